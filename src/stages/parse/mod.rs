//! Stage 1: the bytes of a STEP file -> B-rep, mesh and measures.

use crate::brep::measure::Measures;
use crate::brep::{Mesh, Model, Skipped};

/// A model as read: what the later stages work on.
#[derive(Clone, Debug)]
pub struct Parsed {
    pub model: Model,
    /// The faces of all occurrences, tessellated, in place.
    pub mesh: Mesh,
    pub measures: Measures,
    /// Entities that were left out, with the reason.
    pub skipped: Vec<Skipped>,
    /// Things that were mended or guessed.
    pub warnings: Vec<String>,
}
