//! The faces that a plane maps onto each other, by inverse look-up.
//!
//! A plane that maps nearly the whole surface onto itself needs no other evidence. One that maps only a part needs
//! whole faces that are each other's images (section IV.D validates faces, not areas), for large flat or round faces
//! overlap their images by accident: a hub alone, a third of a propeller, agrees with every plane through its axis.

use super::{Merger, SymmetryPlane};
use crate::brep::PlacedFaceId;
use crate::cancel::Cancelled;
use crate::geometry::{Plane, PointGrid};
use crate::stages::validate;
use crate::stages::validate::faces::FaceSamples;

/// A mirrored centroid finds its image within this share of D.
const NEAR: f64 = 0.003;
/// Coverage from which faces that are their own images count as pairs do.
const MOST: f64 = 0.8;
/// Samples of a face that must lie on its image: the centroids and areas agree already.
const SAMPLES: usize = 12;

/// How faces are compared with their images.
pub(super) fn look_up() -> validate::Options {
    validate::Options { face_samples: SAMPLES, ..validate::Options::default() }
}

/// Which faces of a model are each other's images: where their centroids are, and the samples drawn so far.
pub(super) struct Images<'a> {
    merger: &'a Merger<'a>,
    centroids: PointGrid,
    samples: FaceSamples<'a>,
}

impl<'a> Images<'a> {
    /// Nothing is drawn yet.
    pub fn of(merger: &'a Merger<'a>, look_up: &'a validate::Options) -> Self {
        let width = 4.0 * merger.parsed.measures.tolerance.length(NEAR);
        let centroids = PointGrid::new(merger.outlines.iter().map(|o| o.centroid), width);
        let samples = FaceSamples::with_fewest(merger.parsed, merger.outlines, look_up, SAMPLES);
        Self { merger, centroids, samples }
    }

    /// Planes for which the faces may be looked up.
    fn room(&self) -> usize {
        (self.merger.options.evidence / self.merger.outlines.len().max(1)).max(1)
    }

    /// Adds pairs and self-symmetric faces to the planes, as far as the bound on planes times faces allows.
    pub fn add_to(&mut self, planes: &mut [SymmetryPlane]) -> Result<(), Cancelled> {
        let room = self.room();
        for plane in planes.iter_mut().take(room) {
            self.merger.cancel.check()?;
            let faces = self.pairs(&plane.plane);
            (plane.pairs, plane.selfs) = step_faces(self.merger, &plane.plane, &faces);
        }
        Ok(())
    }

    /// Drops the planes below `near_global` (by more than `doubt`) for which too few faces speak. The pool is sorted,
    /// best first; planes beyond the bound on planes times faces are not looked at and go.
    pub fn keep_confirmed(&mut self, pool: &mut Vec<SymmetryPlane>, doubt: f64) -> Result<(), Cancelled> {
        let (options, best) = (self.merger.options, pool.first().map_or(0.0, |p| p.coverage));
        // While one plane is beyond doubt, most of the others fall behind it; those that stay are looked at in the end.
        let limit = if doubt > 0.0 && best >= options.near_global + doubt { 0.0 } else { options.near_global - doubt };
        let mut room = self.room();
        let mut kept = Vec::new();
        for plane in pool.drain(..) {
            self.merger.cancel.check()?;
            if plane.coverage >= limit {
                kept.push(plane);
            } else if room > 0 {
                room -= 1;
                let faces = self.pairs(&plane.plane);
                if is_confirmed(self.merger, &plane, &faces) {
                    kept.push(plane);
                }
            }
        }
        *pool = kept;
        Ok(())
    }

    /// Pairs (a, b), a <= b, of outlines that are each other's image.
    fn pairs(&mut self, plane: &Plane) -> Vec<(u32, u32)> {
        let (outlines, field) = (self.merger.outlines, &self.merger.validated.field);
        let radius = self.merger.parsed.measures.tolerance.length(NEAR);
        let mut taken = vec![false; outlines.len()];
        let (mut pairs, mut near) = (Vec::new(), Vec::new());
        for a in 0..outlines.len() as u32 {
            if taken[a as usize] {
                continue;
            }
            let image = plane.reflect(&outlines[a as usize].centroid);
            let unmatched = |&b: &u32| b >= a && !taken[b as usize];
            near.clear();
            near.extend(self.centroids.near(&image, radius).filter(unmatched));
            let distance = |b: u32| (outlines[b as usize].centroid - image).norm();
            near.sort_by(|&b, &c| distance(b).total_cmp(&distance(c)).then(b.cmp(&c)));
            if let Some(&b) = near.iter().find(|&&b| self.samples.maps_onto(a, b, plane, field)) {
                (taken[a as usize], taken[b as usize]) = (true, true);
                pairs.push((a, b));
            }
        }
        pairs
    }
}

/// Whether the faces that the plane maps onto faces make up enough of what it maps onto the surface. A single pair of
/// congruent faces always has a plane, two faces often share one by accident, and a face that turns about an axis has
/// every plane through it: two pairs must speak for the plane. Where the plane maps most of the surface and damage has
/// left few pairs whole, three faces or pairs of any kind do.
fn is_confirmed(merger: &Merger, plane: &SymmetryPlane, faces: &[(u32, u32)]) -> bool {
    let outline = |i: u32| &merger.outlines[i as usize];
    let of_two: f64 = faces.iter().filter(|(a, b)| a != b).map(|&(a, b)| outline(a).area + outline(b).area).sum();
    let own = faces.iter().filter(|(a, b)| a == b).map(|&(a, _)| outline(a));
    let alone: Vec<f64> = own.filter(|o| o.axis.is_none()).map(|o| o.area).collect();
    let area = of_two + alone.iter().sum::<f64>();
    let pairs = faces.iter().filter(|(a, b)| a != b).count();
    let needed = (merger.options.confirmed * plane.coverage).max(merger.options.partial);
    let speak = pairs >= 2 || (plane.coverage >= MOST && pairs + alone.len() >= 3);
    speak && area >= needed * merger.parsed.measures.area
}

/// Pairs of faces, and faces that are their own image.
type StepFaces = (Vec<(PlacedFaceId, PlacedFaceId)>, Vec<PlacedFaceId>);

/// The faces of the file behind pairs of maximal faces: each face goes with the one nearest to its image.
fn step_faces(merger: &Merger, plane: &Plane, outlines: &[(u32, u32)]) -> StepFaces {
    let centroid = |f: PlacedFaceId| merger.parsed.mesh.faces[f.index()].centroid;
    let (mut pairs, mut selfs) = (Vec::new(), Vec::new());
    for &(a, b) in outlines {
        let [a, b] = [a, b].map(|i| &merger.outlines[i as usize].faces);
        for &face in a {
            let image = plane.reflect(&centroid(face));
            let distance = |f: &PlacedFaceId| (centroid(*f) - image).norm();
            let Some(&other) = b.iter().min_by(|f, g| distance(f).total_cmp(&distance(g))) else { continue };
            if face == other {
                selfs.push(face);
            } else {
                pairs.push((face.min(other), face.max(other)));
            }
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    selfs.sort_unstable();
    (pairs, selfs)
}
