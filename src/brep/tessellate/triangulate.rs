//! Points and segments in the plane -> triangles: ears for polygons, constrained Delaunay for the rest, and strips
//! between two monotone chains.

use earcut::Earcut;
use rustc_hash::FxHashMap;
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};
use std::cell::Cell;
use std::collections::VecDeque;

use super::chart::Uv;
use crate::memory::held;

/// Crossings that are always split, and how many are split for each point: real borders cross themselves here and
/// there, scribbles as often as there are pairs of segments.
const MOST_CROSSINGS: usize = 1000;
const CROSSINGS_A_POINT: usize = 2;
/// Polygons with more points than this are left to the Delaunay triangulation: ears of tangled ones take cubic time.
const MOST_EARS: usize = 4000;

/// Quadrilaterals that turn by less at a corner, as a share of their area, are no plain ones.
const FLAT: f64 = 1e-6;

/// How much the triangles' area may differ from the polygon's, as a share.
const AREA_SLACK: f64 = 1e-6;

/// What polygons are cut in, one after the other.
#[derive(Default)]
pub(super) struct Room {
    earcut: Earcut<f64>,
    holes: Vec<u32>,
    corners: Vec<u32>,
    pub chains: Chains,
}

/// A ring and the two chains that it is cut into.
#[derive(Default)]
pub(super) struct Chains {
    pub ring: Vec<u32>,
    pub lower: Vec<u32>,
    pub upper: Vec<u32>,
    /// The ring's points, where the chains run along v.
    pub turned: Vec<Uv>,
}

impl Room {
    /// Bytes of memory that it holds, but for the ears' own, which are bounded by [`MOST_EARS`].
    pub fn bytes(&self) -> usize {
        let Chains { ring, lower, upper, turned } = &self.chains;
        [&self.holes, &self.corners, ring, lower, upper].map(held).iter().sum::<usize>() + held(turned)
    }
}

/// Triangles of a polygon with holes, all counter-clockwise; `rings`: where each ring starts, the outer one first,
/// `area`: what they must add up to. `None` where the rings cut each other and the areas differ.
pub(super) fn ears(
    points: &[Uv],
    rings: &[usize],
    area: f64,
    room: &mut Room,
    triangles: &mut Vec<[u32; 3]>,
) -> Option<()> {
    triangles.clear();
    if points.len() > MOST_EARS {
        return None;
    }
    if let (Ok(corners), [_]) = (points.try_into(), rings)
        && let Some(halves) = halves(corners)
    {
        triangles.extend(halves);
        return Some(());
    }
    let Room { earcut, holes, corners, .. } = room;
    holes.clear();
    holes.extend(rings.iter().skip(1).map(|&r| r as u32));
    earcut.earcut(points.iter().copied(), holes, corners);
    triangles.extend_from_slice(corners.as_chunks().0);
    let mut sum = 0.0;
    for t in triangles {
        let twice = doubled_area(points, t);
        if twice < 0.0 {
            t.swap(1, 2);
        }
        sum += 0.5 * twice.abs();
    }
    ((sum - area).abs() <= AREA_SLACK * area).then_some(())
}

/// The halves of a convex quadrilateral, cut as the ears would be.
fn halves(corners: &[Uv; 4]) -> Option<[[u32; 3]; 2]> {
    let turns = [[0, 1, 2], [1, 2, 3], [2, 3, 0], [3, 0, 1]].map(|t| doubled_area(corners, &t));
    let least = FLAT * turns.iter().map(|t| t.abs()).sum::<f64>();
    if turns.iter().all(|t| *t > least) {
        Some([[2, 3, 0], [2, 0, 1]])
    } else if turns.iter().all(|t| *t < -least) {
        Some([[1, 0, 3], [1, 3, 2]])
    } else {
        None
    }
}

/// Twice the signed area of a triangle.
pub(super) fn doubled_area(points: &[Uv], [a, b, c]: &[u32; 3]) -> f64 {
    let [a, b, c] = [a, b, c].map(|i| points[*i as usize]);
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Adds the triangles between a lower and an upper chain, both with growing u. `None` where one of them turns out
/// clockwise, wider than `widest` in u, or the areas do not add up to `area`.
pub(super) fn zip(
    points: &[Uv],
    mut lower: impl Iterator<Item = u32>,
    mut upper: impl Iterator<Item = u32>,
    area: f64,
    widest: f64,
    triangles: &mut Vec<[u32; 3]>,
) -> Option<()> {
    let u = |i: u32| points[i as usize][0];
    let mut ends = [lower.next()?, upper.next()?];
    let mut next = [lower.next(), upper.next()];
    let mut sum = 0.0;
    loop {
        let side = match next {
            [Some(p), Some(q)] => usize::from(u(p) > u(q)),
            [p, _] => usize::from(p.is_none()),
        };
        let Some(third) = next[side] else { break };
        let triangle = [ends[0], third, ends[1]];
        ends[side] = third;
        next[side] = if side == 0 { lower.next() } else { upper.next() };
        if triangle[0] == triangle[2] || triangle[0] == triangle[1] || triangle[1] == triangle[2] {
            continue;
        }
        let twice = doubled_area(points, &triangle);
        let [a, b, c] = triangle.map(u);
        if twice < -1e-9 * area || a.max(b).max(c) - a.min(b).min(c) > widest {
            return None;
        }
        sum += 0.5 * twice;
        triangles.push(triangle);
    }
    ((sum - area).abs() <= AREA_SLACK * area).then_some(())
}

struct Site {
    position: Point2<f64>,
    index: u32,
}

impl HasPosition for Site {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.position
    }
}

type Delaunay = ConstrainedDelaunayTriangulation<Site>;

/// A triangulation of the convex hull, cut into regions by the segments.
pub(super) struct Cut {
    /// Counter-clockwise; indices from the number of given points on mean `added`.
    pub triangles: Vec<[u32; 3]>,
    /// The region of each triangle.
    pub regions: Vec<u32>,
    /// The largest triangle of each region.
    pub largest: Vec<u32>,
    /// Points where segments cross.
    pub added: Vec<Uv>,
}

/// Constrained Delaunay triangulation; segments that cross are split. `None` for points that cannot be used, where
/// segments cross far too often, and when cancelled.
pub(super) fn delaunay(points: &[Uv], segments: &[[u32; 2]], cancelled: &dyn Fn() -> bool) -> Option<Cut> {
    if points.iter().any(|p| !(p[0].abs() < 1e30 && p[1].abs() < 1e30)) {
        return None;
    }
    let (sites, places) = sites(points);
    let edges = segments.iter().map(|s| s.map(|i| places[i as usize])).filter(|s| s[0] != s[1]).collect();
    let mut conflicts = Vec::new();
    let mut mesh = Delaunay::try_bulk_load_cdt(sites, edges, |e| conflicts.push(e)).ok()?;
    let next = Cell::new(points.len() as u32);
    let most = MOST_CROSSINGS.max(CROSSINGS_A_POINT * points.len());
    for [from, to] in conflicts {
        if next.get() as usize - points.len() > most || cancelled() {
            return None;
        }
        let handles = [from, to].map(spade::handles::FixedVertexHandle::from_index);
        mesh.add_constraint_and_split(handles[0], handles[1], |position| {
            let index = next.get();
            next.set(index + 1);
            Site { position, index }
        });
    }
    let mut added = vec![[0.0; 2]; next.get() as usize - points.len()];
    for vertex in mesh.vertices() {
        if let Some(at) = (vertex.data().index as usize).checked_sub(points.len()) {
            added[at] = [vertex.position().x, vertex.position().y];
        }
    }
    Some(regions(&mesh, added))
}

/// Each place once, and which of them each point is: the triangulation takes quadratic time for coincident points.
fn sites(points: &[Uv]) -> (Vec<Site>, Vec<usize>) {
    // Also makes -0 the same as 0.
    let tidy = |x: f64| if x.abs() < 1e-30 { 0.0 } else { x };
    let mut known: FxHashMap<[u64; 2], usize> = FxHashMap::default();
    let mut sites = Vec::with_capacity(points.len());
    let mut place = |(i, p): (usize, &Uv)| {
        let [x, y] = p.map(tidy);
        *known.entry([x.to_bits(), y.to_bits()]).or_insert_with(|| {
            sites.push(Site { position: Point2::new(x, y), index: i as u32 });
            sites.len() - 1
        })
    };
    let places = points.iter().enumerate().map(&mut place).collect();
    (sites, places)
}

/// Floods the triangles between constraint edges.
fn regions(mesh: &Delaunay, added: Vec<Uv>) -> Cut {
    let count = mesh.num_inner_faces();
    let mut triangles = Vec::with_capacity(count);
    for face in mesh.inner_faces() {
        triangles.push(face.vertices().map(|v| v.data().index));
    }
    const NONE: u32 = u32::MAX;
    let mut labels = vec![NONE; count];
    let mut largest = Vec::new();
    let mut queue = VecDeque::new();
    // Inner faces are numbered from 1: 0 is the outer one.
    for face in mesh.inner_faces() {
        if labels[face.fix().index() - 1] != NONE {
            continue;
        }
        let label = largest.len() as u32;
        let mut best = (f64::NEG_INFINITY, 0);
        labels[face.fix().index() - 1] = label;
        queue.push_back(face);
        while let Some(at) = queue.pop_front() {
            best = if at.area() > best.0 { (at.area(), at.fix().index() as u32 - 1) } else { best };
            for edge in at.adjacent_edges() {
                if edge.is_constraint_edge() {
                    continue;
                }
                if let Some(next) = edge.rev().face().as_inner()
                    && labels[next.fix().index() - 1] == NONE
                {
                    labels[next.fix().index() - 1] = label;
                    queue.push_back(next);
                }
            }
        }
        largest.push(best.1);
    }
    Cut { triangles, regions: labels, largest, added }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn eared(points: &[Uv], rings: &[usize], area: f64) -> usize {
        let mut triangles = Vec::new();
        ears(points, rings, area, &mut Room::default(), &mut triangles).unwrap();
        triangles.len()
    }

    #[test]
    fn a_square_with_a_square_hole_is_cut_into_two_regions() {
        let square = |a: f64| [[-a, -a], [a, -a], [a, a], [-a, a]];
        let points: Vec<Uv> = square(2.0).into_iter().chain(square(1.0)).collect();
        let ring = |s: u32| (0..4).map(move |i| [s + i, s + (i + 1) % 4]);
        let segments: Vec<_> = ring(0).chain(ring(4)).collect();
        let cut = delaunay(&points, &segments, &|| false).unwrap();
        let area = |region| {
            let inside = cut.triangles.iter().zip(&cut.regions).filter(move |t| *t.1 == region);
            inside.map(|t| 0.5 * doubled_area(&points, t.0)).sum::<f64>()
        };
        let mut areas: Vec<f64> = (0..cut.largest.len() as u32).map(area).collect();
        areas.sort_by(f64::total_cmp);
        assert_eq!(areas, [4.0, 12.0]);
        assert_eq!(eared(&points, &[0, 4], 12.0), 8);
    }

    #[test]
    fn convex_quadrilaterals_are_halved_as_ears_are_cut() {
        let corners = [[0.0, 0.0], [3.0, 1.0], [2.0, 4.0], [-1.0, 2.0]];
        let mut reversed = corners;
        reversed.reverse();
        for corners in [corners, reversed] {
            let mut cut: Vec<u32> = Vec::new();
            Earcut::new().earcut(corners.iter().copied(), &[], &mut cut);
            assert_eq!(halves(&corners).unwrap().as_flattened(), cut);
            // Half of 0 + 10 + 8 + 0, the cross products of neighbours.
            assert_eq!(eared(&corners, &[0], 9.0), 2);
        }
        assert_eq!(halves(&[[0.0, 0.0], [2.0, 0.0], [0.5, 0.5], [0.0, 2.0]]), None, "a dart");
        assert_eq!(halves(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]), None, "a bow");
        assert_eq!(halves(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 1.0]]), None, "a triangle");
    }

    #[test]
    fn crossing_segments_are_split() {
        let points = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
        let cut = delaunay(&points, &[[0, 1], [2, 3]], &|| false).unwrap();
        assert_eq!(cut.added, [[0.5, 0.5]]);
        assert_eq!(cut.triangles.len(), 4);
    }

    #[test]
    fn chains_are_zipped() {
        let points = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 1.0], [2.0, 1.0]];
        let mut triangles = Vec::new();
        zip(&points, 0..3, 3..5, 2.0, 3.0, &mut triangles).unwrap();
        assert_eq!(triangles, [[0, 1, 3], [1, 2, 3], [2, 4, 3]]);
        assert!(zip(&points, 0..3, 3..5, 2.0, 1.0, &mut triangles).is_none(), "triangles too wide");
    }
}
