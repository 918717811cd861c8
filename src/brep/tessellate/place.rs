//! Faces in the coordinates of their bodies -> the mesh of all occurrences.

use super::face::FaceMesh;
use crate::brep::{EdgeId, FaceGeometry, Mesh, MeshFace, Model, Occurrence, Skipped, Surface};
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::{Aabb, Point, Transform, Vector};

/// Samples of each edge for the size of the model.
const BOX_SAMPLES: usize = 4;

/// A mesh in the making.
#[derive(Default)]
pub(super) struct Placed {
    mesh: Mesh,
    skipped: Vec<Skipped>,
    warnings: Vec<String>,
    /// Faces for which there was no room.
    left_out: usize,
}

impl Placed {
    pub fn finish(mut self) -> (Mesh, Vec<Skipped>, Vec<String>) {
        if self.left_out > 1 {
            self.warnings.push(format!("{} faces in place were left out: too many triangles", self.left_out));
        }
        (self.mesh, self.skipped, self.warnings)
    }

    /// A face for which there is no room; only the first one is named, as occurrences multiply them.
    fn leave_out(&mut self, entity: u64, max_triangles: usize) {
        if self.left_out == 0 {
            let why = format!("more than {max_triangles} triangles in the model");
            self.skipped.push(Skipped { entity, why });
        }
        self.left_out += 1;
    }

    fn add(&mut self, occurrence: u32, placement: &Transform, id: crate::brep::FaceId, face: &FaceMesh) {
        let mesh = &mut self.mesh;
        let (first_point, first_triangle) = (mesh.points.len() as u32, mesh.triangles.len() as u32);
        mesh.points.extend(face.points.iter().map(|p| placement.point(p)));
        let turn = placement.mirrors();
        mesh.triangles.extend(face.triangles.iter().map(|t| {
            let [a, b, c] = t.map(|i| i + first_point);
            if turn { [a, c, b] } else { [a, b, c] }
        }));
        let scale = placement.scale();
        mesh.faces.push(MeshFace {
            face: id,
            occurrence,
            points: first_point..mesh.points.len() as u32,
            triangles: first_triangle..mesh.triangles.len() as u32,
            area: face.integrals.area * scale * scale,
            centroid: placement.point(&face.integrals.centroid(&face.reference)),
            flux: face.integrals.flux * scale.powi(3),
        });
    }
}

/// Triangles of all occurrences together; faces that were not tessellated any more count as the others do.
pub(super) fn triangles(model: &Model, faces: &[Result<FaceMesh, String>]) -> usize {
    let of_body = |o: &Occurrence| model.faces_of(o.body).filter_map(|id| faces.get(id.index())?.as_ref().ok());
    let placed: usize = model.occurrences.iter().flat_map(of_body).map(|face| face.triangles.len()).sum();
    (placed as f64 * model.faces.len() as f64 / faces.len().max(1) as f64) as usize
}

/// Puts every face where each occurrence of its body has it.
pub(super) fn place(
    model: &Model,
    faces: Vec<Result<FaceMesh, String>>,
    max_triangles: usize,
    cancel: &Cancel,
) -> Result<Placed, Cancelled> {
    let mut placed = Placed::default();
    for (index, occurrence) in model.occurrences.iter().enumerate() {
        cancel.check()?;
        for id in model.faces_of(occurrence.body) {
            match faces.get(id.index()) {
                Some(Ok(face)) if placed.mesh.triangles.len() + face.triangles.len() <= max_triangles => {
                    placed.add(index as u32, &occurrence.placement, id, face);
                }
                Some(Err(_)) => {}
                _ => placed.leave_out(model.faces[id.index()].entity, max_triangles),
            }
        }
    }
    for (face, result) in model.faces.iter().zip(faces) {
        match result {
            Ok(mesh) => placed.warnings.extend(mesh.warning),
            Err(why) => placed.skipped.push(Skipped { entity: face.entity, why }),
        }
    }
    Ok(placed)
}

/// A rough box of each body in its own coordinates: points of its edges and the extent of surfaces without bounds.
pub(super) fn boxes(model: &Model, spans: &[Option<[f64; 2]>]) -> Vec<Aabb> {
    let body_box = |body: &crate::brep::Body| {
        let mut aabb = Aabb::default();
        let faces = body.shells.iter().flat_map(|&s| &model.shells[s as usize].faces);
        for face in faces.map(|f| &model.faces[f.index()]) {
            match &face.geometry {
                FaceGeometry::Faceted(facets) => facets.points.iter().for_each(|p| aabb.add(p)),
                FaceGeometry::Trimmed { surface, .. } if face.loops.iter().all(|l| l.uses.is_empty()) => {
                    add_surface(&mut aabb, surface);
                }
                FaceGeometry::Trimmed { .. } => {
                    let edges = face.loops.iter().flat_map(|l| &l.uses).map(|u| u.edge);
                    edges.for_each(|e| add_edge(&mut aabb, model, e, spans[e.index()]));
                }
            }
        }
        aabb
    };
    model.bodies.iter().map(body_box).collect()
}

fn add_edge(aabb: &mut Aabb, model: &Model, id: EdgeId, span: Option<[f64; 2]>) {
    model.ends(id).iter().for_each(|p| aabb.add(p));
    let (Some(curve), Some([from, to])) = (model.edges[id.index()].curve.as_deref(), span) else { return };
    if matches!(curve, crate::brep::Curve::Line { .. }) {
        return;
    }
    let period = curve.period();
    for i in 1..BOX_SAMPLES {
        let t = from + (to - from) * i as f64 / BOX_SAMPLES as f64;
        aabb.add(&curve.point(curve.wrap(t, period)));
    }
}

/// Corners of a box around a whole sphere or torus; the corners of the domain for others that have one.
fn add_surface(aabb: &mut Aabb, surface: &Surface) {
    let (centre, reach) = match surface {
        Surface::Sphere { placement, radius } => (placement.origin, *radius),
        Surface::Torus { placement, major, minor } => (placement.origin, major + minor),
        other => {
            let [u0, u1, v0, v1] = other.domain();
            if [u0, u1, v0, v1].iter().all(|x| x.is_finite()) {
                let share = |a: f64, b: f64, i: usize| a + (b - a) * i as f64 / BOX_SAMPLES as f64;
                let nodes = (0..=BOX_SAMPLES).flat_map(|i| (0..=BOX_SAMPLES).map(move |j| (i, j)));
                nodes.for_each(|(i, j)| aabb.add(&other.point(share(u0, u1, i), share(v0, v1, j))));
            }
            return;
        }
    };
    aabb.add(&(centre + Vector::repeat(reach)));
    aabb.add(&(centre - Vector::repeat(reach)));
}

/// The box of all occurrences, from the corners of the bodies' boxes.
pub(super) fn model_box(model: &Model, boxes: &[Aabb]) -> Aabb {
    let mut all = Aabb::default();
    for Occurrence { body, placement, .. } in &model.occurrences {
        let aabb = &boxes[body.index()];
        if aabb.is_empty() {
            continue;
        }
        for corner in 0..8 {
            let side = |axis: usize| if corner >> axis & 1 == 0 { aabb.min[axis] } else { aabb.max[axis] };
            all.add(&placement.point(&Point::new(side(0), side(1), side(2))));
        }
    }
    all
}

/// The largest factor by which an occurrence enlarges its body.
pub(super) fn largest_scale(model: &Model) -> f64 {
    let scales = model.occurrences.iter().map(|o| o.placement.scale()).filter(|s| s.is_finite() && *s > 0.0);
    scales.fold(None, |best: Option<f64>, s| Some(best.map_or(s, |b| b.max(s)))).unwrap_or(1.0)
}
