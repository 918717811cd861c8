//! Surface entities -> [`Surface`], in mm.

use super::curves::Piece;
use super::file::{File, Record};
use super::placement::placement;
use super::recognise::recognised;
use super::{ruled, splines};
use crate::brep::Surface;
use crate::geometry::{Point, Transform, Vector};
use crate::stages::parse::fault::{Fault, Read};
use crate::stages::parse::moved::moved_surface;
use crate::stages::parse::on_surface::Chart;
use crate::stages::parse::sound;

/// How deep surfaces may be made of surfaces.
const DEEPEST_SURFACE: u32 = 16;
/// Angles nearer to a turn than this (radians) are full turns: files have ten digits.
const NEARLY_A_TURN: f64 = 1e-8;
const TURN: f64 = std::f64::consts::TAU;

/// A surface as the file has it, before its matrix.
#[derive(Clone, Debug)]
pub(super) struct Sheet {
    pub surface: Surface,
    /// From the parameters of IGES to ours.
    pub chart: Chart,
    /// The rectangle [u0, u1, v0, v1] of our parameters; infinite where the surface is.
    pub bounds: [f64; 4],
    /// Where it lies.
    pub place: Option<Transform>,
}

impl Sheet {
    fn new(surface: Surface) -> Self {
        let bounds = surface.domain();
        Self { surface, chart: Chart::default(), bounds, place: None }
    }

    /// The surface in its place, as a quadric or torus where it is one, and whether its normal S_u x S_v is against
    /// that of IGES.
    pub fn placed(&self) -> (Surface, bool) {
        let (surface, changed) =
            recognised(&self.surface, self.bounds).unwrap_or_else(|| (self.surface.clone(), false));
        let turned = changed ^ self.chart.turns();
        match &self.place {
            None => (surface, turned),
            Some(by) => {
                let (surface, against) = moved_surface(surface, by);
                (surface, turned ^ against ^ by.mirrors())
            }
        }
    }

    pub fn is_bounded(&self) -> bool {
        self.bounds.iter().all(|b| b.is_finite())
    }
}

/// Whether a type of entity is a surface.
pub(super) fn is_surface(kind: u32) -> bool {
    matches!(kind, 108 | 114 | 118 | 120 | 122 | 128 | 140 | 190 | 192 | 194 | 196 | 198)
}

impl File<'_> {
    /// Any surface.
    pub fn sheet(&self, entity: u64) -> Read<Sheet> {
        self.nested_sheet(entity, 0)
    }

    fn nested_sheet(&self, entity: u64, depth: u32) -> Read<Sheet> {
        if depth > DEEPEST_SURFACE {
            return Err(Fault::new(entity, "surfaces nested too deep"));
        }
        let record = self.record(entity)?;
        let mut sheet = match record.entry.kind {
            108 => self.plane(&record)?,
            114 => Sheet::new(Surface::Nurbs(splines::parametric_surface(self, &record)?)),
            118 => self.ruled(&record)?,
            120 => self.revolution(&record)?,
            122 => self.tabulated(&record)?,
            128 => {
                let (nurbs, bounds) = splines::rational_surface(self, &record)?;
                Sheet { bounds, ..Sheet::new(Surface::Nurbs(nurbs)) }
            }
            140 => self.offset_surface(&record, depth)?,
            190 | 192 | 194 | 196 | 198 => self.analytic(&record)?,
            _ => return Err(record.fault("not a surface that is known")),
        };
        sound::surface(&sheet.surface).map_err(|why| record.fault(why))?;
        if let Some(outer) = self.transform(&record)? {
            sheet.place = Some(sheet.place.map_or(outer, |inner| outer.after(&inner)));
        }
        Ok(sheet)
    }

    /// PLANE (108): A x + B y + C z = D.
    fn plane(&self, record: &Record) -> Read<Sheet> {
        let [a, b, c, d] = record.fields().reals()?;
        let normal = Vector::new(a, b, c);
        let origin = normal * (d * self.global.unit_mm / normal.norm_squared());
        Ok(Sheet::new(Surface::Plane(placement(Point::from(origin), normal.normalize(), None))))
    }

    /// RULED SURFACE (118).
    fn ruled(&self, record: &Record) -> Read<Sheet> {
        let mut fields = record.fields();
        let (first, second) = (self.curve(fields.pointer()?)?, self.curve(fields.pointer()?)?);
        let against = fields.real_or(0.0) == 1.0;
        let nurbs = ruled::between(&first, &second, against).map_err(|why| record.fault(why))?;
        self.spend(record.entity, nurbs.points.len())?;
        Ok(Sheet::new(Surface::Nurbs(nurbs)))
    }

    /// SURFACE OF REVOLUTION (120): IGES has the generatrix along u and the angle along v, we the other way round.
    fn revolution(&self, record: &Record) -> Read<Sheet> {
        let mut fields = record.fields();
        let axis = self.curve(fields.pointer()?)?;
        let Piece { curve, range, .. } = self.curve(fields.pointer()?)?;
        let [from, to] = fields.reals()?;
        let [a, b] = axis.ends();
        let z = (b - a).try_normalize(f64::MIN_POSITIVE).ok_or_else(|| record.fault("an axis of no length"))?;
        let span = to - from;
        let span = if span <= NEARLY_A_TURN || span > TURN - NEARLY_A_TURN { TURN } else { span };
        let profile = Box::new(Piece { entity: record.entity, curve, range }.bounded());
        let surface = Surface::Revolution { profile, axis: placement(a, z, None) };
        let chart = Chart { swapped: true, ..Chart::default() };
        Ok(Sheet { surface, chart, bounds: [from, from + span, range[0], range[1]], place: None })
    }

    /// TABULATED CYLINDER (122): u runs over [0, 1] along the directrix, v to the end of the generatrix.
    fn tabulated(&self, record: &Record) -> Read<Sheet> {
        let mut fields = record.fields();
        let piece = self.curve(fields.pointer()?)?;
        let end = Point::from(fields.reals::<3>()?) * self.global.unit_mm;
        let direction = end - piece.ends()[0];
        let [a, b] = piece.range;
        let surface = Surface::Extrusion { profile: Box::new(piece.bounded()), direction };
        let chart = Chart { scale: [b - a, 1.0], offset: [a, 0.0], swapped: false };
        Ok(Sheet { surface, chart, bounds: [a, b, 0.0, 1.0], place: None })
    }

    /// OFFSET SURFACE (140): to the side that the indicator shows at the middle of the surface.
    fn offset_surface(&self, record: &Record, depth: u32) -> Read<Sheet> {
        let mut fields = record.fields();
        let indicator = Vector::from(fields.reals::<3>()?);
        let distance = fields.real()? * self.global.unit_mm;
        let basis = self.nested_sheet(fields.pointer()?, depth + 1)?;
        let middle = |a: f64, b: f64| if (b - a).is_finite() { 0.5 * (a + b) } else { 0.0 };
        let [u0, u1, v0, v1] = basis.bounds;
        let normal = basis.surface.jet(middle(u0, u1), middle(v0, v1)).normal();
        let normal = basis.place.map_or(normal, |by| by.vector(&normal));
        let own = if indicator.norm() > 0.0 { indicator.dot(&normal) < 0.0 } else { basis.chart.turns() };
        let distance = if own { -distance } else { distance };
        let surface = Surface::Offset { basis: Box::new(basis.surface.clone()), distance };
        if basis.place.is_some_and(|by| by.mirrors()) {
            return Err(record.fault("offsets of mirrored surfaces are not read"));
        }
        Ok(Sheet { surface, ..basis })
    }

    /// Plane, cylinder, cone, sphere and torus (190 to 198); parameters that are angles are degrees.
    fn analytic(&self, record: &Record) -> Read<Sheet> {
        let (unit, kind) = (self.global.unit_mm, record.entry.kind);
        let mut fields = record.fields();
        let location = fields.pointer()?;
        let mut sizes = [0.0; 2];
        let axis = if kind == 196 { None } else { fields.optional_pointer()? };
        let count = [190, 192, 194, 196, 198].iter().position(|k| *k == kind).map_or(0, |i| [0, 1, 2, 1, 2][i]);
        for size in &mut sizes[..count] {
            *size = fields.real()?;
        }
        let axis = if kind == 196 { pointer_at(&mut fields) } else { axis };
        let placement = self.axes(location, axis, pointer_at(&mut fields))?;
        let surface = match kind {
            190 => Surface::Plane(placement),
            192 => Surface::Cylinder { placement, radius: sizes[0] * unit },
            194 => Surface::Cone { placement, radius: sizes[0] * unit, half_angle: sizes[1].to_radians() },
            196 => Surface::Sphere { placement, radius: sizes[0] * unit },
            _ => Surface::Torus { placement, major: sizes[0] * unit, minor: sizes[1] * unit },
        };
        let degree = 1_f64.to_radians();
        let scale = match kind {
            190 => [unit, unit],
            192 | 194 => [degree, unit],
            _ => [degree, degree],
        };
        Ok(Sheet { chart: Chart { scale, ..Chart::default() }, ..Sheet::new(surface) })
    }
}

/// A pointer that may be left out at the end of a record.
fn pointer_at(fields: &mut super::file::Fields) -> Option<u64> {
    let value = fields.real_or(0.0);
    (value >= 1.0 && value.fract() == 0.0).then_some(value as u64)
}
