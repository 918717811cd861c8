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
    /// The edge found before it at the same end; 0 for the first.
    before: u32,
    /// No two triangles beside it go on as one plane: else its crossings lie between those of other edges, and no hull
    /// has a corner there.
    bends: bool,
    /// All slices cross it at the same place.
    upright: bool,
}

/// The edges found so far, each at one of its ends.
struct Found {
    /// Corners of triangles at each vertex.
    corners: Vec<u32>,
    /// Of each vertex the edge found last; 0 if there is none.
    last: Vec<u32>,
}

impl Found {
    fn none(mesh: &Mesh, ids: &[u32], vertices: usize) -> Self {
        let mut corners = vec![0; vertices];
        mesh.triangles.as_flattened().iter().for_each(|&i| corners[ids[i as usize] as usize] += 1);
        Self { corners, last: vec![0; vertices] }
    }

    /// Where an edge is kept: at the end with fewer triangles, for there may be any number at the hub of a wheel.
    fn end(&self, [a, b]: [u32; 2]) -> usize {
        let [a, b] = [a, b].map(|i| i as usize);
        if self.corners[a] <= self.corners[b] { a } else { b }
    }
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
        let none = Edge { ends: [0; 2], beside: 0, before: 0, bends: false, upright: false };
        let mut wire = Self { vertices, low, thickness, noise: NOISE * reach, ..Self::default() };
        // Nearly all edges lie between two triangles.
        wire.edges.reserve(mesh.triangles.len() * 3 / 2 + 1);
        wire.edges.push(none);
        wire.triangles.reserve(mesh.triangles.len());
        let mut found = Found::none(mesh, &ids, wire.vertices.len());
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|i| ids[i as usize]);
            if a != b && b != c && c != a {
                wire.push([a, b, c], &mut found);
            }
        }
        let edges = (1..wire.edges.len() as u32).map(|edge| (wire.span(edge), edge));
        let triangles = wire.triangles.iter().zip(0..).map(|(triangle, number)| (wire.span(triangle.long), number));
        (wire.rising_edges, wire.rising_triangles) = (rising(edges, count), rising(triangles, count));
        wire
    }

    /// Adds a triangle unless it lies between two slices.
    fn push(&mut self, mut corners: [u32; 3], found: &mut Found) {
        let level = |i: u32| self.vertices[i as usize].level;
        corners.sort_unstable_by_key(|&i| level(i));
        let [a, b, c] = corners;
        if level(a) == level(c) {
            return;
        }
        let middle = level(b);
        let long = self.edge([a, c], b, found);
        let short = [self.edge([a, b], c, found), self.edge([b, c], a, found)];
        self.triangles.push(Triangle { long, short, middle });
    }

    /// The edge between two vertices, the lower one first, of a triangle whose third vertex is `beside`.
    fn edge(&mut self, ends: [u32; 2], beside: u32, found: &mut Found) -> u32 {
        let [lower, upper] = ends.map(|i| &self.vertices[i as usize]);
        if lower.level == upper.level {
            return 0;
        }
        let end = found.end(ends);
        let last = &mut found.last[end];
        let mut number = *last;
        while number != 0 && self.edges[number as usize].ends != ends {
            number = self.edges[number as usize].before;
        }
        if number == 0 {
            let apart = (lower.at[0] - upper.at[0]).abs().max((lower.at[1] - upper.at[1]).abs());
            self.edges.push(Edge { ends, beside, before: *last, bends: true, upright: apart <= self.noise });
            *last = self.edges.len() as u32 - 1;
            return *last;
        }
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
        self.edges[edge as usize].upright
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
fn rising(spans: impl Iterator<Item = (Range<u32>, u32)>, count: usize) -> Vec<(Range<u32>, u32)> {
    let spans: Vec<_> = spans.map(|span| (span.0.start, span)).collect();
    let mut rising = Vec::new();
    group(&spans, count + 1, &mut rising, &mut Vec::new());
    rising
}

/// Sorts things by the number of their group, those of one in the order in which they came, and tells where each of
/// `count` groups ends.
pub(super) fn group<T: Clone + Default>(things: &[(u32, T)], count: usize, sorted: &mut Vec<T>, ends: &mut Vec<usize>) {
    ends.clear();
    ends.resize(count, 0);
    things.iter().for_each(|(group, _)| ends[*group as usize] += 1);
    // Sizes become starts, and as things are put in, ends.
    let mut total = 0;
    ends.iter_mut().for_each(|size| total += std::mem::replace(size, total));
    sorted.resize(total, T::default());
    for (group, thing) in things {
        let end = &mut ends[*group as usize];
        sorted[*end] = thing.clone();
        *end += 1;
    }
}

/// One vertex for all points with the same coordinates, and the vertex of each point.
fn weld(mesh: &Mesh, vertex: impl Fn(&Point) -> WireVertex) -> (Vec<WireVertex>, Vec<u32>) {
    let mut known = FxHashMap::with_capacity_and_hasher(mesh.points.len() / 2, Default::default());
    let mut vertices = Vec::with_capacity(mesh.points.len());
    let mut id = |p: &Point| {
        let plus_zero: Vector = p.coords.map(|c| c + 0.0); // -0 and 0 are the same place
        *known.entry((plus_zero.x.to_bits(), plus_zero.y.to_bits(), plus_zero.z.to_bits())).or_insert_with(|| {
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
