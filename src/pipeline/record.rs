//! What is kept of a model that went through all stages.

use super::steps::{Described, Framed, Posed, Ranked};
use crate::brep::{Mesh, Model, PlacedFaceId};
use crate::geometry::{Point, Vector};
use crate::stages::merge::SymmetryPlane;
use crate::store::{AxisEvidence, EVIDENCE_KEPT, ModelRecord, PLANES_KEPT, PlaneEvidence, Pose, Summary};

/// The record of a described model.
pub fn record(described: &Described) -> ModelRecord {
    let frames = described.framed.frames.iter().zip(&described.descriptors);
    let poses = frames.map(|((method, frame), descriptor)| Pose::new(*method, frame, descriptor)).collect();
    ModelRecord { summary: summary(described), thumbnail: described.thumbnail.clone(), poses }
}

/// Numbers of solids, faces and edges as placed: what occurs twice counts twice.
pub struct Counts {
    /// Placed solids.
    pub solids: usize,
    /// Placed faces.
    pub faces: usize,
    /// Edges of placed bodies.
    pub edges: usize,
}

impl Counts {
    /// Counts the occurrences of a model.
    pub fn of(model: &Model) -> Self {
        let mut counts = Self { solids: 0, faces: 0, edges: 0 };
        let of_bodies: Vec<_> = (0..model.bodies.len()).map(|body| faces_and_edges(model, body)).collect();
        for occurrence in &model.occurrences {
            let (faces, edges) = of_bodies[occurrence.body.index()];
            counts.solids += usize::from(model.bodies[occurrence.body.index()].solid);
            counts.faces += faces;
            counts.edges += edges;
        }
        counts
    }
}

/// Faces and distinct edges of a body.
fn faces_and_edges(model: &Model, body: usize) -> (usize, usize) {
    let faces: Vec<_> = model.faces_of(crate::brep::BodyId(body as u32)).collect();
    let loops = faces.iter().flat_map(|face| &model.faces[face.index()].loops);
    let mut edges: Vec<_> = loops.flat_map(|face_loop| face_loop.uses.iter().map(|edge_use| edge_use.edge)).collect();
    edges.sort_unstable();
    edges.dedup();
    (faces.len(), edges.len())
}

fn summary(described: &Described) -> Summary {
    let Framed { ranked: Ranked { posed: Posed { parsed, .. }, symmetries }, canonical, frames } = &described.framed;
    let (model, measures) = (&parsed.model, &parsed.measures);
    let counts = Counts::of(model);
    let skipped = parsed.skipped.iter().take(EVIDENCE_KEPT);
    let hull = frames.iter().zip(&described.descriptors).map(|((method, _), d)| (*method, d.hull));
    Summary {
        schema: model.schema.clone(),
        unit_mm: model.unit_mm,
        solids: counts.solids,
        faces: counts.faces,
        edges: counts.edges,
        triangles: parsed.mesh.triangles.len(),
        area_mm2: measures.area,
        volume_mm3: measures.volume,
        centroid_mm: point(&measures.centroid),
        bbox_mm: bbox(&measures.bounds),
        skipped: skipped.map(|s| (s.entity, s.why.clone())).collect(),
        skipped_count: parsed.skipped.len(),
        warnings: parsed.warnings.iter().take(EVIDENCE_KEPT).cloned().collect(),
        warning_count: parsed.warnings.len(),
        label: symmetries.label,
        planes: symmetries.planes.iter().take(PLANES_KEPT).map(|p| plane(p, model, &parsed.mesh)).collect(),
        plane_count: symmetries.planes.len(),
        axes: symmetries
            .axes
            .iter()
            .map(|axis| AxisEvidence { point_mm: point(&axis.point), direction: vector(&axis.direction) })
            .collect(),
        source: canonical.source,
        areas_mm2: canonical.areas,
        axisymmetric: canonical.axisymmetric,
        hull: hull.collect(),
    }
}

fn plane(found: &SymmetryPlane, model: &Model, mesh: &Mesh) -> PlaneEvidence {
    let name = |id: PlacedFaceId| mesh.face_name(model, id);
    PlaneEvidence {
        normal: vector(&found.plane.normal),
        offset_mm: found.plane.offset,
        coverage: found.coverage,
        residual_mm: found.residual,
        pairs: found.pairs.iter().take(EVIDENCE_KEPT).map(|(a, b)| (name(*a), name(*b))).collect(),
        pair_count: found.pairs.len(),
        selfs: found.selfs.iter().take(EVIDENCE_KEPT).map(|a| name(*a)).collect(),
        self_count: found.selfs.len(),
    }
}

/// Minimum, then maximum.
pub fn bbox(bounds: &crate::geometry::Aabb) -> [f64; 6] {
    let ([a, b, c], [d, e, f]) = (point(&bounds.min), point(&bounds.max));
    [a, b, c, d, e, f]
}

/// The coordinates of a point.
pub fn point(p: &Point) -> [f64; 3] {
    [p.x, p.y, p.z]
}

/// The components of a vector.
pub fn vector(v: &Vector) -> [f64; 3] {
    [v.x, v.y, v.z]
}
