//! What one model may take, and all together: giant files fail in time with their reason and stage, or wait for room.

mod common;

use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

use common::{code, copies, run, stderr, stdout, symalign};

/// A folder `in` with `count` different models of `bodies` brackets each; the size of one file in bytes.
fn giants(dir: &Path, count: usize, bodies: usize) -> u64 {
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("data-samples/machinery/bracket.step");
    let text = copies(&std::fs::read_to_string(sample).unwrap(), bodies);
    std::fs::create_dir(dir.join("in")).unwrap();
    for i in 0..count {
        std::fs::write(dir.join(format!("in/{i}.step")), format!("{text}/* {i} */")).unwrap();
    }
    text.len() as u64
}

fn limits(dir: &Path, lines: &str) {
    std::fs::write(dir.join("pipeline.toml"), format!("input = \"in\"\nmethods = [\"pca\"]\n[limits]\n{lines}\n"))
        .unwrap();
}

/// The last words on each model that was lost.
fn failures(dir: &Path) -> Vec<String> {
    let listed = stdout(&run(dir, &["store", "list", "--failures"]));
    listed.lines().map(|line| line.split_once('\t').unwrap().1.to_owned()).collect()
}

/// Runs to the end; the largest resident set, bytes.
fn peak_of_run(dir: &Path, args: &[&str]) -> u64 {
    let mut child = symalign(dir, args).stderr(Stdio::null()).stdout(Stdio::null()).spawn().unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0;
    while child.try_wait().unwrap().is_none() {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB"));
        peak = line.map_or(peak, |kilobytes| kilobytes.trim().parse::<u64>().unwrap() << 10);
        std::thread::sleep(Duration::from_millis(10));
    }
    assert!(child.wait().unwrap().success());
    peak
}

#[test]
fn a_giant_stops_soon_after_its_time_with_its_stage() {
    let dir = tempfile::tempdir().unwrap();
    giants(dir.path(), 1, 500);
    limits(dir.path(), "seconds = 0.3");
    let output = run(dir.path(), &["run", "--jobs", "1"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let [why] = &failures(dir.path())[..] else { panic!("{}", stderr(&output)) };
    let (stage, why) = why.split_once(": ").unwrap();
    assert_eq!(why, format!("time limit of 0.3 s passed in stage {stage}"));
}

#[test]
fn a_giant_stops_at_its_memory_with_its_stage() {
    let dir = tempfile::tempdir().unwrap();
    giants(dir.path(), 2, 500);
    limits(dir.path(), "model_memory_mb = 40");
    let peak = peak_of_run(dir.path(), &["run", "--jobs", "1"]);
    let failures = failures(dir.path());
    assert_eq!(failures.len(), 2);
    for failure in failures {
        let (stage, why) = failure.split_once(": ").unwrap();
        assert_eq!(why, format!("memory limit of 40 MB passed in stage {stage}"));
    }
    // The program itself, the two files in flight, and what is taken between two looks at the limit.
    assert!(peak < 200 << 20, "{} MB", peak >> 20);
}

#[test]
fn giants_wait_for_room_instead_of_adding_to_the_peak() {
    let dir = tempfile::tempdir().unwrap();
    let size = giants(dir.path(), 6, 150);
    // Room for one that is computed, and the next one's bytes.
    limits(dir.path(), &format!("model_memory_mb = 100000\nmemory_mb = {}", 8 + ((28 * size) >> 20)));
    let one = peak_of_run(dir.path(), &["run", "in/0.step", "--jobs", "4", "--store", "one"]);
    let six = peak_of_run(dir.path(), &["run", "--jobs", "4"]);
    assert!(failures(dir.path()).is_empty());
    assert!(six < 2 * one, "one takes {} MB, six {} MB", one >> 20, six >> 20);
    limits(dir.path(), "memory_mb = 100000");
    let at_once = peak_of_run(dir.path(), &["run", "--jobs", "4", "--store", "all"]);
    assert!(at_once > six, "six at once take {} MB, in turn {} MB", at_once >> 20, six >> 20);
}
