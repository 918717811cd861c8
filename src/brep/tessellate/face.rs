//! One face -> its triangles and integrals, in the coordinates of its body.

use super::Few;
use super::boundary::{self, Border, Path};
use super::chart::{Chart, Uv};
use super::domain::{self, Patch};
use super::edges::{EdgeLines, Fineness};
use super::fallback::planar_fill;
use super::integrate::{Integrals, integrate, integrate_triangles};
use crate::brep::{Face, FaceGeometry, Facets, Model, Surface};
use crate::cancel::Cancel;
use crate::geometry::Point;

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
    pub lines: EdgeLines,
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

/// A tessellated face.
pub(super) struct FaceMesh {
    pub points: Vec<Point>,
    /// Counter-clockwise seen from the face normal's side.
    pub triangles: Vec<[u32; 3]>,
    pub integrals: Integrals,
    /// Those of the triangles as they are.
    pub plain: Integrals,
    pub reference: Point,
    pub warning: Option<String>,
}

/// Tessellates a face, or says why it cannot be.
pub(super) fn mesh(context: &Context, face: &Face, reference: &Point) -> Result<FaceMesh, String> {
    let (surface, same_sense) = match &face.geometry {
        FaceGeometry::Trimmed { surface, same_sense } => (surface, *same_sense),
        FaceGeometry::Faceted(facets) => return faceted(facets, reference),
    };
    let edges = border(context, face)?;
    let mut chart = Chart::new(surface, same_sense, &edges.loops, context.size);
    chart.cancel = Some(context.cancel);
    match trimmed(context, surface, &mut chart, edges, reference) {
        Ok(mesh) => Ok(mesh),
        Err(why) => filled(context, face, border(context, face)?.loops, reference, &why),
    }
}

fn border(context: &Context, face: &Face) -> Result<Border, String> {
    Ok(Border::of(face, &context.lines, &context.degenerate).ok_or("a border of too many points")?)
}

fn trimmed(
    context: &Context,
    surface: &Surface,
    chart: &mut Chart,
    border: Border,
    reference: &Point,
) -> Result<FaceMesh, String> {
    let far = FAR * context.size;
    let mut paths = boundary::paths(chart, border.loops, context.size, far)
        .map_err(|e| format!("an edge is {:.3} mm off the surface", e.distance))?;
    chart.settle(&paths, border.seams);
    if paths.is_empty() && !chart.is_closed() {
        paths.push(rim(chart, surface).ok_or("the face has no bounds and its surface is infinite")?);
    }
    let mut best = patch(chart, &mut paths, &context.fineness, true, reference)?;
    if matches!(*chart.surface, Surface::Plane(_)) {
        return Ok(best);
    }
    let mut fineness = context.fineness;
    let mut off = error(&best, context);
    for _ in 0..REFINEMENTS {
        if off <= 1.0 {
            break;
        }
        // Errors shrink as the deflection does, unless the edges are too coarse.
        let share = (AIM / off).max(FINER);
        fineness = Fineness { deflection: share * fineness.deflection, angle: share.sqrt() * fineness.angle };
        let Ok(finer) = patch(chart, &mut paths, &fineness, false, reference) else { break };
        let finer_off = error(&finer, context);
        if finer_off <= (HELPS * off).max(1.0) {
            (best, off) = (finer, finer_off);
        } else if finer.triangles.len() > best.triangles.len() {
            break;
        }
    }
    Ok(best)
}

fn patch(
    chart: &Chart,
    paths: &mut [Path],
    fineness: &Fineness,
    quick: bool,
    reference: &Point,
) -> Result<FaceMesh, String> {
    let patch = domain::triangulate(chart, paths, fineness, quick).ok_or("the loops bound no region")?;
    let integrals = integrate(chart, &patch, paths, reference);
    if !(integrals.area.is_finite() && integrals.area > 0.0 && integrals.flux.is_finite()) {
        return Err("the area is not a positive number".to_owned());
    }
    let turn = |t: [u32; 3]| if chart.flipped { [t[0], t[2], t[1]] } else { t };
    let triangles: Vec<_> = patch.triangles.into_iter().map(turn).collect();
    let plain = integrate_triangles(&patch.points, &triangles, reference);
    Ok(FaceMesh { points: patch.points, triangles, integrals, plain, reference: *reference, warning: None })
}

/// How far the triangles are from the surface they stand for, 1 being the most that is taken: their area, and the
/// volume between them and the surface, which is their mean distance times the area.
fn error(mesh: &FaceMesh, context: &Context) -> f64 {
    let (plain, exact) = (&mesh.plain, &mesh.integrals);
    let unseen = UNSEEN * context.size * context.size;
    let area_off = AREA_OFF * context.coarser.powi(3);
    let by_area = (plain.area - exact.area).abs() / (area_off * exact.area).max(unseen);
    let by_distance = (plain.flux - exact.flux).abs() / (context.fineness.deflection * exact.area.max(unseen));
    by_area.max(by_distance)
}

/// The border of the surface's own parameter rectangle.
fn rim(chart: &Chart, surface: &Surface) -> Option<Path> {
    let [u0, u1, v0, v1] = surface.domain();
    if ![u0, u1, v0, v1].iter().all(|x| x.is_finite()) {
        return None;
    }
    let corners = [[u0, v0], [u1, v0], [u1, v1], [u0, v1]];
    let mut path = Path::default();
    for side in 0..4 {
        let (a, b) = (corners[side], corners[(side + 1) % 4]);
        for i in 0..RIM_SEGMENTS {
            let at = |i: f64| -> Uv { [0, 1].map(|k| a[k] + (b[k] - a[k]) * i / RIM_SEGMENTS as f64) };
            path.uv.push(at(i as f64));
            path.middles.push(at(i as f64 + 0.5));
            path.points.push(chart.point(at(i as f64)));
        }
    }
    Some(path)
}

fn filled(
    context: &Context,
    face: &Face,
    borders: Few<[Vec<Point>; 2]>,
    reference: &Point,
    why: &str,
) -> Result<FaceMesh, String> {
    let patch = planar_fill(borders, context).ok_or_else(|| why.to_owned())?;
    let integrals = integrate_triangles(&patch.points, &patch.triangles, reference);
    let warning = Some(format!("face #{}: {why}; its border was filled with a plane", face.entity));
    let Patch { points, triangles, .. } = patch;
    Ok(FaceMesh { points, triangles, integrals, plain: integrals, reference: *reference, warning })
}

fn faceted(facets: &Facets, reference: &Point) -> Result<FaceMesh, String> {
    let count = facets.points.len() as u32;
    let good = |t: &&[u32; 3]| t.iter().all(|&i| i < count);
    let triangles: Vec<_> = facets.triangles.iter().filter(good).copied().collect();
    let integrals = integrate_triangles(&facets.points, &triangles, reference);
    if !(integrals.area > 0.0 && integrals.area.is_finite()) {
        return Err("the triangles have no area".to_owned());
    }
    let points = facets.points.clone();
    Ok(FaceMesh { points, triangles, integrals, plain: integrals, reference: *reference, warning: None })
}
