//! Area-uniform samples of the faces of a mesh.

use std::ops::Range;

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
    let areas = doubled_areas(mesh, 0..mesh.triangles.len());
    let mut spread = Spread { before, ..Spread::new(&areas, count) };
    for id in (0..mesh.faces.len()).map(|i| PlacedFaceId(i as u32)) {
        spread.add_face(mesh, id, &areas[mesh.triangles_of(id)]);
    }
    spread.samples
}

/// About `count` samples of one face, spread evenly over its area.
pub fn sample_face(mesh: &Mesh, id: PlacedFaceId, count: usize) -> Vec<Sample> {
    let areas = doubled_areas(mesh, mesh.triangles_of(id));
    let mut spread = Spread::new(&areas, count);
    spread.add_face(mesh, id, &areas);
    spread.samples
}

/// Twice the areas of some triangles.
fn doubled_areas(mesh: &Mesh, triangles: Range<usize>) -> Vec<f64> {
    triangles.map(|t| mesh.doubled_normal(t).norm()).collect()
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
    /// About `count` samples for triangles of these doubled areas.
    fn new(areas: &[f64], count: usize) -> Self {
        let step = areas.iter().sum::<f64>() / count.max(1) as f64;
        Self { step, owed: 0.5, before: 0, samples: Vec::with_capacity(count + 1) }
    }

    /// `areas`: the doubled ones of the face's triangles.
    fn add_face(&mut self, mesh: &Mesh, id: PlacedFaceId, areas: &[f64]) {
        for (t, &area) in mesh.triangles_of(id).zip(areas) {
            if area <= 0.0 || !area.is_finite() {
                continue;
            }
            self.owed += area / self.step;
            if self.owed >= 1.0 {
                self.add_owed(mesh.corners(t), area, id);
            }
        }
    }

    fn add_owed(&mut self, [a, b, c]: [Point; 3], area: f64, face: PlacedFaceId) {
        let (ab, ac) = (b - a, c - a);
        let normal = ab.cross(&ac) / area;
        while self.owed >= 1.0 {
            self.owed -= 1.0;
            let [s, t] = pick(self.before + self.samples.len());
            self.samples.push(Sample { point: a + ab * s + ac * t, normal, face });
        }
    }
}

/// The `index`-th point of the R2 low-discrepancy sequence (Roberts 2018), folded into the triangle below s + t = 1.
fn pick(index: usize) -> [f64; 2] {
    let i = index as f64 + 1.0;
    let [s, t] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_3].map(|step| fraction(0.5 + i * step));
    if s + t > 1.0 { [1.0 - s, 1.0 - t] } else { [s, t] }
}

/// What `fract` says of a number that is neither negative nor huge, without the call of a function.
fn fraction(x: f64) -> f64 {
    x - (x as i64) as f64
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
