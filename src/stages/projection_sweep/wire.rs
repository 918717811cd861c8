//! The edges of a mesh as slices cross them.

use std::ops::Range;

use rustc_hash::FxHashMap;

use crate::brep::Mesh;
use crate::geometry::cells::first_centre;
use crate::geometry::{Point, Vector};

use super::reference::Turntable;
use super::slices::{Flat, NOISE};

/// Triangles whose height is not above so many times the noise have no plane to speak of.
const SLIVER: f64 = 1e3;

/// The mesh as vertices with their level (the first slice at or above them), edges and triangles of edges.
#[derive(Default)]
pub(super) struct Wire {
    vertices: Vec<WireVertex>,
    /// First one that crosses no slice and stands for all those.
    edges: Vec<Edge>,
    triangles: Vec<Triangle>,
    /// The slices that edges and triangles cross, in the order of the first of these.
    pub rising_edges: Vec<(Range<u32>, u32)>,
    pub rising_triangles: Vec<(Range<u32>, u32)>,
    low: f64,
    thickness: f64,
    /// Distances that may be rounding only, mm.
    noise: f64,
}

struct WireVertex {
    at: Flat,
    height: f64,
    level: u32,
}

/// An edge between two levels.
struct Edge {
    /// Lower and upper vertex.
    ends: [u32; 2],
    /// The third vertex of the first triangle beside it.
    beside: u32,
    /// No two triangles beside it go on as one plane: else its crossings lie between those of other edges, and no hull
    /// has a corner there.
    bends: bool,
}

/// A triangle that crosses slices, as its sides.
pub(super) struct Triangle {
    /// From the lowest corner to the highest.
    pub long: u32,
    /// From the lowest corner to the middle one, and from there to the highest.
    pub short: [u32; 2],
    /// The level of the middle corner.
    pub middle: u32,
}

impl Wire {
    pub fn new(mesh: &Mesh, table: &Turntable, low: f64, thickness: f64, count: usize) -> Self {
        let (vertices, ids) = weld(mesh, |p| {
            let d = p - table.centre;
            let height = table.axis.dot(&d);
            let level = first_centre((height - low) / thickness, count) as u32;
            WireVertex { at: [table.u.dot(&d), table.v.dot(&d)], height, level }
        });
        let reach = vertices.iter().flat_map(|v| v.at).fold(0.0, |most: f64, c| most.max(c.abs()));
        let none = Edge { ends: [0; 2], beside: 0, bends: false };
        let mut wire = Self { vertices, edges: vec![none], low, thickness, noise: NOISE * reach, ..Self::default() };
        let mut known = FxHashMap::with_capacity_and_hasher(mesh.triangles.len(), Default::default());
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|i| ids[i as usize]);
            if a != b && b != c && c != a {
                wire.push([a, b, c], &mut known);
            }
        }
        let edges = (1..wire.edges.len() as u32).map(|edge| (wire.span(edge), edge));
        let triangles = wire.triangles.iter().zip(0..).map(|(triangle, number)| (wire.span(triangle.long), number));
        (wire.rising_edges, wire.rising_triangles) = (rising(edges, count), rising(triangles, count));
        wire
    }

    /// Adds a triangle unless it lies between two slices.
    fn push(&mut self, mut corners: [u32; 3], known: &mut FxHashMap<u64, u32>) {
        let level = |i: u32| self.vertices[i as usize].level;
        corners.sort_unstable_by_key(|&i| level(i));
        let [a, b, c] = corners;
        if level(a) == level(c) {
            return;
        }
        let middle = level(b);
        let long = self.edge([a, c], b, known);
        let short = [self.edge([a, b], c, known), self.edge([b, c], a, known)];
        self.triangles.push(Triangle { long, short, middle });
    }

    /// The edge between two vertices, the lower one first, of a triangle whose third vertex is `beside`.
    fn edge(&mut self, ends: [u32; 2], beside: u32, known: &mut FxHashMap<u64, u32>) -> u32 {
        let [lower, upper] = ends;
        if self.vertices[lower as usize].level == self.vertices[upper as usize].level {
            return 0;
        }
        let number = *known.entry(u64::from(lower) << 32 | u64::from(upper)).or_insert_with(|| {
            self.edges.push(Edge { ends, beside, bends: true });
            self.edges.len() as u32 - 1
        });
        let edge = &self.edges[number as usize];
        if edge.bends && edge.beside != beside && self.is_plane(ends, [edge.beside, beside]) {
            self.edges[number as usize].bends = false;
        }
        number
    }

    /// Whether two triangles on either side of an edge lie in one plane.
    fn is_plane(&self, [a, b]: [u32; 2], [c, d]: [u32; 2]) -> bool {
        let place = |i: u32| {
            let vertex = &self.vertices[i as usize];
            Vector::new(vertex.at[0], vertex.at[1], vertex.height)
        };
        let [edge, c, d] = [b, c, d].map(|i| place(i) - place(a));
        let [left, right] = [edge.cross(&c), edge.cross(&d)];
        let (larger, smaller) = (left.norm_squared(), right.norm_squared());
        let (larger, smaller) = (larger.max(smaller), larger.min(smaller));
        // Slivers lie in every plane.
        let has_plane = smaller > (SLIVER * self.noise).powi(2) * edge.norm_squared();
        // The corner of the smaller triangle stands so far from the plane of the larger one.
        has_plane && left.dot(&right) < 0.0 && left.dot(&d).powi(2) <= self.noise.powi(2) * larger
    }

    /// The slices that the edge crosses.
    fn span(&self, edge: u32) -> Range<u32> {
        let [lower, upper] = self.edges[edge as usize].ends.map(|i| self.vertices[i as usize].level);
        lower..upper
    }

    /// How often edges cross slices.
    pub fn crossings(&self) -> usize {
        self.rising_edges.iter().map(|(slices, _)| slices.len()).sum()
    }

    pub fn triangle(&self, number: u32) -> &Triangle {
        &self.triangles[number as usize]
    }

    /// Whether hulls may have corners where the edge crosses.
    pub fn bends(&self, edge: u32) -> bool {
        self.edges[edge as usize].bends
    }

    /// Whether all slices cross the edge at the same place.
    pub fn is_upright(&self, edge: u32) -> bool {
        let [a, b] = self.edges[edge as usize].ends.map(|i| self.vertices[i as usize].at);
        (a[0] - b[0]).abs().max((a[1] - b[1]).abs()) <= self.noise
    }

    /// Where an edge crosses a slice.
    pub fn crossing(&self, edge: u32, slice: u32) -> Flat {
        let [a, b] = self.edges[edge as usize].ends.map(|i| &self.vertices[i as usize]);
        let height = self.low + (f64::from(slice) + 0.5) * self.thickness;
        let share = ((height - a.height) / (b.height - a.height)).clamp(0.0, 1.0);
        [a.at[0] + share * (b.at[0] - a.at[0]), a.at[1] + share * (b.at[1] - a.at[1])]
    }
}

/// In the order of the first of `count` slices that each crosses.
fn rising(spans: impl Iterator<Item = (Range<u32>, u32)> + Clone, count: usize) -> Vec<(Range<u32>, u32)> {
    grouped(spans.map(|span| (span.0.start, span)), count + 1).0
}

/// Things group by group, those of one in the order in which they came, and where each of `count` groups ends.
pub(super) fn grouped<T: Clone + Default>(
    things: impl Iterator<Item = (u32, T)> + Clone,
    count: usize,
) -> (Vec<T>, Vec<usize>) {
    let mut ends = vec![0; count];
    things.clone().for_each(|(group, _)| ends[group as usize] += 1);
    // Sizes become starts, and as things are put in, ends.
    let mut total = 0;
    ends.iter_mut().for_each(|size| total += std::mem::replace(size, total));
    let mut sorted = vec![T::default(); total];
    for (group, thing) in things {
        let end = &mut ends[group as usize];
        sorted[*end] = thing;
        *end += 1;
    }
    (sorted, ends)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::shapes;

    /// Two triangles with the side from (0, 0, 0) to (0, 0, 4), which is doubled by a sliver between them.
    fn hinge(sliver: f64, other: [f64; 3]) -> Wire {
        let points = [[0.0, 0.0, 0.0], [0.0, 0.0, 4.0], [1.0, 0.0, 2.0], [0.0, sliver, 4.0], other].map(Point::from);
        let mut triangles = vec![[0, 1, 2], [3, 0, 4]];
        if sliver > 0.0 {
            triangles.push([0, 1, 3]);
        }
        let mesh = shapes::mesh(points.to_vec(), triangles);
        let (axis, u, v) = (Vector::z(), Vector::x(), Vector::y());
        Wire::new(&mesh, &Turntable { axis, u, v, centre: Point::origin(), largest_variance: 0.0 }, 0.0, 0.5, 8)
    }

    #[test]
    fn an_edge_bends_where_its_triangles_do_and_a_sliver_flattens_none() {
        let straight = |wire: &Wire| (1..wire.edges.len() as u32).filter(|&edge| !wire.bends(edge)).count();
        assert_eq!(straight(&hinge(0.0, [-1.0, 0.0, 2.0])), 1);
        assert_eq!(straight(&hinge(0.0, [1.0, 1e-3, 2.0])), 0, "folded back");
        assert_eq!(straight(&hinge(0.0, [0.0, 1.0, 2.0])), 0);
        assert_eq!(straight(&hinge(1e-14, [0.0, 1.0, 2.0])), 0);
    }
}
