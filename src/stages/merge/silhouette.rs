//! The area of a model's shadow, roughly: only to settle ties.

use crate::brep::Mesh;
use crate::geometry::cells::first_centre;
use crate::geometry::{Plane, Point, Point2, Vector, any_perpendicular};

/// Pixels along a side.
const PIXELS: usize = 256;

/// Area of the shadow along the plane's normal, mm^2, by counting the pixels whose centres are covered. `centroid`
/// and `size` (mm) are the model's centroid and D: all of it lies within size / 2 of the centroid.
pub(super) fn area(mesh: &Mesh, plane: &Plane, centroid: &Point, size: f64) -> f64 {
    let x = any_perpendicular(&plane.normal);
    let y = plane.normal.cross(&x);
    let pixel = size / PIXELS as f64;
    let project = |p: &Point| {
        let d: Vector = p - centroid;
        Point2::new(d.dot(&x) / pixel, d.dot(&y) / pixel).map(|c| c + 0.5 * PIXELS as f64)
    };
    let flat: Vec<_> = mesh.points.iter().map(project).collect();
    let mut covered = vec![false; PIXELS * PIXELS];
    for triangle in &mesh.triangles {
        fill(&mut covered, triangle.map(|i| flat[i as usize]));
    }
    covered.iter().filter(|&&c| c).count() as f64 * pixel * pixel
}

/// Covers the pixels whose centres lie in the triangle.
fn fill(covered: &mut [bool], corners: [Point2; 3]) {
    let bound = |v: f64| first_centre(v, PIXELS);
    let low = corners.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    let high = corners.iter().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max);
    for row in bound(low)..bound(high) {
        let y = row as f64 + 0.5;
        let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
        for i in 0..3 {
            let (p, q) = (corners[i], corners[(i + 1) % 3]);
            if (p.y <= y) != (q.y <= y) {
                let x = p.x + (q.x - p.x) * (y - p.y) / (q.y - p.y);
                (left, right) = (left.min(x), right.max(x));
            }
        }
        if left < right {
            let start = row * PIXELS;
            covered[start + bound(left)..start + bound(right)].fill(true);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overlapping_triangles_count_once() {
        let points = [[-3.0, -2.0, 0.0], [3.0, -2.0, 0.0], [3.0, 2.0, 0.0], [-3.0, 2.0, 0.0]].map(Point::from).to_vec();
        let mesh = Mesh { points, triangles: vec![[0, 1, 2], [0, 2, 3], [0, 2, 1]], faces: Vec::new() };
        let shadow = |normal: Vector| area(&mesh, &Plane { normal, offset: 0.0 }, &Point::origin(), 8.0);
        assert!((shadow(Vector::z()) - 24.0).abs() < 0.5);
        assert!((shadow(Vector::new(0.0, 0.6, 0.8)) - 24.0 * 0.8).abs() < 0.5);
        assert_eq!(shadow(Vector::x()), 0.0);
    }
}
