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

use crate::brep::{BodyId, PlacedFaceId};
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::{Axis, Point, Transform, Vector};
use crate::stages::parse::Parsed;
use crate::stages::{ModelError, Stage};
use boundary::Tracer;
use edges::EdgeShapes;

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
    /// The faces it is made of, in growing order.
    pub faces: Vec<PlacedFaceId>,
    /// Corners of the outer loop; with the face normal up, the inside is on the left.
    pub corners: Vec<Point>,
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

/// Finds the outlines of all placed faces.
///
/// # Errors
/// Only when cancelled.
pub fn corner_filter(parsed: &Parsed, options: &Options, cancel: &Cancel) -> Result<Vec<Outline>, ModelError> {
    let model = &parsed.model;
    let placed = placed_faces(parsed);
    let mut of_body: Vec<Option<Vec<LocalOutline>>> = vec![None; model.bodies.len()];
    let mut outlines = Vec::with_capacity(parsed.mesh.faces.len());
    let mut uses = vec![0u32; model.bodies.len()];
    model.occurrences.iter().for_each(|occurrence| uses[occurrence.body.index()] += 1);
    let mut shapes = EdgeShapes::new(model);
    for (occurrence, faces) in model.occurrences.iter().zip(&placed) {
        let cancelled = |c| ModelError::cancelled(Stage::CornerFilter, c);
        cancel.check().map_err(cancelled)?;
        let local = match &mut of_body[occurrence.body.index()] {
            Some(local) => local,
            none => {
                let placement = &occurrence.placement;
                let found = body_outlines(parsed, occurrence.body, faces, placement, &mut shapes, options, cancel);
                none.insert(found.map_err(cancelled)?)
            }
        };
        let place = Place::new(&occurrence.placement);
        let is_shared = uses[occurrence.body.index()] > 1;
        let placed = |(number, outline): (u32, &LocalOutline)| {
            outline.placed(parsed, faces, &place, is_shared.then_some((occurrence.body, number)))
        };
        outlines.extend((0..).zip(local.iter()).filter_map(placed));
    }
    Ok(outlines)
}

/// Where the faces of each occurrence are in the mesh, as pairs (face, place) sorted by face.
fn placed_faces(parsed: &Parsed) -> Vec<PlacedFaces> {
    let mut placed = vec![PlacedFaces::default(); parsed.model.occurrences.len()];
    for (i, face) in parsed.mesh.faces.iter().enumerate() {
        placed[face.occurrence as usize].0.push((face.face.0, i as u32));
    }
    placed.iter_mut().for_each(|faces| faces.0.sort_unstable());
    placed
}

/// The faces of one occurrence that have a mesh.
#[derive(Clone, Debug, Default)]
struct PlacedFaces(Vec<(u32, u32)>);

impl PlacedFaces {
    fn find(&self, face: crate::brep::FaceId) -> Option<PlacedFaceId> {
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

/// An outline in the coordinates of its body, the same for all occurrences.
#[derive(Clone, Debug)]
struct LocalOutline {
    faces: Vec<crate::brep::FaceId>,
    corners: Vec<Point>,
    perimeter: f64,
    inner: Vec<InnerLoop>,
    /// Half the sum of p x q along all loops: the vector area they enclose if they run as they should.
    vector_area: Vector,
    axis: Option<Axis>,
    oriented: bool,
}

impl LocalOutline {
    /// The outline in its occurrence; `None` where the mesh has none of its faces. Where several occurrences share it,
    /// `shared` names its body and its number there.
    fn placed(
        &self,
        parsed: &Parsed,
        places: &PlacedFaces,
        place: &Place,
        shared: Option<(BodyId, u32)>,
    ) -> Option<Outline> {
        let placement = place.placement;
        let mut faces: Vec<_> = self.faces.iter().filter_map(|&f| places.find(f)).collect();
        faces.sort_unstable();
        let area: f64 = faces.iter().map(|f| parsed.mesh.faces[f.index()].area).sum();
        if !(area > 0.0 && area.is_finite()) {
            return None;
        }
        let moment: Vector =
            faces.iter().map(|f| &parsed.mesh.faces[f.index()]).map(|f| f.centroid.coords * f.area).sum();
        let scale = place.scale;
        let mut corners: Vec<_> = self.corners.iter().map(|p| placement.point(p)).collect();
        let backwards = self.runs_backwards(parsed, &faces, place);
        if backwards {
            corners.reverse();
        }
        let inner =
            self.inner.iter().map(|l| InnerLoop { centroid: placement.point(&l.centroid), length: l.length * scale });
        let axis =
            self.axis.map(|a| Axis { point: placement.point(&a.point), direction: placement.direction(&a.direction) });
        Some(Outline {
            corners,
            perimeter: self.perimeter * scale,
            inner: inner.collect(),
            area,
            centroid: Point::from(moment / area),
            axis,
            oriented: self.oriented,
            shape: shared.map(|(body, number)| Shape { body, number, backwards, scale: scale.to_bits() }),
            faces,
        })
    }

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

/// The outlines of a body.
fn body_outlines(
    parsed: &Parsed,
    body: BodyId,
    places: &PlacedFaces,
    placement: &Transform,
    shapes: &mut EdgeShapes,
    options: &Options,
    cancel: &Cancel,
) -> Result<Vec<LocalOutline>, Cancelled> {
    let model = &parsed.model;
    let size = parsed.measures.tolerance.size() / placement.scale();
    let tolerance = options.same_surface * size;
    let faces: Vec<_> = model.faces_of(body).filter(|&f| places.find(f).is_some()).collect();
    shapes.add(model, &faces);
    let mut tracer = Tracer::new(model, shapes, 1e-3 * tolerance, options.corner_angle_deg.to_radians());
    let groups = maximal::groups(model, &faces, options.maximal_faces.then_some(tolerance), cancel)?;
    let oriented = model.bodies[body.index()].solid;
    let outline = |group: Vec<crate::brep::FaceId>| {
        cancel.check()?;
        let loops = tracer.loops(&group);
        let axis = if options.axes { axial::axis(parsed, places, &group, &loops, placement, tolerance) } else { None };
        Ok(boundary::outline(model, group, loops, axis, oriented))
    };
    groups.into_iter().map(outline).collect()
}
