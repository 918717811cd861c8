//! Projected areas by exact spans.
//!
//! The mesh is cut once, by planes across the reference axis. In a slice, every connected piece of the cut casts one
//! unbroken shadow on any line, so a piece is as good as its convex hull, and the shadow of the slice is a union of
//! few intervals. Walking round the hulls gives the shadows in all directions at hardly more than the price of one.

use std::ops::Range;

use rayon::prelude::*;

use crate::brep::Mesh;
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::{Vector, polygon};
use crate::stages::parse::Parsed;

use super::cover::uncovered;
use super::curve::Shadows;
use super::reference::Turntable;
use super::slabs::{Slab, Slabs};
use super::widths::Widths;
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
    /// The slices of several pieces.
    slices: Vec<Slice>,
    /// The largest coordinate in a slice, mm.
    reach: f64,
    /// The angle at which the slices know their extreme points.
    stood: Option<f64>,
}

/// The pieces of the cut at one height, or at several where it is the same: convex hulls, counter-clockwise, one after
/// the other.
#[derive(Clone, Debug, Default)]
struct Slice {
    points: Vec<Flat>,
    hulls: Vec<Range<usize>>,
    /// How many slices look like this.
    alike: usize,
    /// Of each hull, the lowest and the highest point in the direction last stood at.
    extremes: Vec<[usize; 2]>,
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
        Self::cut(&parsed.mesh, &Turntable::about(&parsed.measures, axis, start), count, cancel)
    }

    fn new(thickness: f64, mut slices: Vec<Slice>) -> Self {
        let convex = slices.iter().filter(|slice| slice.hulls.len() == 1);
        let widths = Widths::of(convex.map(|slice| (&slice.points[..], slice.alike)));
        slices.retain(|slice| slice.hulls.len() > 1);
        let coordinates = slices.iter().flat_map(|slice| slice.points.as_flattened());
        Self { reach: coordinates.fold(0.0, |most, c| most.max(c.abs())), thickness, widths, slices, stood: None }
    }

    /// Cuts the mesh into `count` slices of equal thickness from its lowest to its highest point along the axis.
    pub(super) fn cut(mesh: &Mesh, table: &Turntable, count: u32, cancel: &Cancel) -> Result<Self, Cancelled> {
        let mut count = count.clamp(1, 65_536) as usize;
        let heights: Vec<f64> = mesh.points.iter().map(|p| table.axis.dot(&(p - table.centre))).collect();
        let (low, high) = heights.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &z| (l.min(z), h.max(z)));
        let mut thickness = (high - low) / count as f64;
        if !(thickness > 0.0 && thickness.is_finite()) {
            return Ok(Self::new(0.0, Vec::new()));
        }
        let mut wire = Wire::new(mesh, table, low, thickness, count);
        let mut crossings = wire.crossings();
        if crossings > MOST_CROSSINGS && count > FEWEST_SLICES {
            count = (count * MOST_CROSSINGS / crossings).max(FEWEST_SLICES);
            thickness = (high - low) / count as f64;
            wire = Wire::new(mesh, table, low, thickness, count);
            crossings = wire.crossings();
        }
        let block = (count * CROSSINGS / crossings.max(CROSSINGS)).max(1);
        let blocks: Vec<_> = (0..count).step_by(block).map(|s| s..(s + block).min(count)).collect();
        let cut = |b: &Range<usize>| cancel.check().map(|()| slices_of(&wire, b));
        let parts: Vec<_> = match blocks.as_slice() {
            [one] => vec![cut(one)?],
            many => many.par_iter().map(|b| cancel.account().within(|| cut(b))).collect::<Result<_, _>>()?,
        };
        Ok(Self::new(thickness, parts.into_iter().flatten().collect()))
    }
}

impl Shadows for Slices {
    fn areas(&mut self, angles: &[f64], cancel: &Cancel) -> Result<Vec<f64>, Cancelled> {
        if let Some(&first) =
            angles.first().filter(|first| !self.stood.is_some_and(|at| (at..at + NEAR).contains(first)))
        {
            let start = first - 0.5 * NEAR;
            self.slices.iter_mut().for_each(|slice| slice.stand(across(start)));
            self.stood = Some(start);
        }
        let noise = NOISE * self.reach;
        let directions: Vec<Flat> = angles.iter().map(|&a| across(a)).collect();
        let mut areas: Vec<_> = directions.iter().map(|&d| self.thickness * self.widths.along(d)).collect();
        let mut walkers = Vec::new();
        for slice in &self.slices {
            let thickness = self.thickness * slice.alike as f64;
            walkers.clear();
            walkers.extend(slice.walkers());
            for (area, &direction) in areas.iter_mut().zip(&directions) {
                cancel.check()?;
                *area += thickness * shadow_length(&slice.points, &mut walkers, direction, noise);
            }
        }
        Ok(areas)
    }
}

/// The slices of a block.
fn slices_of(wire: &Wire, block: &Range<usize>) -> Vec<Slice> {
    let mut slices = Vec::new();
    for slab in Slabs::new(wire, block) {
        push_slices(&mut slices, wire, &slab);
    }
    slices
}

/// Adds the slices of a slab, as one where they are all alike.
fn push_slices(slices: &mut Vec<Slice>, wire: &Wire, slab: &Slab) {
    let is_upright = |piece: &[u32]| piece.iter().all(|&edge| wire.is_upright(edge));
    let upright: Vec<bool> = slab.pieces().map(is_upright).collect();
    let number = if upright.iter().all(|&upright| upright) { 1 } else { slab.slices.len() };
    let first = slices.len();
    slices.resize(first + number, Slice { alike: slab.slices.len() / number, ..Slice::default() });
    let (mut points, mut hull) = (Vec::new(), Vec::new());
    for (piece, upright) in slab.pieces().zip(upright) {
        for (slice, height) in slices[first..].iter_mut().zip(slab.slices.clone()) {
            if !upright || height == slab.slices.start {
                points.clear();
                points.extend(piece.iter().map(|&edge| wire.crossing(edge, height)));
                hull.clear();
                polygon::push_hull(&mut points, &mut hull);
            }
            slice.push(&hull);
        }
    }
    slices[first..].iter_mut().for_each(Slice::drop_covered);
}

/// The interval that a hull covers in a direction that turns counter-clockwise, with the points that bound it.
struct Walker {
    hull: Range<usize>,
    lowest: usize,
    highest: usize,
    low: f64,
    high: f64,
}

impl Slice {
    fn push(&mut self, hull: &[Flat]) {
        self.hulls.push(self.points.len()..self.points.len() + hull.len());
        self.points.extend_from_slice(hull);
    }

    /// Drops the hulls inside the largest one, whose shadows are parts of its own: a plate with ten thousand holes
    /// casts the shadow of a plate.
    fn drop_covered(&mut self) {
        let uncovered = uncovered(&self.points, &self.hulls);
        if uncovered.len() == self.hulls.len() {
            return;
        }
        let mut kept = Self { alike: self.alike, ..Self::default() };
        uncovered.into_iter().for_each(|hull| kept.push(&self.points[hull]));
        *self = kept;
    }

    /// Finds the extreme points of every hull in a direction.
    fn stand(&mut self, direction: Flat) {
        let along = |i: &usize| dot(self.points[*i], direction);
        let extremes = |hull: &Range<usize>| {
            let lowest = hull.clone().min_by(|a, b| along(a).total_cmp(&along(b))).unwrap_or(hull.start);
            let highest = hull.clone().max_by(|a, b| along(a).total_cmp(&along(b))).unwrap_or(hull.start);
            [lowest, highest]
        };
        self.extremes.clear();
        self.extremes.extend(self.hulls.iter().map(extremes));
    }

    /// Walkers where it last stood.
    fn walkers(&self) -> impl Iterator<Item = Walker> + '_ {
        let stand = |(hull, &[lowest, highest]): (&Range<usize>, &[usize; 2])| Walker {
            hull: hull.clone(),
            lowest,
            highest,
            low: 0.0,
            high: 0.0,
        };
        self.hulls.iter().zip(&self.extremes).map(stand)
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
        let hull = 0..points.len();
        let square = Slice { points: points.to_vec(), hulls: vec![hull], alike: 1, extremes: Vec::new() };
        let angles: Vec<_> = (0..180).map(|degrees| f64::from(degrees).to_radians()).collect();
        let areas = Slices::new(1.0, vec![square]).areas(&angles, &Cancel::new()).unwrap();
        for (angle, area) in angles.iter().zip(areas) {
            assert!((area - 2.0 * (angle.sin() + angle.cos().abs())).abs() < 1e-12, "{angle}: {area}");
        }
    }
}
