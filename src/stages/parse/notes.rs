//! What was left out or mended while reading.

use super::fault::Fault;
use crate::brep::Skipped;

/// More warnings than this are only counted.
const MOST_WARNINGS: usize = 200;

/// More entities than this are only counted: a broken list may name millions.
const MOST_SKIPPED: usize = 20_000;

/// The entities skipped and the warnings of one file.
#[derive(Debug, Default)]
pub(super) struct Notes {
    skipped: Vec<Skipped>,
    more_skipped: usize,
    warnings: Vec<String>,
    unsaid: usize,
}

impl Notes {
    /// Something was mended or guessed.
    pub fn warn(&mut self, text: String) {
        if self.warnings.len() < MOST_WARNINGS { self.warnings.push(text) } else { self.unsaid += 1 }
    }

    /// `entity` is left out because of `fault`.
    pub fn skip(&mut self, entity: u64, fault: Fault) {
        if self.skipped.len() >= MOST_SKIPPED {
            self.more_skipped += 1;
            return;
        }
        let why = if fault.entity == entity { fault.why.into() } else { format!("#{}: {}", fault.entity, fault.why) };
        let skipped = Skipped { entity, why };
        if self.skipped.last() != Some(&skipped) {
            self.skipped.push(skipped);
        }
    }

    /// All that was noted.
    pub fn finish(mut self) -> (Vec<Skipped>, Vec<String>) {
        if self.unsaid > 0 {
            self.warnings.push(format!("and {} more warnings", self.unsaid));
        }
        if self.more_skipped > 0 {
            self.warnings.push(format!("{} more entities were left out", self.more_skipped));
        }
        (self.skipped, self.warnings)
    }
}
