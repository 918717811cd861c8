//! The signature of broken silhouettes (Dalitz, Brandt, Goebbels and Kolanus 2013).
//!
//! They describe a shape of several parts by its convex hull and, along it, the distance to the closest point of an
//! actual contour. We fold both into one real signature, comparable with the unbroken ones: the hull's distance from
//! the centroid less the gap between hull and shape. For a convex shape that is the centroid distance itself.

use super::contour::{Contour, boundaries};
use crate::silhouette::Silhouette;

/// The convex hull of all covered pixels, counter-clockwise; `None` for an empty picture.
pub fn hull(picture: &Silhouette) -> Option<Contour> {
    let mut points: Vec<_> = boundaries(picture).into_iter().flatten().collect();
    points.sort_unstable();
    points.dedup();
    let mut chain: Vec<[isize; 2]> = Vec::new();
    half_hull(points.iter(), &mut chain);
    let lower = chain.len().checked_sub(1)?;
    chain.truncate(lower);
    half_hull(points.iter().rev(), &mut chain);
    chain.pop();
    Some(Contour { points: chain.iter().map(|p| p.map(|c| c as f64)).collect() })
}

fn half_hull<'a>(points: impl Iterator<Item = &'a [isize; 2]>, chain: &mut Vec<[isize; 2]>) {
    let base = chain.len();
    for &p in points {
        while chain.len() >= base + 2 && cross(chain[chain.len() - 2], chain[chain.len() - 1], p) <= 0 {
            chain.pop();
        }
        chain.push(p);
    }
}

fn cross(a: [isize; 2], b: [isize; 2], c: [isize; 2]) -> isize {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// For points on the hull: their distance from the centroid less that from the nearest point of the shape.
pub fn signature(picture: &Silhouette, on_hull: &[[f64; 2]], centroid: [f64; 2]) -> Vec<f64> {
    let shape: Vec<_> = boundaries(picture).into_iter().flatten().map(|p| p.map(|c| c as f64)).collect();
    let squared = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2);
    let gap = |h: [f64; 2]| shape.iter().map(|p| squared(h, *p)).fold(f64::INFINITY, f64::min).sqrt();
    on_hull.iter().map(|&h| squared(h, centroid).sqrt() - gap(h)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_parts_share_a_hull_and_the_gap_is_taken_off() {
        let picture = Silhouette::from_text("....... ##...## ##...## ##...## ....... ....... .......");
        let hull = hull(&picture).unwrap();
        assert_eq!(hull.points, vec![[0.0, 3.0], [7.0, 3.0], [7.0, 6.0], [0.0, 6.0]]);
        let centroid = picture.centroid().unwrap();
        let found = signature(&picture, &[[7.0, 3.0], [3.5, 3.0]], centroid);
        assert!((found[0] - 3.5f64.hypot(1.5)).abs() < 1e-12);
        assert!((found[1] - (1.5 - 1.5)).abs() < 1e-12);
    }

    #[test]
    fn an_empty_picture_has_no_hull() {
        assert_eq!(hull(&Silhouette::new(5)), None);
    }
}
