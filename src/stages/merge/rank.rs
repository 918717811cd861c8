//! The order of planes: by support, and where that ties, by what no pose changes.

use super::{Merger, SymmetryPlane};
use crate::alignment::triangles;
use crate::cancel::Cancelled;
use crate::geometry::{Plane, Vector, any_perpendicular};
use crate::silhouette::draw::Raster;
use crate::stages::isometry::Source;
use crate::stages::validate::support::Round;

/// Tied planes whose silhouettes are drawn, those with the smallest mean shadow.
const DRAWN: usize = 16;
/// Pixels along a side of them.
const PIXELS: usize = 256;
/// Silhouettes closer than this (relative) are equal: a few rows of pixels.
const EQUAL_AREA: f64 = 0.02;
/// Silhouettes that differ by more than this are not those of planes that the model maps onto each other.
const UNLIKE_AREA: f64 = 0.004;

/// Sorts the measured planes, best first, and drops those that only the principal axes suggest unless they are as
/// good as the best: their place below it is an accident of the starting direction.
pub(super) fn ordered(merger: &Merger, mut pool: Vec<SymmetryPlane>) -> Result<Vec<SymmetryPlane>, Cancelled> {
    pool.sort_by(|a, b| b.coverage.total_cmp(&a.coverage));
    let best = pool.first().map_or(0.0, |p| p.coverage);
    let tied = |p: &SymmetryPlane| p.coverage >= best - merger.options.tie;
    pool.retain(|p| tied(p) || !matches!(p.source, Source::Principal | Source::Axes));
    let copies: Vec<_> = pool.iter().map(|p| is_copy(merger, p, &pool)).collect();
    let mut copies = copies.into_iter();
    pool.retain(|_| !copies.next().unwrap_or(false));
    let rest = pool.split_off(pool.partition_point(tied));
    let mut ordered = settled(merger, pool)?;
    ordered.extend(rest);
    Ok(ordered)
}

/// Planes at a larger angle (radians) are never one: they meet again in half a turn of 60.
const COPY_ANGLE: f64 = 0.05;

/// Whether a plane of a more reliable source does the same to the surface, as far as support can tell: on a slender
/// body a plane may turn about the long axis by a degree. Sources without corners are not exact.
fn is_copy(merger: &Merger, plane: &SymmetryPlane, pool: &[SymmetryPlane]) -> bool {
    let field = &merger.validated.field;
    let samples = field.samples(Round::Coarse);
    let apart = |other: &SymmetryPlane| {
        let gap = |s: &crate::brep::sample::Sample| {
            (plane.plane.reflect(&s.point) - other.plane.reflect(&s.point)).norm_squared()
        };
        (samples.iter().map(gap).sum::<f64>() / samples.len().max(1) as f64).sqrt()
    };
    pool.iter().any(|other| {
        other.source < plane.source
            && other.coverage >= plane.coverage - merger.options.tie
            && other.plane.angle_to(&plane.plane) <= COPY_ANGLE
            && apart(other) <= field.radius()
    })
}

/// Orders planes of equal support.
fn settled(merger: &Merger, tied: Vec<SymmetryPlane>) -> Result<Vec<SymmetryPlane>, Cancelled> {
    if tied.len() < 2 {
        return Ok(tied);
    }
    let mut keyed: Vec<_> = tied.into_iter().map(|p| (Key::of(merger, &p), p)).collect();
    keyed.sort_by(|a, b| a.0.shadow.total_cmp(&b.0.shadow));
    for (key, plane) in keyed.iter_mut().take(DRAWN) {
        key.silhouette = shadow_along(merger, &plane.plane)?;
    }
    let mut ordered = Vec::new();
    while !keyed.is_empty() {
        let first = first_of(&keyed);
        ordered.push(keyed.remove(first).1);
    }
    Ok(ordered)
}

/// Area of the model's shadow along the normal of a plane, mm^2, by pixels.
fn shadow_along(merger: &Merger, plane: &Plane) -> Result<f64, Cancelled> {
    let (wireframe, measures) = (&merger.parsed.wireframe, &merger.parsed.measures);
    let scale = PIXELS as f64 / measures.tolerance.size();
    let raster = Raster { centre: measures.centroid, scale, side: PIXELS };
    let right = any_perpendicular(&plane.normal);
    let [x, y] = [right, plane.normal.cross(&right)].map(|axis| raster.project(wireframe, &axis));
    let picture = raster.draw(wireframe, [&x, &y], merger.cancel)?;
    Ok(picture.area() as f64 / (scale * scale))
}

/// What settles a tie, in this order.
struct Key {
    /// Area of the shadow along the normal, mm^2; infinite where not drawn.
    silhouette: f64,
    /// In steps of 1e-5 D.
    residual: i64,
    /// From the centroid, in steps of 1e-4 D.
    distance: i64,
    /// Mean |cosine| of the surface normals with the plane's: half the shadow of a convex body.
    shadow: f64,
    /// Mean squared distance of the surface from the plane, a share of D^2.
    moment: f64,
}

impl Key {
    fn of(merger: &Merger, plane: &SymmetryPlane) -> Self {
        let measures = &merger.parsed.measures;
        let size = measures.tolerance.size();
        let (mesh, normal): (_, Vector) = (&merger.parsed.mesh, plane.plane.normal);
        let (mut facing, mut area) = (0.0, 0.0);
        for (_, facet, size) in triangles(mesh) {
            facing += size * facet.dot(&normal).abs();
            area += size;
        }
        let distance = plane.plane.signed_distance(&measures.centroid);
        let steps = |x: f64, step: f64| (x / (step * size)).round() as i64;
        Self {
            silhouette: f64::INFINITY,
            residual: steps(plane.residual, 1e-5),
            distance: steps(distance.abs(), 1e-4),
            shadow: facing / area,
            moment: (normal.dot(&(merger.covariance * normal)) + distance.powi(2)) / (size * size),
        }
    }
}

/// Position of the plane that comes first: the smallest silhouette, and of equal ones the next criterion.
fn first_of(keyed: &[(Key, SymmetryPlane)]) -> usize {
    let smallest = keyed.iter().map(|(k, _)| k.silhouette).fold(f64::INFINITY, f64::min);
    let equal = |k: &Key| k.silhouette <= smallest * (1.0 + EQUAL_AREA);
    let mut best: Option<usize> = None;
    for i in (0..keyed.len()).filter(|&i| equal(&keyed[i].0)) {
        if best.is_none_or(|b| before(&keyed[i], &keyed[b])) {
            best = Some(i);
        }
    }
    best.unwrap_or(0)
}

/// Whether `a` comes before `b` although their silhouettes are equal.
fn before((a, p): &(Key, SymmetryPlane), (b, q): &(Key, SymmetryPlane)) -> bool {
    let coarse = |k: &Key| (k.residual, k.distance);
    if coarse(a) != coarse(b) {
        return coarse(a) < coarse(b);
    }
    for (x, y) in [(a.shadow, b.shadow), (a.moment, b.moment)] {
        if (x - y).abs() > 1e-3 {
            return x < y;
        }
    }
    if (a.silhouette / b.silhouette - 1.0).abs() > UNLIKE_AREA {
        return a.silhouette < b.silhouette;
    }
    // Nothing tells them apart but the coordinates: images of each other under a symmetry of the model.
    let (n, m) = (p.plane.canonical().normal, q.plane.canonical().normal);
    n.iter().zip(m.iter()).map(|(x, y)| y.total_cmp(x)).find(|o| o.is_ne()).is_some_and(|o| o.is_lt())
}
