//! Slabs: slices one on top of the other that cross the same edges.
//!
//! Between two levels of vertices a cut only changes its shape. Which edges it crosses and which of its points are
//! connected is found once for all slices there.

use std::ops::Range;

use super::wire::{Wire, grouped};

/// Slices that cross the same edges.
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
        }
    }

    /// Connects what the triangles connect in a slice.
    fn connect(&mut self, slice: u32) {
        self.edges.now.iter().for_each(|(_, edge)| self.parents[*edge as usize] = *edge);
        for i in 0..self.triangles.now.len() {
            let triangle = self.wire.triangle(self.triangles.now[i].1);
            self.join(triangle.long, triangle.short[usize::from(slice >= triangle.middle)]);
        }
    }

    fn root(&mut self, mut edge: u32) -> u32 {
        while self.parents[edge as usize] != edge {
            let above = self.parents[self.parents[edge as usize] as usize];
            self.parents[edge as usize] = above;
            edge = above;
        }
        edge
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b) as usize] = a.min(b);
    }

    /// The edges that bend piece by piece, and where each piece ends.
    fn pieces(&mut self) -> (Vec<u32>, Vec<usize>) {
        let edges = self.edges.now.iter().map(|(_, edge)| *edge).filter(|edge| self.wire.bends(*edge));
        let mut edges: Vec<_> = edges.map(|edge| (0, edge)).collect();
        edges.iter_mut().for_each(|(root, edge)| *root = self.root(*edge));
        edges.iter().for_each(|(root, _)| self.numbers[*root as usize] = u32::MAX);
        let mut count = 0;
        for (root, _) in &mut edges {
            let number = &mut self.numbers[*root as usize];
            if *number == u32::MAX {
                *number = count;
                count += 1;
            }
            *root = *number;
        }
        grouped(edges.iter().copied(), count as usize)
    }
}

impl Iterator for Slabs<'_> {
    type Item = Slab;

    fn next(&mut self) -> Option<Slab> {
        let start = self.left.start;
        if start >= self.left.end {
            return None;
        }
        self.triangles.rise(start);
        let end = self.edges.rise(start).min(self.left.end);
        self.left.start = end;
        self.connect(start);
        let (edges, ends) = self.pieces();
        Some(Slab { slices: start..end, edges, ends })
    }
}

/// What crosses a slice that rises, with the slices that each crosses.
struct Crossed<'a> {
    /// What begins above it.
    rising: &'a [(Range<u32>, u32)],
    now: Vec<(Range<u32>, u32)>,
}

impl Crossed<'_> {
    /// Rises to a slice; returns the next one where something begins or ends.
    fn rise(&mut self, slice: u32) -> u32 {
        let begun = self.rising.iter().take_while(|(slices, _)| slices.start <= slice).count();
        self.now.retain(|(slices, _)| slices.end > slice);
        // The first slice may lie high up.
        self.now.extend(self.rising[..begun].iter().filter(|(slices, _)| slices.end > slice).cloned());
        self.rising = &self.rising[begun..];
        let begins = self.rising.first().map_or(u32::MAX, |(slices, _)| slices.start);
        self.now.iter().fold(begins, |next, (slices, _)| next.min(slices.end))
    }
}

#[cfg(test)]
mod tests {
    use super::super::reference::Turntable;
    use super::*;
    use crate::alignment::shapes;
    use crate::geometry::{Point, Vector};

    /// Two blocks side by side, 4 and 1 high, cut at 0.25, 0.75 and so on: the first slab ends above the lower one. The
    /// diagonals of their sides are corners of nothing.
    #[test]
    fn a_slab_ends_where_a_block_does() {
        let low = shapes::mapped(&shapes::cuboid(1.0, 1.0, 1.0), |p| p + Vector::new(3.0, 0.0, 0.0));
        let mesh = shapes::joined(&shapes::cuboid(1.0, 1.0, 4.0), &low);
        let (axis, u, v) = (Vector::z(), Vector::x(), Vector::y());
        let table = Turntable { axis, u, v, centre: Point::origin(), largest_variance: 0.0 };
        let wire = Wire::new(&mesh, &table, 0.0, 0.5, 8);
        let slabs: Vec<_> = Slabs::new(&wire, &(0..8)).collect();
        assert_eq!(slabs.iter().map(|slab| slab.slices.clone()).collect::<Vec<_>>(), [0..2, 2..8]);
        let sizes = |slab: &Slab| slab.pieces().map(<[u32]>::len).collect::<Vec<_>>();
        assert_eq!(slabs.iter().map(sizes).collect::<Vec<_>>(), [vec![4, 4], vec![4]]);
        assert!(slabs[0].pieces().flatten().all(|&edge| wire.is_upright(edge)));
        let upper: Vec<_> = Slabs::new(&wire, &(1..5)).map(|slab| slab.slices).collect();
        assert_eq!(upper, [1..2, 2..5]);
    }
}
