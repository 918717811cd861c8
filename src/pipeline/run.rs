//! A run: everything from the inputs to the published store.

use std::collections::HashSet;
use std::io;
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, RecvTimeoutError, bounded};

use super::budget::{Budget, allowed, memory_of};
use super::feed::{Feed, Manifest, Shard};
use super::line::Line;
use super::log;
use super::parcel::Parcel;
use super::progress::{Progress, Snapshot};
use super::report::{Report, peak_memory};
use super::resume;
use super::worker::Bench;
use crate::error::{Result, RunError};
use crate::settings::Settings;
use crate::store::journal::Journal;
use crate::store::{Contents, Failure, Hash, ModelRecord, Store, publish};

/// Outcomes that may wait for the disk, and how long: what a power cut can cost.
const GROUP: usize = 64;
const GROUP_TIME: Duration = Duration::from_secs(1);
/// Time between two looks at deadlines and progress.
pub const TICK: Duration = Duration::from_millis(50);

/// What is asked of a run.
pub struct Request<'a> {
    /// Input, store, methods, limits, thresholds.
    pub settings: &'a Settings,
    /// The part of the inputs to take.
    pub shard: Option<Shard>,
    /// Start over, removing what the store holds.
    pub fresh: bool,
    /// Compute again what failed in an earlier run.
    pub retry_failed: bool,
    /// Set from outside: finish what is in flight, and stop.
    pub stop: &'a AtomicBool,
}

/// Counts that several threads keep.
#[derive(Default)]
pub struct Counters {
    pub found: AtomicU64,
    pub known: AtomicU64,
    pub done: AtomicU64,
    pub failed: AtomicU64,
    pub bytes: AtomicU64,
}

/// Makes the line of workers that a run sends its models down.
pub type Build<'b> = dyn for<'s, 'e> Fn(Line<'s, 'e, Vec<u8>>) -> io::Result<Line<'s, 'e, ModelRecord>> + 'b;

/// Reads the inputs of `request`, sends the models through the eight stages, keeps the outcomes and publishes.
///
/// Errors: see [`crate::error`]; what is done stays in the journal.
pub fn run(request: &Request, progress: &mut Progress) -> Result<Report> {
    run_with(request, progress, &|line| super::plan::stages(line))
}

/// [`run`] with other workers, for tests.
pub fn run_with(request: &Request, progress: &mut Progress, build: &Build) -> Result<Report> {
    let started = Instant::now();
    let settings = request.settings;
    let effective = settings.effective()?;
    let mut opened = resume::open(&settings.store, &effective, request.fresh)?;
    log::started(request, &effective);
    let mut collector = Collector::new(&mut opened.journal);
    let manifest = stream(request, progress, build, &mut collector)?;
    if manifest.is_empty() && request.shard.is_none() {
        let why = "no model in the input (files named .step .stp .p21 .igs .iges .brep, archives of them); the store is as it was";
        return Err(RunError::Usage(why.into()));
    }
    let mut report = std::mem::take(&mut collector.report);
    report.notes.append(&mut opened.notes);
    report.interrupted = !manifest.complete;
    manifest.unreadable.iter().for_each(log::unreadable);
    settle(&manifest, &opened.journal, &mut report)?;
    if manifest.complete {
        report.notes.extend(no_longer_listed(&settings.store, &manifest));
        publish_all(settings, &effective, manifest, &opened.journal, &report.failures)?;
    }
    report.peak_memory = peak_memory();
    report.elapsed = started.elapsed();
    log::ended(&report);
    Ok(report)
}

/// A store lists the models of its last input: what that costs is said, for a wrong path must not empty it in silence.
fn no_longer_listed(store: &Path, manifest: &Manifest) -> Option<String> {
    let published = Store::open(store).ok()?;
    let ids: HashSet<&str> = manifest.models.iter().map(|(id, _)| id.as_str()).collect();
    let gone = (0..published.len()).filter(|&i| !ids.contains(published.id(i))).count();
    let why = "are not in this input and no longer listed; what was computed is kept in the journal";
    (gone > 0).then(|| format!("{gone} models of the store {why}"))
}

/// Places at the bench for so many models computed at the same time: a few more where there are several, for eight times
/// on its way a model waits for a worker to wake up, and with it a processor. Two more for two, three more for eight.
fn places(jobs: usize) -> usize {
    if jobs > 1 { jobs + 1 + jobs.div_ceil(4) } else { 1 }
}

/// Sets up all threads, and collects on this one until the last parcel has come out.
fn stream(request: &Request, progress: &mut Progress, build: &Build, collector: &mut Collector) -> Result<Manifest> {
    let settings = request.settings;
    let places = places(settings.busy_limit());
    let bench = Bench::new(places, allowed(settings));
    let budget = Budget::new(places, memory_of(settings.limits.memory_mb));
    let counters = Counters::default();
    let known = collector.known(request.retry_failed);
    std::thread::scope(|scope| {
        let (outbox, line) = Line::new(scope, &bench, settings);
        let no_threads = |e| RunError::Usage(format!("cannot start the workers: {e}"));
        let (results, queues) = build(line).map_err(no_threads)?.finish();
        let (finished, watching) = bounded::<()>(0);
        let (bench, budget, counters) = (&bench, &budget, &counters);
        scope.spawn(move || watch(&watching, progress, bench, counters, request, &queues));
        let (shard, stop) = (request.shard, request.stop);
        let feed = Feed { settings, shard, known, budget, bench, counters, stop };
        let feeder = scope.spawn(move || feed.run(&outbox));
        let collected = collector.drain(&results, bench, budget, counters, request.stop);
        drop(finished);
        let manifest = feeder.join().unwrap_or_else(|_| Err(RunError::Usage("a bug: the reader panicked".into())));
        collected.and(manifest)
    })
}

/// Looks after deadlines and progress until the run is over.
fn watch(
    over: &Receiver<()>,
    progress: &mut Progress,
    bench: &Bench,
    counters: &Counters,
    request: &Request,
    queues: &[super::line::Queue],
) {
    let started = Instant::now();
    let total = OnceLock::new();
    let count = || {
        let (models, all) = crate::archive::count(&request.settings.input);
        total.get_or_init(|| (all && request.shard.is_none()).then_some(models as u64));
    };
    std::thread::scope(|scope| {
        // Beside, since a large folder takes its time and the limits of models do not wait.
        scope.spawn(count);
        while over.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
            bench.check_limits();
            let load = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
            progress.show(&Snapshot {
                found: load(&counters.found),
                total: total.get().copied().flatten(),
                done: load(&counters.done),
                failed: load(&counters.failed),
                known: load(&counters.known),
                bytes: load(&counters.bytes),
                elapsed: started.elapsed(),
                stages: queues.iter().map(|(stage, length)| (*stage, bench.busy(*stage), length())).collect(),
                slowest: bench.slowest(),
            });
        }
        progress.finish();
    });
}

/// The other end: keeps outcomes.
struct Collector<'a> {
    journal: &'a mut Journal,
    last_commit: Instant,
    report: Report,
}

impl<'a> Collector<'a> {
    fn new(journal: &'a mut Journal) -> Self {
        Self { journal, last_commit: Instant::now(), report: Report::default() }
    }

    fn known(&self, retry_failed: bool) -> HashSet<Hash> {
        self.journal.outcomes().filter(|(_, done)| *done || !retry_failed).map(|(hash, _)| *hash).collect()
    }

    /// Takes all parcels. After an error of the disk it stops the run and lets the rest pass.
    fn drain(
        &mut self,
        results: &Receiver<Parcel<ModelRecord>>,
        bench: &Bench,
        budget: &Budget,
        counters: &Counters,
        stop: &AtomicBool,
    ) -> Result<()> {
        let mut state = Ok(());
        for parcel in results {
            bench.leave(&parcel.job);
            budget.give_back(parcel.job.bytes);
            counters.bytes.fetch_add(parcel.job.bytes, Ordering::Relaxed);
            let counter = if parcel.load.is_ok() { &counters.done } else { &counters.failed };
            counter.fetch_add(1, Ordering::Relaxed);
            if state.is_ok() {
                state = self.keep(parcel);
            }
            if state.is_err() {
                stop.store(true, Ordering::Relaxed);
                bench.cancel_all();
            }
        }
        state.and_then(|()| self.commit())
    }

    fn keep(&mut self, parcel: Parcel<ModelRecord>) -> Result<()> {
        let Parcel { job, load } = parcel;
        self.journal.append(&job.hash, &load)?;
        log::model(&job, &load);
        self.report.note(&job);
        if self.journal.unsynced() >= GROUP || self.last_commit.elapsed() > GROUP_TIME {
            self.commit()?;
        }
        Ok(())
    }

    fn commit(&mut self) -> Result<()> {
        let outcomes = self.journal.unsynced();
        self.journal.commit()?;
        log::committed(outcomes);
        self.last_commit = Instant::now();
        Ok(())
    }
}

/// Counts what the store knows of the models met, and lists the failures.
fn settle(manifest: &Manifest, journal: &Journal, report: &mut Report) -> Result<()> {
    report.failures = manifest.unreadable.clone();
    for (id, hash) in &manifest.models {
        match journal.knows(hash) {
            Some(true) => report.done += 1,
            Some(false) => {
                if let Some(Err(error)) = journal.outcome(hash)? {
                    report.failures.push(Failure { id: id.clone(), hash: Some(*hash), error });
                }
            }
            None => {}
        }
    }
    report.failures.sort_by(|a, b| a.id.cmp(&b.id));
    Ok(())
}

fn publish_all(
    settings: &Settings,
    effective: &str,
    manifest: Manifest,
    journal: &Journal,
    failures: &[Failure],
) -> Result<()> {
    let models = manifest.models.into_iter().filter(|(_, hash)| journal.knows(hash) == Some(true)).collect();
    let contents = Contents { settings: effective, methods: &settings.methods, models, failures: failures.to_vec() };
    publish(&settings.store, contents, &mut |id, hash| match journal.outcome(hash)? {
        Some(Ok(record)) => Ok(record),
        _ => Err(RunError::Store { path: settings.store.clone(), why: format!("the journal lost {id}") }),
    })
}
