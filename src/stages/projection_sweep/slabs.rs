//! Slabs: slices one on top of the other that cross the same edges.
//!
//! Between two levels of vertices a cut only changes its shape. Which edges it crosses and which of its points are
//! connected is found once for all slices there.

use std::ops::Range;

use super::wire::{Wire, group};

/// Slices that cross the same edges.
#[derive(Default)]
pub(super) struct Slab {
    pub slices: Range<u32>,
    /// The edges that hulls may have corners on, piece by piece.
    edges: Vec<u32>,
    /// Where each piece ends.
    ends: Vec<usize>,
}

impl Slab {
    /// The edges of each connected piece of the cut.
    pub fn pieces(&self) -> impl Iterator<Item = &[u32]> {
        let starts = std::iter::once(&0).chain(&self.ends);
        starts.zip(&self.ends).map(|(&start, &end)| &self.edges[start..end])
    }
}

/// Goes up through slices from slab to slab.
pub(super) struct Slabs<'a> {
    wire: &'a Wire,
    left: Range<u32>,
    edges: Crossed<'a>,
    triangles: Crossed<'a>,
    /// Of each edge one that it is connected with, itself for one of each piece.
    parents: Vec<u32>,
    /// Of those the number of the piece.
    numbers: Vec<u32>,
    /// The edges that bend, each with the number of its piece.
    bent: Vec<(u32, u32)>,
    slab: Slab,
}

impl<'a> Slabs<'a> {
    pub fn new(wire: &'a Wire, slices: &Range<usize>) -> Self {
        let none = vec![0; wire.rising_edges.len() + 1];
        Self {
            wire,
            left: slices.start as u32..slices.end as u32,
            edges: Crossed { rising: &wire.rising_edges, now: Vec::new() },
            triangles: Crossed { rising: &wire.rising_triangles, now: Vec::new() },
            parents: none.clone(),
            numbers: none,
            bent: Vec::new(),
            slab: Slab::default(),
        }
    }

    /// The next slab, above the last; `None` at the top.
    pub fn rise(&mut self) -> Option<&Slab> {
        let start = self.left.start;
        if start >= self.left.end {
            return None;
        }
        self.triangles.rise(start);
        self.edges.rise(start);
        self.left.start = self.edges.next().min(self.left.end);
        self.slab.slices = start..self.left.start;
        self.connect(start);
        self.divide();
        Some(&self.slab)
    }

    /// Connects what the triangles connect in a slice.
    fn connect(&mut self, slice: u32) {
        for &(_, edge) in &self.edges.now {
            self.parents[edge as usize] = edge;
            self.numbers[edge as usize] = u32::MAX;
        }
        for (_, number) in &self.triangles.now {
            let triangle = self.wire.triangle(*number);
            let short = triangle.short[usize::from(slice >= triangle.middle)];
            let [a, b] = [triangle.long, short].map(|edge| root(&mut self.parents, edge));
            self.parents[a.max(b) as usize] = a.min(b);
        }
    }

    /// Divides the edges that bend into pieces.
    fn divide(&mut self) {
        self.bent.clear();
        let mut count = 0;
        for edge in self.edges.now.iter().map(|(_, edge)| *edge).filter(|edge| self.wire.bends(*edge)) {
            let number = &mut self.numbers[root(&mut self.parents, edge) as usize];
            if *number == u32::MAX {
                *number = count;
                count += 1;
            }
            self.bent.push((*number, edge));
        }
        group(&self.bent, count as usize, &mut self.slab.edges, &mut self.slab.ends);
    }
}

/// The one that stands for all that an edge is connected with.
fn root(parents: &mut [u32], mut edge: u32) -> u32 {
    loop {
        let parent = parents[edge as usize];
        let above = parents[parent as usize];
        if above == parent {
            return parent;
        }
        parents[edge as usize] = above;
        edge = above;
    }
}

/// What crosses a slice that rises, with the slices that each crosses.
struct Crossed<'a> {
    /// What begins above it.
    rising: &'a [(Range<u32>, u32)],
    now: Vec<(Range<u32>, u32)>,
}

impl Crossed<'_> {
    /// Rises to a slice.
    fn rise(&mut self, slice: u32) {
        let begun = self.rising.iter().take_while(|(slices, _)| slices.start <= slice).count();
        self.now.retain(|(slices, _)| slices.end > slice);
        // The first slice may lie high up.
        self.now.extend(self.rising[..begun].iter().filter(|(slices, _)| slices.end > slice).cloned());
        self.rising = &self.rising[begun..];
    }

    /// The next slice where something begins or ends.
    fn next(&self) -> u32 {
        let begins = self.rising.first().map_or(u32::MAX, |(slices, _)| slices.start);
        self.now.iter().fold(begins, |next, (slices, _)| next.min(slices.end))
    }
}

#[cfg(test)]
mod tests {
    use super::super::reference::Turntable;
    use super::*;
    use crate::alignment::shapes;
    use crate::brep::Wireframe;
    use crate::geometry::{Point, Vector};

    /// Two blocks side by side, 4 and 1 high, cut at 0.25, 0.75 and so on: the first slab ends above the lower one. The
    /// diagonals of their sides are corners of nothing.
    #[test]
    fn a_slab_ends_where_a_block_does() {
        let low = shapes::mapped(&shapes::cuboid(1.0, 1.0, 1.0), |p| p + Vector::new(3.0, 0.0, 0.0));
        let mesh = shapes::joined(&shapes::cuboid(1.0, 1.0, 4.0), &low);
        let (axis, u, v) = (Vector::z(), Vector::x(), Vector::y());
        let table = Turntable { axis, u, v, centre: Point::origin(), largest_variance: 0.0 };
        let wire = Wire::new(&Wireframe::of(&mesh), &table, 0.0, 0.5, 8);
        let slabs = |slices| {
            let (mut slabs, mut found) = (Slabs::new(&wire, &slices), Vec::new());
            while let Some(slab) = slabs.rise() {
                assert!(slab.pieces().flatten().all(|&edge| wire.is_upright(edge)));
                found.push((slab.slices.clone(), slab.pieces().map(<[u32]>::len).collect()));
            }
            found
        };
        assert_eq!(slabs(0..8), [(0..2, vec![4, 4]), (2..8, vec![4])]);
        assert_eq!(slabs(1..5), [(1..2, vec![4, 4]), (2..5, vec![4])]);
    }
}
