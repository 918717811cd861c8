//! Stopped at any instant, a run goes on where it was, and its store is the same bytes.

mod common;

use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use common::{archive, code, published, run, stderr, symalign};

const RUN: [&str; 4] = ["run", "models", "--jobs", "1"];

/// Starts the run and waits until its journal has more than `bytes` bytes or the run has ended.
fn started(dir: &Path, bytes: u64) -> Child {
    let mut child = symalign(dir, &RUN).stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
    let journal = dir.join("store/journal.symalign");
    let end = Instant::now() + Duration::from_secs(120);
    while child.try_wait().unwrap().is_none() && journal.metadata().map_or(0, |meta| meta.len()) <= bytes {
        assert!(Instant::now() < end, "no record in two minutes");
        std::thread::sleep(Duration::from_millis(2));
    }
    child
}

fn journal_length(dir: &Path) -> u64 {
    dir.join("store/journal.symalign").metadata().map_or(0, |meta| meta.len())
}

/// The bytes of an undisturbed run's store.
fn undisturbed(dir: &Path) -> Vec<u8> {
    let output = run(dir, &[&RUN[..], &["--store", "whole"]].concat());
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    published(&dir.join("whole"))
}

#[test]
fn an_interrupted_run_says_how_to_go_on_and_does() {
    let dir = tempfile::tempdir().unwrap();
    archive(dir.path());
    // The two copies of the settings are there; the first model is being computed.
    let child = started(dir.path(), 100);
    let sent = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(code(&output), 130, "{}", stderr(&output));
    assert!(stderr(&output).contains("run the same command to go on"), "{}", stderr(&output));
    assert!(!dir.path().join("store/models.symalign").exists(), "nothing is published before the end");
    assert_eq!(code(&run(dir.path(), &RUN)), 0);
    assert!(published(&dir.path().join("store")) == undisturbed(dir.path()));
}

#[test]
fn a_killed_run_loses_nothing_that_was_committed() {
    let dir = tempfile::tempdir().unwrap();
    archive(dir.path());
    let mut length = 100;
    for _ in 0..3 {
        let mut child = started(dir.path(), length);
        let _ = child.kill(); // it may have ended
        child.wait().unwrap();
        assert!(journal_length(dir.path()) >= length, "the journal lost records");
        length = journal_length(dir.path());
    }
    assert_eq!(code(&run(dir.path(), &RUN)), 0);
    assert!(published(&dir.path().join("store")) == undisturbed(dir.path()));
}

#[test]
fn a_second_run_on_a_store_is_refused_with_the_pid_of_the_first() {
    let dir = tempfile::tempdir().unwrap();
    archive(dir.path());
    let mut child = started(dir.path(), 100);
    let second = run(dir.path(), &RUN);
    let running = child.try_wait().unwrap().is_none();
    child.wait().unwrap();
    if running {
        assert_eq!(code(&second), 2, "{}", stderr(&second));
        assert!(stderr(&second).contains(&format!("process {} ", child.id())), "{}", stderr(&second));
    }
}
