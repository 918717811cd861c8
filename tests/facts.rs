//! Reading against OpenCASCADE's figures, where the real files are on the machine.
//!
//! `SYMALIGN_DATA` is the folder that `facts.csv`'s paths start in, `SYMALIGN_FACTS` the table (unset:
//! `../shared/data/facts.csv`). Without them the test says so and passes.

use std::path::PathBuf;
use std::time::Instant;

use symalign::brep::Model;
use symalign::cancel::Cancel;
use symalign::stages::parse;

/// The folder of the real files, if there is one.
fn data() -> Option<PathBuf> {
    std::env::var_os("SYMALIGN_DATA").map(PathBuf::from).filter(|folder| folder.is_dir())
}

/// The table of facts, if there is one.
fn facts() -> Option<PathBuf> {
    let otherwise = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/data/facts.csv").into();
    Some(std::env::var_os("SYMALIGN_FACTS").map_or(otherwise, PathBuf::from)).filter(|table| table.is_file())
}

fn placed_faces(model: &Model) -> usize {
    model.occurrences.iter().map(|o| model.faces_of(o.body).count()).sum()
}

fn solids(model: &Model) -> usize {
    model.occurrences.iter().filter(|o| model.bodies[o.body.index()].solid).count()
}

#[test]
fn faces_and_solids_are_those_of_opencascade() {
    let (Some(data), Some(facts)) = (data(), facts()) else {
        eprintln!("skipped: set SYMALIGN_DATA to the folder with the real files, and SYMALIGN_FACTS to facts.csv");
        return;
    };
    let mut reader = csv::Reader::from_path(&facts).expect("the table of facts opens");
    let (mut files, mut equal, mut bytes_read, mut seconds) = (0_usize, 0_usize, 0_usize, 0.0);
    for row in reader.deserialize() {
        let row: std::collections::HashMap<String, String> = row.expect("facts.csv is a table");
        let Ok(bytes) = std::fs::read(data.join(&row["path"])) else { continue };
        let start = Instant::now();
        let read = parse::read(&bytes, &parse::Options::default(), &Cancel::new());
        seconds += start.elapsed().as_secs_f64();
        bytes_read += bytes.len();
        files += 1;
        let expected = (row["faces"].clone(), row["solids"].clone());
        let got = read.as_ref().map(|r| (placed_faces(&r.model).to_string(), solids(&r.model).to_string()));
        if got.as_ref() == Ok(&expected) {
            equal += 1;
        } else {
            let skipped = read.as_ref().map_or_else(|e| e.to_string(), |r| format!("{:?}", r.skipped));
            eprintln!("{}: faces, solids {got:?}, expected {expected:?}: {skipped:.300}", row["path"]);
        }
    }
    eprintln!("{equal} of {files} equal; {:.1} MB in {seconds:.2} s", bytes_read as f64 / 1e6);
    assert!(equal as f64 >= 0.995 * files as f64, "{equal} of {files}");
}

#[test]
fn malformed_files_end_with_a_result_or_a_reason() {
    let Some(data) = data().map(|folder| folder.join("hostile")).filter(|folder| folder.is_dir()) else {
        eprintln!("skipped: set SYMALIGN_DATA to the folder with the broken files");
        return;
    };
    for entry in walkdir::WalkDir::new(&data).sort_by_file_name().into_iter().flatten() {
        let path = entry.path();
        let Some(bytes) = path.extension().filter(|e| *e != "csv").and_then(|_| std::fs::read(path).ok()) else {
            continue;
        };
        match parse::read(&bytes, &parse::Options::default(), &Cancel::new()) {
            Ok(parse::Reading { model, skipped, warnings }) => {
                let (faces, solids) = (placed_faces(&model), solids(&model));
                eprintln!(
                    "{}: {faces} faces, {solids} solids, skipped {skipped:.200?}, {warnings:.200?}",
                    path.display()
                );
                assert!(faces > 0);
            }
            Err(error) => {
                eprintln!("{}: {error}", path.display());
                assert!(!error.why.is_empty());
            }
        }
    }
}
