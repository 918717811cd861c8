//! Samples of faces: drawn once for the face of a body, and placed wherever the body is.

use std::ops::Range;

use rustc_hash::FxHashMap;

use crate::brep::sample::{Sample, sample_face};
use crate::brep::{FaceId, Mesh, Model, PlacedFaceId};
use crate::geometry::{Point, Transform, Vector};

/// Samples in the first place of their face; the same ones serve all its other places.
pub struct Drawn<'a> {
    model: &'a Model,
    mesh: &'a Mesh,
    /// Of each face of the model, its first place in the mesh.
    first: Vec<PlacedFaceId>,
    /// Where the samples of a face are, by the face and how many were wanted.
    known: FxHashMap<(FaceId, usize), Range<usize>>,
    samples: Vec<Sample>,
}

/// Samples of a face in one of its places.
pub struct Placed {
    /// Among those drawn.
    samples: Range<usize>,
    /// From the face's first place to this one.
    moved: Option<Transform>,
}

impl Placed {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.samples.len()
    }
}

impl<'a> Drawn<'a> {
    /// None yet.
    pub fn new(model: &'a Model, mesh: &'a Mesh) -> Self {
        let mut first = vec![PlacedFaceId(0); model.faces.len()];
        for (place, face) in (0..mesh.faces.len() as u32).zip(&mesh.faces).rev() {
            first[face.face.index()] = PlacedFaceId(place);
        }
        Self { model, mesh, first, known: FxHashMap::default(), samples: Vec::new() }
    }

    /// About `count` samples of a face in place.
    pub fn of(&mut self, place: PlacedFaceId, count: usize) -> Placed {
        let face = self.mesh.faces[place.index()].face;
        let first = self.first[face.index()];
        let all = &mut self.samples;
        let draw = || {
            let before = all.len();
            all.extend(sample_face(self.mesh, first, count));
            before..all.len()
        };
        let samples = self.known.entry((face, count)).or_insert_with(draw).clone();
        Placed { samples, moved: self.between(first, place) }
    }

    /// The points with the normals there.
    pub fn iter(&self, placed: &Placed) -> impl Iterator<Item = (Point, Vector)> {
        self.samples[placed.samples.clone()].iter().map(|s| match &placed.moved {
            Some(moved) => (moved.point(&s.point), moved.direction(&s.normal)),
            None => (s.point, s.normal),
        })
    }

    /// What moves a face from one place to another one; `None` where it is the same.
    fn between(&self, from: PlacedFaceId, to: PlacedFaceId) -> Option<Transform> {
        let placement = |f: PlacedFaceId| {
            let occurrence = self.mesh.faces[f.index()].occurrence;
            &self.model.occurrences[occurrence as usize].placement
        };
        // No face has an area where its placement is singular.
        (from != to).then(|| placement(from).inverse()).flatten().map(|back| placement(to).after(&back))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::bvh::nearest_on_triangle;
    use crate::stages::fixture::{add_copy, prism, solid};

    impl Drawn<'_> {
        /// How many times samples were drawn, and how many there are.
        pub fn counts(&self) -> (usize, usize) {
            (self.known.len(), self.samples.len())
        }
    }

    #[test]
    fn samples_are_drawn_once_and_their_images_lie_on_the_face_wherever_it_is() {
        let mut parsed = solid(&prism(&[[0.0, 0.0], [4.0, 0.0], [1.0, 3.0]], 2.0), &Transform::identity());
        let (x, y, z) = (Vector::x(), Vector::y(), Vector::z());
        let places = [[y, -x, z], [x, -y, z], [-2.0 * z, 2.0 * y, 2.0 * x], [0.5 * z, 0.5 * y, 0.5 * x]]
            .map(|[x, y, z]| Transform::from_axes(&Point::new(9.0, 1.0, 5.0), &x, &y, &z));
        assert_eq!(places.map(|place| place.mirrors()), [false, true, false, true]);
        places.iter().for_each(|place| add_copy(&mut parsed, place));
        let (mesh, faces) = (&parsed.mesh, parsed.model.faces.len());
        let mut drawn = Drawn::new(&parsed.model, mesh);
        // Whichever place is asked first, they are drawn in the first one.
        let mut forwards = Drawn::new(&parsed.model, mesh);
        let ahead: Vec<_> = (0..mesh.faces.len() as u32).map(|i| forwards.of(PlacedFaceId(i), 20)).collect();
        for id in (0..mesh.faces.len() as u32).rev().map(PlacedFaceId) {
            let placed = drawn.of(id, 20);
            let first = drawn.of(PlacedFaceId(id.0 % faces as u32), 20);
            let place = &parsed.model.occurrences[mesh.faces[id.index()].occurrence as usize].placement;
            assert_eq!((placed.len(), first.len()), (20, 20));
            assert!(drawn.iter(&placed).eq(forwards.iter(&ahead[id.index()])));
            for ((p, n), (q, m)) in drawn.iter(&placed).zip(drawn.iter(&first)) {
                assert!((p - place.point(&q)).norm() < 1e-12);
                assert!((n - place.direction(&m)).norm() < 1e-12);
                let lies_on = |t: usize| {
                    (nearest_on_triangle(&p, &mesh.corners(t)) - p).norm() < 1e-12
                        && (mesh.doubled_normal(t).normalize() - n).norm() < 1e-12
                };
                assert!(mesh.triangles_of(id).any(lies_on));
            }
        }
        assert_eq!(drawn.counts(), (faces, 20 * faces));
        // Where more are wanted they are drawn anew.
        assert_eq!(drawn.of(PlacedFaceId(0), 30).len(), 30);
        assert_eq!(drawn.counts(), (faces + 1, 20 * faces + 30));
    }
}
