//! Real files, changed at random but the same each time: whatever is changed, reading ends with a model or a reason,
//! within time and memory; and what changes only the looks of the text changes nothing else.
//!
//! `data-samples` always; with `SYMALIGN_DATA` also small files of its folders.

mod part21;

use std::path::{Path, PathBuf};

use part21::reading::{PATIENCE, parsed_until};
use part21::{Text, tokens};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use symalign::cancel::Cancel;
use symalign::stages::parse::{Options, Parsed, parse};

/// Files larger than this take too long for many rounds, bytes.
const SMALL: u64 = 60_000;
/// Peak memory of this test program, MB: some files at the same time, none larger than [`SMALL`].
const MOST_MEMORY: u64 = 2000;

/// The small STEP files below a folder, in the order of their names, `most` of them spread over all.
fn small_files(folder: &Path, most: usize) -> Vec<(PathBuf, Vec<u8>)> {
    let is_step = |path: &Path| {
        let extension = path.extension().map(|e| e.to_ascii_lowercase());
        extension.is_some_and(|e| ["step", "stp", "p21"].iter().any(|known| e == *known))
    };
    let walk = walkdir::WalkDir::new(folder).sort_by_file_name().into_iter().flatten();
    let small = walk.filter(|e| is_step(e.path()) && e.metadata().is_ok_and(|m| m.len() <= SMALL));
    let all: Vec<PathBuf> = small.map(|e| e.into_path()).collect();
    let step = all.len().div_ceil(most).max(1);
    all.into_iter().step_by(step).map(|path| (path.clone(), std::fs::read(path).unwrap())).collect()
}

fn samples() -> Vec<(PathBuf, Vec<u8>)> {
    let found = small_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("data-samples"), 12);
    assert!(found.len() >= 6, "{} small samples", found.len());
    found
}

/// Small real files, where they are.
fn real_files() -> Vec<(PathBuf, Vec<u8>)> {
    let Some(data) = std::env::var_os("SYMALIGN_DATA").map(PathBuf::from).filter(|folder| folder.is_dir()) else {
        eprintln!("skipped: set SYMALIGN_DATA to the folder with the real files");
        return Vec::new();
    };
    ["real-parts", "cross-cad", "hostile"].iter().flat_map(|part| small_files(&data.join(part), 12)).collect()
}

fn read(bytes: &[u8]) -> Option<Parsed> {
    parse(bytes, &Options::default(), None, &Cancel::new()).ok()
}

/// Reads what was changed; it must end, and what comes out must be sound. Whether there is a model.
fn survives(path: &Path, bytes: Vec<u8>, what: &str) -> bool {
    let Ok(parsed) = parsed_until(bytes, &Cancel::new(), PATIENCE) else { return false };
    let measures = &parsed.measures;
    assert!(measures.area.is_finite() && measures.volume.is_finite(), "{}, {what}", path.display());
    assert!(parsed.mesh.points.iter().flat_map(|p| p.iter()).all(|c| c.is_finite()), "{}, {what}", path.display());
    assert!(parsed.skipped.iter().all(|s| !s.why.is_empty()), "{}, {what}", path.display());
    true
}

/// Some bytes set to others, and now and then a piece taken out or the end cut off.
fn change_bytes(bytes: &mut Vec<u8>, rng: &mut Pcg64) {
    for _ in 0..rng.random_range(1..=20) {
        let at = rng.random_range(0..bytes.len());
        bytes[at] = match rng.random_range(0..3) {
            0 => rng.random(),
            1 => b"#'();,$*/.\0\n"[rng.random_range(0..12)],
            _ => bytes[at] ^ (1 << rng.random_range(0..8)),
        };
    }
    match rng.random_range(0..4) {
        0 => bytes.truncate(rng.random_range(1..=bytes.len())),
        1 => {
            let from = rng.random_range(0..bytes.len());
            bytes.drain(from..bytes.len().min(from + rng.random_range(1..2000)));
        }
        _ => {}
    }
}

/// The number of changed files that were still read.
fn mutate(files: &[(PathBuf, Vec<u8>)], rounds: u64) -> usize {
    let mut read = 0;
    for (path, bytes) in files {
        let text = Text::split(bytes);
        for round in 0..rounds {
            let mut rng = Pcg64::seed_from_u64(round);
            let mut changed = text.clone();
            (0..rng.random_range(1..=30)).for_each(|_| changed.change(&mut rng));
            read += usize::from(survives(path, changed.join(), &format!("changes of round {round}")));
            let mut changed = bytes.clone();
            change_bytes(&mut changed, &mut rng);
            read += usize::from(survives(path, changed, &format!("bytes of round {round}")));
        }
    }
    read
}

/// Peak memory of this process, MB; `None` where the system does not tell.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix(" kB")?.parse::<u64>().ok().map(|kb| kb / 1024)
}

#[test]
fn changed_samples_are_survived() {
    let (files, rounds) = (samples(), 25);
    let read = mutate(&files, rounds);
    // Else the changes would be of no use.
    assert!(read > files.len() * rounds as usize, "{read} of {}", 2 * files.len() * rounds as usize);
    let peak = peak_memory().unwrap_or(0);
    assert!(peak < MOST_MEMORY, "{peak} MB");
}

#[test]
fn changed_real_files_are_survived() {
    let files = real_files();
    let read = mutate(&files, 15);
    eprintln!("{read} of {} changed real files were read", 30 * files.len());
    let peak = peak_memory().unwrap_or(0);
    assert!(peak < MOST_MEMORY, "{peak} MB");
}

/// A comment, white space and line breaks between some tokens.
fn with_comments(bytes: &[u8], rng: &mut Pcg64) -> Vec<u8> {
    let text = Text::split(bytes);
    let space = ["/* it's; #1=X( */", " ", "\r\n", "\t/**/\n"];
    let spread = |instance: &Vec<u8>, rng: &mut Pcg64| {
        let mut spread = Vec::new();
        let mut from = 0;
        for (_, place) in tokens(instance).into_iter().skip(1) {
            spread.extend_from_slice(&instance[from..place.start]);
            if rng.random_range(0..8) == 0 {
                spread.extend_from_slice(space[rng.random_range(0..space.len())].as_bytes());
            }
            from = place.start;
        }
        spread.extend_from_slice(&instance[from..]);
        spread
    };
    let instances = text.instances.iter().map(|instance| spread(instance, rng)).collect();
    Text { instances, ..text }.join()
}

/// What looks otherwise but says the same.
fn disguises(bytes: &[u8]) -> Vec<(&'static str, Vec<u8>)> {
    let mut rng = Pcg64::seed_from_u64(7);
    let crlf = String::from_utf8_lossy(bytes).replace("\r\n", "\n").replace('\n', "\r\n").into_bytes();
    let mut reversed = Text::split(bytes);
    reversed.instances.reverse();
    let mut shuffled = Text::split(bytes);
    for i in (1..shuffled.instances.len()).rev() {
        shuffled.instances.swap(i, rng.random_range(0..=i));
    }
    vec![
        ("an instance a line", Text::split(bytes).join()),
        ("CRLF", crlf),
        ("lower case", bytes.to_ascii_lowercase()),
        ("comments", with_comments(bytes, &mut rng)),
        ("reversed", reversed.join()),
        ("shuffled", shuffled.join()),
    ]
}

fn assert_disguises_change_nothing(files: &[(PathBuf, Vec<u8>)]) {
    for (path, bytes) in files {
        let Some(expected) = read(bytes) else { continue };
        for (what, text) in disguises(bytes) {
            let found = read(&text).unwrap_or_else(|| panic!("{}: {what}: not read", path.display()));
            assert_eq!(found.measures, expected.measures, "{}: {what}", path.display());
            assert_eq!(found.skipped, expected.skipped, "{}: {what}", path.display());
            assert_eq!(found.mesh.triangles, expected.mesh.triangles, "{}: {what}", path.display());
        }
    }
}

#[test]
fn the_looks_of_the_text_change_nothing() {
    assert_disguises_change_nothing(&samples());
    assert_disguises_change_nothing(&real_files());
}
