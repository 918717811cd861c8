//! Bodies of revolution: their axis, and which of their infinitely many planes are reported.

use super::open::missed;
use super::principal::{candidate, polish};
use super::{Merger, SymmetryPlane};
use crate::cancel::Cancelled;
use crate::geometry::revolution::{TURNS, fit_axis, turn};
use crate::geometry::{Axis, Isometry, Plane, Vector, any_perpendicular};
use crate::stages::isometry::Source;
use crate::stages::validate::support::Round;

/// Support from which nothing tells the planes through the axis apart: the samples of 4,000 that rounding may cost.
const WHOLE: f64 = 0.998;
/// An axis of a face is the fitted one within this sine and share of D.
const SNAP: (f64, f64) = (0.03, 0.02);

/// The axis of a body of revolution, if the model is one.
pub(super) fn axes(merger: &Merger) -> Result<Vec<Axis>, Cancelled> {
    let (measures, field) = (&merger.parsed.measures, &merger.validated.field);
    let elements = field.samples(Round::Middle).iter().map(|s| (s.point, s.normal, 1.0));
    let Some((fitted, error)) = fit_axis(elements, measures.tolerance.size()) else { return of_sphere(merger) };
    if error > 0.05 {
        return Ok(Vec::new());
    }
    for candidate in [of_faces, polished] {
        if let Some(axis) = candidate(merger, &fitted)
            && turns(merger, &axis)?
        {
            return Ok(vec![axis]);
        }
    }
    Ok(Vec::new())
}

/// Spheres about one centre turn about every line through it; the file's z axis stands for all of them.
fn of_sphere(merger: &Merger) -> Result<Vec<Axis>, Cancelled> {
    let axis = |direction: Vector| Axis { point: merger.parsed.measures.centroid, direction };
    let (z, x) = (axis(Vector::z()), axis(Vector::x()));
    Ok(if turns(merger, &z)? && turns(merger, &x)? { vec![z] } else { Vec::new() })
}

/// The exact axis of the largest face of revolution near the fitted one.
fn of_faces(merger: &Merger, fitted: &Axis) -> Option<Axis> {
    let size = merger.parsed.measures.tolerance.size();
    let near = |axis: &Axis| {
        let (sine, distance) = fitted.difference(axis);
        sine <= SNAP.0 && distance <= SNAP.1 * size
    };
    let faces = merger.outlines.iter().filter_map(|o| Some((o, o.axis?))).filter(|(_, axis)| near(axis));
    let (_, axis) = faces.max_by(|(a, _), (b, _)| a.area.total_cmp(&b.area))?;
    // The foot of the centroid is a point that moves with the model.
    Some(Axis { point: axis.project(&merger.parsed.measures.centroid), ..axis })
}

/// The fitted axis, made better as the line in which two polished planes through it meet.
fn polished(merger: &Merger, fitted: &Axis) -> Option<Axis> {
    // What does not nearly turn about the fitted axis turns about no other.
    missed(merger, &rotation(fitted, TURNS[0]))?;
    let first = any_perpendicular(&fitted.direction);
    let plane = |n: &Vector| polish(merger, Plane::through(&fitted.point, n), 0.9, |_| true);
    let (p, q) = (plane(&first)?.0, plane(&fitted.direction.cross(&first))?.0);
    let direction = p.normal.cross(&q.normal).try_normalize(0.1)?;
    let centroid = merger.parsed.measures.centroid;
    let point = centroid - p.normal * p.signed_distance(&centroid);
    // The planes stand nearly at right angles: two rounds of projection settle the point.
    let point = (0..8).fold(point, |x, _| q.project(&p.project(&x)));
    Some(Axis { point, direction })
}

/// Whether turning about the axis maps the surface onto itself.
fn turns(merger: &Merger, axis: &Axis) -> Result<bool, Cancelled> {
    let (field, needed) = (&merger.validated.field, merger.options.revolution);
    for angle in TURNS {
        let turn = rotation(axis, angle);
        if field.reaches(&turn, needed - 0.02).is_none() || field.middle(&turn, needed, merger.cancel)?.share < needed {
            return Ok(false);
        }
    }
    Ok(true)
}

fn rotation(axis: &Axis, angle: f64) -> Isometry {
    Isometry::about(&axis.point, &turn(&axis.direction, angle))
}

/// For a body of revolution: of the planes through the axis keeps one, and adds the plane across in the middle. Where
/// turning costs some of the surface (a small keyway), planes that map all of it are more than one of many.
pub(super) fn restrict(merger: &Merger, axes: &[Axis], pool: &mut Vec<SymmetryPlane>) -> Result<(), Cancelled> {
    let Some(axis) = axes.first() else { return Ok(()) };
    let turn = rotation(axis, TURNS[0]);
    if merger.validated.field.middle(&turn, WHOLE, merger.cancel)?.share >= WHOLE {
        pool.clear();
    } else {
        pool.retain(|p| p.coverage >= WHOLE);
    }
    let centroid = merger.parsed.measures.centroid;
    let through = Plane::through(&axis.point, &direction_across(merger, axis));
    let across = Plane::through(&centroid, &axis.direction);
    for plane in [through, across] {
        if let Some(coverage) = merger.validated.field.reaches(&plane.reflection(), merger.options.partial) {
            pool.push(SymmetryPlane { source: Source::Axes, ..candidate(plane, coverage, 0.0) });
        }
    }
    Ok(())
}

/// Spreads across the axis that differ by less than this share are equal: what the triangles miss of a round body.
const ROUND: f64 = 0.005;

/// A direction at right angles to the axis: the one along which the surface spreads most. Where it spreads equally the
/// body cannot tell them apart, but its mesh can, a polygon across the axis: one towards a corner of that, so that the
/// shadows are the same in every pose.
fn direction_across(merger: &Merger, axis: &Axis) -> Vector {
    let first = any_perpendicular(&axis.direction);
    let second = axis.direction.cross(&first);
    let (cx, cy) = (merger.covariance * first, merger.covariance * second);
    let (xx, xy, yy) = (first.dot(&cx), first.dot(&cy), second.dot(&cy));
    let (cosine, sine, spread) = (xx - yy, 2.0 * xy, xx + yy);
    let corners = merger.parsed.mesh.points.iter().map(|p| axis.radial(p));
    let farthest = corners.max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
    if cosine.hypot(sine) <= ROUND * spread
        && let Some(corner) = farthest.and_then(|corner| corner.try_normalize(0.0))
    {
        return corner;
    }
    let angle = 0.5 * f64::atan2(sine, cosine);
    first * angle.cos() + second * angle.sin()
}
