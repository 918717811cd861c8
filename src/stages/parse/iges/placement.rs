//! Points, directions and transformation matrices, in mm.

use super::file::{File, Record};
use crate::brep::Placement;
use crate::geometry::{Matrix, Point, Transform, Vector, any_perpendicular};
use crate::stages::parse::fault::{Fault, Read};

/// How deep matrices may refer to others.
const DEEPEST_MATRIX: u32 = 16;
/// How far the columns of a matrix may be from equally long and perpendicular, as a share of their length.
const SKEW: f64 = 1e-4;

impl File<'_> {
    /// The matrix of an entity (TRANSFORMATION MATRIX, 124), with those that it refers to; `None` for none.
    pub fn transform(&self, record: &Record) -> Read<Option<Transform>> {
        match record.entry.transform {
            0 => Ok(None),
            matrix => self.matrix(matrix, 0).map(Some),
        }
    }

    pub(super) fn matrix(&self, entity: u64, depth: u32) -> Read<Transform> {
        if depth > DEEPEST_MATRIX {
            return Err(Fault::new(entity, "matrices nested too deep"));
        }
        let record = self.record(entity)?;
        if record.entry.kind != 124 {
            return Err(record.fault("a transformation matrix was expected"));
        }
        let mut fields = record.fields();
        let [a, b, c]: [[f64; 4]; 3] = [fields.reals()?, fields.reals()?, fields.reals()?];
        let linear = Matrix::new(a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]);
        let translation = Vector::new(a[3], b[3], c[3]) * self.global.unit_mm;
        let own = similarity(&linear).map(|linear| Transform { linear, translation });
        let own = own.ok_or_else(|| record.fault("a matrix that is not a similarity"))?;
        match record.entry.transform {
            0 => Ok(own),
            outer => Ok(self.matrix(outer, depth + 1)?.after(&own)),
        }
    }

    /// POINT (116).
    pub fn point(&self, entity: u64) -> Read<Point> {
        let record = self.expect(entity, 116, "a point was expected")?;
        let point = Point::from(record.fields().reals::<3>()?) * self.global.unit_mm;
        Ok(self.transform(&record)?.map_or(point, |by| by.point(&point)))
    }

    /// DIRECTION (123), of length 1.
    pub fn direction(&self, entity: u64) -> Read<Vector> {
        let record = self.expect(entity, 123, "a direction was expected")?;
        let direction = Vector::from(record.fields().reals::<3>()?);
        let direction = self.transform(&record)?.map_or(direction, |by| by.vector(&direction));
        let unit = direction.try_normalize(f64::MIN_POSITIVE).filter(|d| d.iter().all(|c| c.is_finite()));
        unit.ok_or_else(|| record.fault("a direction of no length"))
    }

    /// An entity of the given type.
    pub fn expect(&self, entity: u64, kind: u32, otherwise: &'static str) -> Read<Record> {
        let record = self.record(entity)?;
        if record.entry.kind == kind { Ok(record) } else { Err(record.fault(otherwise)) }
    }

    /// A placement at a point along an axis, with x as near to a reference direction as it can be.
    pub fn axes(&self, location: u64, axis: Option<u64>, reference: Option<u64>) -> Read<Placement> {
        let z = axis.map_or(Ok(Vector::z()), |axis| self.direction(axis))?;
        let reference = reference.map_or(Ok(None), |reference| self.direction(reference).map(Some))?;
        Ok(placement(self.point(location)?, z, reference))
    }
}

/// Right-handed axes with the given z and x near to the reference.
pub(super) fn placement(origin: Point, z: Vector, reference: Option<Vector>) -> Placement {
    let across = reference.and_then(|r| (r - z * z.dot(&r)).try_normalize(1e-9));
    let x = across.unwrap_or_else(|| any_perpendicular(&z));
    Placement { origin, x, y: z.cross(&x), z }
}

/// The matrix, made orthogonal but for a factor where the digits of the file leave it slightly off; `None`: it is far off.
fn similarity(linear: &Matrix) -> Option<Matrix> {
    let gram = linear.transpose() * linear;
    let scale = (gram.trace() / 3.0).sqrt();
    if !(scale > 0.0 && scale.is_finite()) || (gram / (scale * scale) - Matrix::identity()).amax() > SKEW {
        return None;
    }
    let x = linear.column(0).normalize();
    let y = linear.column(1) - x * x.dot(&linear.column(1));
    let y = y.normalize();
    let z = x.cross(&y) * if linear.determinant() < 0.0 { -1.0 } else { 1.0 };
    Some(Matrix::from_columns(&[x * scale, y * scale, z * scale]))
}
