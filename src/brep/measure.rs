//! Area, volume, centroid and bounding box of a model.

use crate::geometry::{Aabb, Point, Tolerance};

/// What a model measures, in its own pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Measures {
    /// Area of all placed faces, mm^2.
    pub area: f64,
    /// Volume of all solids, mm^3; 0 without solids.
    pub volume: f64,
    /// Area centroid.
    pub centroid: Point,
    pub bounds: Aabb,
    /// D = 2 max |p - centroid|.
    pub tolerance: Tolerance,
}
