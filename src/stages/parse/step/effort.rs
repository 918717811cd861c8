//! How often a file may be read over.

use std::cell::Cell;

use crate::cancel::Cancel;
use crate::stages::parse::fault::{Fault, Read};

/// How often each byte may be decoded on average. Real files stay below 2; a small file in which many references lead
/// to a few long instances would take hours.
const READINGS: usize = 16;
/// Bytes that may always be decoded.
const FREE: usize = 1 << 20;
/// What finding an instance counts for, bytes.
const LOOKUP: usize = 16;

/// What is left of the bytes that may be decoded, and whether the work should stop: asked for each instance.
#[derive(Debug, Default)]
pub(super) struct Effort {
    left: Cell<usize>,
    cancel: Cancel,
}

impl Effort {
    /// For a file of `bytes` bytes.
    pub fn new(bytes: usize, cancel: &Cancel) -> Self {
        Self { left: Cell::new(bytes.saturating_mul(READINGS).saturating_add(FREE)), cancel: cancel.clone() }
    }

    /// Counts decoded bytes.
    pub fn spend(&self, bytes: usize) {
        self.left.set(self.left.get().saturating_sub(bytes));
    }

    /// Counts an instance that is looked up.
    ///
    /// # Errors
    /// Where nothing is left, and when cancelled.
    pub fn check(&self, id: u64) -> Read<()> {
        self.spend(LOOKUP);
        if self.left.get() == 0 {
            return Err(Fault::new(id, "references multiply beyond the file's size"));
        }
        self.cancel.check().map_err(|c| Fault::new(id, c.to_string()))
    }
}
