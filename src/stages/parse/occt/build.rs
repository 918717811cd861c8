//! Solids, shells, faces and loops -> the arenas of a [`Model`].

use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::file::File;
use super::locations::{Locations, Place};
use super::shapes::{Data, Kind, Orientation, Use};
use super::surfaces::Sheet;
use crate::brep::{
    Body, BodyId, Curve, EdgeId, EdgeUse, Face, FaceGeometry, FaceId, FaceLoop, Facets, Loops, Model, Shell, Surface,
    SurfaceId, VertexId,
};
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::{Aabb, Transform};
use crate::stages::parse::chains::chains;
use crate::stages::parse::fault::{Fault, Read};
use crate::stages::parse::moved::moved_surface;
use crate::stages::parse::notes::Notes;

/// Builds a model; a shape in one place is made once.
pub(super) struct Builder<'a> {
    pub file: &'a File,
    pub model: Model,
    pub notes: Notes,
    pub(super) locations: Locations,
    pub(super) vertices: FxHashMap<(u32, Place), VertexId>,
    pub(super) edges: FxHashMap<(u32, Place), Option<EdgeId>>,
    pub(super) curves: FxHashMap<(u32, Place), Arc<Curve>>,
    /// A surface in a place, and whether its normal is against OCCT's.
    surfaces: FxHashMap<(u32, Place), (SurfaceId, bool)>,
    /// Uses and numbers of geometry that may still be copied.
    budget: usize,
}

/// A shape as used from a body: how it is turned and where it lies in the body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub shape: u32,
    pub reversed: bool,
    pub place: Place,
}

impl Seen {
    /// The number of the shape in reports.
    pub fn entity(&self) -> u64 {
        u64::from(self.shape) + 1
    }
}

impl<'a> Builder<'a> {
    pub fn new(file: &'a File) -> Self {
        let mut model = Model::empty();
        model.schema = format!("CASCADE Topology V{}", file.version);
        Self {
            file,
            model,
            notes: Notes::default(),
            locations: file.locations.clone(),
            vertices: FxHashMap::default(),
            edges: FxHashMap::default(),
            curves: FxHashMap::default(),
            surfaces: FxHashMap::default(),
            budget: file.bytes,
        }
    }

    /// Counts `count` things made for a shape. Each takes some bytes in a file in which nothing is shared: more things
    /// than bytes means that uses multiply beyond any use.
    pub(super) fn spend(&mut self, entity: u64, count: usize) -> Read<()> {
        let left = self.budget.checked_sub(count);
        self.budget = left.ok_or_else(|| Fault::new(entity, "uses of shapes multiply beyond the file's size"))?;
        Ok(())
    }

    /// The body of a solid, of a shell, of a face, or of the loose faces of a compound; `None` where no face can be read.
    ///
    /// # Errors
    /// Only when cancelled: what cannot be read is noted as skipped.
    pub fn body(&mut self, shape: u32, cancel: &Cancel) -> Result<Option<BodyId>, Cancelled> {
        let whole = Seen { shape, reversed: false, place: 0 };
        let solid = self.kind(shape) == Kind::Solid;
        let mut shells = Vec::new();
        if solid {
            for used in self.file.shapes.uses_of(shape) {
                if let (Kind::Shell, Some(seen)) = (self.kind(used.shape), self.seen(&whole, used)) {
                    shells.extend(self.shell(&seen, cancel)?);
                }
            }
            self.put_outer_first(&mut shells);
        } else {
            shells.extend(self.shell(&whole, cancel)?);
        }
        if shells.is_empty() {
            return Ok(None);
        }
        let id = BodyId(self.model.bodies.len() as u32);
        self.model.bodies.push(Body { entity: whole.entity(), solid, shells });
        Ok(Some(id))
    }

    pub(super) fn kind(&self, shape: u32) -> Kind {
        self.file.shapes.all[shape as usize].kind
    }

    /// A use as seen from outside the shape that has it; `None`, with a note, where its location is wrong.
    pub(super) fn seen(&mut self, outer: &Seen, used: &Use) -> Option<Seen> {
        let numbered = self.locations.numbered(used.location);
        let place = numbered.and_then(|place| self.locations.compose(outer.place, place));
        match place {
            Ok(place) => {
                let reversed = outer.reversed != (used.orientation == Orientation::Reversed);
                Some(Seen { shape: used.shape, reversed, place })
            }
            Err(why) => {
                let entity = u64::from(used.shape) + 1;
                self.notes.skip(entity, Fault::new(entity, why));
                None
            }
        }
    }

    /// OCCT lists the shells of a solid in any order; the outer one has the largest box.
    fn put_outer_first(&self, shells: &mut [u32]) {
        let size = |&shell: &u32| {
            let mut aabb = Aabb::default();
            let faces = self.model.shells[shell as usize].faces.iter().map(|f| &self.model.faces[f.index()]);
            for edge in faces.flat_map(|f| &f.loops).flat_map(|l| &l.uses).map(|u| u.edge) {
                self.model.ends(edge).iter().for_each(|p| aabb.add(p));
            }
            if aabb.is_empty() { 0.0 } else { aabb.diagonal() }
        };
        if shells.len() > 1 {
            shells.sort_by(|a, b| size(b).total_cmp(&size(a)));
        }
    }

    /// A shell, or the faces of a compound, or a single face; `None` if no face can be read.
    fn shell(&mut self, shell: &Seen, cancel: &Cancel) -> Result<Option<u32>, Cancelled> {
        let index = self.model.shells.len() as u32;
        let mut faces = Vec::new();
        let itself = [*shell];
        let parts: Vec<Seen> = if self.kind(shell.shape) == Kind::Face {
            itself.to_vec()
        } else {
            let uses = self.file.shapes.uses_of(shell.shape).iter();
            uses.filter(|u| self.file.shapes.all[u.shape as usize].kind == Kind::Face)
                .filter_map(|used| self.seen(shell, used))
                .collect()
        };
        for part in parts {
            cancel.check()?;
            match self.face(&part, index) {
                Ok(face) => {
                    faces.push(FaceId(self.model.faces.len() as u32));
                    self.model.faces.push(face);
                }
                Err(fault) => self.notes.skip(part.entity(), fault),
            }
        }
        if faces.is_empty() {
            return Ok(None);
        }
        let closed = self.file.shapes.all[shell.shape as usize].closed;
        self.model.shells.push(Shell { entity: shell.entity(), closed, faces });
        Ok(Some(index))
    }

    fn face(&mut self, face: &Seen, shell: u32) -> Read<Face> {
        let entity = face.entity();
        self.spend(entity, 1)?;
        let Data::Face { surface, location, triangulation } = self.file.shapes.all[face.shape as usize].data else {
            return Err(Fault::new(entity, "a face was expected"));
        };
        let fault = |why| Fault::new(entity, why);
        if surface == 0 && triangulation > 0 {
            let facets = self.facets(face, triangulation)?;
            let geometry = FaceGeometry::Faceted(Arc::new(facets));
            return Ok(Face { entity, geometry, loops: Loops::new(), shell });
        }
        let numbered = self.locations.numbered(location).map_err(fault)?;
        let place = self.locations.compose(face.place, numbered).map_err(fault)?;
        let (surface, turned) = self.surface(entity, surface, place)?;
        let loops = self.loops(face)?;
        Ok(Face {
            entity,
            geometry: FaceGeometry::Trimmed { surface, same_sense: face.reversed == turned },
            loops,
            shell,
        })
    }

    /// A surface in its place, and whether its normal S_u x S_v is against that of OCCT.
    fn surface(&mut self, entity: u64, number: u32, place: Place) -> Read<(SurfaceId, bool)> {
        if let Some(known) = self.surfaces.get(&(number, place)) {
            return Ok(*known);
        }
        let sheet = self.sheet(entity, number)?;
        self.spend(entity, weight(&sheet.surface))?;
        let transform = self.locations.transform(place).map_err(|why| Fault::new(entity, why))?;
        let (surface, turned) = match transform {
            None => (sheet.surface.clone(), sheet.turned),
            Some(by) => {
                let (surface, against) = moved_surface(sheet.surface.clone(), by);
                // OCCT's normal follows the parameters, which a mirror carries along.
                (surface, sheet.turned ^ against ^ by.mirrors())
            }
        };
        let made = (self.model.add_surface(surface), turned);
        self.surfaces.insert((number, place), made);
        Ok(made)
    }

    pub(super) fn sheet(&self, entity: u64, number: u32) -> Read<&'a Sheet> {
        let file = self.file;
        let index = (number as usize).checked_sub(1);
        match index.and_then(|i| file.surfaces.get(i)) {
            Some(Ok(sheet)) => Ok(sheet),
            Some(Err(why)) => Err(Fault::new(entity, format!("surface {number}: {why}"))),
            None => Err(Fault::new(entity, "a face without a surface")),
        }
    }

    fn facets(&mut self, face: &Seen, number: u32) -> Read<Facets> {
        let entity = face.entity();
        let made = self.file.triangulations.get(number as usize - 1);
        let facets = match made {
            Some(Ok(facets)) => facets,
            Some(Err(why)) => return Err(Fault::new(entity, format!("triangulation {number}: {why}"))),
            None => return Err(Fault::new(entity, "a triangulation that is not there")),
        };
        self.spend(entity, facets.points.len() + facets.triangles.len())?;
        let place = self.locations.transform(face.place).map_err(|why| Fault::new(entity, why))?;
        let by = place.copied().unwrap_or_else(Transform::identity);
        let points = facets.points.iter().map(|p| by.point(p)).collect();
        let turn = |[a, b, c]: [u32; 3]| if face.reversed { [a, c, b] } else { [a, b, c] };
        Ok(Facets { points, triangles: facets.triangles.iter().copied().map(turn).collect() })
    }

    /// The loops of a face's wires, with the face on the left.
    fn loops(&mut self, face: &Seen) -> Read<Loops> {
        let mut loops = Loops::new();
        for used in self.file.shapes.uses_of(face.shape) {
            if self.kind(used.shape) == Kind::Wire && used.orientation != Orientation::Loose {
                let wire = self.seen(face, used).ok_or_else(|| Fault::new(face.entity(), "a loop in no place"))?;
                loops.extend(self.wire_loops(&wire)?);
            }
        }
        Ok(loops)
    }

    /// The loops of one wire: one, or several where it is not connected; none where all its edges are loose.
    fn wire_loops(&mut self, wire: &Seen) -> Read<Loops> {
        let (mut uses, mut pole) = (Vec::new(), None);
        let parts = self.file.shapes.uses_of(wire.shape);
        self.spend(wire.entity(), parts.len())?;
        for used in parts.iter().filter(|u| u.orientation != Orientation::Loose) {
            if self.kind(used.shape) != Kind::Edge {
                continue;
            }
            let seen = self.seen(wire, used).ok_or_else(|| Fault::new(wire.entity(), "an edge in no place"))?;
            match self.edge(&seen)? {
                Some(edge) => uses.push(EdgeUse { edge, forward: !seen.reversed }),
                None => pole = self.first_vertex(&seen)?,
            }
        }
        if wire.reversed {
            uses.reverse();
        }
        let face_loop = |uses: Vec<_>, pole| FaceLoop { entity: wire.entity(), uses: uses.into(), pole, outer: false };
        if uses.is_empty() {
            return Ok(pole.map(|pole| face_loop(Vec::new(), Some(pole))).into_iter().collect());
        }
        Ok(chains(&self.model, uses).into_iter().map(|uses| face_loop(uses, None)).collect())
    }
}

/// About how many numbers a surface consists of.
pub(super) fn weight(surface: &Surface) -> usize {
    match surface {
        Surface::Nurbs(nurbs) => nurbs.points.len(),
        Surface::Revolution { profile, .. } | Surface::Extrusion { profile, .. } => curve_weight(profile),
        Surface::Offset { basis, .. } | Surface::Rectangular { basis, .. } => weight(basis),
        _ => 1,
    }
}

/// About how many numbers a curve consists of.
pub(super) fn curve_weight(curve: &Curve) -> usize {
    match curve {
        Curve::Nurbs(nurbs) => nurbs.points.len(),
        Curve::Polyline(points) => points.len(),
        Curve::Trimmed { basis, .. } | Curve::Offset { basis, .. } => curve_weight(basis),
        Curve::Composite(pieces) => pieces.iter().map(|(piece, _)| curve_weight(piece)).sum(),
        _ => 1,
    }
}
