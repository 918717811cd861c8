//! The models that are ranked, and which of them are relevant to which.

use super::labels::Assignment;
use crate::error::{Result, RunError};

/// The name that Princeton classifications give to models that belong to no class.
pub const MISCELLANEOUS: &str = "-1";

/// A category with its models.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Class {
    /// Its category.
    pub name: String,
    /// Its models: a range of the gallery.
    pub members: std::ops::Range<usize>,
    /// Whether its models are queries; the others stay in the gallery as distractors.
    pub queried: bool,
}

impl Class {
    /// The number of models, n.
    pub fn size(&self) -> usize {
        self.members.len()
    }

    /// Models relevant to each query of the class, C = n - 1.
    pub fn relevant(&self) -> usize {
        self.size().saturating_sub(1)
    }
}

/// All labelled models, class by class (names in byte order), the ids of a class in byte order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Gallery {
    /// The models, by id.
    pub ids: Vec<String>,
    /// The classes, in the order of their models.
    pub classes: Vec<Class>,
    /// The class of each model.
    pub class_of: Vec<usize>,
    /// The row of each model in the store or matrix it came from.
    pub rows: Vec<usize>,
    /// Place of each id among all ids in byte order: what breaks ties.
    pub id_order: Vec<u32>,
}

impl Gallery {
    /// The labelled models of `ids`. Classes of one model are never queried, nor are those of two with `compat_psb`.
    pub fn new(ids: &[&str], assignment: &Assignment, compat_psb: bool) -> Self {
        let labelled = |row: usize| assignment.category_of[row].as_deref().map(|category| (category, ids[row], row));
        let mut models: Vec<_> = (0..ids.len()).filter_map(labelled).collect();
        models.sort_unstable();
        let mut gallery = Self { id_order: id_order(&models), ..Self::default() };
        for class in models.chunk_by(|a, b| a.0 == b.0) {
            gallery.push_class(class, if compat_psb { 3 } else { 2 });
        }
        gallery
    }

    fn push_class(&mut self, models: &[(&str, &str, usize)], least: usize) {
        let start = self.ids.len();
        let name = models[0].0.to_owned();
        self.ids.extend(models.iter().map(|m| m.1.to_owned()));
        self.rows.extend(models.iter().map(|m| m.2));
        self.class_of.extend(models.iter().map(|_| self.classes.len()));
        let queried = models.len() >= least && name != MISCELLANEOUS;
        self.classes.push(Class { name, members: start..self.ids.len(), queried });
    }

    /// The number of models, N.
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// True without a labelled model.
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    /// The class of model `i`.
    pub fn class(&self, i: usize) -> &Class {
        &self.classes[self.class_of[i]]
    }

    /// The models that are queries, in order.
    pub fn queries(&self) -> Vec<usize> {
        (0..self.len()).filter(|&i| self.class(i).queried).collect()
    }

    /// The classes whose models are queries.
    pub fn queried(&self) -> impl Iterator<Item = &Class> {
        self.classes.iter().filter(|class| class.queried)
    }

    /// Models that are in the gallery but never queries: singletons and miscellaneous ones.
    pub fn distractors(&self) -> usize {
        self.classes.iter().filter(|class| !class.queried).map(Class::size).sum()
    }

    /// An error where nothing can be evaluated.
    pub fn require_queries(&self) -> Result<()> {
        if self.queried().next().is_some() {
            return Ok(());
        }
        let (models, classes) = (self.len(), self.classes.len());
        let why = format!("nothing to evaluate: {models} labelled models in {classes} classes, none with two or more");
        Err(RunError::Usage(why))
    }
}

fn id_order(models: &[(&str, &str, usize)]) -> Vec<u32> {
    let mut by_id: Vec<_> = (0..models.len()).collect();
    by_id.sort_unstable_by_key(|&i| (models[i].1, i));
    let mut order = vec![0; models.len()];
    for (place, &i) in by_id.iter().enumerate() {
        order[i] = place as u32;
    }
    order
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    fn assignment(categories: &[&str]) -> Assignment {
        let pairs: Vec<_> = categories.iter().map(|category| (String::new(), (*category).to_owned())).collect();
        Assignment::whole(&pairs)
    }

    /// A gallery whose model i is called `mi` and belongs to `categories[i]`; give categories in order.
    pub(crate) fn gallery(categories: &[&str]) -> Gallery {
        let ids: Vec<_> = (0..categories.len()).map(|i| format!("m{i:04}")).collect();
        let ids: Vec<_> = ids.iter().map(String::as_str).collect();
        Gallery::new(&ids, &assignment(categories), false)
    }

    #[test]
    fn models_come_class_by_class_and_ties_go_by_id() {
        let gallery = Gallery::new(&["z", "b", "a", "y"], &assignment(&["one", "two", "two", "one"]), false);
        assert_eq!(gallery.ids, ["y", "z", "a", "b"]);
        assert_eq!(gallery.rows, [3, 0, 2, 1]);
        assert_eq!(gallery.id_order, [2, 3, 0, 1]);
        assert_eq!(gallery.classes[1].members, 2..4);
    }

    #[test]
    fn singletons_and_miscellaneous_models_only_distract() {
        let gallery = gallery(&["-1", "-1", "-1", "pair", "pair", "single"]);
        assert_eq!(gallery.queries(), [3, 4]);
        assert_eq!(gallery.distractors(), 4);
    }

    #[test]
    fn princeton_compatibility_drops_pairs() {
        let assignment = assignment(&["pair", "pair", "three", "three", "three"]);
        let gallery = Gallery::new(&["a", "b", "c", "d", "e"], &assignment, true);
        assert_eq!(gallery.queries(), [2, 3, 4]);
    }

    #[test]
    fn nothing_to_query_is_an_error() {
        assert!(gallery(&["a", "b", "c"]).require_queries().is_err());
        assert!(gallery(&["a", "a"]).require_queries().is_ok());
    }
}
