//! Comma-separated text.

use std::fmt::Display;
use std::path::Path;

use super::{Facts, frame, make};
use crate::error::{Result, RunError};
use crate::stages::descriptor::{MAGNITUDES, PHASES};
use crate::store::Store;

/// Writes `models.csv` (one model a line: id, hash, label, coverage, counts, measures; with a head) and
/// `<method>.magnitude.csv`, `<method>.phase.csv`, `<method>.frame.csv` (id and its numbers, no head) into `dir`. Numbers
/// have as many digits as give the same number again.
pub fn csv(store: &Store, dir: &Path) -> Result<()> {
    make(dir)?;
    let path = dir.join("models.csv");
    written(&path, |table| {
        (0..store.len()).try_for_each(|i| table.serialize(Facts::of(store, i)?).map_err(|e| error(&path, e)))
    })?;
    for &method in store.methods() {
        let file = |kind: &str| dir.join(format!("{}.{kind}.csv", method.name()));
        let arrays = [("magnitude", store.magnitudes(method), MAGNITUDES), ("phase", store.phases(method), PHASES)];
        for (kind, numbers, columns) in arrays {
            let of = numbers?.chunks_exact(columns).map(Ok);
            rows(store, &file(kind), of)?;
        }
        rows(store, &file("frame"), (0..store.len()).map(|i| frame(store, method, i)))?;
    }
    Ok(())
}

/// Each model's id and numbers.
fn rows<T: Display>(store: &Store, path: &Path, numbers: impl Iterator<Item = Result<impl AsRef<[T]>>>) -> Result<()> {
    written(path, |table| {
        numbers.enumerate().try_for_each(|(i, row)| {
            let row = row?;
            let numbers = row.as_ref().iter().map(T::to_string);
            let record = std::iter::once(store.id(i).to_owned()).chain(numbers);
            table.write_record(record).map_err(|e| error(path, e))
        })
    })
}

fn written(path: &Path, fill: impl FnOnce(&mut csv::Writer<std::fs::File>) -> Result<()>) -> Result<()> {
    let mut table = csv::Writer::from_path(path).map_err(|e| error(path, e))?;
    fill(&mut table)?;
    table.flush().map_err(|e| RunError::file(path, e))
}

fn error(path: &Path, error: csv::Error) -> RunError {
    RunError::file(path, std::io::Error::other(error))
}
