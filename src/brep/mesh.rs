//! The tessellated faces of all occurrences, in place.

use std::ops::Range;

use super::{FaceId, Model};
use crate::geometry::{Point, Vector};

/// Index into [`Mesh::faces`]: a face as it lies in the model, once for each occurrence.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PlacedFaceId(pub u32);

impl PlacedFaceId {
    /// Position in [`Mesh::faces`].
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A tessellated face in place.
#[derive(Clone, Debug)]
pub struct MeshFace {
    /// The face of the model.
    pub face: FaceId,
    /// Position in [`Model::occurrences`].
    pub occurrence: u32,
    /// Its points in [`Mesh::points`].
    pub points: Range<u32>,
    /// Its triangles in [`Mesh::triangles`].
    pub triangles: Range<u32>,
    /// Area of the trimmed surface, mm^2 (integrated on the surface, not summed over the triangles).
    pub area: f64,
    /// Area centroid of the trimmed surface.
    pub centroid: Point,
    /// What the face adds to the volume of its solid, mm^3: a third of the integral of (p - q) . n over the trimmed
    /// surface, with one point q for all faces of the occurrence. Summed over a closed shell q does not matter.
    pub flux: f64,
}

/// Triangles of all placed faces; counter-clockwise seen from the face normal's side (outside, for solids).
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// All points, mm.
    pub points: Vec<Point>,
    /// Corners of the triangles, as indices of points.
    pub triangles: Vec<[u32; 3]>,
    /// The faces in place, occurrence by occurrence.
    pub faces: Vec<MeshFace>,
}

impl Mesh {
    /// The corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [Point; 3] {
        self.triangles[triangle].map(|i| self.points[i as usize])
    }

    /// Normal times twice the area of a triangle.
    pub fn doubled_normal(&self, triangle: usize) -> Vector {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(&(c - a))
    }

    /// The points of a face.
    pub fn points_of(&self, id: PlacedFaceId) -> &[Point] {
        let range = &self.faces[id.index()].points;
        &self.points[range.start as usize..range.end as usize]
    }

    /// The indices of the triangles of a face.
    pub fn triangles_of(&self, id: PlacedFaceId) -> Range<usize> {
        let range = &self.faces[id.index()].triangles;
        range.start as usize..range.end as usize
    }

    /// The name of a face in reports: its entity number, after `occurrence/` where there are several occurrences.
    pub fn face_name(&self, model: &Model, id: PlacedFaceId) -> String {
        let placed = &self.faces[id.index()];
        let entity = model.faces[placed.face.index()].entity;
        match model.occurrences[placed.occurrence as usize].path.as_str() {
            "" => entity.to_string(),
            path => format!("{path}/{entity}"),
        }
    }
}
