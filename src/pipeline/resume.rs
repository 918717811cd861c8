//! Opening a store for a run: new, where an earlier run left it, or afresh.

use std::path::Path;

use crate::error::{Result, RunError};
use crate::store::journal::Journal;
use crate::store::{
    Damage, Lock, Store, VERSION, differences, journal_path, published_path, version_error, version_of,
};

/// A store that this process may write.
pub struct Opened {
    pub journal: Journal,
    /// What the user should know: what was removed, taken over or damaged.
    pub notes: Vec<String>,
    _lock: Lock,
}

/// Opens the store folder `dir` for a run with the settings `effective`, making it if it is not there.
///
/// Errors: another process writes it, its settings differ (each is named), or it is not readable.
pub fn open(dir: &Path, effective: &str, fresh: bool) -> Result<Opened> {
    std::fs::create_dir_all(dir).map_err(|e| RunError::file(dir, e))?;
    let lock = Lock::take(dir)?;
    let mut notes = Vec::new();
    if fresh {
        remove(dir, &mut notes)?;
    }
    check_version(dir)?;
    let journal = match Journal::open(&journal_path(dir))? {
        Some((journal, settings)) => {
            check_settings(dir, &settings, effective)?;
            journal
        }
        None => taken_over(dir, effective, &mut notes)?,
    };
    let again = |damage: &Damage| {
        format!("{}: damaged: {damage}; what was in it is computed again", journal_path(dir).display())
    };
    notes.extend(journal.damage().iter().map(again));
    Ok(Opened { journal, notes, _lock: lock })
}

/// A new journal, holding what a published store without journal (a merged one) has.
fn taken_over(dir: &Path, effective: &str, notes: &mut Vec<String>) -> Result<Journal> {
    if !published_path(dir).exists() {
        return Journal::create(&journal_path(dir), effective);
    }
    let store = Store::open(dir)?;
    check_settings(dir, store.settings(), effective)?;
    let journal = Journal::create_with(&journal_path(dir), effective, &mut |journal| {
        for i in 0..store.len() {
            journal.append(&store.hash(i), &Ok(store.record(i)?))?;
        }
        for failure in store.failures() {
            if let Some(hash) = failure.hash {
                journal.append(&hash, &Err(failure.error.clone()))?;
            }
        }
        Ok(())
    })?;
    notes.push(format!("took over {} models of the published store", journal.len()));
    Ok(journal)
}

/// A published file of another version is not replaced, even where the journal is ours.
fn check_version(dir: &Path) -> Result<()> {
    let path = published_path(dir);
    match version_of(&path) {
        Ok(Some(version)) if version != VERSION => Err(RunError::Store { path, why: version_error(version) }),
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(RunError::file(path, error)),
        _ => Ok(()),
    }
}

fn check_settings(dir: &Path, theirs: &str, ours: &str) -> Result<()> {
    if theirs == ours {
        return Ok(());
    }
    let differing = differences(theirs, ours).join("; ");
    let why = format!(
        "was made with other settings (store, now): {differing}. Use the store's settings, another --store, or --fresh \
         to start over"
    );
    Err(RunError::Store { path: dir.into(), why })
}

/// Removes the files of a store, and says which.
fn remove(dir: &Path, notes: &mut Vec<String>) -> Result<()> {
    for path in [published_path(dir), journal_path(dir)] {
        match std::fs::metadata(&path) {
            Ok(meta) => {
                std::fs::remove_file(&path).map_err(|e| RunError::file(&path, e))?;
                notes.push(format!("removed {} ({} bytes)", path.display(), meta.len()));
            }
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {}
            Err(error) => return Err(RunError::file(&path, error)),
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::{ModelError, Stage};

    #[test]
    fn a_store_is_resumed_refused_and_started_over() {
        let dir = tempfile::tempdir().unwrap();
        let store = dir.path().join("deep/store");
        let mut opened = open(&store, "a = 1", false).unwrap();
        opened.journal.append(&[1; 32], &Err(ModelError::new(Stage::Parse, "torn"))).unwrap();
        drop(opened);
        assert_eq!(open(&store, "a = 1", false).unwrap().journal.len(), 1);
        let error = open(&store, "a = 2", false).err().unwrap().to_string();
        assert!(error.contains("a: 1, 2") && error.contains("--fresh"), "{error}");
        let fresh = open(&store, "a = 2", true).unwrap();
        assert!(fresh.journal.is_empty());
        assert!(fresh.notes[0].contains("removed") && fresh.notes[0].contains("journal"), "{:?}", fresh.notes);
    }
}
