//! Rankings: all distances of a query, in order, in one pass that scores them and writes them down.

use super::formats::results::Results;
use super::gallery::Gallery;
use super::measures::{Group, Scores};
use super::precision_recall::Curves;
use crate::error::{Result, RunError};
use rayon::prelude::*;

/// Queries whose distances are computed together: their descriptors stay in the cache.
const BLOCK: usize = 16;
/// Models compared with a block of queries at a time: 256 descriptors of 96 f32 are 96 KiB.
const TILE: usize = 256;

/// Distances between the models of a gallery (places in it), smaller is more alike. An infinite one means that the
/// model was not found at all: it has no rank, and what is relevant among such models counts as missed.
pub trait Distances: Sync {
    /// The distances of each of `queries` to all models.
    ///
    /// # Errors
    /// A file that cannot be read.
    fn rows(&self, queries: &[usize]) -> Result<Vec<Vec<f64>>>;
}

/// Distances that are computed pair by pair.
struct Pairs<F> {
    models: usize,
    distance: F,
}

impl<F: Fn(usize, usize) -> f64 + Sync> Distances for Pairs<F> {
    fn rows(&self, queries: &[usize]) -> Result<Vec<Vec<f64>>> {
        let mut rows = vec![vec![0.0; self.models]; queries.len()];
        for start in (0..self.models).step_by(TILE) {
            let tile = start..self.models.min(start + TILE);
            for (row, &query) in rows.iter_mut().zip(queries) {
                tile.clone().for_each(|model| row[model] = (self.distance)(query, model));
            }
        }
        Ok(rows)
    }
}

/// What is evaluated: a method's name and its distances.
pub struct Entrant<'a> {
    /// The method.
    pub name: String,
    /// How far apart the models are by it.
    pub distances: Box<dyn Distances + 'a>,
}

impl<'a> Entrant<'a> {
    /// An entrant on `models` models that computes each distance.
    pub fn of_pairs(name: &str, models: usize, distance: impl Fn(usize, usize) -> f64 + Sync + 'a) -> Self {
        Self { name: name.to_owned(), distances: Box::new(Pairs { models, distance }) }
    }
}

/// One query's results.
#[derive(Clone, Debug, PartialEq)]
pub struct QueryResult {
    /// Its place in the gallery.
    pub query: usize,
    /// Its measures.
    pub scores: Scores,
    /// The expected scores over random orders of equally distant models, where these make a difference.
    pub expected: Option<Scores>,
    /// Its precision over recall.
    pub curves: Curves,
    /// The first hits: places in the gallery and distances.
    pub hits: Vec<(usize, f64)>,
}

/// What the pass leaves of one model: its result, if it is a query, and what is written of it.
struct Visited {
    result: Option<QueryResult>,
    row: Vec<u8>,
    lines: String,
}

/// Ranks and scores all queries of `gallery` by `entrant`, keeping `hits` of each; in the gallery's order. The rows of
/// distances and the rankings go to `results`, a few blocks in memory at a time.
///
/// # Errors
/// A distance that is not a number; a file that cannot be read or written.
pub fn run(
    gallery: &Gallery,
    entrant: &Entrant,
    hits: usize,
    mut results: Option<&mut Results>,
) -> Result<Vec<QueryResult>> {
    let models = if results.is_some() { (0..gallery.len()).collect() } else { gallery.queries() };
    let mut scored = Vec::with_capacity(models.len());
    let form = results.as_ref().map(|results| results.form());
    for wave in models.chunks(BLOCK * rayon::current_num_threads()) {
        let visit = |block: &[usize]| -> Result<Vec<Visited>> {
            let rows = entrant.distances.rows(block)?;
            let visit = |(&model, row): (&usize, &Vec<f64>)| {
                check(gallery, entrant, model, row)?;
                let order = if gallery.class(model).queried { rank(gallery, model, row) } else { Vec::new() };
                let result = gallery.class(model).queried.then(|| score(gallery, model, row, &order, hits));
                let (row, lines) =
                    form.as_ref().map(|form| (form.row(row), form.lines(gallery, model, &order))).unwrap_or_default();
                Ok(Visited { result, row, lines })
            };
            block.iter().zip(&rows).map(visit).collect()
        };
        let blocks: Vec<_> = wave.par_chunks(BLOCK).map(visit).collect::<Result<_>>()?;
        for visited in blocks.into_iter().flatten() {
            results.as_mut().map_or(Ok(()), |results| results.write(&visited.row, &visited.lines))?;
            scored.extend(visited.result);
        }
    }
    Ok(scored)
}

fn check(gallery: &Gallery, entrant: &Entrant, model: usize, row: &[f64]) -> Result<()> {
    match row.iter().position(|distance| distance.is_nan()) {
        Some(bad) => {
            let (name, a, b) = (&entrant.name, &gallery.ids[model], &gallery.ids[bad]);
            Err(RunError::Usage(format!("{name}: the distance between {a} and {b} is not a number")))
        }
        None => Ok(()),
    }
}

/// All other models that were found, in the order of their distance from `query` (numbers, all of them), ties in the
/// byte order of their ids.
pub fn rank(gallery: &Gallery, query: usize, row: &[f64]) -> Vec<usize> {
    let found = |&model: &usize| model != query && row[model] < f64::INFINITY;
    let mut order: Vec<_> = (0..row.len()).filter(found).collect();
    order.sort_unstable_by(|&a, &b| {
        let by_distance = row[a].partial_cmp(&row[b]).unwrap_or(std::cmp::Ordering::Equal);
        by_distance.then_with(|| gallery.id_order[a].cmp(&gallery.id_order[b]))
    });
    order
}

fn score(gallery: &Gallery, query: usize, row: &[f64], order: &[usize], hits: usize) -> QueryResult {
    let (relevant, others) = (gallery.class(query).relevant(), gallery.len() - 1);
    let is_relevant = |model: usize| gallery.class_of[model] == gallery.class_of[query];
    let ranks: Vec<_> = (1..=order.len()).filter(|r| is_relevant(order[r - 1])).collect();
    let groups = order
        .chunk_by(|&a, &b| row[a] == row[b])
        .map(|tied| Group { size: tied.len(), relevant: tied.iter().filter(|&&model| is_relevant(model)).count() });
    let matters = |group: &Group| group.relevant > 0 && group.relevant < group.size;
    let expected = groups.clone().any(|group| matters(&group));
    QueryResult {
        query,
        scores: Scores::of(&ranks, relevant, others),
        expected: expected.then(|| Scores::expected(groups, relevant, others)),
        curves: Curves::of(&ranks, relevant),
        hits: order.iter().take(hits).map(|&model| (model, row[model])).collect(),
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::gallery::tests::gallery;
    use super::*;

    /// Models on a line, compared by how far apart they are.
    pub(crate) fn on_a_line(name: &str, places: Vec<f64>) -> Entrant<'static> {
        Entrant::of_pairs(name, places.len(), move |a, b| (places[a] - places[b]).abs())
    }

    #[test]
    fn a_query_is_not_in_its_own_list() {
        let gallery = gallery(&["a", "a", "b"]);
        assert_eq!(rank(&gallery, 0, &[0.0, 2.0, 1.0]), [2, 1]);
    }

    #[test]
    fn ties_go_by_id_and_their_expectation_is_told() {
        // query m0000 of class a: m0001 (a), m0002 (b), m0003 (b) all at distance 1
        let gallery = gallery(&["a", "a", "b", "b"]);
        let results = run(&gallery, &on_a_line("line", vec![0.0, 1.0, 1.0, -1.0]), 3, None).unwrap();
        assert_eq!(results[0].hits, [(1, 1.0), (2, 1.0), (3, 1.0)]);
        assert_eq!(results[0].scores.nn, 1.0);
        let expected = results[0].expected.unwrap();
        assert!((expected.nn - 1.0 / 3.0).abs() < 1e-12);
        assert!((expected.ap - (1.0 + 1.0 / 2.0 + 1.0 / 3.0) / 3.0).abs() < 1e-12);
        // m0003 (b) sees 1 (a), then 2 (a) and 2 (b): the tie hides where its one relevant model is
        assert_eq!(results[3].scores.ap, 1.0 / 3.0);
        assert!((results[3].expected.unwrap().ap - (1.0 / 2.0 + 1.0 / 3.0) / 2.0).abs() < 1e-12);
    }

    #[test]
    fn ties_among_equally_relevant_models_change_nothing() {
        let gallery = gallery(&["a", "a", "a", "b"]);
        let results = run(&gallery, &on_a_line("line", vec![0.0, 1.0, -1.0, 5.0]), 3, None).unwrap();
        assert!(results[0].expected.is_none());
    }

    #[test]
    fn a_distance_that_is_not_a_number_is_an_error() {
        let gallery = gallery(&["a", "a", "b"]);
        let error = run(&gallery, &Entrant::of_pairs("odd", 3, |_, _| f64::NAN), 3, None).unwrap_err();
        assert!(error.to_string().contains("odd: the distance between m0000 and m0000"), "{error}");
    }

    #[test]
    fn what_was_not_found_counts_as_missed() {
        // the query m0000 finds m0003 (b), then m0001 (a), and never m0002 (a)
        let gallery = gallery(&["a", "a", "a", "b"]);
        let row = [0.0, 2.0, f64::INFINITY, 1.0];
        let entrant = Entrant::of_pairs("some", 4, move |a, b| if a == 0 { row[b] } else { 0.0 });
        let result = &run(&gallery, &entrant, 9, None).unwrap()[0];
        assert_eq!(result.hits, [(3, 1.0), (1, 2.0)]);
        assert_eq!((result.scores.ap, result.scores.ft, result.scores.st), (0.25, 0.5, 0.5));
        assert_eq!((result.curves.pr11[5], result.curves.pr11[6]), (0.5, 0.0));
        assert_eq!((result.curves.pr20[9], result.curves.pr20[19]), (Some(0.5), Some(0.0)));
    }

    #[test]
    fn rows_come_in_order_whatever_the_blocks() {
        let places: Vec<_> = (0..600).map(f64::from).collect();
        let gallery = gallery(&["a"; 600]);
        let results = run(&gallery, &on_a_line("line", places.clone()), 1, None).unwrap();
        assert!(results.iter().enumerate().all(|(i, result)| result.query == i));
        let rows = on_a_line("line", places).distances.rows(&[7, 3]).unwrap();
        assert_eq!((rows[0][0], rows[0][599], rows[1][300]), (7.0, 592.0, 297.0));
    }
}
