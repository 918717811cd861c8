//! Plane convex faces of four corners: most faces of most parts. The distance to a convex face grows in every direction
//! away from it (it is a convex function), so what is near one at its corners is near it everywhere in between.

use crate::brep::{Mesh, PlacedFaceId};
use crate::geometry::Point;
use crate::geometry::bvh::nearest_on_triangle;

/// How far a corner may be off the plane, as a share of the face's size: rounding.
const FLAT: f64 = 1e-9;

/// The faces of a mesh that are plane convex quadrilaterals.
#[derive(Clone, Debug)]
pub struct Quads {
    /// By face: its position in `corners`, or `NONE`.
    numbers: Vec<u32>,
    /// In order around the face, so that the first and the third are ends of one diagonal.
    corners: Vec<[Point; 4]>,
}

const NONE: u32 = u32::MAX;

impl Quads {
    pub fn of(mesh: &Mesh) -> Self {
        let mut quads = Self { numbers: Vec::with_capacity(mesh.faces.len()), corners: Vec::new() };
        for face in 0..mesh.faces.len() as u32 {
            let corners = convex_quad(mesh, PlacedFaceId(face));
            quads.numbers.push(if corners.is_some() { quads.corners.len() as u32 } else { NONE });
            quads.corners.extend(corners);
        }
        quads
    }

    /// The corners of a face, if it is one.
    pub fn get(&self, face: PlacedFaceId) -> Option<&[Point; 4]> {
        self.corners.get(self.numbers[face.index()] as usize)
    }
}

/// Whether a point is within `radius` of a quadrilateral.
pub fn is_near([a, b, c, d]: &[Point; 4], p: &Point, radius: f64) -> bool {
    let near = |triangle: [Point; 3]| (nearest_on_triangle(p, &triangle) - p).norm_squared() <= radius * radius;
    near([*a, *b, *c]) || near([*a, *c, *d])
}

/// The corners of a face in order around it, if it is two triangles of one plane that make a convex quadrilateral.
fn convex_quad(mesh: &Mesh, face: PlacedFaceId) -> Option<[Point; 4]> {
    let triangles = mesh.triangles_of(face);
    if triangles.len() != 2 {
        return None;
    }
    let (first, second) = (mesh.triangles[triangles.start], mesh.triangles[triangles.start + 1]);
    let alone = (0..3).find(|&i| !second.contains(&first[i]))?;
    let opposite = second.iter().position(|i| !first.contains(i))?;
    let around = [first[alone], first[(alone + 1) % 3], second[opposite], first[(alone + 2) % 3]];
    let corners = around.map(|i| mesh.points[i as usize]);
    let [a, b, c, d] = &corners;
    let normal = (b - a).cross(&(d - a)).try_normalize(0.0)?;
    let flat = normal.dot(&(c - a)).abs() <= FLAT * (c - a).norm();
    let turns_left = |from: &Point, over: &Point, to: &Point| (over - from).cross(&(to - over)).dot(&normal) > 0.0;
    let convex = turns_left(a, b, c) && turns_left(b, c, d) && turns_left(c, d, a);
    (flat && convex).then_some(corners)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::{FaceId, MeshFace};

    /// A face of the triangles (0, 1, 2) and (0, 2, 3).
    fn quads(points: [[f64; 3]; 4]) -> Quads {
        let face = MeshFace {
            face: FaceId(0),
            occurrence: 0,
            points: 0..4,
            triangles: 0..2,
            area: 0.0,
            centroid: Point::origin(),
            flux: 0.0,
        };
        let points = points.map(Point::from).to_vec();
        Quads::of(&Mesh { points, triangles: vec![[0, 1, 2], [0, 2, 3]], faces: vec![face] })
    }

    #[test]
    fn a_rectangle_is_one_and_what_is_bent_or_dented_is_not() {
        let face = PlacedFaceId(0);
        let found = quads([[0.0, 0.0, 1.0], [3.0, 0.0, 1.0], [3.0, 2.0, 1.0], [0.0, 2.0, 1.0]]);
        let corners = found.get(face).unwrap();
        assert!(is_near(corners, &Point::new(2.9, 0.1, 1.1), 0.2) && is_near(corners, &Point::new(0.1, 1.9, 1.1), 0.2));
        assert!(!is_near(corners, &Point::new(3.3, 1.0, 1.0), 0.2));
        assert!(quads([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 2.0, 0.1], [0.0, 2.0, 0.0]]).get(face).is_none());
        assert!(quads([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 3.0, 0.0]]).get(face).is_none());
        assert!(quads([[1.0, 1.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 0.0], [3.0, 0.0, 0.0]]).get(face).is_none());
    }
}
