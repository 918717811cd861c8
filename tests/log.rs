//! `run --log`: each line is JSON, the lines' counts are the summary's, and a log that cannot be written costs nothing.

mod common;

use std::path::Path;

use common::{archive, code, published, run, stderr};
use serde_json::Value;

/// The events of a log, in order.
fn events(path: &Path) -> Vec<Value> {
    let text = std::fs::read_to_string(path).unwrap();
    text.lines().map(|line| serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}: {line}"))).collect()
}

fn of<'a>(events: &'a [Value], kind: &str) -> Vec<&'a Value> {
    events.iter().filter(|event| event["event"] == kind).collect()
}

#[test]
fn a_log_tells_the_settings_each_model_and_the_summary() {
    let dir = tempfile::tempdir().unwrap();
    archive(dir.path());
    let output = run(dir.path(), &["run", "models", "--log", "log.jsonl"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let events = events(&dir.path().join("log.jsonl"));
    let (start, end) = (&events[0], events.last().unwrap());
    assert_eq!((&start["event"], &end["event"]), (&"run_start".into(), &"run_end".into()));
    assert!(start["settings"].as_str().unwrap().contains("[validate]"), "{start}");

    let models = of(&events, "model");
    let count = |outcome: &str| models.iter().filter(|model| model["outcome"] == outcome).count() as u64;
    assert_eq!((count("done"), count("failed")), (6, 1));
    assert_eq!((end["done"].as_u64(), end["failed"].as_u64()), (Some(6), Some(1)));
    let committed: u64 = of(&events, "commit").iter().map(|commit| commit["outcomes"].as_u64().unwrap()).sum();
    assert_eq!((end["computed"].as_u64(), committed), (Some(7), 7));
    assert!(stderr(&output).contains(end["summary"].as_str().unwrap()), "the summary that was shown");

    let spent: f64 = models.iter().map(|model| model["seconds.descriptor"].as_f64().unwrap()).sum();
    assert!((spent - end["seconds.descriptor"].as_f64().unwrap()).abs() < 1e-9);
    let lost = models.iter().find(|model| model["outcome"] == "failed").unwrap();
    assert_eq!((&lost["model"], &lost["stage"]), (&"broken.step".into(), &"parse".into()));
    assert!(lost["reason"].is_string() && lost["hash"].as_str().unwrap().len() == 64, "{lost}");
}

#[test]
fn a_second_run_appends_to_the_log_and_computes_nothing() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::create_dir(dir.path().join("in")).unwrap();
    std::fs::write(dir.path().join("in/broken.stp"), "no model").unwrap();
    for _ in 0..2 {
        assert_eq!(code(&run(dir.path(), &["run", "in", "--log", "log.jsonl"])), 0);
    }
    let events = events(&dir.path().join("log.jsonl"));
    assert_eq!((of(&events, "run_start").len(), of(&events, "model").len()), (2, 1));
    let ends = of(&events, "run_end");
    assert_eq!((&ends[1]["computed"], &ends[1]["failed"]), (&0.into(), &1.into()));
}

#[test]
fn a_full_disk_ends_the_log_and_not_the_run() {
    let dir = tempfile::tempdir().unwrap();
    if !Path::new("/dev/full").exists() {
        eprintln!("skipped: no /dev/full");
        return;
    }
    archive(dir.path());
    let output = run(dir.path(), &["run", "models/machinery", "--log", "/dev/full"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert_eq!(stderr(&output).matches("the log ends here").count(), 1, "{}", stderr(&output));
    assert!(!published(&dir.path().join("store")).is_empty());
    let refused = run(dir.path(), &["run", "models/machinery", "--log", "no/such/folder/log"]);
    assert!(code(&refused) == 2 && stderr(&refused).contains("no/such/folder/log"), "{}", stderr(&refused));
}
