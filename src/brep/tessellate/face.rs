//! One face -> its triangles and integrals, in the coordinates of its body.

use std::ops::Range;

use super::border::Border;
use super::boundary::{Mapped, Paths, map_border};
use super::chart::{Chart, Uv};
use super::domain::{self, Patch};
use super::edges::{EdgeLines, Fineness};
use super::fallback::planar_fill;
use super::integrate::{Integrals, Sides, integrate, integrate_triangles};
use super::triangulate::Room;
use crate::brep::{Face, FaceGeometry, Facets, Model, Surface};
use crate::cancel::Cancel;
use crate::geometry::Point;
use crate::memory::{empty, held};

/// Points further than this share of the model's size from their surface do not belong to it.
const FAR: f64 = 0.01;
/// Segments on each side of a face that is bounded by its surface's own limits.
const RIM_SEGMENTS: usize = 24;

/// Triangles whose area is off by more than this share are made again, finer and without short cuts.
const AREA_OFF: f64 = 0.015;
/// Errors smaller than this share of the square of the model's size, a pixel of a silhouette of 512, are not seen.
const UNSEEN: f64 = 4e-6;
/// How often a face is made again at most, and the least share of the deflection each time.
const REFINEMENTS: usize = 4;
const FINER: f64 = 0.25;
/// What is aimed for when a face is made again, as a share of the error that is taken.
const AIM: f64 = 0.75;
/// More triangles that leave more than this share of the error do not help: the edges are too coarse.
const HELPS: f64 = 0.9;

/// What all faces of a model need.
pub(super) struct Context<'a> {
    pub model: &'a Model,
    pub cancel: &'a Cancel,
    pub lines: &'a mut EdgeLines,
    /// Edges without length.
    pub degenerate: Vec<bool>,
    pub fineness: Fineness,
    /// How many times longer the chords are than asked for.
    pub coarser: f64,
    /// Size of the model in the coordinates of its parts, mm.
    pub size: f64,
    /// For each face the point that its integrals refer to.
    pub reference: Vec<Point>,
}

/// The tessellated faces of a model, or some of them, in the coordinates of their bodies. What a face had before it was
/// made again stays among the points and triangles, of no use, until the mesh is put together.
#[derive(Default)]
pub(super) struct Meshes {
    pub points: Vec<Point>,
    /// Counter-clockwise seen from the face normal's side; indices into the points of the face.
    pub triangles: Vec<[u32; 3]>,
    /// For each face its mesh, or why it has none.
    pub faces: Vec<Result<FaceMesh, String>>,
}

/// A tessellated face.
pub(super) struct FaceMesh {
    /// Where its points and triangles are.
    pub points: Range<usize>,
    pub triangles: Range<usize>,
    pub integrals: Integrals,
    /// Those of the triangles as they are.
    pub plain: Integrals,
    pub reference: Point,
    pub warning: Option<String>,
}

/// What is measured of a face.
struct Measured {
    integrals: Integrals,
    plain: Integrals,
    warning: Option<String>,
}

/// Memory that is filled anew for each face.
#[derive(Default)]
pub(super) struct Scratch {
    border: Border,
    work: Work,
}

/// What becomes of a border.
#[derive(Default)]
pub(super) struct Work {
    pub mapped: Vec<Mapped>,
    pub paths: Paths,
    pub patch: Patch,
    /// The best patch so far, while a finer one is made.
    other: Patch,
    pub room: Room,
    sides: Sides,
}

impl Scratch {
    /// Bytes of memory that it holds.
    pub fn bytes(&self) -> usize {
        let Work { mapped, paths, patch, other, room, sides } = &self.work;
        let made = paths.bytes() + patch.bytes() + other.bytes() + room.bytes() + sides.bytes();
        self.border.bytes() + held(mapped) + made
    }
}

impl Meshes {
    /// Bytes of memory that they hold.
    pub fn bytes(&self) -> usize {
        held(&self.points) + held(&self.triangles) + held(&self.faces)
    }

    /// None, with room for so many faces, and for as many points as triangles.
    pub fn empty(&mut self, faces: usize, points: usize) {
        empty(&mut self.points, points);
        empty(&mut self.triangles, points);
        empty(&mut self.faces, faces);
    }

    /// Tessellates a face, or says why it cannot be.
    pub fn make(
        &mut self,
        context: &Context,
        face: &Face,
        reference: &Point,
        scratch: &mut Scratch,
    ) -> Result<FaceMesh, String> {
        let Measured { integrals, plain, warning } = match &face.geometry {
            FaceGeometry::Trimmed { surface, same_sense } => {
                let Scratch { border, work } = scratch;
                let border = border.fill(face, context.lines, &context.degenerate);
                let border = border.ok_or("a border of too many points")?;
                let surface = &context.model.surfaces[surface.index()];
                trimmed(context, (surface, *same_sense), border, reference, work)
                    .or_else(|why| filled(context, face, border, reference, work, why))?
            }
            FaceGeometry::Faceted(facets) => faceted(facets, reference, &mut scratch.work.patch)?,
        };
        let patch = &scratch.work.patch;
        let (point, triangle) = (self.points.len(), self.triangles.len());
        self.points.extend_from_slice(&patch.points);
        self.triangles.extend_from_slice(&patch.triangles);
        let (points, triangles) = (point..self.points.len(), triangle..self.triangles.len());
        Ok(FaceMesh { points, triangles, integrals, plain, reference: *reference, warning })
    }

    /// Adds the faces of others.
    pub fn append(&mut self, others: Self) {
        let (point, triangle) = (self.points.len(), self.triangles.len());
        self.points.extend(others.points);
        self.triangles.extend(others.triangles);
        let moved = |range: Range<usize>, by: usize| range.start + by..range.end + by;
        let moved = |mesh: FaceMesh| FaceMesh {
            points: moved(mesh.points, point),
            triangles: moved(mesh.triangles, triangle),
            ..mesh
        };
        self.faces.extend(others.faces.into_iter().map(|mesh| mesh.map(moved)));
    }
}

/// Tessellates the part of a surface within a border.
fn trimmed(
    context: &Context,
    (surface, same_sense): (&Surface, bool),
    border: &Border,
    reference: &Point,
    work: &mut Work,
) -> Result<Measured, String> {
    let mut chart = Chart::new(surface, same_sense, border.points(), context.size);
    chart.cancel = Some(context.cancel);
    map_border(&chart, border, context.size, FAR * context.size, &mut work.mapped, &mut work.paths)
        .map_err(|e| format!("an edge is {:.3} mm off the surface", e.distance))?;
    chart.settle(&work.paths, border.seams());
    if work.paths.is_empty() && !chart.is_closed() {
        add_rim(&chart, surface, &mut work.paths).ok_or("the face has no bounds and its surface is infinite")?;
    }
    let first = patch(&chart, &context.fineness, true, reference, work)?;
    Ok(if matches!(*chart.surface, Surface::Plane(_)) {
        first
    } else {
        made_again(context, &chart, first, reference, work)
    })
}

/// Makes a face again while its error is too large and finer triangles help.
fn made_again(context: &Context, chart: &Chart, mut best: Measured, reference: &Point, work: &mut Work) -> Measured {
    let mut fineness = context.fineness;
    let mut off = error(&best, context);
    for _ in 0..REFINEMENTS {
        if off <= 1.0 {
            break;
        }
        // Errors shrink as the deflection does, unless the edges are too coarse.
        let share = (AIM / off).max(FINER);
        fineness = Fineness { deflection: share * fineness.deflection, angle: share.sqrt() * fineness.angle };
        std::mem::swap(&mut work.patch, &mut work.other);
        let finer = patch(chart, &fineness, false, reference, work).map(|finer| (error(&finer, context), finer));
        match finer {
            Ok((finer_off, finer)) if finer_off <= (HELPS * off).max(1.0) => (best, off) = (finer, finer_off),
            worse => {
                let more = work.patch.triangles.len() > work.other.triangles.len();
                std::mem::swap(&mut work.patch, &mut work.other);
                if worse.is_err() || more {
                    break;
                }
            }
        }
    }
    best
}

/// Triangulates what the paths bound, and measures it.
fn patch(
    chart: &Chart,
    fineness: &Fineness,
    quick: bool,
    reference: &Point,
    work: &mut Work,
) -> Result<Measured, String> {
    let Work { paths, patch, room, sides, .. } = work;
    domain::triangulate(chart, paths, fineness, quick, patch, room).ok_or("the loops bound no region")?;
    let integrals = integrate(chart, patch, paths, reference, sides);
    if !(integrals.area.is_finite() && integrals.area > 0.0 && integrals.flux.is_finite()) {
        return Err("the area is not a positive number".to_owned());
    }
    if chart.flipped {
        patch.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    let plain = integrate_triangles(&patch.points, &patch.triangles, reference);
    Ok(Measured { integrals, plain, warning: None })
}

/// How far the triangles are from the surface they stand for, 1 being the most that is taken: their area, and the
/// volume between them and the surface, which is their mean distance times the area.
fn error(measured: &Measured, context: &Context) -> f64 {
    let (plain, exact) = (&measured.plain, &measured.integrals);
    let unseen = UNSEEN * context.size * context.size;
    let area_off = AREA_OFF * context.coarser.powi(3);
    let by_area = (plain.area - exact.area).abs() / (area_off * exact.area).max(unseen);
    let by_distance = (plain.flux - exact.flux).abs() / (context.fineness.deflection * exact.area.max(unseen));
    by_area.max(by_distance)
}

/// Adds the border of the surface's own parameter rectangle.
fn add_rim(chart: &Chart, surface: &Surface, paths: &mut Paths) -> Option<()> {
    let [u0, u1, v0, v1] = surface.domain();
    if ![u0, u1, v0, v1].iter().all(|x| x.is_finite()) {
        return None;
    }
    let corners = [[u0, v0], [u1, v0], [u1, v1], [u0, v1]];
    let path = paths.add();
    for side in 0..4 {
        let (a, b) = (corners[side], corners[(side + 1) % 4]);
        for i in 0..RIM_SEGMENTS {
            let at = |i: f64| -> Uv { [0, 1].map(|k| a[k] + (b[k] - a[k]) * i / RIM_SEGMENTS as f64) };
            path.uv.push(at(i as f64));
            path.middles.push(at(i as f64 + 0.5));
            path.points.push(chart.point(at(i as f64)));
        }
    }
    Some(())
}

/// Fills the border of a face that does not fit its surface with a plane.
fn filled(
    context: &Context,
    face: &Face,
    border: &Border,
    reference: &Point,
    work: &mut Work,
    why: String,
) -> Result<Measured, String> {
    if planar_fill(context, border, work).is_none() {
        return Err(why);
    }
    let integrals = integrate_triangles(&work.patch.points, &work.patch.triangles, reference);
    let warning = Some(format!("face #{}: {why}; its border was filled with a plane", face.entity));
    Ok(Measured { integrals, plain: integrals, warning })
}

fn faceted(facets: &Facets, reference: &Point, patch: &mut Patch) -> Result<Measured, String> {
    let count = facets.points.len() as u32;
    let good = |t: &&[u32; 3]| t.iter().all(|&i| i < count);
    patch.clear();
    patch.points.extend_from_slice(&facets.points);
    patch.triangles.extend(facets.triangles.iter().filter(good));
    let integrals = integrate_triangles(&patch.points, &patch.triangles, reference);
    if !(integrals.area > 0.0 && integrals.area.is_finite()) {
        return Err("the triangles have no area".to_owned());
    }
    Ok(Measured { integrals, plain: integrals, warning: None })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::Placement;
    use crate::geometry::Vector;

    #[test]
    fn a_patch_that_finer_triangles_do_not_help_is_put_back() {
        // Three radians of a cylinder of radius 1, whose rims have one chord each: only finer edges would help.
        let placement = Placement { origin: Point::origin(), x: Vector::x(), y: Vector::y(), z: Vector::z() };
        let surface = Surface::Cylinder { placement, radius: 1.0 };
        let chart = Chart::new(&surface, true, &[], 10.0);
        let (model, cancel, reference) = (Model::empty(), Cancel::new(), Point::origin());
        let fineness = Fineness { deflection: 0.01, angle: 0.3 };
        let mut lines = EdgeLines::default();
        let context = Context {
            model: &model,
            cancel: &cancel,
            lines: &mut lines,
            degenerate: Vec::new(),
            fineness,
            coarser: 1.0,
            size: 10.0,
            reference: Vec::new(),
        };
        let mut work = Work::default();
        let corners = [[0.0, 0.0], [3.0, 0.0], [3.0, 4.0], [0.0, 4.0_f64]];
        let path = work.paths.add();
        for (a, b) in corners.into_iter().zip([1, 2, 3, 0].map(|i| corners[i])) {
            path.uv.push(a);
            path.middles.push([0, 1].map(|k| 0.5 * (a[k] + b[k])));
            path.points.push(chart.point(a));
        }
        // Finer triangles are worse: those along the rims get narrower and stand up.
        let finer = Fineness { deflection: FINER * fineness.deflection, angle: FINER.sqrt() * fineness.angle };
        let worse = patch(&chart, &finer, false, &reference, &mut work).unwrap();
        let first = patch(&chart, &fineness, true, &reference, &mut work).unwrap();
        let (off, plain) = (error(&first, &context), first.plain);
        assert!(off > 1.0 && error(&worse, &context) > off);
        let points = work.patch.points.clone();
        let best = made_again(&context, &chart, first, &reference, &mut work);
        assert_eq!(work.patch.points, points);
        let measured = integrate_triangles(&work.patch.points, &work.patch.triangles, &reference);
        let numbers = |i: &Integrals| [i.area, i.flux];
        assert_eq!([&best.plain, &measured].map(numbers), [numbers(&plain); 2]);
    }
}
