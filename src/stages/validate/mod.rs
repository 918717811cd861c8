//! Stage 5: candidate planes -> those that map surfaces onto surfaces.
//!
//! In: [`Candidates`]. Out: [`Validated`]: distinct planes with the pairs that passed, and the sampled surface.
//!
//! Method: section IV.D. The paper compares the histograms of the distances of two faces' samples to the plane (eq.
//! 6), which is undefined for walls parallel to the plane and blind to shifts along it; the default compares the
//! distances by the one-dimensional Wasserstein distance, then the mirrored samples of each face with the surface of
//! the other, then the inner loops (`faces`). Before that, candidates are joined into distinct planes, and planes
//! whose coarse surface support (`support`) is far below the best are dropped. Faces that a plane maps onto whole faces
//! (`whole_faces`, `quads`) need no look at their samples, which are drawn once for all places of a face (`drawn`).
//!
//! Cost: a look-up for each face and, for the samples of the others, a bit of the picture of a large plane face
//! (`footprint`) or a query of the triangle tree: a few hundred for each plane that is kept, some tens for each that is
//! dropped.

mod drawn;
pub mod faces;
mod footprint;
mod quads;
pub mod shape;
pub mod support;
mod tally;
mod whole_faces;

use smallvec::SmallVec;

use crate::cancel::{Cancel, Cancelled};
use crate::geometry::{Plane, PlaneIndex};
use crate::stages::corner_filter::Outline;
use crate::stages::isometry::{Candidate, Candidates, Source, mirror};
use crate::stages::pair_match::{Corners, Matches};
use crate::stages::parse::Parsed;
use crate::stages::{ModelError, Stage};
use faces::FaceSamples;
use support::SurfaceField;

/// Settings of the stage.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Samples of the whole surface; a fifth of them where that tells a plane's coverage within 0.1 %, or that it is not
    /// the best. 2,000 rank planes wrongly.
    pub samples: usize,
    /// A mirrored sample lies on the surface within this share of D: above the chords of the tessellation.
    pub on_surface: f64,
    /// Normals agree up to this angle, degrees: above the kinks of the tessellation, below 45.
    pub normal_angle_deg: f64,
    /// Two candidates are one plane up to this angle, degrees ..
    pub same_angle_deg: f64,
    /// .. and this distance, as a share of D.
    pub same_offset: f64,
    /// Distinct planes whose support is measured, the most voted ones; of each kind of source.
    pub planes: usize,
    /// Coarse support a plane may be below the best so far. Larger than the 5 % reported, for 500 samples are rough.
    pub slack: f64,
    /// Pairs of faces checked for each plane, the largest first.
    pub pairs: usize,
    /// Distance of neighbouring samples on a face, as a share of D.
    pub face_step: f64,
    /// Most samples on a face.
    pub face_samples: usize,
    /// Largest Wasserstein distance of the distances to the plane, as a share of D.
    pub wasserstein: f64,
    /// Largest relative difference of areas.
    pub area: f64,
    /// Largest distance of 95 % of the mirrored samples from the other face, as a share of D.
    pub distance_95: f64,
    /// Largest distance of any, as a share of D.
    pub distance_max: f64,
    /// Judge by the correlation of eq. (6) alone, at least this; 0: by the criteria above.
    pub correlation: f64,
    /// Bins of the histograms of eq. (6).
    pub bins: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            samples: 20_000,
            on_surface: 0.004,
            normal_angle_deg: 30.0,
            same_angle_deg: 0.5,
            same_offset: 0.002,
            planes: 256,
            slack: 0.15,
            pairs: 4,
            face_step: 0.02,
            face_samples: 512,
            wasserstein: 0.005,
            area: 0.01,
            distance_95: 0.005,
            distance_max: 0.02,
            correlation: 0.0,
            bins: 32,
        }
    }
}

impl Options {
    /// The paper's reading.
    pub fn paper() -> Self {
        Self { face_step: 0.01, face_samples: 4096, correlation: 0.9, ..Self::default() }
    }
}

/// A plane with the candidates that speak for it.
#[derive(Clone, Debug)]
pub struct ValidatedPlane {
    /// The plane.
    pub plane: Plane,
    /// Root mean square distance of mirrored corners from their images, mm.
    pub residual: f64,
    /// Votes by area, mm^2.
    pub weight: f64,
    /// What suggested it.
    pub source: Source,
    /// Checked pairs, as positions in [`Matches::pairs`].
    pub pairs: Vec<u32>,
    /// Mean correlation of eq. (6) over the checked pairs for which it is defined.
    pub correlation: Option<f64>,
    /// Coarse surface support; 0 where it was not measured (the paper's profile).
    pub coarse: f64,
}

/// What is left, and the surface it was checked against.
#[derive(Clone, Debug)]
pub struct Validated {
    /// Planes with their coarse support.
    pub planes: Vec<ValidatedPlane>,
    /// The surface, to measure supports with.
    pub field: SurfaceField,
    /// Faces that direct isometries map onto others.
    pub repeats: crate::stages::isometry::Repeats,
}

/// Keeps the candidates that map surfaces onto surfaces.
///
/// # Errors
/// Only when cancelled.
pub fn validate(
    parsed: &Parsed,
    outlines: &[Outline],
    matches: &Matches,
    candidates: &Candidates,
    options: &Options,
    cancel: &Cancel,
) -> Result<Validated, ModelError> {
    let cosine = options.normal_angle_deg.to_radians().cos();
    let cancelled = |c| ModelError::cancelled(Stage::Validate, c);
    let field = SurfaceField::new(parsed, options.samples, options.on_surface, cosine, cancel).map_err(cancelled)?;
    let mut samples = FaceSamples::new(parsed, outlines, options);
    let mut planes = Vec::new();
    if options.correlation > 0.0 {
        let mut corners = Corners::default();
        for candidate in &candidates.mirrors {
            cancel.check().map_err(cancelled)?;
            let candidate = fitted(candidate, matches, outlines, &mut corners);
            planes.extend(by_correlation(matches, &candidate, &mut samples, options));
        }
    } else {
        let mut best: f64 = 0.0;
        for group in distinct(parsed, outlines, matches, &candidates.mirrors, options, cancel).map_err(cancelled)? {
            cancel.check().map_err(cancelled)?;
            let least = if group.paired { 0.05 } else { SELF_EVIDENT - DOUBT };
            let needed = (best - options.slack).max(least);
            if group.plane.signed_distance(&parsed.measures.centroid).abs() > farthest(parsed, &field, needed) {
                continue;
            }
            let Some(coarse) = field.reaches(&group.plane.reflection(), needed) else { continue };
            best = best.max(coarse);
            planes.extend(check(group, coarse, matches, &field, &mut samples));
        }
        planes.retain(|p| p.coarse >= best - options.slack);
    }
    Ok(Validated { planes, field, repeats: candidates.repeats })
}

/// The largest distance from the centroid of a plane that maps a share of the surface onto it, mm. What it does not map
/// makes up for all of the distance between the centroid and its image, and is no farther than D (and that distance)
/// from where it would have to be. Where surfaces lie on each other the share may be larger than that.
fn farthest(parsed: &Parsed, field: &SurfaceField, share: f64) -> f64 {
    let rest = (1.0 - share + DOUBT).max(0.0);
    0.5 * rest / (1.0 - rest).max(0.0) * parsed.measures.tolerance.size() + field.radius()
}

/// The paper: every pair stands for itself.
fn by_correlation(
    matches: &Matches,
    candidate: &Candidate,
    samples: &mut FaceSamples,
    options: &Options,
) -> Option<ValidatedPlane> {
    let pair = candidate.pair?;
    let [a, b] = matches.pairs[pair as usize].faces;
    let correlation = samples.correlation(a, b, &candidate.plane)?;
    (correlation >= options.correlation).then(|| ValidatedPlane {
        plane: candidate.plane,
        residual: candidate.residual,
        weight: candidate.weight,
        source: candidate.source,
        pairs: vec![pair],
        correlation: Some(correlation),
        coarse: 0.0,
    })
}

/// Candidates that are one plane.
#[derive(Clone, Debug)]
struct Group {
    plane: Plane,
    residual: f64,
    weight: f64,
    source: Source,
    /// Whether two different faces speak for it. Every face that turns about an axis, and many a single face, has
    /// planes of its own: without a pair, only nearly the whole surface shows that the model shares them.
    paired: bool,
    /// The first few pairs, largest votes first.
    pairs: SmallVec<[u32; 4]>,
}

/// Joins candidates into distinct planes by leaders, the most reliable source and the largest vote first, and keeps
/// the most voted planes of each source.
fn distinct(
    parsed: &Parsed,
    outlines: &[Outline],
    matches: &Matches,
    candidates: &[Candidate],
    options: &Options,
    cancel: &Cancel,
) -> Result<Vec<Group>, Cancelled> {
    let measures = &parsed.measures;
    let mut order: Vec<_> = candidates.iter().filter(|c| c.plane.offset.is_finite()).collect();
    order.sort_by(|a, b| a.source.cmp(&b.source).then(b.weight.total_cmp(&a.weight)));
    let distance = measures.tolerance.length(options.same_offset);
    let mut index = PlaneIndex::new(measures.centroid, options.same_angle_deg.to_radians(), distance);
    let of_two = |c: &Candidate| c.pair.is_some_and(|i| matches.pairs[i as usize].is_of_two());
    let (mut groups, mut corners) = (Vec::<Group>::new(), Corners::default());
    for candidate in order {
        cancel.check()?;
        if let Some(i) = index.find(&candidate.plane) {
            groups[i].weight += candidate.weight;
            groups[i].paired |= of_two(candidate);
            if groups[i].pairs.len() < options.pairs {
                groups[i].pairs.extend(candidate.pair);
            }
        } else {
            let Candidate { plane, residual, weight, source, pair, .. } =
                fitted(candidate, matches, outlines, &mut corners);
            index.add(plane);
            let paired = of_two(candidate);
            groups.push(Group { plane, residual, weight, source, paired, pairs: pair.into_iter().collect() });
        }
    }
    groups.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    let mut taken = std::collections::BTreeMap::<Source, usize>::new();
    groups.retain(|g| {
        let count = taken.entry(g.source).or_default();
        *count += 1;
        *count <= options.planes
    });
    Ok(groups)
}

/// The candidate, fitted to all corners of its pair where it lies halfway: what stands for others is to be exact.
fn fitted(candidate: &Candidate, matches: &Matches, outlines: &[Outline], corners: &mut Corners) -> Candidate {
    let pair = candidate.pair.filter(|_| candidate.halfway);
    let fit = pair.and_then(|i| {
        corners.clear();
        corners.add(&matches.pairs[i as usize], outlines);
        mirror::fit(&corners.from, &corners.to)
    });
    let of_fit = |f: mirror::Fit| Candidate { plane: f.plane, residual: f.squared.max(0.0).sqrt(), ..*candidate };
    fit.map_or(*candidate, of_fit)
}

/// Support from which a plane needs no pair to speak for it: the halves may be split differently.
const SELF_EVIDENT: f64 = 0.9;
/// Three standard deviations and more of a share near it measured by 500 samples.
const DOUBT: f64 = 0.05;

/// Checks the pairs of a plane; `None` where it has pairs and all of them fail.
fn check(
    group: Group,
    coarse: f64,
    matches: &Matches,
    field: &SurfaceField,
    samples: &mut FaceSamples,
) -> Option<ValidatedPlane> {
    let had_pairs = !group.pairs.is_empty();
    let mut correlations = Vec::new();
    let mut passes = |pair: &u32| {
        let [a, b] = matches.pairs[*pair as usize].faces;
        let (correlation, mirrored) = samples.compared(a, b, &group.plane, field);
        correlations.extend(correlation);
        mirrored
    };
    let pairs: Vec<_> = group.pairs.into_iter().filter(|pair| passes(pair)).collect();
    let mean = correlations.iter().sum::<f64>() / correlations.len() as f64;
    if had_pairs && pairs.is_empty() && coarse < SELF_EVIDENT {
        return None;
    }
    let correlation = (!correlations.is_empty()).then_some(mean);
    let Group { plane, residual, weight, source, .. } = group;
    Some(ValidatedPlane { plane, residual, weight, source, pairs, correlation, coarse })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::geometry::{Transform, Vector};
    use crate::stages::fixture::{cuboid, solid};
    use crate::stages::pair_match::{Correspondence, FacePair, Order};

    #[test]
    fn a_plane_that_maps_a_share_is_no_farther_away_than_that_allows() {
        // A bar of 4 x 1 x 1 beside a unit cube: the bar's own plane x = 2 maps 18 of 24, and the centroid is at
        // (18 * 2 + 6 * 5.5) / 24 = 2.875.
        let cube = cuboid(1.0, 1.0, 1.0).into_iter().map(|f| f.iter().map(|p| p + Vector::x() * 5.0).collect());
        let polygons: Vec<_> = cuboid(4.0, 1.0, 1.0).into_iter().chain(cube).collect();
        let parsed = solid(&polygons, &Transform::identity());
        let field = SurfaceField::new(&parsed, 2000, 0.004, 0.866, &Cancel::new()).unwrap();
        let plane = Plane { normal: Vector::x(), offset: 2.0 };
        let support = field.support(&parsed.mesh, &plane.reflection(), &Cancel::new()).unwrap();
        assert!((support.share - 0.75).abs() <= 4.0 * support.error.max(1e-3), "{support:?}");
        let distance = plane.signed_distance(&parsed.measures.centroid).abs();
        assert!((distance - 0.875).abs() < 1e-9);
        assert!(distance <= farthest(&parsed, &field, support.share));
        assert!(distance > farthest(&parsed, &field, 0.95));
    }

    #[test]
    fn what_stands_for_a_plane_is_fitted_to_all_corners() {
        // A square at x = 1 and its image, one corner of which lies 4e-10 farther away: halfway between the corners
        // that are farthest apart the plane is 2e-10 off at all of them, through the middle of all 0.5e-10.
        let square = [[1.0, 0.0, 0.0], [1.0, 2.0, 0.0], [1.0, 2.0, 2.0], [1.0, 0.0, 2.0]].map(Point::from);
        let mut image = square.map(|p| Point::new(-p.x, p.y, p.z));
        image[0].x -= 4e-10;
        let outline = |corners: &[Point]| Outline {
            faces: Default::default(),
            corners: corners.into(),
            perimeter: 8.0,
            inner: Vec::new(),
            area: 4.0,
            centroid: Point::origin(),
            axis: None,
            oriented: true,
            shape: None,
        };
        let outlines = [outline(&square), outline(&image)];
        let corners = (0..4).map(|i| (i, i)).collect();
        let correspondence = Correspondence::Listed { corners, order: Order::Reversed };
        let matches =
            Matches { pairs: vec![FacePair { faces: [0, 1], correspondence, weight: 1.0 }], ..Matches::default() };
        let plane = mirror::halfway(&square, &image, 1e-9, 1e-3).unwrap();
        let candidate =
            Candidate { plane, residual: 0.0, weight: 8.0, source: Source::Corners, pair: Some(0), halfway: true };
        let parsed = solid(&cuboid(2.0, 2.0, 2.0), &Transform::identity());
        let groups = distinct(&parsed, &outlines, &matches, &[candidate], &Options::default(), &Cancel::new()).unwrap();
        let fit = mirror::fit(&square, &image).unwrap();
        assert_eq!((groups.len(), groups[0].plane, groups[0].residual), (1, fit.plane, fit.squared.sqrt()));
        let middle = Point::new(-0.5e-10, 1.0, 1.0);
        assert!((plane.signed_distance(&middle).abs() - 1.5e-10).abs() < 1e-14);
        assert!(groups[0].plane.signed_distance(&middle).abs() < 1e-14 && groups[0].residual > 0.0);
    }
}
