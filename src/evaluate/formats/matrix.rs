//! Princeton distance matrices (`.matrix`): N * N little-endian f32, row by row, in the order of a `.cla` file.

use super::super::ranking::Distances;
use crate::error::{Result, RunError};
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// A matrix that stays in its file, so that it may be larger than memory.
pub struct Matrix {
    path: PathBuf,
    file: Mutex<File>,
    /// Its number of rows.
    n: usize,
    /// The row of each model of the gallery.
    rows: Vec<usize>,
}

impl Matrix {
    /// Opens the matrix of `n` models; `rows` are those of the gallery's models, each below `n`.
    ///
    /// # Errors
    /// A file that cannot be opened or has another size.
    pub fn open(path: &Path, n: usize, rows: Vec<usize>) -> Result<Self> {
        let failed = |source| RunError::file(path, source);
        let file = File::open(path).map_err(failed)?;
        let size = file.metadata().map_err(failed)?.len();
        if size != (n as u64).saturating_mul(n as u64).saturating_mul(4) {
            let why = format!("{n} models need {n} * {n} * 4 bytes, it has {size}");
            return Err(RunError::Usage(format!("matrix {}: {why}", path.display())));
        }
        Ok(Self { path: path.to_owned(), file: Mutex::new(file), n, rows })
    }

    fn bytes(&self, row: usize) -> std::io::Result<Vec<u8>> {
        let mut bytes = vec![0; 4 * self.n];
        let mut file = self.file.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        file.seek(SeekFrom::Start(row as u64 * bytes.len() as u64))?;
        file.read_exact(&mut bytes)?;
        Ok(bytes)
    }
}

impl Distances for Matrix {
    fn rows(&self, queries: &[usize]) -> Result<Vec<Vec<f64>>> {
        let row = |&query: &usize| {
            let bytes = self.bytes(self.rows[query]).map_err(|source| RunError::file(&self.path, source))?;
            let at = |&column: &usize| f64::from(f32::from_le_bytes(std::array::from_fn(|i| bytes[4 * column + i])));
            Ok(self.rows.iter().map(at).collect())
        };
        queries.iter().map(row).collect()
    }
}

/// A row as the file holds it.
pub fn row(distances: &[f64]) -> Vec<u8> {
    distances.iter().flat_map(|&distance| (distance as f32).to_le_bytes()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_and_columns_come_in_the_gallery_s_order() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("three.matrix");
        std::fs::write(&path, row(&[0.0, 1.0, 2.0, 10.0, 11.0, 12.0, 20.0, 21.0, 22.0])).unwrap();
        // two models of the gallery are rows 2 and 0 of the file
        let matrix = Matrix::open(&path, 3, vec![2, 0]).unwrap();
        assert_eq!(matrix.rows(&[0, 1]).unwrap(), [[22.0, 20.0], [2.0, 0.0]]);
    }

    #[test]
    fn a_matrix_of_another_size_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.matrix");
        std::fs::write(&path, row(&[0.0; 4])).unwrap();
        let error = Matrix::open(&path, 3, vec![0, 1, 2]).map(|_| ()).unwrap_err();
        assert!(error.to_string().contains("3 * 3 * 4 bytes, it has 16"), "{error}");
    }
}
