//! NumPy's own format.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use super::{frame, make};
use crate::error::{Result, RunError};
use crate::stages::descriptor::{MAGNITUDES, PHASES};
use crate::store::Store;

/// Writes `<method>.magnitude.npy` (f32, N x 96), `<method>.phase.npy` (f32, N x 384), `<method>.frame.npy` (f64,
/// N x 12) and `ids.txt` (one a line, in the order of the rows) into `dir`.
pub fn npy(store: &Store, dir: &Path) -> Result<()> {
    make(dir)?;
    let n = store.len();
    for &method in store.methods() {
        let name = method.name();
        let arrays = [("magnitude", store.magnitudes(method), MAGNITUDES), ("phase", store.phases(method), PHASES)];
        for (kind, rows, columns) in arrays {
            let bytes = rows?.iter().flat_map(|x| x.to_le_bytes());
            array(&dir.join(format!("{name}.{kind}.npy")), "<f4", &[n, columns], bytes)?;
        }
        let frames = (0..n).map(|i| frame(store, method, i)).collect::<Result<Vec<_>>>()?;
        let bytes = frames.into_iter().flatten().flat_map(f64::to_le_bytes);
        array(&dir.join(format!("{name}.frame.npy")), "<f8", &[n, 12], bytes)?;
    }
    let ids: String = (0..n).map(|i| format!("{}\n", store.id(i))).collect();
    let path = dir.join("ids.txt");
    std::fs::write(&path, ids).map_err(|e| RunError::file(path, e))
}

/// Writes a C-ordered array in NumPy's format 1.0 (NEP 1).
fn array(path: &Path, dtype: &str, shape: &[usize; 2], bytes: impl Iterator<Item = u8>) -> Result<()> {
    let [rows, columns] = shape;
    let mut header = format!("{{'descr': '{dtype}', 'fortran_order': False, 'shape': ({rows}, {columns}), }}");
    // Magic (6), version (2) and length (2) stand before; the whole is a multiple of 64 and ends in a newline.
    let padded = (10 + header.len() + 1).next_multiple_of(64) - 10;
    header.extend(std::iter::repeat_n(' ', padded - header.len() - 1));
    header.push('\n');
    let io = |e| RunError::file(path, e);
    let mut file = BufWriter::new(File::create(path).map_err(io)?);
    file.write_all(b"\x93NUMPY\x01\x00").map_err(io)?;
    file.write_all(&(header.len() as u16).to_le_bytes()).map_err(io)?;
    file.write_all(header.as_bytes()).map_err(io)?;
    bytes.into_iter().try_for_each(|byte| file.write_all(&[byte])).map_err(io)?;
    file.flush().map_err(io)
}
