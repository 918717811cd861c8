//! Curve entities -> bounded pieces of [`Curve`]s, in mm.
//!
//! Parameters are those of IGES: lines run over [0, 1], arcs over their angles, splines over their knots.

use super::conic::conic_arc;
use super::file::{File, Record};
use super::splines;
use crate::brep::{Curve, Placement};
use crate::geometry::{Point, Vector};
use crate::stages::parse::fault::{Fault, Read};
use crate::stages::parse::moved::moved_curve;
use crate::stages::parse::sound;

/// How deep curves may be made of curves.
const DEEPEST_CURVE: u32 = 16;
/// Arcs whose angle is nearer to nothing or to a turn than this (radians) are full circles: files have ten digits, and
/// there are arcs almost as short as that.
const NEARLY_A_TURN: f64 = 1e-9;

/// A curve between two of its parameters.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// Number of the entity.
    pub entity: u64,
    pub curve: Curve,
    pub range: [f64; 2],
}

impl Piece {
    /// Where it starts and ends.
    pub fn ends(&self) -> [Point; 2] {
        self.range.map(|t| self.at(t))
    }

    /// The point at a share of its parameter range.
    pub fn along(&self, share: f64) -> Point {
        self.at(self.range[0] + share * (self.range[1] - self.range[0]))
    }

    fn at(&self, t: f64) -> Point {
        self.curve.point(self.curve.wrap(t, self.curve.period()))
    }

    /// The piece as a curve of its own, with the same parameters.
    pub fn bounded(self) -> Curve {
        let [a, b] = self.curve.domain();
        let whole = a == self.range[0] && b == self.range[1];
        if whole {
            return self.curve;
        }
        Curve::Trimmed { basis: Box::new(self.curve), range: self.range, forward: true }
    }
}

/// In which space a curve is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Space {
    /// Lengths become mm.
    Model,
    /// u and v are left as they are, in the plane z = 0; matrices do not count.
    Parameter,
}

/// Whether a type of entity is a curve.
pub(super) fn is_curve(kind: u32) -> bool {
    matches!(kind, 100 | 102 | 104 | 106 | 110 | 112 | 126 | 130)
}

impl File<'_> {
    /// The simple curves that a curve is made of, one after the other.
    pub fn pieces(&self, entity: u64, space: Space) -> Read<Vec<Piece>> {
        let mut pieces = Vec::new();
        self.add_pieces(entity, space, 0, &mut pieces)?;
        if pieces.is_empty() { Err(Fault::new(entity, "a curve without pieces")) } else { Ok(pieces) }
    }

    /// A curve as one.
    pub fn curve(&self, entity: u64) -> Read<Piece> {
        let mut pieces = self.pieces(entity, Space::Model)?;
        if pieces.len() == 1 {
            return Ok(pieces.remove(0));
        }
        let range = [0.0, pieces.len() as f64];
        let pieces: Vec<(Curve, bool)> = pieces.into_iter().map(|piece| (piece.bounded(), true)).collect();
        Ok(Piece { entity, curve: Curve::Composite(pieces), range })
    }

    fn add_pieces(&self, entity: u64, space: Space, depth: u32, out: &mut Vec<Piece>) -> Read<()> {
        if depth > DEEPEST_CURVE {
            return Err(Fault::new(entity, "curves nested too deep"));
        }
        let record = self.record(entity)?;
        let first = out.len();
        if record.entry.kind == 102 {
            let mut fields = record.fields();
            let count = fields.count()?;
            for part in fields.pointers(count)? {
                self.add_pieces(part, space, depth + 1, out)?;
            }
        } else {
            let (curve, range) = self.simple(&record, space, depth)?;
            let bounds = Curve::Trimmed { basis: Box::new(curve), range, forward: true };
            sound::curve(&bounds).map_err(|why| record.fault(why))?;
            let Curve::Trimmed { basis, .. } = bounds else { return Ok(()) };
            out.push(Piece { entity, curve: *basis, range });
        }
        if let (Space::Model, Some(by)) = (space, self.transform(&record)?) {
            for piece in &mut out[first..] {
                piece.curve = moved_curve(piece.curve.clone(), &by);
            }
        }
        Ok(())
    }

    fn simple(&self, record: &Record, space: Space, depth: u32) -> Read<(Curve, [f64; 2])> {
        let unit = if space == Space::Model { self.global.unit_mm } else { 1.0 };
        let flat = |mut read: (Curve, [f64; 2])| {
            if space == Space::Parameter {
                flatten(&mut read.0);
            }
            read
        };
        Ok(flat(match record.entry.kind {
            100 => arc(record, unit)?,
            104 => conic_arc(record, unit)?,
            106 => copious(record, unit)?,
            110 => line(record, unit)?,
            112 => splines::parametric_curve(record, unit)?,
            126 => splines::rational_curve(self, record, unit)?,
            130 => self.offset(record, unit, depth)?,
            _ => return Err(record.fault("not a curve that is known")),
        }))
    }

    /// OFFSET CURVE (130) at one distance: along the plane's normal x tangent.
    fn offset(&self, record: &Record, unit: f64, depth: u32) -> Read<(Curve, [f64; 2])> {
        let mut fields = record.fields();
        let (base, how) = (fields.pointer()?, fields.integer()?);
        if how != 1 {
            return Err(record.fault("offset curves of varying distance are not read"));
        }
        fields.skip(3);
        let distance = fields.real()? * unit;
        let reference = Vector::from(fields.skip(3).reals::<3>()?);
        let range: [f64; 2] = fields.reals()?;
        let mut pieces = Vec::new();
        self.add_pieces(base, Space::Model, depth + 1, &mut pieces)?;
        let [piece] = &pieces[..] else { return Err(record.fault("offsets of composite curves are not read")) };
        let range = if range[0] < range[1] { range } else { piece.range };
        let reference = reference.try_normalize(f64::MIN_POSITIVE).unwrap_or_default();
        Ok((Curve::Offset { basis: Box::new(piece.curve.clone()), distance, reference }, range))
    }
}

/// Takes the third coordinate out of lines, splines and polylines in parameter space.
fn flatten(curve: &mut Curve) {
    match curve {
        Curve::Line { origin, direction } => (origin.z, direction.z) = (0.0, 0.0),
        Curve::Nurbs(nurbs) => nurbs.points.iter_mut().for_each(|p| p.z = 0.0),
        Curve::Polyline(points) => points.iter_mut().for_each(|p| p.z = 0.0),
        _ => {}
    }
}

/// LINE (110).
fn line(record: &Record, unit: f64) -> Read<(Curve, [f64; 2])> {
    let mut fields = record.fields();
    let (a, b) = (Vector::from(fields.reals::<3>()?) * unit, Vector::from(fields.reals::<3>()?) * unit);
    Ok((Curve::Line { origin: a.into(), direction: b - a }, [0.0, 1.0]))
}

/// The frame of a plane z = constant.
pub(super) fn level(x: f64, y: f64, z: f64) -> Placement {
    Placement { origin: Point::new(x, y, z), x: Vector::x(), y: Vector::y(), z: Vector::z() }
}

/// CIRCULAR ARC (100), counter-clockwise from its start to its end.
fn arc(record: &Record, unit: f64) -> Read<(Curve, [f64; 2])> {
    let [z, cx, cy, ax, ay, bx, by] = record.fields().reals::<7>()?.map(|c| c * unit);
    let radius = (ax - cx).hypot(ay - cy);
    let (from, to) = ((ay - cy).atan2(ax - cx), (by - cy).atan2(bx - cx));
    let turn = std::f64::consts::TAU;
    let from = if from < -NEARLY_A_TURN { from + turn } else { from.max(0.0) };
    let angle = (to - from).rem_euclid(turn);
    let angle = if angle < NEARLY_A_TURN || angle > turn - NEARLY_A_TURN { turn } else { angle };
    Ok((Curve::Circle { placement: level(cx, cy, z), radius }, [from, from + angle]))
}

/// COPIOUS DATA (106): points, joined by straight lines; forms 63 and 1 to 13.
fn copious(record: &Record, unit: f64) -> Read<(Curve, [f64; 2])> {
    let mut fields = record.fields();
    let (how, count) = (fields.integer()?, fields.count()?);
    let mut points = Vec::new();
    let level = if how == 1 { fields.real()? } else { 0.0 };
    for _ in 0..count {
        let [x, y] = fields.reals()?;
        let z = if how == 1 { level } else { fields.real()? };
        points.push(Point::new(x, y, z) * unit);
        fields.skip(if how == 3 { 3 } else { 0 });
    }
    points.dedup();
    if record.entry.form == 63 && points.first() != points.last() {
        points.extend(points.first().copied());
    }
    let last = points.len().saturating_sub(1) as f64;
    Ok((Curve::Polyline(points), [0.0, last]))
}
