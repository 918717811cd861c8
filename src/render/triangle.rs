//! Triangles in a picture: the samples that they cover and values that are linear over them.

use std::ops::Range;

use crate::geometry::cells::{centre, first_centre};
use crate::geometry::order::{less, more};

/// A triangle in the picture, its corners from the top down.
pub(super) struct Triangle {
    width: usize,
    corners: [[f64; 2]; 3],
    /// Samples to the right for each sample down: along the long side, the upper and the lower short side.
    slopes: [f64; 3],
}

impl Triangle {
    /// A triangle in a picture `width` samples wide and high, given by where its corners lie: samples to the right,
    /// samples down. `None` if it is seen edge-on or lies between the samples.
    pub fn new(mut corners: [[f64; 2]; 3], width: usize) -> Option<Self> {
        let misses = |i: usize| {
            let [a, b, c] = corners.map(|corner| corner[i]);
            first_centre(less(less(a, b), c), width) == first_centre(more(more(a, b), c), width)
        };
        if misses(0) || misses(1) {
            return None;
        }
        let doubled = doubled_area(&corners);
        if !(doubled.abs() > 1e-9 && doubled.is_finite()) {
            return None;
        }
        corners.sort_unstable_by(|a, b| a[1].total_cmp(&b[1]));
        let [a, b, c] = corners;
        let slope = |from: [f64; 2], to: [f64; 2]| (to[0] - from[0]) / (to[1] - from[1]);
        Some(Self { width, corners, slopes: [slope(a, c), slope(a, b), slope(b, c)] })
    }

    /// The rows that it passes and in each the samples inside.
    pub fn spans(&self) -> impl Iterator<Item = (usize, Range<usize>)> {
        let Self { width, corners: [a, b, c], slopes: [long, upper, lower] } = *self;
        (first_centre(a[1], width)..first_centre(c[1], width)).map(move |y| {
            let height = centre(y);
            let p = a[0] + (height - a[1]) * long;
            let q = if height < b[1] { a[0] + (height - a[1]) * upper } else { b[0] + (height - b[1]) * lower };
            (y, first_centre(less(p, q), width)..first_centre(more(p, q), width))
        })
    }
}

/// A value that is linear over a triangle.
pub(super) struct Ramp {
    corner: [f64; 2],
    value: f64,
    /// What it gains with each sample to the right, and with each sample down.
    right: f64,
    down: f64,
}

impl Ramp {
    /// The ramp through values at the corners of a triangle that is not seen edge-on.
    pub fn new(corners: &[[f64; 2]; 3], values: [f64; 3]) -> Self {
        let [a, b, c] = corners;
        let share = 1.0 / doubled_area(corners);
        let (to_b, to_c) = (values[1] - values[0], values[2] - values[0]);
        Self {
            corner: *a,
            value: values[0],
            right: (to_b * (c[1] - a[1]) - to_c * (b[1] - a[1])) * share,
            down: (to_c * (b[0] - a[0]) - to_b * (c[0] - a[0])) * share,
        }
    }

    /// The value at the centre of a sample.
    #[inline]
    pub fn at(&self, x: usize, y: usize) -> f64 {
        let [right, down] = [centre(x) - self.corner[0], centre(y) - self.corner[1]];
        self.value + down * self.down + right * self.right
    }
}

fn doubled_area([a, b, c]: &[[f64; 2]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_covers_the_samples_whose_centres_it_holds() {
        // Right angle at (1, 1), legs of 4: the hypotenuse passes through the centres where x + y = 5.
        let triangle = [[1.0, 5.0], [1.0, 1.0], [5.0, 1.0]];
        let spans = |width| Triangle::new(triangle, width).unwrap().spans().collect::<Vec<_>>();
        assert_eq!(spans(8), [(1, 1..4), (2, 1..3), (3, 1..2), (4, 1..1)]);
        assert_eq!(spans(2), [(1, 1..2)]);
        assert!(Triangle::new([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]], 8).is_none());
        assert!(Triangle::new([[0.0, 0.0], [1.0, f64::NAN], [2.0, 2.0]], 8).is_none());
        assert!(Triangle::new([[0.6, 0.0], [1.4, 0.0], [1.0, 9.0]], 8).is_none());
    }

    #[test]
    fn a_ramp_takes_the_values_of_its_corners() {
        let corners = [[0.5, 0.5], [4.5, 0.5], [0.5, 2.5]];
        let ramp = Ramp::new(&corners, [1.0, 9.0, 5.0]);
        assert_eq!([ramp.at(0, 0), ramp.at(4, 0), ramp.at(0, 2), ramp.at(2, 1)], [1.0, 9.0, 5.0, 7.0]);
    }
}
