//! Directions spread evenly.

use std::f64::consts::PI;

use super::Vector;

/// `count` directions over half the sphere about the third axis: a Fibonacci spiral, the golden angle from one to the
/// next.
pub fn half_sphere(axes: &[Vector; 3], count: usize) -> impl Iterator<Item = Vector> + '_ {
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    (0..count).map(move |k| {
        let height = (k as f64 + 0.5) / count as f64;
        let (sin, cos) = (golden * k as f64).sin_cos();
        (axes[0] * cos + axes[1] * sin) * (1.0 - height * height).sqrt() + axes[2] * height
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_unit_and_balanced_about_the_third_axis() {
        let axes = [Vector::x(), Vector::y(), Vector::z()];
        let all: Vec<_> = half_sphere(&axes, 1000).collect();
        assert!(all.iter().all(|d| (d.norm() - 1.0).abs() < 1e-12 && d.z > 0.0));
        // Heights are uniform on half a sphere: their mean is a half.
        let mean: Vector = all.iter().sum::<Vector>() / 1000.0;
        assert!((mean - Vector::new(0.0, 0.0, 0.5)).norm() < 1e-2, "{mean}");
    }
}
