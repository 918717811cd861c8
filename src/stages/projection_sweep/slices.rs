//! Projected areas by exact spans.
//!
//! The mesh is cut once, by planes across the reference axis. In a slice, every connected piece of the cut casts one
//! unbroken shadow on any line, so a piece is as good as its convex hull, and the shadow of the slice is a union of
//! few intervals. Walking round the hulls gives the shadows in all directions at hardly more than the price of one.

use std::ops::Range;

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::brep::Mesh;
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::{Point, Vector, polygon};
use crate::stages::parse::Parsed;

use super::cover::uncovered;
use super::curve::Shadows;
use super::reference::Turntable;

/// Edge crossings held at a time by one worker: bounds the memory at some 100 MB.
const CROSSINGS: usize = 1 << 20;

/// Edge crossings in all: a mesh of millions of triangles is cut into fewer slices, but never fewer than so many.
const MOST_CROSSINGS: usize = 1 << 26;
const FEWEST_SLICES: usize = 16;

/// A point of a cut: (along u, along v) of the turntable, mm.
pub(super) type Flat = [f64; 2];

/// The convex hulls of the pieces of every slice.
pub struct Slices {
    thickness: f64,
    slices: Vec<Slice>,
}

/// The pieces of the cut at one height: convex hulls, counter-clockwise, one after the other.
#[derive(Clone, Debug, Default)]
struct Slice {
    points: Vec<Flat>,
    hulls: Vec<Range<usize>>,
}

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

    /// Cuts the mesh into `count` slices of equal thickness from its lowest to its highest point along the axis.
    pub(super) fn cut(mesh: &Mesh, table: &Turntable, count: u32, cancel: &Cancel) -> Result<Self, Cancelled> {
        let mut count = count.clamp(1, 65_536) as usize;
        let heights: Vec<f64> = mesh.points.iter().map(|p| table.axis.dot(&(p - table.centre))).collect();
        let (low, high) = heights.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &z| (l.min(z), h.max(z)));
        let mut thickness = (high - low) / count as f64;
        if !(thickness > 0.0 && thickness.is_finite()) {
            return Ok(Self { thickness: 0.0, slices: Vec::new() });
        }
        let mut wire = Wire::new(mesh, table, low, thickness, count);
        let mut crossings = wire.crossings(count);
        if crossings > MOST_CROSSINGS && count > FEWEST_SLICES {
            count = (count * MOST_CROSSINGS / crossings).max(FEWEST_SLICES);
            thickness = (high - low) / count as f64;
            wire = Wire::new(mesh, table, low, thickness, count);
            crossings = wire.crossings(count);
        }
        let block = (count * CROSSINGS / crossings.max(CROSSINGS)).max(1);
        let blocks: Vec<_> = (0..count).step_by(block).map(|s| s..(s + block).min(count)).collect();
        let cut = |b: &Range<usize>| cancel.check().map(|()| wire.cut(b.clone()));
        let parts: Vec<_> = match blocks.as_slice() {
            [one] => vec![cut(one)?],
            many => many.par_iter().map(|b| cancel.account().within(|| cut(b))).collect::<Result<_, _>>()?,
        };
        Ok(Self { thickness, slices: parts.into_iter().flatten().collect() })
    }
}

impl Shadows for Slices {
    fn areas(&mut self, angles: &[f64], cancel: &Cancel) -> Result<Vec<f64>, Cancelled> {
        let directions: Vec<Flat> = angles.iter().map(|a| [-a.sin(), a.cos()]).collect();
        let mut areas = vec![0.0; angles.len()];
        let mut walkers = Vec::new();
        for slice in &self.slices {
            slice.start(directions[0], &mut walkers);
            for (area, &direction) in areas.iter_mut().zip(&directions) {
                cancel.check()?;
                *area += self.thickness * shadow_length(&slice.points, &mut walkers, direction);
            }
        }
        Ok(areas)
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

impl Slice {
    /// Drops the hulls inside the largest one, whose shadows are parts of its own: a plate with ten thousand holes
    /// casts the shadow of a plate.
    fn drop_covered(&mut self) {
        let mut kept = Self::default();
        for hull in uncovered(&self.points, &self.hulls) {
            let start = kept.points.len();
            kept.points.extend_from_slice(&self.points[hull]);
            kept.hulls.push(start..kept.points.len());
        }
        *self = kept;
    }

    /// Stands at the extreme points of every hull in a direction.
    fn start(&self, direction: Flat, walkers: &mut Vec<Walker>) {
        let along = |i: &usize| dot(self.points[*i], direction);
        let stand = |hull: &Range<usize>| {
            let lowest = hull.clone().min_by(|a, b| along(a).total_cmp(&along(b))).unwrap_or(hull.start);
            let highest = hull.clone().max_by(|a, b| along(a).total_cmp(&along(b))).unwrap_or(hull.start);
            Walker { hull: hull.clone(), lowest, highest, low: 0.0, high: 0.0 }
        };
        walkers.clear();
        walkers.extend(self.hulls.iter().map(stand));
    }
}

impl Walker {
    /// Walks on to the extreme points in a direction at most half a turn after the last.
    fn turn(&mut self, points: &[Flat], direction: Flat) {
        let next = |i: usize| if i + 1 == self.hull.end { self.hull.start } else { i + 1 };
        self.high = dot(points[self.highest], direction);
        self.low = dot(points[self.lowest], direction);
        for _ in 0..self.hull.len() {
            let ahead = dot(points[next(self.highest)], direction);
            if ahead <= self.high {
                break;
            }
            (self.highest, self.high) = (next(self.highest), ahead);
        }
        for _ in 0..self.hull.len() {
            let ahead = dot(points[next(self.lowest)], direction);
            if ahead >= self.low {
                break;
            }
            (self.lowest, self.low) = (next(self.lowest), ahead);
        }
    }
}

/// Length of the union of the hulls' intervals in a direction.
fn shadow_length(points: &[Flat], walkers: &mut [Walker], direction: Flat) -> f64 {
    walkers.iter_mut().for_each(|w| w.turn(points, direction));
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

fn dot(a: Flat, b: Flat) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// The mesh as vertices with their level (the first slice at or above them), edges and triangles of edges.
struct Wire {
    vertices: Vec<WireVertex>,
    /// Lower and upper vertex.
    edges: Vec<[u32; 2]>,
    /// The three edges of each triangle.
    triangles: Vec<[u32; 3]>,
    low: f64,
    thickness: f64,
}

struct WireVertex {
    at: Flat,
    height: f64,
    level: usize,
}

impl Wire {
    fn new(mesh: &Mesh, table: &Turntable, low: f64, thickness: f64, count: usize) -> Self {
        let (vertices, ids) = weld(mesh, |p| {
            let d = p - table.centre;
            let height = table.axis.dot(&d);
            let level = ((height - low) / thickness - 0.5).ceil().clamp(0.0, count as f64) as usize;
            WireVertex { at: [table.u.dot(&d), table.v.dot(&d)], height, level }
        });
        let mut wire = Self { vertices, edges: Vec::new(), triangles: Vec::new(), low, thickness };
        let mut known = FxHashMap::default();
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|i| ids[i as usize]);
            if a != b && b != c && c != a {
                let edges = [[a, b], [b, c], [c, a]].map(|e| wire.edge(e, &mut known));
                wire.triangles.push(edges);
            }
        }
        wire
    }

    fn edge(&mut self, [a, b]: [u32; 2], known: &mut FxHashMap<[u32; 2], u32>) -> u32 {
        let height = |i: u32| self.vertices[i as usize].height;
        let (lower, upper) = if (height(a), a) <= (height(b), b) { (a, b) } else { (b, a) };
        let next = self.edges.len() as u32;
        *known.entry([lower, upper]).or_insert_with(|| {
            self.edges.push([lower, upper]);
            next
        })
    }

    /// The slices of `block` that an edge crosses.
    fn span(&self, edge: &[u32; 2], block: Range<usize>) -> Range<usize> {
        let [lower, upper] = edge.map(|i| self.vertices[i as usize].level);
        let start = lower.max(block.start);
        start..upper.min(block.end).max(start)
    }

    /// How often edges cross slices.
    fn crossings(&self, count: usize) -> usize {
        self.edges.iter().map(|e| self.span(e, 0..count).len()).sum()
    }

    /// Cuts the slices of a block.
    fn cut(&self, block: Range<usize>) -> Vec<Slice> {
        let (mut points, pieces) = Crossings::new(self, &block).pieces();
        let mut slices = vec![Slice::default(); block.len()];
        let mut from = 0;
        for (end, slice) in pieces {
            let slice = &mut slices[slice - block.start];
            let start = slice.points.len();
            polygon::push_hull(&mut points[from..end], &mut slice.points);
            slice.hulls.push(start..slice.points.len());
            from = end;
        }
        slices.iter_mut().for_each(Slice::drop_covered);
        slices
    }

    /// Where an edge crosses a slice.
    fn crossing(&self, edge: &[u32; 2], slice: usize) -> Flat {
        let [a, b] = edge.map(|i| &self.vertices[i as usize]);
        let height = self.low + (slice as f64 + 0.5) * self.thickness;
        let share = ((height - a.height) / (b.height - a.height)).clamp(0.0, 1.0);
        [a.at[0] + share * (b.at[0] - a.at[0]), a.at[1] + share * (b.at[1] - a.at[1])]
    }
}

/// One vertex for all points with the same coordinates, and the vertex of each point.
fn weld(mesh: &Mesh, vertex: impl Fn(&Point) -> WireVertex) -> (Vec<WireVertex>, Vec<u32>) {
    let mut known = FxHashMap::default();
    let mut vertices = Vec::new();
    let mut id = |p: &Point| {
        let plus_zero: Vector = p.coords.map(|c| c + 0.0); // -0 and 0 are the same place
        *known.entry([plus_zero.x.to_bits(), plus_zero.y.to_bits(), plus_zero.z.to_bits()]).or_insert_with(|| {
            vertices.push(vertex(p));
            vertices.len() as u32 - 1
        })
    };
    let ids = mesh.points.iter().map(&mut id).collect();
    (vertices, ids)
}

/// All crossings of edges with the slices of a block, edge by edge, joined into connected pieces.
struct Crossings {
    points: Vec<Flat>,
    slices: Vec<u32>,
    parents: Vec<u32>,
}

impl Crossings {
    fn new(wire: &Wire, block: &Range<usize>) -> Self {
        let mut all = Self { points: Vec::new(), slices: Vec::new(), parents: Vec::new() };
        let mut starts = Vec::with_capacity(wire.edges.len());
        for edge in &wire.edges {
            starts.push(all.points.len());
            for slice in wire.span(edge, block.clone()) {
                all.parents.push(all.points.len() as u32);
                all.slices.push(slice as u32);
                all.points.push(wire.crossing(edge, slice));
            }
        }
        for triangle in &wire.triangles {
            all.join_triangle(wire, block, triangle, &starts);
        }
        all
    }

    /// In every slice that a triangle crosses, its two crossings are connected.
    fn join_triangle(&mut self, wire: &Wire, block: &Range<usize>, triangle: &[u32; 3], starts: &[usize]) {
        let mut sides = triangle.map(|e| (wire.span(&wire.edges[e as usize], block.clone()), starts[e as usize]));
        sides.sort_unstable_by_key(|(span, _)| std::cmp::Reverse(span.len()));
        let [(long, at_long), others @ ..] = sides;
        for (span, at) in others {
            for slice in span.clone() {
                self.join((at_long + slice - long.start) as u32, (at + slice - span.start) as u32);
            }
        }
    }

    fn root(&mut self, mut i: u32) -> u32 {
        while self.parents[i as usize] != i {
            let above = self.parents[self.parents[i as usize] as usize];
            self.parents[i as usize] = above;
            i = above;
        }
        i
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b) as usize] = a.min(b);
    }

    /// Numbers the pieces in order of their first crossings: the piece of each crossing, and how many there are.
    fn numbered(&mut self) -> (Vec<u32>, usize) {
        let mut piece_of = vec![u32::MAX; self.points.len()];
        let mut count = 0;
        for i in 0..self.points.len() {
            // The root is the first crossing of its piece.
            let root = self.root(i as u32) as usize;
            if root == i {
                piece_of[i] = count;
                count += 1;
            }
            piece_of[i] = piece_of[root];
        }
        (piece_of, count as usize)
    }

    /// The points piece by piece, where each piece ends, and the slice that it lies in.
    fn pieces(mut self) -> (Vec<Flat>, Vec<(usize, usize)>) {
        let (piece_of, count) = self.numbered();
        let mut pieces = vec![(0, 0); count];
        for (&piece, &slice) in piece_of.iter().zip(&self.slices) {
            let (size, in_slice) = &mut pieces[piece as usize];
            (*size, *in_slice) = (*size + 1, slice as usize);
        }
        // Sizes become starts, and as points are put in, ends.
        let mut start = 0;
        for (size, _) in &mut pieces {
            start += std::mem::replace(size, start);
        }
        let mut points = vec![[0.0; 2]; self.points.len()];
        for (&piece, &point) in piece_of.iter().zip(&self.points) {
            let end = &mut pieces[piece as usize].0;
            points[*end] = point;
            *end += 1;
        }
        (points, pieces)
    }
}
