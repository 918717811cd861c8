//! A random rigid motion for every model: catalogue parts come ready-aligned, so a comparison of alignments on them
//! is fair only after this.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::geometry::{Chirality, Isometry, Matrix, Vector};
use crate::store::Hash;

/// Largest shift along each axis, mm: about a part's size, so that positions matter and precision does not.
const SHIFT: f64 = 100.0;

/// The motion of the model with these bytes: a uniform rotation (Shoemake 1992) and a shift, fixed by `seed` and the
/// bytes, so that neither the file's name nor the order of reading changes it.
pub fn random_pose(seed: u64, hash: &Hash) -> Isometry {
    let mut hasher = blake3::Hasher::new();
    hasher.update(&seed.to_le_bytes()).update(hash);
    let mut rng = Pcg64::from_seed(*hasher.finalize().as_bytes());
    let rotation = quaternion(rng.random(), rng.random(), rng.random()).to_rotation_matrix();
    let shift = Vector::from_fn(|_, _| SHIFT * (2.0 * rng.random::<f64>() - 1.0));
    Isometry { rotation: Matrix::from(rotation), translation: shift, chirality: Chirality::Proper }
}

/// A uniformly distributed rotation from three uniform numbers in [0, 1).
fn quaternion(a: f64, b: f64, c: f64) -> nalgebra::UnitQuaternion<f64> {
    let (s, t) = ((1.0 - a).sqrt(), a.sqrt());
    let (sin_b, cos_b) = (b * std::f64::consts::TAU).sin_cos();
    let (sin_c, cos_c) = (c * std::f64::consts::TAU).sin_cos();
    nalgebra::UnitQuaternion::new_normalize(nalgebra::Quaternion::new(t * cos_c, s * sin_b, s * cos_b, t * sin_c))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pose_is_rigid_and_fixed_by_seed_and_bytes() {
        let pose = random_pose(1, &[7; 32]);
        assert!((pose.rotation.determinant() - 1.0).abs() < 1e-12);
        assert!((pose.rotation * pose.rotation.transpose() - Matrix::identity()).norm() < 1e-12);
        assert!(pose.translation.amax() <= SHIFT);
        assert_eq!(random_pose(1, &[7; 32]), pose);
        assert_ne!(random_pose(2, &[7; 32]), pose);
        assert_ne!(random_pose(1, &[8; 32]), pose);
    }

    #[test]
    fn directions_are_uniform() {
        let images = (0..2000u64).map(|seed| random_pose(seed, &[0; 32]).rotation * Vector::x());
        let mean = images.sum::<Vector>() / 2000.0;
        // The mean of n uniform unit vectors has length sqrt(1/n) = 0.022 on average.
        assert!(mean.norm() < 0.08, "{mean}");
    }
}
