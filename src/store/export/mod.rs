//! Stores for other tools: NumPy arrays, Parquet and CSV.

mod csv;
mod npy;
mod parquet;

use std::path::Path;

use serde::Serialize;

pub use self::csv::csv;
pub use self::npy::npy;
pub use self::parquet::parquet;

use super::Store;
use crate::alignment::Method;
use crate::error::{Result, RunError};

/// What the tables of models tell of one.
#[derive(Serialize)]
struct Facts {
    id: String,
    hash: String,
    label: &'static str,
    coverage: f64,
    solids: u64,
    faces: u64,
    triangles: u64,
    area_mm2: f64,
    volume_mm3: f64,
    source: &'static str,
}

impl Facts {
    fn of(store: &Store, i: usize) -> Result<Self> {
        let s = store.summary(i)?;
        Ok(Self {
            id: store.id(i).to_owned(),
            hash: blake3::Hash::from_bytes(store.hash(i)).to_string(),
            label: s.label.name(),
            coverage: s.planes.first().map_or(0.0, |plane| plane.coverage),
            solids: s.solids as u64,
            faces: s.faces as u64,
            triangles: s.triangles as u64,
            area_mm2: s.area_mm2,
            volume_mm3: s.volume_mm3,
            source: s.source.name(),
        })
    }
}

/// The 12 numbers of the frame of model `i`.
fn frame(store: &Store, method: Method, i: usize) -> Result<[f64; 12]> {
    Ok(super::record::frame_numbers(&store.frame(method, i)?))
}

fn make(dir: &Path) -> Result<()> {
    std::fs::create_dir_all(dir).map_err(|e| RunError::file(dir, e))
}
