//! Stage 4: pairs of faces -> the isometries that map one to the other, and the mirror planes among them.
//!
//! In: [`Matches`]. Out: [`Candidates`]: mirror planes with their residual, and how many faces repeat.
//!
//! Method: section IV.C. Mirrors are fitted directly as a plane (`mirror`), which is exact and needs no case for
//! coplanar corners; direct isometries by Umeyama (1991). Exact images need neither: the plane halfway between them is
//! a vote, fitted where it comes to stand for others, and three corners tell a turn. Beside the pairs, faces without corners vote by the bisector
//! planes of their centroids and by their axes (`axes`), and single faces by their own symmetries.
//!
//! Cost: linear in the pairs and their corners. It does not promise that the surfaces between the corners agree.

mod axes;
pub mod mirror;

use crate::cancel::Cancel;
use crate::geometry::{Chirality, Isometry, Plane, Point};
use crate::stages::corner_filter::Outline;
use crate::stages::pair_match::{Corners, Correspondence, FacePair, Matches, Order};
use crate::stages::parse::Parsed;
use crate::stages::{ModelError, Stage};

/// Settings of the stage.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Largest root mean square distance of corners from their images, as a share of D; above the precision of files
    /// and below any difference that is meant.
    pub residual: f64,
    /// Smallest distance of the two lowest eigenvalues of the plane fit, as a share of its largest: below it several
    /// planes fit and the pair says nothing.
    pub eigen_gap: f64,
    /// Fit mirrors by Umeyama and accept every isometry whose eigenvalue 1 is double, glides too, as the paper does.
    pub umeyama: bool,
    /// Take candidates from faces without corners: bisectors of congruent ones, and axes.
    pub cornerless: bool,
    /// Take candidates from single faces that are their own mirror images.
    pub single_faces: bool,
    /// Axes of revolution (the largest by area) whose common planes are tried.
    pub axes: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { residual: 1e-3, eigen_gap: 1e-3, umeyama: false, cornerless: true, single_faces: true, axes: 12 }
    }
}

impl Options {
    /// The paper's reading.
    pub fn paper() -> Self {
        Self { umeyama: true, cornerless: false, single_faces: false, axes: 0, ..Self::default() }
    }
}

/// Where a candidate plane comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Source {
    /// Corners of two faces.
    Corners,
    /// Corners of one face.
    SingleFace,
    /// Centroids of two congruent faces without corners.
    Bisector,
    /// Axes of faces of revolution.
    Axes,
    /// Principal axes of the surface or its normals, polished.
    Principal,
}

/// A plane in which the model may be symmetric.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// The plane.
    pub plane: Plane,
    /// Root mean square distance of the mirrored corners from their images, mm.
    pub residual: f64,
    /// Area of the faces that speak for it, times the pairs that this one stands for, mm^2.
    pub weight: f64,
    /// What suggested it.
    pub source: Source,
    /// Position of the pair in [`Matches::pairs`].
    pub pair: Option<u32>,
    /// Whether the plane lies halfway between exact images: enough for a vote, less than a fit to all corners.
    pub halfway: bool,
}

/// Faces that direct isometries map onto others.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Repeats {
    /// Faces that are the image of another one.
    pub faces: usize,
    /// Their share of all (maximal) faces: the repeated-face ratio.
    pub ratio: f64,
    /// Faces that another one is shifted to, without a turn.
    pub shifted: usize,
    /// Faces that another one is turned to (and shifted).
    pub turned: usize,
}

/// How a face is the image of another one.
#[derive(Clone, Copy, Debug, Default)]
struct Repeated {
    shifted: bool,
    turned: bool,
}

/// What the pairs say.
#[derive(Clone, Debug, Default)]
pub struct Candidates {
    /// Candidate planes.
    pub mirrors: Vec<Candidate>,
    /// Faces that direct isometries map onto others.
    pub repeats: Repeats,
}

/// Fits isometries to the matched pairs.
///
/// # Errors
/// Only when cancelled.
pub fn isometry(
    parsed: &Parsed,
    outlines: &[Outline],
    matches: &Matches,
    options: &Options,
    cancel: &Cancel,
) -> Result<Candidates, ModelError> {
    let size = parsed.measures.tolerance.size();
    let mut mirrors = Vec::new();
    let mut repeated = vec![Repeated::default(); outlines.len()];
    let mut corners = Corners::default();
    for (i, pair) in matches.pairs.iter().enumerate() {
        corners.clear();
        corners.add(pair, outlines);
        if i % 1024 == 0 {
            cancel.check().map_err(|c| ModelError::cancelled(Stage::Isometry, c))?;
        }
        mirrors.extend(mirror_of(outlines, (i as u32, pair), &corners, size, options));
        let [a, b] = pair.faces.map(|f| f as usize);
        let known = Repeated {
            shifted: repeated[a].shifted && repeated[b].shifted,
            turned: repeated[a].turned && repeated[b].turned,
        };
        if let Some(by) = direct(outlines, pair, &corners, known, size, options) {
            for face in [a, b] {
                repeated[face].shifted |= by == Direct::Shift;
                repeated[face].turned |= by == Direct::Turn;
            }
        }
    }
    if options.axes > 0 {
        mirrors.extend(axes::planes(&parsed.measures, outlines, options.axes));
    }
    let count = |of: fn(&Repeated) -> bool| repeated.iter().filter(|r| of(r)).count();
    let faces = count(|r| r.shifted || r.turned);
    let ratio = faces as f64 / outlines.len().max(1) as f64;
    let repeats = Repeats { faces, ratio, shifted: count(|r| r.shifted), turned: count(|r| r.turned) };
    Ok(Candidates { mirrors, repeats })
}

/// The mirror plane of a pair, if its corners have one.
fn mirror_of(
    outlines: &[Outline],
    (index, pair): (u32, &FacePair),
    Corners { from, to }: &Corners,
    size: f64,
    options: &Options,
) -> Option<Candidate> {
    let [a, b] = pair.faces.map(|i| &outlines[i as usize]);
    let single = pair.faces[0] == pair.faces[1];
    if single && !options.single_faces {
        return None;
    }
    let area = if single { a.area } else { a.area + b.area };
    let candidate = |plane: Plane, residual: f64, source: Source| {
        let weight = area * pair.weight;
        Candidate { plane, residual, weight, source, pair: Some(index), halfway: false }
    };
    if pair.correspondence == Correspondence::Centroids {
        let plane = if options.cornerless { axes::bisector(a, b, size)? } else { return None };
        return Some(candidate(plane, 0.0, Source::Bisector));
    }
    if pair.order() == Some(Order::Same) && a.oriented && b.oriented && !options.umeyama {
        return None;
    }
    let source = if single { Source::SingleFace } else { Source::Corners };
    let most = (options.residual * size).powi(2);
    if !options.umeyama && !mirror::may_fit(from, to, most) {
        return None;
    }
    let halfway = || mirror::halfway(from, to, EXACT * size, options.eigen_gap);
    if let Some(plane) = (!options.umeyama).then(halfway).flatten() {
        return Some(Candidate { halfway: true, ..candidate(plane, 0.0, source) });
    }
    let (plane, squared) = fitted(from, to, options)?;
    (squared <= most).then(|| candidate(plane, squared.max(0.0).sqrt(), source))
}

/// The plane that fits best, if it is the only one, and its mean squared residual, mm^2.
fn fitted(from: &[Point], to: &[Point], options: &Options) -> Option<(Plane, f64)> {
    if options.umeyama {
        let (isometry, squared) = Isometry::fit(from, to, Chirality::Improper)?;
        return Some((mirror::plane_of(&isometry, options.residual)?, squared));
    }
    let fit = mirror::fit(from, to)?;
    (fit.gap >= options.eigen_gap).then_some((fit.plane, fit.squared))
}

/// The kinds of direct isometry.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Direct {
    Shift,
    Turn,
}

/// Sine of the angle up to which a turn is none.
const NO_TURN: f64 = 1e-3;

/// Corners that are moved to within this share of D need no fit to tell by what.
const EXACT: f64 = 1e-9;

/// Whether all points are shifted alike.
fn is_shifted(from: &[Point], to: &[Point], tolerance: f64) -> bool {
    let shift = to[0] - from[0];
    from.iter().zip(to).all(|(p, q)| (q - p - shift).amax() <= tolerance)
}

/// Whether the isometry that maps the points with at most the residual may turn them by less than `NO_TURN`.
fn may_be_shifted(from: &[Point], to: &[Point], residual: f64) -> bool {
    let extent = from.iter().map(|p| (p - from[0]).norm()).fold(0.0, f64::max);
    // The root mean square of n distances is at least the largest one over the root of n.
    is_shifted(from, to, NO_TURN * extent + 2.0 * (from.len() as f64).sqrt() * residual)
}

/// The direct isometry that maps the first face of the pair to the second, if one does that is not `known` of both.
fn direct(
    outlines: &[Outline],
    pair: &FacePair,
    Corners { from, to }: &Corners,
    known: Repeated,
    size: f64,
    options: &Options,
) -> Option<Direct> {
    if !pair.is_of_two() || pair.order() == Some(Order::Reversed) || (known.shifted && known.turned) {
        return None;
    }
    let kind = |turned: bool| if turned { Direct::Turn } else { Direct::Shift };
    if pair.correspondence == Correspondence::Centroids {
        let [a, b] = pair.faces.map(|f| outlines[f as usize].axis);
        return Some(kind(a.zip(b).is_some_and(|(p, q)| p.direction.cross(&q.direction).norm() > NO_TURN)));
    }
    if from.len() < 3 {
        return None;
    }
    if is_shifted(from, to, EXACT * size) {
        return Some(Direct::Shift);
    }
    if known.turned && !may_be_shifted(from, to, options.residual * size) {
        return None;
    }
    let exact = Isometry::exact(from, to, EXACT * size).map(|isometry| (isometry, 0.0));
    let (isometry, squared) = exact.or_else(|| Isometry::fit(from, to, Chirality::Proper))?;
    let turned = (isometry.rotation - crate::geometry::Matrix::identity()).norm() > NO_TURN;
    (squared.max(0.0).sqrt() <= options.residual * size).then(|| kind(turned))
}
