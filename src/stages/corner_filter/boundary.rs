//! The loops of a maximal face, without seams and poles, and their corners.

use super::edges::EdgeShapes;
use super::{InnerLoop, LocalOutline};
use crate::brep::{EdgeId, EdgeUse, FaceGeometry, FaceId, Model, Surface, VertexId};
use crate::geometry::{Axis, Point, Vector};

/// A closed chain of edges around a maximal face.
#[derive(Clone, Debug, Default)]
pub(super) struct Boundary {
    pub corners: Vec<Point>,
    /// Points along the loop, close enough together for areas and centroids.
    pub points: Vec<Point>,
    pub length: f64,
    /// Whether a piece of it belongs to a loop that the file calls the outer one.
    pub outer: bool,
}

impl Boundary {
    /// Half the sum of p x q, taken about the first point.
    pub fn vector_area(&self) -> Vector {
        let Some(origin) = self.points.first() else { return Vector::zeros() };
        let spokes = self.points.windows(2).map(|w| (w[0] - origin).cross(&(w[1] - origin)));
        spokes.sum::<Vector>() * 0.5
    }

    /// Mean of the loop by arc length.
    fn centroid(&self) -> Point {
        let mut sum = (Vector::zeros(), 0.0);
        for (p, q) in self.points.iter().zip(self.points.iter().cycle().skip(1)) {
            let length = (q - p).norm();
            sum = (sum.0 + (p.coords + q.coords) * (0.5 * length), sum.1 + length);
        }
        if sum.1 > 0.0 { Point::from(sum.0 / sum.1) } else { self.points.first().copied().unwrap_or_default() }
    }
}

/// Finds the loops of one group of faces after the other, in the same memory.
pub(super) struct Tracer<'a> {
    pub model: &'a Model,
    pub shapes: &'a EdgeShapes,
    /// An edge shorter than this is a pole, mm.
    pub shortest: f64,
    /// Radians.
    pub corner_angle: f64,
    room: Room,
}

/// What is filled anew for each group.
#[derive(Default)]
struct Room {
    /// Uses of edges, and whether their loop is called the outer one.
    uses: Vec<(EdgeUse, bool)>,
    edges: Vec<EdgeId>,
    /// Where uses start, and their positions.
    starts: Vec<(VertexId, usize)>,
    used: Vec<bool>,
    /// Positions of uses that follow each other.
    chain: Vec<usize>,
}

impl<'a> Tracer<'a> {
    pub fn new(model: &'a Model, shapes: &'a EdgeShapes, shortest: f64, corner_angle: f64) -> Self {
        Self { model, shapes, shortest, corner_angle, room: Room::default() }
    }

    /// The loops around a group of faces: edges between two faces of the group and seams (used twice by one face) go,
    /// so do edges without length; what is left is chained again.
    pub fn loops(&mut self, group: &[FaceId]) -> Vec<Boundary> {
        let (model, shapes, shortest) = (self.model, self.shapes, self.shortest);
        let Room { uses, edges, starts, used, .. } = &mut self.room;
        uses.clear();
        for face_loop in group.iter().flat_map(|face| &model.faces[face.index()].loops) {
            uses.extend(face_loop.uses.iter().map(|&u| (u, face_loop.outer)));
        }
        edges.clear();
        edges.extend(uses.iter().map(|(u, _)| u.edge));
        edges.sort_unstable();
        let once = |edge: EdgeId| edges.get(edges.partition_point(|e| *e < edge) + 1) != Some(&edge);
        uses.retain(|(u, _)| once(u.edge) && shapes.length(u.edge) > shortest);
        starts.clear();
        starts.extend(uses.iter().enumerate().map(|(i, (edge_use, _))| (ends(model, edge_use).0, i)));
        starts.sort_unstable();
        used.clear();
        used.resize(uses.len(), false);
        let mut loops = Vec::with_capacity(1);
        for first in 0..used.len() {
            if self.chain(first) {
                loops.push(self.boundary());
            }
        }
        loops
    }

    /// Chains uses head to tail; false where the first one is in a chain already. A chain that does not close (a broken
    /// file) is kept as it is.
    fn chain(&mut self, first: usize) -> bool {
        let Room { uses, starts, used, chain, .. } = &mut self.room;
        chain.clear();
        let mut next = (!used[first]).then_some(first);
        while let Some(i) = next {
            used[i] = true;
            chain.push(i);
            let end = ends(self.model, &uses[i].0).1;
            let leaving = &starts[starts.partition_point(|s| s.0 < end)..];
            next = leaving.iter().take_while(|s| s.0 == end).map(|s| s.1).find(|&j| !used[j]);
        }
        !chain.is_empty()
    }

    /// The loop that the chain makes.
    fn boundary(&self) -> Boundary {
        let chain = || self.room.chain.iter().map(|&i| self.room.uses[i]);
        let count = chain().map(|(u, _)| self.shapes.count(u.edge)).sum();
        let mut result = Boundary { points: Vec::with_capacity(count), ..Boundary::default() };
        let Some((last, _)) = chain().next_back() else { return result };
        let mut incoming = self.shapes.leaving(&last);
        for (edge_use, outer) in chain() {
            let first = result.points.len();
            self.shapes.add_points(&edge_use, &mut result.points);
            if turn(&incoming, &self.shapes.entering(&edge_use)) > self.corner_angle {
                result.corners.extend(result.points.get(first));
            }
            incoming = self.shapes.leaving(&edge_use);
            result.length += self.shapes.length(edge_use.edge);
            result.outer |= outer;
        }
        result
    }
}

/// The two ends of an edge use, in the direction of the loop.
fn ends(model: &Model, edge_use: &EdgeUse) -> (VertexId, VertexId) {
    let edge = &model.edges[edge_use.edge.index()];
    if edge_use.forward { (edge.start, edge.end) } else { (edge.end, edge.start) }
}

/// Angle between two directions, radians; a cusp turns by pi. Unknown directions (zero) count as a corner.
fn turn(a: &Vector, b: &Vector) -> f64 {
    if *a == Vector::zeros() || *b == Vector::zeros() {
        return std::f64::consts::PI;
    }
    a.cross(b).norm().atan2(a.dot(b))
}

/// The outline of a group from its loops.
pub(super) fn outline(
    model: &Model,
    group: Vec<FaceId>,
    mut loops: Vec<Boundary>,
    axis: Option<Axis>,
    oriented: bool,
) -> LocalOutline {
    let vector_area = loops.iter().map(Boundary::vector_area).sum();
    let outer = outer_loop(model, &group, &loops).map(|i| loops.swap_remove(i)).unwrap_or_default();
    let inner = loops.iter().map(|l| InnerLoop { centroid: l.centroid(), length: l.length }).collect();
    LocalOutline { corners: outer.corners, perimeter: outer.length, faces: group, inner, vector_area, axis, oriented }
}

/// Position of the outer loop: the one the file names where it names one, else the one that encloses most.
fn outer_loop(model: &Model, group: &[FaceId], loops: &[Boundary]) -> Option<usize> {
    let mut named = (0..loops.len()).filter(|&i| loops[i].outer);
    if let (Some(only), None) = (named.next(), named.next()) {
        return Some(only);
    }
    let plane = group.iter().all(|f| is_plane(model, *f));
    let extent = |l: &Boundary| if plane { l.vector_area().norm() } else { l.length };
    (0..loops.len()).max_by(|&i, &j| extent(&loops[i]).total_cmp(&extent(&loops[j])).then(j.cmp(&i)))
}

fn is_plane(model: &Model, face: FaceId) -> bool {
    let FaceGeometry::Trimmed { surface, .. } = &model.faces[face.index()].geometry else { return false };
    matches!(**surface, Surface::Plane(_))
}
