//! The descriptors of an archive in a memory-mapped file: the only bytes on disk that are ours.
//!
//! A store is a folder. `models.symalign` is published whole, by rename, and never changed; [`Store`] maps it.
//! `journal.symalign` is appended to while a run goes on ([`journal`]) and lets it resume. `FORMAT.md` beside this
//! file tells both layouts. The published bytes are a function of the settings and of the models with their
//! results: not of workers, order, shards, interruptions or the clock.
//!
//! The map is `unsafe`: a published file is never written again, so what is mapped stays.

mod difference;
mod encoding;
pub mod export;
mod format;
mod ids;
pub mod journal;
pub mod lock;
pub mod merge;
mod reader;
pub mod record;
mod verify;
mod writer;

use std::path::{Path, PathBuf};

pub use difference::differences;
pub use format::{Kind, Section, VERSION, version_error, version_of};
pub use lock::Lock;
pub use reader::Store;
pub use record::{
    AxisEvidence, EVIDENCE_KEPT, Failure, Hash, ModelRecord, PLANES_KEPT, PlaneEvidence, Pose, Summary, THUMBNAIL,
};
pub use verify::Damage;
pub use writer::{Contents, publish};

/// The published file of the store in `dir`.
pub fn published_path(dir: &Path) -> PathBuf {
    dir.join("models.symalign")
}

/// The journal of the store in `dir`.
pub fn journal_path(dir: &Path) -> PathBuf {
    dir.join("journal.symalign")
}
