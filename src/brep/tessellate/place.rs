//! Faces in the coordinates of their bodies -> the mesh of all occurrences.

use super::face::{FaceMesh, Meshes};
use crate::brep::{BodyId, EdgeId, FaceGeometry, FaceId, Mesh, MeshFace, Model, Occurrence, Skipped, Surface};
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

    fn add(
        &mut self,
        occurrence: u32,
        placement: &Transform,
        scale: f64,
        id: FaceId,
        meshes: &Meshes,
        face: &FaceMesh,
    ) {
        let mesh = &mut self.mesh;
        let (first_point, first_triangle) = (mesh.points.len() as u32, mesh.triangles.len() as u32);
        mesh.points.extend(meshes.points[face.points.clone()].iter().map(|p| placement.point(p)));
        let turn = placement.mirrors();
        mesh.triangles.extend(meshes.triangles[face.triangles.clone()].iter().map(|t| {
            let [a, b, c] = t.map(|i| i + first_point);
            if turn { [a, c, b] } else { [a, b, c] }
        }));
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
    let placed = in_all(model, faces, |face| face.triangles.len());
    (placed as f64 * model.faces.len() as f64 / faces.len().max(1) as f64) as usize
}

/// The sizes of the faces of all occurrences together, each body's summed once: it may be at very many places.
fn in_all(model: &Model, faces: &[Result<FaceMesh, String>], size: fn(&FaceMesh) -> usize) -> usize {
    let of_face = |id: FaceId| Some(size(faces.get(id.index())?.as_ref().ok()?));
    let of_body = |body: usize| model.faces_of(BodyId(body as u32)).filter_map(of_face).sum();
    let of_bodies: Vec<usize> = (0..model.bodies.len()).map(of_body).collect();
    model.occurrences.iter().fold(0, |sum, o| sum.saturating_add(of_bodies[o.body.index()]))
}

/// Puts every face where each occurrence of its body has it.
pub(super) fn place(
    model: &Model,
    meshes: &mut Meshes,
    max_triangles: usize,
    cancel: &Cancel,
) -> Result<Placed, Cancelled> {
    let mut placed = Placed::default();
    let sizes = |size| in_all(model, &meshes.faces, size).min(max_triangles);
    placed.mesh.points.reserve_exact(sizes(|face| face.points.len()));
    placed.mesh.triangles.reserve_exact(sizes(|face| face.triangles.len()));
    for (index, occurrence) in model.occurrences.iter().enumerate() {
        cancel.check()?;
        let scale = occurrence.placement.scale();
        for id in model.faces_of(occurrence.body) {
            match meshes.faces.get(id.index()) {
                Some(Ok(face)) if placed.mesh.triangles.len() + face.triangles.len() <= max_triangles => {
                    placed.add(index as u32, &occurrence.placement, scale, id, meshes, face);
                }
                Some(Err(_)) => {}
                _ => placed.leave_out(model.faces[id.index()].entity, max_triangles),
            }
        }
    }
    for (face, result) in model.faces.iter().zip(meshes.faces.drain(..)) {
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
    /// The ball about the mean of weighted points: the same for a body whatever its coordinates, without a choice that
    /// rounding decides, so that a model is meshed alike in every pose. `None` without points.
    fn of(points: &[Weighted]) -> Option<Self> {
        let (first, _) = points.first()?;
        let total: f64 = points.iter().map(|(_, weight)| weight).sum();
        let share = |weight: f64| if total > 0.0 { weight / total } else { 1.0 / points.len() as f64 };
        let centre = first + points.iter().map(|(p, weight)| (p - first) * share(*weight)).sum::<Vector>();
        let radius = points.iter().map(|(p, _)| (p - centre).norm_squared()).fold(0.0, f64::max).sqrt();
        Some(Self { centre, radius })
    }
}

/// Where each body lies, by points of its edges and the extent of surfaces without bounds.
pub(super) fn places(model: &Model, spans: &[Option<[f64; 2]>]) -> Vec<Option<Place>> {
    let chains: Vec<_> = (0..model.edges.len()).map(|e| chain(model, EdgeId(e as u32), spans[e])).collect();
    let edges_are_finite = chains.iter().flatten().all(is_finite);
    // Most edges have two faces.
    let mut points = Vec::with_capacity(2 * chains.as_flattened().len());
    let mut place = |body: &crate::brep::Body| {
        points.clear();
        let faces = body.shells.iter().flat_map(|&s| &model.shells[s as usize].faces);
        for face in faces.map(|f| &model.faces[f.index()]) {
            match &face.geometry {
                FaceGeometry::Faceted(facets) => points.extend(weights(&facets.points).filter(is_finite)),
                FaceGeometry::Trimmed { surface, .. } if face.loops.iter().all(|l| l.uses.is_empty()) => {
                    add_surface(&mut points, &model.surfaces[surface.index()]);
                }
                FaceGeometry::Trimmed { .. } => {
                    let edges = face.loops.iter().flat_map(|l| &l.uses).map(|u| u.edge);
                    edges.for_each(|e| points.extend_from_slice(&chains[e.index()]));
                }
            }
        }
        if !edges_are_finite {
            points.retain(is_finite);
        }
        Place::of(&points)
    };
    model.bodies.iter().map(&mut place).collect()
}

/// A point with its weight.
type Weighted = (Point, f64);

/// Points, each with the distance from the one before it as its weight: many on a short edge count little.
fn weights(chain: &[Point]) -> impl Iterator<Item = Weighted> + '_ {
    (0..chain.len()).map(|i| weighted(chain, i))
}

fn weighted(chain: &[Point], i: usize) -> Weighted {
    (chain[i], (chain[i] - chain[i.saturating_sub(1)]).norm())
}

fn is_finite((p, weight): &Weighted) -> bool {
    p.iter().chain([weight]).all(|c| c.is_finite())
}

/// Points of an edge with their weights.
fn chain(model: &Model, id: EdgeId, span: Option<[f64; 2]>) -> [Weighted; EDGE_SAMPLES + 1] {
    let [start, end] = model.ends(id);
    let mut points = [end; EDGE_SAMPLES + 1];
    points[0] = start;
    let inner = (1..).map(|i| f64::from(i) / EDGE_SAMPLES as f64).zip(&mut points[1..EDGE_SAMPLES]);
    match model.edges[id.index()].curve.as_deref().zip(span) {
        Some((curve, [from, to])) => {
            let period = curve.period();
            inner.for_each(|(share, p)| *p = curve.point(curve.wrap(from + (to - from) * share, period)));
        }
        None => inner.for_each(|(share, p)| *p = start + (end - start) * share),
    }
    std::array::from_fn(|i| weighted(&points, i))
}

/// The poles of a whole sphere or torus; a grid over the domain of others that have one.
fn add_surface(points: &mut Vec<Weighted>, surface: &Surface) {
    let (placement, reach) = match surface {
        Surface::Sphere { placement, radius } => (placement, *radius),
        Surface::Torus { placement, major, minor } => (placement, major + minor),
        other => {
            let [u0, u1, v0, v1] = other.domain();
            if [u0, u1, v0, v1].iter().all(|x| x.is_finite()) {
                let share = |a: f64, b: f64, i: usize| a + (b - a) * i as f64 / EDGE_SAMPLES as f64;
                let nodes = (0..=EDGE_SAMPLES).flat_map(|i| (0..=EDGE_SAMPLES).map(move |j| (i, j)));
                let grid: Vec<_> = nodes.map(|(i, j)| other.point(share(u0, u1, i), share(v0, v1, j))).collect();
                points.extend(weights(&grid).filter(is_finite));
            }
            return;
        }
    };
    let poles = [placement.x, placement.y, placement.z].into_iter().flat_map(|axis| [axis * reach, -axis * reach]);
    points.extend(poles.map(|pole| (placement.origin + pole, reach)).filter(is_finite));
}

/// The diameter of a ball that holds all occurrences, seen as balls, mm; 0 without any.
pub(super) fn model_size(model: &Model, places: &[Option<Place>]) -> f64 {
    let placed = |o: &Occurrence| {
        let own = places[o.body.index()]?;
        Some((o.placement.point(&own.centre), own.radius * o.placement.scale()))
    };
    let balls: Vec<Weighted> = model.occurrences.iter().filter_map(placed).collect();
    let Some(all) = Place::of(&balls) else { return 0.0 };
    2.0 * balls.iter().map(|(centre, radius)| (centre - all.centre).norm() + radius).fold(0.0, f64::max)
}

/// The largest factor by which an occurrence enlarges its body.
pub(super) fn largest_scale(model: &Model) -> f64 {
    let scales = model.occurrences.iter().map(|o| o.placement.scale()).filter(|s| s.is_finite() && *s > 0.0);
    scales.fold(None, |best: Option<f64>, s| Some(best.map_or(s, |b| b.max(s)))).unwrap_or(1.0)
}
