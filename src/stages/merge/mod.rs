//! Stage 6: validated symmetries -> the dominant symmetry.
//!
//! In: [`Validated`] planes. Out: [`Symmetries`]: the label, the planes best first with their evidence, the axis.
//!
//! Method: section IV.E. To the planes that faces speak for come those across the principal axes of the surface
//! (`principal`), those of a body of revolution (`revolution`), and what exact planes imply together (`closure`). All are ranked by surface support: the share of the
//! area whose mirror image lies on the surface, measured in rounds, the last one only for
//! planes that may tie with the best and have a standard error above 0.1 %. Ties
//! are settled by `rank`. The faces that are each other's image (`evidence`) are looked up afterwards. The paper's
//! own choice, the largest bounding box of symmetric faces, is in `paper`.
//!
//! Cost: a few full passes over the samples, each n log n in the triangles. It does not promise partial planes
//! that neither faces nor principal axes suggest.

mod closure;
mod evidence;
mod open;
mod paper;
mod principal;
mod rank;
mod revolution;
#[cfg(test)]
mod tests;

use evidence::Images;

use crate::alignment::cpca;
use crate::brep::PlacedFaceId;
use crate::cancel::{Cancel, Cancelled};
pub use crate::geometry::Axis;
use crate::geometry::{Matrix, Plane, PlaneIndex};
use crate::stages::corner_filter::Outline;
use crate::stages::isometry::{Repeats, Source, mirror};
use crate::stages::pair_match::{Corners, Matches};
use crate::stages::parse::Parsed;
use crate::stages::validate::support::Support;
use crate::stages::validate::{Validated, ValidatedPlane};
use crate::stages::{ModelError, Stage};

/// Settings of the stage.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Two planes are one up to this angle, degrees ..
    pub same_angle_deg: f64,
    /// .. and this distance, as a share of D.
    pub same_offset: f64,
    /// Choose by the paper's rule: eq. (7) up to `paper_distance`, then the largest bounding box.
    pub paper: bool,
    /// Largest distance of eq. (7) within one symmetry.
    pub paper_distance: f64,
    /// Least support of an exact symmetry.
    pub exact: f64,
    /// Least support of a near-global symmetry.
    pub near_global: f64,
    /// Least support of a partial symmetry; below there is none.
    pub partial: f64,
    /// Below `near_global`, whole faces that the plane maps onto faces must make up this share of its coverage (and
    /// `partial` of the area). A third: where the halves are split differently, the faces of true planes make up
    /// 0.35 to 0.55; of accidents, next to nothing.
    pub confirmed: f64,
    /// Planes are reported down to this share below the best.
    pub reported: f64,
    /// Supports closer than this are a tie; 0.02 is too wide.
    pub tie: f64,
    /// Try the planes across the principal axes.
    pub principal: bool,
    /// Least support under rotations of a body of revolution.
    pub revolution: f64,
    /// Planes measured at most.
    pub finalists: usize,
    /// Planes times faces for which evidence is looked up at most (the best plane always has it).
    pub evidence: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            same_angle_deg: 0.5,
            same_offset: 0.002,
            paper: false,
            paper_distance: 1e-3,
            exact: 0.995,
            near_global: 0.9,
            partial: 0.1,
            confirmed: 0.33,
            reported: 0.05,
            tie: 0.005,
            principal: true,
            revolution: 0.99,
            finalists: 128,
            evidence: 100_000,
        }
    }
}

impl Options {
    /// The paper's reading.
    pub fn paper() -> Self {
        Self { paper: true, principal: false, ..Self::default() }
    }
}

/// How much of the surface the best plane maps onto the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Label {
    /// Coverage >= 0.995.
    Exact,
    /// Coverage >= 0.9.
    NearGlobal,
    /// Coverage >= 0.1.
    Partial,
    /// Less, or nothing confirmed.
    None,
}

impl Label {
    /// The name in JSON and text.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::NearGlobal => "near-global",
            Self::Partial => "partial",
            Self::None => "none",
        }
    }
}

/// A mirror plane with its evidence.
#[derive(Clone, Debug)]
pub struct SymmetryPlane {
    /// The plane.
    pub plane: Plane,
    /// Surface support: the share of the whole surface's area whose mirror image lies on the surface.
    pub coverage: f64,
    /// Standard error of the coverage, by the number of samples.
    pub error: f64,
    /// Root mean square of the distances of mirrored corners (or samples) to their images, mm.
    pub residual: f64,
    /// Faces that are each other's mirror image.
    pub pairs: Vec<(PlacedFaceId, PlacedFaceId)>,
    /// Faces that the plane cuts into mirror images.
    pub selfs: Vec<PlacedFaceId>,
    /// What suggested the plane.
    pub source: Source,
    /// Mean histogram correlation of eq. (6) over the checked pairs, where it is defined: a diagnostic.
    pub correlation: Option<f64>,
}

impl SymmetryPlane {
    /// Takes note of a support that was measured.
    fn set_support(&mut self, by: Support) {
        (self.coverage, self.error) = (by.share, by.error);
    }
}

/// The symmetries of a model, best plane first.
#[derive(Clone, Debug)]
pub struct Symmetries {
    /// How much of the surface the best plane maps onto itself.
    pub label: Label,
    /// Mirror planes, best first.
    pub planes: Vec<SymmetryPlane>,
    /// The axis of a body of revolution.
    pub axes: Vec<Axis>,
    /// Faces that direct isometries map onto others.
    pub repeats: Repeats,
    /// Of the surface, mm^2: the stages to come look for its axes, too.
    pub covariance: Matrix,
}

/// Finds the dominant symmetry.
///
/// # Errors
/// Only when cancelled.
pub fn merge(
    parsed: &Parsed,
    outlines: &[Outline],
    matches: &Matches,
    validated: &Validated,
    options: &Options,
    cancel: &Cancel,
) -> Result<Symmetries, ModelError> {
    let covariance = cpca::covariance(&parsed.mesh);
    let merger = Merger { parsed, outlines, matches, validated, options, cancel, covariance };
    merger.run().map_err(|c| ModelError::cancelled(Stage::Merge, c))
}

/// How many standard errors are beyond doubt.
const SURE: f64 = 3.0;
/// The standard error of a share measured by 500 samples; what such a share is in doubt by, and one by 4,000.
const COARSE_ERROR: f64 = 0.02;
const COARSE_DOUBT: f64 = SURE * COARSE_ERROR;
const MIDDLE_DOUBT: f64 = 0.02;
/// The standard error that tells supports apart: a fifth of a tie.
const FINE_ERROR: f64 = 1e-3;

/// What the steps of the stage share.
struct Merger<'a> {
    parsed: &'a Parsed,
    outlines: &'a [Outline],
    matches: &'a Matches,
    validated: &'a Validated,
    options: &'a Options,
    cancel: &'a Cancel,
    /// Of the surface, mm^2.
    covariance: Matrix,
}

impl Merger<'_> {
    fn run(&self) -> Result<Symmetries, Cancelled> {
        let look_up = evidence::look_up();
        let mut images = Images::of(self, &look_up);
        let (planes, axes) = if self.options.paper {
            (paper::planes(self)?, Vec::new())
        } else {
            let axes = revolution::axes(self)?;
            let mut pool = self.pool(&axes)?;
            self.measure(&mut pool, &mut images)?;
            (rank::ordered(self, pool)?, axes)
        };
        let best = planes.first().map_or(0.0, |p| p.coverage);
        let label = self.label(best);
        let mut planes = if label == Label::None { Vec::new() } else { planes };
        images.add_to(&mut planes)?;
        Ok(Symmetries { label, planes, axes, repeats: self.validated.repeats, covariance: self.covariance })
    }

    fn label(&self, coverage: f64) -> Label {
        match coverage {
            c if c >= self.options.exact => Label::Exact,
            c if c >= self.options.near_global => Label::NearGlobal,
            c if c >= self.options.partial => Label::Partial,
            _ => Label::None,
        }
    }

    fn index(&self) -> PlaneIndex {
        let measures = &self.parsed.measures;
        let distance = measures.tolerance.length(self.options.same_offset);
        PlaneIndex::new(measures.centroid, self.options.same_angle_deg.to_radians(), distance)
    }

    /// All distinct planes with their coarse support.
    fn pool(&self, axes: &[Axis]) -> Result<Vec<SymmetryPlane>, Cancelled> {
        let mut pool: Vec<_> = self.validated.planes.iter().map(|p| self.refitted(p)).collect();
        revolution::restrict(self, axes, &mut pool)?;
        // A body of revolution leaves its principal axes across open, and has its planes already.
        if self.options.principal && axes.is_empty() {
            pool.extend(principal::planes(self, &pool)?);
        }
        let mut index = self.index();
        pool.retain(|p| {
            let new = index.find(&p.plane).is_none();
            if new {
                index.add(p.plane);
            }
            new
        });
        if axes.is_empty() {
            closure::close(self, &mut pool, &mut index)?;
        }
        Ok(pool)
    }

    /// The plane fitted again to the corners of all its pairs, where its own fit is not exact already.
    fn refitted(&self, validated: &ValidatedPlane) -> SymmetryPlane {
        let (mut plane, mut residual) = (validated.plane, validated.residual);
        let exact = self.parsed.measures.tolerance.length(1e-6);
        if residual > exact && validated.pairs.len() > 1 {
            let mut corners = Corners::default();
            validated.pairs.iter().for_each(|&i| corners.add(&self.matches.pairs[i as usize], self.outlines));
            if let Some(fit) = mirror::fit(&corners.from, &corners.to)
                && fit.squared.sqrt() <= residual
            {
                (plane, residual) = (fit.plane, fit.squared.sqrt());
            }
        }
        SymmetryPlane {
            plane,
            coverage: validated.coarse,
            error: COARSE_ERROR,
            residual,
            pairs: Vec::new(),
            selfs: Vec::new(),
            source: validated.source,
            correlation: validated.correlation,
        }
    }

    /// Replaces the coarse support of the best planes by a better one and drops the others.
    fn measure(&self, pool: &mut Vec<SymmetryPlane>, images: &mut Images) -> Result<(), Cancelled> {
        self.keep_best(pool, images, COARSE_DOUBT)?;
        pool.truncate(self.options.finalists);
        self.measure_middle(pool)?;
        self.keep_best(pool, images, MIDDLE_DOUBT)?;
        self.measure_rivals(pool)?;
        images.keep_confirmed(pool, 0.0)?;
        // Faces speak for the other sources; across a principal axis a small share fits by accident.
        pool.retain(|p| p.source != Source::Principal || p.coverage >= self.options.near_global);
        self.keep_near_best(pool, 0.0);
        Ok(())
    }

    /// Sorts the planes, best first, and drops those that are out of the question in spite of the doubt.
    fn keep_best(&self, pool: &mut Vec<SymmetryPlane>, images: &mut Images, doubt: f64) -> Result<(), Cancelled> {
        pool.sort_by(|a, b| b.coverage.total_cmp(&a.coverage));
        // A plane that is out of the question must not push others out.
        images.keep_confirmed(pool, doubt)?;
        self.keep_near_best(pool, doubt);
        Ok(())
    }

    /// Measures all planes by the samples of two rounds; a plane only as far as it may be near the best.
    fn measure_middle(&self, pool: &mut [SymmetryPlane]) -> Result<(), Cancelled> {
        let mut best = 0.0;
        for plane in pool {
            let needed = self.near_best(best, MIDDLE_DOUBT);
            let support = self.validated.field.middle(&plane.plane.reflection(), needed, self.cancel)?;
            plane.set_support(support);
            // Others may still be dropped, and the bound with them.
            if plane.coverage >= self.options.near_global {
                best = plane.coverage.max(best);
            }
        }
        Ok(())
    }

    /// Measures the planes that may tie with the best one by all samples, where they are still in doubt.
    fn measure_rivals(&self, pool: &mut [SymmetryPlane]) -> Result<(), Cancelled> {
        let Some(best) = pool.first() else { return Ok(()) };
        let tied = best.coverage - self.options.tie - SURE * best.error;
        let may_tie = |p: &SymmetryPlane| p.coverage + SURE * p.error >= tied;
        for plane in pool.iter_mut().filter(|p| may_tie(p) && self.is_in_doubt(p)) {
            let known = Support { share: plane.coverage, error: plane.error };
            let reflection = plane.plane.reflection();
            plane.set_support(self.validated.field.completed(&self.parsed.mesh, &reflection, known, self.cancel)?);
        }
        Ok(())
    }

    /// Whether the coverage is not told well enough: from those of others, or for the label.
    fn is_in_doubt(&self, plane: &SymmetryPlane) -> bool {
        let SymmetryPlane { coverage, error, .. } = *plane;
        let bounds = [self.options.exact, self.options.near_global, self.options.partial];
        error > FINE_ERROR || bounds.iter().any(|bound| (coverage - bound).abs() <= SURE * error)
    }

    /// The least coverage that is reported beside the best one, where both are in doubt.
    fn near_best(&self, best: f64, doubt: f64) -> f64 {
        best * (1.0 - self.options.reported) - doubt
    }

    fn keep_near_best(&self, pool: &mut Vec<SymmetryPlane>, doubt: f64) {
        let best = pool.iter().map(|p| p.coverage).fold(0.0, f64::max);
        pool.retain(|p| p.coverage >= self.near_best(best, doubt) && p.coverage > 0.0);
    }
}
