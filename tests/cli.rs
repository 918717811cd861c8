//! The contract of the command line: exit codes, and what goes where.

mod common;

use common::{archive, code, run, stderr, stdout};

#[test]
fn bad_usage_and_bad_settings_cannot_run() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::create_dir(dir.path().join("empty")).unwrap();
    let cases: [(&[&str], &str); 8] = [
        (&["run"], "pipeline.toml"),
        (&["run", "missing"], "missing"),
        (&["run", "--shard", "3/2", "x"], "3/2"),
        (&["eval", "--store", "none"], "is no store"),
        (&["eval"], "not finished"),
        (&["run", "empty", "--store", "none"], "no model in the input"),
        (&["frobnicate"], "frobnicate"),
        (&["query", "x.step", "-k", "0"], "1.."),
    ];
    for (args, named) in cases {
        let output = run(dir.path(), args);
        assert_eq!((code(&output), stdout(&output)), (2, String::new()), "{args:?}");
        assert!(stderr(&output).contains(named), "{args:?}: {}", stderr(&output));
    }
    std::fs::write(dir.path().join("pipeline.toml"), "input = \"x\"\n[limits]\nhours = 1\n").unwrap();
    let output = run(dir.path(), &["run"]);
    assert!(code(&output) == 2 && stderr(&output).contains("hours"), "{}", stderr(&output));
}

#[test]
fn failed_models_are_fatal_only_where_that_is_asked() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::create_dir(dir.path().join("in")).unwrap();
    std::fs::write(dir.path().join("in/broken.stp"), "no model").unwrap();
    let output = run(dir.path(), &["run", "in"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert!(stderr(&output).contains("0 models done, 1 failed"), "{}", stderr(&output));
    assert_eq!(code(&run(dir.path(), &["run", "in", "--strict"])), 1);
    let listed = stdout(&run(dir.path(), &["store", "list", "--failures"]));
    assert!(listed.starts_with("broken.stp\tparse: "), "{listed}");
}

#[test]
fn inspect_tells_of_a_model_that_cannot_be_read() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("broken.stp"), "no model").unwrap();
    let output = run(dir.path(), &["inspect", "broken.stp", "--json"]);
    assert_eq!(code(&output), 1);
    let object: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!((&object["model"], &object["error"]["stage"]), (&"broken.stp".into(), &"parse".into()));
    assert!(object["error"]["why"].is_string() && object["error"]["entity"].is_null(), "{object}");
    let output = run(dir.path(), &["inspect", "missing.stp", "broken.stp", "--json"]);
    assert_eq!((code(&output), stdout(&output).lines().count()), (1, 2), "a missing file does not cost the others");
}

#[test]
fn completions_are_printed_for_every_shell() {
    let dir = tempfile::tempdir().unwrap();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let output = run(dir.path(), &["completions", shell]);
        assert!(code(&output) == 0 && stdout(&output).contains("symalign"), "{shell}");
    }
}

#[test]
fn settings_that_differ_from_the_stores_are_named_and_fresh_starts_over() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::create_dir(dir.path().join("in")).unwrap();
    std::fs::write(dir.path().join("in/broken.stp"), "no model").unwrap();
    assert_eq!(code(&run(dir.path(), &["run", "in"])), 0);
    let differing = ["run", "in", "--random-pose", "7"];
    let output = run(dir.path(), &differing);
    assert_eq!(code(&output), 2);
    assert!(stderr(&output).contains("random_pose: not set, 7"), "{}", stderr(&output));
    let output = run(dir.path(), &[&differing[..], &["--fresh"]].concat());
    assert!(code(&output) == 0 && stderr(&output).contains("removed"), "{}", stderr(&output));
}

#[test]
fn damage_is_found_and_told_with_its_place() {
    let dir = tempfile::tempdir().unwrap();
    archive(dir.path());
    assert_eq!(code(&run(dir.path(), &["run", "models/machinery", "--method", "pca"])), 0);
    assert_eq!(code(&run(dir.path(), &["store", "verify"])), 0);
    let info: serde_json::Value =
        serde_json::from_str(&stdout(&run(dir.path(), &["store", "info", "--json"]))).unwrap();
    let sections = info["sections"].as_array().unwrap();
    let frames = sections.iter().find(|section| section["name"] == "frame").unwrap();
    assert_eq!((&frames["method"], &frames["dtype"]), (&"pca".into(), &"<f8".into()));
    assert_eq!(frames["shape"], serde_json::json!([2, 12]));
    let path = dir.path().join("store/models.symalign");
    let mut bytes = std::fs::read(&path).unwrap();
    bytes[frames["offset"].as_u64().unwrap() as usize + 3] ^= 16;
    std::fs::write(&path, bytes).unwrap();
    let output = run(dir.path(), &["store", "verify"]);
    assert_eq!(code(&output), 2);
    assert!(stderr(&output).contains("Frames of pca"), "{}", stderr(&output));
}

#[test]
fn every_command_has_examples_and_a_manual_page() {
    let dir = tempfile::tempdir().unwrap();
    assert_eq!(code(&run(dir.path(), &["man", "man1"])), 0);
    for command in ["run", "eval", "query", "inspect", "align", "symmetries", "store", "completions", "man"] {
        let help = stdout(&run(dir.path(), &[command, "--help"]));
        assert!(help.contains("Example") && help.contains(&format!("symalign {command} ")), "{help}");
        let page = std::fs::read_to_string(dir.path().join(format!("man1/symalign-{command}.1"))).unwrap();
        assert!(page.starts_with(".ie") && page.contains("Example"), "{command}: {page}");
    }
}
