//! Triangles in a picture: the samples that they cover and values that are linear over them.

use std::ops::Range;

use crate::geometry::cells::{centre, first_centre};
use crate::geometry::order::{ascending, less, more};

/// The first sample to the right and the first one down, in a picture `width` samples wide and high, whose centre a
/// place does not lie beyond.
pub(super) fn cell(place: [f64; 2], width: usize) -> [u32; 2] {
    place.map(|c| first_centre(c, width) as u32)
}

/// The box of samples whose centres a triangle may hold.
pub(super) struct Samples {
    pub columns: Range<usize>,
    pub rows: Range<usize>,
}

impl Samples {
    /// Those between the cells of the corners; `None` if there are none.
    #[inline]
    pub fn of(cells: &[[u32; 2]; 3]) -> Option<Self> {
        let range = |i: usize| {
            let [a, b, c] = cells.map(|cell| cell[i]);
            a.min(b).min(c) as usize..a.max(b).max(c) as usize
        };
        let (columns, rows) = (range(0), range(1));
        (!columns.is_empty() && !rows.is_empty()).then_some(Self { columns, rows })
    }
}

/// A triangle in the picture, its corners from the top down.
pub(super) struct Triangle {
    width: usize,
    rows: Range<usize>,
    corners: [[f64; 2]; 3],
    /// Samples to the right for each sample down: along the long side, the upper and the lower short side.
    slopes: [f64; 3],
}

impl Triangle {
    /// A triangle in a picture `width` samples wide and high, given by where its corners lie (samples to the right,
    /// samples down) and the samples that it may cover. `None` if it is seen edge-on.
    pub fn new(corners: [[f64; 2]; 3], samples: &Samples, width: usize) -> Option<Self> {
        let doubled = doubled_area(&corners);
        if !(doubled.abs() > 1e-9 && doubled.is_finite()) {
            return None;
        }
        let corners = ascending(corners, |corner| corner[1]);
        let [a, b, c] = corners;
        let slope = |from: [f64; 2], to: [f64; 2]| (to[0] - from[0]) / (to[1] - from[1]);
        Some(Self { width, rows: samples.rows.clone(), corners, slopes: [slope(a, c), slope(a, b), slope(b, c)] })
    }

    /// Calls `span` for the rows that it passes with the samples inside, where there are any.
    #[inline]
    pub fn each_span(&self, mut span: impl FnMut(usize, Range<usize>)) {
        let Self { rows, width, corners: [a, b, _], slopes: [long, upper, lower] } = self;
        for y in rows.clone() {
            let height = centre(y);
            let p = a[0] + (height - a[1]) * long;
            let q = if height < b[1] { a[0] + (height - a[1]) * upper } else { b[0] + (height - b[1]) * lower };
            let samples = first_centre(less(p, q), *width)..first_centre(more(p, q), *width);
            if !samples.is_empty() {
                span(y, samples);
            }
        }
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

    /// The values in a row of samples.
    #[inline]
    pub fn row(&self, y: usize) -> Row {
        Row { from: self.corner[0], value: self.value + (centre(y) - self.corner[1]) * self.down, right: self.right }
    }
}

/// A value that is linear over a row of samples.
pub(super) struct Row {
    from: f64,
    value: f64,
    right: f64,
}

impl Row {
    /// The value at the centre of a sample.
    #[inline]
    pub fn at(&self, x: usize) -> f64 {
        self.value + (centre(x) - self.from) * self.right
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
        let new = |corners: [[f64; 2]; 3], width| {
            let samples = Samples::of(&corners.map(|corner| cell(corner, width)))?;
            Triangle::new(corners, &samples, width)
        };
        let spans = |width| {
            let mut spans = Vec::new();
            new(triangle, width).unwrap().each_span(|y, span| spans.push((y, span)));
            spans
        };
        assert_eq!(spans(8), [(1, 1..4), (2, 1..3), (3, 1..2)]);
        assert_eq!(spans(2), [(1, 1..2)]);
        assert!(new([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]], 8).is_none());
        assert!(new([[0.0, 0.0], [1.0, f64::NAN], [2.0, 2.0]], 8).is_none());
        assert!(new([[0.6, 0.0], [1.4, 0.0], [1.0, 9.0]], 8).is_none());
    }

    #[test]
    fn a_ramp_takes_the_values_of_its_corners() {
        let corners = [[0.5, 0.5], [4.5, 0.5], [0.5, 2.5]];
        let ramp = Ramp::new(&corners, [1.0, 9.0, 5.0]);
        let values = [[0, 0], [4, 0], [0, 2], [2, 1]].map(|[x, y]| ramp.row(y).at(x));
        assert_eq!(values, [1.0, 9.0, 5.0, 7.0]);
    }
}
