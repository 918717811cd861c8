//! TREC judgements (`qid 0 docid rel`) and runs (`qid Q0 docid rank score tag`).
//!
//! The score is the negative rank: tools hold scores as f32 and break ties in ways of their own. In runs of others a
//! higher score is better, whatever the rank says, as for trec_eval.

use super::super::Gallery;
use super::super::gallery::MISCELLANEOUS;
use super::super::ranking::Distances;
use super::{token, untoken};
use crate::error::{Result, RunError};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;

/// Writes the relevant models of each query.
pub fn write_judgements(gallery: &Gallery, out: &mut dyn Write) -> std::io::Result<()> {
    for query in gallery.queries() {
        for model in gallery.class(query).members.clone().filter(|&model| model != query) {
            writeln!(out, "{} 0 {} 1", token(&gallery.ids[query]), token(&gallery.ids[model]))?;
        }
    }
    Ok(())
}

/// The lines of a run for `query`, which found `order`.
pub fn lines(gallery: &Gallery, query: usize, order: &[usize], tag: &str) -> String {
    let id = token(&gallery.ids[query]);
    let mut lines = String::with_capacity(order.len() * (id.len() + tag.len() + 40));
    for (place, &model) in order.iter().enumerate() {
        let (rank, model) = (place + 1, token(&gallery.ids[model]));
        writeln!(lines, "{id} Q0 {model} {rank} -{rank} {tag}").expect("a string takes all text");
    }
    lines
}

/// The (id, class) pairs of judgements, each class named after its first model; `others` are models without a judgement.
///
/// A model is relevant from 1 on. Our measures know relevance as membership of one class, so judgements must be such.
///
/// # Errors
/// What is wrong, in words.
pub fn classes(text: &str, others: &BTreeSet<String>) -> std::result::Result<Vec<(String, String)>, String> {
    let mut relevant: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    let mut ids = BTreeSet::new();
    for (at, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let fields: Vec<_> = line.split_whitespace().collect();
        let &[query, _, model, judgement] = &fields[..] else {
            return Err(format!("line {}: `qid 0 docid rel` is expected", at + 1));
        };
        let judgement: i64 =
            judgement.parse().map_err(|_| format!("line {}: `{judgement}` is no judgement", at + 1))?;
        ids.extend([query, model]);
        let class = relevant.entry(query).or_insert_with(|| BTreeSet::from([query]));
        if judgement > 0 {
            class.insert(model);
        }
    }
    for (query, class) in relevant.iter().filter(|(_, class)| class.len() > 1) {
        let other = class.iter().find(|&model| relevant.get(model) != Some(class));
        if let Some(other) = other {
            return Err(format!(
                "{query} and {other} do not have the same relevant models, as those of one class have"
            ));
        }
    }
    let class_of = |id: &str| relevant.get(id).filter(|class| class.len() > 1).and_then(|class| class.first());
    let judged = ids.iter().map(|id| (untoken(id), untoken(class_of(id).unwrap_or(&MISCELLANEOUS))));
    let mut pairs: BTreeMap<_, _> = others.iter().map(|id| (id.clone(), MISCELLANEOUS.to_owned())).collect();
    pairs.extend(judged);
    Ok(pairs.into_iter().collect())
}

/// The ids of all models that the run at `path` speaks of.
///
/// # Errors
/// A file that cannot be read or is no run.
pub fn ids(path: &Path) -> Result<BTreeSet<String>> {
    let mut ids = BTreeSet::new();
    each_line(path, |query, model, _| {
        for id in [query, model] {
            if !ids.contains(id) {
                ids.insert(id.to_owned());
            }
        }
        Ok(())
    })?;
    Ok(ids.iter().map(|id| untoken(id)).collect())
}

/// A run of somebody, as distances: the scores turned around, infinite where a model is not in the list.
pub struct Run {
    models: usize,
    /// What each query found.
    found: Vec<Vec<(u32, f64)>>,
}

impl Run {
    /// Reads the run at `path`; `place_of` tells the place of an id among `models` ones; others are passed over.
    ///
    /// # Errors
    /// A file that cannot be read, is no run, or lists a model twice.
    pub fn read(path: &Path, models: usize, place_of: &BTreeMap<String, usize>) -> Result<Self> {
        let mut found = vec![Vec::new(); models];
        each_line(path, |query, model, score| {
            let place = |token: &str| place_of.get(&untoken(token)).copied();
            if let (Some(query), Some(model)) = (place(query), place(model)) {
                found[query].push((model as u32, -score));
            }
            Ok(())
        })?;
        for (query, list) in found.iter_mut().enumerate() {
            list.sort_unstable_by_key(|hit: &(u32, f64)| hit.0);
            if let Some(twice) = list.windows(2).find(|pair| pair[0].0 == pair[1].0) {
                let name = |place: usize| place_of.iter().find(|(_, p)| **p == place).map_or("", |(id, _)| id);
                let (query, model) = (name(query), name(twice[0].0 as usize));
                return Err(RunError::Usage(format!("run {}: {query} lists {model} twice", path.display())));
            }
        }
        Ok(Self { models, found })
    }

    /// The number of models with a list.
    pub fn lists(&self) -> usize {
        self.found.iter().filter(|list| !list.is_empty()).count()
    }
}

impl Distances for Run {
    fn rows(&self, queries: &[usize]) -> Result<Vec<Vec<f64>>> {
        let row = |&query: &usize| {
            let mut row = vec![f64::INFINITY; self.models];
            self.found[query].iter().for_each(|&(model, distance)| row[model as usize] = distance);
            row
        };
        Ok(queries.iter().map(row).collect())
    }
}

/// Calls `visit` with the query, the model and the score of each line.
fn each_line(path: &Path, mut visit: impl FnMut(&str, &str, f64) -> Result<()>) -> Result<()> {
    let failed = |source| RunError::file(path, source);
    let mut reader = BufReader::new(File::open(path).map_err(failed)?);
    let (mut line, mut number) = (String::new(), 0);
    while reader.read_line(&mut line).map_err(failed)? > 0 {
        number += 1;
        let wrong = |why: &str| RunError::Usage(format!("run {}, line {number}: {why}", path.display()));
        let fields: Vec<_> = line.split_whitespace().collect();
        match &fields[..] {
            [] => {}
            &[query, _, model, _, score, _] => match score.parse::<f64>() {
                Ok(score) if score.is_finite() => visit(query, model, score)?,
                _ => return Err(wrong(&format!("`{score}` is no score"))),
            },
            _ => return Err(wrong("`qid Q0 docid rank score tag` is expected")),
        }
        line.clear();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::super::gallery::tests::gallery;
    use super::*;

    #[test]
    fn judgements_leave_the_query_and_distractors_out() {
        let mut judgements = Vec::new();
        write_judgements(&gallery(&["a", "a", "b"]), &mut judgements).unwrap();
        assert_eq!(String::from_utf8(judgements).unwrap(), "m0000 0 m0001 1\nm0001 0 m0000 1\n");
    }

    #[test]
    fn judgements_make_classes_and_the_rest_distracts() {
        let text = "b 0 a%20x 2\na%20x 0 b 1\na%20x 0 c 0\n\nc 0 b 0\n";
        let pairs = classes(text, &BTreeSet::from(["d".to_owned(), "b".to_owned()])).unwrap();
        let pairs: Vec<_> = pairs.iter().map(|(id, class)| (id.as_str(), class.as_str())).collect();
        assert_eq!(pairs, [("a x", "a x"), ("b", "a x"), ("c", "-1"), ("d", "-1")]);
    }

    #[test]
    fn judgements_that_make_no_classes_are_refused() {
        for (text, why) in [
            ("a 0 b 1\n", "same relevant"),
            ("a 0 b 1\nb 0 a 1\nb 0 c 1\nc 0 b 1\n", "same relevant"),
            ("a 0 b\n", "line 1"),
            ("a 0 b yes\n", "judgement"),
        ] {
            let error = classes(text, &BTreeSet::new()).unwrap_err();
            assert!(error.contains(why), "{error}");
        }
    }

    fn run_of(text: &str) -> Result<Run> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.run");
        std::fs::write(&path, text).unwrap();
        let places = ["a", "b", "c d"].iter().enumerate().map(|(place, id)| ((*id).to_owned(), place)).collect();
        Run::read(&path, 3, &places)
    }

    #[test]
    fn scores_become_distances_and_what_is_not_listed_is_infinitely_far() {
        let run = run_of("a Q0 c%20d 1 0.5 x\na Q0 unknown 2 0.4 x\n\nb Q0 a 7 -3e2 x\n").unwrap();
        let infinite = f64::INFINITY;
        let expected = [[infinite, infinite, -0.5], [300.0, infinite, infinite], [infinite; 3]];
        assert_eq!(run.rows(&[0, 1, 2]).unwrap(), expected);
        assert_eq!(run.lists(), 2);
    }

    #[test]
    fn what_is_no_run_is_refused_with_its_line() {
        for (text, why) in [
            ("a Q0 b 1 0.5 x\na Q0 b 2 0.4 x\n", "a lists b twice"),
            ("a Q0 b 1 0.5 x\na Q0 b 0.4 x\n", "line 2"),
            ("a Q0 b 1 NaN x\n", "NaN"),
        ] {
            let error = run_of(text).map(|_| ()).unwrap_err().to_string();
            assert!(error.contains(why), "{error}");
        }
    }
}
