//! Faces without topology: trimmed and bounded surfaces, and surfaces that are bounded by themselves.

use super::curves::{Piece, Space};
use super::file::{File, Record};
use super::surfaces::Sheet;
use crate::brep::{Curve, Surface};
use crate::geometry::Point;
use crate::stages::parse::fault::{Fault, Read};
use crate::stages::parse::moved::moved_curve;
use crate::stages::parse::on_surface;

/// Points of a traced curve that count as one thing made: the file gives fewer numbers for them.
const POINTS_OF_ONE: usize = 4;
/// Points of each piece for the direction of a loop in parameter space.
const SAMPLES: usize = 8;

/// The curves of one loop, one after the other, with the face on the left where the file tells.
#[derive(Clone, Debug)]
pub(super) struct RawLoop {
    /// Number of the boundary or curve.
    pub entity: u64,
    pub pieces: Vec<Piece>,
    /// The pieces run backwards.
    pub reversed: bool,
}

/// A face whose edges are not yet joined to those of other faces.
#[derive(Clone, Debug)]
pub(super) struct RawFace {
    pub entity: u64,
    pub surface: Surface,
    pub same_sense: bool,
    pub loops: Vec<RawLoop>,
}

/// Whether a type of entity makes a face on its own.
pub(super) fn is_face(kind: u32) -> bool {
    matches!(kind, 143 | 144) || super::surfaces::is_surface(kind)
}

impl File<'_> {
    /// A trimmed (144) or bounded (143) surface, or a surface with a border of its own; `None`: it has none.
    pub fn raw_face(&self, entity: u64) -> Read<Option<RawFace>> {
        let record = self.record(entity)?;
        let face = match record.entry.kind {
            144 => self.trimmed(&record)?,
            143 => self.bounded(&record)?,
            108 => return self.bounded_plane(&record),
            _ => {
                let sheet = self.sheet(entity)?;
                if !sheet.is_bounded() {
                    return Ok(None);
                }
                let whole = self.natural_loop(entity, &sheet)?;
                return Ok(Some(raw(entity, &sheet, vec![whole])));
            }
        };
        match self.transform(&record)? {
            None => Ok(Some(face)),
            Some(by) => Ok(Some(face.moved(&by))),
        }
    }

    /// TRIMMED SURFACE (144).
    fn trimmed(&self, record: &Record) -> Read<RawFace> {
        let mut fields = record.fields();
        let sheet = self.sheet(fields.pointer()?)?;
        let (has_outer, inner) = (fields.flag()?, fields.count()?);
        let outer = fields.optional_pointer()?.filter(|_| has_outer);
        let mut loops = vec![match outer {
            Some(outer) => self.curve_on_surface(outer, &sheet, true)?,
            None => self.natural_loop(record.entity, &sheet)?,
        }];
        for hole in fields.pointers(inner)? {
            loops.push(self.curve_on_surface(hole, &sheet, false)?);
        }
        Ok(raw(record.entity, &sheet, loops))
    }

    /// CURVE ON A PARAMETRIC SURFACE (142): its curve in space, else what the one in parameter space traces.
    fn curve_on_surface(&self, entity: u64, sheet: &Sheet, outer: bool) -> Read<RawLoop> {
        let record = self.expect(entity, 142, "a curve on a surface was expected")?;
        let mut fields = record.fields();
        let flat = fields.skip(2).optional_pointer()?;
        let space = fields.optional_pointer()?;
        let flat = flat.map(|flat| self.pieces(flat, Space::Parameter));
        // Counter-clockwise round the face in the parameters of the file.
        let reversed = match &flat {
            Some(Ok(pieces)) => (signed_area(pieces) > 0.0) != outer,
            _ => false,
        };
        let pieces = match (space, flat) {
            (Some(space), _) => self.pieces(space, Space::Model)?,
            (None, Some(flat)) => self.traced(sheet, flat?)?,
            (None, None) => return Err(record.fault("a curve on a surface without curves")),
        };
        Ok(RawLoop { entity, pieces, reversed })
    }

    /// The border of a surface's own rectangle, counter-clockwise in the parameters of the file.
    fn natural_loop(&self, entity: u64, sheet: &Sheet) -> Read<RawLoop> {
        if !sheet.is_bounded() {
            return Err(Fault::new(entity, "a surface without end needs an outer boundary"));
        }
        let [u0, u1, v0, v1] = sheet.bounds;
        let corners = [[u0, v0], [u1, v0], [u1, v1], [u0, v1]].map(|[u, v]| Point::new(u, v, 0.0));
        let mut pieces = Vec::with_capacity(4);
        for side in 0..4 {
            let (from, to) = (corners[side], corners[(side + 1) % 4]);
            let flat = Curve::Line { origin: from, direction: to - from };
            let traced = on_surface::traced(&sheet.surface, &on_surface::Chart::default(), &flat, [0.0, 1.0]);
            let traced = traced.map_err(|why| Fault::new(entity, why))?;
            self.spend(entity, traced.points.len() / POINTS_OF_ONE)?;
            pieces.push(placed(entity, Curve::Nurbs(traced), [0.0, 1.0], sheet));
        }
        Ok(RawLoop { entity, pieces, reversed: sheet.chart.turns() })
    }

    fn traced(&self, sheet: &Sheet, flat: Vec<Piece>) -> Read<Vec<Piece>> {
        let mut pieces = Vec::with_capacity(flat.len());
        for Piece { entity, curve, range } in flat {
            let traced = on_surface::traced(&sheet.surface, &sheet.chart, &curve, range);
            let traced = traced.map_err(|why| Fault::new(entity, why))?;
            self.spend(entity, traced.points.len() / POINTS_OF_ONE)?;
            pieces.push(placed(entity, Curve::Nurbs(traced), range, sheet));
        }
        Ok(pieces)
    }

    /// BOUNDED SURFACE (143) with its BOUNDARIES (141).
    fn bounded(&self, record: &Record) -> Read<RawFace> {
        let mut fields = record.fields();
        let sheet = self.sheet(fields.skip(1).pointer()?)?;
        let count = fields.count()?;
        let boundaries = fields.pointers(count)?;
        let loops: Vec<RawLoop> = boundaries.iter().map(|b| self.boundary(*b)).collect::<Read<_>>()?;
        if loops.is_empty() {
            return Err(record.fault("a bounded surface without boundaries"));
        }
        Ok(raw(record.entity, &sheet, loops))
    }

    fn boundary(&self, entity: u64) -> Read<RawLoop> {
        let record = self.expect(entity, 141, "a boundary was expected")?;
        let mut fields = record.fields();
        let count = fields.skip(3).count()?;
        let mut pieces = Vec::new();
        for _ in 0..count {
            let curve = fields.pointer()?;
            let sense = fields.integer()?;
            let flat = fields.count()?;
            fields.skip(flat);
            let mut part = self.pieces(curve, Space::Model)?;
            if sense == 2 {
                part.reverse();
            }
            pieces.append(&mut part);
        }
        Ok(RawLoop { entity, pieces, reversed: false })
    }

    /// PLANE (108) with a bounding curve.
    fn bounded_plane(&self, record: &Record) -> Read<Option<RawFace>> {
        let mut fields = record.fields();
        let border = fields.skip(4).optional_pointer()?;
        let Some(border) = border.filter(|_| record.entry.form == 1) else { return Ok(None) };
        let sheet = self.sheet(record.entity)?;
        let mut pieces = self.pieces(border, Space::Model)?;
        if let Some(by) = &sheet.place {
            pieces.iter_mut().for_each(|piece| piece.curve = moved_curve(piece.curve.clone(), by));
        }
        Ok(Some(raw(record.entity, &sheet, vec![RawLoop { entity: border, pieces, reversed: false }])))
    }
}

fn raw(entity: u64, sheet: &Sheet, loops: Vec<RawLoop>) -> RawFace {
    let (surface, turned) = sheet.placed();
    RawFace { entity, surface, same_sense: !turned, loops }
}

fn placed(entity: u64, curve: Curve, range: [f64; 2], sheet: &Sheet) -> Piece {
    let curve = match &sheet.place {
        Some(by) => moved_curve(curve, by),
        None => curve,
    };
    Piece { entity, curve, range }
}

/// Of the polygon of points of the pieces.
fn signed_area(pieces: &[Piece]) -> f64 {
    let points: Vec<Point> =
        pieces.iter().flat_map(|piece| (0..SAMPLES).map(|i| piece.along(i as f64 / SAMPLES as f64))).collect();
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(a, b)| 0.5 * (a.x * b.y - a.y * b.x)).sum()
}

impl RawFace {
    /// The face moved; its normal follows the parameters, which a mirror carries along.
    fn moved(mut self, by: &crate::geometry::Transform) -> Self {
        let (surface, against) = crate::stages::parse::moved::moved_surface(self.surface, by);
        self.surface = surface;
        self.same_sense ^= against ^ by.mirrors();
        for piece in self.loops.iter_mut().flat_map(|l| &mut l.pieces) {
            piece.curve = moved_curve(piece.curve.clone(), by);
        }
        self
    }
}
