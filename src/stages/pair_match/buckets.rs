//! Who meets whom: buckets of faces with equal invariants, and the subset that stands for a large bucket.

use rustc_hash::FxHashMap;

use super::Options;
use crate::brep::measure::Measures;
use crate::stages::corner_filter::Outline;

/// Width of a bin of ln(area) and ln(length): faces within 1 % are at most one bin apart.
const BIN: f64 = 0.02;

/// Pairs of faces to compare, and how many of its kind each pair stands for.
#[derive(Clone, Debug, Default)]
pub(super) struct Bucket {
    pub meetings: Vec<(u32, u32)>,
    pub weight: f64,
}

/// What a mirror preserves, in bins: corners, area, perimeter.
type Key = (u32, i32, i32);

fn key(outline: &Outline, size: f64, buckets: bool) -> Key {
    // The small summand widens the bins of faces so small that files do not hold them precisely.
    let bin = |share: f64| ((share + 1e-4).ln() / BIN).floor() as i32;
    let corners = outline.corners.len() as u32;
    if !buckets {
        return (corners, 0, 0);
    }
    let corners = if corners < 3 { 0 } else { corners };
    (corners, bin(outline.area.sqrt() / size), bin(outline.perimeter / size))
}

/// Whether area, perimeter and inner loops agree as closely as congruent faces' do.
pub(super) fn alike(p: &Outline, q: &Outline, size: f64) -> bool {
    let near = |x: f64, y: f64| (x - y).abs() <= 0.01 * x.max(y) + 1e-5 * size;
    near(p.area.sqrt(), q.area.sqrt())
        && near(p.perimeter, q.perimeter)
        && p.inner.len() == q.inner.len()
        && p.axis.is_some() == q.axis.is_some()
}

/// The meetings of each bucket, smallest keys first; listed one bucket after the other, as all together may be many.
pub(super) fn plan<'a>(
    outlines: &'a [Outline],
    measures: &'a Measures,
    options: &'a Options,
) -> impl Iterator<Item = Bucket> + 'a {
    let size = measures.tolerance.size();
    let mut members: FxHashMap<Key, Vec<u32>> = FxHashMap::default();
    for (i, outline) in outlines.iter().enumerate() {
        members.entry(key(outline, size, options.buckets)).or_default().push(i as u32);
    }
    let mut keys: Vec<_> = members.keys().copied().collect();
    keys.sort_unstable();
    let distance = move |i: u32| (outlines[i as usize].centroid - measures.centroid).norm();
    let extra = options.extra_corners as u32;
    keys.into_iter().map(move |k| {
        let own = &members[&k];
        let subset = subset(own, distance, options.subset);
        let mut meetings = within(own, &subset);
        for other in neighbours(&k, extra).filter_map(|n| members.get(&n)) {
            meetings.extend(subset.iter().flat_map(|&a| other.iter().map(move |&b| (a, b))));
        }
        Bucket { meetings, weight: own.len() as f64 / subset.len() as f64 }
    })
}

/// Keys that hold faces congruent to those of `k` in spite of the bins, each unordered pair of keys once.
fn neighbours(&(corners, area, length): &Key, extra: u32) -> impl Iterator<Item = Key> {
    let range = -1..=1;
    let near = range.clone().flat_map(move |i| range.clone().map(move |j| (i, j)));
    let more = (0..=extra).filter(move |e| *e == 0 || corners >= 3);
    more.flat_map(move |e| near.clone().map(move |(i, j)| (e, i, j)))
        .filter(|&(e, i, j)| e > 0 || (i, j) > (0, 0))
        .map(move |(e, i, j)| (corners + e, area + i, length + j))
}

/// The faces that meet all others: spread evenly over the distances from the centroid, which no pose changes.
fn subset(members: &[u32], distance: impl Fn(u32) -> f64, count: usize) -> Vec<u32> {
    // Twice as many may meet each other without harm, and small buckets are searched in full.
    if members.len() <= count.max(1).saturating_mul(2) {
        return members.to_vec();
    }
    let mut sorted: Vec<_> = members.iter().map(|&i| (distance(i), i)).collect();
    sorted.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let step = (members.len() - 1) as f64 / (count.max(2) - 1) as f64;
    let mut chosen: Vec<_> = (0..count.max(1)).map(|i| sorted[(i as f64 * step) as usize].1).collect();
    chosen.sort_unstable();
    chosen.dedup();
    chosen
}

/// Each pair of a face of the subset with a face of the bucket once, a face with itself included.
fn within(members: &[u32], subset: &[u32]) -> Vec<(u32, u32)> {
    let chosen = |i: u32| subset.binary_search(&i).is_ok();
    let mut meetings = Vec::with_capacity(members.len() * (subset.len() + 1));
    for &b in members {
        if !chosen(b) {
            meetings.push((b, b));
        }
        meetings.extend(subset.iter().filter(|&&a| !chosen(b) || a <= b).map(|&a| (a, b)));
    }
    meetings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_buckets_meet_in_full_and_large_ones_through_their_subset() {
        assert_eq!(within(&[3, 5, 8], &[3, 5, 8]).len(), 6);
        let members: Vec<u32> = (0..100).collect();
        let chosen = subset(&members, f64::from, 4);
        assert_eq!(chosen, [0, 33, 66, 99]);
        // Each of 96 others meets 4 and itself; the 4 meet each other and themselves.
        assert_eq!(within(&members, &chosen).len(), 96 * 5 + 10);
    }

    /// A flat face of `n` corners about the origin, of an area and a perimeter.
    fn outline(n: usize, area: f64, perimeter: f64) -> Outline {
        let corner = |i: usize| crate::geometry::Point::new(i as f64, 0.0, 0.0);
        Outline {
            faces: Default::default(),
            corners: (0..n).map(corner).collect(),
            perimeter,
            inner: Vec::new(),
            area,
            centroid: crate::geometry::Point::origin(),
            axis: None,
            oriented: true,
            shape: None,
        }
    }

    #[test]
    fn all_faces_that_are_alike_meet() {
        let share = |i: usize, step: f64| (i as f64 * step).fract();
        let random = |i: usize| {
            let side = 0.3 + 0.02 * share(i, 0.754_877_666);
            outline(i % 7, side * side, 4.0 * side * (1.0 + 0.02 * share(i, 0.569_840_291)))
        };
        let outlines: Vec<_> = (0..300).map(random).collect();
        let mut measures = crate::stages::fixture::solid(
            &crate::stages::fixture::cuboid(1.0, 1.0, 1.0),
            &crate::geometry::Transform::identity(),
        )
        .measures;
        measures.tolerance = crate::geometry::Tolerance::of(1.0);
        let options = Options { subset: usize::MAX, ..Options::default() };
        let met: std::collections::BTreeSet<_> =
            plan(&outlines, &measures, &options).flat_map(|b| b.meetings).map(|(a, b)| (a.min(b), a.max(b))).collect();
        let corners = |i: u32| outlines[i as usize].corners.len();
        let (mut alike_pairs, mut missed) = (0, 0);
        for a in 0..outlines.len() as u32 {
            for b in a..outlines.len() as u32 {
                let (n, m) = (corners(a), corners(b));
                let comparable = if n.min(m) < 3 { n.max(m) < 3 } else { n.abs_diff(m) <= options.extra_corners };
                if comparable && alike(&outlines[a as usize], &outlines[b as usize], 1.0) {
                    alike_pairs += 1;
                    missed += usize::from(!met.contains(&(a, b)));
                }
            }
        }
        assert!(alike_pairs > 3000 && missed == 0, "{missed} of {alike_pairs}");
    }

    #[test]
    fn neighbouring_keys_are_met_from_one_side_only() {
        let key = (4, 10, 20);
        let reached = |from: Key| neighbours(&from, 0).collect::<Vec<_>>();
        assert_eq!(reached(key).len(), 4);
        for other in reached(key) {
            assert!(!reached(other).contains(&key));
        }
    }
}
