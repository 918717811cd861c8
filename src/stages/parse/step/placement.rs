//! Points, directions, placements and transformation operators, in mm.

use std::cell::Cell;

use super::keyword::Kind;
use super::records::File;
use super::units::Units;
use crate::brep::Placement;
use crate::geometry::{Point, Transform, Vector, any_perpendicular};
use crate::stages::parse::fault::{Fault, Read};
use crate::stages::parse::sound;

/// The scales of transformation operators that are taken.
const SCALES: std::ops::RangeInclusive<f64> = 1e-9..=1e9;

/// Decodes geometry in the units of one representation.
#[derive(Clone)]
pub(super) struct Geometry<'a> {
    pub file: File<'a>,
    pub units: Units,
    /// Curves, surfaces, control points and edge uses that may still be made.
    budget: Cell<usize>,
}

impl<'a> Geometry<'a> {
    /// In a file in which nothing is shared each thing made has some bytes of its own: more things than bytes means
    /// that references multiply beyond any use.
    pub fn new(file: File<'a>, units: Units) -> Self {
        Self { file, units, budget: Cell::new(file.bytes.len()) }
    }

    /// Counts `count` things made for entity `id`.
    pub(super) fn spend(&self, id: u64, count: usize) -> Read<()> {
        let left = self.budget.get().checked_sub(count);
        self.budget.set(left.ok_or_else(|| Fault::new(id, "references multiply beyond the file's size"))?);
        Ok(())
    }

    /// CARTESIAN_POINT.
    pub fn point(&self, id: u64) -> Read<Point> {
        let coordinates = self.triple(id, Kind::CartesianPoint, "a point was expected")?;
        self.in_reach(id, coordinates)
    }

    /// A point with coordinates in the units of the representation.
    pub(super) fn in_reach(&self, id: u64, coordinates: Vector) -> Read<Point> {
        let point = Point::from(coordinates * self.units.length);
        sound::in_reach(&point).map_err(|why| Fault::new(id, why))?;
        Ok(point)
    }

    /// DIRECTION, of length 1; `None` for a zero direction.
    fn unit_direction(&self, id: u64) -> Read<Option<Vector>> {
        let v = self.triple(id, Kind::Direction, "a direction was expected")?;
        let largest = v.amax();
        // Dividing by the largest component first keeps tiny and huge ones from under- and overflowing.
        Ok((largest > 0.0).then(|| (v / largest).normalize()))
    }

    /// DIRECTION, of length 1.
    pub fn direction(&self, id: u64) -> Read<Vector> {
        self.unit_direction(id)?.ok_or_else(|| Fault::new(id, "a direction of no length"))
    }

    /// VECTOR: direction times magnitude.
    pub fn vector(&self, id: u64) -> Read<Vector> {
        let record = self.file.record(id)?;
        if !record.is(Kind::Vector) {
            return Err(record.fault("a vector was expected"));
        }
        let mut cursor = record.fields(&[Kind::RepresentationItem, Kind::Vector]);
        let direction = self.direction(cursor.skip_many(1).reference()?)?;
        let magnitude = cursor.real()?;
        if magnitude == 0.0 {
            return Err(record.fault("a vector of no length"));
        }
        Ok(direction * (magnitude * self.units.length))
    }

    fn triple(&self, id: u64, kind: Kind, otherwise: &'static str) -> Read<Vector> {
        let entry = self.file.find(id)?;
        if let Some(values) = self.file.plain_triple(entry, kind) {
            return Ok(values);
        }
        let record = self.file.record_of(entry);
        if !record.is(kind) {
            return Err(record.fault(otherwise));
        }
        let inheritance = match kind {
            Kind::Direction => &[Kind::RepresentationItem, Kind::Direction],
            _ => &[Kind::RepresentationItem, Kind::CartesianPoint],
        };
        let (mut values, mut count) = ([0.0; 3], 0);
        record.fields(inheritance).skip_many(1).list(|c| {
            let value = c.real()?;
            if let Some(place) = values.get_mut(count) {
                *place = value;
            }
            count += 1;
            Ok(())
        })?;
        if count == 3 { Ok(Vector::from(values)) } else { Err(record.fault("three coordinates were expected")) }
    }

    /// AXIS2_PLACEMENT_3D, or AXIS1_PLACEMENT with some x axis.
    pub fn placement(&self, id: u64) -> Read<Placement> {
        let record = self.file.record(id)?;
        if !record.is(Kind::Axis2) && !record.is(Kind::Axis1) {
            return Err(record.fault("a placement was expected"));
        }
        let mut cursor = record.fields(&[Kind::RepresentationItem, Kind::Placement, Kind::Axis1, Kind::Axis2]);
        let origin = self.point(cursor.skip_many(1).reference()?)?;
        let axis = self.optional_direction(cursor.optional_reference()?)?;
        let reference = self.optional_direction(cursor.optional_reference()?)?;
        Ok(orthonormal(origin, axis, reference))
    }

    fn optional_direction(&self, id: Option<u64>) -> Read<Option<Vector>> {
        id.map_or(Ok(None), |id| self.unit_direction(id))
    }

    /// The map that a placement or a CARTESIAN_TRANSFORMATION_OPERATOR_3D stands for.
    pub fn transform(&self, id: u64) -> Read<Transform> {
        let record = self.file.record(id)?;
        if record.is(Kind::TransformationOperator3d) { self.operator(id) } else { Ok(self.placement(id)?.transform()) }
    }

    /// CARTESIAN_TRANSFORMATION_OPERATOR_3D (ISO 10303-42, 4.4.21): axes, origin and scale, possibly mirroring.
    fn operator(&self, id: u64) -> Read<Transform> {
        let record = self.file.record(id)?;
        let inheritance = &[Kind::RepresentationItem, Kind::TransformationOperator, Kind::TransformationOperator3d];
        let mut cursor = record.fields(inheritance);
        let mut count = 0;
        while !cursor.at_end() {
            cursor.skip();
            count += 1;
        }
        let mut cursor = record.fields(inheritance);
        // Some writers leave out the name and description of the functionally defined transformation.
        cursor.skip_many(if count >= 8 { 3 } else { 1 });
        let first = self.optional_direction(cursor.optional_reference()?)?;
        let second = self.optional_direction(cursor.optional_reference()?)?;
        let origin = self.point(cursor.reference()?)?;
        let scale = cursor.optional_real()?.unwrap_or(1.0);
        let third = self.optional_direction(cursor.optional_reference()?)?;
        if !SCALES.contains(&scale) {
            return Err(record.fault("a scale that is not positive or beyond reason"));
        }
        let frame = orthonormal(origin, third, first);
        let y = if second.is_some_and(|s| s.dot(&frame.y) < 0.0) { -frame.y } else { frame.y };
        Ok(Transform::from_axes(&origin, &(frame.x * scale), &(y * scale), &(frame.z * scale)))
    }
}

/// Right-handed axes with z along `axis` and x as near to `reference` as it can be; what is missing or parallel is
/// replaced as ISO 10303-42 says.
pub(super) fn orthonormal(origin: Point, axis: Option<Vector>, reference: Option<Vector>) -> Placement {
    let z = axis.unwrap_or_else(Vector::z);
    let across = |v: Vector| {
        let rest = v - z * z.dot(&v);
        (rest.norm() > 1e-9).then(|| rest.normalize())
    };
    let x = reference.and_then(across).or_else(|| across(Vector::x())).unwrap_or_else(|| any_perpendicular(&z));
    Placement { origin, x, y: z.cross(&x), z }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_and_parallel_axes_are_replaced() {
        let o = Point::origin();
        let plain = orthonormal(o, None, None);
        assert_eq!((plain.x, plain.y, plain.z), (Vector::x(), Vector::y(), Vector::z()));
        let parallel = orthonormal(o, Some(Vector::x()), Some(Vector::x()));
        assert!(parallel.x.dot(&parallel.z).abs() < 1e-15);
        assert!((parallel.x.cross(&parallel.y) - parallel.z).norm() < 1e-15);
    }
}
