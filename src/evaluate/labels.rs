//! Which category each model belongs to.

use super::formats::cla;
use crate::error::{Result, RunError};
use std::collections::BTreeMap;
use std::path::Path;

/// Categories by the paths of models, or by the folders they lie in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Labels {
    /// (path, category), in the order of the file.
    Table(Vec<(String, String)>),
    /// The name of a model's parent folder is its category.
    ParentFolder,
}

/// A label whose model is not there.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Missing {
    /// The id of the model.
    pub path: String,
    /// Its class.
    pub category: String,
    /// Why the model failed; `None` where nothing is known of it.
    pub why: Option<String>,
}

/// Labels brought together with the models that there are.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Assignment {
    /// The category of each id, in their order.
    pub category_of: Vec<Option<String>>,
    /// The place of each id's label in their table; `None` too where its folder is the label.
    pub label_of: Vec<Option<usize>>,
    /// Labels that no id has.
    pub missing: Vec<Missing>,
}

impl Assignment {
    /// Models that are those of the labels, in their order.
    pub fn whole(pairs: &[(String, String)]) -> Self {
        let category_of = pairs.iter().map(|(_, category)| Some(category.clone())).collect();
        Self { category_of, label_of: (0..pairs.len()).map(Some).collect(), missing: Vec::new() }
    }

    /// The number of models with a category.
    pub fn labelled(&self) -> usize {
        self.category_of.iter().flatten().count()
    }
}

impl Labels {
    /// Reads a CSV file with the columns `path` and `category` (others are ignored) or a Princeton `.cla` file;
    /// the name `parent-folder` is [`Labels::ParentFolder`].
    ///
    /// # Errors
    /// A file that cannot be read, lacks a column, or gives one path two categories.
    pub fn load(path: &Path) -> Result<Self> {
        if path.as_os_str() == "parent-folder" {
            return Ok(Self::ParentFolder);
        }
        let text = std::fs::read_to_string(path).map_err(|source| RunError::file(path, source))?;
        let classification = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("cla"));
        let pairs = if classification { cla::read(&text) } else { read_csv(&text) };
        pairs.and_then(Self::table).map_err(|why| RunError::Usage(format!("labels {}: {why}", path.display())))
    }

    /// The (path, category) pairs; none for parent folders.
    pub fn pairs(&self) -> &[(String, String)] {
        match self {
            Self::Table(pairs) => pairs,
            Self::ParentFolder => &[],
        }
    }

    /// Labels from (path, category) pairs.
    ///
    /// # Errors
    /// An empty path or category; a path with two categories.
    pub fn table(pairs: Vec<(String, String)>) -> std::result::Result<Self, String> {
        let mut seen = BTreeMap::new();
        for (path, category) in &pairs {
            if path.is_empty() || category.is_empty() {
                return Err(format!("the path {path:?} has the category {category:?}"));
            }
            match seen.insert(path, category) {
                Some(other) if other != category => {
                    return Err(format!("{path} is both {other} and {category}"));
                }
                _ => {}
            }
        }
        Ok(Self::Table(pairs))
    }

    /// Gives each of `ids` its category. `failures` are (id, reason) of models that could not be described.
    ///
    /// A label belongs to an id that is its path, or ends with it after a `/` or `!`, or of which it ends with the
    /// whole, so that labels work whether an archive was given by itself or inside a folder; where nothing else
    /// fits, the file's extension may be left out.
    pub fn assign(&self, ids: &[&str], failures: &[(&str, String)]) -> Assignment {
        match self {
            Self::ParentFolder => {
                let failed = failures.iter().filter_map(|(id, why)| {
                    let (path, category) = ((*id).to_owned(), parent_folder(id)?);
                    Some(Missing { path, category, why: Some(why.clone()) })
                });
                let category_of = ids.iter().map(|id| parent_folder(id)).collect();
                Assignment { category_of, label_of: vec![None; ids.len()], missing: failed.collect() }
            }
            Self::Table(pairs) => assign_table(pairs, ids, failures),
        }
    }
}

fn assign_table(pairs: &[(String, String)], ids: &[&str], failures: &[(&str, String)]) -> Assignment {
    let index = Index::new(pairs);
    let mut reason: Vec<Option<Option<&str>>> = vec![Some(None); pairs.len()];
    for (id, why) in failures {
        index.find(id).into_iter().for_each(|label| reason[label] = Some(Some(why)));
    }
    let label_of: Vec<_> = ids.iter().map(|id| index.find(id)).collect();
    label_of.iter().flatten().for_each(|&label| reason[label] = None);
    let category_of = label_of.iter().map(|label| label.map(|label| pairs[label].1.clone())).collect();
    let lost = pairs.iter().zip(reason).filter_map(|((path, category), reason)| {
        let why = reason?.map(str::to_owned);
        Some(Missing { path: path.clone(), category: category.clone(), why })
    });
    Assignment { category_of, label_of, missing: lost.collect() }
}

/// Labels by path, and by all ends of their paths that are unambiguous.
struct Index {
    whole: BTreeMap<String, usize>,
    ends: BTreeMap<String, Option<usize>>,
}

impl Index {
    fn new(pairs: &[(String, String)]) -> Self {
        let mut index = Self { whole: BTreeMap::new(), ends: BTreeMap::new() };
        for (label, (path, _)) in pairs.iter().enumerate() {
            let path = normal(path);
            for end in ends(&path).skip(1) {
                let entry = index.ends.entry(end.to_owned()).or_insert(Some(label));
                *entry = entry.filter(|other| *other == label);
            }
            index.whole.entry(path).or_insert(label);
        }
        index
    }

    /// The label of `id`, the longest fit first.
    fn find(&self, id: &str) -> Option<usize> {
        let id = normal(id);
        let stem = id.rsplit_once('.').map(|(stem, _)| stem).filter(|stem| !stem.ends_with('/'));
        let fit = |id: &str| ends(id).find_map(|end| self.whole.get(end).copied());
        let inside = |id: &str| self.ends.get(id).copied().flatten();
        fit(&id).or_else(|| inside(&id)).or_else(|| stem.and_then(fit))
    }
}

/// The path with `/` between folders, archives and members, without a leading `./`.
fn normal(path: &str) -> String {
    let path = path.replace(['\\', '!'], "/");
    path.trim_start_matches("./").to_owned()
}

/// The path, then without its first folder, and so on.
fn ends(path: &str) -> impl Iterator<Item = &str> {
    std::iter::once(path).chain(path.match_indices('/').map(|(at, _)| &path[at + 1..]))
}

fn parent_folder(id: &str) -> Option<String> {
    let path = normal(id);
    let parent = path.rsplit('/').nth(1)?;
    (!parent.is_empty()).then(|| parent.to_owned())
}

fn read_csv(text: &str) -> std::result::Result<Vec<(String, String)>, String> {
    let text = text.trim_start_matches('\u{feff}');
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
    let header = reader.headers().map_err(|error| error.to_string())?.clone();
    let column = |name: &str| {
        let found = header.iter().position(|field| field.eq_ignore_ascii_case(name));
        found.ok_or(format!("no column `{name}`; the first line must name the columns path,category"))
    };
    let (path, category) = (column("path")?, column("category")?);
    let pair = |record: std::result::Result<csv::StringRecord, csv::Error>| {
        let record = record.map_err(|error| error.to_string())?;
        Ok((record[path].to_owned(), record[category].to_owned()))
    };
    reader.records().map(pair).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(pairs: &[(&str, &str)]) -> Labels {
        Labels::table(pairs.iter().map(|(a, b)| ((*a).into(), (*b).into())).collect()).unwrap()
    }

    fn categories(labels: &Labels, ids: &[&str]) -> Vec<Option<String>> {
        labels.assign(ids, &[]).category_of
    }

    #[test]
    fn a_csv_may_have_more_columns_in_any_order() {
        let text = "category,unit,Path\nbolt,mm,\"a, b.step\"\n";
        assert_eq!(read_csv(text).unwrap(), [("a, b.step".into(), "bolt".into())]);
        assert!(read_csv("file,category\nx,y\n").unwrap_err().contains("`path`"));
        assert!(read_csv("path,category\nx\n").is_err());
    }

    #[test]
    fn contradictions_and_blanks_are_refused() {
        let pair = |a: &str, b: &str| (a.to_owned(), b.to_owned());
        assert!(Labels::table(vec![pair("a", "x"), pair("a", "y")]).is_err());
        assert!(Labels::table(vec![pair("a", "x"), pair("a", "x")]).is_ok());
        assert!(Labels::table(vec![pair("a", "")]).is_err());
    }

    #[test]
    fn labels_fit_members_of_archives_and_longer_or_shorter_paths() {
        let labels = labels(&[("nut/a.step", "nut"), ("bolt/a.step", "bolt")]);
        let ids = ["parts.zip!nut/a.step", "x/bolt/a.step", "nut\\a.step", "./bolt/a.step", "a.step", "gear/a.step"];
        let expected = [Some("nut"), Some("bolt"), Some("nut"), Some("bolt"), None, None];
        assert_eq!(categories(&labels, &ids), expected.map(|c| c.map(str::to_owned)));
    }

    #[test]
    fn an_unambiguous_end_of_a_label_is_enough() {
        let labels = labels(&[("models/nut/a.step", "nut"), ("models/nut/b.step", "nut")]);
        assert_eq!(categories(&labels, &["nut/a.step", "b.step"]), [Some("nut".into()), Some("nut".into())]);
    }

    #[test]
    fn classifications_may_leave_the_extension_out() {
        let labels = labels(&[("101", "plane"), ("102.stp", "car")]);
        let ids = ["db/101.step", "db/102.stp", "db/102.step"];
        assert_eq!(categories(&labels, &ids), [Some("plane".into()), Some("car".into()), None]);
    }

    #[test]
    fn missing_models_are_named_with_the_reason() {
        let labels = labels(&[("a.step", "x"), ("b.step", "x"), ("c.step", "y")]);
        let assignment = labels.assign(&["a.step"], &[("b.step", "parse: no shells".into())]);
        let why: Vec<_> = assignment.missing.iter().map(|m| (m.path.as_str(), m.why.as_deref())).collect();
        assert_eq!(why, [("b.step", Some("parse: no shells")), ("c.step", None)]);
        assert_eq!(assignment.labelled(), 1);
    }

    #[test]
    fn the_parent_folder_is_a_category() {
        let ids = ["kit/nut/a.step", "kit.zip!b.step", "c.step"];
        assert_eq!(categories(&Labels::ParentFolder, &ids), [Some("nut".into()), Some("kit.zip".into()), None]);
        let failed = Labels::ParentFolder.assign(&[], &[("nut/a.step", "why".into()), ("b.step", "why".into())]);
        assert_eq!(failed.missing.len(), 1);
    }
}
