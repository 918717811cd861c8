//! Tables in CSV: the curves of all methods, and all queries.

use super::super::measures::NAMES;
use super::super::precision_recall::{INTERPOLATED, PRINCETON};
use super::super::{Evaluation, Summary};
use std::io::Write;

/// Writes `points,recall,<method>,..,chance,ceiling`: micro means at 11 and 20 recall levels; empty where no query counts.
pub fn write_curves(evaluation: &Evaluation, out: &mut dyn Write) -> std::io::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    let summaries = rows(evaluation);
    let names = summaries.iter().map(|(name, _)| (*name).to_owned());
    table.write_record(["points".to_owned(), "recall".to_owned()].into_iter().chain(names))?;
    let mut line = |points: usize, recall: f64, value: &dyn Fn(&Summary) -> Option<f64>| {
        let values = summaries.iter().map(|(_, summary)| value(summary).map_or(String::new(), |v| v.to_string()));
        table.write_record([points.to_string(), recall.to_string()].into_iter().chain(values))
    };
    for level in 0..INTERPOLATED {
        let recall = level as f64 / (INTERPOLATED - 1) as f64;
        line(INTERPOLATED, recall, &|summary| summary.micro_curves.pr11[level])?;
    }
    for level in 0..PRINCETON {
        let recall = (level + 1) as f64 / PRINCETON as f64;
        line(PRINCETON, recall, &|summary| summary.micro_curves.pr20[level])?;
    }
    table.flush()
}

/// The summaries of all methods, then of chance and the ceiling, with their names.
pub fn rows(evaluation: &Evaluation) -> Vec<(&str, &Summary)> {
    let methods = evaluation.methods.iter().map(|method| (method.name.as_str(), &method.summary));
    methods.chain([("chance", &evaluation.chance), ("ceiling", &evaluation.ceiling)]).collect()
}

/// Writes one line for each method and query: its measures, their expected values over random tie breaks
/// (`<measure>_expected`, the same where ties make no difference), its nearest neighbour, and the interpolated precision at
/// recall 0, 0.1 .. 1.
pub fn write_queries(evaluation: &Evaluation, out: &mut dyn Write) -> std::io::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    let names = NAMES.map(|name| if name == "map" { "ap" } else { name });
    let mut header: Vec<_> = ["method", "query", "class"].map(str::to_owned).to_vec();
    header.extend(names.map(str::to_owned));
    header.extend(names.map(|name| format!("{name}_expected")));
    header.extend(["nearest", "nearest_class", "nearest_distance"].map(str::to_owned));
    header.extend((0..INTERPOLATED).map(|level| format!("p({:.1})", level as f64 / (INTERPOLATED - 1) as f64)));
    table.write_record(header)?;
    let gallery = &evaluation.gallery;
    for (method, result) in evaluation.methods.iter().flat_map(|m| m.queries.iter().map(move |query| (m, query))) {
        let mut record =
            vec![method.name.clone(), gallery.ids[result.query].clone(), gallery.class(result.query).name.clone()];
        record.extend(result.scores.values().map(|v| v.to_string()));
        record.extend(result.expected.unwrap_or(result.scores).values().map(|v| v.to_string()));
        let nearest = result
            .hits
            .first()
            .map(|&(hit, distance)| [gallery.ids[hit].clone(), gallery.class(hit).name.clone(), distance.to_string()]);
        record.extend(nearest.unwrap_or_default());
        record.extend(result.curves.pr11.map(|precision| precision.to_string()));
        table.write_record(record)?;
    }
    table.flush()
}

#[cfg(test)]
mod tests {
    use super::super::super::tests::toy;
    use super::*;

    fn text(write: impl Fn(&Evaluation, &mut dyn Write) -> std::io::Result<()>) -> String {
        let mut out = Vec::new();
        write(&toy(), &mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn curves_have_31_levels_with_chance_and_ceiling() {
        let text = text(write_curves);
        assert_eq!(text.lines().count(), 32);
        assert!(text.starts_with("points,recall,good,bad,chance,ceiling\n11,0,1,"), "{text}");
        // classes of three: C = 2, nothing below a recall of 0.5
        assert!(text.contains("\n20,0.45,,,,\n20,0.5,1,"), "{text}");
    }

    #[test]
    fn each_query_of_each_method_has_a_line() {
        let text = text(write_queries);
        assert_eq!(text.lines().count(), 1 + 2 * 6);
        let first = text.lines().nth(1).unwrap();
        assert!(first.starts_with("good,m0000,a,1,1,1,"), "{first}");
        assert!(first.ends_with(&format!(",m0001,a,1{}", ",1".repeat(11))), "{first}");
        assert!(text.lines().next().unwrap().ends_with(
            "nearest_distance,p(0.0),p(0.1),p(0.2),p(0.3),p(0.4),p(0.5),p(0.6),p(0.7),p(0.8),p(0.9),p(1.0)"
        ));
    }
}
