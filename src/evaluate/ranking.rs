//! Rankings: all distances of a query, in order.

use super::gallery::Gallery;
use super::measures::{Group, Scores};
use super::precision_recall::Curves;
use crate::error::{Result, RunError};
use rayon::prelude::*;

/// Queries whose distances are computed together: their descriptors stay in the cache.
const BLOCK: usize = 16;
/// Models compared with a block of queries at a time: 256 descriptors of 96 f32 are 96 KiB.
const TILE: usize = 256;

/// A distance to be evaluated: from model to model of a gallery (places in it), smaller is more alike.
pub struct Entrant<'a> {
    pub name: String,
    pub distance: Box<dyn Fn(usize, usize) -> f64 + Send + Sync + 'a>,
}

/// One query's results.
#[derive(Clone, Debug, PartialEq)]
pub struct QueryResult {
    /// Its place in the gallery.
    pub query: usize,
    pub scores: Scores,
    /// The expected scores over random orders of equally distant models, where these make a difference.
    pub expected: Option<Scores>,
    pub curves: Curves,
    /// The first hits: places in the gallery and distances.
    pub hits: Vec<(usize, f64)>,
}

/// Ranks and scores all queries of `gallery` by `entrant`, keeping `hits` of each; in the gallery's order.
///
/// # Errors
/// A distance that is not a number.
pub fn run(gallery: &Gallery, entrant: &Entrant, hits: usize) -> Result<Vec<QueryResult>> {
    let queries = gallery.queries();
    let blocks: Result<Vec<Vec<_>>> = queries
        .par_chunks(BLOCK)
        .map(|block| {
            let rows = rows(gallery.len(), entrant, block);
            block.iter().zip(&rows).map(|(&query, row)| score(gallery, query, row, hits)).collect()
        })
        .collect();
    Ok(blocks?.concat())
}

/// The distances of each query of a block to all `n` models, tile by tile.
pub fn rows(n: usize, entrant: &Entrant, block: &[usize]) -> Vec<Vec<f64>> {
    let mut rows = vec![vec![0.0; n]; block.len()];
    for start in (0..n).step_by(TILE) {
        for (row, &query) in rows.iter_mut().zip(block) {
            let end = n.min(start + TILE);
            (start..end).for_each(|model| row[model] = (entrant.distance)(query, model));
        }
    }
    rows
}

/// All rows of distances in order, a few blocks in memory at a time.
pub fn each_row(n: usize, entrant: &Entrant, mut visit: impl FnMut(usize, &[f64]) -> Result<()>) -> Result<()> {
    let all: Vec<_> = (0..n).collect();
    for wave in all.chunks(BLOCK * rayon::current_num_threads()) {
        let blocks: Vec<_> = wave.par_chunks(BLOCK).map(|block| rows(n, entrant, block)).collect();
        for (&query, row) in wave.iter().zip(blocks.iter().flatten()) {
            visit(query, row)?;
        }
    }
    Ok(())
}

/// All other models in the order of their distance from `query`, ties in the byte order of their ids.
///
/// # Errors
/// A distance that is not a number.
pub fn rank(gallery: &Gallery, query: usize, row: &[f64]) -> Result<Vec<usize>> {
    let others = || (0..row.len()).filter(|&model| model != query);
    if let Some(bad) = others().find(|&model| row[model].is_nan()) {
        let (a, b) = (&gallery.ids[query], &gallery.ids[bad]);
        return Err(RunError::Usage(format!("the distance between {a} and {b} is not a number")));
    }
    let mut order: Vec<_> = others().collect();
    order.sort_unstable_by(|&a, &b| {
        let by_distance = row[a].partial_cmp(&row[b]).expect("NaN was refused above");
        by_distance.then_with(|| gallery.id_order[a].cmp(&gallery.id_order[b]))
    });
    Ok(order)
}

fn score(gallery: &Gallery, query: usize, row: &[f64], hits: usize) -> Result<QueryResult> {
    let order = rank(gallery, query, row)?;
    let relevant = |model: usize| gallery.class_of[model] == gallery.class_of[query];
    let ranks: Vec<_> = (1..=order.len()).filter(|r| relevant(order[r - 1])).collect();
    let groups = order
        .chunk_by(|&a, &b| row[a] == row[b])
        .map(|tied| Group { size: tied.len(), relevant: tied.iter().filter(|&&model| relevant(model)).count() });
    let matters = |group: &Group| group.relevant > 0 && group.relevant < group.size;
    let expected = groups.clone().any(|group| matters(&group));
    Ok(QueryResult {
        query,
        scores: Scores::of(&ranks, order.len()),
        expected: expected.then(|| Scores::expected(groups, ranks.len(), order.len())),
        curves: Curves::of(&ranks),
        hits: order.iter().take(hits).map(|&model| (model, row[model])).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::super::gallery::tests::gallery;
    use super::*;

    /// Models on a line, compared by how far apart they are.
    fn on_a_line(places: &[f64]) -> Entrant<'_> {
        Entrant { name: "line".into(), distance: Box::new(|a, b| (places[a] - places[b]).abs()) }
    }

    #[test]
    fn a_query_is_not_in_its_own_list() {
        let gallery = gallery(&["a", "a", "b"]);
        assert_eq!(rank(&gallery, 0, &[0.0, 2.0, 1.0]).unwrap(), [2, 1]);
    }

    #[test]
    fn ties_go_by_id_and_their_expectation_is_told() {
        // query m0000 of class a: m0001 (a), m0002 (b), m0003 (b) all at distance 1
        let gallery = gallery(&["a", "a", "b", "b"]);
        let entrant = on_a_line(&[0.0, 1.0, 1.0, -1.0]);
        let results = run(&gallery, &entrant, 3).unwrap();
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
        let results = run(&gallery, &on_a_line(&[0.0, 1.0, -1.0, 5.0]), 3).unwrap();
        assert!(results[0].expected.is_none());
    }

    #[test]
    fn a_distance_that_is_not_a_number_is_an_error() {
        let gallery = gallery(&["a", "a", "b"]);
        let entrant = Entrant { name: "nan".into(), distance: Box::new(|_, _| f64::NAN) };
        assert!(run(&gallery, &entrant, 3).is_err());
    }

    #[test]
    fn rows_come_in_order_whatever_the_blocks() {
        let places: Vec<_> = (0..600).map(f64::from).collect();
        let entrant = on_a_line(&places);
        let mut next = 0;
        let visit = |query: usize, row: &[f64]| {
            assert_eq!(query, next);
            assert_eq!((row[0], row[599]), (query as f64, 599.0 - query as f64));
            next += 1;
            Ok(())
        };
        each_row(600, &entrant, visit).unwrap();
        assert_eq!(next, 600);
    }
}
