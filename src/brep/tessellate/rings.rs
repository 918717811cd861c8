//! The wall between two rings that go round a straight-lined surface once each: a strip that needs no cut.

use std::ops::Range;

use super::Few;
use super::boundary::{Path, rectangle};
use super::chart::{Chart, Uv};
use super::domain::Patch;
use super::edges::Fineness;
use super::triangulate::zip;
use crate::geometry::polygon;

/// How much wider than a step of the curvature triangles may be.
pub(super) const WIDEST: f64 = 2.2;

/// The wall, where two rings bound one and neither turns back on its way round.
pub(super) fn between_two_rings(chart: &Chart, paths: &[Path], fineness: &Fineness, patch: &mut Patch) -> Option<()> {
    let [a, b] = paths else { return None };
    let period = chart.periods[0]?;
    let once = a.winding[0].abs() == 1 && a.winding[1] == 0 && b.winding == [-a.winding[0], 0];
    if !once || !chart.surface.is_ruled_along_v() {
        return None;
    }
    let (low, high) = if level(a) < level(b) { (a, b) } else { (b, a) };
    patch.clear();
    let [lower, upper] = [low, high].map(|p| add_ring(patch, p, period, low.uv[0][0]));
    let [_, _, v0, v1] = rectangle(patch.uv.iter());
    let steps = chart.steps([0.0, period, v0, v1], fineness)[0].max(3);
    patch.sides = sides(paths, Some(low));
    add_wall(patch, &lower, &upper, WIDEST * period / steps as f64)
}

/// The mean height of a ring.
pub(super) fn level(ring: &Path) -> f64 {
    ring.uv.iter().map(|uv| uv[1]).sum::<f64>() / ring.uv.len() as f64
}

/// On which side of each ring the face lies: of the lower one on the left, where that runs towards growing parameters.
pub(super) fn sides(rings: &[Path], lower: Option<&Path>) -> Few<f64> {
    let is_lower = |ring: &Path| lower.is_some_and(|lower| std::ptr::eq(lower, ring));
    rings.iter().map(|ring| f64::from(if is_lower(ring) { ring.winding[0] } else { -ring.winding[0] })).collect()
}

/// Points of a patch that follow each other.
pub(super) type Chain = Range<u32>;

/// Adds the triangles between two chains, where both run towards growing u and none is wider than `widest`.
pub(super) fn add_wall(patch: &mut Patch, lower: &Chain, upper: &Chain, widest: f64) -> Option<()> {
    let uv = |chain: &Chain| &patch.uv[chain.start as usize..chain.end as usize];
    let rising = |chain: &[Uv]| chain.windows(2).all(|w| w[1][0] >= w[0][0]);
    let around = uv(lower).iter().chain(uv(upper).iter().rev()).copied();
    let area = polygon::signed_area(around);
    if !(rising(uv(lower)) && rising(uv(upper)) && area > 0.0) {
        return None;
    }
    zip(&patch.uv, lower.clone(), upper.clone(), area, widest, &mut patch.triangles)
}

/// Adds a ring once round in the direction of growing u, the first point repeated at the end; it starts with the
/// point nearest to `start`.
pub(super) fn add_ring(patch: &mut Patch, path: &Path, period: f64, start: f64) -> Chain {
    let n = path.uv.len();
    let beyond = |i: usize| path.uv[i][0] - start - period * ((path.uv[i][0] - start) / period).round();
    let first = (0..n).min_by(|&i, &j| beyond(i).abs().total_cmp(&beyond(j).abs())).unwrap_or(0);
    let forward = path.winding[0] > 0;
    let shift = start + beyond(first) - path.uv[first][0] + if forward { 0.0 } else { period };
    let turn = if forward { period } else { -period };
    let from = patch.uv.len() as u32;
    for k in 0..=n {
        let i = first + if forward { k } else { n - k };
        let [u, v] = path.uv[i % n];
        patch.points.push(path.points[i % n]);
        patch.uv.push([u + shift + if i >= n { turn } else { 0.0 }, v]);
    }
    from..from + n as u32 + 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;

    #[test]
    fn rings_start_side_by_side_and_run_upwards() {
        let ring = |us: [f64; 4], winding: i32| Path {
            points: vec![Point::origin(); 4],
            uv: us.map(|u| [u, 0.0]).to_vec(),
            middles: vec![[0.0; 2]; 4],
            winding: [winding, 0],
        };
        let mut patch = Patch::default();
        let places = |patch: &Patch, chain: Chain| chain.map(|i| patch.uv[i as usize][0]).collect::<Vec<_>>();
        let chain = add_ring(&mut patch, &ring([0.0, 1.0, 2.0, 3.0], 1), 4.0, 2.25);
        assert_eq!(places(&patch, chain), [2.0, 3.0, 4.0, 5.0, 6.0]);
        let chain = add_ring(&mut patch, &ring([7.5, 6.5, 5.5, 4.5], -1), 4.0, 2.25);
        assert_eq!(places(&patch, chain), [2.5, 3.5, 4.5, 5.5, 6.5]);
    }
}
