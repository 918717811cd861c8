//! What may stop a run. What may stop one model is [`crate::stages::ModelError`], which travels as data.

use std::path::PathBuf;

/// An error after which the program cannot go on: exit code 2.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    #[error("settings: {0}")]
    Settings(String),
    #[error("{path}: {source}")]
    File { path: PathBuf, source: std::io::Error },
    #[error("store {path}: {why}")]
    Store { path: PathBuf, why: String },
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
