//! `run`: the main job.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use symalign::error::{Result, RunError};
use symalign::pipeline::{self, Progress, Report, Request};
use symalign::settings::Settings;

use super::CONFIG;
use crate::cli::{Exit, Run};

/// Reads the inputs into the store, and scores retrieval where there are labels.
pub fn run(args: &Run) -> Result<Exit> {
    let settings = ready(args)?;
    args.log.as_deref().map_or(Ok(()), super::log::to_file)?;
    let stop = Arc::new(AtomicBool::new(false));
    on_interrupt(Arc::clone(&stop))?;
    let request = Request {
        settings: &settings,
        shard: args.shard,
        fresh: args.fresh,
        retry_failed: args.retry_failed,
        stop: &stop,
    };
    pipeline::helpers(settings.busy_limit());
    let report =
        pipeline::run(&request, &mut Progress::for_stderr()).inspect_err(|error| how_to_go_on(error, &settings))?;
    eprintln!("{}", report.summary());
    if report.interrupted {
        eprintln!("interrupted; what is done is kept in {}: run the same command to go on", settings.store.display());
        return Ok(Exit::Interrupted);
    }
    score(&settings, args, &report)?;
    Ok(if args.strict && !report.failures.is_empty() { Exit::ModelFailed } else { Exit::Done })
}

/// After an error of a disk, what was done is still there.
fn how_to_go_on(error: &RunError, settings: &Settings) {
    let store = &settings.store;
    let of_store = matches!(error, RunError::File { path, .. } if path.starts_with(store));
    if of_store && symalign::store::journal_path(store).exists() {
        eprintln!(
            "stopped; what is done is kept in {}: when the cause is mended, run the same command to go on",
            store.display()
        );
    }
}

/// Ends a run with the report, where there are labels and this is the whole of the models.
fn score(settings: &Settings, args: &Run, report: &Report) -> Result<()> {
    match &settings.labels {
        Some(labels) if args.shard.is_none() && report.done > 0 => {
            super::eval::score(&settings.store, labels, &settings.report)
        }
        _ => Ok(()),
    }
}

/// The settings file with the command line over it.
fn ready(args: &Run) -> Result<Settings> {
    let named = args.config.is_some() || Path::new(CONFIG).exists();
    if args.input.is_empty() && !named {
        return Err(RunError::Usage(format!("name an input, or write a {CONFIG}; see symalign run --help")));
    }
    let mut settings = super::settings(args.config.as_deref(), args.profile)?;
    if !args.input.is_empty() {
        // The file's labels are those of the file's input.
        settings.labels = labels_inside(&args.input);
        settings.input.clone_from(&args.input);
    }
    if settings.input.is_empty() {
        return Err(RunError::Usage("the settings name no input".into()));
    }
    override_with(&mut settings, args);
    settings.check().map_err(RunError::Settings)?;
    check_labels(settings.labels.as_deref())?;
    Ok(settings)
}

/// Labels are read at the end of a run; that they are there is checked at its start.
fn check_labels(labels: Option<&Path>) -> Result<()> {
    match labels {
        Some(path) if path.as_os_str() != "parent-folder" => {
            std::fs::metadata(path).map(drop).map_err(|e| RunError::file(path, e))
        }
        _ => Ok(()),
    }
}

fn override_with(settings: &mut Settings, args: &Run) {
    if let Some(store) = &args.store {
        settings.store.clone_from(store);
    }
    if let Some(jobs) = args.jobs {
        settings.jobs = jobs.into();
    }
    if let Some(methods) = &args.method {
        settings.methods.clone_from(methods);
    }
    if let Some(out) = &args.out {
        settings.report.clone_from(out);
    }
    settings.labels = args.labels.clone().or(settings.labels.take());
    settings.random_pose = args.random_pose.or(settings.random_pose);
}

/// `labels.csv` in the only input, a folder.
fn labels_inside(input: &[PathBuf]) -> Option<PathBuf> {
    let [folder] = input else { return None };
    Some(folder.join("labels.csv")).filter(|path| path.is_file())
}

/// The first Ctrl-C or SIGTERM lets the run finish what is in flight, the second ends it.
fn on_interrupt(stop: Arc<AtomicBool>) -> Result<()> {
    let handler = move || {
        if stop.swap(true, Ordering::Relaxed) {
            // What was committed is on the disk; a torn record is cut off at the next start.
            std::process::exit(Exit::Interrupted.code().into());
        }
        pipeline::interrupted();
        eprintln!("finishing the models in flight; once more to stop now");
    };
    ctrlc::set_handler(handler).map_err(|e| RunError::Usage(format!("cannot listen for interrupts: {e}")))
}
