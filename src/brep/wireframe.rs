//! The edges of a mesh, each once, whatever faces and bodies it lies between.
//!
//! Made once for a model; what looks at it from many sides, the sweep and the silhouettes of all frames, starts here.

use rustc_hash::FxHashMap;

use super::Mesh;
use crate::geometry::{Point, Vector};

/// A mesh as vertices, edges, and triangles of edges. Points with the same coordinates are one vertex; triangles of which
/// two corners are one are left out.
#[derive(Clone, Debug, Default)]
pub struct Wireframe {
    /// The vertices, mm.
    pub vertices: Vec<Point>,
    /// The two vertices of each edge.
    pub edges: Vec<[u32; 2]>,
    /// Of each edge, whether no two triangles beside it go on as one plane: else nothing that is convex has a corner there.
    pub bends: Vec<bool>,
    /// The sides of each triangle, one after the other around it, counter-clockwise seen from outside.
    pub triangles: Vec<[Side; 3]>,
    /// Their unit normals; zero where there is none.
    pub normals: Vec<[f32; 3]>,
}

/// An edge as a triangle goes along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Side(u32);

impl Side {
    fn new(edge: usize, is_reversed: bool) -> Self {
        Self((edge as u32) << 1 | u32::from(is_reversed))
    }

    /// Position in [`Wireframe::edges`].
    #[inline]
    pub fn edge(self) -> usize {
        (self.0 >> 1) as usize
    }

    /// Whether it goes from the second vertex of the edge to the first.
    #[inline]
    pub fn is_reversed(self) -> bool {
        self.0 & 1 == 1
    }
}

/// Distances that are less than this share of the largest coordinate may be rounding only.
const NOISE: f64 = 1e-12;
/// Triangles whose height is not above so many times the noise have no plane to speak of.
const SLIVER: f64 = 1e3;
/// No edge.
const NONE: u32 = u32::MAX;
/// An edge whose ends are both corners of more triangles is found in a table.
const HUB: u32 = 32;

impl Wireframe {
    /// That of a mesh.
    pub fn of(mesh: &Mesh) -> Self {
        let (vertices, ids) = weld(&mesh.points);
        let mut maker = Maker::new(vertices, mesh.triangles.len());
        let welded = |triangle: &[u32; 3]| triangle.map(|i| ids[i as usize]);
        mesh.triangles.as_flattened().iter().for_each(|&i| maker.corners[ids[i as usize] as usize] += 1);
        for [a, b, c] in mesh.triangles.iter().map(welded).filter(|[a, b, c]| a != b && b != c && c != a) {
            let sides = [maker.side([a, b], c), maker.side([b, c], a), maker.side([c, a], b)];
            maker.made.triangles.push(sides);
            maker.made.normals.push(normal([a, b, c].map(|i| &maker.made.vertices[i as usize])));
        }
        maker.made
    }

    /// Where a side of a triangle starts: one of its corners.
    #[inline]
    pub fn start(&self, side: Side) -> usize {
        self.edges[side.edge()][usize::from(side.is_reversed())] as usize
    }
}

/// The unit normal of a triangle.
fn normal([a, b, c]: [&Point; 3]) -> [f32; 3] {
    let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default();
    normal.map(|c| c as f32).into()
}

/// One vertex for all points with the same coordinates, and the vertex of each point.
fn weld(points: &[Point]) -> (Vec<Point>, Vec<u32>) {
    let mut known = FxHashMap::with_capacity_and_hasher(points.len() / 2, Default::default());
    let mut vertices = Vec::with_capacity(points.len() / 2);
    let mut id = |p: &Point| {
        let plus_zero: Vector = p.coords.map(|c| c + 0.0); // -0 and 0 are the same place
        *known.entry((plus_zero.x.to_bits(), plus_zero.y.to_bits(), plus_zero.z.to_bits())).or_insert_with(|| {
            vertices.push(*p);
            vertices.len() as u32 - 1
        })
    };
    let ids = points.iter().map(&mut id).collect();
    (vertices, ids)
}

/// A wireframe in the making: its edges so far, each found at one of its ends.
struct Maker {
    made: Wireframe,
    /// Corners of triangles at each vertex.
    corners: Vec<u32>,
    /// Of each vertex the edge found there last.
    last: Vec<u32>,
    /// Of each edge the one found before it at the same end.
    before: Vec<u32>,
    /// Edges between hubs, by their ends: each may have any number of them.
    between_hubs: FxHashMap<[u32; 2], u32>,
    /// Of each edge the third vertex of the first triangle beside it.
    beside: Vec<u32>,
    /// Distances that may be rounding only, mm.
    noise: f64,
}

impl Maker {
    fn new(vertices: Vec<Point>, triangles: usize) -> Self {
        let reach = vertices.iter().map(|p| (p - vertices[0]).amax()).fold(0.0, f64::max);
        let (corners, last) = (vec![0; vertices.len()], vec![NONE; vertices.len()]);
        // Nearly all edges lie between two triangles.
        let edges = triangles * 3 / 2 + 1;
        let made = Wireframe {
            vertices,
            edges: Vec::with_capacity(edges),
            bends: Vec::with_capacity(edges),
            triangles: Vec::with_capacity(triangles),
            normals: Vec::with_capacity(triangles),
        };
        let (before, beside) = (Vec::with_capacity(edges), Vec::with_capacity(edges));
        let between_hubs = FxHashMap::default();
        Self { made, corners, last, before, between_hubs, beside, noise: NOISE * reach }
    }

    /// The side from one vertex to another of a triangle whose third vertex is `beside`.
    fn side(&mut self, ends: [u32; 2], beside: u32) -> Side {
        let number = self.found(ends);
        if number == NONE {
            self.made.edges.push(ends);
            self.made.bends.push(true);
            self.beside.push(beside);
            return Side::new(self.made.edges.len() - 1, false);
        }
        let edge = number as usize;
        if self.made.bends[edge] && self.beside[edge] != beside && self.is_plane(ends, [self.beside[edge], beside]) {
            self.made.bends[edge] = false;
        }
        Side::new(edge, self.made.edges[edge] != ends)
    }

    /// The edge between two vertices, whichever comes first; where there is none, the next one will be found as that.
    fn found(&mut self, ends: [u32; 2]) -> u32 {
        let (end, next) = (self.kept_at(ends), self.made.edges.len() as u32);
        let turned = [ends[1], ends[0]];
        if self.corners[end] > HUB {
            let number = *self.between_hubs.entry(ends.min(turned)).or_insert(next);
            if number < next {
                return number;
            }
            self.before.push(NONE);
            return NONE;
        }
        let mut number = self.last[end];
        while number != NONE && ![ends, turned].contains(&self.made.edges[number as usize]) {
            number = self.before[number as usize];
        }
        if number == NONE {
            self.before.push(std::mem::replace(&mut self.last[end], next));
        }
        number
    }

    /// The end at which an edge is kept: that with fewer triangles, for there may be any number at the hub of a wheel.
    fn kept_at(&self, [a, b]: [u32; 2]) -> usize {
        let [a, b] = [a, b].map(|i| i as usize);
        if (self.corners[a], a) <= (self.corners[b], b) { a } else { b }
    }

    /// Whether two triangles on either side of an edge lie in one plane.
    fn is_plane(&self, [a, b]: [u32; 2], [c, d]: [u32; 2]) -> bool {
        let from_a = |i: u32| self.made.vertices[i as usize] - self.made.vertices[a as usize];
        let [edge, c, d] = [b, c, d].map(from_a);
        let [left, right] = [edge.cross(&c), edge.cross(&d)];
        let [one, other] = [left.norm_squared(), right.norm_squared()];
        // Slivers lie in every plane.
        let has_plane = one.min(other) > (SLIVER * self.noise).powi(2) * edge.norm_squared();
        // The corner of the smaller triangle stands so far from the plane of the larger one.
        has_plane && left.dot(&right) < 0.0 && left.dot(&d).powi(2) <= self.noise.powi(2) * one.max(other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::shapes;

    /// Two triangles with the side from (0, 0, 0) to (0, 0, 4), which is doubled by a sliver between them.
    fn hinge(sliver: f64, other: [f64; 3]) -> Wireframe {
        let points = [[0.0, 0.0, 0.0], [0.0, 0.0, 4.0], [1.0, 0.0, 2.0], [0.0, sliver, 4.0], other].map(Point::from);
        let mut triangles = vec![[0, 1, 2], [3, 0, 4]];
        if sliver > 0.0 {
            triangles.push([0, 1, 3]);
        }
        Wireframe::of(&shapes::mesh(points.to_vec(), triangles))
    }

    #[test]
    fn an_edge_bends_where_its_triangles_do_and_a_sliver_flattens_none() {
        let straight = |wireframe: &Wireframe| wireframe.bends.iter().filter(|bends| !**bends).count();
        assert_eq!(straight(&hinge(0.0, [-1.0, 0.0, 2.0])), 1);
        assert_eq!(straight(&hinge(0.0, [1.0, 1e-3, 2.0])), 0, "folded back");
        assert_eq!(straight(&hinge(0.0, [0.0, 1.0, 2.0])), 0);
        assert_eq!(straight(&hinge(1e-14, [0.0, 1.0, 2.0])), 0);
    }

    /// A cube whose faces have points of their own: 8 vertices, 12 edges and 6 diagonals, each passed once either way.
    #[test]
    fn the_faces_of_a_cube_share_their_edges() {
        let cube = shapes::cuboid(1.0, 1.0, 1.0);
        let points = cube.triangles.iter().flatten().map(|&i| cube.points[i as usize]).collect();
        let triangles = (0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let apart = Wireframe::of(&shapes::mesh(points, triangles));
        assert_eq!((apart.vertices.len(), apart.edges.len(), apart.triangles.len()), (8, 18, 12));
        assert_eq!(apart.bends.iter().filter(|bends| **bends).count(), 12);
        let mut passed = vec![[0; 2]; 18];
        for side in apart.triangles.iter().flatten() {
            passed[side.edge()][usize::from(side.is_reversed())] += 1;
        }
        assert!(passed.iter().all(|both| *both == [1, 1]), "{passed:?}");
        for sides in &apart.triangles {
            for (side, next) in sides.iter().zip([sides[1], sides[2], sides[0]]) {
                let end = apart.edges[side.edge()][usize::from(!side.is_reversed())];
                assert_eq!(end as usize, apart.start(next));
            }
        }
    }

    /// All triangles of a few points: each pair of points is one edge, whatever the number of triangles around them, and
    /// looked for in a table where that is large.
    #[test]
    fn edges_between_hubs_are_found_once() {
        for count in [4_u32, 9, 10, 40] {
            let angle = |i: u32| f64::from(i) * 0.37;
            let points = (0..count).map(|i| Point::new(angle(i).cos(), angle(i).sin(), f64::from(i))).collect();
            let pairs = |a: u32| (a + 1..count).flat_map(move |b| (b + 1..count).map(move |c| [a, b, c]));
            let triangles: Vec<_> = (0..count).flat_map(pairs).collect();
            let all = Wireframe::of(&shapes::mesh(points, triangles.clone()));
            assert_eq!(all.edges.len(), (count * (count - 1) / 2) as usize);
            for (sides, corners) in all.triangles.iter().zip(&triangles) {
                assert_eq!(sides.map(|side| all.start(side) as u32), *corners);
            }
        }
    }
}
