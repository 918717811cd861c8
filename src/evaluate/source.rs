//! Where distances come from: the descriptors of a store, and the matrices and runs of others beside them.

use super::formats::matrix::Matrix;
use super::formats::trec::{self, Run};
use super::labels::{Assignment, Labels, Missing};
use super::{Entrant, Evaluation, Gallery, Options, output, score};
use crate::error::{Result, RunError};
use crate::search::{self, Kind, Name, Rows};
use crate::store::Store;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// What is evaluated.
pub struct Input<'a> {
    /// The models and the methods of our own. Without a store the models are those of the labels.
    pub store: Option<&'a Store>,
    /// Which models are of one class.
    pub labels: Labels,
    /// Princeton matrices, their rows in the order of the labels.
    pub matrices: Vec<Named>,
    /// TREC runs.
    pub runs: Vec<Named>,
}

impl<'a> Input<'a> {
    /// The methods of a store alone.
    pub fn of_store(store: &'a Store, labels: Labels) -> Self {
        Self { store: Some(store), labels, matrices: Vec::new(), runs: Vec::new() }
    }
}

/// A file with the results of a method: "name=FILE", or "FILE", which names the method too.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Named {
    /// The method.
    pub name: String,
    /// The file.
    pub path: PathBuf,
}

impl FromStr for Named {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let (name, path) = match text.split_once('=') {
            Some((name, path)) if !name.contains(['/', '\\']) => (name.to_owned(), path),
            _ => (stem(text), text),
        };
        if name.trim().is_empty() || path.is_empty() {
            return Err("NAME=FILE is expected".into());
        }
        Ok(Self { name, path: path.into() })
    }
}

/// The file's name without what tells its format.
fn stem(path: &str) -> String {
    let name = Path::new(path).file_name().map_or(path.into(), |name| name.to_string_lossy());
    let endings = [".run.trec", ".trec", ".run", ".txt", ".matrix"];
    endings.iter().find_map(|ending| name.strip_suffix(ending)).unwrap_or(&name).to_owned()
}

/// What the labels, the models and the files of others have to do with each other.
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
    /// Files of others, with what was done about them.
    pub files: Vec<String>,
}

/// Judgements as labels; models that only the `runs` speak of are distractors.
///
/// # Errors
/// Files that cannot be read; judgements that do not make classes.
pub fn judgements(path: &Path, runs: &[Named]) -> Result<Labels> {
    let text = std::fs::read_to_string(path).map_err(|source| RunError::file(path, source))?;
    let mut others = BTreeSet::new();
    for run in runs {
        others.append(&mut trec::ids(&run.path)?);
    }
    let pairs = trec::classes(&text, &others).and_then(Labels::table);
    pairs.map_err(|why| RunError::Usage(format!("judgements {}: {why}", path.display())))
}

/// Scores all methods of `input` on the models that have a label.
///
/// # Errors
/// A method that the store does not hold; files that cannot be read or do not fit the labels; no class with two models;
/// a distance that is not a number.
pub fn evaluate(input: &Input, options: &Options) -> Result<Evaluation> {
    run(input, options, None)
}

/// [`evaluate`], and writes the report, metrics, tables, matrices, labels, judgements and runs into the folder `out`,
/// which is made where it is not there.
///
/// # Errors
/// Those of [`evaluate`]; a file that cannot be written; a damaged store.
pub fn report(input: &Input, options: &Options, out: &Path) -> Result<Evaluation> {
    std::fs::create_dir_all(out).map_err(|source| RunError::file(out, source))?;
    let evaluation = run(input, options, Some(out))?;
    output::write(&evaluation, input.store, out)?;
    Ok(evaluation)
}

fn run(input: &Input, options: &Options, out: Option<&Path>) -> Result<Evaluation> {
    let models = Models::of(input, options)?;
    models.gallery.require_queries()?;
    let mut entrants = Vec::new();
    if let Some(store) = input.store {
        entrants = own(store, &models.gallery.rows, &chosen(store, &options.methods)?)?;
    }
    let mut files = Vec::new();
    entrants.extend(matrices(input, &models, &mut files)?);
    entrants.extend(runs(input, &models, &mut files)?);
    let coverage = Coverage { files, ..models.coverage };
    Ok(Evaluation { coverage, ..score(models.gallery, &entrants, options, out)? })
}

/// The models that are ranked, and the label that each has.
struct Models {
    gallery: Gallery,
    /// For each model of the gallery, the place of its label in their table; empty for parent folders.
    label_of: Vec<usize>,
    coverage: Coverage,
}

impl Models {
    fn of(input: &Input, options: &Options) -> Result<Self> {
        let table = input.labels.pairs();
        let ids: Vec<&str> = match input.store {
            Some(store) => (0..store.len()).map(|i| store.id(i)).collect(),
            None => table.iter().map(|(id, _)| id.as_str()).collect(),
        };
        let failures: Vec<_> = input.store.map(Store::failures).unwrap_or_default().iter().collect();
        let failures: Vec<_> = failures.iter().map(|f| (f.id.as_str(), f.error.to_string())).collect();
        let assignment = match input.store {
            Some(_) => input.labels.assign(&ids, &failures),
            None => Assignment::whole(table),
        };
        let gallery = Gallery::new(&ids, &assignment, options.compat_psb);
        let label_of = gallery.rows.iter().filter_map(|&row| assignment.label_of[row]).collect();
        let coverage = Coverage {
            described: ids.len(),
            failed: failures.len(),
            unlabelled: ids.len() - assignment.labelled(),
            missing: assignment.missing,
            files: Vec::new(),
        };
        Ok(Self { gallery, label_of, coverage })
    }
}

/// The methods of the store that are asked for; all, where none is.
fn chosen(store: &Store, asked: &[String]) -> Result<Vec<Name>> {
    let mut known = search::names(store);
    for text in asked {
        let name: Name = text.parse().map_err(RunError::Usage)?;
        Rows::of(store, name)?;
        if !known.contains(&name) {
            known.push(name);
        }
    }
    let is_asked = |name: &Name| asked.iter().any(|text| *text == name.to_string() || text == name.frame.name());
    Ok(known.into_iter().filter(|name| asked.is_empty() || is_asked(name)).collect())
}

/// The distances of `names` between the models in `rows` of the store.
fn own<'a>(store: &'a Store, rows: &[usize], names: &[Name]) -> Result<Vec<Entrant<'a>>> {
    let entrant = |&name: &Name| {
        let (all, rows) = (Rows::of(store, name)?, rows.to_vec());
        let models = rows.len();
        let distance = move |a: usize, b: usize| all.distance(all.row(rows[a]), all.row(rows[b]));
        Ok(Entrant::of_pairs(&name.to_string(), models, distance))
    };
    names.iter().map(entrant).collect()
}

fn matrices(input: &Input, models: &Models, files: &mut Vec<String>) -> Result<Vec<Entrant<'static>>> {
    let labels = input.labels.pairs().len();
    if !input.matrices.is_empty() && labels == 0 {
        let why = "a matrix needs the labels that its rows are in the order of: a .cla or a CSV file";
        return Err(RunError::Usage(why.into()));
    }
    let entrant = |Named { name, path }: &Named| {
        let matrix = Matrix::open(path, labels, models.label_of.clone())?;
        files.push(format!("{name}: matrix {}, {} of its {labels} models", path.display(), models.label_of.len()));
        Ok(Entrant { name: name.clone(), distances: Box::new(matrix) })
    };
    input.matrices.iter().map(entrant).collect()
}

fn runs(input: &Input, models: &Models, files: &mut Vec<String>) -> Result<Vec<Entrant<'static>>> {
    let (gallery, table) = (&models.gallery, input.labels.pairs());
    // a run may call a model as the labels do, or as the store does
    let mut place_of: BTreeMap<String, usize> = BTreeMap::new();
    place_of.extend(models.label_of.iter().enumerate().map(|(place, &label)| (table[label].0.clone(), place)));
    place_of.extend(gallery.ids.iter().enumerate().map(|(place, id)| (id.clone(), place)));
    let entrant = |Named { name, path }: &Named| {
        let run = Run::read(path, gallery.len(), &place_of)?;
        files.push(format!("{name}: run {}, the lists of {} models", path.display(), run.lists()));
        Ok(Entrant { name: name.clone(), distances: Box::new(run) })
    };
    input.runs.iter().map(entrant).collect()
}

/// Whether a name's distances are of phases.
pub fn is_phase(name: &str) -> bool {
    name.parse::<Name>().is_ok_and(|name| name.kind == Kind::Phase)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_name_methods_unless_a_name_is_given() {
        let named = |text: &str| text.parse::<Named>().unwrap();
        let of = |name: &str, path: &str| Named { name: name.into(), path: path.into() };
        assert_eq!(named("theirs=a/b.matrix"), of("theirs", "a/b.matrix"));
        assert_eq!(named("a/b=c.matrix"), of("b=c", "a/b=c.matrix"));
        assert_eq!(named("a/cpca-phase.run.trec"), of("cpca-phase", "a/cpca-phase.run.trec"));
        assert!("=x".parse::<Named>().is_err() && "x=".parse::<Named>().is_err());
    }
}
