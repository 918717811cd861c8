//! What `docs/faults.md` tells, row by row: what the user sees, and what is kept.

mod common;

use std::os::unix::fs::{PermissionsExt, symlink};
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use common::{MODELS, archive, code, published, run, stderr, stdout, symalign};

const RUN: [&str; 6] = ["run", "models", "--jobs", "1", "--method", "pca,cpca"];

/// The bytes of an undisturbed run's store.
fn undisturbed(dir: &Path) -> Vec<u8> {
    let output = run(dir, &[&RUN[..], &["--store", "whole"]].concat());
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    published(&dir.join("whole"))
}

/// The run again, to its end and to the bytes of an undisturbed one.
#[track_caller]
fn assert_resumed(dir: &Path) -> Output {
    let output = run(dir, &RUN);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert!(published(&dir.join("store")) == undisturbed(dir), "the bytes differ");
    output
}

/// An error that stops a run: exit code 2 and these words.
#[track_caller]
fn assert_stopped(output: &Output, words: &[&str]) {
    let said = stderr(output);
    assert_eq!(code(output), 2, "{said}");
    assert!(words.iter().all(|word| said.contains(word)), "{words:?} in {said}");
}

/// The failure of a model, as the store lists it.
fn failure(dir: &Path, id: &str) -> String {
    let listed = stdout(&run(dir, &["store", "list", "--failures"]));
    let line = listed.lines().find_map(|line| line.strip_prefix(id)?.strip_prefix('\t'));
    line.unwrap_or_else(|| panic!("{id} in {listed}")).to_owned()
}

#[test]
fn a_disk_that_fills_up_stops_the_run_and_costs_nothing_that_was_done() {
    let dir = tempfile::tempdir().unwrap();
    archive(dir.path());
    // Files may not grow beyond 96 blocks of 512 bytes: room for the first models.
    let limited = "trap '' XFSZ; ulimit -f 96; exec \"$0\" \"$@\"";
    let mut shell = Command::new("sh");
    shell.current_dir(dir.path()).args(["-c", limited, env!("CARGO_BIN_EXE_symalign")]).args(RUN);
    let output = shell.output().unwrap();
    assert_stopped(&output, &["store/journal.symalign: File too large", "run the same command to go on"]);
    assert!(!dir.path().join("store/models.symalign").exists());
    let resumed = assert_resumed(dir.path());
    assert!(!stderr(&resumed).contains(&format!("{} computed", MODELS.len() + 1)), "{}", stderr(&resumed));
}

#[test]
fn a_disk_that_is_full_when_publishing_leaves_the_older_store_whole() {
    let dir = tempfile::tempdir().unwrap();
    let models = archive(dir.path());
    assert_eq!(code(&run(dir.path(), &RUN)), 0);
    let before = published(&dir.path().join("store"));
    std::fs::copy(models.join(MODELS[0]), models.join("new.step")).unwrap();
    symlink("/dev/full", dir.path().join("store/models.symalign.draft")).unwrap();
    let output = run(dir.path(), &RUN);
    assert_stopped(&output, &["models.symalign.draft: No space left on device", "run the same command to go on"]);
    assert!(published(&dir.path().join("store")) == before);
    assert!(!dir.path().join("store/models.symalign.draft").exists(), "the draft is in the way");
    assert_resumed(dir.path());
}

#[test]
fn a_store_that_cannot_be_begun_is_not_begun() {
    let dir = tempfile::tempdir().unwrap();
    archive(dir.path());
    std::fs::create_dir(dir.path().join("store")).unwrap();
    symlink("/dev/full", dir.path().join("store/journal.symalign.draft")).unwrap();
    assert_stopped(&run(dir.path(), &RUN), &["journal.symalign.draft: No space left on device"]);
    std::fs::remove_file(dir.path().join("store/journal.symalign.draft")).unwrap();
    assert_resumed(dir.path());
}

#[test]
fn a_read_error_and_a_file_that_vanished_cost_one_model() {
    let dir = tempfile::tempdir().unwrap();
    let models = archive(dir.path());
    // The first page of a process's memory cannot be read: EIO.
    symlink("/proc/self/mem", models.join("bad-sector.step")).unwrap();
    symlink("nowhere", models.join("vanished.step")).unwrap();
    let output = run(dir.path(), &RUN);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert_eq!(failure(dir.path(), "bad-sector.step"), "parse: cannot be read: Input/output error (os error 5)");
    let vanished = failure(dir.path(), "vanished.step");
    assert!(vanished.contains("No such file or directory (os error 2)"), "{vanished}");
    std::fs::remove_file(models.join("bad-sector.step")).unwrap();
    std::fs::remove_file(models.join("vanished.step")).unwrap();
    assert_resumed(dir.path());
}

/// The program as somebody who is not root, who may read and write anything; `None` where that is not possible.
fn as_nobody(dir: &Path, args: &[&str]) -> Option<Output> {
    let mut command = symalign(dir, args);
    if std::fs::metadata("/proc/self").is_ok_and(|meta| std::os::unix::fs::MetadataExt::uid(&meta) == 0) {
        command.uid(65534).gid(65534);
    }
    command.output().inspect_err(|e| eprintln!("skipped: the program cannot be started as nobody: {e}")).ok()
}

#[test]
fn a_model_that_may_not_be_read_is_one_failure_and_a_store_that_may_not_be_written_stops() {
    let dir = tempfile::tempdir().unwrap();
    let models = archive(dir.path());
    let mode = |path: &Path, mode| std::fs::set_permissions(path, PermissionsExt::from_mode(mode)).unwrap();
    mode(dir.path(), 0o777);
    mode(&models.join(MODELS[0]), 0o000);
    let Some(output) = as_nobody(dir.path(), &RUN) else { return };
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert_eq!(failure(dir.path(), MODELS[0]), "parse: cannot be read: Permission denied (os error 13)");
    std::fs::create_dir(dir.path().join("closed")).unwrap();
    mode(&dir.path().join("closed"), 0o555);
    for store in ["closed", "closed/deeper"] {
        let output = as_nobody(dir.path(), &[&RUN[..], &["--store", store]].concat()).unwrap();
        assert_stopped(&output, &[store, "Permission denied"]);
    }
    mode(&models.join(MODELS[0]), 0o644);
    let output = as_nobody(dir.path(), &RUN).unwrap();
    assert!(stderr(&output).contains("6 models done, 1 failed; 1 computed"), "{}", stderr(&output));
}

/// Gives the published file another format version, with checksums that are right.
fn set_version(path: &Path, version: u32) {
    let mut bytes = std::fs::read(path).unwrap();
    for header in [0, bytes.len() - 64] {
        bytes[header + 8..header + 12].copy_from_slice(&version.to_le_bytes());
        let crc = crc32fast::hash(&bytes[header..header + 60]);
        bytes[header + 60..header + 64].copy_from_slice(&crc.to_le_bytes());
    }
    std::fs::write(path, bytes).unwrap();
}

#[test]
fn a_store_of_a_newer_version_is_refused_and_left_alone() {
    let dir = tempfile::tempdir().unwrap();
    archive(dir.path());
    assert_eq!(code(&run(dir.path(), &RUN)), 0);
    let store = dir.path().join("store");
    set_version(&store.join("models.symalign"), 99);
    let before = published(&store);
    let words = ["format version 99, this program reads 2", "--fresh"];
    for args in [&["store", "list"][..], &["store", "verify"], &["eval"], &RUN] {
        assert_stopped(&run(dir.path(), args), &words);
    }
    std::fs::remove_file(store.join("journal.symalign")).unwrap();
    assert_stopped(&run(dir.path(), &RUN), &words);
    assert!(published(&store) == before);
    assert_eq!(code(&run(dir.path(), &[&RUN[..], &["--fresh"]].concat())), 0);
}

/// Flips a bit in the middle of the section of this name (and method) of the published file.
fn damage_section(dir: &Path, name: &str, method: &str) {
    let info: serde_json::Value = serde_json::from_str(&stdout(&run(dir, &["store", "info", "--json"]))).unwrap();
    let sections = info["sections"].as_array().unwrap();
    let hit = sections.iter().find(|s| s["name"] == name && (method.is_empty() || s["method"] == method)).unwrap();
    let at = hit["offset"].as_u64().unwrap() + hit["bytes"].as_u64().unwrap() / 2;
    flip(&dir.join("store/models.symalign"), at as usize);
}

fn flip(path: &Path, at: usize) {
    let mut bytes = std::fs::read(path).unwrap();
    bytes[at] ^= 8;
    std::fs::write(path, bytes).unwrap();
}

#[test]
fn a_flipped_bit_in_a_store_costs_one_section_until_the_next_run() {
    let dir = tempfile::tempdir().unwrap();
    archive(dir.path());
    assert_eq!(code(&run(dir.path(), &RUN)), 0);
    damage_section(dir.path(), "magnitude", "pca");
    damage_section(dir.path(), "ids", "");
    let verified = run(dir.path(), &["store", "verify"]);
    assert_stopped(&verified, &["damaged: Magnitudes of pca at byte", "damaged: Ids at byte"]);
    let model = format!("models/{}", MODELS[0]);
    let query = |method| run(dir.path(), &["query", &model, "--method", method]);
    assert_stopped(&query("pca"), &["section Magnitudes of pca at byte", "the same `run` again"]);
    assert_eq!(code(&query("cpca")), 0);
    assert!(stdout(&query("cpca")).contains(MODELS[0]));
    let listed = run(dir.path(), &["store", "list"]);
    assert_eq!((code(&listed), stdout(&listed).lines().count()), (0, MODELS.len()));
    let resumed = assert_resumed(dir.path());
    assert!(stderr(&resumed).contains("; 0 computed"), "{}", stderr(&resumed));
}

#[test]
fn a_flipped_bit_in_a_journal_costs_one_model_until_the_next_run() {
    let dir = tempfile::tempdir().unwrap();
    archive(dir.path());
    assert_eq!(code(&run(dir.path(), &RUN)), 0);
    let journal = dir.path().join("store/journal.symalign");
    flip(&journal, journal.metadata().unwrap().len() as usize / 2);
    assert_stopped(&run(dir.path(), &["store", "verify"]), &["journal.symalign: damaged: records at byte"]);
    let resumed = assert_resumed(dir.path());
    assert!(stderr(&resumed).contains("what was in it is computed again"), "{}", stderr(&resumed));
    assert!(stderr(&resumed).contains("; 1 computed"), "{}", stderr(&resumed));
    assert_eq!(code(&run(dir.path(), &["store", "verify"])), 0, "the run has mended it");
}

/// Starts the run, and sends it signals once it computes; its end.
fn signalled(dir: &Path, signals: &[&str]) -> Output {
    let child = symalign(dir, &RUN).stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
    let end = Instant::now() + Duration::from_secs(120);
    while !dir.join("store/journal.symalign").exists() {
        assert!(Instant::now() < end, "no journal in two minutes");
        std::thread::sleep(Duration::from_millis(2));
    }
    for signal in signals {
        assert!(Command::new("kill").arg(signal).arg(child.id().to_string()).status().unwrap().success());
        std::thread::sleep(Duration::from_millis(20));
    }
    child.wait_with_output().unwrap()
}

#[test]
fn sigterm_ends_a_run_as_ctrl_c_does() {
    let dir = tempfile::tempdir().unwrap();
    archive(dir.path());
    let output = signalled(dir.path(), &["-TERM"]);
    assert_eq!(code(&output), 130, "{}", stderr(&output));
    assert!(stderr(&output).contains("run the same command to go on"), "{}", stderr(&output));
    assert_resumed(dir.path());
}

#[test]
fn a_second_interrupt_stops_at_once_and_loses_nothing() {
    let dir = tempfile::tempdir().unwrap();
    archive(dir.path());
    let output = signalled(dir.path(), &["-INT", "-INT"]);
    assert_eq!(code(&output), 130, "{}", stderr(&output));
    assert!(stderr(&output).contains("once more to stop now"), "{}", stderr(&output));
    assert_resumed(dir.path());
}
