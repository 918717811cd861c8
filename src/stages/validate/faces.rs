//! Whether a mirror maps one face onto another.

use smallvec::SmallVec;

use super::Options;
use super::drawn::{Drawn, Placed};
use super::shape::{histogram_correlation, wasserstein};
use super::support::SurfaceField;
use crate::brep::PlacedFaceId;
use crate::geometry::bvh::{Recent, nearest_on_triangle};
use crate::geometry::{Plane, Point, Vector};
use crate::stages::corner_filter::Outline;
use crate::stages::parse::Parsed;

/// Fewest samples on a face.
const FEWEST: usize = 32;

/// Samples of the outlines of a model, drawn when first asked for.
pub struct FaceSamples<'a> {
    parsed: &'a Parsed,
    outlines: &'a [Outline],
    options: &'a Options,
    size: f64,
    fewest: usize,
    drawn: Drawn<'a>,
}

impl<'a> FaceSamples<'a> {
    /// Nothing is drawn yet.
    pub fn new(parsed: &'a Parsed, outlines: &'a [Outline], options: &'a Options) -> Self {
        Self::with_fewest(parsed, outlines, options, FEWEST)
    }

    /// As `new`, with at least `fewest` samples on a face.
    pub fn with_fewest(parsed: &'a Parsed, outlines: &'a [Outline], options: &'a Options, fewest: usize) -> Self {
        let (size, drawn) = (parsed.measures.tolerance.size(), Drawn::new(&parsed.model, &parsed.mesh));
        Self { parsed, outlines, options, size, fewest, drawn }
    }

    /// The samples of an outline, a fixed distance apart, by its faces.
    fn of(&mut self, outline: u32) -> SmallVec<[Placed; 1]> {
        let outline = &self.outlines[outline as usize];
        let fewest = self.fewest as f64;
        let wanted = outline.area / (self.options.face_step * self.size).powi(2);
        let count = wanted.clamp(fewest, fewest.max(self.options.face_samples as f64));
        let of_face = |&f: &PlacedFaceId| {
            let share = self.parsed.mesh.faces[f.index()].area / outline.area;
            self.drawn.of(f, (count * share).ceil().max(1.0) as usize)
        };
        outline.faces.iter().map(of_face).collect()
    }

    /// Signed distances of the samples from the plane.
    fn signed_distances(&mut self, outline: u32, plane: &Plane) -> Vec<f64> {
        let samples = self.of(outline);
        let points = samples.iter().flat_map(|placed| self.drawn.iter(placed));
        points.map(|(p, _)| plane.signed_distance(&p)).collect()
    }

    /// Unsigned distances of the samples from the plane.
    fn distances(&mut self, outline: u32, plane: &Plane) -> Vec<f64> {
        let mut distances = self.signed_distances(outline, plane);
        distances.iter_mut().for_each(|d| *d = d.abs());
        distances
    }

    /// The distances of two faces; for one face, those of its two sides.
    fn both_distances(&mut self, a: u32, b: u32, plane: &Plane) -> (Vec<f64>, Vec<f64>) {
        if a != b {
            return (self.distances(a, plane), self.distances(b, plane));
        }
        let signed = self.signed_distances(a, plane);
        let (left, right): (Vec<f64>, Vec<f64>) = signed.into_iter().partition(|d| *d < 0.0);
        (left.into_iter().map(f64::abs).collect(), right)
    }

    /// The correlation of eq. (6) between two faces, or the two sides of one.
    pub fn correlation(&mut self, a: u32, b: u32, plane: &Plane) -> Option<f64> {
        let (p, q) = self.both_distances(a, b, plane);
        histogram_correlation(&p, &q, self.options.bins)
    }

    /// The correlation of eq. (6) as above; and whether the mirror maps face `a` onto face `b` (or `a` onto itself):
    /// areas, inner loops, distances to the plane, surfaces both ways.
    pub fn compared(&mut self, a: u32, b: u32, plane: &Plane, field: &SurfaceField) -> (Option<f64>, bool) {
        let is_image = self.is_image(a, b, plane, field);
        let (mut s, mut t) = if is_image && a != b {
            // The samples of the one face are the images of those of the other.
            let distances = self.distances(a, plane);
            (distances.clone(), distances)
        } else {
            self.both_distances(a, b, plane)
        };
        let correlation = histogram_correlation(&s, &t, self.options.bins);
        let (p, q) = (&self.outlines[a as usize], &self.outlines[b as usize]);
        let mirrored = (p.area - q.area).abs() <= self.options.area * p.area.max(q.area)
            && self.inner_loops_match(p, q, plane)
            && (is_image || a == b || wasserstein(&mut s, &mut t) <= self.options.wasserstein * self.size)
            && (is_image || self.samples_lie_on(a, b, plane, field))
            && (a == b || self.lies_on(b, a, plane, field));
        (correlation, mirrored)
    }

    /// Whether areas and inner loops agree and the samples of `a` are mirrored onto `b`: one way only, for faces whose
    /// centroids are known to be images.
    pub fn maps_onto(&mut self, a: u32, b: u32, plane: &Plane, field: &SurfaceField) -> bool {
        let (p, q) = (&self.outlines[a as usize], &self.outlines[b as usize]);
        (p.area - q.area).abs() <= self.options.area * p.area.max(q.area)
            && self.inner_loops_match(p, q, plane)
            && self.lies_on(a, b, plane, field)
    }

    /// Whether each inner loop of one face has its image among those of the other.
    fn inner_loops_match(&self, p: &Outline, q: &Outline, plane: &Plane) -> bool {
        let limit = self.options.distance_95 * self.size;
        let image = |l: &crate::stages::corner_filter::InnerLoop| {
            let centroid = plane.reflect(&l.centroid);
            q.inner
                .iter()
                .any(|m| (m.centroid - centroid).norm() <= limit && (m.length - l.length).abs() <= 2.0 * limit)
        };
        p.inner.len() == q.inner.len() && (p.inner.len() > INNER || p.inner.iter().all(image))
    }

    /// Whether the mirror maps one face onto the other, as a whole or by its samples.
    fn lies_on(&mut self, a: u32, b: u32, plane: &Plane, field: &SurfaceField) -> bool {
        self.is_image(a, b, plane, field) || self.samples_lie_on(a, b, plane, field)
    }

    /// Whether face `b` is as a whole the image of face `a`: to tell, none of their samples is asked.
    fn is_image(&self, a: u32, b: u32, plane: &Plane, field: &SurfaceField) -> bool {
        match [a, b].map(|i| &self.outlines[i as usize].faces[..]) {
            [&[one], &[other]] => field.maps_onto(&plane.reflection(), one, other),
            _ => false,
        }
    }

    /// Whether the mirrored samples of one face lie on the other.
    fn samples_lie_on(&mut self, a: u32, b: u32, plane: &Plane, field: &SurfaceField) -> bool {
        let far = self.options.distance_max * self.size;
        let near = far.min(self.options.distance_95 * self.size);
        let samples = self.of(a);
        let target = &self.outlines[b as usize];
        let faces = &target.faces;
        let small = target.area <= SMALL * near * near && self.triangles_of(target).count() <= FEW_TRIANGLES;
        let count: usize = samples.iter().map(Placed::len).sum();
        let (mut outside, mut recent) = (0, Recent::default());
        for (p, n) in samples.iter().flat_map(|placed| self.drawn.iter(placed)) {
            let (image, normal) = (plane.reflect(&p), plane.reflect_vector(&n));
            let mut within = |radius| {
                if small {
                    return self.is_on(target, (&image, &normal), radius, field);
                }
                field.touches((&image, &normal), radius, &mut recent, |f| faces.binary_search(&f).is_ok())
            };
            if within(near) {
                continue;
            }
            outside += 1;
            if outside * 20 > count || !within(far) {
                return false;
            }
        }
        true
    }

    fn triangles_of(&self, outline: &'a Outline) -> impl Iterator<Item = usize> {
        outline.faces.iter().flat_map(|&f| self.parsed.mesh.triangles_of(f))
    }

    /// Whether an outline has a point within `radius` of `p` with this normal, triangle by triangle.
    fn is_on(&self, outline: &Outline, (p, normal): (&Point, &Vector), radius: f64, field: &SurfaceField) -> bool {
        let mesh = &self.parsed.mesh;
        self.triangles_of(outline).any(|t| {
            (nearest_on_triangle(p, &mesh.corners(t)) - p).norm_squared() <= radius * radius
                && mesh.doubled_normal(t).try_normalize(0.0).is_some_and(|n| field.agree(&n, normal))
        })
    }
}

/// Up to this share of the radius squared the area of a face is small: the tree would show all that is around it.
const SMALL: f64 = 4.0;
/// .. and up to so many triangles it is asked itself.
const FEW_TRIANGLES: usize = 64;
/// Faces with more inner loops (a plate with hundreds of holes) are judged by their surfaces alone.
const INNER: usize = 256;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cancel::Cancel;
    use crate::geometry::Transform;
    use crate::stages::corner_filter::corner_filter;
    use crate::stages::fixture::{prism, solid};

    #[test]
    fn a_face_and_its_image_share_their_samples() {
        // A trapezoid mirrored by x = 2; its second and fourth wall are images of each other.
        let base = [[0.0, 0.0], [4.0, 0.0], [3.0, 2.0], [1.0, 2.0]];
        let parsed = solid(&prism(&base, 3.0), &Transform::identity());
        let outlines = corner_filter(&parsed, &Default::default(), &Cancel::new()).unwrap();
        let options = Options::default();
        let field = SurfaceField::new(&parsed, 2000, 0.004, 0.866, &Cancel::new()).unwrap();
        let plane = Plane { normal: Vector::x(), offset: 2.0 };
        let mut samples = FaceSamples::new(&parsed, &outlines, &options);
        let (correlation, mirrored) = samples.compared(3, 5, &plane, &field);
        assert!(mirrored && (correlation.unwrap() - 1.0).abs() < 1e-12);
        assert_eq!(samples.drawn.counts().0, 1);
        assert_eq!(samples.compared(5, 3, &plane, &field), (correlation, true));
        // Beside the plane they are no images, and each has samples of its own.
        let aside = Plane { offset: 2.5, ..plane };
        let mut samples = FaceSamples::new(&parsed, &outlines, &options);
        assert!(!samples.compared(3, 5, &aside, &field).1);
        assert_eq!(samples.drawn.counts().0, 2);
    }
}
