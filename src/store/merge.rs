//! Joining the stores of shards.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::record::{Failure, Hash};
use super::{Contents, Lock, Store, publish};
use crate::error::{Result, RunError};

/// Publishes in `into` the models of all `sources`, whatever their order.
///
/// Errors: the sources' settings differ, an id stands for different bytes in two of them, or `into` holds a store
/// already.
pub fn merge(sources: &[PathBuf], into: &Path) -> Result<()> {
    let stores = sources.iter().map(|dir| Store::open(dir)).collect::<Result<Vec<_>>>()?;
    let first = stores.first().ok_or_else(|| RunError::Usage("nothing to merge".into()))?;
    if let Some(other) = stores.iter().find(|s| s.settings() != first.settings()) {
        return Err(RunError::Store { path: other.path().into(), why: different(first, other) });
    }
    std::fs::create_dir_all(into).map_err(|e| RunError::file(into, e))?;
    let _lock = Lock::take(into)?;
    if super::published_path(into).exists() || super::journal_path(into).exists() {
        return Err(RunError::Store { path: into.into(), why: "there is a store already; name a new folder".into() });
    }
    let models = models_of(&stores)?;
    let failures = failures_of(&stores, &models);
    let rows = models.iter().map(|(id, (hash, ..))| (id.clone(), *hash)).collect();
    let contents = Contents { settings: first.settings(), methods: first.methods(), models: rows, failures };
    publish(into, contents, &mut |id, _| {
        let (_, store, row) = models[id];
        stores[store].record(row)
    })
}

fn different(first: &Store, other: &Store) -> String {
    let differing = super::differences(first.settings(), other.settings());
    format!("its settings differ from {}: {}", first.path().display(), differing.join("; "))
}

/// For every id: its hash, and store and row where it is.
type Rows = BTreeMap<String, (Hash, usize, usize)>;

fn models_of(stores: &[Store]) -> Result<Rows> {
    let mut models = Rows::new();
    for (s, store) in stores.iter().enumerate() {
        for row in 0..store.len() {
            let (id, hash) = (store.id(row), store.hash(row));
            match models.get(id) {
                Some((other, ..)) if *other != hash => {
                    return Err(
                        store.error(format!("{id} has other bytes than in {}", stores[models[id].1].path().display()))
                    );
                }
                Some(_) => {}
                None => drop(models.insert(id.to_owned(), (hash, s, row))),
            }
        }
    }
    Ok(models)
}

/// The failures of all stores, once each, without those that another store has done.
fn failures_of(stores: &[Store], models: &Rows) -> Vec<Failure> {
    let all = stores.iter().flat_map(|store| store.failures());
    let unmet = all.filter(|failure| !models.contains_key(&failure.id));
    let by_id: BTreeMap<&str, &Failure> = unmet.map(|failure| (failure.id.as_str(), failure)).collect();
    by_id.into_values().cloned().collect()
}
