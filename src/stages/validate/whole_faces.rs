//! Whole faces that an isometry maps onto whole faces: none of their samples needs to be asked.

use crate::brep::{Mesh, PlacedFaceId};
use crate::geometry::{Isometry, Point, PointGrid, Vector};

/// Looks at other points that finding the image of a point may take on average, before the face is asked by its samples.
const LOOKS: usize = 64;
/// Areas of images differ by this share at most ..
const AREA: f64 = 1e-3;
/// .. and the integrals of their normals by this share of the area: what bends the other way is no image.
const NORMALS: f64 = 1e-2;

/// What is needed to tell that one face is the image of another one: centroid, area, normals, and where the points of
/// its mesh are.
#[derive(Clone, Debug)]
pub struct WholeFaces {
    centroids: PointGrid,
    faces: Vec<Face>,
    points: Vec<Point>,
    /// How far images may be off, mm.
    radius: f64,
}

#[derive(Clone, Debug)]
struct Face {
    area: f64,
    /// Integral of the normals, mm^2.
    normals: Vector,
    /// In `points`.
    points: std::ops::Range<u32>,
}

impl WholeFaces {
    /// The faces of a mesh; images may be off by `radius`, mm.
    pub fn of(mesh: &Mesh, radius: f64) -> Self {
        let (mut faces, mut points) = (Vec::with_capacity(mesh.faces.len()), Vec::new());
        for (i, face) in mesh.faces.iter().enumerate() {
            let id = PlacedFaceId(i as u32);
            let normals = mesh.triangles_of(id).map(|t| mesh.doubled_normal(t)).sum::<Vector>() * 0.5;
            let (first, of_face) = (points.len() as u32, mesh.points_of(id));
            points.extend_from_slice(of_face);
            faces.push(Face { area: face.area, normals, points: first..points.len() as u32 });
        }
        let centroids = PointGrid::new(mesh.faces.iter().map(|f| f.centroid), 8.0 * radius);
        Self { centroids, faces, points, radius }
    }

    /// Whether the isometry maps a face onto one other; with `both`, that may be turned inside out.
    pub fn maps(&self, isometry: &Isometry, id: PlacedFaceId, both: bool) -> bool {
        let face = &self.faces[id.index()];
        let points = self.points_of(face);
        if points.is_empty() {
            return false;
        }
        let normals = isometry.rotation * face.normals;
        let centroid = isometry.apply(self.centroids.point(id.0));
        self.centroids.near(&centroid, self.radius).map(|b| &self.faces[b as usize]).any(|other| {
            (face.area - other.area).abs() <= AREA * face.area
                && other.points.len() == points.len()
                && ((normals - other.normals).norm() <= NORMALS * face.area
                    || (both && (normals + other.normals).norm() <= NORMALS * face.area))
                && self.meet(isometry, points, self.points_of(other))
        })
    }

    fn points_of(&self, face: &Face) -> &[Point] {
        &self.points[face.points.start as usize..face.points.end as usize]
    }

    /// Whether each point's image is near one of the others. Images mostly follow each other as the points do, or the
    /// other way around.
    fn meet(&self, isometry: &Isometry, points: &[Point], others: &[Point]) -> bool {
        let (limit, count) = (self.radius * self.radius, others.len());
        let (mut last, mut looks) = (0, LOOKS * count);
        points.iter().all(|p| {
            let image = isometry.apply(p);
            let near = |&i: &usize| (others[i] - image).norm_squared() <= limit;
            let neighbours = [(last + 1) % count, (last + count - 1) % count];
            let found = neighbours.into_iter().find(near).or_else(|| {
                looks = looks.saturating_sub(count);
                (0..if looks > 0 { count } else { 0 }).find(near)
            });
            last = found.unwrap_or(last);
            found.is_some()
        })
    }
}
