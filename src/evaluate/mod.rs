//! How well descriptors retrieve: rankings, measures, significance, and the files and report that tell them.
//!
//! In: a store, distance matrices and runs of others, and labels. Out: an [`Evaluation`] and the files of [`report()`].
//! Method: every labelled model whose class has another member is a query against all other labelled models.
//! The measures are the Princeton Shape Benchmark's (Shilane, Min, Kazhdan, Funkhouser 2004) and TREC's average
//! precision; each is told in [`measures`] and [`precision_recall`], the tests in [`significance`].
//! Cost: N^2 distances and N sorts for each method, once, in parallel, in memory for a few rows only: what is scored is
//! written in the same pass.
//! Does not promise: a verdict on models that failed to be read; they are counted as missing, not as misses.

pub mod chance;
pub mod formats;
pub mod gallery;
pub mod labels;
pub mod measures;
pub mod output;
pub mod precision_recall;
pub mod ranking;
pub mod report;
pub mod significance;
pub mod source;
pub mod summary;

pub use gallery::Gallery;
pub use labels::Labels;
pub use ranking::{Entrant, QueryResult};
pub use source::{Coverage, Input, Named, evaluate, judgements, report};

pub use summary::Summary;

use crate::error::{Result, RunError};
use formats::results::Results;
use significance::Comparison;
use std::collections::BTreeSet;
use std::path::Path;

/// What `eval` may be asked.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Names of the methods to evaluate ("symmetry", "cpca:phase"); a frame's name alone means both of its
    /// descriptors. Empty: all that the store holds.
    pub methods: Vec<String>,
    /// Leave classes of one or two models out of all averages, as the Princeton tools do.
    pub compat_psb: bool,
    /// Hits kept of each query for the report's gallery; 10 fill one row on a wide screen.
    pub hits: usize,
    /// Sign flips drawn where there are too many to try all; 100,000 give a p-value of 0.05 to 0.0014.
    pub draws: usize,
    /// Resamplings for an interval; 10,000 is the custom for 95 % intervals.
    pub resamples: usize,
    /// Seed of all draws.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self { methods: Vec::new(), compat_psb: false, hits: 10, draws: 100_000, resamples: 10_000, seed: 2014 }
    }
}

/// The results of one method: its queries in the order of the gallery, and what they amount to.
#[derive(Clone, Debug)]
pub struct MethodResult {
    /// The method, as `symmetry` or `symmetry:phase`.
    pub name: String,
    /// The queries in the order of the gallery.
    pub queries: Vec<QueryResult>,
    /// Means over them.
    pub summary: Summary,
}

/// The results of all methods on one gallery.
#[derive(Clone, Debug)]
pub struct Evaluation {
    /// Which models were ranked.
    pub gallery: Gallery,
    /// How the gallery came about; empty where [`score`] was called directly.
    pub coverage: Coverage,
    /// In the order they were given.
    pub methods: Vec<MethodResult>,
    /// The expected results of a random ranking.
    pub chance: Summary,
    /// The results of an ideal ranking; not all measures reach 1.
    pub ceiling: Summary,
    /// Pairs of methods, tested.
    pub comparisons: Vec<Comparison>,
    /// How it was evaluated.
    pub options: Options,
}

/// Scores `entrants`, each a distance on the models of `gallery`, and writes their matrices and runs into `out`.
///
/// # Errors
/// A distance that is not a number; a gallery without a single query; two methods of one name; a file that cannot be
/// read or written.
pub fn score(gallery: Gallery, entrants: &[Entrant], options: &Options, out: Option<&Path>) -> Result<Evaluation> {
    gallery.require_queries()?;
    check_names(entrants)?;
    let mut methods = Vec::with_capacity(entrants.len());
    for entrant in entrants {
        let mut results = out.map(|out| Results::create(out, &entrant.name, &gallery)).transpose()?;
        let queries = ranking::run(&gallery, entrant, options.hits, results.as_mut())?;
        results.map_or(Ok(()), Results::finish)?;
        let summary = Summary::of(&gallery, queries.iter().map(|q| (q.query, &q.scores, &q.curves)));
        methods.push(MethodResult { name: entrant.name.clone(), queries, summary });
    }
    let comparisons = significance::compare_all(&gallery, &methods, options);
    let chance = chance::random(&gallery, options.seed);
    let ceiling = chance::ideal(&gallery);
    let coverage = Coverage::default();
    Ok(Evaluation { gallery, coverage, methods, chance, ceiling, comparisons, options: options.clone() })
}

/// Names are told apart in files too.
fn check_names(entrants: &[Entrant]) -> Result<()> {
    let mut names = BTreeSet::from(["chance".to_owned(), "ceiling".to_owned()]);
    match entrants.iter().find(|entrant| !names.insert(formats::file_name(&entrant.name))) {
        Some(entrant) => Err(RunError::Usage(format!("there are two methods {}; give one another name", entrant.name))),
        None if entrants.is_empty() => Err(RunError::Usage("there is no method to evaluate".into())),
        None => Ok(()),
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::gallery::tests::gallery;
    use super::ranking::tests::on_a_line;
    use super::*;

    /// Two classes of three on a line, found by their places ("good") and by the order of their names ("bad").
    pub(crate) fn toy() -> Evaluation {
        let places = [0.0, 1.0, 2.0, 10.0, 11.0, 12.0];
        let mixed = [0.0, 10.0, 20.0, 1.0, 11.0, 21.0];
        let entrants = [on_a_line("good", places.to_vec()), on_a_line("bad", mixed.to_vec())];
        let options = Options { resamples: 200, ..Options::default() };
        score(gallery(&["a", "a", "a", "b", "b", "b"]), &entrants, &options, None).unwrap()
    }

    #[test]
    fn names_must_differ_in_files_too() {
        let gallery = || gallery(&["a", "a"]);
        let entrant = |name| on_a_line(name, vec![0.0, 1.0]);
        for names in [&["x", "x"][..], &["x:y", "x-y"], &["chance"], &[]] {
            let entrants: Vec<_> = names.iter().map(|name| entrant(name)).collect();
            assert!(score(gallery(), &entrants, &Options::default(), None).is_err(), "{names:?}");
        }
    }

    #[test]
    fn a_perfect_ranking_reaches_the_ceiling_and_a_mixed_one_does_not() {
        let evaluation = toy();
        assert_eq!(evaluation.methods[0].summary, evaluation.ceiling);
        assert_eq!(evaluation.methods[1].summary.micro.nn, 0.0);
        let comparison = &evaluation.comparisons[0];
        assert!(comparison.mean_difference > 0.4);
        // 2 of 2^6 sign flips of queries, 2 of 2^2 of classes
        assert_eq!((comparison.p_query, comparison.p_class, comparison.p_holm), (2.0 / 64.0, 0.5, 0.5));
    }
}
