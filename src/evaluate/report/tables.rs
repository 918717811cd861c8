//! The tables, bars and confusions of the report.

use super::super::formats::{metrics, table};
use super::super::measures::{NAMES, Scores};
use super::super::{Evaluation, MethodResult};

/// Classes up to which a confusion is shown as a whole.
const WHOLE: usize = 40;
/// Classes with bars: the largest.
const BARS: usize = 120;
/// Confused pairs of classes listed.
const LISTED: usize = 12;

/// A row of numbers with the text to print and the full value to sort by.
pub struct Row<'a> {
    pub name: &'a str,
    /// mAP, which sums a ranking up best, then the others.
    pub cells: Vec<Cell>,
    /// Chance and ceiling, which are not methods.
    pub bound: bool,
}

/// A number in a table.
pub struct Cell {
    pub value: f64,
    pub text: String,
    /// The best of its column.
    pub best: bool,
}

/// A table of measures.
pub struct Measures<'a> {
    pub title: &'static str,
    pub note: String,
    pub rows: Vec<Row<'a>>,
}

/// The micro and the macro table, and where ties make a difference that of expected values.
pub fn measures(evaluation: &Evaluation) -> Vec<Measures<'_>> {
    let rows = |scores: &dyn Fn(&super::super::Summary) -> Scores| {
        let rows = table::rows(evaluation).into_iter().map(|(name, summary)| (name, scores(summary))).collect();
        marked(rows, evaluation.methods.len())
    };
    let mut tables = vec![
        Measures { title: "Mean over queries", note: "micro".into(), rows: rows(&|summary| summary.micro) },
        Measures { title: "Mean over classes", note: "macro".into(), rows: rows(&|summary| summary.macros) },
    ];
    let tied = |method: &MethodResult| method.queries.iter().filter(|query| query.expected.is_some()).count();
    let most = evaluation.methods.iter().map(tied).max().unwrap_or(0);
    if most > 0 {
        let expected = |method: &'_ MethodResult| metrics::expected(evaluation, method).micro;
        let mut rows: Vec<_> = evaluation.methods.iter().map(|m| (m.name.as_str(), expected(m))).collect();
        rows.extend([("chance", evaluation.chance.micro), ("ceiling", evaluation.ceiling.micro)]);
        let note = format!("micro, equally distant models in random order: that matters for up to {most} queries");
        tables.push(Measures { title: "Expected over ties", note, rows: marked(rows, evaluation.methods.len()) });
    }
    tables
}

/// The measures in the order of the table.
fn ordered(scores: &Scores) -> [f64; NAMES.len()] {
    let mut values = scores.values();
    values.rotate_right(1);
    values
}

/// Rows with the best of the first `methods` in each column marked.
fn marked(rows: Vec<(&str, Scores)>, methods: usize) -> Vec<Row<'_>> {
    let best: [f64; NAMES.len()] =
        std::array::from_fn(|i| rows[..methods].iter().map(|(_, s)| ordered(s)[i]).fold(0.0, f64::max));
    let row = |(at, (name, scores)): (usize, (_, Scores))| {
        let bound = at >= methods;
        let cell =
            |(value, best): (f64, f64)| Cell { value, text: format!("{value:.3}"), best: !bound && value == best };
        Row { name, cells: ordered(&scores).into_iter().zip(best).map(cell).collect(), bound }
    };
    rows.into_iter().enumerate().map(row).collect()
}

/// The average precision of a class by each method, in per cent.
pub struct Bars<'a> {
    pub class: &'a str,
    pub size: usize,
    pub chance: f64,
    pub values: Vec<f64>,
}

/// The bars of the classes that are queried; of the largest, where there are more than [`BARS`].
pub fn bars(evaluation: &Evaluation) -> Vec<Bars<'_>> {
    let bar = |(i, chance): (usize, &'_ super::super::summary::ClassSummary)| {
        let class = &evaluation.ceiling.classes[i];
        let value = |method: &MethodResult| 100.0 * method.summary.classes[i].scores.ap;
        let values = evaluation.methods.iter().map(value).collect();
        Bars { class: &class.name, size: class.size, chance: 100.0 * chance.scores.ap, values }
    };
    let mut bars: Vec<_> = evaluation.chance.classes.iter().enumerate().map(bar).collect();
    bars.sort_by_key(|bar| std::cmp::Reverse(bar.size));
    bars.truncate(BARS);
    bars.sort_by_key(|bar| bar.class);
    bars
}

/// How often a query of one class has its nearest neighbour in another.
pub struct Confusion<'a> {
    pub method: &'a str,
    /// Names of the columns: classes with a nearest neighbour; empty where there are too many classes.
    pub columns: Vec<&'a str>,
    pub rows: Vec<(&'a str, Vec<Count>)>,
    /// The pairs confused most often: query class, class found, queries.
    pub worst: Vec<(&'a str, &'a str, usize)>,
}

/// The queries of a class whose nearest neighbour is of another (or the same) class.
pub struct Count {
    pub count: usize,
    /// Share of the class's queries in per cent.
    pub share: f64,
    /// Whether both classes are one.
    pub same: bool,
}

/// The confusion of each method.
pub fn confusions(evaluation: &Evaluation) -> Vec<Confusion<'_>> {
    evaluation.methods.iter().map(|method| confusion(evaluation, method)).collect()
}

fn confusion<'a>(evaluation: &'a Evaluation, method: &'a MethodResult) -> Confusion<'a> {
    let gallery = &evaluation.gallery;
    let (n, name) = (gallery.classes.len(), |class: usize| gallery.classes[class].name.as_str());
    let mut counts = vec![vec![0; n]; n];
    for query in &method.queries {
        query.hits.first().iter().for_each(|hit| counts[gallery.class_of[query.query]][gallery.class_of[hit.0]] += 1);
    }
    let queried = |class: &usize| gallery.classes[*class].queried;
    let pairs = (0..n).flat_map(|a| (0..n).map(move |b| (a, b))).filter(|(a, b)| a != b);
    let mut worst: Vec<_> = pairs.map(|(a, b)| (name(a), name(b), counts[a][b])).filter(|pair| pair.2 > 0).collect();
    worst.sort_by_key(|pair| std::cmp::Reverse(pair.2));
    worst.truncate(LISTED);
    let columns: Vec<_> = (0..n).filter(|c| queried(c) || counts.iter().any(|row| row[*c] > 0)).collect();
    let shown = if columns.len() <= WHOLE { columns } else { Vec::new() };
    let row = |class: usize| {
        let size = gallery.classes[class].size() as f64;
        let cell = |&found: &usize| {
            let count = counts[class][found];
            Count { count, share: 100.0 * count as f64 / size, same: class == found }
        };
        (name(class), shown.iter().map(cell).collect())
    };
    let rows = (0..n).filter(queried).filter(|_| !shown.is_empty()).map(row).collect();
    Confusion { method: &method.name, columns: shown.iter().map(|&c| name(c)).collect(), rows, worst }
}

#[cfg(test)]
mod tests {
    use super::super::super::tests::toy;
    use super::*;

    #[test]
    fn tables_end_with_chance_and_ceiling_and_mark_the_best_method() {
        let toy = toy();
        let tables = measures(&toy);
        let micro = &tables[0];
        let names: Vec<_> = micro.rows.iter().map(|row| (row.name, row.bound)).collect();
        assert_eq!(names, [("good", false), ("bad", false), ("chance", true), ("ceiling", true)]);
        assert!(micro.rows[0].cells[0].best && !micro.rows[1].cells[0].best && !micro.rows[3].cells[0].best);
    }

    #[test]
    fn confusion_counts_the_classes_of_nearest_neighbours() {
        let toy = toy();
        let [good, bad] = &confusions(&toy)[..] else { panic!("two methods") };
        let counts = |c: &Confusion| c.rows.iter().flat_map(|r| r.1.iter().map(|c| c.count)).collect::<Vec<_>>();
        assert_eq!(counts(good), [3, 0, 0, 3]);
        assert!(good.worst.is_empty());
        assert_eq!(counts(bad), [0, 3, 3, 0]);
        assert_eq!(bad.worst, [("a", "b", 3), ("b", "a", 3)]);
    }

    #[test]
    fn bars_are_in_per_cent() {
        let toy = toy();
        let bars = bars(&toy);
        assert_eq!((bars[0].class, bars[0].size, bars[0].values[0]), ("a", 3, 100.0));
    }
}
