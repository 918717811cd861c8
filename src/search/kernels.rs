//! Distances in f32, a few rows and a few vectors of queries at a time: to leave rows out, not to rank them.
//!
//! All are sums of squares of differences, so that nothing cancels: a distance is off by at most [`SLACK`] of itself.

use pulp::Simd;

use crate::stages::descriptor::{HARMONICS, MAGNITUDES, PHASES};

/// How far a distance in f32 may be off, as a share of it. A sum of n squares in f32 is off by (n + 2) / 2^24 at most
/// and its root by half of that; the longest sums have 128 terms.
pub(super) const SLACK: f64 = 1e-5;
/// .. and what the squares of tiny differences lose to underflow.
pub(super) const UNDERFLOW: f64 = 1e-15;
/// Lanes of [`magnitude`]: one vector of the widest common registers.
const LANES: usize = 16;

/// The distances of R rows to Q vectors of queries.
///
/// `queries` holds, dimension by dimension, Q vectors whose lanes are queries.
pub(super) trait Tile<const R: usize, const Q: usize>: Copy + Sync {
    /// Numbers in a row.
    const LENGTH: usize;

    fn distances<S: Simd>(simd: S, queries: &[S::f32s], rows: [&[f32]; R]) -> [[S::f32s; Q]; R];
}

/// Eq. (8) of magnitudes. Four rows by two vectors keep eight sums in registers, beside what is loaded.
#[derive(Clone, Copy)]
pub(super) struct Magnitudes;

impl Tile<4, 2> for Magnitudes {
    const LENGTH: usize = MAGNITUDES;

    #[inline(always)]
    fn distances<S: Simd>(simd: S, queries: &[S::f32s], rows: [&[f32]; 4]) -> [[S::f32s; 2]; 4] {
        let first = view(simd, (queries, 0), (rows, 0));
        let second = view(simd, (queries, 1), (rows, 1));
        added(simd, added(simd, first, second), view(simd, (queries, 2), (rows, 2)))
    }
}

/// The same in the better order of the second and third view.
#[derive(Clone, Copy)]
pub(super) struct Swapped;

impl Tile<4, 2> for Swapped {
    const LENGTH: usize = MAGNITUDES;

    #[inline(always)]
    fn distances<S: Simd>(simd: S, queries: &[S::f32s], rows: [&[f32]; 4]) -> [[S::f32s; 2]; 4] {
        let first = view(simd, (queries, 0), (rows, 0));
        let [second, third] = [1, 2].map(|i| (queries, i));
        let straight = added(simd, view(simd, second, (rows, 1)), view(simd, third, (rows, 2)));
        let crossed = added(simd, view(simd, second, (rows, 2)), view(simd, third, (rows, 1)));
        let least = |r: usize, q: usize| simd.min_f32s(straight[r][q], crossed[r][q]);
        added(simd, first, std::array::from_fn(|r| std::array::from_fn(|q| least(r, q))))
    }
}

/// A third of a row, or of queries.
#[inline(always)]
fn view_of<T>(all: &[T], i: usize) -> &[T] {
    let length = all.len() / 3;
    &all[i * length..][..length]
}

#[inline(always)]
fn added<S: Simd>(simd: S, a: [[S::f32s; 2]; 4], b: [[S::f32s; 2]; 4]) -> [[S::f32s; 2]; 4] {
    std::array::from_fn(|r| std::array::from_fn(|q| simd.add_f32s(a[r][q], b[r][q])))
}

/// Euclidean distances of the i-th view of the queries and the j-th of the rows. A function, for a closure may be
/// compiled for every processor, and each of its operations becomes a call.
#[inline(always)]
fn view<S: Simd>(simd: S, (queries, i): (&[S::f32s], usize), (rows, j): ([&[f32]; 4], usize)) -> [[S::f32s; 2]; 4] {
    roots(simd, view_of(queries, i), rows.map(|row| view_of(row, j)))
}

/// Euclidean distances of queries and rows.
#[inline(always)]
fn roots<S: Simd>(simd: S, queries: &[S::f32s], rows: [&[f32]; 4]) -> [[S::f32s; 2]; 4] {
    let mut sums = [[simd.splat_f32s(0.0); 2]; 4];
    let rows = rows.map(|row| &row[..HARMONICS]);
    for (i, query) in queries.chunks_exact(2).enumerate().take(HARMONICS) {
        for (sums, row) in sums.iter_mut().zip(rows) {
            let value = simd.splat_f32s(row[i]);
            for (sum, query) in sums.iter_mut().zip(query) {
                let difference = simd.sub_f32s(*query, value);
                *sum = simd.mul_add_e_f32s(difference, difference, *sum);
            }
        }
    }
    sums.map(|sums| sums.map(|sum| simd.sqrt_f32s(sum)))
}

/// Eq. (8) of phases, the least over the signs of the axes, as [`crate::distance::phase`] tells it.
#[derive(Clone, Copy)]
pub(super) struct Phases;

impl Tile<1, 1> for Phases {
    const LENGTH: usize = PHASES;

    #[inline(always)]
    fn distances<S: Simd>(simd: S, queries: &[S::f32s], [row]: [&[f32]; 1]) -> [[S::f32s; 1]; 1] {
        let views = [
            turned(simd, view_of(queries, 0), view_of(row, 0)),
            turned(simd, view_of(queries, 1), view_of(row, 1)),
            turned(simd, view_of(queries, 2), view_of(row, 2)),
        ];
        let mut least = simd.splat_f32s(f32::INFINITY);
        for signs in 0..8_usize {
            let flipped = |axis: usize| signs >> (axis % 3) & 1;
            let of = |i: usize| views[i][flipped(i + 1)][flipped(i + 2)];
            let sum = simd.add_f32s(simd.add_f32s(of(0), of(1)), of(2));
            // A NaN in the second operand stays.
            least = simd.min_f32s(least, sum);
        }
        [[least]]
    }
}

/// Distances of a view with the other's axes turned around: `[right][up]`.
#[inline(always)]
fn turned<S: Simd>(simd: S, queries: &[S::f32s], row: &[f32]) -> [[S::f32s; 2]; 2] {
    let half = row.len() / 2;
    let zero = simd.splat_f32s(0.0);
    // For equal and for exchanged starting points: real parts, imaginary parts, the same with one conjugate.
    let (mut same, mut other) = ([zero; 3], [zero; 3]);
    for i in (0..half).step_by(2) {
        let values = [i, i + 1, half + i, half + i + 1].map(|at| simd.splat_f32s(row[at]));
        let query = [queries[i], queries[i + 1], queries[half + i], queries[half + i + 1]];
        for (sums, starts) in [(&mut same, [0, 2]), (&mut other, [2, 0])] {
            for (a, b) in [(0, starts[0]), (2, starts[1])] {
                let real = simd.sub_f32s(query[a], values[b]);
                let plain = simd.sub_f32s(query[a + 1], values[b + 1]);
                let conjugate = simd.add_f32s(query[a + 1], values[b + 1]);
                for (sum, part) in sums.iter_mut().zip([real, plain, conjugate]) {
                    *sum = simd.mul_add_e_f32s(part, part, *sum);
                }
            }
        }
    }
    let half = simd.splat_f32s(0.5);
    let root = |[real, imaginary, conjugate]: [S::f32s; 3]| {
        [imaginary, conjugate].map(|part| simd.sqrt_f32s(simd.mul_f32s(half, simd.add_f32s(real, part))))
    };
    let ([plain, conjugate], [other_plain, other_conjugate]) = (root(same), root(other));
    [[plain, conjugate], [other_conjugate, other_plain]]
}

/// Eq. (8) of two rows of magnitudes, for so few queries that vectors of them would be mostly empty.
#[inline(always)]
pub(super) fn magnitude(query: &[f32], row: &[f32]) -> f32 {
    let views = query.chunks_exact(HARMONICS).zip(row.chunks_exact(HARMONICS));
    views.map(|(a, b)| squared(a, b).sqrt()).sum()
}

#[inline(always)]
fn squared(a: &[f32], b: &[f32]) -> f32 {
    let mut sums = [0.0; LANES];
    for (a, b) in a.chunks_exact(LANES).zip(b.chunks_exact(LANES)) {
        for i in 0..LANES {
            let difference = a[i] - b[i];
            sums[i] += difference * difference;
        }
    }
    // Halved again and again, which vectors do at once.
    for half in [LANES / 2, LANES / 4, LANES / 8, LANES / 16] {
        for i in 0..half {
            sums[i] += sums[i + half];
        }
    }
    sums[0]
}

const _: () = assert!(HARMONICS.is_multiple_of(LANES) && MAGNITUDES == 3 * HARMONICS);
