//! The files of a report, but for the matrices and runs, which are written while the distances are computed.

use super::formats::{self, cla, metrics, table, trec};
use super::{Evaluation, report};
use crate::error::Result;
use crate::store::Store;
use std::path::Path;

/// Writes metrics, tables, labels, judgements and the report into the folder `out`.
///
/// # Errors
/// A file that cannot be written; a damaged store.
pub fn write(evaluation: &Evaluation, store: Option<&Store>, out: &Path) -> Result<()> {
    let gallery = &evaluation.gallery;
    formats::create(&out.join("metrics.json"), |file| {
        serde_json::to_writer_pretty(&mut *file, &metrics::of(evaluation))?;
        writeln!(file)
    })?;
    formats::create(&out.join("pr.csv"), |file| table::write_curves(evaluation, file))?;
    formats::create(&out.join("per_query.csv"), |file| table::write_queries(evaluation, file))?;
    formats::create(&out.join("labels.cla"), |file| cla::write(gallery, file))?;
    formats::create(&out.join("qrels.trec"), |file| trec::write_judgements(gallery, file))?;
    report::write(evaluation, store, out)
}
