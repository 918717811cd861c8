//! `metrics.json`: everything a script would want of an evaluation.

use super::super::measures::Scores;
use super::super::{Evaluation, MethodResult, Summary};
use serde_json::{Map, Value, json};

/// The evaluation as told in the program's interface; numbers in full precision.
pub fn of(evaluation: &Evaluation) -> Value {
    let gallery = &evaluation.gallery;
    let methods: Map<_, _> = evaluation.methods.iter().map(|m| (m.name.clone(), method(evaluation, m))).collect();
    json!({
        "models": gallery.len(),
        "queries": gallery.queries().len(),
        "classes": gallery.classes.len(),
        "distractors": gallery.distractors(),
        "methods": methods,
        "chance": summary(&evaluation.chance),
        "ceiling": summary(&evaluation.ceiling),
        "comparisons": evaluation.comparisons,
        "coverage": evaluation.coverage,
        "options": evaluation.options,
    })
}

fn method(evaluation: &Evaluation, method: &MethodResult) -> Value {
    let mut value = summary(&method.summary);
    let tied = method.queries.iter().filter(|query| query.expected.is_some()).count();
    value["tied_queries"] = tied.into();
    if tied > 0 {
        let expected = expected(evaluation, method);
        value["expected_over_ties"] = json!({ "micro": expected.micro, "macro": expected.macros });
    }
    value
}

/// The means with the expected values of tied queries.
pub fn expected(evaluation: &Evaluation, method: &MethodResult) -> Summary {
    let scores: Vec<Scores> = method.queries.iter().map(|query| query.expected.unwrap_or(query.scores)).collect();
    let queries = method.queries.iter().zip(&scores).map(|(query, scores)| (query.query, scores, &query.curves));
    Summary::of(&evaluation.gallery, queries)
}

fn summary(summary: &Summary) -> Value {
    let classes: Map<_, _> = summary
        .classes
        .iter()
        .map(|class| {
            let mut value = json!(class.scores);
            value["n"] = class.size.into();
            (class.name.clone(), value)
        })
        .collect();
    json!({
        "micro": summary.micro,
        "macro": summary.macros,
        "pr11": summary.micro_curves.pr11,
        "pr20": summary.micro_curves.pr20,
        "pr11_macro": summary.macro_curves.pr11,
        "pr20_macro": summary.macro_curves.pr20,
        "classes": classes,
    })
}

#[cfg(test)]
mod tests {
    use super::super::super::tests::toy;
    use super::*;

    #[test]
    fn the_fields_are_those_of_the_interface() {
        let value = of(&toy());
        assert_eq!((&value["models"], &value["queries"]), (&json!(6), &json!(6)));
        for summary in [&value["methods"]["good"], &value["chance"], &value["ceiling"]] {
            for mean in ["micro", "macro"] {
                for measure in ["nn", "ft", "st", "e", "dcg", "map"] {
                    assert!(summary[mean][measure].is_f64(), "{mean} {measure}");
                }
            }
            assert_eq!(summary["pr11"].as_array().unwrap().len(), 11);
            assert_eq!(summary["pr20"].as_array().unwrap().len(), 20);
            assert_eq!(summary["classes"]["a"]["n"], 3);
        }
        assert_eq!(value["methods"]["good"]["micro"]["map"], 1.0);
        let comparison = &value["comparisons"][0];
        for field in ["a", "b", "measure", "mean_difference", "ci95", "p_query", "p_class", "p_holm"] {
            assert!(!comparison[field].is_null(), "{field}");
        }
    }
}
