//! Solids with topology: vertices and edges from lists, loops, faces and shells.

use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::file::{File, Record};
use crate::brep::{
    Body, BodyId, Edge, EdgeId, EdgeUse, Face, FaceGeometry, FaceId, FaceLoop, Loops, Model, Shell, SurfaceId, Uses,
    Vertex, VertexId,
};
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::Point;
use crate::stages::parse::cut;
use crate::stages::parse::fault::Read;
use crate::stages::parse::notes::Notes;

/// Builds a model; what several faces share is made once.
pub(super) struct Builder<'a> {
    pub file: &'a File<'a>,
    pub model: Model,
    pub notes: Notes,
    records: FxHashMap<u64, Arc<Record>>,
    /// By list and index.
    vertices: FxHashMap<(u64, i64), VertexId>,
    edges: FxHashMap<(u64, i64), Option<EdgeId>>,
    /// A surface, and whether its normal is against that of IGES.
    surfaces: FxHashMap<u64, (SurfaceId, bool)>,
}

impl<'a> Builder<'a> {
    pub fn new(file: &'a File<'a>) -> Self {
        let mut model = Model::empty();
        model.schema = file.global.version.clone();
        model.unit_mm = file.global.unit_mm;
        let mut notes = Notes::default();
        file.global.warning.iter().for_each(|warning| notes.warn(warning.clone()));
        Self {
            file,
            model,
            notes,
            records: FxHashMap::default(),
            vertices: FxHashMap::default(),
            edges: FxHashMap::default(),
            surfaces: FxHashMap::default(),
        }
    }

    /// MANIFOLD SOLID B-REP (186), or a SHELL (514) on its own; `None` where no face can be read.
    ///
    /// # Errors
    /// Only when cancelled: what cannot be read is noted as skipped.
    pub fn solid(&mut self, entity: u64, cancel: &Cancel) -> Result<Option<BodyId>, Cancelled> {
        let (shells, solid) = match self.shells_of(entity) {
            Ok(found) => found,
            Err(fault) => {
                self.notes.skip(entity, fault);
                return Ok(None);
            }
        };
        let mut made = Vec::new();
        for (shell, turned) in shells {
            made.extend(self.shell(shell, turned, cancel)?);
        }
        Ok((!made.is_empty()).then(|| self.push_body(entity, solid, made)))
    }

    pub(super) fn push_body(&mut self, entity: u64, solid: bool, shells: Vec<u32>) -> BodyId {
        let id = BodyId(self.model.bodies.len() as u32);
        self.model.bodies.push(Body { entity, solid, shells });
        id
    }

    /// The shells of a body with whether each is turned over; the outer one comes first.
    fn shells_of(&self, entity: u64) -> Read<(Vec<(u64, bool)>, bool)> {
        let record = self.file.record(entity)?;
        if record.entry.kind == 514 {
            return Ok((vec![(entity, false)], false));
        }
        let mut fields = record.fields();
        let mut shells = vec![(fields.pointer()?, !fields.flag()?)];
        let voids = fields.count()?;
        for _ in 0..voids {
            shells.push((fields.pointer()?, !fields.flag()?));
        }
        Ok((shells, true))
    }

    /// A shell with its faces; `None` if none of them can be read.
    fn shell(&mut self, entity: u64, turned: bool, cancel: &Cancel) -> Result<Option<u32>, Cancelled> {
        let (uses, closed) = match self.face_uses(entity) {
            Ok(found) => found,
            Err(fault) => {
                self.notes.skip(entity, fault);
                return Ok(None);
            }
        };
        let index = self.model.shells.len() as u32;
        let mut faces = Vec::with_capacity(uses.len());
        for (face, against) in uses {
            cancel.check()?;
            match self.face(face, turned != against, index) {
                Ok(made) => {
                    faces.push(FaceId(self.model.faces.len() as u32));
                    self.model.faces.push(made);
                }
                Err(fault) => self.notes.skip(face, fault),
            }
        }
        if faces.is_empty() {
            return Ok(None);
        }
        self.model.shells.push(Shell { entity, closed, faces });
        Ok(Some(index))
    }

    /// The faces of a shell with whether each is turned over, and whether the shell is closed.
    fn face_uses(&self, entity: u64) -> Read<(Vec<(u64, bool)>, bool)> {
        let record = self.file.expect(entity, 514, "a shell was expected")?;
        let mut fields = record.fields();
        let count = fields.count()?;
        let faces = (0..count).map(|_| Ok((fields.pointer()?, !fields.flag()?))).collect::<Read<_>>()?;
        Ok((faces, record.entry.form != 2))
    }

    /// FACE (510).
    fn face(&mut self, entity: u64, turned: bool, shell: u32) -> Read<Face> {
        let record = self.file.expect(entity, 510, "a face was expected")?;
        let mut fields = record.fields();
        let (surface, against) = self.surface(fields.pointer()?)?;
        let count = fields.count()?;
        let has_outer = fields.flag()?;
        let ids = fields.pointers(count)?;
        let mut loops = Loops::with_capacity(ids.len());
        for (i, id) in ids.into_iter().enumerate() {
            let mut face_loop = self.face_loop(id)?;
            face_loop.outer = has_outer && i == 0;
            if turned {
                face_loop.uses.reverse();
                face_loop.uses.iter_mut().for_each(|used| used.forward = !used.forward);
            }
            if !face_loop.uses.is_empty() || face_loop.pole.is_some() {
                loops.push(face_loop);
            }
        }
        let geometry = FaceGeometry::Trimmed { surface, same_sense: turned == against };
        Ok(Face { entity, geometry, loops, shell })
    }

    fn surface(&mut self, entity: u64) -> Read<(SurfaceId, bool)> {
        if let Some(known) = self.surfaces.get(&entity) {
            return Ok(*known);
        }
        let (surface, against) = self.file.sheet(entity)?.placed();
        let made = (self.model.add_surface(surface), against);
        self.surfaces.insert(entity, made);
        Ok(made)
    }

    /// LOOP (508): edges, or vertices for poles.
    fn face_loop(&mut self, entity: u64) -> Read<FaceLoop> {
        let record = self.file.expect(entity, 508, "a loop was expected")?;
        let mut fields = record.fields();
        let count = fields.count()?;
        let mut face_loop = FaceLoop { entity, uses: Uses::with_capacity(count), pole: None, outer: false };
        for _ in 0..count {
            let (kind, list, index) = (fields.integer()?, fields.pointer()?, fields.integer()?);
            let forward = fields.flag()?;
            let curves = fields.count()?;
            fields.skip(curves.saturating_mul(2));
            if kind == 1 {
                face_loop.pole = Some(self.vertex(list, index)?);
            } else if let Some(edge) = self.edge(list, index)? {
                face_loop.uses.push(EdgeUse { edge, forward });
            }
        }
        if !face_loop.uses.is_empty() {
            face_loop.pole = None;
        }
        Ok(face_loop)
    }

    /// A list of vertices or edges, read once.
    fn list(&mut self, entity: u64, kind: u32, otherwise: &'static str) -> Read<Arc<Record>> {
        if let Some(known) = self.records.get(&entity).filter(|record| record.entry.kind == kind) {
            return Ok(known.clone());
        }
        let record = Arc::new(self.file.expect(entity, kind, otherwise)?);
        self.records.insert(entity, record.clone());
        Ok(record)
    }

    /// The index-th entry, from 1, of a list whose entries have `size` parameters.
    fn entry_of(record: &Record, index: i64, size: usize) -> Read<usize> {
        let count = record.fields().count()?;
        let place = usize::try_from(index - 1).ok().filter(|i| *i < count);
        place.map(|i| 1 + i * size).ok_or_else(|| record.fault(format!("there is no entry {index} in the list")))
    }

    /// VERTEX LIST (502).
    fn vertex(&mut self, list: u64, index: i64) -> Read<VertexId> {
        if let Some(&known) = self.vertices.get(&(list, index)) {
            return Ok(known);
        }
        let record = self.list(list, 502, "a list of vertices was expected")?;
        let place = Self::entry_of(&record, index, 3)?;
        let point = Point::from(record.fields().skip(place).reals::<3>()?) * self.file.global.unit_mm;
        let point = self.file.transform(&record)?.map_or(point, |by| by.point(&point));
        let id = VertexId(self.model.vertices.len() as u32);
        self.model.vertices.push(Vertex { entity: list, point });
        self.vertices.insert((list, index), id);
        Ok(id)
    }

    /// EDGE LIST (504); `None` for an edge without length.
    fn edge(&mut self, list: u64, index: i64) -> Read<Option<EdgeId>> {
        if let Some(&known) = self.edges.get(&(list, index)) {
            return Ok(known);
        }
        let record = self.list(list, 504, "a list of edges was expected")?;
        let mut fields = record.fields();
        fields.skip(Self::entry_of(&record, index, 5)?);
        let curve = fields.optional_pointer()?;
        let start = self.vertex(fields.pointer()?, fields.integer()?)?;
        let end = self.vertex(fields.pointer()?, fields.integer()?)?;
        let curve = match curve {
            Some(curve) => Some(self.edge_curve(curve, start == end)?),
            None => None,
        };
        let made = if curve.is_none() && start == end {
            None
        } else {
            let id = EdgeId(self.model.edges.len() as u32);
            let (curve, same_sense) = curve.map_or((None, true), |(curve, sense)| (Some(curve), sense));
            self.model.edges.push(Edge { entity: list, curve, start, end, same_sense });
            Some(id)
        };
        self.edges.insert((list, index), made);
        Ok(made)
    }

    /// The curve of an edge, cut to its range where its vertices do not tell that by themselves.
    fn edge_curve(&self, entity: u64, closed: bool) -> Read<(Arc<crate::brep::Curve>, bool)> {
        let piece = self.file.curve(entity)?;
        let whole = cut::needs_none(&piece.curve, piece.range, closed);
        let curve = if whole { piece.curve } else { piece.bounded() };
        Ok((Arc::new(curve), true))
    }
}
