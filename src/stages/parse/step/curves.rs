//! Curve entities -> [`Curve`].

use super::cursor::Cursor;
use super::keyword::Kind;
use super::placement::Geometry;
use super::records::Record;
use super::splines;
use crate::brep::Curve;
use crate::geometry::Point;
use crate::stages::parse::fault::{Fault, Read};
use crate::stages::parse::sound;

/// How deep curves may be made of curves.
const DEEPEST_CURVE: u32 = 16;

const ON_SURFACE: &[Kind] = &[Kind::RepresentationItem, Kind::SurfaceCurve];
const TRIMMED: &[Kind] = &[Kind::RepresentationItem, Kind::TrimmedCurve];
const CONIC: &[Kind] =
    &[Kind::RepresentationItem, Kind::Conic, Kind::Circle, Kind::Ellipse, Kind::Parabola, Kind::Hyperbola];

impl Geometry<'_> {
    /// Any curve in space that can be evaluated.
    pub fn curve(&self, id: u64) -> Read<Curve> {
        let curve = self.nested_curve(id, 0)?;
        sound::curve(&curve).map_err(|why| Fault::new(id, why))?;
        Ok(curve)
    }

    /// Whether a curve is a line: of an edge along it, that tells no more than its ends do.
    pub fn is_line(&self, mut id: u64) -> bool {
        for _ in 0..=DEEPEST_CURVE {
            let Ok(record) = self.file.record(id) else { return false };
            let basis = match record.kind {
                Kind::Line => return true,
                Kind::SurfaceCurve | Kind::SeamCurve | Kind::IntersectionCurve => {
                    record.fields(ON_SURFACE).skip_many(1).reference()
                }
                _ => return false,
            };
            let Ok(basis) = basis else { return false };
            id = basis;
        }
        false
    }

    /// A curve that others are made of.
    pub(super) fn nested_curve(&self, id: u64, depth: u32) -> Read<Curve> {
        if depth > DEEPEST_CURVE {
            return Err(Fault::new(id, "curves nested too deep"));
        }
        self.spend(id, 1)?;
        let record = self.file.record(id)?;
        for kind in record.kinds() {
            if let Some(curve) = self.curve_of_kind(&record, kind, depth)? {
                sound::nested(&curve).map_err(|why| record.fault(why))?;
                return Ok(curve);
            }
        }
        Err(record.fault("not a curve that is known"))
    }

    fn curve_of_kind(&self, record: &Record, kind: Kind, depth: u32) -> Read<Option<Curve>> {
        Ok(Some(match kind {
            Kind::Line => self.line(record)?,
            Kind::Circle | Kind::Ellipse | Kind::Parabola | Kind::Hyperbola => self.conic(record, kind)?,
            Kind::BSplineCurve
            | Kind::BSplineCurveWithKnots
            | Kind::RationalBSplineCurve
            | Kind::QuasiUniformCurve
            | Kind::UniformCurve
            | Kind::BezierCurve => Curve::Nurbs(splines::curve(self, record)?),
            Kind::Polyline => self.polyline(record)?,
            Kind::TrimmedCurve => self.trimmed(record, depth)?,
            Kind::CompositeCurve | Kind::CompositeCurveOnSurface | Kind::BoundaryCurve | Kind::OuterBoundaryCurve => {
                self.composite(record, depth)?
            }
            Kind::SurfaceCurve | Kind::SeamCurve | Kind::IntersectionCurve => {
                self.nested_curve(record.fields(ON_SURFACE).skip_many(1).reference()?, depth + 1)?
            }
            Kind::BoundedSurfaceCurve if record.kind != Kind::Complex => {
                self.nested_curve(record.fields(&[]).skip_many(1).reference()?, depth + 1)?
            }
            Kind::OffsetCurve3d => self.offset_curve(record, depth)?,
            Kind::CurveReplica => {
                let mut cursor = record.fields(&[Kind::RepresentationItem, Kind::CurveReplica]);
                let parent = self.nested_curve(cursor.skip_many(1).reference()?, depth + 1)?;
                crate::stages::parse::moved::moved_curve(parent, &self.transform(cursor.reference()?)?)
            }
            _ => return Ok(None),
        }))
    }

    fn line(&self, record: &Record) -> Read<Curve> {
        let mut cursor = record.fields(&[Kind::RepresentationItem, Kind::Line]);
        let origin = self.point(cursor.skip_many(1).reference()?)?;
        Ok(Curve::Line { origin, direction: self.vector(cursor.reference()?)? })
    }

    fn conic(&self, record: &Record, kind: Kind) -> Read<Curve> {
        let mut cursor = record.fields(CONIC);
        let placement = self.placement(cursor.skip_many(1).reference()?)?;
        let first = self.length(record, &mut cursor)?;
        Ok(match kind {
            Kind::Circle => Curve::Circle { placement, radius: first },
            Kind::Parabola => Curve::Parabola { placement, focal: first },
            Kind::Ellipse => Curve::Ellipse { placement, semi_x: first, semi_y: self.length(record, &mut cursor)? },
            _ => Curve::Hyperbola { placement, semi_x: first, semi_y: self.length(record, &mut cursor)? },
        })
    }

    /// A length above 0.
    pub(super) fn length(&self, record: &Record, cursor: &mut Cursor) -> Read<f64> {
        let value = cursor.real()? * self.units.length;
        if value > 0.0 && value.is_finite() { Ok(value) } else { Err(record.fault("a length that is not positive")) }
    }

    fn polyline(&self, record: &Record) -> Read<Curve> {
        let ids = record.fields(&[Kind::RepresentationItem, Kind::Polyline]).skip_many(1).references()?;
        self.spend(record.id, ids.len())?;
        let points = ids.into_iter().map(|id| self.point(id)).collect::<Read<Vec<_>>>()?;
        if points.len() < 2 {
            Err(record.fault("a polyline of fewer than two points"))
        } else {
            Ok(Curve::Polyline(points))
        }
    }

    fn composite(&self, record: &Record, depth: u32) -> Read<Curve> {
        let segments = record.fields(&[Kind::RepresentationItem, Kind::CompositeCurve]).skip_many(1).references()?;
        if segments.is_empty() {
            return Err(record.fault("a composite curve without segments"));
        }
        let pieces = segments.into_iter().map(|id| self.segment(id, depth)).collect::<Read<_>>()?;
        Ok(Curve::Composite(pieces))
    }

    /// COMPOSITE_CURVE_SEGMENT: its curve and whether it runs along it.
    pub(super) fn segment(&self, id: u64, depth: u32) -> Read<(Curve, bool)> {
        let record = self.file.record(id)?;
        if !record.is(Kind::CompositeCurveSegment) && !record.is(Kind::ReparametrisedSegment) {
            return Err(record.fault("a segment of a composite curve was expected"));
        }
        let mut cursor = record.fields(&[Kind::CompositeCurveSegment]);
        let sense = cursor.skip_many(1).flag().unwrap_or(true);
        Ok((self.nested_curve(cursor.reference()?, depth + 1)?, sense))
    }

    fn offset_curve(&self, record: &Record, depth: u32) -> Read<Curve> {
        let mut cursor = record.fields(&[Kind::RepresentationItem, Kind::OffsetCurve3d]);
        let basis = Box::new(self.nested_curve(cursor.skip_many(1).reference()?, depth + 1)?);
        let distance = cursor.real()? * self.units.length;
        let reference = self.direction(cursor.skip_many(1).reference()?)?;
        Ok(Curve::Offset { basis, distance, reference })
    }

    fn trimmed(&self, record: &Record, depth: u32) -> Read<Curve> {
        let mut cursor = record.fields(TRIMMED);
        let basis = self.nested_curve(cursor.skip_many(1).reference()?, depth + 1)?;
        let (first, second) = (self.trim(&mut cursor)?, self.trim(&mut cursor)?);
        let forward = cursor.flag().unwrap_or(true);
        let by_point = cursor.word().eq_ignore_ascii_case(b"CARTESIAN");
        let parameter = |trim: &Trim| trim.parameter(&basis, self.units.angle, by_point);
        let (Some(a), Some(b)) = (parameter(&first), parameter(&second)) else {
            return Err(record.fault("a curve trimmed at no parameters"));
        };
        let range = unwrapped(&basis, [a, b], forward);
        if !range.iter().all(|t| t.is_finite()) {
            return Err(record.fault("a curve trimmed at impossible parameters"));
        }
        Ok(Curve::Trimmed { basis: Box::new(basis), range, forward })
    }

    fn trim(&self, cursor: &mut Cursor) -> Read<Trim> {
        let mut trim = Trim::default();
        cursor.list(|c| {
            if c.is_reference() {
                trim.point = Some(self.point(c.reference()?)?);
            } else {
                trim.parameter = Some(c.real()?);
            }
            Ok(())
        })?;
        Ok(trim)
    }
}

/// One end of a trimmed curve, by parameter, by point or by both.
#[derive(Default)]
struct Trim {
    parameter: Option<f64>,
    point: Option<Point>,
}

impl Trim {
    fn parameter(&self, basis: &Curve, angle: f64, by_point: bool) -> Option<f64> {
        let given = self.parameter.map(|t| t * parameter_unit(basis, angle));
        let mapped = || self.point.map(|p| basis.project(&p, None));
        if by_point { mapped().or(given) } else { given.or_else(mapped) }
    }
}

/// Radians (or 1 for other parameters) in the unit of a curve's parameter.
pub(super) fn parameter_unit(curve: &Curve, angle: f64) -> f64 {
    match curve {
        Curve::Circle { .. } | Curve::Ellipse { .. } => angle,
        Curve::Trimmed { basis, .. } | Curve::Offset { basis, .. } => parameter_unit(basis, angle),
        _ => 1.0,
    }
}

/// Shifts the second parameter of a periodic curve so that the piece runs the way `forward` says.
fn unwrapped(basis: &Curve, [a, b]: [f64; 2], forward: bool) -> [f64; 2] {
    let Some(period) = basis.period() else { return [a, b] };
    let span = if forward { b - a } else { a - b };
    let rest = span.rem_euclid(period);
    let span = if rest < 1e-12 * period { period } else { rest };
    [a, if forward { a + span } else { a - span }]
}
