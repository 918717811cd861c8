//! Means over queries (micro) and over classes (macro).

use super::gallery::Gallery;
use super::measures::Scores;
use super::precision_recall::{Curves, MeanCurves};

/// What a ranking of all queries amounts to.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Means over queries.
    pub micro: Scores,
    /// Means over classes of their means.
    pub macros: Scores,
    /// Means over all queries.
    pub micro_curves: MeanCurves,
    /// Means over the classes.
    pub macro_curves: MeanCurves,
    /// The means of each class that is queried, in the gallery's order.
    pub classes: Vec<ClassSummary>,
}

/// The means of one class.
#[derive(Clone, Debug, PartialEq)]
pub struct ClassSummary {
    /// The category.
    pub name: String,
    /// Its number of models.
    pub size: usize,
    /// Means over its queries.
    pub scores: Scores,
    /// The same of the curves.
    pub curves: MeanCurves,
}

impl Summary {
    /// The means of `results` (query, measures, curves), which are in the gallery's order.
    pub fn of<'a>(gallery: &Gallery, results: impl Iterator<Item = (usize, &'a Scores, &'a Curves)>) -> Self {
        let results: Vec<_> = results.collect();
        let class_of = |result: &(usize, &Scores, &Curves)| gallery.class_of[result.0];
        let classes: Vec<_> = results
            .chunk_by(|a, b| class_of(a) == class_of(b))
            .map(|chunk| {
                let class = &gallery.classes[class_of(&chunk[0])];
                let scores = Scores::mean(chunk.iter().map(|r| r.1));
                let curves = MeanCurves::of(chunk.iter().map(|r| r.2));
                ClassSummary { name: class.name.clone(), size: class.size(), scores, curves }
            })
            .collect();
        let curves: Vec<_> = classes.iter().map(|class| class.curves).collect();
        Self {
            micro: Scores::mean(results.iter().map(|r| r.1)),
            macros: Scores::mean(classes.iter().map(|class| &class.scores)),
            micro_curves: MeanCurves::of(results.iter().map(|r| r.2)),
            macro_curves: MeanCurves::of_means(&curves),
            classes,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::gallery::tests::gallery;
    use super::*;

    #[test]
    fn micro_weighs_queries_and_macro_classes() {
        let gallery = gallery(&["a", "a", "b", "b", "b"]);
        // both of a found first, none of b
        let ranks = [vec![1], vec![1], vec![3, 4], vec![3, 4], vec![3, 4]];
        let results: Vec<_> = ranks.iter().map(|r| (Scores::of(r, r.len(), 4), Curves::of(r, r.len()))).collect();
        let summary = Summary::of(&gallery, results.iter().enumerate().map(|(i, (s, c))| (i, s, c)));
        assert_eq!((summary.micro.nn, summary.macros.nn), (0.4, 0.5));
        assert_eq!(summary.classes[1].scores.ft, 0.0);
        assert_eq!(summary.macro_curves.pr11[0], Some(0.75), "1 for a, 2/4 for b");
    }
}
