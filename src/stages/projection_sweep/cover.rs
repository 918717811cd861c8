//! Convex hulls inside a larger one, which cast no shadow of their own.

use super::slices::Flat;

/// A convex polygon that is asked what lies inside it.
pub(super) struct Cover<'a> {
    /// Counter-clockwise.
    hull: &'a [Flat],
    centre: Flat,
    /// Square of the radius about the centre within which all is inside, mm^2.
    within: f64,
}

impl<'a> Cover<'a> {
    /// `hull`: counter-clockwise, at least a triangle.
    pub fn of(hull: &'a [Flat]) -> Self {
        let share = 1.0 / hull.len().max(1) as f64;
        let centre = [0, 1].map(|i| hull.iter().map(|p| p[i]).sum::<f64>() * share);
        let mut cover = Self { hull, centre, within: 0.0 };
        let nearest = cover.heights(centre).fold(f64::INFINITY, f64::min).max(0.0);
        // What rounding may add to a distance stays outside.
        cover.within = (nearest * (1.0 - 1e-9)).powi(2);
        cover
    }

    /// Whether the polygon holds all of `points`.
    pub fn holds(&self, points: &[Flat]) -> bool {
        points.iter().all(|p| {
            let d = [p[0] - self.centre[0], p[1] - self.centre[1]];
            d[0] * d[0] + d[1] * d[1] <= self.within || self.heights(*p).all(|height| height >= 0.0)
        })
    }

    /// Signed distances of a point from the sides, inside positive.
    fn heights(&self, p: Flat) -> impl Iterator<Item = f64> + '_ {
        let ends = self.hull.iter().cycle().skip(1);
        self.hull.iter().zip(ends).map(move |(a, b)| {
            let side = [b[0] - a[0], b[1] - a[1]];
            (side[0] * (p[1] - a[1]) - side[1] * (p[0] - a[0])) / side[0].hypot(side[1])
        })
    }
}

/// Twice the area of a counter-clockwise polygon, mm^2.
pub(super) fn doubled_area(hull: &[Flat]) -> f64 {
    let ends = hull.iter().cycle().skip(1);
    hull.iter().zip(ends).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_holds_what_is_inside_and_on_its_border() {
        let square = [[1.0, 1.0], [5.0, 1.0], [5.0, 5.0], [1.0, 5.0]];
        assert_eq!(doubled_area(&square), 32.0);
        let cover = Cover::of(&square);
        assert!(cover.holds(&[[3.0, 3.0], [4.9, 4.9]]));
        assert!(cover.holds(&[[1.0, 2.0], [5.0, 5.0]]));
        assert!(!cover.holds(&[[3.0, 3.0], [5.1, 3.0]]));
    }
}
