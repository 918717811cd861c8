//! Principal axes of symmetric matrices.

use super::{Matrix, Vector};

/// Eigenvalues in growing order and the unit eigenvectors that belong to them, as (values, vectors).
///
/// The sign of each vector has no meaning; of equal eigenvalues, neither has the choice of the vectors. A matrix that
/// is not finite gives zeros and the coordinate axes.
pub fn symmetric_eigen(matrix: &Matrix) -> ([f64; 3], [Vector; 3]) {
    if !matrix.iter().all(|x| x.is_finite()) {
        return ([0.0; 3], [Vector::x(), Vector::y(), Vector::z()]);
    }
    let eigen = matrix.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| eigen.eigenvalues[i].total_cmp(&eigen.eigenvalues[j]));
    let vector = |i: usize| eigen.eigenvectors.column(i).into_owned();
    (order.map(|i| eigen.eigenvalues[i]), order.map(vector))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_grow_and_vectors_fit() {
        // The block [[2, 1], [1, 2]] has the eigenvalues 1 and 3.
        let matrix = Matrix::new(2.0, 1.0, 0.0, 1.0, 2.0, 0.0, 0.0, 0.0, -5.0);
        let (values, vectors) = symmetric_eigen(&matrix);
        for (value, expected) in values.iter().zip([-5.0, 1.0, 3.0]) {
            assert!((value - expected).abs() < 1e-12);
        }
        assert!((vectors[2].dot(&Vector::new(1.0, 1.0, 0.0).normalize()).abs() - 1.0).abs() < 1e-12);
    }
}
