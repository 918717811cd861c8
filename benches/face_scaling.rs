//! Times the stages on made models of 100 to 100,000 faces: distinct faces, and thousands that are congruent.
//!
//! ```console
//! $ cargo run --release --example face_scaling                     all kinds, up to 100,000 faces
//! $ cargo run --release --example face_scaling -- 10000 holes      one kind, up to 10,000
//! $ cargo run --release --example face_scaling -- --write DIR 1000 the files themselves
//! ```
//!
//! One thread. Seconds are those of the processor where the system tells them (Linux), so other programs do not
//! count; `growth` is the exponent p of time ~ faces^p from the row before, `peak` the largest memory so far.

use std::fmt::Write;
use std::time::Instant;

use symalign::cancel::Cancel;
use symalign::stages::corner_filter::corner_filter;
use symalign::stages::descriptor::descriptor;
use symalign::stages::isometry::isometry;
use symalign::stages::merge::merge;
use symalign::stages::pair_match::pair_match;
use symalign::stages::parse::{self, parse};
use symalign::stages::projection_sweep::projection_sweep;
use symalign::stages::validate::validate;

#[path = "face_scaling/models.rs"]
mod models;
use models::KINDS;

const SIZES: [usize; 4] = [100, 1_000, 10_000, 100_000];
const STAGES: [&str; 8] = ["parse", "corners", "pairs", "isometry", "validate", "merge", "sweep", "descr."];

fn main() -> std::io::Result<()> {
    let mut words: Vec<String> = std::env::args().skip(1).collect();
    let folder =
        words.iter().position(|w| w == "--write").map(|at| words.drain(at..at + 2).next_back().unwrap_or_default());
    let most = words.iter().find_map(|w| w.parse().ok()).unwrap_or(usize::MAX);
    let kinds = KINDS.iter().filter(|(name, _)| words.iter().all(|w| w.parse::<usize>().is_ok() || w == name));
    rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global().expect("the first pool");
    for (name, make) in kinds {
        if folder.is_none() {
            println!("{}", table_head(name));
        }
        let mut before = None;
        for wanted in SIZES.into_iter().filter(|s| *s <= most) {
            let text = make(wanted);
            if let Some(folder) = &folder {
                std::fs::write(format!("{folder}/{name}-{wanted}.step"), text)?;
            } else {
                before = Some(row(text.as_bytes(), before));
            }
        }
    }
    Ok(())
}

fn table_head(name: &str) -> String {
    let stages = STAGES.map(|s| format!("{s:>9}")).concat();
    format!("\n{name:<12} faces{stages}    total  growth  peak MB  planes")
}

/// Runs and prints one model; returns its faces and seconds.
fn row(bytes: &[u8], before: Option<(usize, f64)>) -> (usize, f64) {
    let mut seconds = [0.0; 8];
    let (faces, planes) = run(bytes, &mut seconds);
    let total: f64 = seconds.iter().sum();
    let growth = before.map(|(n, t)| (total / t).ln() / (faces as f64 / n as f64).ln());
    let mut line = format!("{faces:>18}");
    for s in seconds {
        write!(line, "{s:>9.4}").expect("text grows");
    }
    let growth = growth.map_or_else(String::new, |g| format!("{g:.2}"));
    println!("{line}{total:>9.3}{growth:>8}{:>9}{planes:>8}", peak_megabytes());
    (faces, total)
}

/// All stages one after the other; returns faces and planes.
fn run(bytes: &[u8], seconds: &mut [f64; 8]) -> (usize, usize) {
    let cancel = Cancel::new();
    let mut stage = 0;
    macro_rules! timed {
        ($call:expr) => {{
            let start = now();
            let result = $call.expect("made models pass all stages");
            seconds[stage] = now() - start;
            stage += 1;
            result
        }};
    }
    let options = parse::Options::default();
    let parsed = timed!(parse(bytes, &options, None, &cancel));
    let outlines = timed!(corner_filter(&parsed, &Default::default(), &cancel));
    let matches = timed!(pair_match(&parsed, &outlines, &Default::default(), &cancel));
    let candidates = timed!(isometry(&parsed, &outlines, &matches, &Default::default(), &cancel));
    let validated = timed!(validate(&parsed, &outlines, &matches, &candidates, &Default::default(), &cancel));
    let symmetries = timed!(merge(&parsed, &outlines, &matches, &validated, &Default::default(), &cancel));
    let canonical = timed!(projection_sweep(&parsed, &symmetries, &Default::default(), &cancel));
    timed!(descriptor(&parsed.wireframe, &parsed.measures, &canonical.frame, &Default::default(), &cancel));
    assert_eq!(stage, STAGES.len());
    (parsed.mesh.faces.len(), symmetries.planes.len())
}

/// Seconds this thread has spent on a processor; wall time where the system does not tell.
fn now() -> f64 {
    static START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    let spent = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = spent.and_then(|s| s.split_whitespace().next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| START.get_or_init(Instant::now).elapsed().as_secs_f64(), |ns| ns * 1e-9)
}

/// Largest resident memory so far; 0 where the system does not tell.
fn peak_megabytes() -> usize {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    line.and_then(|l| l.split_whitespace().next()?.parse::<usize>().ok()).map_or(0, |kb| kb / 1024)
}
