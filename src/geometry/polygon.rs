//! Polygons in the plane.

use super::Point2;

/// Signed area of the closed polygon, positive when it runs counter-clockwise.
pub fn signed_area(polygon: &[Point2]) -> f64 {
    let Some(last) = polygon.last() else { return 0.0 };
    let mut previous = last;
    let mut twice = 0.0;
    for p in polygon {
        twice += previous.x * p.y - p.x * previous.y;
        previous = p;
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

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<Point2> {
        [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]].map(Point2::from).to_vec()
    }

    #[test]
    fn a_counter_clockwise_square_has_positive_area() {
        assert_eq!(signed_area(&square()), 4.0);
        assert_eq!(signed_area(&square().into_iter().rev().collect::<Vec<_>>()), -4.0);
    }

    #[test]
    fn a_point_inside_is_wound_around_once() {
        assert_eq!(winding_number(&square(), &Point2::new(1.0, 1.0)), 1);
        assert_eq!(winding_number(&square(), &Point2::new(3.0, 1.0)), 0);
    }
}
