//! A store in, the files of `eval` and `query` out.

mod synthetic;

use std::path::Path;
use symalign::evaluate::{self, Evaluation, Input, Labels, Named, Options, Summary};
use symalign::search::{self, Asked, Name};
use symalign::store::Store;

/// The synthetic store in `dir`, evaluated into `out`.
fn reported(dir: &Path, out: &Path, options: &Options) -> (Store, Evaluation) {
    synthetic::store(dir);
    let store = Store::open(dir).unwrap();
    let evaluation = evaluate::report(&Input::of_store(&store, labels(dir)), options, out).unwrap();
    (store, evaluation)
}

fn labels(dir: &Path) -> Labels {
    Labels::load(&dir.join("labels.csv")).unwrap()
}

fn summary<'a>(evaluation: &'a Evaluation, name: &str) -> &'a Summary {
    &evaluation.methods.iter().find(|m| m.name == name).unwrap().summary
}

fn quick() -> Options {
    Options { draws: 2_000, resamples: 500, ..Options::default() }
}

#[test]
fn all_files_are_written_and_what_is_missing_is_said() {
    let folder = tempfile::tempdir().unwrap();
    // a folder to look at: SYMALIGN_REPORT=/tmp/report cargo test --release --test evaluate_report
    let out = std::env::var("SYMALIGN_REPORT").map_or_else(|_| folder.path().join("out"), Into::into);
    reported(folder.path(), &out, &quick());
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
fn matrices_and_runs_of_other_people_score_as_the_store_they_came_from() {
    let folder = tempfile::tempdir().unwrap();
    let (out, again) = (folder.path().join("out"), folder.path().join("again"));
    let (_, evaluation) = reported(folder.path(), &out, &quick());
    let file = |name: &str| Named { name: name.replace(".run.trec", ":run"), path: out.join(name) };
    let matrices = vec![Named { name: "symmetry".into(), ..file("symmetry.matrix") }];
    let runs = vec![file("symmetry.run.trec")];
    let labels = Labels::load(&out.join("labels.cla")).unwrap();
    let theirs = evaluate::report(&Input { store: None, labels, matrices, runs }, &quick(), &again).unwrap();
    let ours = summary(&evaluation, "symmetry");
    assert_eq!(summary(&theirs, "symmetry:run"), ours, "ranks lose nothing");
    // distances are rounded to f32 on the way, which may swap neighbours that are all but tied
    assert!((summary(&theirs, "symmetry").micro.ap - ours.micro.ap).abs() < 1e-3);
    let page = std::fs::read_to_string(again.join("report.html")).unwrap();
    assert!(!page.contains("id=\"gallery\""), "there are no pictures");
    let same =
        |name: &str| assert_eq!(std::fs::read(out.join(name)).unwrap(), std::fs::read(again.join(name)).unwrap());
    same("symmetry.matrix");
    same("labels.cla");
}

#[test]
fn a_peer_s_matrix_stands_beside_the_store_s_methods_on_the_models_of_both() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let (store, _) = reported(folder.path(), &out, &quick());
    // the peer's labels have one model more than the store, first, at distance 0 from all
    let cla = "PSB 1\n3 98\nextra 0 1\nnew\n".to_owned();
    let rest = std::fs::read_to_string(out.join("labels.cla")).unwrap();
    let classes = rest.split_once("\n\n").unwrap().1;
    std::fs::write(folder.path().join("peer.cla"), cla.replace("3 98", "10 98") + classes).unwrap();
    let matrix = std::fs::read(out.join("npca.matrix")).unwrap();
    let mut wider = vec![0; 4 * 98];
    matrix.chunks(4 * 97).for_each(|row| wider.extend([&[0; 4], row].concat()));
    std::fs::write(folder.path().join("peer.matrix"), wider).unwrap();
    let labels = Labels::load(&folder.path().join("peer.cla")).unwrap();
    let matrices = vec![folder.path().join("peer.matrix").to_str().unwrap().parse().unwrap()];
    let input = Input { matrices, ..Input::of_store(&store, labels) };
    let evaluation = evaluate::evaluate(&input, &quick()).unwrap();
    let (peer, own) = (summary(&evaluation, "peer"), summary(&evaluation, "npca"));
    assert!((peer.micro.ap - own.micro.ap).abs() < 1e-3);
    assert_eq!(evaluation.coverage.missing[0].path, "new");
    assert!(evaluation.coverage.files[0].contains("97 of its 98 models"), "{:?}", evaluation.coverage.files);
    assert!(evaluation.comparisons.iter().any(|c| (c.a.as_str(), c.b.as_str()) == ("symmetry", "peer")));
}

#[test]
fn judgements_stand_for_labels() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let (_, evaluation) = reported(folder.path(), &out, &quick());
    let runs: Vec<Named> = vec![out.join("npca-phase.run.trec").to_str().unwrap().parse().unwrap()];
    let labels = evaluate::judgements(&out.join("qrels.trec"), &runs).unwrap();
    let input = Input { store: None, labels, matrices: Vec::new(), runs };
    let theirs = evaluate::evaluate(&input, &quick()).unwrap();
    let (theirs, ours) = (summary(&theirs, "npca-phase"), summary(&evaluation, "npca:phase"));
    assert_eq!((theirs.micro, theirs.micro_curves), (ours.micro, ours.micro_curves));
}

#[test]
fn methods_are_chosen_by_name() {
    let folder = tempfile::tempdir().unwrap();
    synthetic::store(folder.path());
    let store = Store::open(folder.path()).unwrap();
    let evaluated = |names: &[&str]| {
        let options = Options { methods: names.iter().map(|n| (*n).to_owned()).collect(), ..quick() };
        evaluate::evaluate(&Input::of_store(&store, labels(folder.path())), &options)
    };
    let names = |evaluation: Evaluation| evaluation.methods.into_iter().map(|m| m.name).collect::<Vec<_>>();
    assert_eq!(names(evaluated(&["cpca", "symmetry:phase"]).unwrap()), ["cpca", "symmetry:phase", "cpca:phase"]);
    assert_eq!(names(evaluated(&["pca:swapped"]).unwrap()), ["pca:swapped"]);
    assert!(evaluated(&["file"]).is_err(), "not in the store");
    assert!(evaluated(&["magic"]).is_err());
}

/// The peak of this process's memory in bytes, where the system tells it.
fn peak() -> Option<usize> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(1024 * line.trim().trim_end_matches(" kB").parse::<usize>().ok()?)
}

#[test]
#[ignore = "minutes, and gigabytes of matrix: SYMALIGN_MODELS=20000 cargo test --release --test evaluate_report -- --ignored --nocapture"]
fn thousands_of_models_fit_into_memory_and_the_page() {
    let models: usize = std::env::var("SYMALIGN_MODELS").map_or(20_000, |n| n.parse().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let classes: Vec<_> = (0..models / 10).map(|i| (format!("class-{i:04}"), 10)).collect();
    synthetic::of(folder.path(), &classes);
    let store = Store::open(folder.path()).unwrap();
    let out = folder.path().join("out");
    let options = Options { methods: vec!["symmetry:swapped".into()], ..quick() };
    let (before, start) = (peak(), std::time::Instant::now());
    let evaluation = evaluate::report(&Input::of_store(&store, labels(folder.path())), &options, &out).unwrap();
    let size = |name: &str| out.join(name).metadata().unwrap().len() as usize;
    let (matrix, page) = (size("symmetry-swapped.matrix"), size("report.html"));
    println!("{models} models: {:.0?}, mAP {}", start.elapsed(), evaluation.methods[0].summary.micro.ap);
    println!(
        "matrix {matrix}, run {}, page {page}, peak {before:?} -> {:?}",
        size("symmetry-swapped.run.trec"),
        peak()
    );
    assert_eq!(matrix, 4 * models * models);
    assert!(page < 6_000_000);
    assert!(peak().is_none_or(|peak| peak < matrix / 2 + 500_000_000), "far less than the matrix");
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
        let asked =
            Asked { model: "<mine>.step", thumbnail: Some(store.thumbnail(5).unwrap()), method: &name.to_string() };
        search::write_page(&page, &store, &asked, &hits).unwrap();
        let page = std::fs::read_to_string(page).unwrap();
        assert_eq!(page.matches("data:image/png;base64,").count(), 5);
        assert!(!page.contains("<mine>"));
    }
}
