//! Distributions of distances to a plane, compared.

/// The one-dimensional Wasserstein distance of two samples: the mean distance of their quantile functions. The
/// samples are sorted in place; 0 if one is empty.
pub fn wasserstein(a: &mut [f64], b: &mut [f64]) -> f64 {
    if a.is_empty() || b.is_empty() {
        return 0.0;
    }
    a.sort_by(f64::total_cmp);
    b.sort_by(f64::total_cmp);
    let (n, m) = (a.len(), b.len());
    let (mut i, mut j, mut done, mut sum) = (0, 0, 0.0, 0.0);
    while i < n && j < m {
        // Sample i of a ends at the quantile (i + 1) / n.
        let (end_a, end_b) = ((i + 1) as f64 / n as f64, (j + 1) as f64 / m as f64);
        let end = end_a.min(end_b);
        sum += (a[i] - b[j]).abs() * (end - done);
        done = end;
        i += usize::from(end_a <= end);
        j += usize::from(end_b <= end);
    }
    sum
}

/// The correlation of eq. (6) between the histograms of two samples over their common range; `None` where a
/// histogram is constant, for then it is undefined.
pub fn histogram_correlation(a: &[f64], b: &[f64], bins: usize) -> Option<f64> {
    let all = || a.iter().chain(b);
    let low = all().copied().fold(f64::INFINITY, f64::min);
    let high = all().copied().fold(f64::NEG_INFINITY, f64::max);
    if low.partial_cmp(&high) != Some(std::cmp::Ordering::Less) || bins == 0 {
        return None;
    }
    let histogram = |values: &[f64]| {
        let mut counts = vec![0.0; bins];
        for v in values {
            counts[(((v - low) / (high - low) * bins as f64) as usize).min(bins - 1)] += 1.0;
        }
        let mean = values.len() as f64 / bins as f64;
        counts.iter_mut().for_each(|c| *c -= mean);
        counts
    };
    let (g, h) = (histogram(a), histogram(b));
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(s, t)| s * t).sum::<f64>();
    let norm = (dot(&g, &g) * dot(&h, &h)).sqrt();
    (norm > 0.0).then(|| dot(&g, &h) / norm)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shift_is_its_own_distance() {
        assert!((wasserstein(&mut [3.0, 1.0, 2.0], &mut [1.5, 3.5, 2.5]) - 0.5).abs() < 1e-12);
        // One value against two: half the mass moves by 1, half by 3.
        assert!((wasserstein(&mut [0.0], &mut [1.0, 3.0]) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn equal_histograms_correlate_and_flat_ones_are_undefined() {
        let a = [0.0, 0.1, 0.1, 1.0];
        assert!((histogram_correlation(&a, &a, 4).unwrap() - 1.0).abs() < 1e-12);
        assert!(histogram_correlation(&a, &[0.0, 0.9, 1.0, 1.0], 4).unwrap() < 0.9);
        assert_eq!(histogram_correlation(&[1.0, 1.0], &[1.0], 32), None);
    }
}
