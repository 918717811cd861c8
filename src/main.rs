//! Arguments -> settings -> call -> exit code.

mod cli;
mod commands;

use std::alloc::System;
use std::process::ExitCode;

use clap::Parser;
use symalign::memory::Counting;

use cli::{Cli, Command, Exit};

/// Counts what each model takes, for the setting `limits.model_memory_mb`.
#[global_allocator]
static MEMORY: Counting<System> = Counting(System);

fn main() -> ExitCode {
    symalign::memory::give_back_large_pieces();
    let ended = match Cli::parse().command {
        Command::Run(args) => commands::run::run(&args),
        Command::Eval(args) => commands::eval::eval(&args),
        Command::Query(args) => commands::query::query(&args),
        Command::Inspect(args) => commands::inspect::inspect(&args),
        Command::Align(args) => commands::align::align(&args),
        Command::Store(args) => commands::store::store(&args),
        Command::Symmetries(args) => commands::symmetries::symmetries(&args),
        Command::Man { dir } => commands::man(&dir),
        Command::Completions { shell } => commands::completions(shell),
    };
    let exit = ended.unwrap_or_else(|error| {
        eprintln!("symalign: {error}");
        Exit::CannotRun
    });
    ExitCode::from(exit.code())
}
