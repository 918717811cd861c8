//! Continuous PCA (Vranic, Saupe and Richter 2001): the covariance of all points of the surface, not of samples.
//!
//! C = 1/(12 S) sum S_i [f(A_i) + f(B_i) + f(C_i) + 9 f(G_i)] with f(v) = (v - m)(v - m)^T, m the area centroid,
//! G_i the centroid of triangle i and S_i its area: exact on triangles.

use crate::brep::Mesh;
use crate::geometry::{Matrix, Point, Vector};

use super::{principal_axes, triangle};

/// Principal axes of the surface, largest variance first.
pub fn axes(mesh: &Mesh) -> [Vector; 3] {
    principal_axes(&covariance(mesh))
}

/// Covariance of the surface's points about its area centroid, mm^2; zero for a mesh without area.
pub fn covariance(mesh: &Mesh) -> Matrix {
    let (mut total, mut moment) = (0.0, Vector::zeros());
    // For both passes.
    let part = |t| triangle(mesh, t).map(|(corners, _, area)| (t, centroid(&corners), area));
    let parts: Vec<_> = (0..mesh.triangles.len()).filter_map(part).collect();
    for (_, centroid, area) in &parts {
        total += area;
        moment += centroid.coords * *area;
    }
    if total <= 0.0 {
        return Matrix::zeros();
    }
    let m = Point::from(moment / total);
    let mut sum = [0.0; 6];
    for (t, centroid, area) in &parts {
        let [a, b, c] = mesh.corners(*t);
        let [a, b, c, g] = [a, b, c, *centroid].map(|p| products(&(p - m)));
        for i in 0..6 {
            sum[i] += area * (a[i] + b[i] + c[i] + 9.0 * g[i]);
        }
    }
    let [xx, xy, xz, yy, yz, zz] = sum;
    Matrix::new(xx, xy, xz, xy, yy, yz, xz, yz, zz) / (12.0 * total)
}

/// The upper half of v v^T, row by row.
#[inline]
fn products(v: &Vector) -> [f64; 6] {
    [v.x * v.x, v.x * v.y, v.x * v.z, v.y * v.y, v.y * v.z, v.z * v.z]
}

#[inline]
fn centroid(corners: &[Point; 3]) -> Point {
    Point::from((corners[0].coords + corners[1].coords + corners[2].coords) / 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::shapes;

    #[test]
    fn the_covariance_of_a_rectangle_is_its_second_moment() {
        // A flat 2 x 6 rectangle: variances 2^2 / 12 and 6^2 / 12.
        let mesh = shapes::rectangle(2.0, 6.0);
        let expected = Matrix::from_diagonal(&Vector::new(4.0 / 12.0, 36.0 / 12.0, 0.0));
        assert!((covariance(&mesh) - expected).norm() < 1e-12);
    }
}
