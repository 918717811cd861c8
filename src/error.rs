//! What may stop a run. What may stop one model is [`crate::stages::ModelError`], which travels as data.

use std::path::PathBuf;

/// An error after which the program cannot go on: exit code 2.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// Settings that cannot be used.
    #[error("settings: {0}")]
    Settings(String),
    /// A file that cannot be read or written.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A store that is damaged, of another version or of other settings.
    #[error("store {path}: {why}")]
    Store {
        /// The published file.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
    /// Anything else that was asked for and cannot be done.
    #[error("{0}")]
    Usage(String),
}

impl RunError {
    /// An input or output error with the path it happened on.
    pub fn file(path: impl Into<PathBuf>, source: std::io::Error) -> Self {
        Self::File { path: path.into(), source }
    }
}

/// The result of anything that may stop a run.
pub type Result<T> = std::result::Result<T, RunError>;
