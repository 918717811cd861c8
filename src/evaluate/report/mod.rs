//! The report: one self-contained page and a picture of its curves.
//!
//! Tables, curves, bars and the confusion are written out, so that the page can be read without scripts and printed;
//! a little script sorts, filters and shows the hits of a query.

mod chart;
mod gallery;
mod tables;

use super::formats::results;
use super::labels::Missing;
use super::{Evaluation, significance};
use crate::error::{Result, RunError};
use crate::store::{Store, VERSION};
use askama::Template;
use chart::{Curves, Style};
use gallery::Gallery;
use std::path::Path;
use tables::{Bars, Confusion, Measures};

/// The page's data, ready to be printed.
#[derive(Template)]
#[template(path = "evaluate/report/report.html")]
struct Page<'a> {
    evaluation: &'a Evaluation,
    version: &'static str,
    queries: usize,
    /// Labels, with or without a model.
    labelled: usize,
    /// Units up to which sign flips are tried exhaustively.
    exact: usize,
    styles: Vec<Style<'a>>,
    curves: Vec<Curves>,
    measures: Vec<Measures<'a>>,
    bars: Vec<Bars<'a>>,
    confusions: Vec<Confusion<'a>>,
    /// The first [`LISTED`] of all.
    failures: Vec<Failure>,
    failed: usize,
    missing: &'a [Missing],
    /// How many places of each ranking the TREC runs hold, where these are not whole.
    run_depth: Option<usize>,
    settings: &'a str,
    store: String,
    format: u32,
    options: String,
    gallery: Option<Gallery>,
}

/// Failures and labels without a model listed at most; the store lists all.
const LISTED: usize = 1_000;

struct Failure {
    id: String,
    stage: &'static str,
    why: String,
}

/// Writes `report.html` and `pr.png` into `out`; pictures, failures and settings come from `store`.
///
/// # Errors
/// A damaged store; a file that cannot be written.
pub fn write(evaluation: &Evaluation, store: Option<&Store>, out: &Path) -> Result<()> {
    let path = out.join("pr.png");
    let png = chart::png(evaluation).map_err(|why| RunError::Usage(format!("{}: {why}", path.display())))?;
    std::fs::write(&path, png).map_err(|source| RunError::file(&path, source))?;
    let path = out.join("report.html");
    let html =
        page(evaluation, store)?.render().map_err(|why| RunError::Usage(format!("{}: {why}", path.display())))?;
    std::fs::write(&path, html).map_err(|source| RunError::file(&path, source))
}

fn page<'a>(evaluation: &'a Evaluation, store: Option<&'a Store>) -> Result<Page<'a>> {
    let missing = &evaluation.coverage.missing;
    Ok(Page {
        evaluation,
        version: env!("CARGO_PKG_VERSION"),
        queries: evaluation.gallery.queries().len(),
        labelled: evaluation.gallery.len() + evaluation.coverage.missing.len(),
        exact: significance::EXACT,
        styles: chart::styles(evaluation),
        curves: chart::curves(evaluation),
        measures: tables::measures(evaluation),
        bars: tables::bars(evaluation),
        confusions: tables::confusions(evaluation),
        failures: store.map(failures).unwrap_or_default(),
        failed: evaluation.coverage.failed,
        missing: &missing[..missing.len().min(LISTED)],
        run_depth: Some(results::run_depth(&evaluation.gallery)).filter(|&depth| depth < evaluation.gallery.len()),
        format: VERSION,
        settings: store.map(Store::settings).unwrap_or_default(),
        store: store.map(|store| store.path().display().to_string()).unwrap_or_default(),
        options: toml::to_string(&evaluation.options).map_err(|error| RunError::Settings(error.to_string()))?,
        gallery: store.map(|store| Gallery::new(evaluation, store)).transpose()?,
    })
}

fn failures(store: &Store) -> Vec<Failure> {
    let told = |failure: &'_ crate::store::Failure| {
        let at = failure.error.entity.map(|entity| format!(" (#{entity})")).unwrap_or_default();
        let why = format!("{}{at}", failure.error.why);
        Failure { id: failure.id.clone(), stage: failure.error.stage.name(), why }
    };
    store.failures().iter().take(LISTED).map(told).collect()
}

/// How numbers are printed.
mod filters {
    /// Three digits with a sign.
    #[askama::filter_fn]
    pub fn signed(value: &f64, _: &dyn askama::Values) -> askama::Result<String> {
        Ok(format!("{value:+.3}"))
    }

    /// One digit after the point.
    #[askama::filter_fn]
    pub fn one(value: &f64, _: &dyn askama::Values) -> askama::Result<String> {
        Ok(format!("{value:.1}"))
    }

    /// Three digits after the point, or that it is less.
    #[askama::filter_fn]
    pub fn probability(value: &f64, _: &dyn askama::Values) -> askama::Result<String> {
        Ok(if *value < 0.0005 { "< 0.001".into() } else { format!("{value:.3}") })
    }
}
