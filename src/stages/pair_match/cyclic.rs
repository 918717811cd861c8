//! Eq. (3): cyclic matching of corner distances.

use super::{Correspondence, Options, Order};
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::Point;

/// The position on the second loop (of `n` corners) of corner `k` of the first.
pub(super) fn position(k: usize, offset: usize, order: Order, n: usize) -> usize {
    match order {
        Order::Same => (offset + k) % n,
        Order::Reversed => (offset + n - k % n) % n,
    }
}

/// Shows `look` the corners of the second loop that belong to those of the first, one after the other.
pub(super) fn from_offset<T>(corners: &[T], offset: usize, order: Order, look: impl FnMut(&T)) {
    match order {
        Order::Same => corners[offset..].iter().chain(&corners[..offset]).for_each(look),
        Order::Reversed => corners[..=offset].iter().rev().chain(corners[offset + 1..].iter().rev()).for_each(look),
    }
}

/// Closed loops of corners and the distances between consecutive ones, measured once for all pairs of loops.
#[derive(Default)]
pub(super) struct Loops<'a> {
    corners: Vec<&'a [Point]>,
    /// Of each loop the sides twice around, and twice around the other way: from any corner on they lie side by side.
    sides: Vec<f64>,
    /// Where those of each loop start.
    starts: Vec<usize>,
}

impl<'a> Loops<'a> {
    pub fn push(&mut self, corners: &'a [Point]) {
        let start = self.sides.len();
        self.corners.push(corners);
        self.starts.push(start);
        let next = corners.iter().cycle().skip(1);
        self.sides.extend(corners.iter().zip(next).map(|(p, q)| (q - p).norm()));
        let end = self.sides.len();
        self.sides.extend_from_within(start..end);
        self.sides.extend_from_within(start..);
        self.sides[2 * end - start..].reverse();
    }

    pub fn get(&self, number: usize) -> Loop<'_> {
        let (corners, start) = (self.corners[number], self.starts[number]);
        Loop { corners, sides: &self.sides[start..start + 4 * corners.len()] }
    }
}

/// One of the loops.
#[derive(Clone, Copy)]
pub(super) struct Loop<'a> {
    corners: &'a [Point],
    sides: &'a [f64],
}

impl Loop<'_> {
    /// The sides from a corner on. Side k runs from corner k to k + 1; reversed, it is met from its other end.
    fn from(&self, offset: usize, order: Order) -> &[f64] {
        let n = self.corners.len();
        let start = match order {
            Order::Same => offset,
            Order::Reversed => 3 * n - 1 - (offset + n - 1) % n,
        };
        &self.sides[start..start + n]
    }
}

/// How correspondences are looked for.
pub(super) struct Search<'a> {
    /// Largest sum for each corner, mm.
    pub limit: f64,
    pub options: &'a Options,
    pub cancel: &'a Cancel,
}

impl Search<'_> {
    /// Shows `keep` every correspondence in the given order whose sum is within the limit.
    pub(super) fn matches(
        &self,
        a: Loop,
        b: Loop,
        order: Order,
        keep: &mut impl FnMut(Correspondence),
    ) -> Result<(), Cancelled> {
        let (count, others) = (a.corners.len(), b.corners.len());
        if count == others {
            let total = self.limit * count as f64;
            for offset in 0..count {
                self.cancel.check()?;
                if difference(a.from(0, Order::Same), b.from(offset, order), total, self.options.absolute) <= total {
                    keep(Correspondence::Cyclic { offset: offset as u32, order });
                }
            }
        } else if count.abs_diff(others) <= self.options.extra_corners {
            self.subsequences(a.corners, b.corners, order, keep)?;
        }
        Ok(())
    }

    /// Correspondences of all corners of the shorter loop with a cyclic subsequence of the longer one.
    ///
    /// From each start a dynamic program over (corners matched, corners left out) keeps the smallest sum.
    fn subsequences(
        &self,
        a: &[Point],
        b: &[Point],
        order: Order,
        keep: &mut impl FnMut(Correspondence),
    ) -> Result<(), Cancelled> {
        let swapped = a.len() > b.len();
        let (short, long) = if swapped { (b, a) } else { (a, b) };
        let total = self.limit * short.len() as f64;
        for offset in 0..long.len() {
            self.cancel.check()?;
            if let Some(chain) = subsequence(short, long, offset, order, total) {
                let pair = |(i, j): (usize, usize)| if swapped { (j as u32, i as u32) } else { (i as u32, j as u32) };
                keep(Correspondence::Listed { corners: chain.into_iter().enumerate().map(pair).collect(), order });
            }
        }
        Ok(())
    }
}

/// The sum of eq. (3), given up once it passes `limit`.
fn difference(p: &[f64], q: &[f64], limit: f64, absolute: bool) -> f64 {
    let mut sum = 0.0;
    for (side, other) in p.iter().zip(q) {
        sum += if absolute { (side - other).abs() } else { side - other };
        if absolute && sum > limit {
            break;
        }
    }
    sum.abs()
}

/// The best subsequence of `long` that starts at `offset`, as positions; `None` if its sum is above `total`.
fn subsequence(short: &[Point], long: &[Point], offset: usize, order: Order, total: f64) -> Option<Vec<usize>> {
    let (n, spare) = (short.len(), long.len() - short.len());
    let at = |k: usize| &long[position(k, offset, order, long.len())];
    // Corner k of the short loop lies on step k + s of the long one; with the step before it.
    let mut sums = vec![(f64::INFINITY, 0); n * (spare + 1)];
    let place = |k: usize, s: usize| k * (spare + 1) + s;
    sums[0] = (0.0, 0);
    for k in 1..n {
        let side = (short[k] - short[k - 1]).norm();
        for s in 0..=spare {
            for before in 0..=s {
                let cost = (side - (at(k + s) - at(k - 1 + before)).norm()).abs() + sums[place(k - 1, before)].0;
                if cost < sums[place(k, s)].0 {
                    sums[place(k, s)] = (cost, before);
                }
            }
        }
    }
    let closing = (short[0] - short[n - 1]).norm();
    let closed = |s: usize| sums[place(n - 1, s)].0 + (closing - (at(0) - at(n - 1 + s)).norm()).abs();
    let mut s = (0..=spare).min_by(|&s, &t| closed(s).total_cmp(&closed(t)))?;
    if closed(s) > total {
        return None;
    }
    let mut chain = vec![0; n];
    for k in (0..n).rev() {
        chain[k] = position(k + s, offset, order, long.len());
        s = sums[place(k, s)].1;
    }
    Some(chain)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(list: &[[f64; 2]]) -> Vec<Point> {
        list.iter().map(|&[x, y]| Point::new(x, y, 0.0)).collect()
    }

    fn loops<'a>(of: impl IntoIterator<Item = &'a [Point]>) -> Loops<'a> {
        let mut loops = Loops::default();
        of.into_iter().for_each(|corners| loops.push(corners));
        loops
    }

    fn found(a: &[Point], b: &[Point], order: Order, options: &Options) -> Vec<Correspondence> {
        let mut all = Vec::new();
        let search = Search { limit: 1e-3, options, cancel: &Cancel::new() };
        let loops = loops([a, b]);
        search.matches(loops.get(0), loops.get(1), order, &mut |c| all.push(c)).unwrap();
        all
    }

    #[test]
    fn a_rectangle_is_its_own_mirror_image_in_two_ways() {
        let rectangle = points(&[[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [0.0, 1.0]]);
        let ways = found(&rectangle, &rectangle, Order::Reversed, &Options::default());
        // Corner 0 to corner 1 (left-right) or to corner 3 (top-bottom).
        let cyclic = |offset| Correspondence::Cyclic { offset, order: Order::Reversed };
        assert_eq!(ways, [cyclic(1), cyclic(3)]);
    }

    #[test]
    fn without_absolute_values_equal_perimeters_match() {
        let oblong = points(&[[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [0.0, 1.0]]);
        let square = points(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
        assert!(found(&oblong, &square, Order::Same, &Options::default()).is_empty());
        assert_eq!(found(&oblong, &square, Order::Same, &Options::paper()).len(), 4);
    }

    #[test]
    fn a_scalene_triangle_matches_its_mirror_image_in_one_way() {
        let triangle = points(&[[0.0, 0.0], [4.0, 0.0], [0.0, 3.0]]);
        let image = points(&[[0.0, 0.0], [0.0, 3.0], [-4.0, 0.0]]);
        assert_eq!(found(&triangle, &image, Order::Reversed, &Options::default()).len(), 1);
        assert!(found(&triangle, &image, Order::Same, &Options::default()).is_empty());
    }

    #[test]
    fn a_search_ends_when_cancelled() {
        let (options, cancel) = (Options::default(), Cancel::new());
        cancel.cancel();
        let search = Search { limit: 1e-3, options: &options, cancel: &cancel };
        let corners = [3, 4].map(|n| (0..n).map(|i| Point::new(f64::from(i), 0.0, 0.0)).collect::<Vec<_>>());
        let loops = loops(corners.iter().map(|c| &c[..]));
        for other in 0..2 {
            let found = search.matches(loops.get(0), loops.get(other), Order::Same, &mut |_| panic!("found one"));
            assert!(found.is_err());
        }
    }

    #[test]
    fn corners_follow_each_other_from_the_offset_on() {
        for order in [Order::Same, Order::Reversed] {
            for offset in 0..4 {
                let mut met = Vec::new();
                from_offset(&[0, 1, 2, 3], offset, order, |&corner| met.push(corner));
                assert_eq!(met, [0, 1, 2, 3].map(|k| position(k, offset, order, 4)));
            }
        }
    }

    #[test]
    fn an_extra_corner_is_left_out() {
        let triangle = points(&[[0.0, 0.0], [4.0, 0.0], [0.0, 3.0]]);
        let image = points(&[[0.0, 0.0], [0.0, 3.0], [-2.0, 1.5], [-4.0, 0.0]]);
        let ways = found(&triangle, &image, Order::Reversed, &Options::default());
        let corners = vec![(0, 0), (1, 3), (2, 1)];
        assert_eq!(ways, [Correspondence::Listed { corners: corners.clone(), order: Order::Reversed }]);
        let turned = corners.iter().map(|&(i, j)| (j, i)).collect::<Vec<_>>();
        let Correspondence::Listed { corners: mut back, .. } =
            found(&image, &triangle, Order::Reversed, &Options::default()).remove(0)
        else {
            panic!("the longer loop may come first")
        };
        back.sort_unstable();
        let mut turned = turned;
        turned.sort_unstable();
        assert_eq!(back, turned);
    }
}
