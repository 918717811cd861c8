//! What each command does with its arguments. Results go to standard output, everything else to standard error.

pub mod align;
pub mod eval;
pub mod inspect;
mod log;
pub mod query;
pub mod run;
pub mod store;
pub mod symmetries;

use std::io::{ErrorKind, Write};
use std::path::Path;

use clap::CommandFactory;
use symalign::error::{Result, RunError};
use symalign::settings::{Profile, Settings};

use crate::cli::{Cli, Exit};

/// The settings file that is read when none is named.
const CONFIG: &str = "pipeline.toml";

/// The named settings file, else `pipeline.toml` if it is there, else the defaults.
fn settings(config: Option<&Path>, profile: Option<Profile>) -> Result<Settings> {
    match config {
        Some(path) => Settings::load(path, profile),
        None if Path::new(CONFIG).exists() => Settings::load(Path::new(CONFIG), profile),
        None => Ok(Settings::profile(profile.unwrap_or_default())),
    }
}

/// Prints results. A reader that has seen enough (`| head`) is no error.
fn print(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(RunError::file("standard output", error)),
        _ => Ok(()),
    }
}

/// Prints the completions for a shell.
pub fn completions(shell: clap_complete::Shell) -> Result<Exit> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "symalign", &mut script);
    print(&String::from_utf8_lossy(&script))?;
    Ok(Exit::Done)
}

/// Writes the manual pages into `dir`: symalign.1, symalign-run.1 and so on.
pub fn man(dir: &Path) -> Result<Exit> {
    let written = std::fs::create_dir_all(dir).and_then(|()| clap_mangen::generate_to(Cli::command(), dir));
    written.map_err(|e| RunError::file(dir, e))?;
    Ok(Exit::Done)
}
