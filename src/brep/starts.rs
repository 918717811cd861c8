//! Where an iteration towards the nearest point of a curve or surface starts when there is no hint: the best of a few
//! samples.

use super::Curve;
use super::surface::Surface;
use crate::geometry::{Aabb, Point};

/// Samples in each knot span when there is no hint.
const SAMPLES: usize = 12;
/// How far rounding moves a point of a curve at most, as a share of its coordinates.
const ROUNDING: f64 = 1e-9;
/// Nodes of the grid that finds a start when there is no hint.
const MAX_NODES: usize = 16_384;

/// A surface sampled on a grid over its domain (clipped to something finite), finer where there are many knot spans.
#[derive(Clone, Debug)]
pub(super) struct Samples {
    columns: usize,
    nodes: Vec<([f64; 2], Point)>,
}

impl Samples {
    pub fn of(surface: &Surface) -> Self {
        let [u0, u1, v0, v1] = surface.domain().map(|a| a.clamp(-1e6, 1e6));
        let mut cells = match surface {
            Surface::Nurbs(nurbs) => nurbs.spans().map(|n| (3 * n + 1).max(6)),
            _ => [24, 24],
        };
        while (cells[0] + 1) * (cells[1] + 1) > MAX_NODES {
            let longer = usize::from(cells[1] > cells[0]);
            cells[longer] = cells[longer].div_ceil(2);
        }
        let [nu, nv] = cells;
        let [mut us, mut vs] = [(u0, u1, nu), (v0, v1, nv)]
            .map(|(from, to, n)| (0..=n).map(|i| from + (to - from) * i as f64 / n as f64).collect::<Vec<_>>());
        let size = (surface.point(u0, v0) - surface.point(0.5 * (u0 + u1), 0.5 * (v0 + v1))).norm();
        leave_poles(&mut us, &vs, size, |u, v| surface.point(u, v));
        leave_poles(&mut vs, &us, size, |v, u| surface.point(u, v));
        let uv = us.iter().flat_map(|&u| vs.iter().map(move |&v| [u, v]));
        Self { columns: nv + 1, nodes: uv.map(|uv| (uv, surface.point(uv[0], uv[1]))).collect() }
    }

    /// The parameters of at most `count` samples that are nearer to `p` than the samples around them, nearest first.
    pub fn nearest(&self, p: &Point, count: usize) -> Vec<[f64; 2]> {
        let distances: Vec<f64> = self.nodes.iter().map(|(_, q)| (q - p).norm_squared()).collect();
        let (n, columns) = (distances.len(), self.columns);
        let lowest = |&i: &usize| {
            let d = distances[i];
            (i % columns == 0 || d <= distances[i - 1])
                && (i % columns + 1 == columns || d <= distances[i + 1])
                && (i < columns || d <= distances[i - columns])
                && (i + columns >= n || d <= distances[i + columns])
        };
        let mut minima: Vec<usize> = (0..n).filter(lowest).collect();
        minima.sort_by(|&a, &b| distances[a].total_cmp(&distances[b]));
        minima.truncate(count);
        minima.into_iter().map(|i| self.nodes[i].0).collect()
    }
}

/// Moves the first and the last line off a side that has shrunk to a point: there the surface does not move with the
/// other parameter, and an iteration that starts with a wrong one stays.
fn leave_poles(lines: &mut [f64], across: &[f64], size: f64, at: impl Fn(f64, f64) -> Point) {
    let shrunk = |line: f64| across.iter().all(|&t| (at(line, t) - at(line, across[0])).norm() <= 1e-6 * size);
    let n = lines.len();
    for (side, next) in [(0, 1), (n - 1, n - 2)] {
        if shrunk(lines[side]) {
            lines[side] += 0.25 * (lines[next] - lines[side]);
        }
    }
}

/// The sample with the least size. Pieces that are farther than an end of the curve, where edges end, are left out.
pub(super) fn best_by(curve: &Curve, size: &impl Fn(f64) -> f64, least: impl Iterator<Item = f64>) -> f64 {
    let breaks = curve.breaks();
    let sample = |pair: &[f64], i: usize| pair[0] + (pair[1] - pair[0]) * i as f64 / SAMPLES as f64;
    let mut at_ends = None;
    let mut best = (f64::INFINITY, breaks.first().copied().unwrap_or(0.0));
    for (pair, least) in breaks.windows(2).zip(least) {
        if least > 0.0 {
            let ends = || size(breaks[0]).min(size(sample(&breaks[breaks.len() - 2..], SAMPLES)));
            if least > best.0.min(*at_ends.get_or_insert_with(ends)) {
                continue;
            }
        }
        for t in (0..=SAMPLES).map(|i| sample(pair, i)) {
            let value = size(t);
            if value < best.0 {
                best = (value, t);
            }
        }
    }
    best.1
}

/// The squares of the least distances of pieces of which nothing is known.
pub(super) fn anywhere() -> impl Iterator<Item = f64> {
    std::iter::repeat(0.0)
}

/// The square of a distance that no point of the hull is nearer than.
pub(super) fn least_distance(points: &[Point], p: &Point) -> f64 {
    let bounds = Aabb::of(points);
    let gap = |i: usize| {
        let (low, high) = (bounds.min[i], bounds.max[i]);
        // Whatever rounding does to a point of the curve.
        let margin = ROUNDING * low.abs().max(high.abs()).max(p[i].abs());
        (low - p[i]).max(p[i] - high).max(margin) - margin
    };
    [0, 1, 2].map(gap).iter().map(|gap| gap * gap).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::nurbs::NurbsCurve;
    use crate::geometry::Vector;

    #[test]
    fn pieces_out_of_reach_do_not_change_what_is_found() {
        // A coil: each point has several places that look nearest from nearby.
        let at = |i: i32| Point::new(f64::from(i).cos(), f64::from(i).sin(), 0.05 * f64::from(i));
        let points: Vec<_> = (0..40).map(at).collect();
        let inner = (1..37).map(f64::from);
        let knots = [0.0; 4].into_iter().chain(inner).chain([37.0; 4]).collect();
        let curve = Curve::Nurbs(NurbsCurve { degree: 3, knots, points, weights: Vec::new(), closed: false });
        for t in [0.0, 0.4, 9.0, 20.3, 36.9, 37.0] {
            let p = curve.point(t) + Vector::new(0.01, -0.02, 0.01);
            let size = |t: f64| (curve.point(t) - p).norm_squared();
            let Curve::Nurbs(nurbs) = &curve else { unreachable!() };
            let least: Vec<f64> = nurbs.pieces().map(|points| least_distance(points, &p)).collect();
            assert_eq!(best_by(&curve, &size, least.iter().copied()), best_by(&curve, &size, anywhere()));
            assert!(least.iter().filter(|l| **l > size(t)).count() > 20);
        }
    }
}
