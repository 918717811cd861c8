//! `store info|list|verify|export|merge`.

use std::path::Path;

use serde_json::{Value, json};
use symalign::error::Result;
use symalign::stages::descriptor::{MAGNITUDES, PHASES};
use symalign::store::journal::Journal;
use symalign::store::{self, Damage, Kind, Section, Store, THUMBNAIL, export};

use super::print;
use crate::cli::{Exit, Format, Store as Args};

/// Runs a `store` command.
pub fn store(args: &Args) -> Result<Exit> {
    match args {
        Args::Info { store, json } => info(store, *json),
        Args::List { store, failures } => list(store, *failures),
        Args::Verify { store } => verify(store),
        Args::Export { store, format, out } => {
            let store = Store::open(store)?;
            match format {
                Format::Npy => export::npy(&store, out)?,
                Format::Csv => export::csv(&store, out)?,
                Format::Parquet => export::parquet(&store, out)?,
            }
            Ok(Exit::Done)
        }
        Args::Merge { store, into } => {
            store::merge::merge(store, into)?;
            let merged = Store::open(into)?;
            eprintln!("{}: {} models, {} failures", into.display(), merged.len(), merged.failures().len());
            Ok(Exit::Done)
        }
    }
}

fn info(dir: &Path, as_json: bool) -> Result<Exit> {
    let store = Store::open(dir)?;
    let methods: Vec<_> = store.methods().iter().map(|m| m.name()).collect();
    if as_json {
        let sections: Vec<_> = store.sections().iter().map(|section| section_json(section, store.len())).collect();
        let info = json!({
            "version": store::VERSION,
            "file": store.path(),
            "models": store.len(),
            "failures": store.failures().len(),
            "methods": methods,
            "sections": sections,
            "settings": store.settings(),
        });
        print(&format!("{info}\n"))?;
    } else {
        let counts = format!("{} models, {} failures", store.len(), store.failures().len());
        print(&format!("{counts}\nmethods: {}\n\n{}", methods.join(", "), store.settings()))?;
    }
    Ok(Exit::Done)
}

/// Name, place and, for arrays, dtype and shape as numpy.memmap wants them.
fn section_json(section: &Section, n: usize) -> Value {
    let (name, dtype, shape) = match section.kind {
        Kind::Settings => ("settings", None, vec![]),
        Kind::Ids => ("ids", None, vec![]),
        Kind::Failures => ("failures", None, vec![]),
        Kind::Hashes => ("hashes", Some("|u1"), vec![n, 32]),
        Kind::Thumbnails => ("thumbnails", Some("|u1"), vec![n, THUMBNAIL, THUMBNAIL]),
        Kind::Magnitudes => ("magnitude", Some("<f4"), vec![n, MAGNITUDES]),
        Kind::Phases => ("phase", Some("<f4"), vec![n, PHASES]),
        Kind::Frames => ("frame", Some("<f8"), vec![n, 12]),
        Kind::SummaryOffsets => ("summary_offsets", Some("<u8"), vec![n + 1]),
        Kind::Summaries => ("summaries", None, vec![]),
    };
    let mut json = json!({"name": name, "offset": section.offset, "bytes": section.length, "crc32": section.crc});
    if let Some(method) = section.method {
        json["method"] = method.name().into();
    }
    if let Some(dtype) = dtype {
        json["dtype"] = dtype.into();
        json["shape"] = shape.into();
    }
    json
}

fn list(dir: &Path, failures: bool) -> Result<Exit> {
    let store = Store::open(dir)?;
    let lines: String = if failures {
        store.failures().iter().map(|failure| format!("{}\t{}\n", failure.id, failure.error)).collect()
    } else {
        (0..store.len()).map(|i| format!("{}\n", store.id(i))).collect()
    };
    print(&lines)?;
    Ok(Exit::Done)
}

/// Checks the published file and the journal, as far as they are there.
fn verify(dir: &Path) -> Result<Exit> {
    let journal = store::journal_path(dir);
    let has_journal = journal.exists();
    let mut whole = true;
    if store::published_path(dir).exists() || !has_journal {
        let store = Store::open(dir)?;
        whole &= told(store.path(), store.len(), &store.verify());
    }
    if has_journal {
        let (models, damages) = Journal::verify(&journal)?;
        whole &= told(&journal, models, &damages);
    }
    Ok(if whole { Exit::Done } else { Exit::CannotRun })
}

/// Says what is damaged; true where nothing is.
fn told(path: &Path, models: usize, damages: &[Damage]) -> bool {
    for damage in damages {
        eprintln!("{}: damaged: {damage}", path.display());
    }
    if damages.is_empty() {
        eprintln!("{}: {models} models, all well", path.display());
    }
    damages.is_empty()
}
