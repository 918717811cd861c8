//! The rows of distances and the rankings of one method, written while they are computed.

use super::super::Gallery;
use super::{Draft, file_name, matrix, token, trec};
use crate::error::Result;
use std::path::Path;

/// Models up to which a TREC run holds whole rankings; beyond, it would be many times the size of the matrix.
pub const WHOLE_RUNS: usize = 5_000;
/// Places of a ranking that a run holds beyond that: the custom at TREC.
const DEPTH: usize = 1_000;

/// How many places of each ranking a run over `gallery` holds: in large ones `DEPTH`, or the second tier of the
/// largest class.
pub fn run_depth(gallery: &Gallery) -> usize {
    let tier = gallery.queried().map(|class| 2 * class.relevant()).max().unwrap_or(0);
    if gallery.len() <= WHOLE_RUNS { gallery.len() } else { DEPTH.max(tier) }
}

/// `<method>.matrix` and `<method>.run.trec`.
pub struct Results {
    matrix: Draft,
    run: Draft,
    form: Form,
}

/// How rows become bytes and lines; knows no file, so that threads may share it.
#[derive(Clone)]
pub struct Form {
    tag: String,
    depth: usize,
}

impl Results {
    /// Begins the files of the method `name` in the folder `out`.
    ///
    /// # Errors
    /// Where they cannot be made.
    pub fn create(out: &Path, name: &str, gallery: &Gallery) -> Result<Self> {
        let file = file_name(name);
        Ok(Self {
            matrix: Draft::create(&out.join(format!("{file}.matrix")))?,
            run: Draft::create(&out.join(format!("{file}.run.trec")))?,
            form: Form { tag: token(name).into_owned(), depth: run_depth(gallery) },
        })
    }

    /// How rows are written.
    pub fn form(&self) -> Form {
        self.form.clone()
    }

    /// Writes what [`Form`] made of one model.
    ///
    /// # Errors
    /// Where the files cannot be written.
    pub fn write(&mut self, row: &[u8], lines: &str) -> Result<()> {
        self.matrix.write(row)?;
        self.run.write(lines.as_bytes())
    }

    /// Publishes the files.
    ///
    /// # Errors
    /// Where they cannot be written.
    pub fn finish(self) -> Result<()> {
        self.matrix.publish()?;
        self.run.publish()
    }
}

impl Form {
    /// A row of the matrix.
    pub fn row(&self, distances: &[f64]) -> Vec<u8> {
        matrix::row(distances)
    }

    /// The lines of a run for `query`.
    pub fn lines(&self, gallery: &Gallery, query: usize, order: &[usize]) -> String {
        trec::lines(gallery, query, &order[..order.len().min(self.depth)], &self.tag)
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::gallery::tests::gallery;
    use super::super::super::ranking::{run, tests::on_a_line};
    use super::*;

    #[test]
    fn one_pass_writes_the_matrix_and_the_run() {
        let folder = tempfile::tempdir().unwrap();
        let gallery = gallery(&["a", "a", "b"]);
        let mut results = Results::create(folder.path(), "cpca:phase", &gallery).unwrap();
        let scored = run(&gallery, &on_a_line("cpca:phase", vec![0.0, 0.5, 1.0]), 3, Some(&mut results)).unwrap();
        assert_eq!(scored.len(), 2, "the single model of b is no query");
        assert!(!folder.path().join("cpca-phase.matrix").exists(), "published whole");
        results.finish().unwrap();
        let matrix = std::fs::read(folder.path().join("cpca-phase.matrix")).unwrap();
        let expected = [0.0f32, 0.5, 1.0, 0.5, 0.0, 0.5, 1.0, 0.5, 0.0].map(f32::to_le_bytes).concat();
        assert_eq!(matrix, expected);
        let run = std::fs::read_to_string(folder.path().join("cpca-phase.run.trec")).unwrap();
        let lines = "m0000 Q0 m0001 1 -1 cpca:phase\nm0000 Q0 m0002 2 -2 cpca:phase\n\
                     m0001 Q0 m0000 1 -1 cpca:phase\nm0001 Q0 m0002 2 -2 cpca:phase\n";
        assert_eq!(run, lines);
    }

    #[test]
    fn runs_over_many_models_are_cut() {
        assert_eq!(run_depth(&gallery(&["a"; 50])), 50);
        assert_eq!(run_depth(&gallery(&vec!["a"; WHOLE_RUNS + 1])), 2 * WHOLE_RUNS);
        let categories: Vec<_> = (0..WHOLE_RUNS + 1).map(|i| format!("{:05}", i / 3)).collect();
        assert_eq!(run_depth(&gallery(&categories.iter().map(String::as_str).collect::<Vec<_>>())), DEPTH);
    }
}
