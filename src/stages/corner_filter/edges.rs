//! The edges of a body as polylines with the exact tangents at their ends.

use rustc_hash::FxHashMap;

use crate::brep::{Curve, Edge, EdgeId, EdgeUse, FaceId, Model};
use crate::geometry::{Point, Vector};

/// Pieces a curved edge is cut into: enough to tell areas and centroids of loops apart.
const PIECES: usize = 16;

/// An edge from its start to its end.
#[derive(Clone, Debug)]
struct EdgeShape {
    /// Both ends included.
    points: Vec<Point>,
    /// Directions of travel at the start and at the end; zero where unknown.
    tangents: [Vector; 2],
    /// Arc length, mm.
    length: f64,
}

/// The shapes of all edges of some faces.
#[derive(Clone, Debug, Default)]
pub(super) struct EdgeShapes {
    shapes: FxHashMap<EdgeId, EdgeShape>,
    /// An edge shorter than this is a pole, mm.
    shortest: f64,
}

impl EdgeShapes {
    /// Evaluates the edges of `faces`; those shorter than `shortest` (mm) count as poles.
    pub fn of(model: &Model, faces: &[FaceId], shortest: f64) -> Self {
        let mut shapes = FxHashMap::default();
        for face in faces {
            for edge_use in model.faces[face.index()].loops.iter().flat_map(|l| &l.uses) {
                let edge = &model.edges[edge_use.edge.index()];
                shapes.entry(edge_use.edge).or_insert_with(|| EdgeShape::of(model, edge));
            }
        }
        Self { shapes, shortest }
    }

    /// Whether the edge has no length.
    pub fn is_degenerate(&self, edge: EdgeId) -> bool {
        let length = self.shapes[&edge].length;
        length.is_nan() || length <= self.shortest
    }

    /// Arc length of an edge, mm.
    pub fn length(&self, edge: EdgeId) -> f64 {
        self.shapes[&edge].length
    }

    /// Adds the points along the use, without the last one.
    pub fn add_points(&self, edge_use: &EdgeUse, out: &mut Vec<Point>) {
        let points = &self.shapes[&edge_use.edge].points;
        let last = points.len() - 1;
        if edge_use.forward { out.extend_from_slice(&points[..last]) } else { out.extend(points[1..].iter().rev()) }
    }

    /// Direction of travel at the beginning of the use.
    pub fn entering(&self, edge_use: &EdgeUse) -> Vector {
        let [start, end] = self.shapes[&edge_use.edge].tangents;
        if edge_use.forward { start } else { -end }
    }

    /// Direction of travel at the end of the use.
    pub fn leaving(&self, edge_use: &EdgeUse) -> Vector {
        let [start, end] = self.shapes[&edge_use.edge].tangents;
        if edge_use.forward { end } else { -start }
    }
}

impl EdgeShape {
    fn of(model: &Model, edge: &Edge) -> Self {
        let ends = [edge.start, edge.end].map(|v| model.vertices[v.index()].point);
        let Some(curve) = edge.curve.as_deref() else { return Self::straight(ends) };
        if let Curve::Line { .. } = curve {
            return Self::straight(ends);
        }
        let [first, last] = range(curve, edge, &ends);
        let at = |i: usize| first + (last - first) * i as f64 / (2 * PIECES) as f64;
        let jets: Vec<_> = (0..=2 * PIECES).map(|i| curve.derivatives(at(i))).collect();
        let mut points: Vec<_> = jets.iter().step_by(2).map(|j| Point::from(j[0])).collect();
        (points[0], points[PIECES]) = (ends[0], ends[1]);
        let speed = |i: usize| jets[i][1].norm();
        let panels = (0..PIECES).map(|i| speed(2 * i) + 4.0 * speed(2 * i + 1) + speed(2 * i + 2));
        let length = panels.sum::<f64>() * (last - first).abs() / (6 * PIECES) as f64;
        let sense = (last - first).signum();
        let tangents = [
            direction(&jets[0], sense, 1.0, points[1] - points[0]),
            direction(&jets[2 * PIECES], sense, -1.0, points[PIECES] - points[PIECES - 1]),
        ];
        Self { points, tangents, length }
    }

    fn straight([start, end]: [Point; 2]) -> Self {
        let along = end - start;
        let tangent = along.try_normalize(0.0).unwrap_or_else(Vector::zeros);
        Self { points: vec![start, end], tangents: [tangent; 2], length: along.norm() }
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
