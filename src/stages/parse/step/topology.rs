//! Edges, loops and faces: topological entities -> the arenas of a [`Model`].

use std::sync::Arc;

use rustc_hash::FxHashMap;
use smallvec::smallvec;

use super::keyword::Kind;
use super::known::{Known, Made};
use super::placement::{Geometry, orthonormal};
use super::records::Record;
use super::units::Units;
use crate::brep::{
    Curve, Edge, EdgeId, EdgeUse, Face, FaceGeometry, FaceLoop, Loops, Model, Surface, SurfaceId, Uses, Vertex,
    VertexId,
};
use crate::geometry::{Point, Vector};
use crate::stages::parse::fault::{Fault, Read};
use crate::stages::parse::notes::Notes;

/// How deep oriented edges and faces may refer to others.
const DEEPEST_ORIENTED: u32 = 8;

/// The ends of a closed curve are nearer than this share of the distance to its middle.
const CLOSED: f64 = 1e-3;

const EDGE: &[Kind] = &[Kind::RepresentationItem, Kind::Edge, Kind::EdgeCurve, Kind::Subedge];
const FACE: &[Kind] = &[Kind::RepresentationItem, Kind::Face, Kind::FaceSurface];
const BOUND: &[Kind] = &[Kind::RepresentationItem, Kind::FaceBound];

/// Builds a model; what several faces share is made once.
pub(super) struct Builder<'a> {
    pub geometry: Geometry<'a>,
    pub model: Model,
    pub notes: Notes,
    pub(super) known: Known,
    /// Straight edges of poly loops, by the entities of their ends, the smaller first.
    straight_edges: FxHashMap<[u64; 2], EdgeId>,
    /// Lists of coordinates that triangles share.
    pub(super) coordinates: FxHashMap<u64, Arc<[Point]>>,
}

/// A face that is not yet in a shell.
pub(super) struct LooseFace {
    pub entity: u64,
    pub geometry: FaceGeometry,
    pub loops: Loops,
}

impl<'a> Builder<'a> {
    pub fn new(geometry: Geometry<'a>, known: Known) -> Self {
        Self {
            known,
            geometry,
            model: Model::empty(),
            notes: Notes::default(),
            straight_edges: FxHashMap::default(),
            coordinates: FxHashMap::default(),
        }
    }

    /// Reads from now on in these units; what was read in other units is not shared.
    pub fn use_units(&mut self, units: Units) {
        if units != self.geometry.units {
            self.known.clear();
            self.straight_edges.clear();
            self.coordinates.clear();
            self.geometry.units = units;
        }
    }

    fn made(&self, id: u64) -> Option<Made> {
        self.known.get(self.geometry.file.place(id))
    }

    fn note(&mut self, id: u64, made: Made) {
        self.known.set(self.geometry.file.place(id), made);
    }

    pub(super) fn record(&self, id: u64) -> Read<Record<'a>> {
        self.geometry.file.record(id)
    }

    /// Any face with its loops.
    pub fn face(&mut self, id: u64, depth: u32) -> Read<LooseFace> {
        let record = self.record(id)?;
        if record.is(Kind::OrientedFace) {
            return self.oriented_face(&record, depth);
        }
        let on_surface = record.is(Kind::AdvancedFace) || record.is(Kind::FaceSurface);
        if !on_surface && !record.is(Kind::Subface) && !record.is(Kind::Face) {
            return Err(record.fault("a face was expected"));
        }
        self.geometry.spend(id, 1)?;
        let mut cursor = record.fields(FACE);
        let bounds = cursor.skip_many(1).references()?;
        if record.is(Kind::Subface) {
            let parent = self.parent_face(cursor.reference()?, depth)?;
            return Ok(LooseFace { entity: id, loops: self.bounds(id, &bounds)?, geometry: parent.geometry });
        }
        let geometry = if on_surface {
            let surface = self.surface(cursor.reference()?)?;
            FaceGeometry::Trimmed { surface, same_sense: cursor.flag().unwrap_or(true) }
        } else {
            self.plane_of(&record, &bounds)?
        };
        Ok(LooseFace { entity: id, loops: self.bounds(id, &bounds)?, geometry })
    }

    fn parent_face(&mut self, id: u64, depth: u32) -> Read<LooseFace> {
        if depth > DEEPEST_ORIENTED {
            return Err(Fault::new(id, "faces nested too deep"));
        }
        self.face(id, depth + 1)
    }

    /// ORIENTED_FACE: the face it names, turned over where its orientation says so.
    fn oriented_face(&mut self, record: &Record, depth: u32) -> Read<LooseFace> {
        let mut cursor = record.fields(&[Kind::RepresentationItem, Kind::OrientedFace]);
        if record.kind != Kind::Complex {
            cursor.skip();
        }
        let element = cursor.skip_many(1).reference()?;
        let turned = cursor.flag() == Some(false);
        let mut face = self.parent_face(element, depth)?;
        if turned {
            face.turn_over();
        }
        Ok(face)
    }

    /// The plane of a face that names no surface: that of its first poly loop.
    fn plane_of(&mut self, record: &Record, bounds: &[u64]) -> Read<FaceGeometry> {
        let first = bounds.first().ok_or_else(|| record.fault("a face without surface and bounds"))?;
        let bound = self.bound(*first)?;
        let corners: Vec<Point> = bound.uses.iter().map(|u| self.start_of(*u)).collect();
        let origin = *corners.first().ok_or_else(|| record.fault("a face without surface"))?;
        let normal = corners.iter().zip(corners.iter().cycle().skip(1)).map(|(a, b)| (a - origin).cross(&(b - origin)));
        let normal: Vector = normal.sum();
        let length = normal.norm();
        if !(length > 0.0 && length.is_finite()) {
            return Err(record.fault("a face without area"));
        }
        let plane = Surface::Plane(orthonormal(origin, Some(normal / length), None));
        Ok(FaceGeometry::Trimmed { surface: self.model.add_surface(plane), same_sense: true })
    }

    fn start_of(&self, used: EdgeUse) -> Point {
        let edge = &self.model.edges[used.edge.index()];
        self.model.vertices[if used.forward { edge.start } else { edge.end }.index()].point
    }

    /// A bounded surface as a face without loops.
    pub(super) fn whole_surface(&mut self, id: u64) -> Read<LooseFace> {
        let geometry = FaceGeometry::Trimmed { surface: self.surface(id)?, same_sense: true };
        Ok(LooseFace { entity: id, geometry, loops: Loops::new() })
    }

    fn surface(&mut self, id: u64) -> Read<SurfaceId> {
        if let Some(Made::Surface(known)) = self.made(id) {
            return Ok(known);
        }
        let surface = self.geometry.surface(id)?;
        let made = self.model.add_surface(surface);
        self.note(id, Made::Surface(made));
        Ok(made)
    }

    fn bounds(&mut self, face: u64, ids: &[u64]) -> Read<Loops> {
        self.geometry.spend(face, ids.len())?;
        ids.iter().map(|id| self.bound(*id)).collect()
    }

    /// FACE_BOUND or FACE_OUTER_BOUND: a loop, run through backwards where the bound says so.
    fn bound(&mut self, id: u64) -> Read<FaceLoop> {
        let record = self.record(id)?;
        let outer = record.is(Kind::FaceOuterBound);
        if !outer && !record.is(Kind::FaceBound) {
            return Err(record.fault("a face bound was expected"));
        }
        let mut cursor = record.fields(BOUND);
        let inner = cursor.skip_many(1).reference()?;
        let mut face_loop = self.face_loop(inner)?;
        face_loop.outer = outer;
        if cursor.flag() == Some(false) {
            face_loop.turn_over();
        }
        Ok(face_loop)
    }

    fn face_loop(&mut self, id: u64) -> Read<FaceLoop> {
        let record = self.record(id)?;
        let mut face_loop = FaceLoop { entity: id, uses: Uses::new(), pole: None, outer: false };
        if record.is(Kind::VertexLoop) {
            let mut cursor = record.fields(&[Kind::RepresentationItem, Kind::VertexLoop]);
            face_loop.pole = Some(self.vertex(cursor.skip_many(1).reference()?)?);
        } else if record.is(Kind::PolyLoop) {
            let ids = record.fields(&[Kind::RepresentationItem, Kind::PolyLoop]).skip_many(1).references()?;
            self.geometry.spend(id, ids.len())?;
            face_loop.uses = self.poly_loop(&record, &ids)?;
        } else if record.is(Kind::EdgeLoop) {
            let ids = record.fields(&[Kind::RepresentationItem, Kind::EdgeLoop]).skip_many(1).references()?;
            self.geometry.spend(id, ids.len())?;
            face_loop.uses = ids.into_iter().map(|id| self.edge_use(id, 0)).collect::<Read<_>>()?;
            if face_loop.uses.is_empty() {
                return Err(record.fault("a loop without edges"));
            }
        } else {
            return Err(record.fault("a loop was expected"));
        }
        Ok(face_loop)
    }

    /// A closed curve as a loop of one edge that starts where the curve does.
    pub(super) fn curve_loop(&mut self, id: u64) -> Read<FaceLoop> {
        let curve = self.geometry.curve(id)?;
        let [start, end] = curve.domain();
        let (first, last, middle) = (curve.point(start), curve.point(end), curve.point(0.5 * (start + end)));
        // Not so for infinite curves either, whose ends are not numbers.
        let closed = (last - first).norm() <= CLOSED * (middle - first).norm();
        if !closed {
            return Err(Fault::new(id, "a boundary curve that is not closed"));
        }
        let vertex = self.push_vertex(id, first);
        let curve = Some(Arc::new(curve));
        let edge = self.push_edge(Edge { entity: id, curve, start: vertex, end: vertex, same_sense: true });
        let outer = self.record(id)?.is(Kind::OuterBoundaryCurve);
        Ok(FaceLoop { entity: id, uses: smallvec![EdgeUse { edge, forward: true }], pole: None, outer })
    }

    /// The straight edges between the points of a POLY_LOOP; each pair of points has one edge in all loops.
    fn poly_loop(&mut self, record: &Record, ids: &[u64]) -> Read<Uses> {
        let mut uses = Uses::with_capacity(ids.len());
        for (&from, &to) in ids.iter().zip(ids.iter().cycle().skip(1)) {
            if from != to {
                uses.push(self.straight_edge(record.id, from, to)?);
            }
        }
        if uses.len() < 3 { Err(record.fault("a poly loop of fewer than three points")) } else { Ok(uses) }
    }

    fn straight_edge(&mut self, entity: u64, from: u64, to: u64) -> Read<EdgeUse> {
        let ends = [from.min(to), from.max(to)];
        let edge = match self.straight_edges.get(&ends) {
            Some(&known) => known,
            None => {
                let [start, end] = [self.poly_vertex(ends[0])?, self.poly_vertex(ends[1])?];
                let made = self.push_edge(Edge { entity, curve: None, start, end, same_sense: true });
                self.straight_edges.insert(ends, made);
                made
            }
        };
        Ok(EdgeUse { edge, forward: from < to })
    }

    fn poly_vertex(&mut self, id: u64) -> Read<VertexId> {
        if let Some(Made::Vertex(known)) = self.made(id) {
            return Ok(known);
        }
        let point = self.geometry.point(id)?;
        Ok(self.push_vertex(id, point))
    }

    /// VERTEX_POINT.
    fn vertex(&mut self, id: u64) -> Read<VertexId> {
        if let Some(Made::Vertex(known)) = self.made(id) {
            return Ok(known);
        }
        let record = self.record(id)?;
        if !record.is(Kind::VertexPoint) {
            return Err(record.fault("a vertex was expected"));
        }
        let mut cursor = record.fields(&[Kind::RepresentationItem, Kind::VertexPoint]);
        let point = self.geometry.point(cursor.skip_many(1).reference()?)?;
        Ok(self.push_vertex(id, point))
    }

    fn push_vertex(&mut self, entity: u64, point: Point) -> VertexId {
        let id = VertexId(self.model.vertices.len() as u32);
        self.model.vertices.push(Vertex { entity, point });
        self.note(entity, Made::Vertex(id));
        id
    }

    fn push_edge(&mut self, edge: Edge) -> EdgeId {
        let id = EdgeId(self.model.edges.len() as u32);
        self.model.edges.push(edge);
        id
    }

    /// ORIENTED_EDGE, or an edge itself.
    fn edge_use(&mut self, id: u64, depth: u32) -> Read<EdgeUse> {
        let record = self.record(id)?;
        if !record.is(Kind::OrientedEdge) {
            return Ok(EdgeUse { edge: self.edge(&record, depth)?, forward: true });
        }
        if depth > DEEPEST_ORIENTED {
            return Err(record.fault("edges nested too deep"));
        }
        let mut cursor = record.fields(&[Kind::RepresentationItem, Kind::OrientedEdge]);
        if record.kind != Kind::Complex {
            cursor.skip_many(2);
        }
        let element = cursor.skip_many(1).reference()?;
        let forward = cursor.flag().unwrap_or(true);
        let inner = self.edge_use(element, depth + 1)?;
        Ok(EdgeUse { edge: inner.edge, forward: inner.forward == forward })
    }

    /// EDGE_CURVE, SUBEDGE or EDGE.
    fn edge(&mut self, record: &Record, depth: u32) -> Read<EdgeId> {
        if let Some(Made::Edge(known)) = self.made(record.id) {
            return Ok(known);
        }
        let is_curve = record.is(Kind::EdgeCurve);
        if !is_curve && !record.is(Kind::Subedge) && !record.is(Kind::Edge) {
            return Err(record.fault("an edge was expected"));
        }
        let mut cursor = record.fields(EDGE);
        let start = self.vertex(cursor.skip_many(1).reference()?)?;
        let end = self.vertex(cursor.reference()?)?;
        let geometry = cursor.optional_reference()?;
        // Half of the entities of many files are lines with their points and directions: none is looked at.
        let straight = is_curve && start != end && geometry.is_some_and(|curve| self.geometry.is_line(curve));
        let (curve, same_sense) = match geometry {
            _ if straight => (None, cursor.flag().unwrap_or(true)),
            Some(curve) if is_curve => (self.edge_curve(record, curve), cursor.flag().unwrap_or(true)),
            Some(parent) if record.is(Kind::Subedge) => self.parent_curve(parent, depth)?,
            _ => (None, true),
        };
        if curve.is_none() && start == end {
            return Err(record.fault("a closed edge without a curve"));
        }
        let shaped = curve.is_some();
        let made = self.push_edge(Edge { entity: record.id, curve, start, end, same_sense });
        if let Some(curve) = geometry.filter(|_| is_curve && shaped) {
            self.note(curve, Made::Curve(made));
        }
        self.note(record.id, Made::Edge(made));
        Ok(made)
    }

    /// The curve of an edge; where it cannot be read the edge becomes straight, with a warning.
    fn edge_curve(&mut self, record: &Record, id: u64) -> Option<Arc<Curve>> {
        if let Some(Made::Curve(edge)) = self.made(id) {
            return self.model.edges[edge.index()].curve.clone();
        }
        match self.geometry.curve(id) {
            Ok(curve) => Some(Arc::new(curve)),
            Err(fault) => {
                self.notes.warn(format!("edge #{} is taken as straight: #{}: {}", record.id, fault.entity, fault.why));
                None
            }
        }
    }

    fn parent_curve(&mut self, id: u64, depth: u32) -> Read<(Option<Arc<Curve>>, bool)> {
        if depth > DEEPEST_ORIENTED {
            return Err(Fault::new(id, "edges nested too deep"));
        }
        let parent = self.edge_use(id, depth + 1)?;
        let edge = &self.model.edges[parent.edge.index()];
        Ok((edge.curve.clone(), edge.same_sense == parent.forward))
    }
}

impl LooseFace {
    /// Turns the face normal round.
    pub fn turn_over(&mut self) {
        self.loops.iter_mut().for_each(TurnOver::turn_over);
        match &mut self.geometry {
            FaceGeometry::Trimmed { same_sense, .. } => *same_sense = !*same_sense,
            FaceGeometry::Faceted(facets) => {
                Arc::make_mut(facets).triangles.iter_mut().for_each(|t| t.swap(1, 2));
            }
        }
    }

    /// The face as part of a shell.
    pub fn into_face(self, shell: u32) -> Face {
        Face { entity: self.entity, geometry: self.geometry, loops: self.loops, shell }
    }
}

/// What can be run through backwards.
trait TurnOver {
    fn turn_over(&mut self);
}

impl TurnOver for FaceLoop {
    fn turn_over(&mut self) {
        self.uses.reverse();
        self.uses.iter_mut().for_each(|u| u.forward = !u.forward);
    }
}
