//! Candidate planes from faces that have centroids and axes but no corners.

use super::{Candidate, Source};
use crate::brep::measure::Measures;
use crate::geometry::{Axis, Plane, Point};
use crate::stages::corner_filter::Outline;

/// Two axes are one, and a point is on an axis, within this share of D (and this sine).
const SAME_LINE: f64 = 1e-3;
/// Faces beside an axis whose centroids are tried together with it.
const FACES: usize = 12;

/// The plane that swaps the centroids of two faces, if it also maps the axis of one to that of the other.
pub(super) fn bisector(a: &Outline, b: &Outline, size: f64) -> Option<Plane> {
    let between = b.centroid - a.centroid;
    if between.norm() <= SAME_LINE * size {
        return None;
    }
    let plane = Plane::through(&nalgebra::center(&a.centroid, &b.centroid), &between);
    let agree = match (&a.axis, &b.axis) {
        (Some(p), Some(q)) => plane.reflect_vector(&p.direction).cross(&q.direction).norm() <= 10.0 * SAME_LINE,
        _ => true,
    };
    agree.then_some(plane)
}

/// An axis with the faces that turn about it.
#[derive(Clone, Copy, Debug)]
struct Spindle {
    axis: Axis,
    area: f64,
    /// Centroid of its faces.
    centroid: Point,
}

/// The planes that the largest axes suggest: through two of them, through one and the centroid of another face, and
/// across one in the middle of its faces or of the model.
pub(super) fn planes(measures: &Measures, outlines: &[Outline], count: usize) -> Vec<Candidate> {
    let size = measures.tolerance.size();
    let mut spindles = spindles(outlines, size);
    spindles.truncate(count);
    let mut planes = Vec::new();
    let mut add = |plane: Option<Plane>, area: f64| {
        planes.extend(plane.map(|plane| Candidate {
            plane,
            residual: 0.0,
            weight: area,
            source: Source::Axes,
            pair: None,
            halfway: false,
        }));
    };
    let off = off_axis(outlines);
    for (i, spindle) in spindles.iter().enumerate() {
        let (axis, area) = (&spindle.axis, spindle.area);
        add(Some(Plane::through(&spindle.centroid, &axis.direction)), area);
        add(Some(Plane::through(&measures.centroid, &axis.direction)), area);
        add(through(axis, &measures.centroid, size), area);
        spindles[..i].iter().for_each(|other| add(common(axis, &other.axis, size), area.min(other.area)));
        off.iter().for_each(|face| add(through(axis, &face.centroid, size), area.min(face.area)));
    }
    planes
}

/// The axes of the model by area, largest first.
fn spindles(outlines: &[Outline], size: f64) -> Vec<Spindle> {
    let mut found: Vec<Spindle> = Vec::new();
    for (outline, axis) in outlines.iter().filter_map(|o| Some((o, o.axis?))) {
        let same = |s: &&mut Spindle| {
            let (sine, distance) = s.axis.difference(&Axis { point: outline.centroid, ..axis });
            sine <= SAME_LINE && distance <= SAME_LINE * size
        };
        if let Some(spindle) = found.iter_mut().find(same) {
            let share = outline.area / (spindle.area + outline.area);
            spindle.centroid += (outline.centroid - spindle.centroid) * share;
            spindle.area += outline.area;
        } else if found.len() < MOST_AXES {
            found.push(Spindle { axis, area: outline.area, centroid: outline.centroid });
        }
    }
    found.sort_by(|s, t| t.area.total_cmp(&s.area));
    found
}

/// Axes told apart at most: a plate with ten thousand holes must not cost their square.
const MOST_AXES: usize = 256;

/// The largest faces without an axis.
fn off_axis(outlines: &[Outline]) -> Vec<&Outline> {
    let mut faces: Vec<_> = outlines.iter().filter(|o| o.axis.is_none()).collect();
    faces.sort_by(|a, b| b.area.total_cmp(&a.area));
    faces.truncate(FACES);
    faces
}

/// The plane that contains the axis and a point beside it.
fn through(axis: &Axis, p: &Point, size: f64) -> Option<Plane> {
    let radial = axis.radial(p);
    (radial.norm() > SAME_LINE * size).then(|| Plane::through(&axis.point, &axis.direction.cross(&radial)))
}

/// The plane that contains both axes, if there is exactly one.
fn common(a: &Axis, b: &Axis, size: f64) -> Option<Plane> {
    let across = a.direction.cross(&b.direction);
    if across.norm() <= SAME_LINE {
        return through(a, &b.point, size);
    }
    let plane = Plane::through(&a.point, &across);
    (plane.signed_distance(&b.point).abs() <= SAME_LINE * size).then_some(plane)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vector;

    #[test]
    fn parallel_and_crossing_axes_have_a_common_plane_and_skew_ones_none() {
        let axis = |point: [f64; 3], direction: Vector| Axis { point: Point::from(point), direction };
        let z = axis([0.0; 3], Vector::z());
        let parallel = common(&z, &axis([0.0, 3.0, 1.0], Vector::z()), 10.0).unwrap();
        assert!(parallel.normal.x.abs() > 1.0 - 1e-12 && parallel.offset.abs() < 1e-12);
        let crossing = common(&z, &axis([0.0, 0.0, 5.0], Vector::x()), 10.0).unwrap();
        assert!(crossing.normal.y.abs() > 1.0 - 1e-12);
        assert!(common(&z, &axis([0.0, 1.0, 0.0], Vector::x()), 10.0).is_none());
        assert!(common(&z, &axis([0.0, 0.0, 7.0], -Vector::z()), 10.0).is_none());
    }
}
