//! Surface support: the share of a surface that an isometry maps onto the surface.

use std::sync::OnceLock;

use super::footprint::{Footprint, Footprints};
use super::quads::{Quads, is_near};
pub use super::tally::Support;
use super::tally::Tally;
use super::whole_faces::WholeFaces;
use crate::brep::sample::{Sample, sample_mesh};
use crate::brep::{Mesh, PlacedFaceId};
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::bvh::{Around, Bvh, Nearest, Recent};
use crate::geometry::sides::Neighbours;
use crate::geometry::{Isometry, Point, Vector};
use crate::stages::parse::Parsed;

/// Every how many-th of all samples belongs to the first two rounds, and every how many-th of these to the first.
const STRIDES: [usize; 2] = [5, 8];

/// Images of whole faces may be off by this share of the radius.
const SAME: f64 = 0.05;

/// The surface of a model, ready to be asked whether points lie on it.
#[derive(Clone, Debug)]
pub struct SurfaceField {
    /// Triangles under the number of their face.
    tree: Bvh,
    quads: Quads,
    whole: WholeFaces,
    footprints: Footprints,
    /// Those of the first round, then those of the second.
    samples: Vec<Sample>,
    /// Samples of the first round.
    coarse: usize,
    /// Samples of the third round, drawn when first asked for, and about how many.
    last: (OnceLock<Vec<Sample>>, usize),
    /// Distance within which a point lies on the surface, mm.
    radius: f64,
    /// Least cosine between normals that agree.
    cosine: f64,
    /// Where normals that agree point, roughly.
    agreeing: Neighbours,
    /// Whether the faces have an outside; without it, opposite normals agree too.
    oriented: bool,
}

/// Samples that are asked before the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Round {
    /// A fortieth of the samples: finds planes that are out of the question.
    Coarse,
    /// A fifth.
    Middle,
}

impl SurfaceField {
    /// Samples the mesh of a model at about `count` points; `share` of D is the distance within which they agree.
    ///
    /// # Errors
    /// When cancelled.
    pub fn new(parsed: &Parsed, count: usize, share: f64, cosine: f64, cancel: &Cancel) -> Result<Self, Cancelled> {
        let mesh = &parsed.mesh;
        let tree = Bvh::new(mesh.triangles.len(), numbered_triangles(mesh));
        let first = count.div_ceil(STRIDES[0]);
        let (samples, coarse) = coarse_first(&sample_mesh(mesh, first, 0), STRIDES[1]);
        let oriented = parsed.model.bodies.iter().all(|b| b.solid) && encloses_volume(parsed);
        let (radius, agreeing) = (parsed.measures.tolerance.length(share), Neighbours::within(cosine, !oriented));
        Ok(Self {
            tree,
            quads: Quads::of(mesh),
            whole: WholeFaces::of(mesh, SAME * radius, !oriented),
            footprints: Footprints::of(mesh, radius, cancel)?,
            samples,
            coarse,
            last: (OnceLock::new(), count - first),
            radius,
            cosine,
            agreeing,
            oriented,
        })
    }

    /// The samples of a round and those before it.
    pub fn samples(&self, round: Round) -> &[Sample] {
        match round {
            Round::Coarse => &self.samples[..self.coarse],
            Round::Middle => &self.samples,
        }
    }

    /// Distance within which a point lies on the surface, mm.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Whether two unit normals agree.
    pub fn agree(&self, a: &Vector, b: &Vector) -> bool {
        let cosine = a.dot(b);
        cosine >= self.cosine || (!self.oriented && -cosine >= self.cosine)
    }

    /// The point of the surface nearest to `p` of those with this normal, if one is within `radius`. `guess` as in
    /// [`Bvh::nearest_around`].
    pub fn nearest(&self, (p, normal): (&Point, &Vector), radius: f64, guess: &mut u32) -> Option<Nearest> {
        let around = Around { point: p, radius, sides: self.agreeing.of(normal) };
        self.tree.nearest_around(&around, guess, |t| self.agree(&t.normal, normal))
    }

    /// Whether a face that `accept` takes has a point within `radius` of `p` with this normal. `recent` as in
    /// [`Bvh::any_around`].
    pub fn touches(
        &self,
        (p, normal): (&Point, &Vector),
        radius: f64,
        recent: &mut Recent,
        accept: impl Fn(PlacedFaceId) -> bool,
    ) -> bool {
        let around = Around { point: p, radius, sides: self.agreeing.of(normal) };
        self.tree.any_around(&around, recent, |t| self.agree(&t.normal, normal) && accept(PlacedFaceId(t.id)))
    }

    /// Whether the isometry maps a sample to within `radius` of the surface. `recent` as in [`Bvh::any_around`].
    pub fn maps_near(&self, isometry: &Isometry, sample: &Sample, radius: f64, recent: &mut Recent) -> bool {
        let (p, normal) = (isometry.apply(&sample.point), isometry.rotation * sample.normal);
        self.touches((&p, &normal), radius, recent, |_| true)
    }

    /// Whether the isometry maps a sample onto the surface. `image` is of the face that the sample before it on the same
    /// face was mapped onto.
    fn maps<'a>(
        &'a self,
        isometry: &Isometry,
        sample: &Sample,
        recent: &mut Recent,
        image: &mut Option<&'a Footprint>,
    ) -> bool {
        let (p, normal) = (isometry.apply(&sample.point), isometry.rotation * sample.normal);
        if image.is_some_and(|face| face.holds(&p) && self.agree(&face.normal, &normal)) {
            return true;
        }
        let maps = self.touches((&p, &normal), self.radius, recent, |_| true);
        if maps {
            *image = self.latest(recent).and_then(|face| self.footprints.get(face));
        }
        maps
    }

    /// The face found last.
    fn latest(&self, recent: &Recent) -> Option<PlacedFaceId> {
        recent.latest().and_then(|position| self.tree.id_of(position)).map(PlacedFaceId)
    }

    /// The share of the samples of two rounds that `isometry` maps onto the surface; where it cannot be `needed`,
    /// something smaller than that.
    ///
    /// # Errors
    /// When cancelled.
    pub fn middle(&self, isometry: &Isometry, needed: f64, cancel: &Cancel) -> Result<Support, Cancelled> {
        self.share(isometry, (Tally::default(), self.samples.len()), &self.samples, needed, cancel)
    }

    /// The share of all samples, where that of two rounds is known.
    ///
    /// # Errors
    /// When cancelled.
    pub fn completed(
        &self,
        mesh: &Mesh,
        isometry: &Isometry,
        middle: Support,
        cancel: &Cancel,
    ) -> Result<Support, Cancelled> {
        let asked = self.samples.len();
        let samples = self.last.0.get_or_init(|| sample_mesh(mesh, self.last.1, asked));
        self.share(isometry, (Tally::from(middle, asked), asked + samples.len()), samples, 0.0, cancel)
    }

    /// The share of all samples.
    ///
    /// # Errors
    /// When cancelled.
    pub fn support(&self, mesh: &Mesh, isometry: &Isometry, cancel: &Cancel) -> Result<Support, Cancelled> {
        let middle = self.middle(isometry, 0.0, cancel)?;
        self.completed(mesh, isometry, middle, cancel)
    }

    /// The share of `count` samples: of those tallied already, and of others.
    fn share(
        &self,
        isometry: &Isometry,
        (mut tally, count): (Tally, usize),
        samples: &[Sample],
        needed: f64,
        cancel: &Cancel,
    ) -> Result<Support, Cancelled> {
        let (mut recent, mut whole) = (Recent::default(), self.whole.under(isometry));
        // A little less than needed, for rounding.
        let most_missed = ((1.0 - needed) * count as f64).ceil() as usize + 1;
        for of_face in samples.chunk_by(|a, b| a.face == b.face) {
            cancel.check()?;
            let hits =
                if whole.has(of_face[0].face) { of_face.len() } else { self.hits(isometry, of_face, &mut recent) };
            tally.add(of_face.len(), hits);
            if tally.missed() > most_missed {
                break;
            }
        }
        Ok(tally.support(count))
    }

    /// How many samples of a face are mapped that is not mapped as a whole.
    fn hits(&self, isometry: &Isometry, samples: &[Sample], recent: &mut Recent) -> usize {
        if self.maps_quad(isometry, &samples[0], recent) {
            return samples.len();
        }
        let mut image = None;
        samples.iter().filter(|s| self.maps(isometry, s, recent, &mut image)).count()
    }

    /// Whether the isometry maps a whole face onto another (or itself).
    pub fn maps_onto(&self, isometry: &Isometry, a: PlacedFaceId, b: PlacedFaceId) -> bool {
        self.whole.maps_onto(isometry, a, b)
    }

    /// Whether the whole face of a sample is mapped onto one other, which can be told of a quadrilateral by its corners.
    fn maps_quad(&self, isometry: &Isometry, sample: &Sample, recent: &mut Recent) -> bool {
        let Some(corners) = self.quads.get(sample.face) else { return false };
        self.maps(isometry, sample, recent, &mut None)
            && self
                .latest(recent)
                .and_then(|face| self.quads.get(face))
                .is_some_and(|image| corners.iter().all(|corner| is_near(image, &isometry.apply(corner), self.radius)))
    }

    /// The coarse support, or `None` as soon as it is (with three standard deviations) below `needed`.
    pub fn reaches(&self, isometry: &Isometry, needed: f64) -> Option<f64> {
        let samples = self.samples(Round::Coarse);
        let (mut hits, mut recent, mut whole) = (0, Recent::default(), self.whole.under(isometry));
        // Of each face onto what its last sample was mapped.
        let mut images: Vec<Option<&Footprint>> = vec![None; whole.count()];
        // A step coprime to most counts spreads also the first few samples over the whole surface.
        let step = spread_step(samples.len());
        for n in 1..=samples.len() {
            let sample = &samples[n * step % samples.len()];
            let image = &mut images[sample.face.index()];
            hits += usize::from(whole.has(sample.face) || self.maps(isometry, sample, &mut recent, image));
            if n >= 8 && n % 4 == 0 {
                let share = hits as f64 / n as f64;
                let deviation = ((share * (1.0 - share) + 1.0 / n as f64) / n as f64).sqrt();
                if share + 3.0 * deviation < needed {
                    return None;
                }
            }
        }
        let share = hits as f64 / samples.len().max(1) as f64;
        (share >= needed || samples.is_empty()).then_some(share)
    }
}

/// The triangles of a mesh with the number of their face.
fn numbered_triangles(mesh: &Mesh) -> impl Iterator<Item = ([Point; 3], u32)> {
    (0..mesh.faces.len() as u32)
        .flat_map(move |i| mesh.triangles_of(PlacedFaceId(i)).map(move |t| (mesh.corners(t), i)))
}

/// Every `stride`-th sample, then the others; and how many come first.
fn coarse_first(samples: &[Sample], stride: usize) -> (Vec<Sample>, usize) {
    let mut ordered: Vec<_> = samples.iter().step_by(stride).copied().collect();
    let coarse = ordered.len();
    let is_other = |(i, _): &(usize, &Sample)| !i.is_multiple_of(stride);
    ordered.extend(samples.iter().enumerate().filter(is_other).map(|(_, s)| *s));
    (ordered, coarse)
}

/// Whether the triangles enclose the volume of the solids: where faces are turned inside out they do not, and normals
/// say nothing about sides.
fn encloses_volume(parsed: &Parsed) -> bool {
    let (mesh, measures) = (&parsed.mesh, &parsed.measures);
    let cone = |t: usize| {
        let [a, b, c] = mesh.corners(t).map(|p| p - measures.centroid);
        a.cross(&b).dot(&c) / 6.0
    };
    let meshed: f64 = (0..mesh.triangles.len()).map(cone).sum();
    // Chords cost a few percent of thin round bodies.
    (meshed - measures.volume).abs() <= 0.1 * measures.volume
}

/// A number near 0.618 n without a common factor with `n`.
fn spread_step(n: usize) -> usize {
    let golden = (n as f64 * 0.618) as usize;
    (golden.max(1)..=golden.max(1) + n).find(|&s| gcd(s, n) == 1).unwrap_or(1)
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_step_visits_every_sample() {
        for n in [1, 2, 16, 500, 501] {
            let step = spread_step(n);
            let mut seen = vec![false; n];
            (1..=n).for_each(|i| seen[i * step % n] = true);
            assert!(seen.iter().all(|&s| s));
        }
    }
}
