//! Princeton distance matrices (`.matrix`): N * N little-endian f32, row by row, in the order of a `.cla` file.

use super::super::ranking::{Entrant, each_row};
use super::create;
use crate::error::{Result, RunError};
use std::path::Path;

/// Reads the matrix of `n` models.
///
/// # Errors
/// A file that cannot be read, has another size, or holds a number that is NaN.
pub fn read(path: &Path, n: usize) -> Result<Vec<f32>> {
    let size = std::fs::metadata(path).map_err(|source| RunError::file(path, source))?.len();
    let wrong = |why: String| RunError::Usage(format!("matrix {}: {why}", path.display()));
    if size != (n as u64).saturating_mul(n as u64).saturating_mul(4) {
        return Err(wrong(format!("{n} models need {n} * {n} * 4 bytes, it has {size}")));
    }
    let bytes = std::fs::read(path).map_err(|source| RunError::file(path, source))?;
    let values: Vec<_> = bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
    match values.iter().position(|value| value.is_nan()) {
        Some(at) => Err(wrong(format!("row {}, column {} is not a number", at / n, at % n))),
        None => Ok(values),
    }
}

/// Writes the distances of `entrant` on `n` models, some rows in memory at a time.
///
/// # Errors
/// Where the file cannot be written.
pub fn write(path: &Path, n: usize, entrant: &Entrant) -> Result<()> {
    create(path, |out| {
        each_row(n, entrant, |_, row| {
            let bytes: Vec<_> = row.iter().flat_map(|&distance| (distance as f32).to_le_bytes()).collect();
            out.write_all(&bytes).map_err(|source| RunError::file(path, source))
        })
        .map_err(|error| match error {
            RunError::File { source, .. } => source,
            other => std::io::Error::other(other),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("line.matrix");
        let entrant = Entrant { name: "line".into(), distance: Box::new(|a, b| a.abs_diff(b) as f64 / 2.0) };
        write(&path, 3, &entrant).unwrap();
        assert_eq!(read(&path, 3).unwrap(), [0.0, 0.5, 1.0, 0.5, 0.0, 0.5, 1.0, 0.5, 0.0]);
        assert!(read(&path, 4).unwrap_err().to_string().contains("4 * 4 * 4"));
    }

    #[test]
    fn nan_is_refused_at_the_door() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("nan.matrix");
        std::fs::write(&path, [0.0f32, 1.0, f32::NAN, 0.0].map(f32::to_le_bytes).concat()).unwrap();
        assert!(read(&path, 2).unwrap_err().to_string().contains("row 1, column 0"));
    }
}
