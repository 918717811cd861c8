//! Imports point one way: geometry <- brep <- stages <- pipeline <- main; the store knows descriptors only, search
//! and evaluation know the store only. Each stage knows earlier stages only.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Each module of the crate, and the modules it may name.
const LAYERS: [(&str, &[&str]); 19] = [
    ("geometry", &[]),
    ("memory", &[]),
    ("cancel", &["memory"]),
    ("brep", &["geometry", "cancel", "memory"]),
    ("alignment", &["geometry", "brep", "cancel"]),
    ("silhouette", &["alignment", "geometry", "brep", "cancel"]),
    ("stages", &["geometry", "brep", "cancel", "memory", "alignment", "silhouette"]),
    ("aligned", &["geometry", "brep", "stages"]),
    ("error", &[]),
    ("archive", &["error", "memory"]),
    ("settings", &["alignment", "error", "stages"]),
    ("render", &["geometry", "brep", "cancel", "silhouette", "stages", "error"]),
    ("rotations", &["alignment", "geometry", "brep", "cancel", "stages"]),
    ("store", &["alignment", "error", "geometry", "stages"]),
    ("distance", &["stages", "cancel"]),
    ("search", &["alignment", "distance", "error", "stages", "store"]),
    ("evaluate", &["alignment", "distance", "error", "search", "stages", "store"]),
    (
        "pipeline",
        &[
            "alignment",
            "archive",
            "brep",
            "cancel",
            "error",
            "geometry",
            "memory",
            "render",
            "settings",
            "stages",
            "store",
        ],
    ),
    (
        "inspect",
        &["alignment", "archive", "brep", "error", "geometry", "pipeline", "render", "settings", "stages", "store"],
    ),
];

/// What stages, as pure functions, have no business with.
const IMPURE: [&str; 9] = [
    "std::fs",
    "std::thread",
    "std::time",
    "std::env",
    "std::process",
    "crossbeam",
    "println!",
    "indicatif",
    "tracing",
];

const STAGES: [&str; 8] =
    ["parse", "corner_filter", "pair_match", "isometry", "validate", "merge", "projection_sweep", "descriptor"];

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// All Rust files at or below `path`.
fn files(path: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    if path.is_file() {
        found.push(path.to_owned());
    } else if let Ok(entries) = std::fs::read_dir(path) {
        entries.flatten().for_each(|entry| found.extend(files(&entry.path())));
    }
    found.retain(|file| file.extension().is_some_and(|extension| extension == "rs"));
    found.sort();
    found
}

/// The files of a module: `name.rs` and the folder `name`.
fn module(parent: &Path, name: &str) -> Vec<PathBuf> {
    [files(&parent.join(format!("{name}.rs"))), files(&parent.join(name))].concat()
}

/// The code of a file: without comments and without the tests at its end, which may use anything.
fn code(file: &Path) -> String {
    if file.file_name().is_some_and(|name| name == "tests.rs") {
        return String::new();
    }
    let text = std::fs::read_to_string(file).unwrap();
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
    text.lines().map(|line| line.split("//").next().unwrap()).collect::<Vec<_>>().join("\n")
}

/// The names that follow `prefix` in the code of a module, such as `a` and `b` in `crate::{a::x, b}`.
fn named_after(prefix: &str, code: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (at, _) in code.match_indices(prefix) {
        let rest = &code[at + prefix.len()..];
        match rest.strip_prefix('{') {
            Some(group) => found.extend(leading_names(group)),
            None => found.extend(identifier(rest)),
        }
    }
    found
}

fn identifier(text: &str) -> Option<String> {
    let end = text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    (end > 0).then(|| text[..end].to_owned())
}

/// The first name of each part of a braced group that was opened before `group`.
fn leading_names(group: &str) -> Vec<String> {
    let (mut depth, mut names, mut at_start) = (0, Vec::new(), true);
    for (i, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => at_start = true,
            c if at_start && !c.is_whitespace() => {
                names.extend(identifier(&group[i..]));
                at_start = false;
            }
            _ => {}
        }
    }
    names
}

#[test]
fn the_scan_sees_plain_grouped_and_inline_names() {
    let code = "use crate::a::B;\nuse crate::{c::{D, E}, f};\nlet x = crate::g::h();";
    let expected = ["a", "c", "f", "g"].map(String::from);
    assert_eq!(named_after("crate::", code), BTreeSet::from(expected));
}

#[test]
fn modules_name_only_modules_below_them() {
    for (name, allowed) in LAYERS {
        for file in module(&source(), name) {
            for used in named_after("crate::", &code(&file)) {
                let fine = used == name || allowed.contains(&used.as_str());
                assert!(fine, "{} names crate::{used}; {name} may name {allowed:?}", file.display());
            }
        }
    }
}

#[test]
fn every_module_has_its_layer() {
    let library = std::fs::read_to_string(source().join("lib.rs")).unwrap();
    let modules = library.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'));
    for name in modules {
        assert!(LAYERS.iter().any(|(layer, _)| *layer == name), "{name} is not in tests/layers.rs");
        assert!(!module(&source(), name).is_empty(), "{name} has no files");
    }
}

#[test]
fn a_stage_knows_earlier_stages_only() {
    for (i, stage) in STAGES.iter().enumerate() {
        for file in module(&source().join("stages"), stage) {
            for used in named_after("crate::stages::", &code(&file)) {
                if let Some(other) = STAGES.iter().position(|name| *name == used) {
                    assert!(other <= i, "{} names the later stage {used}", file.display());
                }
            }
        }
    }
}

#[test]
fn stages_are_pure() {
    for file in files(&source().join("stages")) {
        let code = code(&file);
        for word in IMPURE {
            assert!(!code.contains(word), "{} names {word}", file.display());
        }
    }
}

#[test]
fn the_map_and_the_allocator_are_the_only_unsafe() {
    for file in files(&source()) {
        let blocks = code(&file).matches("unsafe {").count();
        let expected = [("store/reader.rs", 1), ("src/memory.rs", 5)].iter().find(|(name, _)| file.ends_with(name));
        assert_eq!(blocks, expected.map_or(0, |(_, blocks)| *blocks), "unsafe in {}", file.display());
    }
}
