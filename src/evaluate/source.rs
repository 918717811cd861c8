//! Where distances come from: a store, or matrices that somebody else computed.

use super::formats::{self, cla, matrix, metrics, table, trec};
use super::labels::{Assignment, Labels, Missing};
use super::{Entrant, Evaluation, Gallery, Options, report, score};
use crate::error::{Result, RunError};
use crate::search::{self, Kind, Name, Rows};
use crate::store::Store;
use std::path::{Path, PathBuf};

/// What the labels and the models have to do with each other.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Coverage {
    /// Models that were described.
    pub described: usize,
    /// Models that failed.
    pub failed: usize,
    /// Models that were described but have no label; they are left out.
    pub unlabelled: usize,
    /// Labels without a described model; their models are not counted as misses.
    pub missing: Vec<Missing>,
}

/// Scores the models of `store` that have a label.
///
/// # Errors
/// A method that the store does not hold; no class with two models; a distance that is not a number.
pub fn evaluate(store: &Store, labels: &Labels, options: &Options) -> Result<Evaluation> {
    let ids: Vec<_> = (0..store.len()).map(|i| store.id(i)).collect();
    let failures: Vec<_> = store.failures().iter().map(|f| (f.id.as_str(), f.error.to_string())).collect();
    let assignment = labels.assign(&ids, &failures);
    let gallery = Gallery::new(&ids, &assignment, options.compat_psb);
    let names = chosen(store, &options.methods)?;
    let entrants = entrants(store, &gallery.rows, &names)?;
    let mut evaluation = score(gallery.clone(), &entrants, options)?;
    evaluation.coverage = Coverage {
        described: store.len(),
        failed: failures.len(),
        unlabelled: store.len() - assignment.labelled(),
        missing: assignment.missing,
    };
    Ok(evaluation)
}

/// Writes the report, metrics, tables, matrices, labels, judgements and runs of an evaluation into the folder `out`,
/// which is made where it is not there.
///
/// # Errors
/// A file that cannot be written; a damaged store.
pub fn write(evaluation: &Evaluation, store: &Store, out: &Path) -> Result<()> {
    let names: Vec<Name> = evaluation.methods.iter().filter_map(|method| method.name.parse().ok()).collect();
    let entrants = entrants(store, &evaluation.gallery.rows, &names)?;
    write_data(evaluation, &entrants, out)?;
    report::write(evaluation, Some(store), out)
}

/// Scores Princeton matrices, each a method named by its file; their rows are in the order of the `.cla` file.
///
/// # Errors
/// Files that cannot be read or do not fit together; no class with two models.
pub fn evaluate_matrices(matrices: &[PathBuf], labels: &Path, options: &Options) -> Result<Evaluation> {
    with_matrices(matrices, labels, options, |evaluation, _| Ok(evaluation))
}

/// [`evaluate_matrices`], then writes what [`write`] does; the report has no pictures.
///
/// # Errors
/// Those of [`evaluate_matrices`]; a file that cannot be written.
pub fn report_matrices(matrices: &[PathBuf], labels: &Path, options: &Options, out: &Path) -> Result<Evaluation> {
    with_matrices(matrices, labels, options, |evaluation, entrants| {
        write_data(&evaluation, entrants, out)?;
        report::write(&evaluation, None, out)?;
        Ok(evaluation)
    })
}

fn with_matrices(
    matrices: &[PathBuf],
    labels: &Path,
    options: &Options,
    then: impl FnOnce(Evaluation, &[Entrant]) -> Result<Evaluation>,
) -> Result<Evaluation> {
    let Labels::Table(pairs) = Labels::load(labels)? else {
        return Err(RunError::Usage("a matrix needs the .cla file that its rows are in the order of".into()));
    };
    let ids: Vec<_> = pairs.iter().map(|(id, _)| id.as_str()).collect();
    let categories: Vec<_> = pairs.iter().map(|(_, category)| category.as_str()).collect();
    let gallery = Gallery::new(&ids, &Assignment::of(&categories), options.compat_psb);
    let (n, rows) = (ids.len(), gallery.rows.clone());
    let values = matrices.iter().map(|path| matrix::read(path, n)).collect::<Result<Vec<_>>>()?;
    let entrant = |(path, values): (&PathBuf, Vec<f32>)| {
        let (name, rows) = (path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned(), rows.clone());
        Entrant { name, distance: Box::new(move |a, b| f64::from(values[rows[a] * n + rows[b]])) }
    };
    let entrants: Vec<_> = matrices.iter().zip(values).map(entrant).collect();
    let mut evaluation = score(gallery, &entrants, options)?;
    evaluation.coverage.described = n;
    then(evaluation, &entrants)
}

/// The methods of the store that are asked for; all, where none is.
fn chosen(store: &Store, asked: &[String]) -> Result<Vec<Name>> {
    let known = search::names(store);
    for text in asked {
        let name: Name = text.parse().map_err(RunError::Usage)?;
        Rows::of(store, name)?;
    }
    let is_asked = |name: &Name| asked.iter().any(|text| *text == name.to_string() || text == name.frame.name());
    Ok(known.into_iter().filter(|name| asked.is_empty() || is_asked(name)).collect())
}

/// The distances of `names` between the models in `rows` of the store.
fn entrants<'a>(store: &'a Store, rows: &[usize], names: &[Name]) -> Result<Vec<Entrant<'a>>> {
    let entrant = |&name: &Name| {
        let (all, rows) = (Rows::of(store, name)?, rows.to_vec());
        let distance = move |a: usize, b: usize| all.distance(all.row(rows[a]), all.row(rows[b]));
        Ok(Entrant { name: name.to_string(), distance: Box::new(distance) })
    };
    names.iter().map(entrant).collect()
}

/// Whether a name's distances are of phases.
pub fn is_phase(name: &str) -> bool {
    name.parse::<Name>().is_ok_and(|name| name.kind == Kind::Phase)
}

fn write_data(evaluation: &Evaluation, entrants: &[Entrant], out: &Path) -> Result<()> {
    std::fs::create_dir_all(out).map_err(|source| RunError::file(out, source))?;
    let gallery = &evaluation.gallery;
    formats::create(&out.join("metrics.json"), |file| {
        serde_json::to_writer_pretty(&mut *file, &metrics::of(evaluation))?;
        writeln!(file)
    })?;
    formats::create(&out.join("pr.csv"), |file| table::write_curves(evaluation, file))?;
    formats::create(&out.join("per_query.csv"), |file| table::write_queries(evaluation, file))?;
    formats::create(&out.join("labels.cla"), |file| cla::write(gallery, file))?;
    formats::create(&out.join("qrels.trec"), |file| trec::write_judgements(gallery, file))?;
    for entrant in entrants {
        let name = entrant.name.replace(':', "-");
        matrix::write(&out.join(format!("{name}.matrix")), gallery.len(), entrant)?;
        trec::write_run(&out.join(format!("{name}.run.trec")), gallery, entrant)?;
    }
    Ok(())
}
