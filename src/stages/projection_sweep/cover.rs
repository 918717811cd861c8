//! Convex hulls inside a larger one, which cast no shadow of their own.

use std::ops::Range;

use super::slices::Flat;

/// Drops the hulls that lie inside the largest one: a plate with ten thousand holes casts the shadow of a plate.
pub(super) fn drop_covered(points: &[Flat], hulls: &mut Vec<Range<usize>>) {
    if hulls.len() < 2 {
        return;
    }
    let areas = hulls.iter().map(|hull| (doubled_area(&points[hull.clone()]), hull));
    let largest = areas.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(area, _)| *area > 0.0);
    let Some(largest) = largest.map(|(_, hull)| hull.clone()) else { return };
    let cover = Cover::of(&points[largest.clone()]);
    hulls.retain(|hull| *hull == largest || !cover.holds(&points[hull.clone()]));
}

/// A convex polygon that is asked what lies inside it.
struct Cover<'a> {
    /// Counter-clockwise.
    hull: &'a [Flat],
    centre: Flat,
    /// Square of the radius about the centre within which all is inside, mm^2.
    within: f64,
}

impl<'a> Cover<'a> {
    /// `hull`: counter-clockwise, at least a triangle.
    fn of(hull: &'a [Flat]) -> Self {
        let share = 1.0 / hull.len().max(1) as f64;
        let centre = [0, 1].map(|i| hull.iter().map(|p| p[i]).sum::<f64>() * share);
        let mut cover = Self { hull, centre, within: 0.0 };
        let heights =
            cover.sides().map(|[a, b]| beside(a, b, centre) / ((b[0] - a[0]).powi(2) + (b[1] - a[1]).powi(2)).sqrt());
        let nearest = heights.fold(f64::INFINITY, f64::min).max(0.0);
        // What rounding may add to a distance stays outside.
        cover.within = (nearest * (1.0 - 1e-9)).powi(2);
        cover
    }

    /// Whether the polygon holds all of `points`.
    fn holds(&self, points: &[Flat]) -> bool {
        points.iter().all(|p| {
            let d = [p[0] - self.centre[0], p[1] - self.centre[1]];
            d[0] * d[0] + d[1] * d[1] <= self.within || self.sides().all(|[a, b]| beside(a, b, *p) >= 0.0)
        })
    }

    fn sides(&self) -> impl Iterator<Item = [Flat; 2]> + '_ {
        sides(self.hull)
    }
}

/// How far a point lies to the left of the way from `a` to `b`, times that way's length.
fn beside(a: Flat, b: Flat, p: Flat) -> f64 {
    (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
}

/// Twice the area of a counter-clockwise polygon, mm^2.
fn doubled_area(hull: &[Flat]) -> f64 {
    sides(hull).map(|[a, b]| a[0] * b[1] - a[1] * b[0]).sum()
}

/// The sides of a polygon, from corner to corner.
pub(super) fn sides(polygon: &[Flat]) -> impl Iterator<Item = [Flat; 2]> + '_ {
    polygon.iter().zip(polygon.iter().skip(1).chain(polygon.first())).map(|(a, b)| [*a, *b])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_hulls_outside_the_largest_are_kept() {
        // A square of side 4, a triangle inside it, one beside it.
        let points = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [1.0, 1.0], [2.0, 1.0], [1.0, 2.0], [5.0, 0.0]];
        let points: Vec<Flat> = points.into_iter().chain([[6.0, 0.0], [5.0, 1.0]]).collect();
        let mut hulls = vec![4..7, 0..4, 7..10];
        drop_covered(&points, &mut hulls);
        assert_eq!(hulls, [0..4, 7..10]);
    }

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
