//! The edges of a mesh and the pieces that slices cut them into.

use std::ops::Range;

use rustc_hash::FxHashMap;

use crate::brep::Mesh;
use crate::geometry::cells::first_centre;
use crate::geometry::{Point, Vector};

use super::reference::Turntable;
use super::slices::Flat;

/// The mesh as vertices with their level (the first slice at or above them), edges and triangles of edges.
pub(super) struct Wire {
    vertices: Vec<WireVertex>,
    /// Lower and upper vertex; first one that crosses no slice and stands for all those.
    edges: Vec<[u32; 2]>,
    /// The edges of each triangle that crosses a slice, the one first that crosses as many as the triangle.
    triangles: Vec<[u32; 3]>,
    low: f64,
    thickness: f64,
}

struct WireVertex {
    at: Flat,
    height: f64,
    level: u32,
}

impl Wire {
    pub fn new(mesh: &Mesh, table: &Turntable, low: f64, thickness: f64, count: usize) -> Self {
        let (vertices, ids) = weld(mesh, |p| {
            let d = p - table.centre;
            let height = table.axis.dot(&d);
            let level = first_centre((height - low) / thickness, count) as u32;
            WireVertex { at: [table.u.dot(&d), table.v.dot(&d)], height, level }
        });
        let mut wire = Self { vertices, edges: vec![[0, 0]], triangles: Vec::new(), low, thickness };
        let mut known = FxHashMap::with_capacity_and_hasher(mesh.triangles.len(), Default::default());
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|i| ids[i as usize]);
            if a != b && b != c && c != a {
                wire.push([a, b, c], &mut known);
            }
        }
        wire
    }

    /// Adds a triangle unless it lies between two slices.
    fn push(&mut self, [a, b, c]: [u32; 3], known: &mut FxHashMap<u64, u32>) {
        let mut edges = [[a, b], [b, c], [c, a]].map(|e| self.edge(e, known));
        if edges != [0; 3] {
            edges.sort_by_key(|&e| std::cmp::Reverse(self.span(&self.edges[e as usize], 0..usize::MAX).len()));
            self.triangles.push(edges);
        }
    }

    fn edge(&mut self, [a, b]: [u32; 2], known: &mut FxHashMap<u64, u32>) -> u32 {
        let [p, q] = [a, b].map(|i| &self.vertices[i as usize]);
        if p.level == q.level {
            return 0;
        }
        let [lower, upper] = if p.level < q.level { [a, b] } else { [b, a] };
        *known.entry(u64::from(lower) << 32 | u64::from(upper)).or_insert_with(|| {
            self.edges.push([lower, upper]);
            self.edges.len() as u32 - 1
        })
    }

    /// The slices of `block` that an edge crosses.
    fn span(&self, edge: &[u32; 2], block: Range<usize>) -> Range<usize> {
        let [lower, upper] = edge.map(|i| self.vertices[i as usize].level as usize);
        let start = lower.max(block.start);
        start..upper.min(block.end).max(start)
    }

    /// How often edges cross the slices of a block.
    pub fn crossings(&self, block: &Range<usize>) -> usize {
        self.edges.iter().map(|e| self.span(e, block.clone()).len()).sum()
    }

    /// Cuts the slices of a block: the points of the cut piece by piece, where each piece ends, and its slice.
    pub fn pieces(&self, block: &Range<usize>) -> (Vec<Flat>, Vec<(usize, usize)>) {
        Crossings::new(self, block).pieces()
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
    let mut known = FxHashMap::with_capacity_and_hasher(mesh.points.len(), Default::default());
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
        let count = wire.crossings(block);
        let [slices, parents] = [Vec::with_capacity(count), Vec::with_capacity(count)];
        let mut all = Self { points: Vec::with_capacity(count), slices, parents };
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
        let sides = triangle.map(|e| (wire.span(&wire.edges[e as usize], block.clone()), starts[e as usize]));
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
