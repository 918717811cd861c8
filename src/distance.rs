//! How far apart two descriptors are (the paper's eq. 8): a dissimilarity, smaller is more alike.
//!
//! All functions take the descriptors as the store holds them, one row of numbers a model, and add up in f64. They
//! are symmetric to the last bit. Rows of different lengths are compared over the shorter one's views.
//!
//! Magnitude rows: three views of K magnitudes. Phase rows: three views of two starting points of K complex numbers.
//!
//! The axes of a frame have no sign, so a phase distance is the least over the 8 choices of signs. View i has axis
//! i + 1 to the right and axis i + 2 up. Turning the axis to the right around mirrors the picture: the contour then
//! starts at the other starting point and runs backwards, and a real signal run backwards has the conjugate
//! coefficients. Turning the axis upwards around keeps the starting point and runs backwards. Hence the coefficients
//! after turning (right, up) are those of start `right`, conjugate if exactly one of the two was turned. Both
//! starting points are compared, which makes the distance symmetric and halves the harm of a start that jumps.

/// Distance of two magnitude rows: the sum of the views' Euclidean distances, views in order (eq. 8).
pub fn magnitude(a: &[f32], b: &[f32]) -> f64 {
    magnitude_views(a, b).iter().sum()
}

/// The Euclidean distances of the three views of two magnitude rows.
pub fn magnitude_views(a: &[f32], b: &[f32]) -> [f64; 3] {
    [0, 1, 2].map(|i| euclidean(view(a, i), view(b, i)))
}

/// The least of [`magnitude`] and the same with the second and third view of one row swapped: which of the two planes
/// across the symmetry plane comes first is a choice that two alike models may make differently.
pub fn magnitude_swapped(a: &[f32], b: &[f32]) -> f64 {
    let [first, second, third] = magnitude_swapped_views(a, b);
    first + (second + third)
}

/// The distances of the views of the first row in the order that [`magnitude_swapped`] chose.
pub fn magnitude_swapped_views(a: &[f32], b: &[f32]) -> [f64; 3] {
    let [first, second, third] = magnitude_views(a, b);
    let crossed = [euclidean(view(a, 1), view(b, 2)), euclidean(view(a, 2), view(b, 1))];
    if crossed[0] + crossed[1] < second + third { [first, crossed[0], crossed[1]] } else { [first, second, third] }
}

/// Distance of two phase rows: the least sum of the views' distances over the 8 signs of the axes.
pub fn phase(a: &[f32], b: &[f32]) -> f64 {
    phase_views(a, b).iter().sum()
}

/// The distances of the three views of two phase rows under the best signs of the axes.
pub fn phase_views(a: &[f32], b: &[f32]) -> [f64; 3] {
    let turned = [0, 1, 2].map(|i| view_under_turns(view(a, i), view(b, i)));
    let mut best = ([f64::INFINITY; 3], f64::INFINITY);
    for signs in 0..8_usize {
        let flipped = |axis: usize| signs >> (axis % 3) & 1;
        let views = [0, 1, 2].map(|i| turned[i][flipped(i + 1)][flipped(i + 2)]);
        let sum = views.iter().sum();
        if sum < best.1 {
            best = (views, sum);
        }
    }
    best.0
}

/// The part of a row that belongs to a view.
fn view(row: &[f32], i: usize) -> &[f32] {
    let length = row.len() / 3;
    &row[i * length..(i + 1) * length]
}

/// Sums that run side by side, so that none waits for another.
const LANES: usize = 8;

fn euclidean(a: &[f32], b: &[f32]) -> f64 {
    let (a, rest_of_a) = a.as_chunks::<LANES>();
    let (b, rest_of_b) = b.as_chunks::<LANES>();
    let squared = |(p, q): (&f32, &f32)| (f64::from(*p) - f64::from(*q)).powi(2);
    let mut sums = [0.0; LANES];
    for (p, q) in a.iter().zip(b) {
        sums.iter_mut().zip(p.iter().zip(q)).for_each(|(sum, pair)| *sum += squared(pair));
    }
    let rest: f64 = rest_of_a.iter().zip(rest_of_b).map(squared).sum();
    (sums.iter().sum::<f64>() + rest).sqrt()
}

/// Distances of a view with the other's axes turned around: `[right][up]`.
fn view_under_turns(a: &[f32], b: &[f32]) -> [[f64; 2]; 2] {
    let (a, b) = (a.split_at(a.len() / 2), b.split_at(b.len() / 2));
    let same = [squared_both(a.0, b.0), squared_both(a.1, b.1)];
    let other = [squared_both(a.0, b.1), squared_both(a.1, b.0)];
    let mean = |pairs: [[f64; 2]; 2], conjugate: usize| (0.5 * (pairs[0][conjugate] + pairs[1][conjugate])).sqrt();
    [[mean(same, 0), mean(same, 1)], [mean(other, 1), mean(other, 0)]]
}

/// Squared distances of complex rows: as they are, and with one of them conjugate.
fn squared_both(a: &[f32], b: &[f32]) -> [f64; 2] {
    let (a, rest_of_a) = a.as_chunks::<LANES>();
    let (b, rest_of_b) = b.as_chunks::<LANES>();
    // real and imaginary parts by turns, for differences and sums; the sums of real parts are not needed
    let (mut minus, mut plus) = ([0.0; LANES], [0.0; LANES]);
    let mut add = |lane: usize, p: f32, q: f32| {
        let (p, q) = (f64::from(p), f64::from(q));
        minus[lane] += (p - q).powi(2);
        plus[lane] += (p + q).powi(2);
    };
    for (p, q) in a.iter().zip(b) {
        (0..LANES).for_each(|lane| add(lane, p[lane], q[lane]));
    }
    rest_of_a.iter().zip(rest_of_b).enumerate().for_each(|(lane, (p, q))| add(lane, *p, *q));
    let of = |lanes: &[f64; LANES], first: usize| lanes.iter().skip(first).step_by(2).sum::<f64>();
    let real = of(&minus, 0);
    [real + of(&minus, 1), real + of(&plus, 1)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn magnitudes_add_up_the_views() {
        // Two harmonics: views (3, 4), (0, 1), (2, 0) against zeros.
        let a = [3.0, 4.0, 0.0, 1.0, 2.0, 0.0];
        assert_eq!(magnitude_views(&a, &[0.0; 6]), [5.0, 1.0, 2.0]);
        assert_eq!(magnitude(&a, &[0.0; 6]), 8.0);
    }

    #[test]
    fn swapped_planes_are_forgiven() {
        let a = [3.0, 4.0, 0.0, 1.0, 2.0, 0.0];
        let b = [3.0, 4.0, 2.0, 0.0, 0.0, 1.0];
        assert_eq!(magnitude_swapped(&a, &b), 0.0);
        assert!((magnitude(&a, &b) - 2.0 * 5f64.sqrt()).abs() < 1e-15);
    }

    /// The row that turning axes around makes of a row of one harmonic, written out view by view.
    fn turned(row: &[f32], flips: [bool; 3]) -> Vec<f32> {
        let mut out = Vec::new();
        for i in 0..3 {
            let (right, up) = (flips[(i + 1) % 3], flips[(i + 2) % 3]);
            for start in 0..2 {
                let source = if right { 1 - start } else { start };
                let [re, im] = [row[4 * i + 2 * source], row[4 * i + 2 * source + 1]];
                out.extend([re, if right != up { -im } else { im }]);
            }
        }
        out
    }

    proptest! {
        #[test]
        fn turned_axes_cost_nothing_and_distances_are_symmetric(
            a in prop::collection::vec(-1.0f32..1.0, 12), b in prop::collection::vec(-1.0f32..1.0, 12), signs in 0u8..8,
        ) {
            let flips = [0, 1, 2].map(|i| signs >> i & 1 == 1);
            prop_assert_eq!(phase(&a, &turned(&a, flips)), 0.0);
            prop_assert_eq!(phase(&a, &b), phase(&b, &a));
            prop_assert!((phase(&a, &b) - phase(&turned(&a, flips), &b)).abs() < 1e-12);
            prop_assert_eq!(magnitude(&a, &b), magnitude(&b, &a));
            prop_assert_eq!(magnitude_swapped(&a, &b), magnitude_swapped(&b, &a));
        }
    }
}
