//! SIGKILL at instants spread over whole runs, each resumed until it is done: the published bytes are those of an
//! undisturbed run, and the journal has the outcome of each model once.
//!
//! The short form kills ten times; `SYMALIGN_KILLS=200` is the long one, with the real parts of `SYMALIGN_DATA` where
//! they are there. It prints what it did.

mod common;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Duration;

use common::{archive, code, published, run, stderr, symalign};
use symalign::store::journal::Journal;

/// What is read: all of data-samples and real parts in the long form, a few models in the short one.
fn inputs(dir: &Path, long: bool) -> Vec<PathBuf> {
    if !long {
        return vec![archive(dir)];
    }
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("data-samples");
    let real = std::env::var_os("SYMALIGN_DATA").map(|data| Path::new(&data).join("real-parts"));
    let real = real.filter(|folder| folder.is_dir());
    if real.is_none() {
        eprintln!("no real-parts in SYMALIGN_DATA: data-samples only");
    }
    std::iter::once(samples).chain(real).collect()
}

/// A number from 0 to 1 that looks random: the same for the same kill.
fn noise(kill: u64) -> f64 {
    let mixed = (kill + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let mixed = (mixed ^ mixed >> 29).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    (mixed >> 11) as f64 / (1u64 << 53) as f64
}

/// Where a run was when it was killed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Phase {
    /// It had no journal yet.
    Start,
    Computing,
    /// A draft of the published file was there.
    Publishing,
    /// It had ended before.
    Ended,
}

/// When a run is killed.
enum Instant {
    After(Duration),
    /// So long after the draft of the published file is there.
    Publishing(Duration),
}

/// Kills a run of `args`, and tells where it was.
fn killed(dir: &Path, args: &[&str], instant: &Instant) -> Phase {
    let store = dir.join("cut");
    let publishes = || store.join("models.symalign.draft").exists();
    // A draft that an earlier kill left is none of this run.
    let _ = std::fs::remove_file(store.join("models.symalign.draft"));
    let mut child = symalign(dir, args).stderr(Stdio::null()).stdout(Stdio::null()).spawn().unwrap();
    match instant {
        Instant::After(delay) => std::thread::sleep(*delay),
        Instant::Publishing(delay) => {
            while !publishes() && child.try_wait().unwrap().is_none() {
                std::thread::sleep(Duration::from_micros(200));
            }
            std::thread::sleep(*delay);
        }
    }
    if child.try_wait().unwrap().is_some() {
        return Phase::Ended;
    }
    child.kill().unwrap();
    child.wait().unwrap();
    match () {
        () if publishes() => Phase::Publishing,
        () if !store.join("journal.symalign").exists() => Phase::Start,
        () => Phase::Computing,
    }
}

/// The outcomes in a journal, read by the layout that FORMAT.md tells: how often each content hash is there.
fn outcomes(journal: &Path) -> BTreeMap<[u8; 32], usize> {
    let bytes = std::fs::read(journal).unwrap();
    let (mut at, mut found) = (0, BTreeMap::new());
    while at < bytes.len() {
        assert_eq!(bytes[at..at + 4], *b"\xABrec", "a record at byte {at}");
        let kind = u32::from_le_bytes(bytes[at + 4..at + 8].try_into().unwrap());
        let length = u64::from_le_bytes(bytes[at + 8..at + 16].try_into().unwrap()) as usize;
        if kind == 2 {
            *found.entry(bytes[at + 20..at + 52].try_into().unwrap()).or_default() += 1;
        }
        at += 20 + length;
    }
    found
}

#[test]
fn runs_killed_at_any_instant_end_with_the_bytes_of_an_undisturbed_one() {
    let asked = std::env::var("SYMALIGN_KILLS").ok();
    let kills: u64 = asked.as_ref().map_or(10, |text| text.parse().expect("SYMALIGN_KILLS is a number"));
    let dir = tempfile::tempdir().unwrap();
    let inputs = inputs(dir.path(), asked.is_some());
    let inputs = inputs.iter().map(|path| path.to_str().unwrap());
    let args =
        |store| -> Vec<&str> { ["run", "--jobs", "2", "--store", store].into_iter().chain(inputs.clone()).collect() };
    let started = std::time::Instant::now();
    let whole = run(dir.path(), &args("whole"));
    assert_eq!(code(&whole), 0, "{}", stderr(&whole));
    let undisturbed = started.elapsed();
    let expected = published(&dir.path().join("whole"));

    let (mut phases, mut finished) = (BTreeMap::<Phase, u64>::new(), 0);
    let journal = dir.path().join("cut/journal.symalign");
    let check = || {
        assert!(published(&dir.path().join("cut")) == expected, "the bytes differ");
        assert_eq!(Journal::verify(&journal).unwrap().1, []);
        let outcomes = outcomes(&journal);
        assert!(outcomes.values().all(|count| *count == 1), "a model was computed and committed twice");
        outcomes.len()
    };
    let (mut tried, mut done) = (0, 0);
    while done < kills {
        let (kind, random) = (tried % 8, noise(tried));
        let instant = match kind {
            0 => Instant::After(undisturbed.mul_f64(0.02 * random)),
            1 => Instant::Publishing(Duration::from_millis(10).mul_f64(random)),
            // A tenth more than an undisturbed run takes, so that some fall on its end.
            _ => Instant::After(undisturbed.mul_f64(1.1 * random)),
        };
        tried += 1;
        let phase = killed(dir.path(), &args("cut"), &instant);
        if phase == Phase::Ended {
            check();
            std::fs::remove_dir_all(dir.path().join("cut")).unwrap();
            finished += 1;
        } else {
            *phases.entry(phase).or_default() += 1;
            done += 1;
        }
    }
    let last = run(dir.path(), &args("cut"));
    assert_eq!(code(&last), 0, "{}", stderr(&last));
    let models = check();
    eprintln!(
        "{kills} kills: {phases:?}; undisturbed {undisturbed:.1?}; {} runs to their end, each equal; {models} models, each \
         committed once",
        finished + 1
    );
}
