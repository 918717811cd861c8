//! Whether a mirror maps one face onto another.

use std::rc::Rc;

use super::Options;
use super::shape::{histogram_correlation, wasserstein};
use super::support::SurfaceField;
use crate::brep::sample::sample_face;
use crate::geometry::bvh::{Recent, nearest_on_triangle};
use crate::geometry::{Plane, Point, Vector};
use crate::stages::corner_filter::Outline;
use crate::stages::parse::Parsed;

/// Fewest samples on a face.
const FEWEST: usize = 32;

/// Points and normals on a face.
type Samples = Rc<[(Point, Vector)]>;

/// Samples of the faces of a model, drawn when first asked for.
pub struct FaceSamples<'a> {
    parsed: &'a Parsed,
    outlines: &'a [Outline],
    options: &'a Options,
    size: f64,
    fewest: usize,
    drawn: Vec<Option<Samples>>,
}

impl<'a> FaceSamples<'a> {
    /// Nothing is drawn yet.
    pub fn new(parsed: &'a Parsed, outlines: &'a [Outline], options: &'a Options) -> Self {
        Self::with_fewest(parsed, outlines, options, FEWEST)
    }

    /// As `new`, with at least `fewest` samples on a face.
    pub fn with_fewest(parsed: &'a Parsed, outlines: &'a [Outline], options: &'a Options, fewest: usize) -> Self {
        let size = parsed.measures.tolerance.size();
        Self { parsed, outlines, options, size, fewest, drawn: vec![None; outlines.len()] }
    }

    /// The samples of an outline, a fixed distance apart.
    fn of(&mut self, outline: u32) -> Samples {
        let (outlines, options, size, parsed) = (self.outlines, self.options, self.size, self.parsed);
        let fewest = self.fewest as f64;
        let draw = || {
            let outline = &outlines[outline as usize];
            let wanted = outline.area / (options.face_step * size).powi(2);
            let count = wanted.clamp(fewest, fewest.max(options.face_samples as f64));
            let of_face = |&f: &crate::brep::PlacedFaceId| {
                let share = parsed.mesh.faces[f.index()].area / outline.area;
                sample_face(&parsed.mesh, f, (count * share).ceil().max(1.0) as usize)
            };
            outline.faces.iter().flat_map(of_face).map(|s| (s.point, s.normal)).collect()
        };
        self.drawn[outline as usize].get_or_insert_with(draw).clone()
    }

    /// Unsigned distances of the samples from the plane.
    fn distances(&mut self, outline: u32, plane: &Plane) -> Vec<f64> {
        self.of(outline).iter().map(|(p, _)| plane.signed_distance(p).abs()).collect()
    }

    /// The distances of two faces; for one face, those of its two sides.
    fn both_distances(&mut self, a: u32, b: u32, plane: &Plane) -> (Vec<f64>, Vec<f64>) {
        if a != b {
            return (self.distances(a, plane), self.distances(b, plane));
        }
        let samples = self.of(a);
        let signed = samples.iter().map(|(p, _)| plane.signed_distance(p));
        let (left, right): (Vec<f64>, Vec<f64>) = signed.partition(|d| *d < 0.0);
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
        let (mut s, mut t) = self.both_distances(a, b, plane);
        let correlation = histogram_correlation(&s, &t, self.options.bins);
        let (p, q) = (&self.outlines[a as usize], &self.outlines[b as usize]);
        let mirrored = (p.area - q.area).abs() <= self.options.area * p.area.max(q.area)
            && self.inner_loops_match(p, q, plane)
            && (a == b || wasserstein(&mut s, &mut t) <= self.options.wasserstein * self.size)
            && self.lies_on(a, b, plane, field)
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

    /// Whether the mirrored samples of one face lie on the other.
    fn lies_on(&mut self, a: u32, b: u32, plane: &Plane, field: &SurfaceField) -> bool {
        let [from, faces] = [a, b].map(|i| &self.outlines[i as usize].faces);
        if let ([one], [other]) = (&from[..], &faces[..])
            && field.maps_onto(&plane.reflection(), *one, *other)
        {
            return true;
        }
        let far = self.options.distance_max * self.size;
        let near = far.min(self.options.distance_95 * self.size);
        let samples = self.of(a);
        let target = &self.outlines[b as usize];
        let small = target.area <= SMALL * near * near && self.triangles_of(target).count() <= FEW_TRIANGLES;
        let (mut outside, mut recent) = (0, Recent::default());
        for (p, n) in samples.iter() {
            let (image, normal) = (plane.reflect(p), plane.reflect_vector(n));
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
            if outside * 20 > samples.len() || !within(far) {
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
