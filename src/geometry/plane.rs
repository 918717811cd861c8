//! Planes and the reflections in them.

use super::{Isometry, Point, Transform, Vector};

/// The plane of points with `normal . p = offset`; the normal has length 1.
///
/// (n, d) and (-n, -d) are the same plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Unit.
    pub normal: Vector,
    /// Signed distance of the origin from the plane, against the normal, mm.
    pub offset: f64,
}

impl Plane {
    /// The plane through `point` at right angles to `normal` (any length above 0).
    pub fn through(point: &Point, normal: &Vector) -> Self {
        let normal = normal.normalize();
        Self { normal, offset: normal.dot(&point.coords) }
    }

    /// Signed distance of `p`, positive on the normal's side, mm.
    pub fn signed_distance(&self, p: &Point) -> f64 {
        self.normal.dot(&p.coords) - self.offset
    }

    /// The mirror image of `p`.
    pub fn reflect(&self, p: &Point) -> Point {
        p - self.normal * (2.0 * self.signed_distance(p))
    }

    /// The mirror image of a direction.
    pub fn reflect_vector(&self, v: &Vector) -> Vector {
        v - self.normal * (2.0 * self.normal.dot(v))
    }

    /// The foot of the perpendicular from `p`.
    pub fn project(&self, p: &Point) -> Point {
        p - self.normal * self.signed_distance(p)
    }

    /// Angle between the planes in radians, 0 to pi/2; the sign of the normals does not matter.
    pub fn angle_to(&self, other: &Self) -> f64 {
        let sine = self.normal.cross(&other.normal).norm();
        sine.atan2(self.normal.dot(&other.normal).abs())
    }

    /// The reflection as an isometry.
    pub fn reflection(&self) -> Isometry {
        Isometry::reflection(self)
    }

    /// The plane carried along by a similarity.
    pub fn transformed(&self, by: &Transform) -> Self {
        let foot = Point::from(self.normal * self.offset);
        Self::through(&by.point(&foot), &by.direction(&self.normal))
    }

    /// The same plane with the first component of the normal that is not near zero positive.
    pub fn canonical(&self) -> Self {
        let lead = self.normal.iter().copied().find(|c| c.abs() > 1e-9).unwrap_or(1.0);
        if lead < 0.0 { Self { normal: -self.normal, offset: -self.offset } } else { *self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_mirrored_across_the_plane() {
        let plane = Plane::through(&Point::new(1.0, 0.0, 0.0), &Vector::new(2.0, 0.0, 0.0));
        assert_eq!(plane.reflect(&Point::new(4.0, 5.0, 6.0)), Point::new(-2.0, 5.0, 6.0));
        assert_eq!(plane.signed_distance(&Point::new(4.0, 5.0, 6.0)), 3.0);
    }

    #[test]
    fn opposite_normals_are_the_same_plane() {
        let plane = Plane { normal: -Vector::z(), offset: 2.0 };
        assert_eq!(plane.canonical(), Plane { normal: Vector::z(), offset: -2.0 });
        assert!(plane.angle_to(&plane.canonical()) < 1e-15);
    }
}
