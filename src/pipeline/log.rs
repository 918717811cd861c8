//! The log of a run: one JSON line a model, with the times that the published file leaves out.

use std::fs::{File, OpenOptions};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};

use super::parcel::{Job, Seconds};
use crate::error::{Result, RunError};
use crate::stages::{ModelError, Stage};

/// The log of the store in `dir`.
pub fn path(dir: &Path) -> PathBuf {
    dir.join("run.log.jsonl")
}

/// An open log; each run appends.
pub struct Log {
    path: PathBuf,
    file: BufWriter<File>,
}

impl Log {
    pub fn open(dir: &Path) -> Result<Self> {
        let path = path(dir);
        let file = OpenOptions::new().append(true).create(true).open(&path).map_err(|e| RunError::file(&path, e))?;
        Ok(Self { path, file: BufWriter::new(file) })
    }

    /// Notes that a model arrived.
    pub fn model(&mut self, job: &Job, error: Option<&ModelError>) -> Result<()> {
        let line = json!({
            "model": job.id,
            "bytes": job.bytes,
            "seconds": by_stage(&job.seconds()),
            "error": error.map(|e| json!({"stage": e.stage.name(), "why": e.why, "entity": e.entity})),
        });
        writeln!(self.file, "{line}").map_err(|e| RunError::file(&self.path, e))
    }

    pub fn flush(&mut self) -> Result<()> {
        self.file.flush().map_err(|e| RunError::file(&self.path, e))
    }
}

/// Seconds under the names of the stages.
pub fn by_stage(seconds: &Seconds) -> Value {
    let named = Stage::ALL.iter().zip(seconds).map(|(stage, s)| (stage.name().to_owned(), json!(s)));
    Value::Object(named.collect::<Map<_, _>>())
}
