//! Faces in the coordinates of their bodies -> the mesh of all occurrences.

use super::face::FaceMesh;
use crate::brep::{EdgeId, FaceGeometry, Mesh, MeshFace, Model, Occurrence, Skipped, Surface};
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::{Point, Transform, Vector};

/// Samples of each edge for the size of the model.
const EDGE_SAMPLES: usize = 4;

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

/// Where a body lies in its own coordinates, roughly.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub centre: Point,
    /// Of a ball about the centre that holds the body.
    pub radius: f64,
}

impl Place {
    /// The ball about the middle between two points that are far apart: the same for a body wherever its coordinates
    /// come from, so that a model is meshed alike in every pose. `None` without points.
    fn of(points: &[Point]) -> Option<Self> {
        let first = points.first()?;
        let mean = points.iter().map(|p| (p - first) / points.len() as f64).sum::<Vector>() + first.coords;
        let from = farthest(points, &Point::from(mean))?;
        let to = farthest(points, &from)?;
        let centre = nalgebra::center(&from, &to);
        let radius = (farthest(points, &centre)? - centre).norm();
        Some(Self { centre, radius })
    }
}

fn farthest(points: &[Point], from: &Point) -> Option<Point> {
    points.iter().copied().max_by(|p, q| (p - from).norm_squared().total_cmp(&(q - from).norm_squared()))
}

/// Where each body lies, by points of its edges and the extent of surfaces without bounds.
pub(super) fn places(model: &Model, spans: &[Option<[f64; 2]>]) -> Vec<Option<Place>> {
    let place = |body: &crate::brep::Body| {
        let mut points = Vec::new();
        let faces = body.shells.iter().flat_map(|&s| &model.shells[s as usize].faces);
        for face in faces.map(|f| &model.faces[f.index()]) {
            match &face.geometry {
                FaceGeometry::Faceted(facets) => points.extend_from_slice(&facets.points),
                FaceGeometry::Trimmed { surface, .. } if face.loops.iter().all(|l| l.uses.is_empty()) => {
                    add_surface(&mut points, surface);
                }
                FaceGeometry::Trimmed { .. } => {
                    let edges = face.loops.iter().flat_map(|l| &l.uses).map(|u| u.edge);
                    edges.for_each(|e| add_edge(&mut points, model, e, spans[e.index()]));
                }
            }
        }
        points.retain(|p| p.iter().all(|c| c.is_finite()));
        Place::of(&points)
    };
    model.bodies.iter().map(place).collect()
}

fn add_edge(points: &mut Vec<Point>, model: &Model, id: EdgeId, span: Option<[f64; 2]>) {
    points.extend(model.ends(id));
    let (Some(curve), Some([from, to])) = (model.edges[id.index()].curve.as_deref(), span) else { return };
    if matches!(curve, crate::brep::Curve::Line { .. }) {
        return;
    }
    let period = curve.period();
    for i in 1..EDGE_SAMPLES {
        let t = from + (to - from) * i as f64 / EDGE_SAMPLES as f64;
        points.push(curve.point(curve.wrap(t, period)));
    }
}

/// The poles of a whole sphere or torus; a grid over the domain of others that have one.
fn add_surface(points: &mut Vec<Point>, surface: &Surface) {
    let (placement, reach) = match surface {
        Surface::Sphere { placement, radius } => (placement, *radius),
        Surface::Torus { placement, major, minor } => (placement, major + minor),
        other => {
            let [u0, u1, v0, v1] = other.domain();
            if [u0, u1, v0, v1].iter().all(|x| x.is_finite()) {
                let share = |a: f64, b: f64, i: usize| a + (b - a) * i as f64 / EDGE_SAMPLES as f64;
                let nodes = (0..=EDGE_SAMPLES).flat_map(|i| (0..=EDGE_SAMPLES).map(move |j| (i, j)));
                points.extend(nodes.map(|(i, j)| other.point(share(u0, u1, i), share(v0, v1, j))));
            }
            return;
        }
    };
    let poles = [placement.x, placement.y, placement.z].into_iter().flat_map(|axis| [axis * reach, -axis * reach]);
    points.extend(poles.map(|pole| placement.origin + pole));
}

/// The diameter of all occurrences, seen as balls, mm; 0 without any.
pub(super) fn model_size(model: &Model, places: &[Option<Place>]) -> f64 {
    let placed = |o: &Occurrence| {
        let own = places[o.body.index()]?;
        Some((o.placement.point(&own.centre), own.radius * o.placement.scale()))
    };
    let balls: Vec<_> = model.occurrences.iter().filter_map(placed).collect();
    let reach = |from: &Point| {
        let reaches = balls.iter().map(|(centre, radius)| (*centre, (centre - from).norm() + radius));
        reaches.max_by(|a, b| a.1.total_cmp(&b.1))
    };
    let Some((first, radius)) = balls.first() else { return 0.0 };
    if balls.len() == 1 {
        return 2.0 * radius;
    }
    let mean = balls.iter().map(|(c, _)| (c - first) / balls.len() as f64).sum::<Vector>() + first.coords;
    let mean = Point::from(mean);
    // As far as the ball that reaches farthest from the mean, on its far side.
    let Some((centre, far)) = reach(&mean) else { return 0.0 };
    let outward = (centre - mean).try_normalize(0.0).unwrap_or_else(Vector::zeros);
    reach(&(mean + outward * far)).map_or(0.0, |(_, size)| size)
}

/// The largest factor by which an occurrence enlarges its body.
pub(super) fn largest_scale(model: &Model) -> f64 {
    let scales = model.occurrences.iter().map(|o| o.placement.scale()).filter(|s| s.is_finite() && *s > 0.0);
    scales.fold(None, |best: Option<f64>, s| Some(best.map_or(s, |b| b.max(s)))).unwrap_or(1.0)
}
