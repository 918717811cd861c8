//! Projected areas by exact spans.
//!
//! The mesh is cut once, by planes across the reference axis. In a slice, every connected piece of the cut casts one
//! unbroken shadow on any line, so a piece is as good as its convex hull, and the shadow of the slice is a union of
//! few intervals. Walking round the hulls gives the shadows in all directions at hardly more than the price of one.

use std::ops::Range;

use rayon::prelude::*;

use crate::brep::Wireframe;
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::Vector;
use crate::geometry::order::{less, more};
use crate::stages::parse::Parsed;

use super::curve::Shadows;
use super::cutter::{Cutter, Hull, Pieces};
use super::reference::Turntable;
use super::slabs::Slabs;
use super::widths::{Sides, Widths};
use super::wire::Wire;

/// Edge crossings of the slices that one worker cuts at a time.
const CROSSINGS: usize = 1 << 20;

/// Edge crossings in all: a mesh of millions of triangles is cut into fewer slices, but never fewer than so many.
const MOST_CROSSINGS: usize = 1 << 26;
const FEWEST_SLICES: usize = 16;

/// A point of a cut: (along u, along v) of the turntable, mm.
pub(super) type Flat = [f64; 2];

/// The convex hulls of the pieces of every slice.
pub struct Slices {
    thickness: f64,
    /// Of the slices that are one piece.
    widths: Widths,
    /// The slices of several pieces, block by block.
    blocks: Vec<Pieces>,
    /// The largest coordinate in a slice, mm.
    reach: f64,
    /// The angle at which the slices know their extreme points.
    stood: Option<f64>,
}

/// Within so many radians of where the slices stood, walking there is cheaper than to look at all points: the angles
/// that refine one minimum lie within two steps of a degree.
const NEAR: f64 = 0.1;

/// Heights of points that differ by less than this share of the largest coordinate may differ by rounding only.
pub(super) const NOISE: f64 = 1e-12;

impl Slices {
    /// Cuts the model for the shadows along directions at right angles to `axis`, angles counted from `start`.
    pub fn about(
        parsed: &Parsed,
        axis: &Vector,
        start: &Vector,
        count: u32,
        cancel: &Cancel,
    ) -> Result<Self, Cancelled> {
        Self::cut(&parsed.wireframe, &Turntable::about(&parsed.measures, axis, start), count, cancel)
    }

    fn new(thickness: f64, sides: Sides, blocks: Vec<Pieces>) -> Self {
        let coordinates = blocks.iter().flat_map(|block| block.points.as_flattened());
        let reach = coordinates.fold(0.0, |most: f64, c| most.max(c.abs()));
        Self { thickness, widths: Widths::of(sides), blocks, reach, stood: None }
    }

    /// Cuts a mesh into `count` slices of equal thickness from its lowest to its highest point along the axis.
    pub(super) fn cut(
        wireframe: &Wireframe,
        table: &Turntable,
        count: u32,
        cancel: &Cancel,
    ) -> Result<Self, Cancelled> {
        let mut count = count.clamp(1, 65_536) as usize;
        let heights = wireframe.vertices.iter().map(|p| table.axis.dot(&(p - table.centre)));
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), z| (less(l, z), more(h, z)));
        let mut thickness = (high - low) / count as f64;
        if !(thickness > 0.0 && thickness.is_finite()) {
            return Ok(Self::new(0.0, Sides::default(), Vec::new()));
        }
        let mut wire = Wire::new(wireframe, table, low, thickness, count);
        let mut crossings = wire.crossings();
        if crossings > MOST_CROSSINGS && count > FEWEST_SLICES {
            count = (count * MOST_CROSSINGS / crossings).max(FEWEST_SLICES);
            thickness = (high - low) / count as f64;
            wire = Wire::new(wireframe, table, low, thickness, count);
            crossings = wire.crossings();
        }
        let block = (count * CROSSINGS / crossings.max(CROSSINGS)).max(1);
        let blocks: Vec<_> = (0..count).step_by(block).map(|s| s..(s + block).min(count)).collect();
        let cut = |b: &Range<usize>| cancel.check().map(|()| cut_block(&wire, b));
        let parts: Vec<_> = match blocks.as_slice() {
            [one] => vec![cut(one)?],
            many => many.par_iter().map(|b| cancel.account().within(|| cut(b))).collect::<Result<_, _>>()?,
        };
        let (mut sides, mut blocks) = (Sides::default(), Vec::new());
        for part in parts {
            sides.append(part.sides);
            blocks.push(part.pieces);
        }
        Ok(Self::new(thickness, sides, blocks))
    }
}

impl Shadows for Slices {
    fn areas(&mut self, angles: &[f64], cancel: &Cancel) -> Result<Vec<f64>, Cancelled> {
        if let Some(&first) =
            angles.first().filter(|first| !self.stood.is_some_and(|at| (at..at + NEAR).contains(first)))
        {
            let start = first - 0.5 * NEAR;
            self.blocks.iter_mut().for_each(|block| stand(block, across(start)));
            self.stood = Some(start);
        }
        let noise = NOISE * self.reach;
        let directions: Vec<Flat> = angles.iter().map(|&a| across(a)).collect();
        let mut areas: Vec<_> = directions.iter().map(|&d| self.thickness * self.widths.along(d)).collect();
        let mut walkers = Vec::new();
        for (block, slice) in self.blocks.iter().flat_map(|block| block.slices.iter().map(move |slice| (block, slice)))
        {
            cancel.check()?;
            let thickness = self.thickness * slice.alike as f64;
            walkers.clear();
            walkers.extend(block.hulls[slice.hulls.clone()].iter().map(Walker::from));
            for (area, &direction) in areas.iter_mut().zip(&directions) {
                *area += thickness * shadow_length(&block.points, &mut walkers, direction, noise);
            }
        }
        Ok(areas)
    }
}

/// What a block of slices casts.
fn cut_block(wire: &Wire, block: &Range<usize>) -> Cutter {
    let (mut cutter, mut slabs) = (Cutter::default(), Slabs::new(wire, block));
    while let Some(slab) = slabs.rise() {
        cutter.cut(wire, slab);
    }
    cutter
}

/// Finds the extreme points of every hull in a direction.
fn stand(block: &mut Pieces, direction: Flat) {
    for hull in &mut block.hulls {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for i in hull.points.clone() {
            let along = dot(block.points[i], direction);
            if along < low {
                (low, hull.extremes[0]) = (along, i);
            }
            if along >= high {
                (high, hull.extremes[1]) = (along, i);
            }
        }
    }
}

/// The interval that a hull covers in a direction that turns counter-clockwise, with the points that bound it.
struct Walker {
    hull: Range<usize>,
    lowest: usize,
    highest: usize,
    low: f64,
    high: f64,
}

impl From<&Hull> for Walker {
    /// Where the hull's extremes are.
    fn from(hull: &Hull) -> Self {
        let [lowest, highest] = hull.extremes;
        Self { hull: hull.points.clone(), lowest, highest, low: 0.0, high: 0.0 }
    }
}

impl Walker {
    /// Walks on to the extreme points in a direction at most half a turn after the last.
    fn turn(&mut self, points: &[Flat], direction: Flat, noise: f64) {
        (self.highest, self.high) = self.walked(self.highest, noise, |i| dot(points[i], direction));
        let low = self.walked(self.lowest, noise, |i| -dot(points[i], direction));
        (self.lowest, self.low) = (low.0, -low.1);
    }

    /// Counter-clockwise on from a point of the hull to the highest: as far as it goes up. Where points lie closer
    /// together than `noise` rounding decides which is higher; they are passed over.
    #[inline]
    fn walked(&self, from: usize, noise: f64, height: impl Fn(usize) -> f64) -> (usize, f64) {
        let (mut at, mut highest) = (from, (from, height(from)));
        for _ in 0..self.hull.len() {
            at = if at + 1 == self.hull.end { self.hull.start } else { at + 1 };
            let ahead = height(at);
            if ahead > highest.1 {
                highest = (at, ahead);
            } else if ahead < highest.1 - noise {
                break;
            }
        }
        highest
    }
}

/// Length of the union of the hulls' intervals in a direction.
fn shadow_length(points: &[Flat], walkers: &mut [Walker], direction: Flat, noise: f64) -> f64 {
    walkers.iter_mut().for_each(|w| w.turn(points, direction, noise));
    walkers.sort_unstable_by(|a, b| a.low.total_cmp(&b.low));
    let (mut length, mut covered) = (0.0, f64::NEG_INFINITY);
    for w in walkers.iter() {
        if w.high > covered {
            length += w.high - w.low.max(covered);
            covered = w.high;
        }
    }
    length
}

/// The direction along the plane at an angle.
fn across(angle: f64) -> Flat {
    [-angle.sin(), angle.cos()]
}

fn dot(a: Flat, b: Flat) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_corner_that_rounding_doubled_does_not_stop_the_walk() {
        let points = [[-1.0, -1.0], [1.0, -1.0], [1.0, -1.0 + f64::EPSILON], [1.0, 1.0], [-1.0, 1.0]];
        let mut square = Pieces::default();
        square.push(&points, std::slice::from_ref(&(0..points.len())), 1);
        let angles: Vec<_> = (0..180).map(|degrees| f64::from(degrees).to_radians()).collect();
        let areas = Slices::new(1.0, Sides::default(), vec![square]).areas(&angles, &Cancel::new()).unwrap();
        for (angle, area) in angles.iter().zip(areas) {
            assert!((area - 2.0 * (angle.sin() + angle.cos().abs())).abs() < 1e-12, "{angle}: {area}");
        }
    }
}
