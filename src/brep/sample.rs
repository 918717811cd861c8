//! Area-uniform samples of the faces of a mesh.

use super::mesh::{Mesh, PlacedFaceId};
use crate::geometry::{Point, Vector};

/// A point on a face with the face normal there (unit, outward for solids).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Where it lies, mm.
    pub point: Point,
    /// The face normal there, unit.
    pub normal: Vector,
    /// The face it lies on.
    pub face: PlacedFaceId,
}

/// About `count` samples spread evenly over the area of the whole mesh: each triangle gets its share by a running
/// remainder and low-discrepancy points inside, so that the same mesh gives the same samples. To others of which there
/// are `before` these are new ones.
pub fn sample_mesh(mesh: &Mesh, count: usize, before: usize) -> Vec<Sample> {
    let total: f64 = (0..mesh.triangles.len()).map(|t| mesh.doubled_normal(t).norm()).sum();
    let ids = (0..mesh.faces.len()).map(|i| PlacedFaceId(i as u32));
    let mut spread = Spread { before, ..Spread::new(total / count.max(1) as f64) };
    spread.samples.reserve(count + 1);
    ids.for_each(|id| spread.add_face(mesh, id));
    spread.samples
}

/// About `count` samples of one face, spread evenly over its area.
pub fn sample_face(mesh: &Mesh, id: PlacedFaceId, count: usize) -> Vec<Sample> {
    let total: f64 = mesh.triangles_of(id).map(|t| mesh.doubled_normal(t).norm()).sum();
    let mut spread = Spread::new(total / count.max(1) as f64);
    spread.add_face(mesh, id);
    spread.samples
}

/// Deals samples out to triangles, one for every `step` of doubled area.
struct Spread {
    step: f64,
    owed: f64,
    /// Samples drawn earlier.
    before: usize,
    samples: Vec<Sample>,
}

impl Spread {
    fn new(step: f64) -> Self {
        Self { step, owed: 0.5, before: 0, samples: Vec::new() }
    }

    fn add_face(&mut self, mesh: &Mesh, id: PlacedFaceId) {
        for t in mesh.triangles_of(id) {
            let doubled = mesh.doubled_normal(t);
            let area = doubled.norm();
            if area <= 0.0 || !area.is_finite() {
                continue;
            }
            self.owed += area / self.step;
            let corners = mesh.corners(t);
            while self.owed >= 1.0 {
                self.owed -= 1.0;
                let point = pick(&corners, self.before + self.samples.len());
                self.samples.push(Sample { point, normal: doubled / area, face: id });
            }
        }
    }
}

/// The `index`-th point of the R2 low-discrepancy sequence (Roberts 2018), folded into the triangle.
fn pick([a, b, c]: &[Point; 3], index: usize) -> Point {
    let i = index as f64 + 1.0;
    let (mut s, mut t) = ((0.5 + i * 0.754_877_666_246_692_7).fract(), (0.5 + i * 0.569_840_290_998_053_3).fract());
    if s + t > 1.0 {
        (s, t) = (1.0 - s, 1.0 - t);
    }
    a + (b - a) * s + (c - a) * t
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::{FaceId, MeshFace};

    #[test]
    fn samples_follow_the_area_and_lie_inside() {
        let points = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, -1.0, 0.0]].map(Point::from).to_vec();
        let face = MeshFace {
            face: FaceId(0),
            occurrence: 0,
            points: 0..4,
            triangles: 0..2,
            area: 10.0,
            centroid: Point::origin(),
            flux: 0.0,
        };
        let mesh = Mesh { points, triangles: vec![[0, 1, 2], [0, 3, 1]], faces: vec![face] };
        let samples = sample_mesh(&mesh, 100, 0);
        assert_eq!(samples.len(), 100);
        assert_eq!(samples.iter().filter(|s| s.point.y > 0.0).count(), 80);
        assert!(samples.iter().all(|s| s.normal == Vector::z()));
        let more = sample_mesh(&mesh, 100, 100);
        assert!(more.iter().all(|s| samples.iter().all(|t| t.point != s.point)));
    }
}
