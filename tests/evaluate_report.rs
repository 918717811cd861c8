//! A store in, the files of `eval` and `query` out.

mod synthetic;

use std::path::Path;
use symalign::evaluate::{self, Evaluation, Labels, Options};
use symalign::search::{self, Asked, Name};
use symalign::store::Store;

fn evaluated(dir: &Path, options: &Options) -> (Store, Evaluation) {
    synthetic::store(dir);
    let store = Store::open(dir).unwrap();
    let labels = Labels::load(&dir.join("labels.csv")).unwrap();
    let evaluation = evaluate::evaluate(&store, &labels, options).unwrap();
    (store, evaluation)
}

fn quick() -> Options {
    Options { draws: 2_000, resamples: 500, ..Options::default() }
}

#[test]
fn all_files_are_written_and_what_is_missing_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let (store, evaluation) = evaluated(folder.path(), &quick());
    // a folder to look at: SYMALIGN_REPORT=/tmp/report cargo test --release --test evaluate_report
    let out = std::env::var("SYMALIGN_REPORT").map_or_else(|_| folder.path().join("out"), Into::into);
    evaluate::write(&evaluation, &store, &out).unwrap();
    for name in ["report.html", "metrics.json", "pr.csv", "per_query.csv", "pr.png", "labels.cla", "qrels.trec"] {
        assert!(out.join(name).metadata().unwrap().len() > 100, "{name}");
    }
    for method in ["symmetry", "npca", "symmetry-phase", "npca-phase"] {
        assert_eq!(out.join(format!("{method}.matrix")).metadata().unwrap().len(), 97 * 97 * 4, "{method}");
        let run = std::fs::read_to_string(out.join(format!("{method}.run.trec"))).unwrap();
        assert_eq!(run.lines().count(), 97 * 96, "{method}");
    }
    let metrics: serde_json::Value = serde_json::from_slice(&std::fs::read(out.join("metrics.json")).unwrap()).unwrap();
    assert_eq!((metrics["models"].as_u64(), metrics["queries"].as_u64()), (Some(97), Some(97)));
    assert_eq!(metrics["coverage"]["missing"][0]["path"], "boat/broken.step");
    assert_eq!(metrics["comparisons"].as_array().unwrap().len(), 7, "three frames by two descriptors, and phase");
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("97 of 98 labelled models are in"));
    assert!(!page.contains("<shell>") && page.contains("no &#60;shell&#62;"), "text of files is escaped");
    assert_eq!(page.matches("data:image/png;base64,").count(), 97);
    assert!(!page.contains("http://") || page.matches("http://").count() == page.matches("http://www.w3.org/").count());
}

#[test]
fn matrices_of_other_people_score_as_the_store_they_came_from() {
    let folder = tempfile::tempdir().unwrap();
    let (store, evaluation) = evaluated(folder.path(), &quick());
    let (out, again) = (folder.path().join("out"), folder.path().join("again"));
    evaluate::write(&evaluation, &store, &out).unwrap();
    let matrices = [out.join("symmetry.matrix"), out.join("pca.matrix")];
    let theirs = evaluate::report_matrices(&matrices, &out.join("labels.cla"), &quick(), &again).unwrap();
    for name in ["symmetry", "pca"] {
        let of = |evaluation: &Evaluation| evaluation.methods.iter().find(|m| m.name == name).unwrap().summary.clone();
        // distances are rounded to f32 on the way, which may swap neighbours that are all but tied
        assert!((of(&evaluation).micro.ap - of(&theirs).micro.ap).abs() < 1e-3, "{name}");
    }
    let page = std::fs::read_to_string(again.join("report.html")).unwrap();
    assert!(!page.contains("id=\"gallery\""), "there are no pictures");
}

#[test]
fn methods_are_chosen_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let chosen = |names: &[&str]| Options { methods: names.iter().map(|n| (*n).to_owned()).collect(), ..quick() };
    let (store, evaluation) = evaluated(folder.path(), &chosen(&["cpca", "symmetry:phase"]));
    let names: Vec<_> = evaluation.methods.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["cpca", "symmetry:phase", "cpca:phase"]);
    let labels = Labels::load(&folder.path().join("labels.csv")).unwrap();
    assert!(evaluate::evaluate(&store, &labels, &chosen(&["file"])).is_err(), "not in the store");
    assert!(evaluate::evaluate(&store, &labels, &chosen(&["magic"])).is_err());
}

#[test]
fn a_model_of_the_store_is_its_own_nearest() {
    let folder = tempfile::tempdir().unwrap();
    synthetic::store(folder.path());
    let store = Store::open(folder.path()).unwrap();
    for name in ["symmetry", "npca:phase"] {
        let name: Name = name.parse().unwrap();
        let row = search::Rows::of(&store, name).unwrap().row(5);
        let hits = search::query(&store, row, 4, name).unwrap();
        assert_eq!((hits[0].row, hits[0].distance), (5, 0.0));
        assert!(hits.windows(2).all(|pair| pair[0].distance <= pair[1].distance));
        assert!((hits[1].views.iter().sum::<f64>() - hits[1].distance).abs() < 1e-12);
        let page = folder.path().join("page.html");
        let asked = Asked { model: "<mine>.step", thumbnail: Some(store.thumbnail(5)), method: &name.to_string() };
        search::write_page(&page, &store, &asked, &hits).unwrap();
        let page = std::fs::read_to_string(page).unwrap();
        assert_eq!(page.matches("data:image/png;base64,").count(), 5);
        assert!(!page.contains("<mine>"));
    }
}
