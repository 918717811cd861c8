//! Where a picture is taken from.

use crate::brep::Mesh;
use crate::brep::measure::Measures;
use crate::geometry::order::{less, more};
use crate::geometry::{Frame, Point, Vector};

/// A parallel projection onto a square picture.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    right: Vector,
    up: Vector,
    toward: Vector,
    centre: Point,
    middle: f64,
    scale: f64,
}

/// The eye in a frame's (right, forward, up): a little more from the front and from above than the cube's corner.
const EYE: [f64; 3] = [0.55, 0.8, 0.5];
/// Half the picture's width is this many bounding radii.
const MARGIN: f64 = 1.02;

impl Camera {
    /// Looks from a corner of the frame, its third axis up, at a picture of `side` samples.
    ///
    /// The axes of a frame have no signs; here each points away from the model's heavier end, so that things stand on
    /// their feet, and the three are right-handed, so that no picture is mirrored.
    pub fn from_corner(mesh: &Mesh, measures: &Measures, frame: &Frame, side: usize) -> Self {
        let up = frame.axes[2] * lighter_end(mesh, measures, &frame.axes[2]);
        let forward = frame.axes[1] * -lighter_end(mesh, measures, &frame.axes[1]);
        let toward = (up.cross(&forward) * EYE[0] + forward * EYE[1] + up * EYE[2]).normalize();
        let right = up.cross(&toward).normalize();
        let (low, high) = extent(mesh, measures, &right);
        let (bottom, top) = extent(mesh, measures, &toward.cross(&right));
        let half = (0.5 * (high - low).max(top - bottom)).max(f64::MIN_POSITIVE);
        let middle = 0.5 * side as f64;
        Self {
            right,
            up: toward.cross(&right),
            toward,
            centre: measures.centroid + right * (0.5 * (low + high)) + toward.cross(&right) * (0.5 * (bottom + top)),
            middle,
            scale: middle / (MARGIN * half),
        }
    }

    /// Where a point lies in the picture: samples to the right, samples down, mm towards the eye.
    pub fn project(&self, p: &Point) -> [f64; 3] {
        let d = p - self.centre;
        [self.middle + self.scale * self.right.dot(&d), self.middle - self.scale * self.up.dot(&d), self.toward.dot(&d)]
    }

    /// The direction towards the lamp: over the eye's left shoulder.
    pub fn lamp(&self) -> Vector {
        (self.toward * 0.8 + self.up * 0.55 - self.right * 0.25).normalize()
    }

    /// The axis, or its opposite: whichever points towards the eye.
    pub fn facing(&self, axis: &Vector) -> Vector {
        if axis.dot(&self.toward) < 0.0 { -axis } else { *axis }
    }

    /// Shows as much around the same point as these points need to be seen.
    pub fn including(self, points: &[Point]) -> Self {
        let reach = |p: &Point| {
            let [x, y, _] = self.project(p);
            (x - self.middle).abs().max((y - self.middle).abs()) * MARGIN / self.middle
        };
        let factor = points.iter().map(reach).filter(|r| r.is_finite()).fold(1.0, f64::max);
        Self { scale: self.scale / factor, ..self }
    }
}

/// From the centroid to the lowest and the highest point along an axis.
pub(super) fn extent(mesh: &Mesh, measures: &Measures, axis: &Vector) -> (f64, f64) {
    let heights = mesh.points.iter().map(|p| axis.dot(&(p - measures.centroid)));
    heights.fold((0.0, 0.0), |(low, high), h| (less(low, h), more(high, h)))
}

/// 1 where the model reaches farther from its centroid along the axis than against it, else -1.
fn lighter_end(mesh: &Mesh, measures: &Measures, axis: &Vector) -> f64 {
    let (low, high) = extent(mesh, measures, axis);
    if high >= -low { 1.0 } else { -1.0 }
}
