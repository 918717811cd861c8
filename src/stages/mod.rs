//! The method, in eight stages. Each is a pure function from the output of earlier stages to its own.
//!
//! 1. [`parse`] reads the bytes of a CAD file (STEP, IGES, OCCT `.brep`) into a B-rep, its mesh and its measures.
//! 2. [`corner_filter`] merges faces split by the exporter and finds the corners of each outline.
//! 3. [`pair_match`] finds the pairs of faces whose corners, in order, are equally far apart.
//! 4. [`isometry`] fits to each pair the isometry that maps the corners of one face to the other's.
//! 5. [`validate`] keeps the candidates that also map the surfaces of the faces onto each other.
//! 6. [`merge`] joins equal symmetries and ranks them: the dominant (possibly partial) symmetry.
//! 7. [`projection_sweep`] turns a plane about the symmetry normal until the projected area is smallest: the frame.
//! 8. [`descriptor`] draws the three silhouettes and describes their contours by Fourier coefficients.

pub mod corner_filter;
pub mod descriptor;
#[cfg(test)]
pub mod fixture;
pub mod isometry;
pub mod merge;
pub mod pair_match;
pub mod parse;
pub mod projection_sweep;
pub mod validate;

use crate::cancel::Cancelled;

/// The eight stages in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// Section III: the bytes of a file -> model.
    Parse,
    /// Section IV.B: corners of the faces.
    CornerFilter,
    /// Eq. (3): pairs of faces.
    PairMatch,
    /// Section IV.C: candidate isometries.
    Isometry,
    /// Section IV.D, eq. (6): validated symmetries.
    Validate,
    /// Section IV.E, eq. (7): the dominant symmetry.
    Merge,
    /// Section V: the canonical frame.
    ProjectionSweep,
    /// Section VI: silhouettes and Fourier descriptors.
    Descriptor,
}

impl Stage {
    /// All stages in order.
    pub const ALL: [Self; 8] = [
        Self::Parse,
        Self::CornerFilter,
        Self::PairMatch,
        Self::Isometry,
        Self::Validate,
        Self::Merge,
        Self::ProjectionSweep,
        Self::Descriptor,
    ];

    /// The name in settings, logs and JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Parse => "parse",
            Self::CornerFilter => "corner_filter",
            Self::PairMatch => "pair_match",
            Self::Isometry => "isometry",
            Self::Validate => "validate",
            Self::Merge => "merge",
            Self::ProjectionSweep => "projection_sweep",
            Self::Descriptor => "descriptor",
        }
    }
}

/// Memory that stages fill anew for each model instead of taking it anew. What is in it means nothing: a stage begins by
/// emptying its part.
#[derive(Default)]
pub struct Scratch {
    /// Of [`parse::parse_in`].
    pub parse: parse::Scratch,
    /// Of [`corner_filter::corner_filter_in`].
    pub corner_filter: corner_filter::Scratch,
}

impl Scratch {
    /// Bytes of memory that it holds.
    pub fn bytes(&self) -> usize {
        self.parse.bytes() + self.corner_filter.bytes()
    }
}

/// Why one model was lost; it travels as data and the run goes on.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, serde::Serialize, serde::Deserialize)]
#[error("{}: {why}{}", stage.name(), entity.map(|e| format!(" (#{e})")).unwrap_or_default())]
pub struct ModelError {
    /// Where it was lost.
    pub stage: Stage,
    /// The reason, for people.
    pub why: String,
    /// The entity of the file where it happened, if there is one.
    pub entity: Option<u64>,
}

impl ModelError {
    /// An error of `stage` that no single entity is to blame for.
    pub fn new(stage: Stage, why: impl Into<String>) -> Self {
        Self { stage, why: why.into(), entity: None }
    }

    /// An error of `stage` at an entity of the file.
    pub fn at(stage: Stage, entity: u64, why: impl Into<String>) -> Self {
        Self { stage, why: why.into(), entity: Some(entity) }
    }

    /// The work was cancelled in `stage`.
    pub fn cancelled(stage: Stage, _: Cancelled) -> Self {
        Self::new(stage, "cancelled")
    }
}
