//! The edges of a body as polylines with the exact tangents at their ends.

use std::ops::Range;

use crate::brep::{Curve, Edge, EdgeId, EdgeUse, FaceId, Model};
use crate::geometry::{Point, Vector};
use crate::memory::{empty, held};

/// Pieces a curved edge is cut into: enough to tell areas and centroids of loops apart.
const PIECES: usize = 16;
/// The place of an edge that no face has asked for.
const NOWHERE: u32 = u32::MAX;

/// An edge from its start to its end.
#[derive(Clone, Debug)]
struct EdgeShape {
    /// Where its points are, both ends included.
    points: Range<usize>,
    /// Directions of travel at the start and at the end; zero where unknown.
    tangents: [Vector; 2],
    /// Arc length, mm.
    length: f64,
}

/// The shapes of the edges of some faces.
#[derive(Default)]
pub(super) struct EdgeShapes {
    /// For each edge of the model its place among the shapes.
    places: Vec<u32>,
    shapes: Vec<EdgeShape>,
    points: Vec<Point>,
}

impl EdgeShapes {
    /// No shapes of a model yet.
    pub fn clear(&mut self, model: &Model) {
        let count = model.edges.len();
        empty(&mut self.places, count);
        self.places.resize(count, NOWHERE);
        empty(&mut self.shapes, count);
        // Most edges are straight.
        empty(&mut self.points, 2 * count);
    }

    /// Bytes of memory that they hold.
    pub fn bytes(&self) -> usize {
        held(&self.places) + held(&self.shapes) + held(&self.points)
    }

    /// Evaluates the edges of `faces`.
    pub fn add(&mut self, model: &Model, faces: &[FaceId]) {
        let loops = faces.iter().flat_map(|face| &model.faces[face.index()].loops);
        for edge_use in loops.flat_map(|l| &l.uses) {
            let place = &mut self.places[edge_use.edge.index()];
            if *place == NOWHERE {
                *place = self.shapes.len() as u32;
                let edge = &model.edges[edge_use.edge.index()];
                self.shapes.push(EdgeShape::of(model, edge, &mut self.points));
            }
        }
    }

    fn shape(&self, edge: EdgeId) -> &EdgeShape {
        &self.shapes[self.places[edge.index()] as usize]
    }

    /// Arc length of an edge, mm.
    pub fn length(&self, edge: EdgeId) -> f64 {
        self.shape(edge).length
    }

    /// Adds the points along the use, without the last one.
    pub fn add_points(&self, edge_use: &EdgeUse, out: &mut Vec<Point>) {
        let points = &self.points[self.shape(edge_use.edge).points.clone()];
        let last = points.len() - 1;
        if edge_use.forward { out.extend_from_slice(&points[..last]) } else { out.extend(points[1..].iter().rev()) }
    }

    /// Direction of travel at the beginning of the use.
    pub fn entering(&self, edge_use: &EdgeUse) -> Vector {
        let [start, end] = self.shape(edge_use.edge).tangents;
        if edge_use.forward { start } else { -end }
    }

    /// Direction of travel at the end of the use.
    pub fn leaving(&self, edge_use: &EdgeUse) -> Vector {
        let [start, end] = self.shape(edge_use.edge).tangents;
        if edge_use.forward { end } else { -start }
    }
}

impl EdgeShape {
    /// Evaluates an edge and adds its points.
    fn of(model: &Model, edge: &Edge, points: &mut Vec<Point>) -> Self {
        let ends = [edge.start, edge.end].map(|v| model.vertices[v.index()].point);
        match edge.curve.as_deref() {
            None | Some(Curve::Line { .. }) => Self::straight(ends, points),
            Some(curve) => Self::bent(curve, edge, ends, points),
        }
    }

    fn straight([start, end]: [Point; 2], points: &mut Vec<Point>) -> Self {
        let along = end - start;
        let tangent = along.try_normalize(0.0).unwrap_or_else(Vector::zeros);
        points.extend([start, end]);
        Self { points: points.len() - 2..points.len(), tangents: [tangent; 2], length: along.norm() }
    }

    fn bent(curve: &Curve, edge: &Edge, ends: [Point; 2], points: &mut Vec<Point>) -> Self {
        let [first, last] = range(curve, edge, &ends);
        let jet = |i: usize| curve.derivatives(first + (last - first) * i as f64 / (2 * PIECES) as f64);
        let tips = [jet(0), jet(2 * PIECES)];
        let from = points.len();
        points.push(ends[0]);
        // By Simpson's rule, for which each piece is halved; a circle has one speed.
        let mut speeds = tips[0][1].norm() + tips[1][1].norm();
        let circle = matches!(curve, Curve::Circle { .. });
        for i in (1..2 * PIECES).filter(|i| !circle || i % 2 == 0) {
            let [p, d, _] = jet(i);
            speeds += d.norm() * if i % 2 == 0 { 2.0 } else { 4.0 };
            if i % 2 == 0 {
                points.push(Point::from(p));
            }
        }
        points.push(ends[1]);
        let mean = if circle { tips[0][1].norm() } else { speeds / (6 * PIECES) as f64 };
        let sense = (last - first).signum();
        let chords = [points[from + 1] - ends[0], ends[1] - points[points.len() - 2]];
        let tangents = [direction(&tips[0], sense, 1.0, chords[0]), direction(&tips[1], sense, -1.0, chords[1])];
        Self { points: from..points.len(), tangents, length: mean * (last - first).abs() }
    }
}

/// The curve parameters at the two ends, in the direction of travel.
fn range(curve: &Curve, edge: &Edge, ends: &[Point; 2]) -> [f64; 2] {
    let mut first = curve.project(&ends[0], None);
    let mut last = if edge.start == edge.end { first } else { curve.project(&ends[1], None) };
    if let Some(period) = curve.period() {
        // A closed edge goes round once.
        if edge.same_sense && last <= first {
            last += period;
        } else if !edge.same_sense && last >= first {
            first += period;
        }
    }
    [first, last]
}

/// Direction of travel from the first derivative that does not vanish; `inward` is 1 at the start of the edge and
/// -1 at its end, where the curve comes in against its second derivative.
fn direction(jet: &[Vector; 3], sense: f64, inward: f64, chord: Vector) -> Vector {
    let unit = |v: Vector| v.try_normalize(1e-9 * chord.norm());
    let first = unit(jet[1] * sense);
    first.or_else(|| unit(jet[2] * inward)).or_else(|| unit(chord)).unwrap_or_else(Vector::zeros)
}
