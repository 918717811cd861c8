//! Shells and bodies: the items of a shape representation -> the bodies of a model.

use super::keyword::Kind;
use super::records::Record;
use super::topology::{Builder, LooseFace};
use crate::brep::{Body, BodyId, FaceId, Shell};
use crate::cancel::{Cancel, Cancelled};
use crate::stages::parse::fault::Read;

const SOLID: &[Kind] = &[Kind::RepresentationItem, Kind::ManifoldSolidBrep, Kind::BrepWithVoids];
const SHELL: &[Kind] = &[Kind::RepresentationItem, Kind::ConnectedFaceSet];
/// How deep an oriented shell may refer to another one.
const DEEPEST_SHELL: u32 = 8;

/// What kind of body an item of a representation makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BodyKind {
    Solid,
    /// Shells without a solid.
    Shells,
    /// Loose surfaces and faces.
    Set,
    /// A shell, or a face, that is itself an item.
    Bare,
    /// Triangles instead of a B-rep.
    Tessellated,
}

impl BodyKind {
    /// The kind of body that a record makes, if any.
    pub fn of(record: &Record) -> Option<Self> {
        record.kinds().find_map(|kind| {
            Some(match kind {
                Kind::ManifoldSolidBrep | Kind::BrepWithVoids | Kind::FacetedBrep => Self::Solid,
                Kind::ShellBasedSurfaceModel | Kind::FaceBasedSurfaceModel => Self::Shells,
                Kind::GeometricSet | Kind::GeometricCurveSet => Self::Set,
                Kind::OpenShell | Kind::ClosedShell | Kind::OrientedClosedShell | Kind::OrientedOpenShell => Self::Bare,
                Kind::ConnectedFaceSet | Kind::AdvancedFace | Kind::FaceSurface => Self::Bare,
                Kind::TessellatedSolid | Kind::TessellatedShell => Self::Tessellated,
                Kind::TriangulatedSurfaceSet | Kind::ComplexTriangulatedSurfaceSet => Self::Tessellated,
                Kind::TriangulatedFace | Kind::ComplexTriangulatedFace => Self::Tessellated,
                _ => return None,
            })
        })
    }
}

impl Builder<'_> {
    /// Reads one item of a representation into a body; `None` where it holds no face.
    ///
    /// # Errors
    /// Only when cancelled: what cannot be read is noted as skipped.
    pub fn body(&mut self, record: &Record, kind: BodyKind, cancel: &Cancel) -> Result<Option<BodyId>, Cancelled> {
        let shells = match kind {
            BodyKind::Solid => self.solid_shells(record),
            BodyKind::Shells => record
                .fields(&[Kind::RepresentationItem, Kind::ShellBasedSurfaceModel, Kind::FaceBasedSurfaceModel])
                .skip_many(1)
                .references_leniently(),
            BodyKind::Set | BodyKind::Bare | BodyKind::Tessellated => Ok(vec![record.id]),
        };
        let shells = match shells {
            Ok(shells) => shells,
            Err(fault) => {
                self.notes.skip(record.id, fault);
                return Ok(None);
            }
        };
        let mut made = Vec::new();
        for shell in shells {
            made.extend(self.shell(shell, kind, cancel)?);
        }
        if made.is_empty() {
            return Ok(None);
        }
        let id = BodyId(self.model.bodies.len() as u32);
        let solid = kind == BodyKind::Solid || (kind == BodyKind::Tessellated && record.is(Kind::TessellatedSolid));
        self.model.bodies.push(Body { entity: record.id, solid, shells: made });
        Ok(Some(id))
    }

    /// The outer shell, then the voids.
    fn solid_shells(&self, record: &Record) -> Read<Vec<u64>> {
        let mut cursor = record.fields(SOLID);
        let mut shells = vec![cursor.skip_many(1).reference()?];
        if cursor.is_list() {
            shells.append(&mut cursor.references_leniently()?);
        }
        Ok(shells)
    }

    /// A shell with its faces; `None` if none of them could be read.
    fn shell(&mut self, id: u64, kind: BodyKind, cancel: &Cancel) -> Result<Option<u32>, Cancelled> {
        let faces = match kind {
            BodyKind::Tessellated => self.triangulated(id).map(|faces| (faces, false)),
            BodyKind::Set => self.loose_surfaces(id, cancel)?.map(|faces| (faces, false)),
            _ => self.shell_faces(id, cancel)?,
        };
        match faces {
            Ok((faces, closed)) => Ok(self.push_shell(id, closed, faces)),
            Err(fault) => {
                self.notes.skip(id, fault);
                Ok(None)
            }
        }
    }

    fn push_shell(&mut self, entity: u64, closed: bool, faces: Vec<LooseFace>) -> Option<u32> {
        if faces.is_empty() {
            return None;
        }
        let shell = self.model.shells.len() as u32;
        let first = self.model.faces.len() as u32;
        self.model.faces.extend(faces.into_iter().map(|f| f.into_face(shell)));
        let faces = (first..self.model.faces.len() as u32).map(FaceId).collect();
        self.model.shells.push(Shell { entity, closed, faces });
        Some(shell)
    }

    /// The faces of any shell, and whether it calls itself closed.
    fn shell_faces(&mut self, id: u64, cancel: &Cancel) -> Result<Read<(Vec<LooseFace>, bool)>, Cancelled> {
        let (ids, closed, turned) = match self.face_ids(id, 0) {
            Ok(found) => found,
            Err(fault) => return Ok(Err(fault)),
        };
        let mut faces = Vec::with_capacity(ids.len());
        for id in ids {
            cancel.check()?;
            match self.face(id, 0) {
                Ok(face) => faces.push(face),
                Err(fault) => self.notes.skip(id, fault),
            }
        }
        if turned {
            faces.iter_mut().for_each(LooseFace::turn_over);
        }
        Ok(Ok((faces, closed)))
    }

    /// The faces a shell names, whether it is closed, and whether it is to be turned over.
    fn face_ids(&self, id: u64, depth: u32) -> Read<(Vec<u64>, bool, bool)> {
        let record = self.record(id)?;
        let oriented = record.is(Kind::OrientedClosedShell) || record.is(Kind::OrientedOpenShell);
        if oriented && depth < DEEPEST_SHELL {
            let mut cursor =
                record.fields(&[Kind::RepresentationItem, Kind::OrientedClosedShell, Kind::OrientedOpenShell]);
            if record.kind != Kind::Complex {
                cursor.skip();
            }
            let element = cursor.skip_many(1).reference()?;
            let flipped = cursor.flag() == Some(false);
            let (ids, closed, turned) = self.face_ids(element, depth + 1)?;
            return Ok((ids, closed, turned != flipped));
        }
        if record.is(Kind::AdvancedFace) || record.is(Kind::FaceSurface) {
            return Ok((vec![id], false, false));
        }
        let known = [Kind::ClosedShell, Kind::OpenShell, Kind::ConnectedFaceSet, Kind::ConnectedFaceSubSet];
        if !known.iter().any(|kind| record.is(*kind)) {
            return Err(record.fault("a shell was expected"));
        }
        let ids = record.fields(SHELL).skip_many(1).references_leniently()?;
        Ok((ids, record.is(Kind::ClosedShell), false))
    }

    /// The bounded surfaces of a GEOMETRIC_SET; its curves and points make no faces.
    fn loose_surfaces(&mut self, id: u64, cancel: &Cancel) -> Result<Read<Vec<LooseFace>>, Cancelled> {
        let elements = self.record(id).and_then(|record| {
            record.fields(&[Kind::RepresentationItem, Kind::GeometricSet]).skip_many(1).references_leniently()
        });
        let elements = match elements {
            Ok(elements) => elements,
            Err(fault) => return Ok(Err(fault)),
        };
        let mut faces = Vec::new();
        for element in elements {
            cancel.check()?;
            match self.loose_surface(element) {
                Ok(face) => faces.extend(face),
                Err(fault) => self.notes.skip(element, fault),
            }
        }
        Ok(Ok(faces))
    }

    fn loose_surface(&mut self, id: u64) -> Read<Option<LooseFace>> {
        let record = self.record(id)?;
        for kind in record.kinds() {
            match kind {
                Kind::AdvancedFace | Kind::FaceSurface | Kind::OrientedFace => return self.face(id, 0).map(Some),
                Kind::RectangularTrimmedSurface
                | Kind::BSplineSurface
                | Kind::BSplineSurfaceWithKnots
                | Kind::QuasiUniformSurface
                | Kind::UniformSurface
                | Kind::BezierSurface
                | Kind::SphericalSurface
                | Kind::ToroidalSurface
                | Kind::DegenerateToroidalSurface
                | Kind::SurfaceReplica => return self.whole_surface(id).map(Some),
                Kind::CurveBoundedSurface => return self.curve_bounded(&record).map(Some),
                _ => {}
            }
        }
        Ok(None)
    }

    /// CURVE_BOUNDED_SURFACE: each of its closed curves becomes a loop of one edge.
    fn curve_bounded(&mut self, record: &Record) -> Read<LooseFace> {
        let mut cursor = record.fields(&[Kind::RepresentationItem, Kind::CurveBoundedSurface]);
        cursor.skip_many(2);
        let boundaries = cursor.references()?;
        if cursor.flag() == Some(true) && !boundaries.is_empty() {
            return Err(record.fault("a surface whose own border is cut by further curves"));
        }
        self.geometry.spend(record.id, boundaries.len())?;
        let mut face = self.whole_surface(record.id)?;
        face.loops = boundaries.into_iter().map(|id| self.curve_loop(id)).collect::<Read<_>>()?;
        Ok(face)
    }
}
