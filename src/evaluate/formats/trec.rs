//! TREC judgements (`qid 0 docid rel`) and runs (`qid Q0 docid rank score tag`).
//!
//! The score is the negative rank: tools hold scores as f32 and break ties in ways of their own.

use super::super::Gallery;
use super::super::ranking::{Entrant, each_row, rank};
use super::{create, token};
use crate::error::{Result, RunError};
use std::io::Write;
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

/// Writes the ranking of all queries by `entrant`.
///
/// # Errors
/// Where the file cannot be written; a distance that is not a number.
pub fn write_run(path: &Path, gallery: &Gallery, entrant: &Entrant) -> Result<()> {
    let tag = token(&entrant.name);
    create(path, |out| {
        each_row(gallery.len(), entrant, |query, row| {
            if !gallery.class(query).queried {
                return Ok(());
            }
            let id = token(&gallery.ids[query]);
            for (place, model) in rank(gallery, query, row)?.into_iter().enumerate() {
                let (rank, model) = (place + 1, token(&gallery.ids[model]));
                writeln!(out, "{id} Q0 {model} {rank} -{rank} {tag}").map_err(|source| RunError::file(path, source))?;
            }
            Ok(())
        })
        .map_err(std::io::Error::other)
    })
}

#[cfg(test)]
mod tests {
    use super::super::super::gallery::tests::gallery;
    use super::*;

    #[test]
    fn judgements_and_runs_leave_the_query_and_distractors_out() {
        let gallery = gallery(&["a", "a", "b"]);
        let mut judgements = Vec::new();
        write_judgements(&gallery, &mut judgements).unwrap();
        assert_eq!(String::from_utf8(judgements).unwrap(), "m0000 0 m0001 1\nm0001 0 m0000 1\n");
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("line.run.trec");
        let entrant = Entrant { name: "cpca:phase".into(), distance: Box::new(|a, b| a.abs_diff(b) as f64) };
        write_run(&path, &gallery, &entrant).unwrap();
        let expected = "m0000 Q0 m0001 1 -1 cpca:phase\nm0000 Q0 m0002 2 -2 cpca:phase\n\
                        m0001 Q0 m0000 1 -1 cpca:phase\nm0001 Q0 m0002 2 -2 cpca:phase\n";
        assert_eq!(std::fs::read_to_string(path).unwrap(), expected);
    }
}
