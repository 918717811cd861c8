//! Parquet, without compression: descriptors hardly shrink.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, FloatType, Int64Type};
use parquet::errors::{ParquetError, Result as Done};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::parser::parse_message_type;

use super::{Facts, frame, make};
use crate::error::{Result, RunError};
use crate::stages::descriptor::{MAGNITUDES, PHASES};
use crate::store::Store;

/// Models in a row group: some 20 MB of descriptors.
const GROUP: usize = 10_000;

const MODELS: &str = "message models {
    required binary id (STRING); required binary hash (STRING); required binary label (STRING);
    required double coverage; required int64 solids; required int64 faces; required int64 triangles;
    required double area_mm2; required double volume_mm3; required binary source (STRING);
}";

const ROWS: &str = "message rows {
    required binary id (STRING);
    required group magnitude (LIST) { repeated group list { required float element; } }
    required group phase (LIST) { repeated group list { required float element; } }
    required group frame (LIST) { repeated group list { required double element; } }
}";

/// Writes `models.parquet` (the columns of `models.csv`) and `<method>.parquet` (id, and lists of numbers: magnitude,
/// phase, frame) into `dir`; row i of each is model i.
pub fn parquet(store: &Store, dir: &Path) -> Result<()> {
    make(dir)?;
    let all: Vec<usize> = (0..store.len()).collect();
    table(&dir.join("models.parquet"), MODELS, &all, |group, models| {
        let facts = models.iter().map(|i| Facts::of(store, *i)).collect::<Result<Vec<_>>>()?;
        Ok(of_facts(group, &facts))
    })?;
    for &method in store.methods() {
        table(&dir.join(format!("{}.parquet", method.name())), ROWS, &all, |group, models| {
            let frames = models.iter().map(|i| frame(store, method, *i)).collect::<Result<Vec<_>>>()?;
            let descriptors = (store.magnitudes(method)?, store.phases(method)?);
            Ok(of_method(group, store, descriptors, models, &frames.concat()))
        })?;
    }
    Ok(())
}

type Group<'a> = SerializedRowGroupWriter<'a, File>;

/// Writes a file of one row for each model, group by group.
fn table(
    path: &Path,
    schema: &str,
    models: &[usize],
    fill: impl Fn(&mut Group, &[usize]) -> Result<Done<()>>,
) -> Result<()> {
    let failed = |e: ParquetError| RunError::file(path, std::io::Error::other(e));
    let file = File::create(path).map_err(|e| RunError::file(path, e))?;
    let schema = parse_message_type(schema).map_err(failed)?;
    // Numbers of descriptors hardly ever repeat: no dictionary.
    let properties = WriterProperties::builder().set_dictionary_enabled(false).build();
    let mut writer = SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties)).map_err(failed)?;
    for part in models.chunks(GROUP) {
        let mut group = writer.next_row_group().map_err(failed)?;
        fill(&mut group, part)?.map_err(failed)?;
        group.close().map_err(failed)?;
    }
    writer.close().map_err(failed)?;
    Ok(())
}

fn of_facts(group: &mut Group, facts: &[Facts]) -> Done<()> {
    texts(group, facts.iter().map(|f| f.id.as_str()))?;
    texts(group, facts.iter().map(|f| f.hash.as_str()))?;
    texts(group, facts.iter().map(|f| f.label))?;
    column::<DoubleType>(group, facts.iter().map(|f| f.coverage), None)?;
    column::<Int64Type>(group, facts.iter().map(|f| f.solids as i64), None)?;
    column::<Int64Type>(group, facts.iter().map(|f| f.faces as i64), None)?;
    column::<Int64Type>(group, facts.iter().map(|f| f.triangles as i64), None)?;
    column::<DoubleType>(group, facts.iter().map(|f| f.area_mm2), None)?;
    column::<DoubleType>(group, facts.iter().map(|f| f.volume_mm3), None)?;
    texts(group, facts.iter().map(|f| f.source))
}

/// `magnitudes`, `phases`: those of all models of the store.
fn of_method(
    group: &mut Group,
    store: &Store,
    (magnitudes, phases): (&[f32], &[f32]),
    models: &[usize],
    frames: &[f64],
) -> Done<()> {
    let part = |numbers: &[f32], columns: usize| -> Vec<f32> {
        let rows = numbers.chunks_exact(columns);
        rows.skip(models[0]).take(models.len()).flatten().copied().collect()
    };
    texts(group, models.iter().map(|i| store.id(*i)))?;
    column::<FloatType>(group, part(magnitudes, MAGNITUDES), Some(MAGNITUDES))?;
    column::<FloatType>(group, part(phases, PHASES), Some(PHASES))?;
    column::<DoubleType>(group, frames.iter().copied(), Some(12))
}

fn texts<'a>(group: &mut Group, texts: impl Iterator<Item = &'a str>) -> Done<()> {
    column::<ByteArrayType>(group, texts.map(ByteArray::from), None)
}

/// Writes the next column: a value a row, or a list of `width` values a row.
fn column<T: DataType>(group: &mut Group, values: impl IntoIterator<Item = T::T>, width: Option<usize>) -> Done<()> {
    let values: Vec<T::T> = values.into_iter().collect();
    // All values are there (1); the first of each list opens a row (0), the others go on with it (1).
    let defined = width.map(|_| vec![1; values.len()]);
    let repeated: Option<Vec<i16>> = width.map(|w| (0..values.len()).map(|i| i16::from(i % w > 0)).collect());
    let missing = || ParquetError::General("fewer columns than the schema has".into());
    let mut column = group.next_column()?.ok_or_else(missing)?;
    column.typed::<T>().write_batch(&values, defined.as_deref(), repeated.as_deref())?;
    column.close()
}
