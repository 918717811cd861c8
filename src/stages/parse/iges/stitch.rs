//! Loose faces -> a shell with shared vertices and edges.
//!
//! Trimmed surfaces each have boundary curves of their own. Ends that lie together become one vertex, and curves with
//! the same ends that run along each other one edge, so that later stages see which faces are neighbours.

use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::curves::Piece;
use super::trimmed::{RawFace, RawLoop};
use crate::brep::{Edge, EdgeId, EdgeUse, Face, FaceGeometry, FaceId, FaceLoop, Model, Uses, Vertex, VertexId};
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::{Aabb, Point};
use crate::stages::parse::cut;

/// Points nearer than this share of the size of all faces are one; ten digits leave less than that.
const TOGETHER: f64 = 1e-6;
/// The resolution that the file itself states counts up to this share.
const MOST_TOGETHER: f64 = 1e-5;
/// Curves are compared at these shares of their parameter ranges.
const COMPARED: [f64; 2] = [0.5, 0.21];
/// Edges between the same two vertices that a new one is compared with at most.
const MOST_COMPARED: usize = 64;

/// Joins faces into the model; `resolution` is what the file calls the smallest distance, mm.
pub(super) struct Stitcher<'a> {
    model: &'a mut Model,
    tolerance: f64,
    cells: FxHashMap<[i64; 3], Vec<VertexId>>,
    between: FxHashMap<[VertexId; 2], Vec<EdgeId>>,
}

impl<'a> Stitcher<'a> {
    pub fn new(model: &'a mut Model, faces: &[RawFace], resolution: f64) -> Self {
        let ends = faces
            .iter()
            .flat_map(|f| &f.loops)
            .flat_map(|l| &l.pieces)
            .flat_map(|p| [0.0, 0.5, 1.0].map(|s| p.along(s)));
        let mut aabb = Aabb::default();
        ends.for_each(|p| aabb.add(&p));
        let size = Some(aabb.diagonal()).filter(|size| size.is_finite()).unwrap_or_default();
        let tolerance = resolution.clamp(TOGETHER * size, MOST_TOGETHER * size).max(f64::MIN_POSITIVE);
        Self { model, tolerance, cells: FxHashMap::default(), between: FxHashMap::default() }
    }

    /// Adds the faces to a shell; gives their ids.
    ///
    /// # Errors
    /// Only when cancelled.
    pub fn add(&mut self, faces: Vec<RawFace>, shell: u32, cancel: &Cancel) -> Result<Vec<FaceId>, Cancelled> {
        let mut ids = Vec::with_capacity(faces.len());
        for RawFace { entity, surface, same_sense, loops } in faces {
            cancel.check()?;
            let loops = loops.into_iter().filter_map(|raw| self.face_loop(raw)).collect();
            let geometry = FaceGeometry::Trimmed { surface: self.model.add_surface(surface), same_sense };
            ids.push(FaceId(self.model.faces.len() as u32));
            self.model.faces.push(Face { entity, geometry, loops, shell });
        }
        Ok(ids)
    }

    /// A loop of the pieces in their order, whatever the gaps between them; `None` where they have no length.
    fn face_loop(&mut self, raw: RawLoop) -> Option<FaceLoop> {
        let RawLoop { entity, pieces, reversed } = raw;
        let senses = senses(&pieces, self.tolerance);
        let mut uses = Uses::with_capacity(pieces.len());
        for (piece, forward) in pieces.into_iter().zip(senses) {
            uses.extend(self.edge(piece).map(|used| EdgeUse { forward: used.forward == forward, ..used }));
        }
        if reversed {
            uses.reverse();
            uses.iter_mut().for_each(|used| used.forward = !used.forward);
        }
        if uses.is_empty() {
            return None;
        }
        Some(FaceLoop { entity, uses, pole: None, outer: false })
    }

    /// The edge of a piece, and whether the piece runs along it; `None` where it has no length.
    fn edge(&mut self, piece: Piece) -> Option<EdgeUse> {
        let [a, b] = piece.ends();
        let middles = COMPARED.map(|share| piece.along(share));
        let tolerance = self.tolerance;
        let together = |p: &Point, q: &Point| (p - q).norm() <= 2.0 * tolerance;
        let (start, end) = (self.vertex(a, piece.entity), self.vertex(b, piece.entity));
        if start == end && middles.iter().all(|m| together(m, &a)) {
            return None;
        }
        let key = if start <= end { [start, end] } else { [end, start] };
        let known = self.between.get(&key).map(Vec::as_slice).unwrap_or_default();
        for &id in known.iter().take(MOST_COMPARED) {
            if let Some(forward) = runs_along(self.model, id, &piece, [start, end], tolerance) {
                return Some(EdgeUse { edge: id, forward });
            }
        }
        let Piece { entity, curve, range } = piece;
        let curve =
            if cut::needs_none(&curve, range, start == end) { curve } else { Piece { entity, curve, range }.bounded() };
        let id = EdgeId(self.model.edges.len() as u32);
        self.model.edges.push(Edge { entity, curve: Some(Arc::new(curve)), start, end, same_sense: true });
        self.between.entry(key).or_default().push(id);
        Some(EdgeUse { edge: id, forward: true })
    }

    /// The vertex at a point.
    fn vertex(&mut self, point: Point, entity: u64) -> VertexId {
        let cell = |p: f64| (p / (2.0 * self.tolerance)).floor() as i64;
        let home = [cell(point.x), cell(point.y), cell(point.z)];
        for step in 0..27 {
            let at = [0, 1, 2].map(|axis| home[axis].saturating_add(step / [1, 3, 9][axis] % 3 - 1));
            let near = |id: &&VertexId| (self.model.vertices[id.index()].point - point).norm() <= self.tolerance;
            if let Some(known) = self.cells.get(&at).and_then(|ids| ids.iter().find(near)) {
                return *known;
            }
        }
        let id = VertexId(self.model.vertices.len() as u32);
        self.model.vertices.push(Vertex { entity, point });
        self.cells.entry(home).or_default().push(id);
        id
    }
}

/// Whether each piece runs forwards along the loop: from where the one before ends. Closed pieces run as they are
/// given, so the other way round must be nearer by more than the tolerance.
fn senses(pieces: &[Piece], tolerance: f64) -> Vec<bool> {
    let ends: Vec<[Point; 2]> = pieces.iter().map(Piece::ends).collect();
    let near = |p: &Point, of: &[Point; 2]| (p - of[0]).norm().min((p - of[1]).norm());
    let mut senses = Vec::with_capacity(pieces.len());
    for (i, [start, end]) in ends.iter().enumerate() {
        let [ahead, back] = match (i, ends.get(1)) {
            (0, None) => [0.0, 0.0],
            (0, Some(next)) => [near(end, next), near(start, next)],
            _ => {
                let last = ends[i - 1][usize::from(senses[i - 1])];
                [(start - last).norm(), (end - last).norm()]
            }
        };
        senses.push(ahead <= back + tolerance);
    }
    senses
}

/// Whether a piece runs forwards or backwards along an edge with the same ends; `None`: somewhere else.
fn runs_along(model: &Model, id: EdgeId, piece: &Piece, ends: [VertexId; 2], tolerance: f64) -> Option<bool> {
    let edge = &model.edges[id.index()];
    let curve = edge.curve.as_deref()?;
    let [from, to] = model.edge_span(id)?;
    let period = curve.period();
    let at = |t: f64| curve.point(curve.wrap(t, period));
    let reach = 4.0 * tolerance;
    let mut shares = [0.0; 2];
    for (share, place) in shares.iter_mut().zip(COMPARED) {
        let p = piece.along(place);
        let t = period.map_or(curve.project(&p, None), |period| {
            let low = from.min(to);
            low + (curve.project(&p, None) - low).rem_euclid(period)
        });
        if (at(t) - p).norm() > reach {
            return None;
        }
        *share = (t - from) / (to - from);
    }
    // Half way and at about a fifth: the order tells the direction of closed edges.
    if shares.iter().any(|s| !(-1e-6..=1.0 + 1e-6).contains(s)) {
        return None;
    }
    Some(if ends[0] == ends[1] { shares[1] < shares[0] } else { edge.start == ends[0] })
}

#[cfg(test)]
mod tests {
    use super::super::curves::level;
    use super::*;
    use crate::brep::{Curve, Surface};
    use crate::geometry::Vector;

    fn line(a: [f64; 3], b: [f64; 3]) -> Piece {
        let (a, b) = (Point::from(a), Point::from(b));
        Piece { entity: 1, curve: Curve::Line { origin: a, direction: b - a }, range: [0.0, 1.0] }
    }

    fn face(pieces: Vec<Piece>) -> RawFace {
        let surface = Surface::Plane(level(0.0, 0.0, 0.0));
        RawFace { entity: 1, surface, same_sense: true, loops: vec![RawLoop { entity: 3, pieces, reversed: false }] }
    }

    #[test]
    fn neighbours_share_an_edge_within_the_tolerance() {
        let [a, b, c, d] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let off = [1.0, 1.0 + 1e-8, 0.0];
        // The second face lists its curves in turning directions.
        let faces =
            vec![face(vec![line(a, b), line(b, c), line(c, a)]), face(vec![line(a, off), line(d, off), line(d, a)])];
        let mut model = Model::empty();
        let mut stitcher = Stitcher::new(&mut model, &faces, 0.0);
        stitcher.add(faces, 0, &Cancel::new()).unwrap();
        assert_eq!((model.vertices.len(), model.edges.len()), (4, 5));
        let uses = &model.faces[1].loops[0].uses;
        assert_eq!(uses.iter().map(|u| u.forward).collect::<Vec<_>>(), [false, false, true]);
    }

    #[test]
    fn a_circle_meets_itself_run_backwards() {
        let circle = |from: f64, turn: f64| {
            let placement = level(0.0, 0.0, 0.0);
            let turned = crate::brep::Placement { y: placement.y * turn, z: placement.z * turn, ..placement };
            let curve = Curve::Circle { placement: turned, radius: 2.0 };
            Piece { entity: 1, curve, range: [from, from + std::f64::consts::TAU] }
        };
        let faces = vec![face(vec![circle(0.0, 1.0)]), face(vec![circle(0.0, -1.0)])];
        let mut model = Model::empty();
        Stitcher::new(&mut model, &faces, 0.0).add(faces, 0, &Cancel::new()).unwrap();
        assert_eq!(model.edges.len(), 1);
        assert!(model.faces[0].loops[0].uses[0].forward && !model.faces[1].loops[0].uses[0].forward);
        assert_eq!(model.vertices[0].point - Point::origin(), Vector::new(2.0, 0.0, 0.0));
    }
}
