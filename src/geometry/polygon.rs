//! Polygons in the plane.

use super::Point2;

/// Signed area of the closed polygon, positive when it runs counter-clockwise.
pub fn signed_area(polygon: impl DoubleEndedIterator<Item = [f64; 2]> + Clone) -> f64 {
    let Some(mut p) = polygon.clone().next_back() else { return 0.0 };
    let mut twice = 0.0;
    for q in polygon {
        twice += p[0] * q[1] - q[0] * p[1];
        p = q;
    }
    0.5 * twice
}

/// How often the closed polygon winds around `p` (0: outside).
pub fn winding_number(polygon: &[Point2], p: &Point2) -> i32 {
    let Some(last) = polygon.last() else { return 0 };
    let mut a = last;
    let mut winding = 0;
    for b in polygon {
        let side = (b.x - a.x) * (p.y - a.y) - (p.x - a.x) * (b.y - a.y);
        if a.y <= p.y && b.y > p.y && side > 0.0 {
            winding += 1;
        } else if a.y > p.y && b.y <= p.y && side < 0.0 {
            winding -= 1;
        }
        a = b;
    }
    winding
}

/// The convex hull of `points`, counter-clockwise without collinear points.
pub fn convex_hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let mut hull = Vec::new();
    push_hull(&mut points, &mut hull, &mut Vec::new());
    hull
}

/// Appends the convex hull of `points`, counter-clockwise without collinear points (Andrew's monotone chain). The points
/// are left sorted; `keys` is room to sort them.
pub fn push_hull(points: &mut [[f64; 2]], hull: &mut Vec<[f64; 2]>, keys: &mut Vec<u128>) {
    sort(points, keys);
    let mut distinct = 1;
    for i in 1..points.len() {
        if points[i] != points[distinct - 1] {
            points[distinct] = points[i];
            distinct += 1;
        }
    }
    let points = &points[..distinct.min(points.len())];
    let base = hull.len();
    if points.len() < 3 {
        hull.extend_from_slice(points);
        return;
    }
    push_chain(points.iter(), base, hull);
    let upper = hull.len() - 1;
    hull.truncate(upper);
    push_chain(points.iter().rev(), upper, hull);
    hull.pop();
}

/// Sorts points by their first coordinate, then by the second, as whole numbers that are compared at once.
fn sort(points: &mut [[f64; 2]], keys: &mut Vec<u128>) {
    keys.clear();
    keys.extend(points.iter().map(|&[x, y]| u128::from(key(x)) << 64 | u128::from(key(y))));
    keys.sort_unstable();
    let coordinates = |key: u128| [key >> 64, key].map(|bits| coordinate(bits as u64));
    points.iter_mut().zip(keys).for_each(|(point, key)| *point = coordinates(*key));
}

/// Bits that compare like the number.
fn key(c: f64) -> u64 {
    let bits = c.to_bits();
    if bits >> 63 == 0 { bits | 1 << 63 } else { !bits }
}

/// The number with such bits.
fn coordinate(key: u64) -> f64 {
    f64::from_bits(if key >> 63 == 1 { key & !(1 << 63) } else { !key })
}

fn push_chain<'a>(points: impl Iterator<Item = &'a [f64; 2]>, base: usize, hull: &mut Vec<[f64; 2]>) {
    for &p in points {
        while let [.., a, b] = hull[base..]
            && turns_right(a, b, p)
        {
            hull.pop();
        }
        hull.push(p);
    }
}

fn turns_right(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> bool {
    (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]) <= 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hull_leaves_out_inner_and_collinear_points() {
        let points = vec![[0.0, 0.0], [1.0, 1.0], [2.0, 0.0], [1.0, 0.0], [2.0, 2.0], [0.0, 2.0], [0.0, 0.0]];
        assert_eq!(convex_hull(points), [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
    }

    /// As slices have them: rows of equal heights, points met twice, nearly straight sides, and all on one line.
    #[test]
    fn the_hull_reaches_as_far_as_its_points_in_every_direction() {
        for kind in 0..60 {
            let share = |i: usize, step: f64| (i as f64 * step + f64::from(kind) * 0.3).fract();
            let point = |i: usize| {
                let (x, y) = (share(i, 0.754_877_666), share(i, 0.569_840_291));
                match kind % 4 {
                    0 => [x, y],
                    1 => [(x * 4.0).floor(), (y * 4.0).floor()],
                    2 => [x, 1e-16 * y + f64::from(kind) * x],
                    _ => [(x * 3.0).floor(), y],
                }
            };
            let points: Vec<_> = (0..3 + kind as usize).map(point).collect();
            let hull = convex_hull(points.clone());
            assert!(hull.iter().all(|p| points.contains(p)));
            for turn in 0..90 {
                let (sin, cos) = (f64::from(turn) * std::f64::consts::TAU / 90.0).sin_cos();
                let reach = |all: &[[f64; 2]]| all.iter().map(|p| p[0] * cos + p[1] * sin).fold(f64::MIN, f64::max);
                assert!((reach(&hull) - reach(&points)).abs() <= 1e-12, "{kind}: {points:?}");
            }
        }
    }

    fn square() -> Vec<Point2> {
        [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]].map(Point2::from).to_vec()
    }

    #[test]
    fn points_are_sorted_by_both_coordinates() {
        let sorted = [[f64::NEG_INFINITY, 1.0], [-3.5, -2.0], [-3.5, 1e-300], [0.0, -0.0], [0.0, 0.0], [2.0, -1.0]];
        let mut points = [3, 5, 0, 2, 4, 1].map(|i| sorted[i]);
        sort(&mut points, &mut Vec::new());
        assert_eq!(points.map(|p| p.map(f64::to_bits)), sorted.map(|p| p.map(f64::to_bits)));
    }

    #[test]
    fn a_counter_clockwise_square_has_positive_area() {
        let square = square().into_iter().map(|p| [p.x, p.y]);
        assert_eq!(signed_area(square.clone()), 4.0);
        assert_eq!(signed_area(square.rev()), -4.0);
    }

    #[test]
    fn a_point_inside_is_wound_around_once() {
        assert_eq!(winding_number(&square(), &Point2::new(1.0, 1.0)), 1);
        assert_eq!(winding_number(&square(), &Point2::new(3.0, 1.0)), 0);
    }
}
