//! The plane that mirrors one point set onto another with the least squared error.

use crate::geometry::isometry::mean;
use crate::geometry::principal::symmetric_eigen;
use crate::geometry::{Isometry, Matrix, Plane, Point};

/// A fitted mirror plane.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    /// The plane fitted.
    pub plane: Plane,
    /// Mean squared distance of the mirrored points from their images, mm^2.
    pub squared: f64,
    /// Distance of the two lowest eigenvalues as a share of the largest magnitude, 0 to 2: small where the plane is
    /// not determined.
    pub gap: f64,
}

/// Fits the plane by an eigenproblem.
///
/// With centred points a, b and delta = mean(to) - mean(from), the squared error of the mirror with unit normal n is
/// sum |b - a|^2 + N |delta|^2 + n^T M n, where M = 2 sum (a b^T + b a^T) - N delta delta^T: the best normal is the
/// eigenvector of the smallest eigenvalue, and the plane goes through the middle of the means. `None` for fewer than
/// three points.
pub fn fit(from: &[Point], to: &[Point]) -> Option<Fit> {
    let count = from.len();
    if count < 3 || count != to.len() {
        return None;
    }
    let (v, w) = (mean(from), mean(to));
    let delta = w - v;
    let mut matrix = -(delta * delta.transpose()) * count as f64;
    let mut spread = delta.norm_squared() * count as f64;
    for (p, q) in from.iter().zip(to) {
        let (a, b) = (p - v, q - w);
        let product: Matrix = a * b.transpose();
        matrix += (product + product.transpose()) * 2.0;
        spread += (b - a).norm_squared();
    }
    let (values, vectors) = symmetric_eigen(&matrix);
    let largest = values[0].abs().max(values[2].abs());
    if !(largest > 0.0 && spread.is_finite()) {
        return None;
    }
    let plane = Plane::through(&nalgebra::center(&v, &w), &vectors[0]);
    // The closed form subtracts nearly equal numbers; near zero only the distances themselves are exact.
    let squared = from.iter().zip(to).map(|(p, q)| (plane.reflect(p) - q).norm_squared()).sum::<f64>() / count as f64;
    Some(Fit { plane, squared, gap: (values[1] - values[0]) / largest })
}

/// The plane halfway between points and their images where these are exact to within `tolerance` (mm), at a fraction of
/// the price of a fit; `None` also where another plane may fit as well: where the `gap` of a fit may be smaller.
///
/// For exact images the matrix of the fit has the normal as its eigenvector, with the eigenvalue -sum |d|^2, d = to -
/// from; the others are those of 4 sum (a a^T) along the plane, between 0 and 4 sum |a|^2.
pub fn halfway(from: &[Point], to: &[Point], tolerance: f64, gap: f64) -> Option<Plane> {
    if from.len() < 3 || from.len() != to.len() {
        return None;
    }
    let pairs = || from.iter().zip(to);
    let (p, q) = pairs().max_by(|(p, q), (r, s)| (*q - *p).norm_squared().total_cmp(&(*s - *r).norm_squared()))?;
    let plane = Plane::through(&nalgebra::center(p, q), &(q - p).try_normalize(0.0)?);
    let (mut across, mut along) = (0.0, 0.0);
    for (p, q) in pairs() {
        let (moved, from_first) = (q - p, p - from[0]);
        if (plane.reflect(p) - q).norm_squared() > tolerance * tolerance {
            return None;
        }
        across += moved.norm_squared();
        along += 4.0 * from_first.norm_squared();
    }
    (across > gap * along.max(across)).then_some(plane)
}

/// Whether some plane may have no larger mean squared error than `most` (mm^2): a mirror moves points along its normal
/// alone.
///
/// The error is at least the sum e of the two lower eigenvalues of S = mean(d d^T), d = to - from; and e times the trace
/// of S is at least the sum of its principal minors, l1 l2 + l1 l3 + l2 l3.
pub fn may_fit(from: &[Point], to: &[Point], most: f64) -> bool {
    let mut moved = Matrix::zeros();
    for (p, q) in from.iter().zip(to) {
        let d = q - p;
        moved += d * d.transpose();
    }
    moved /= from.len() as f64;
    let minor = |i: usize, j: usize| moved[(i, i)] * moved[(j, j)] - moved[(i, j)] * moved[(i, j)];
    minor(0, 1) + minor(0, 2) + minor(1, 2) <= moved.trace() * most * 1.001
}

/// The plane of an improper isometry whose eigenvalue 1 is double; a shift along the plane (a glide) is ignored, as
/// the paper's criterion does. `tolerance` bounds |trace - 1|.
pub fn plane_of(isometry: &Isometry, tolerance: f64) -> Option<Plane> {
    // An improper rotation by phi has the trace 2 cos(phi) - 1: only a mirror has 1.
    if (isometry.rotation.trace() - 1.0).abs() > tolerance {
        return None;
    }
    let (values, vectors) = symmetric_eigen(&((isometry.rotation + isometry.rotation.transpose()) * 0.5));
    let normal = vectors[0];
    (values[0] < 0.0).then(|| Plane { normal, offset: 0.5 * normal.dot(&isometry.translation) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Chirality, Vector};

    fn corners() -> Vec<Point> {
        [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 2.0, 0.0], [0.0, 1.0, 0.0]].map(Point::from).to_vec()
    }

    #[test]
    fn the_plane_of_exact_images_is_found() {
        for normal in [Vector::new(1.0, 0.0, 0.0), Vector::new(1.0, 2.0, -0.5), Vector::new(0.1, 0.0, 1.0)] {
            let plane = Plane::through(&Point::new(7.0, 0.3, 2.0), &normal);
            let images: Vec<_> = corners().iter().map(|p| plane.reflect(p)).collect();
            let fit = fit(&corners(), &images).unwrap();
            assert!(fit.squared < 1e-24 && fit.gap > 0.1);
            assert!(fit.plane.angle_to(&plane) < 1e-9);
            assert!((fit.plane.canonical().offset - plane.canonical().offset).abs() < 1e-9);
        }
    }

    #[test]
    fn exact_images_have_a_plane_halfway() {
        let plane = Plane::through(&Point::new(7.0, 0.3, 2.0), &Vector::new(1.0, 2.0, -0.5));
        let mut images: Vec<_> = corners().iter().map(|p| plane.reflect(p)).collect();
        let found = halfway(&corners(), &images, 1e-9, 1e-3).unwrap();
        assert!(found.angle_to(&plane) < 1e-12 && (found.offset.abs() - plane.offset.abs()).abs() < 1e-12);
        images[2].z += 1e-6;
        assert!(halfway(&corners(), &images, 1e-9, 1e-3).is_none());
        // A needle beside the plane that it is mirrored in nearly fits any plane along it.
        let needle = [[0.01, 0.0, 0.0], [0.01, 9.0, 0.0], [0.01, 9.0, 0.01]].map(Point::from);
        let across = needle.map(|p| Point::new(-p.x, p.y, p.z));
        assert!(halfway(&needle, &across, 1e-9, 1e-3).is_none());
        assert!(fit(&needle, &across).unwrap().gap < 1e-3);
    }

    #[test]
    fn the_residual_is_the_mean_squared_distance() {
        // Mirror in x = 0; two of four images are moved by 1 to opposite sides in y.
        let from = [[1.0, 9.0, 0.0], [1.0, -9.0, 0.0], [1.0, 0.0, 9.0], [1.0, 0.0, -9.0]].map(Point::from);
        let mut to = from.map(|p| Point::new(-p.x, p.y, p.z));
        to[0].y += 1.0;
        to[1].y -= 1.0;
        let fit = fit(&from, &to).unwrap();
        assert!(may_fit(&from, &to, 0.5) && !may_fit(&from, &to, 0.1));
        assert!((fit.squared - 0.5).abs() < 1e-12);
        assert!(fit.plane.angle_to(&Plane { normal: Vector::x(), offset: 0.0 }) < 1e-12);
    }

    #[test]
    fn a_glide_has_a_plane_for_the_paper_only() {
        let plane = Plane { normal: Vector::x(), offset: 1.0 };
        let images: Vec<_> = corners().iter().map(|p| plane.reflect(p) + Vector::new(0.0, 4.0, 0.0)).collect();
        assert!(fit(&corners(), &images).unwrap().squared > 0.1);
        let (glide, squared) = Isometry::fit(&corners(), &images, Chirality::Improper).unwrap();
        assert!(squared < 1e-20);
        let found = plane_of(&glide, 1e-6).unwrap();
        assert!(found.angle_to(&plane) < 1e-9 && (found.canonical().offset - 1.0).abs() < 1e-9);
    }
}
