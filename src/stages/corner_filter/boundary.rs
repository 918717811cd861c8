//! The loops of a maximal face, without seams and poles, and their corners.

use super::edges::EdgeShapes;
use super::{InnerLoop, LocalOutline, LocalOutlines};
use crate::brep::{EdgeUse, FaceId, Model, Surface, VertexId};
use crate::geometry::{Axis, Point, Vector};
use crate::memory::{empty, held};

/// A closed chain of edges around a maximal face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Boundary<'a> {
    pub corners: &'a [Point],
    /// Points along the loop, close enough together for areas and centroids.
    pub points: &'a [Point],
    pub length: f64,
}

impl Boundary<'_> {
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

/// The loops around a group of faces.
#[derive(Default)]
pub(super) struct Loops {
    loops: Vec<OneLoop>,
    corners: Vec<Point>,
    points: Vec<Point>,
}

/// A loop whose corners and points end here, and begin where those of the one before end.
struct OneLoop {
    corners: usize,
    points: usize,
    length: f64,
    /// Whether a piece of it belongs to a loop that the file calls the outer one.
    outer: bool,
}

impl Loops {
    /// Bytes of memory that they hold.
    pub fn bytes(&self) -> usize {
        held(&self.loops) + held(&self.corners) + held(&self.points)
    }

    fn clear(&mut self) {
        self.loops.clear();
        self.corners.clear();
        self.points.clear();
    }

    fn get(&self, i: usize) -> Boundary<'_> {
        let (corners, points) = i.checked_sub(1).map_or((0, 0), |i| (self.loops[i].corners, self.loops[i].points));
        let this = &self.loops[i];
        let (corners, points) = (&self.corners[corners..this.corners], &self.points[points..this.points]);
        Boundary { corners, points, length: this.length }
    }

    /// The loops in the order in which they were found.
    pub fn iter(&self) -> impl Iterator<Item = Boundary<'_>> {
        (0..self.loops.len()).map(|i| self.get(i))
    }
}

/// Finds the loops of one group of faces after the other, in the same memory.
pub(super) struct Tracer<'a> {
    model: &'a Model,
    pub shapes: &'a mut EdgeShapes,
    /// An edge shorter than this is a pole, mm.
    pub shortest: f64,
    /// Radians.
    corner_angle: f64,
    pub loops: &'a mut Loops,
    room: &'a mut Room,
}

/// What is filled anew for each group.
#[derive(Default)]
pub(super) struct Room {
    /// Uses of edges, and whether their loop is called the outer one.
    uses: Vec<(EdgeUse, bool)>,
    /// How often the group uses each edge of the model; all zero between two groups.
    counts: Vec<u32>,
    /// Where uses start, and their positions.
    starts: Vec<(VertexId, usize)>,
    used: Vec<bool>,
    /// Positions of uses that follow each other.
    chain: Vec<usize>,
}

impl Room {
    /// Bytes of memory that it holds.
    pub fn bytes(&self) -> usize {
        held(&self.uses) + held(&self.counts) + held(&self.starts) + held(&self.used) + held(&self.chain)
    }
}

impl<'a> Tracer<'a> {
    pub fn new(
        model: &'a Model,
        corner_angle: f64,
        shapes: &'a mut EdgeShapes,
        loops: &'a mut Loops,
        room: &'a mut Room,
    ) -> Self {
        shapes.clear(model);
        empty(&mut room.counts, model.edges.len());
        room.counts.resize(model.edges.len(), 0);
        Self { model, shapes, shortest: 0.0, corner_angle, loops, room }
    }

    /// Finds the loops around a group of faces: edges between two faces of the group and seams (used twice by one face)
    /// go, so do edges without length; what is left is chained again.
    pub fn trace(&mut self, group: &[FaceId]) {
        let (model, shapes, shortest) = (self.model, &*self.shapes, self.shortest);
        let Room { uses, counts, starts, used, .. } = &mut *self.room;
        let loops = || group.iter().flat_map(|face| &model.faces[face.index()].loops);
        let edges = || loops().flat_map(|l| &l.uses).map(|u| u.edge);
        edges().for_each(|edge| counts[edge.index()] += 1);
        uses.clear();
        for face_loop in loops() {
            let kept = |u: &&EdgeUse| counts[u.edge.index()] == 1 && shapes.length(u.edge) > shortest;
            uses.extend(face_loop.uses.iter().filter(kept).map(|&u| (u, face_loop.outer)));
        }
        edges().for_each(|edge| counts[edge.index()] = 0);
        starts.clear();
        starts.extend(uses.iter().enumerate().map(|(i, (edge_use, _))| (ends(model, edge_use).0, i)));
        starts.sort_unstable();
        used.clear();
        used.resize(uses.len(), false);
        self.loops.clear();
        for first in 0..self.room.uses.len() {
            if self.chain(first) {
                self.add_loop();
            }
        }
    }

    /// Chains uses head to tail; false where the first one is in a chain already. A chain that does not close (a broken
    /// file) is kept as it is.
    fn chain(&mut self, first: usize) -> bool {
        let Room { uses, starts, used, chain, .. } = &mut *self.room;
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

    /// Adds the loop that the chain makes.
    fn add_loop(&mut self) {
        let chain = || self.room.chain.iter().map(|&i| self.room.uses[i]);
        let Loops { loops, corners, points } = &mut *self.loops;
        let Some((last, _)) = chain().next_back() else { return };
        let (mut incoming, mut length, mut outer) = (self.shapes.leaving(&last), 0.0, false);
        for (edge_use, is_outer) in chain() {
            let first = points.len();
            self.shapes.add_points(&edge_use, points);
            if turn(&incoming, &self.shapes.entering(&edge_use)) > self.corner_angle {
                corners.extend(points.get(first));
            }
            incoming = self.shapes.leaving(&edge_use);
            length += self.shapes.length(edge_use.edge);
            outer |= is_outer;
        }
        loops.push(OneLoop { corners: corners.len(), points: points.len(), length, outer });
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

/// Adds the outline of a group from its loops.
pub(super) fn add_outline(
    out: &mut LocalOutlines,
    model: &Model,
    group: &[FaceId],
    loops: &Loops,
    axis: Option<Axis>,
    oriented: bool,
) {
    let vector_area = loops.iter().map(|l| l.vector_area()).sum();
    let outer = outer_loop(model, group, loops);
    let mut perimeter = 0.0;
    if let Some(outer) = outer {
        let last = loops.loops.len() - 1;
        // The last one takes the place of the outer one.
        let inner = (0..last).map(|i| loops.get(if i == outer { last } else { i }));
        out.inner.extend(inner.map(|l| InnerLoop { centroid: l.centroid(), length: l.length }));
        out.corners.extend_from_slice(loops.get(outer).corners);
        perimeter = loops.get(outer).length;
    }
    out.faces.extend_from_slice(group);
    let ends = [out.faces.len(), out.corners.len(), out.inner.len()];
    out.outlines.push(LocalOutline { ends, perimeter, vector_area, axis, oriented });
}

/// Position of the outer loop: the one the file names where it names one, else the one that encloses most.
fn outer_loop(model: &Model, group: &[FaceId], loops: &Loops) -> Option<usize> {
    let count = loops.loops.len();
    let mut named = (0..count).filter(|&i| loops.loops[i].outer);
    if let (Some(only), None) = (named.next(), named.next()) {
        return Some(only);
    }
    let plane = group.iter().all(|f| is_plane(model, *f));
    let extent = |i: usize| if plane { loops.get(i).vector_area().norm() } else { loops.loops[i].length };
    (0..count).max_by(|&i, &j| extent(i).total_cmp(&extent(j)).then(j.cmp(&i)))
}

fn is_plane(model: &Model, face: FaceId) -> bool {
    matches!(model.surface_of(&model.faces[face.index()]), Some((Surface::Plane(_), _)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Transform;
    use crate::stages::fixture::{cuboid, solid};

    impl Loops {
        /// Adds a square from (corner, corner, 0) on: the outer loop or, the other way round, a hole.
        fn push_square(&mut self, corner: f64, side: f64, outer: bool) {
            let mut square = [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]]
                .map(|[x, y]| Point::new(corner + x, corner + y, 0.0));
            if !outer {
                square.reverse();
            }
            self.corners.extend(square);
            self.points.extend(square);
            let (corners, points) = (self.corners.len(), self.points.len());
            self.loops.push(OneLoop { corners, points, length: 4.0 * side, outer });
        }
    }

    #[test]
    fn the_outer_loop_comes_first_and_both_holes_are_kept() {
        let model = solid(&cuboid(1.0, 1.0, 1.0), &Transform::identity()).model;
        let mut loops = Loops::default();
        loops.push_square(0.0, 10.0, true);
        loops.push_square(1.5, 1.0, false);
        loops.push_square(6.0, 2.0, false);
        let mut found = LocalOutlines::default();
        add_outline(&mut found, &model, &[FaceId(0)], &loops, None, true);
        let hole = |middle: f64, length| InnerLoop { centroid: Point::new(middle, middle, 0.0), length };
        assert_eq!(found.inner, [hole(7.0, 8.0), hole(2.0, 4.0)]);
        assert_eq!(found.corners, loops.get(0).corners);
        assert_eq!(found.outlines[0].perimeter, 40.0);
        assert_eq!(found.outlines[0].vector_area, Vector::z() * 95.0);
    }
}
