//! Canonical frames.

use super::{Point, Vector};

/// Three orthonormal axes and an origin. `axes[0]` is the normal of the first canonical plane, and so on;
/// the sign of each axis has no meaning, so a frame may be left-handed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Orthonormal, their signs without meaning.
    pub axes: [Vector; 3],
    /// Where the planes meet, mm.
    pub origin: Point,
}

impl Frame {
    /// The frame whose axes are (first, second made orthogonal to it, their cross product).
    pub fn from_two(origin: Point, first: &Vector, second: &Vector) -> Self {
        let a = first.normalize();
        let b = (second - a * a.dot(second)).normalize();
        Self { axes: [a, b, a.cross(&b)], origin }
    }

    /// Coordinates of `p` in the frame.
    pub fn coordinates(&self, p: &Point) -> [f64; 3] {
        let d = p - self.origin;
        self.axes.map(|axis| axis.dot(&d))
    }

    /// The largest angle between axes of the same index, radians, signs ignored.
    pub fn angle_to(&self, other: &Self) -> f64 {
        let angle = |i: usize| {
            let (a, b) = (&self.axes[i], &other.axes[i]);
            a.cross(b).norm().atan2(a.dot(b).abs())
        };
        (0..3).map(angle).fold(0.0, f64::max)
    }
}
