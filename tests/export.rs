//! What `store export` writes, read again by other readers: the values are the store's.
//!
//! `SYMALIGN_PYTHON` names the interpreter, else it is `python3`; without numpy (and pyarrow for Parquet) the test says
//! so and passes.

mod common;

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Command;

use common::{archive, code, run, stderr, stdout};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::{Field, RowAccessor};
use symalign::alignment::Method;
use symalign::store::Store;

/// A store of some models, and its exports in the folders `npy`, `csv` and `parquet` of `dir`.
fn exported(dir: &Path) -> Store {
    archive(dir);
    assert_eq!(code(&run(dir, &["run", "models/household", "models/machinery", "--method", "symmetry,pca"])), 0);
    for format in ["npy", "csv", "parquet"] {
        let output = run(dir, &["store", "export", "--format", format, "--out", format]);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
    }
    Store::open(&dir.join("store")).unwrap()
}

/// Rows of a CSV file as id and numbers.
fn csv_rows<T: std::str::FromStr<Err: std::fmt::Debug>>(path: PathBuf) -> Vec<(String, Vec<T>)> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_path(path).unwrap();
    let row = |row: csv::StringRecord| (row[0].to_owned(), row.iter().skip(1).map(|x| x.parse().unwrap()).collect());
    reader.records().map(|record| row(record.unwrap())).collect()
}

#[test]
fn csv_gives_the_same_numbers_again() {
    let dir = tempfile::tempdir().unwrap();
    let store = exported(dir.path());
    assert_eq!(store.len(), 4);
    for &method in store.methods() {
        let file = |kind: &str| dir.path().join(format!("csv/{}.{kind}.csv", method.name()));
        let read = [csv_rows::<f32>(file("magnitude")), csv_rows::<f32>(file("phase"))];
        let ids: Vec<_> = read[0].iter().map(|(id, _)| id.as_str()).collect();
        assert_eq!(ids, (0..4).map(|i| store.id(i)).collect::<Vec<_>>());
        let numbers = read.map(|rows| rows.into_iter().flat_map(|(_, row)| row).collect::<Vec<_>>());
        assert_eq!(numbers[0], store.magnitudes(method).unwrap());
        assert_eq!(numbers[1], store.phases(method).unwrap());
        for (i, (_, row)) in csv_rows::<f64>(file("frame")).iter().enumerate() {
            let frame = store.frame(method, i).unwrap();
            let axes = frame.axes.iter().flat_map(|axis| axis.iter().copied());
            assert_eq!(*row, axes.chain(frame.origin.iter().copied()).collect::<Vec<_>>());
        }
    }
    let text = std::fs::read_to_string(dir.path().join("csv/models.csv")).unwrap();
    assert!(text.starts_with("id,hash,label,coverage,solids,faces,triangles,area_mm2,volume_mm3,source\n"), "{text}");
    assert_eq!(text.lines().count(), 5);
}

#[test]
fn parquet_gives_the_same_numbers_again() {
    let dir = tempfile::tempdir().unwrap();
    let store = exported(dir.path());
    let open = |name: &str| SerializedFileReader::new(File::open(dir.path().join(name)).unwrap()).unwrap();
    let rows = open("parquet/pca.parquet");
    assert_eq!(rows.metadata().file_metadata().num_rows(), 4);
    let mut magnitudes = Vec::new();
    for (i, row) in rows.get_row_iter(None).unwrap().enumerate() {
        let row = row.unwrap();
        assert_eq!(row.get_string(0).unwrap(), store.id(i));
        let floats = row.get_list(1).unwrap().elements().iter().map(|field| match field {
            Field::Float(x) => *x,
            other => panic!("{other:?}"),
        });
        magnitudes.extend(floats);
        assert_eq!(row.get_list(3).unwrap().len(), 12);
    }
    assert_eq!(magnitudes, store.magnitudes(Method::Pca).unwrap());

    for (i, row) in open("parquet/models.parquet").get_row_iter(None).unwrap().enumerate() {
        let (row, summary) = (row.unwrap(), store.summary(i).unwrap());
        assert_eq!((row.get_string(0).unwrap().as_str(), row.get_double(7).unwrap()), (store.id(i), summary.area_mm2));
        assert_eq!(row.get_long(5).unwrap(), summary.faces as i64);
    }
}

/// Arguments: folder of this repository, folder with `store` and the exports.
const CHECK: &str = r#"
import csv, sys
import numpy
repository, folder = sys.argv[1:]
sys.path.insert(0, repository + "/contrib/numpy")
from open_store import open_store
methods, ids, arrays = open_store(folder + "/store")
assert ids == open(folder + "/npy/ids.txt").read().splitlines() and len(ids) == 4
try:
    import pyarrow.parquet as parquet
except ImportError:
    parquet = None
compared = 0
for method in methods:
    if parquet:
        table = parquet.read_table(f"{folder}/parquet/{method}.parquet")
        assert table["id"].to_pylist() == ids
    for kind in ("magnitude", "phase", "frame"):
        mapped = arrays[method, kind]
        assert isinstance(mapped, numpy.memmap)
        saved = numpy.load(f"{folder}/npy/{method}.{kind}.npy")
        assert saved.dtype == mapped.dtype and saved.shape == mapped.shape and (saved == mapped).all(), (method, kind)
        text = [row[1:] for row in csv.reader(open(f"{folder}/csv/{method}.{kind}.csv"))]
        assert (numpy.array(text, dtype=mapped.dtype) == mapped).all(), (method, kind, "csv")
        if parquet:
            column = numpy.array(table[kind].to_pylist(), dtype=mapped.dtype)
            assert (column == mapped).all(), (method, kind, "parquet")
        compared += 1
if parquet:
    models = parquet.read_table(folder + "/parquet/models.parquet").to_pylist()
    facts = list(csv.DictReader(open(folder + "/csv/models.csv")))
    assert len(models) == len(facts) == 4
    for model, row in zip(models, facts):
        for name, value in model.items():
            assert type(value)(row[name]) == value, (name, value, row[name])
print(compared, "with pyarrow" if parquet else "skipped: no pyarrow")
"#;

#[test]
fn numpy_maps_the_store_and_finds_what_was_exported() {
    let python = std::env::var("SYMALIGN_PYTHON").unwrap_or_else(|_| "python3".into());
    if !Command::new(&python).args(["-c", "import numpy"]).output().is_ok_and(|o| o.status.success()) {
        eprintln!("skipped: {python} has no numpy (set SYMALIGN_PYTHON to one that has)");
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    exported(dir.path());
    let repository = env!("CARGO_MANIFEST_DIR");
    let with_program = || {
        let mut command = Command::new(&python);
        command.env("SYMALIGN", env!("CARGO_BIN_EXE_symalign")).env("PYTHONDONTWRITEBYTECODE", "1");
        command
    };
    let output = with_program().args(["-c", CHECK, repository]).arg(dir.path()).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stdout(&output).starts_with("6 "), "{}", stdout(&output));
    eprint!("{}", stdout(&output));

    let example = format!("{repository}/contrib/numpy/open_store.py");
    let output = with_program().arg(example).arg(dir.path().join("store")).output().unwrap();
    assert!(output.status.success() && stdout(&output).lines().count() == 4, "{}", stderr(&output));
}
