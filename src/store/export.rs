//! Stores for other tools: numpy arrays and CSV.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use super::Store;
use crate::error::{Result, RunError};
use crate::stages::descriptor::{MAGNITUDES, PHASES};

/// Writes `<method>.magnitude.npy` (f32, N x 96), `<method>.phase.npy` (f32, N x 384), `<method>.frame.npy` (f64,
/// N x 12) and `ids.txt` (one a line, in the order of the rows) into `dir`.
pub fn npy(store: &Store, dir: &Path) -> Result<()> {
    std::fs::create_dir_all(dir).map_err(|e| RunError::file(dir, e))?;
    let n = store.len();
    for &method in store.methods() {
        let name = method.name();
        let arrays = [("magnitude", store.magnitudes(method), MAGNITUDES), ("phase", store.phases(method), PHASES)];
        for (kind, rows, columns) in arrays {
            let bytes = rows?.iter().flat_map(|x| x.to_le_bytes());
            array(&dir.join(format!("{name}.{kind}.npy")), "<f4", &[n, columns], bytes)?;
        }
        let frames = (0..n).map(|i| store.frame(method, i)).collect::<Result<Vec<_>>>()?;
        let numbers = frames.iter().flat_map(super::record::frame_numbers);
        array(&dir.join(format!("{name}.frame.npy")), "<f8", &[n, 12], numbers.flat_map(f64::to_le_bytes))?;
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

/// Writes `models.csv` (one model a line: id, label, coverage, counts, measures) and `<method>.magnitude.csv`
/// (id and its numbers) into `dir`.
pub fn csv(store: &Store, dir: &Path) -> Result<()> {
    std::fs::create_dir_all(dir).map_err(|e| RunError::file(dir, e))?;
    models(store, &dir.join("models.csv"))?;
    for &method in store.methods() {
        let path = dir.join(format!("{}.magnitude.csv", method.name()));
        let mut table = writer(&path)?;
        for (i, row) in store.magnitudes(method)?.chunks_exact(MAGNITUDES).enumerate() {
            let numbers = row.iter().map(f32::to_string);
            let record = std::iter::once(store.id(i).to_owned()).chain(numbers);
            table.write_record(record).map_err(|e| csv_error(&path, e))?;
        }
        table.flush().map_err(|e| RunError::file(&path, e))?;
    }
    Ok(())
}

fn models(store: &Store, path: &Path) -> Result<()> {
    let mut table = writer(path)?;
    let head = ["id", "label", "coverage", "solids", "faces", "triangles", "area_mm2", "volume_mm3", "source"];
    table.write_record(head).map_err(|e| csv_error(path, e))?;
    for i in 0..store.len() {
        let s = store.summary(i)?;
        let coverage = s.planes.first().map_or(0.0, |plane| plane.coverage);
        let label = name_of(&s.label)?;
        let source = name_of(&s.source)?;
        let row = (store.id(i), label, coverage, s.solids, s.faces, s.triangles, s.area_mm2, s.volume_mm3, source);
        table.serialize(row).map_err(|e| csv_error(path, e))?;
    }
    table.flush().map_err(|e| RunError::file(path, e))
}

/// The name of a unit variant, as JSON has it.
fn name_of<T: serde::Serialize>(value: &T) -> Result<String> {
    let json = serde_json::to_value(value).map_err(|e| RunError::Usage(e.to_string()))?;
    Ok(json.as_str().unwrap_or_default().to_owned())
}

fn writer(path: &Path) -> Result<csv::Writer<File>> {
    csv::WriterBuilder::new().has_headers(false).from_path(path).map_err(|e| csv_error(path, e))
}

fn csv_error(path: &Path, error: csv::Error) -> RunError {
    RunError::file(path, std::io::Error::other(error))
}
