//! The triangles of each placed body, moved, with normals.

use crate::brep::{MeshFace, PlacedFaceId};
use crate::geometry::{Isometry, Point, Vector};
use crate::stages::parse::Parsed;

/// A placed body.
pub(super) struct Part {
    /// The entity number of the body, after `occurrence/` where it is part of an assembly.
    pub name: String,
    /// mm.
    pub points: Vec<Point>,
    /// One for each point, of length 1 (zero where no triangle has an area).
    pub normals: Vec<Vector>,
    /// Counter-clockwise seen from outside; indices of points.
    pub triangles: Vec<[u32; 3]>,
    /// Each face's name and the number of its triangles, in the order of the triangles.
    pub faces: Vec<(String, usize)>,
}

/// The bodies of a model after a motion, in the order of their occurrences.
pub(super) fn parts(parsed: &Parsed, by: &Isometry) -> Vec<Part> {
    let of_one = parsed.mesh.faces.chunk_by(|a, b| a.occurrence == b.occurrence);
    let mut first = 0;
    of_one
        .map(|faces| {
            let part = part(parsed, by, first, faces);
            first += faces.len();
            part
        })
        .collect()
}

fn part(parsed: &Parsed, by: &Isometry, first: usize, faces: &[MeshFace]) -> Part {
    let (model, mesh) = (&parsed.model, &parsed.mesh);
    let occurrence = &model.occurrences[faces[0].occurrence as usize];
    let body = model.bodies[occurrence.body.index()].entity;
    let name = if occurrence.path.is_empty() { body.to_string() } else { format!("{}/{body}", occurrence.path) };
    let mut part = Part {
        name,
        points: Vec::new(),
        normals: Vec::new(),
        triangles: Vec::new(),
        faces: Vec::with_capacity(faces.len()),
    };
    for (i, face) in faces.iter().enumerate() {
        let id = PlacedFaceId((first + i) as u32);
        let shift = part.points.len() as u32;
        part.points.extend(mesh.points_of(id).iter().map(|p| by.apply(p)));
        let local = |corner: u32| corner - face.points.start + shift;
        part.triangles.extend(mesh.triangles_of(id).map(|t| mesh.triangles[t].map(local)));
        part.faces.push((mesh.face_name(model, id), face.triangles.len()));
    }
    part.normals = normals(&part.points, &part.triangles);
    part
}

/// The mean of the normals of the triangles that meet in a point, by area: points belong to one face, so that edges
/// stay sharp.
fn normals(points: &[Point], triangles: &[[u32; 3]]) -> Vec<Vector> {
    let mut sums = vec![Vector::zeros(); points.len()];
    for triangle in triangles {
        let normal = doubled_normal(points, triangle);
        triangle.iter().for_each(|&i| sums[i as usize] += normal);
    }
    sums.iter().map(|sum| sum.try_normalize(0.0).unwrap_or_default()).collect()
}

/// Normal times twice the area of a triangle.
pub(super) fn doubled_normal(points: &[Point], triangle: &[u32; 3]) -> Vector {
    let [a, b, c] = triangle.map(|i| points[i as usize]);
    (b - a).cross(&(c - a))
}

/// The coordinates as stored in files, in units of `unit` mm.
pub(super) fn single(v: &Vector, unit: f64) -> [f32; 3] {
    [v.x, v.y, v.z].map(|c| (c / unit) as f32)
}
