//! What slices cast: the sides of those that are one piece, the hulls of the pieces of the others.

use std::ops::Range;

use crate::geometry::polygon;

use super::cover::drop_covered;
use super::slabs::Slab;
use super::slices::Flat;
use super::widths::Sides;
use super::wire::Wire;

/// Takes the slices of a block, slab by slab.
#[derive(Default)]
pub(super) struct Cutter {
    /// Of the slices that are one piece.
    pub sides: Sides,
    /// The slices of several pieces.
    pub pieces: Pieces,
    /// The hulls of the slice at hand and those of the one before it.
    now: Hulls,
    before: Hulls,
    /// Room for the hulls that cast shadows of their own, for the points of a piece, and to sort them.
    kept: Vec<Range<usize>>,
    crossings: Vec<Flat>,
    keys: Vec<u128>,
}

/// Convex hulls, counter-clockwise, one after the other.
#[derive(Default)]
struct Hulls {
    points: Vec<Flat>,
    each: Vec<Range<usize>>,
}

/// Slices of several pieces each.
#[derive(Default)]
pub(super) struct Pieces {
    /// Of the hulls, one after the other.
    pub points: Vec<Flat>,
    pub hulls: Vec<Hull>,
    pub slices: Vec<Slice>,
}

/// The convex hull of a piece, counter-clockwise.
pub(super) struct Hull {
    pub points: Range<usize>,
    /// The lowest and the highest point in the direction last stood at.
    pub extremes: [usize; 2],
}

/// A slice, or several where the cut is the same.
pub(super) struct Slice {
    pub hulls: Range<usize>,
    /// How many slices look like this.
    pub alike: usize,
}

impl Cutter {
    /// Takes the slices of a slab, as one where they are all alike.
    pub fn cut(&mut self, wire: &Wire, slab: &Slab) {
        let is_upright = |piece: &[u32]| piece.iter().all(|&edge| wire.is_upright(edge));
        let first = slab.slices.start;
        let (heights, alike) = if slab.pieces().all(is_upright) {
            (first..first + 1, slab.slices.len())
        } else {
            (slab.slices.clone(), 1)
        };
        for height in heights {
            std::mem::swap(&mut self.now, &mut self.before);
            self.now.points.clear();
            self.now.each.clear();
            for (number, piece) in slab.pieces().enumerate() {
                let start = self.now.points.len();
                if height > first && is_upright(piece) {
                    self.now.points.extend_from_slice(&self.before.points[self.before.each[number].clone()]);
                } else {
                    self.crossings.clear();
                    self.crossings.extend(piece.iter().map(|&edge| wire.crossing(edge, height)));
                    polygon::push_hull(&mut self.crossings, &mut self.now.points, &mut self.keys);
                }
                self.now.each.push(start..self.now.points.len());
            }
            self.keep(alike);
        }
    }

    /// Keeps what casts the shadows of the slice at hand.
    fn keep(&mut self, alike: usize) {
        let Hulls { points, each } = &self.now;
        self.kept.clear();
        self.kept.extend_from_slice(each);
        drop_covered(points, &mut self.kept);
        match self.kept.as_slice() {
            [] => {}
            [one] => self.sides.push(&points[one.clone()], alike),
            several => self.pieces.push(points, several, alike),
        }
    }
}

impl Pieces {
    /// Adds a slice with some hulls of these points.
    pub fn push(&mut self, points: &[Flat], hulls: &[Range<usize>], alike: usize) {
        let first = self.hulls.len();
        for hull in hulls {
            let start = self.points.len();
            self.points.extend_from_slice(&points[hull.clone()]);
            self.hulls.push(Hull { points: start..self.points.len(), extremes: [start; 2] });
        }
        self.slices.push(Slice { hulls: first..self.hulls.len(), alike });
    }
}
