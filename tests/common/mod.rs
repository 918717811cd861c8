//! What the whole-program tests share: the program, and a small archive of labelled models.
#![allow(dead_code)] // each test program uses its part

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Models of `data-samples` that are read quickly: two classes of two, and two models alone.
pub const MODELS: [&str; 6] = [
    "airplane/glider-v-tail.step",
    "boat/canoe.step",
    "household/bottle.step",
    "household/stool.step",
    "machinery/bracket.step",
    "machinery/hexagon-bolt.step",
];

/// A command of the program, in the folder `dir`.
pub fn symalign(dir: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_symalign"));
    command.current_dir(dir).args(args);
    command
}

/// Runs a command to its end.
pub fn run(dir: &Path, args: &[&str]) -> Output {
    symalign(dir, args).output().unwrap()
}

/// The exit code of a command that must end by itself.
pub fn code(output: &Output) -> i32 {
    output.status.code().unwrap_or_else(|| panic!("ended by a signal: {output:?}"))
}

/// Standard error as text.
pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Standard output as text.
pub fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Copies [`MODELS`], with their labels and a file that is no model, into `dir/models`.
pub fn archive(dir: &Path) -> PathBuf {
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("data-samples");
    let folder = dir.join("models");
    let mut labels = "path,category\n".to_owned();
    for model in MODELS {
        let (class, _) = model.split_once('/').unwrap();
        std::fs::create_dir_all(folder.join(class)).unwrap();
        std::fs::copy(samples.join(model), folder.join(model)).unwrap();
        labels += &format!("{model},{class}\n");
    }
    std::fs::write(folder.join("broken.step"), "ISO-10303-21; nothing of the kind").unwrap();
    std::fs::write(folder.join("labels.csv"), labels).unwrap();
    folder
}

/// The published bytes of a store.
pub fn published(store: &Path) -> Vec<u8> {
    std::fs::read(store.join("models.symalign")).unwrap()
}

/// A STEP file that holds the contents of `text` so many times: the numbers of the entities are shifted.
pub fn copies(text: &str, count: usize) -> String {
    let (head, rest) = text.split_once("DATA;").unwrap();
    let (data, tail) = rest.split_once("ENDSEC;").unwrap();
    let mut pieces = data.split('#');
    let first = pieces.next().unwrap();
    let numbered = |piece: &'_ str| {
        let digits = piece.bytes().take_while(u8::is_ascii_digit).count();
        (piece[..digits].parse::<usize>().unwrap(), piece[digits..].to_owned())
    };
    let pieces: Vec<_> = pieces.map(numbered).collect();
    let stride = pieces.iter().map(|(number, _)| number).max().unwrap() + 1;
    let mut all = format!("{head}DATA;{first}");
    for copy in 0..count {
        pieces.iter().for_each(|(number, rest)| all += &format!("#{}{rest}", number + copy * stride));
    }
    all + "ENDSEC;" + tail
}
