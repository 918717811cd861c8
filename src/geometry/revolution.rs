//! The axis that a surface turns about into itself, from points and normals.

use super::principal::symmetric_eigen;
use super::{Matrix, Point, Vector};

/// Turns under which a body of revolution stays as it is, radians: no part of a full turn that gears use.
pub const TURNS: [f64; 3] = [0.7, 1.9, 3.7];

/// The rotation by an angle (radians) about a unit direction.
pub fn turn(direction: &Vector, angle: f64) -> Matrix {
    *nalgebra::Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(*direction), angle).matrix()
}

/// A line with a direction whose sign has no meaning: the axis of a body or face of revolution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// A point on it, mm.
    pub point: Point,
    /// Unit.
    pub direction: Vector,
}

impl Axis {
    /// The part of `p - point` at right angles to the axis.
    pub fn radial(&self, p: &Point) -> Vector {
        let d = p - self.point;
        d - self.direction * d.dot(&self.direction)
    }

    /// Distance of `p` from the axis.
    pub fn distance(&self, p: &Point) -> f64 {
        self.radial(p).norm()
    }

    /// The foot of the perpendicular from `p`.
    pub fn project(&self, p: &Point) -> Point {
        p - self.radial(p)
    }

    /// How far the other axis is from being the same line, as (sine of the angle, distance of its point).
    pub fn difference(&self, other: &Self) -> (f64, f64) {
        (self.direction.cross(&other.direction).norm(), self.distance(&other.point))
    }
}

/// The axis met by most normals of a surface: of all velocity fields c x p + d the one along which the weighted
/// surface elements (point, unit normal, weight) move least out of the surface (Pottmann and Wallner,
/// Computational Line Geometry, 2001), taken as a rotation.
///
/// Returns the axis and the root mean square of the normals' speed, as a share of the spread of the points:
/// 0 for a surface of revolution. `None` without elements or where the rotation is not determined.
pub fn fit_axis(elements: impl Iterator<Item = (Point, Vector, f64)> + Clone, scale: f64) -> Option<(Axis, f64)> {
    let total: f64 = elements.clone().map(|e| e.2).sum();
    if !(total > 0.0 && scale > 0.0) {
        return None;
    }
    let mean = Point::from(elements.clone().map(|(p, _, w)| p.coords * w).sum::<Vector>() / total);
    let (mut turning, mut mixed, mut moving) = (Matrix::zeros(), Matrix::zeros(), Matrix::zeros());
    for (p, n, w) in elements {
        let moment = ((p - mean) / scale).cross(&n);
        turning += moment * moment.transpose() * (w / total);
        mixed += moment * n.transpose() * (w / total);
        moving += n * n.transpose() * (w / total);
    }
    // Directions in which no normal points (along a cylinder) do not fix the axis: pseudo-inverse.
    let inverse = moving.pseudo_inverse(1e-6).ok()?;
    let (values, vectors) = symmetric_eigen(&(turning - mixed * inverse * mixed.transpose()));
    let direction = vectors[0];
    let velocity = -(inverse * mixed.transpose() * direction);
    let point = mean + direction.cross(&velocity) * scale;
    let determined = values[1] > 1e-5 && values[1] > 16.0 * values[0].max(0.0);
    determined.then(|| (Axis { point, direction }, values[0].max(0.0).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Elements of a cone of half angle 45 degrees about a line through (1, 2, 3).
    fn cone(direction: Vector) -> Vec<(Point, Vector, f64)> {
        let x = crate::geometry::any_perpendicular(&direction);
        let y = direction.cross(&x);
        let element = |i: usize| {
            let angle = i as f64 * 2.399;
            let out = x * angle.cos() + y * angle.sin();
            let height = 1.0 + (i % 7) as f64;
            let p = Point::new(1.0, 2.0, 3.0) + direction * height + out * height;
            (p, (out - direction).normalize(), 1.0)
        };
        (0..300).map(element).collect()
    }

    #[test]
    fn the_axis_of_a_cone_is_found() {
        let direction = Vector::new(1.0, -2.0, 2.0) / 3.0;
        let (axis, error) = fit_axis(cone(direction).into_iter(), 10.0).unwrap();
        assert!(error < 1e-6, "{error}");
        assert!(axis.direction.cross(&direction).norm() < 1e-9);
        assert!(axis.distance(&Point::new(1.0, 2.0, 3.0)) < 1e-9);
    }

    #[test]
    fn a_sphere_has_no_single_axis() {
        let element = |i: usize| {
            let z = (i as f64 + 0.5) / 150.0 - 1.0;
            let (r, angle) = ((1.0 - z * z).sqrt(), i as f64 * 2.399_963);
            let n = Vector::new(r * angle.cos(), r * angle.sin(), z);
            (Point::from(n), n, 1.0)
        };
        assert!(fit_axis((0..300).map(element), 2.0).is_none());
    }
}
