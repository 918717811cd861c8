//! The loops of a face -> closed polylines in space, less the seams.

use rustc_hash::FxHashMap;
use smallvec::smallvec;

use super::Few;
use super::edges::EdgeLines;
use crate::brep::{EdgeId, EdgeUse, Face, Uses};
use crate::geometry::Point;
use crate::memory::held;

/// Seams of one face that are taken out: each costs a pass over the loop, and what is left bounds nothing.
const MOST_SEAMS: usize = 256;
/// Points of the border of one face at most: edges may be used again and again.
const MOST_POINTS: usize = 1_000_000;

/// Up to so many edges a seam is found soonest by comparing each with each.
const SHORT: usize = 16;

/// The border of one face after the other in space: a closed polyline for each loop.
#[derive(Default)]
pub(super) struct Border {
    points: Vec<Point>,
    /// Where the true edge is half way to the next point.
    middles: Vec<Point>,
    /// Where each polyline ends.
    ends: Vec<usize>,
    /// A point on each seam: an edge that a loop runs along both ways, so that the face lies on both its sides.
    seams: Vec<Point>,
}

impl Border {
    /// Makes it the border of a face; `None` where that has far too many points.
    pub fn fill(&mut self, face: &Face, lines: &EdgeLines, degenerate: &[bool]) -> Option<&Self> {
        self.points.clear();
        self.middles.clear();
        self.ends.clear();
        self.seams.clear();
        let uses = face.loops.iter().flat_map(|l| &l.uses);
        if uses.map(|u| lines.line(u.edge).0.len()).sum::<usize>() > MOST_POINTS {
            return None;
        }
        let (mut chains, mut seams) = (Few::new(), Few::new());
        for face_loop in &face.loops {
            if first_pair(&face_loop.uses).is_none() && !face_loop.uses.iter().any(|u| degenerate[u.edge.index()]) {
                self.add(&face_loop.uses, lines);
                continue;
            }
            let uses = face_loop.uses.iter().copied().filter(|u| !degenerate[u.edge.index()]).collect();
            split_at_seams(uses, &mut chains, &mut seams);
            chains.drain(..).for_each(|chain| self.add(&chain, lines));
        }
        self.seams.extend(seams.into_iter().map(|edge| half_way(edge, lines)));
        Some(self)
    }

    /// Bytes of memory that it holds.
    pub fn bytes(&self) -> usize {
        held(&self.points) + held(&self.middles) + held(&self.ends) + held(&self.seams)
    }

    /// Adds the polyline of a chain, if it has two points at least.
    fn add(&mut self, chain: &[EdgeUse], lines: &EdgeLines) {
        let first = self.points.len();
        for edge_use in chain {
            let (p, m) = lines.line(edge_use.edge);
            let n = p.len() - 1;
            if edge_use.forward {
                self.points.extend_from_slice(&p[..n]);
                self.middles.extend_from_slice(&m[..n]);
            } else {
                self.points.extend(p[1..].iter().rev());
                self.middles.extend(m[..n].iter().rev());
            }
        }
        if self.points.len() > first + 1 {
            self.ends.push(self.points.len());
        } else {
            self.points.truncate(first);
            self.middles.truncate(first);
        }
    }

    /// The points of all loops.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// A point on each seam.
    pub fn seams(&self) -> &[Point] {
        &self.seams
    }

    /// Points and middles of one loop after the other.
    pub fn loops(&self) -> impl Iterator<Item = [&[Point]; 2]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(from, &to)| [&self.points[from..to], &self.middles[from..to]])
    }
}

/// Takes out edges that a chain runs along in both directions; what lies between them becomes chains of their own.
fn split_at_seams(uses: Uses, out: &mut Few<Uses>, seams: &mut Few<EdgeId>) {
    let mut open: Few<Uses> = smallvec![uses];
    while let Some(chain) = open.pop() {
        let pair = if seams.len() < MOST_SEAMS { first_pair(&chain) } else { None };
        match pair {
            Some((i, j)) => {
                seams.push(chain[i].edge);
                open.push(Uses::from_slice(&chain[i + 1..j]));
                open.push(chain[j + 1..].iter().chain(&chain[..i]).copied().collect());
            }
            None if !chain.is_empty() => out.push(chain),
            None => {}
        }
    }
}

/// The places of the first use of an edge that has an opposite one, and of that.
fn first_pair(chain: &[EdgeUse]) -> Option<(usize, usize)> {
    if chain.len() <= SHORT {
        let opposite = |i: usize| {
            let twin = |u: &EdgeUse| u.edge == chain[i].edge && u.forward != chain[i].forward;
            chain[i + 1..].iter().position(twin).map(|n| (i, i + 1 + n))
        };
        return (0..chain.len()).find_map(opposite);
    }
    let mut first: FxHashMap<(EdgeId, bool), usize> = FxHashMap::default();
    let pairs = chain.iter().enumerate().filter_map(|(j, u)| {
        first.entry((u.edge, u.forward)).or_insert(j);
        first.get(&(u.edge, !u.forward)).map(|&i| (i, j))
    });
    pairs.min()
}

/// A point near the middle of an edge.
fn half_way(edge: EdgeId, lines: &EdgeLines) -> Point {
    let (points, middles) = lines.line(edge);
    middles[(points.len() - 1) / 2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_falls_apart_at_its_seams() {
        let along = |edge: u32, forward: bool| EdgeUse { edge: EdgeId(edge), forward };
        // Bottom, seam, top, seam: two rings and one seam.
        let (mut chains, mut seams) = (Few::new(), Few::new());
        let wall = smallvec![along(0, true), along(1, true), along(2, false), along(1, false)];
        split_at_seams(wall, &mut chains, &mut seams);
        chains.sort_by_key(|c: &Uses| c[0].edge);
        assert_eq!(chains.iter().map(|c| c.to_vec()).collect::<Vec<_>>(), [[along(0, true)], [along(2, false)]]);
        assert_eq!(seams.to_vec(), [EdgeId(1)]);
    }
}
