//! Points, planes, isometries and trees of triangles: a leaf that knows nothing of CAD.
//!
//! Lengths are millimetres and angles radians everywhere inside the crate.

pub mod aabb;
pub mod bvh;
pub mod cells;
pub mod directions;
pub mod frame;
pub mod isometry;
pub mod order;
pub mod plane;
pub mod plane_index;
pub mod point_grid;
pub mod polygon;
pub mod principal;
pub mod revolution;
pub mod sides;
pub mod tolerance;
pub mod transform;

pub use aabb::Aabb;
pub use frame::Frame;
pub use isometry::{Chirality, Isometry};
pub use plane::Plane;
pub use plane_index::PlaneIndex;
pub use point_grid::PointGrid;
pub use revolution::Axis;
pub use tolerance::Tolerance;
pub use transform::Transform;

/// A point in space, mm.
pub type Point = nalgebra::Point3<f64>;
/// A vector in space, mm, or a direction without unit.
pub type Vector = nalgebra::Vector3<f64>;
/// A point in a parameter domain or a picture plane.
pub type Point2 = nalgebra::Point2<f64>;
/// A vector in a parameter domain or a picture plane.
pub type Vector2 = nalgebra::Vector2<f64>;
/// A 3 by 3 matrix.
pub type Matrix = nalgebra::Matrix3<f64>;

/// Some direction at right angles to `v` (a unit vector), the same for the same `v`.
pub fn any_perpendicular(v: &Vector) -> Vector {
    let least = if v.x.abs() <= v.y.abs() && v.x.abs() <= v.z.abs() {
        Vector::x()
    } else if v.y.abs() <= v.z.abs() {
        Vector::y()
    } else {
        Vector::z()
    };
    (least - v * v.dot(&least)).normalize()
}
