//! The nearest rows of many queries in one pass over the rows: exact, whatever the order of the additions.
//!
//! Method: distances in f32 leave out all rows that are certainly farther than the k nearest so far; what remains is
//! measured in f64 by the definition and kept in a bounded heap, equal distances in the order of the rows. The rows
//! are shared out among the threads; in each share, blocks of rows that fit the nearest cache meet all queries before
//! the next block is read, so that memory is read once for all queries.
//!
//! Cost: one pass over the rows, 2 operations a number and query. Memory: k hits a query and share.

use std::collections::BinaryHeap;

use pulp::{Arch, Simd, WithSimd, bytemuck};
use rayon::prelude::*;

use super::kernels::{Magnitudes, Phases, SLACK, Swapped, Tile, UNDERFLOW, magnitude};
use super::{Kind, Rows};

/// Bytes of a block of rows: half of a usual second-level cache's share of a core.
const BLOCK: usize = 128 << 10;
/// Rows shared out at least: fewer are not worth a thread.
const SHARE: usize = 4096;
/// Up to so many queries are compared one by one: more fill vectors.
const FEW: usize = 3;

/// The k nearest so far: the farthest of them on top.
pub(super) struct Nearest {
    k: usize,
    /// Distances are not negative, so that their bits have their order.
    heap: BinaryHeap<(u64, usize)>,
    /// Whether a distance was not a number.
    pub undefined: bool,
}

impl Nearest {
    fn new(k: usize) -> Self {
        Self { k, heap: BinaryHeap::new(), undefined: false }
    }

    /// Takes a row in, if it is among the nearest.
    fn add(&mut self, distance: f64, row: usize) {
        self.undefined |= distance.is_nan();
        let found = (distance.to_bits(), row);
        if self.heap.len() < self.k {
            self.heap.push(found);
        } else if let Some(mut farthest) = self.heap.peek_mut()
            && found < *farthest
        {
            *farthest = found;
        }
    }

    /// Rows whose distance in f32 is above this are not among the nearest.
    fn limit(&self) -> f32 {
        match self.heap.peek() {
            Some((farthest, _)) if self.heap.len() == self.k => {
                let limit = f64::from_bits(*farthest) * (1.0 + SLACK) + UNDERFLOW;
                // Where squares may overflow f32 tells nothing.
                if limit < 1e18 { limit as f32 } else { f32::INFINITY }
            }
            _ => f32::INFINITY,
        }
    }

    fn join(mut self, other: Self) -> Self {
        self.undefined |= other.undefined;
        other.heap.into_iter().for_each(|(distance, row)| self.add(f64::from_bits(distance), row));
        self
    }

    /// Distances and rows, nearest first.
    pub fn sorted(self) -> impl Iterator<Item = (f64, usize)> {
        self.heap.into_sorted_vec().into_iter().map(|(distance, row)| (f64::from_bits(distance), row))
    }
}

/// The `k` nearest rows of each query; all have the rows' length.
pub(super) fn nearest(rows: &Rows, queries: &[&[f32]], k: usize) -> Vec<Nearest> {
    let none = || queries.iter().map(|_| Nearest::new(k)).collect::<Vec<_>>();
    if k == 0 || queries.is_empty() {
        return none();
    }
    let count = rows.values.len() / rows.length;
    let share = count.div_ceil(4 * rayon::current_num_threads()).max(SHARE);
    let shares = rows.values.par_chunks(share * rows.length).enumerate();
    let found = shares.map(|(i, values)| {
        let mut nearest = none();
        look_through(&Rows { values, ..*rows }, i * share, queries, &mut nearest);
        nearest
    });
    found.reduce(none, |a, b| a.into_iter().zip(b).map(|(a, b)| a.join(b)).collect())
}

/// Looks through one share of the rows, whose first is row `first`.
fn look_through(rows: &Rows, first: usize, queries: &[&[f32]], nearest: &mut [Nearest]) {
    let arch = Arch::new();
    match rows.kind {
        Kind::Magnitude if queries.len() <= FEW => arch.dispatch(OneByOne { rows, first, queries, nearest }),
        Kind::Magnitude => arch.dispatch(Blocks { rows, first, queries, nearest, tile: Magnitudes }),
        Kind::Swapped => arch.dispatch(Blocks { rows, first, queries, nearest, tile: Swapped }),
        Kind::Phase => arch.dispatch(Blocks { rows, first, queries, nearest, tile: Phases }),
    }
}

/// A few queries by magnitudes.
struct OneByOne<'a> {
    rows: &'a Rows<'a>,
    first: usize,
    queries: &'a [&'a [f32]],
    nearest: &'a mut [Nearest],
}

impl WithSimd for OneByOne<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let length = self.rows.length;
        for (block, values) in self.rows.values.chunks(block_rows(length) * length).enumerate() {
            let first = self.first + block * block_rows(length);
            for (query, nearest) in self.queries.iter().zip(self.nearest.iter_mut()) {
                let mut limit = nearest.limit();
                for (i, row) in values.chunks_exact(length).enumerate() {
                    // What is not a number is looked at.
                    if !is_above(magnitude(query, row), limit) {
                        nearest.add(self.rows.distance(query, row), first + i);
                        limit = nearest.limit();
                    }
                }
            }
        }
    }
}

#[inline(always)]
fn is_above(distance: f32, limit: f32) -> bool {
    distance > limit
}

fn block_rows(length: usize) -> usize {
    BLOCK / (length * size_of::<f32>())
}

/// Many queries, a vector of them at a time.
struct Blocks<'a, T> {
    rows: &'a Rows<'a>,
    first: usize,
    queries: &'a [&'a [f32]],
    nearest: &'a mut [Nearest],
    tile: T,
}

impl WithSimd for Blocks<'_, Magnitudes> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.run::<S, 4, 2>(simd);
    }
}

impl WithSimd for Blocks<'_, Swapped> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.run::<S, 4, 2>(simd);
    }
}

impl WithSimd for Blocks<'_, Phases> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.run::<S, 1, 1>(simd);
    }
}

impl<T> Blocks<'_, T> {
    #[inline(always)]
    fn run<S: Simd, const R: usize, const Q: usize>(mut self, simd: S)
    where
        T: Tile<R, Q>,
    {
        let _ = self.tile;
        let (length, width) = (T::LENGTH, Q * S::F32_LANES);
        let turned = turned::<S>(simd, self.queries, length, width);
        let mut limits = vec![simd.splat_f32s(f32::INFINITY); self.queries.len().div_ceil(width) * Q];
        // Lanes without a query are near to nothing.
        bytemuck::cast_slice_mut::<_, f32>(&mut limits)[self.queries.len()..].fill(f32::NEG_INFINITY);
        let rows = self.rows.values;
        for (block, values) in rows.chunks(block_rows(length) * length).enumerate() {
            let first = self.first + block * block_rows(length);
            for (group, queries) in turned.chunks_exact(length * Q).enumerate() {
                for (i, some) in values.chunks(R * length).enumerate() {
                    // The last few rows are met again in place of those that are not there.
                    let count = some.len() / length;
                    let row = |r: usize| &some[r.min(count - 1) * length..][..length];
                    let distances = T::distances(simd, queries, std::array::from_fn(row));
                    for (r, of_row) in distances.iter().enumerate().take(count) {
                        for (q, distances) in of_row.iter().enumerate() {
                            let vector = group * Q + q;
                            let above = simd.greater_than_f32s(*distances, limits[vector]);
                            if simd.first_true_m32s(simd.not_m32s(above)) < S::F32_LANES {
                                self.check::<S>(distances, &mut limits, vector, (first + i * R + r, row(r)));
                            }
                        }
                    }
                }
            }
        }
    }

    /// Measures a row by the definition for the queries of a vector that it may be near to.
    #[inline(never)]
    fn check<S: Simd>(&mut self, distances: &S::f32s, limits: &mut [S::f32s], vector: usize, row: (usize, &[f32])) {
        let distances: &[f32] = bytemuck::cast_slice(std::slice::from_ref(distances));
        let limits: &mut [f32] = bytemuck::cast_slice_mut(std::slice::from_mut(&mut limits[vector]));
        let first = vector * S::F32_LANES;
        for (lane, (distance, limit)) in distances.iter().zip(limits).enumerate() {
            let Some(query) = self.queries.get(first + lane).filter(|_| !is_above(*distance, *limit)) else { continue };
            let nearest = &mut self.nearest[first + lane];
            nearest.add(self.rows.distance(query, row.1), row.0);
            *limit = nearest.limit();
        }
    }
}

/// The queries in groups of `width`, in each group dimension by dimension; lanes without a query hold zeros.
#[inline(always)]
fn turned<S: Simd>(simd: S, queries: &[&[f32]], length: usize, width: usize) -> Vec<S::f32s> {
    let groups = queries.len().div_ceil(width);
    let mut turned = vec![simd.splat_f32s(0.0); groups * length * (width / S::F32_LANES)];
    let values: &mut [f32] = bytemuck::cast_slice_mut(&mut turned);
    for (i, query) in queries.iter().enumerate() {
        let (group, lane) = (i / width, i % width);
        for (dimension, value) in query.iter().enumerate() {
            values[(group * length + dimension) * width + lane] = *value;
        }
    }
    turned
}
