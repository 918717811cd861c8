//! Stage 2: model -> the outlines of its faces, reduced to their corners.
//!
//! In: a [`Parsed`] model. Out: one [`Outline`] for each maximal face, in place.
//!
//! Method: section IV.B of the paper keeps the vertices of a face's outer loop where the left and right tangents
//! differ. Before that, faces that an exporter cut out of one wall are joined (`maximal`), and with them go the
//! seams and poles, which are edges of a parametrisation and not of the shape (`boundary`). Faces that turn about an
//! axis into themselves have no corners that mean anything; they get the axis instead (`axial`).
//!
//! Cost: linear in the edges and the triangles. It does not promise corners: a full cylinder has none.

mod axial;
mod boundary;
mod edges;
mod maximal;

use std::ops::Range;

use smallvec::SmallVec;

use crate::brep::{BodyId, FaceId, PlacedFaceId};
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::{Axis, Point, Transform, Vector};
use crate::memory::{empty, held};
use crate::stages::parse::Parsed;
use crate::stages::{ModelError, Stage};
use boundary::{Loops, Room, Tracer};
use edges::EdgeShapes;
use maximal::Groups;

/// Settings of the stage.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// A vertex is a corner where the tangents of its edges differ by more than this, degrees. Tangent-continuous
    /// joints of real files are off by up to a degree; chamfers turn by 15 and more.
    pub corner_angle_deg: f64,
    /// Join adjacent faces of one underlying surface. The paper takes faces as the file has them.
    pub maximal_faces: bool,
    /// Two surfaces are the same where they are no farther apart, as a share of D. Well above the precision of
    /// files (1e-6), well below any step that is meant.
    pub same_surface: f64,
    /// Find the axes of faces of revolution. The paper has nothing for them.
    pub axes: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { corner_angle_deg: 5.0, maximal_faces: true, same_surface: 1e-4, axes: true }
    }
}

impl Options {
    /// The paper's reading.
    pub fn paper() -> Self {
        Self { maximal_faces: false, axes: false, ..Self::default() }
    }
}

/// A loop inside an outline: the rim of a hole, or the other end of a tube.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InnerLoop {
    /// Mean of the loop by arc length.
    pub centroid: Point,
    /// Arc length, mm.
    pub length: f64,
}

/// A maximal face as matching sees it, in place.
#[derive(Clone, Debug)]
pub struct Outline {
    /// The faces it is made of, in growing order: one for most.
    pub faces: SmallVec<[PlacedFaceId; 4]>,
    /// Corners of the outer loop; with the face normal up, the inside is on the left. Most have four.
    pub corners: SmallVec<[Point; 4]>,
    /// Arc length of the outer loop, mm.
    pub perimeter: f64,
    /// Its holes.
    pub inner: Vec<InnerLoop>,
    /// Area of the trimmed surface, mm^2.
    pub area: f64,
    /// Area centroid.
    pub centroid: Point,
    /// The axis about which the face turns into itself.
    pub axis: Option<Axis>,
    /// Whether the face has an outside (it belongs to a solid), so that the order of its corners means something.
    pub oriented: bool,
    /// Of a face of a body in several places, the shape that it has in all of them.
    pub shape: Option<Shape>,
}

/// What outlines have in common that are one outline in several places.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Shape {
    body: BodyId,
    /// Among the outlines of the body.
    number: u32,
    /// Whether the corners are listed the other way round than in the body.
    backwards: bool,
    /// The scale of the place, bit by bit.
    scale: u64,
}

/// Memory that is filled anew for each model.
#[derive(Default)]
pub struct Scratch {
    faces: Vec<FaceId>,
    groups: Groups,
    shapes: EdgeShapes,
    loops: Loops,
    room: Room,
    found: LocalOutlines,
}

impl Scratch {
    /// Bytes of memory that it holds.
    pub fn bytes(&self) -> usize {
        let Self { faces, groups, shapes, loops, room, found } = self;
        held(faces) + groups.bytes() + shapes.bytes() + loops.bytes() + room.bytes() + found.bytes()
    }
}

/// Finds the outlines of all placed faces.
///
/// # Errors
/// Only when cancelled.
pub fn corner_filter(parsed: &Parsed, options: &Options, cancel: &Cancel) -> Result<Vec<Outline>, ModelError> {
    corner_filter_in(&mut Scratch::default(), parsed, options, cancel)
}

/// [`corner_filter`] in memory that others have done with.
///
/// # Errors
/// Only when cancelled.
pub fn corner_filter_in(
    scratch: &mut Scratch,
    parsed: &Parsed,
    options: &Options,
    cancel: &Cancel,
) -> Result<Vec<Outline>, ModelError> {
    let model = &parsed.model;
    let cancelled = |c| ModelError::cancelled(Stage::CornerFilter, c);
    let placed = AllPlaced::new(parsed);
    let mut finder = Finder::new(scratch, parsed, options, cancel);
    let mut of_body: Vec<Option<Range<usize>>> = vec![None; model.bodies.len()];
    let mut outlines = Vec::with_capacity(parsed.mesh.faces.len());
    let mut uses = vec![0u32; model.bodies.len()];
    model.occurrences.iter().for_each(|occurrence| uses[occurrence.body.index()] += 1);
    for (index, occurrence) in model.occurrences.iter().enumerate() {
        cancel.check().map_err(cancelled)?;
        let (body, faces, placement) = (occurrence.body, placed.of(index), &occurrence.placement);
        let local = match &of_body[body.index()] {
            Some(local) => local.clone(),
            None => finder.find(body, faces, placement).map_err(cancelled)?,
        };
        let place = Place::new(placement);
        let is_shared = uses[body.index()] > 1;
        let placed = |(number, outline): (u32, usize)| {
            finder.found.placed(outline, parsed, faces, &place, is_shared.then_some((body, number)))
        };
        outlines.extend((0..).zip(local.clone()).filter_map(placed));
        of_body[body.index()] = Some(local);
    }
    Ok(outlines)
}

/// Where the faces of each occurrence are in the mesh: pairs (face, place), sorted by face, of one occurrence after the
/// other.
struct AllPlaced {
    pairs: Vec<(u32, u32)>,
    /// Where the pairs of each occurrence end.
    ends: Vec<usize>,
}

impl AllPlaced {
    fn new(parsed: &Parsed) -> Self {
        let faces = &parsed.mesh.faces;
        let mut pairs: Vec<_> = (0..).zip(faces).map(|(i, face)| (face.face.0, i)).collect();
        let mut ends = Vec::with_capacity(parsed.model.occurrences.len());
        let mut end = 0;
        for occurrence in 0..parsed.model.occurrences.len() as u32 {
            let from = end;
            end += faces[from..].iter().take_while(|face| face.occurrence == occurrence).count();
            pairs[from..end].sort_unstable();
            ends.push(end);
        }
        Self { pairs, ends }
    }

    fn of(&self, occurrence: usize) -> PlacedFaces<'_> {
        let from = occurrence.checked_sub(1).map_or(0, |before| self.ends[before]);
        PlacedFaces(&self.pairs[from..self.ends[occurrence]])
    }
}

/// The faces of one occurrence that have a mesh.
#[derive(Clone, Copy, Debug)]
struct PlacedFaces<'a>(&'a [(u32, u32)]);

impl PlacedFaces<'_> {
    fn find(&self, face: FaceId) -> Option<PlacedFaceId> {
        // Most bodies have their faces one after the other and none is left out: then this guess is right.
        let guess = face.0.checked_sub(self.0.first()?.0)? as usize;
        if let Some(&(found, place)) = self.0.get(guess)
            && found == face.0
        {
            return Some(PlacedFaceId(place));
        }
        let at = self.0.binary_search_by_key(&face.0, |&(face, _)| face).ok()?;
        Some(PlacedFaceId(self.0[at].1))
    }
}

/// A placement with what each outline asks of it.
struct Place<'a> {
    placement: &'a Transform,
    inverse: Option<Transform>,
    determinant: f64,
    scale: f64,
}

impl<'a> Place<'a> {
    fn new(placement: &'a Transform) -> Self {
        let (inverse, determinant) = (placement.inverse(), placement.linear.determinant());
        Self { placement, inverse, determinant, scale: placement.scale() }
    }
}

/// Outlines in the coordinates of their bodies, the same for all occurrences.
#[derive(Default)]
struct LocalOutlines {
    outlines: Vec<LocalOutline>,
    faces: Vec<FaceId>,
    corners: Vec<Point>,
    inner: Vec<InnerLoop>,
}

/// An outline whose faces, corners and inner loops end here, and begin where those of the one before end.
struct LocalOutline {
    ends: [usize; 3],
    perimeter: f64,
    /// Half the sum of p x q along all loops: the vector area they enclose if they run as they should.
    vector_area: Vector,
    axis: Option<Axis>,
    oriented: bool,
}

impl LocalOutlines {
    /// None yet; most of these faces will be outlines of their own, with four corners.
    fn clear(&mut self, faces: usize) {
        empty(&mut self.outlines, faces);
        empty(&mut self.faces, faces);
        empty(&mut self.corners, 4 * faces);
        self.inner.clear();
    }

    /// Bytes of memory that they hold.
    fn bytes(&self) -> usize {
        held(&self.outlines) + held(&self.faces) + held(&self.corners) + held(&self.inner)
    }

    /// Where the faces, corners and inner loops of an outline are.
    fn ranges(&self, index: usize) -> [Range<usize>; 3] {
        let starts = index.checked_sub(1).map_or([0; 3], |before| self.outlines[before].ends);
        let ends = self.outlines[index].ends;
        std::array::from_fn(|i| starts[i]..ends[i])
    }

    /// One of the outlines in its occurrence; `None` where the mesh has none of its faces. Where several occurrences
    /// share it, `shared` names its body and its number there.
    fn placed(
        &self,
        index: usize,
        parsed: &Parsed,
        places: PlacedFaces,
        place: &Place,
        shared: Option<(BodyId, u32)>,
    ) -> Option<Outline> {
        let (placement, scale) = (place.placement, place.scale);
        let (outline, [of_faces, of_corners, of_inner]) = (&self.outlines[index], self.ranges(index));
        let mut faces: SmallVec<[PlacedFaceId; 4]> =
            self.faces[of_faces].iter().filter_map(|&f| places.find(f)).collect();
        faces.sort_unstable();
        let area: f64 = faces.iter().map(|f| parsed.mesh.faces[f.index()].area).sum();
        if !(area > 0.0 && area.is_finite()) {
            return None;
        }
        let moment: Vector =
            faces.iter().map(|f| &parsed.mesh.faces[f.index()]).map(|f| f.centroid.coords * f.area).sum();
        let mut corners: SmallVec<[Point; 4]> = self.corners[of_corners].iter().map(|p| placement.point(p)).collect();
        let backwards = outline.runs_backwards(parsed, &faces, place);
        if backwards {
            corners.reverse();
        }
        let inner = self.inner[of_inner].iter();
        let inner =
            inner.map(|l| InnerLoop { centroid: placement.point(&l.centroid), length: l.length * scale }).collect();
        let axis = outline
            .axis
            .map(|a| Axis { point: placement.point(&a.point), direction: placement.direction(&a.direction) });
        Some(Outline {
            corners,
            perimeter: outline.perimeter * scale,
            inner,
            area,
            centroid: Point::from(moment / area),
            axis,
            oriented: outline.oriented,
            shape: shared.map(|(body, number)| Shape { body, number, backwards, scale: scale.to_bits() }),
            faces,
        })
    }
}

impl LocalOutline {
    /// Whether the loops enclose the opposite of the mesh's vector area (Stokes): files break the rule of the left
    /// side, and a mirroring placement turns it round.
    fn runs_backwards(&self, parsed: &Parsed, faces: &[PlacedFaceId], place: &Place) -> bool {
        let triangles = faces.iter().flat_map(|&f| parsed.mesh.triangles_of(f));
        let meshed: Vector = triangles.map(|t| parsed.mesh.doubled_normal(t)).sum();
        let doubled = meshed.norm();
        let Some(inverse) = &place.inverse else { return false };
        let enclosed = inverse.linear.transpose() * self.vector_area * place.determinant;
        let agreement = enclosed.dot(&meshed);
        if agreement.abs() > 1e-3 * enclosed.norm() * doubled { agreement < 0.0 } else { place.placement.mirrors() }
    }
}

/// Finds the outlines of one body after the other, in the same memory.
struct Finder<'a> {
    parsed: &'a Parsed,
    options: &'a Options,
    cancel: &'a Cancel,
    faces: &'a mut Vec<FaceId>,
    groups: &'a mut Groups,
    tracer: Tracer<'a>,
    found: &'a mut LocalOutlines,
}

impl<'a> Finder<'a> {
    fn new(scratch: &'a mut Scratch, parsed: &'a Parsed, options: &'a Options, cancel: &'a Cancel) -> Self {
        let model = &parsed.model;
        let Scratch { faces, groups, shapes, loops, room, found } = scratch;
        let tracer = Tracer::new(model, options.corner_angle_deg.to_radians(), shapes, loops, room);
        groups.clear(model);
        found.clear(model.faces.len());
        Self { parsed, options, cancel, faces, groups, tracer, found }
    }

    /// The outlines of a body, by their places among those found; one occurrence of it says where its faces are.
    fn find(&mut self, body: BodyId, places: PlacedFaces, placement: &Transform) -> Result<Range<usize>, Cancelled> {
        let Self { parsed, options, tracer, .. } = self;
        let model = &parsed.model;
        let tolerance = options.same_surface * (parsed.measures.tolerance.size() / placement.scale());
        self.faces.clear();
        self.faces.extend(model.faces_of(body).filter(|&f| places.find(f).is_some()));
        tracer.shapes.add(model, self.faces);
        tracer.shortest = 1e-3 * tolerance;
        self.groups.find(model, self.faces, options.maximal_faces.then_some(tolerance), self.cancel)?;
        let first = self.found.outlines.len();
        let oriented = model.bodies[body.index()].solid;
        for group in self.groups.iter() {
            self.cancel.check()?;
            tracer.trace(group);
            let loops = &*tracer.loops;
            let axis =
                if options.axes { axial::axis(parsed, places, group, loops, placement, tolerance) } else { None };
            boundary::add_outline(self.found, model, group, loops, axis, oriented);
        }
        Ok(first..self.found.outlines.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_are_found_where_some_are_left_out() {
        // Counted from face 3, face 5 would come third and face 4 second.
        let places = PlacedFaces(&[(3, 8), (5, 1), (6, 4)]);
        let found = [2, 3, 4, 5, 6, 7].map(|face| places.find(FaceId(face)).map(|place| place.0));
        assert_eq!(found, [None, Some(8), None, Some(1), Some(4), None]);
        assert_eq!(PlacedFaces(&[]).find(FaceId(0)), None);
    }
}
