//! Faces that turn about an axis into themselves: discs, rings, full cylinders, cones, caps, tori.

use super::PlacedFaces;
use super::boundary::{Boundary, Loops};
use crate::brep::{FaceId, Surface};
use crate::geometry::revolution::fit_axis;
use crate::geometry::{Axis, Point, Transform, Vector};
use crate::stages::parse::Parsed;

/// Sine between the triangles' normals and the meridian planes that still counts as a surface of revolution:
/// triangles of a coarse tessellation lean by that much.
const LEAN: f64 = 0.1;

/// The axis of a group of faces, in the coordinates of its body, if all its loops are circles about one axis and its
/// surface turns about it too.
pub(super) fn axis(
    parsed: &Parsed,
    places: PlacedFaces,
    group: &[FaceId],
    loops: &Loops,
    placement: &Transform,
    tolerance: f64,
) -> Option<Axis> {
    if loops.iter().any(|l| !l.corners.is_empty()) {
        return None;
    }
    let axis = candidate(parsed, places, group, loops, placement)?;
    let turns = loops.iter().all(|l| is_circle(&l, &axis, tolerance));
    (turns && (is_analytic(parsed, group) || normals_meet(parsed, places, group, &axis, placement))).then_some(axis)
}

/// The only axis the group may have: its surface's own, that of a circle around it, or the one its normals meet.
fn candidate(
    parsed: &Parsed,
    places: PlacedFaces,
    group: &[FaceId],
    loops: &Loops,
    placement: &Transform,
) -> Option<Axis> {
    if let Some(axis) = surface(parsed, group[0]).and_then(surface_axis) {
        return Some(axis);
    }
    if let Some(axis) = loops.iter().find_map(|l| circle_axis(&l)) {
        return Some(axis);
    }
    let (elements, size) = (elements(parsed, places, group), parsed.measures.tolerance.size());
    let (axis, error) = fit_axis(elements.into_iter(), size)?;
    let inverse = placement.inverse()?;
    let local = Axis { point: inverse.point(&axis.point), direction: inverse.direction(&axis.direction) };
    (error < LEAN).then_some(local)
}

fn surface(parsed: &Parsed, face: FaceId) -> Option<&Surface> {
    parsed.model.surface_of(&parsed.model.faces[face.index()]).map(|(surface, _)| surface)
}

/// Whether the face's surface is one that turns about its axis by definition, or a plane or sphere with a circle.
fn is_analytic(parsed: &Parsed, group: &[FaceId]) -> bool {
    let known = |s: &Surface| surface_axis(s).is_some() || matches!(s, Surface::Plane(_) | Surface::Sphere { .. });
    group.iter().all(|&f| surface(parsed, f).is_some_and(known))
}

fn surface_axis(surface: &Surface) -> Option<Axis> {
    match surface {
        Surface::Cylinder { placement, .. }
        | Surface::Cone { placement, .. }
        | Surface::Torus { placement, .. }
        | Surface::Revolution { axis: placement, .. } => Some(Axis { point: placement.origin, direction: placement.z }),
        Surface::Offset { basis, .. } | Surface::Rectangular { basis, .. } => surface_axis(basis),
        _ => None,
    }
}

/// The axis of the circle through three points of a loop, a third of its points apart.
fn circle_axis(boundary: &Boundary) -> Option<Axis> {
    let n = boundary.points.len();
    if n < 6 {
        return None;
    }
    let [a, b, c] = [0, n / 3, 2 * n / 3].map(|i| boundary.points[i]);
    let (u, v) = (b - a, c - a);
    let normal = u.cross(&v);
    let doubled = 2.0 * normal.norm_squared();
    let centre = a + (normal.cross(&u) * v.norm_squared() + v.cross(&normal) * u.norm_squared()) / doubled;
    let axis = Axis { point: centre, direction: normal.try_normalize(0.0)? };
    centre.iter().all(|x| x.is_finite()).then_some(axis)
}

/// Whether all points of the loop have one height along and one distance from the axis.
fn is_circle(boundary: &Boundary, axis: &Axis, tolerance: f64) -> bool {
    let place = |p: &Point| ((p - axis.point).dot(&axis.direction), axis.distance(p));
    let Some((height, radius)) = boundary.points.first().map(place) else { return true };
    boundary.points.iter().map(place).all(|(h, r)| (h - height).abs() <= tolerance && (r - radius).abs() <= tolerance)
}

/// Middle, normal and area of the triangles of the group, in place.
fn elements(parsed: &Parsed, places: PlacedFaces, group: &[FaceId]) -> Vec<(Point, Vector, f64)> {
    let mesh = &parsed.mesh;
    let triangles = group.iter().filter_map(|&f| places.find(f)).flat_map(|f| mesh.triangles_of(f));
    let element = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        let doubled = mesh.doubled_normal(t);
        let area = doubled.norm();
        (area > 0.0).then(|| (Point::from((a.coords + b.coords + c.coords) / 3.0), doubled / area, area))
    };
    triangles.filter_map(element).collect()
}

/// Whether the normals of the triangles meet the axis, by area.
fn normals_meet(parsed: &Parsed, places: PlacedFaces, group: &[FaceId], axis: &Axis, placement: &Transform) -> bool {
    let axis = Axis { point: placement.point(&axis.point), direction: placement.direction(&axis.direction) };
    let elements = elements(parsed, places, group);
    let lean = |(p, n, _): &(Point, Vector, f64)| {
        let across = axis.direction.cross(&axis.radial(p));
        across.try_normalize(0.0).map_or(0.0, |across| across.dot(n))
    };
    let total: f64 = elements.iter().map(|e| e.2).sum();
    let squared: f64 = elements.iter().map(|e| lean(e).powi(2) * e.2).sum();
    squared <= LEAN * LEAN * total
}
