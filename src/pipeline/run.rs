//! A run: everything from the inputs to the published store.

use std::collections::{BTreeMap, HashSet};
use std::io;
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, RecvTimeoutError, bounded};

use super::budget::{Budget, allowed, memory_of};
use super::feed::{Feed, Manifest, Shard};
use super::line::Line;
use super::log::Log;
use super::parcel::{Parcel, Seconds};
use super::progress::{Progress, Snapshot};
use super::resume;
use super::worker::Bench;
use crate::error::{Result, RunError};
use crate::settings::Settings;
use crate::stages::Stage;
use crate::store::journal::Journal;
use crate::store::{Contents, Failure, Hash, ModelRecord, publish};

/// Outcomes that may wait for the disk, and how long: what a power cut can cost.
const GROUP: usize = 64;
const GROUP_TIME: Duration = Duration::from_secs(1);
/// Time between two looks at deadlines and progress.
pub const TICK: Duration = Duration::from_millis(50);
/// Models listed as slowest.
const SLOWEST: usize = 10;

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

/// How a run ended.
#[derive(Debug, Default)]
pub struct Report {
    /// Models of the inputs that the store has, computed now or earlier.
    pub done: usize,
    /// Models of the inputs that were lost, now or earlier, sorted by id.
    pub failures: Vec<Failure>,
    /// Models computed or lost in this run.
    pub computed: u64,
    /// Stopped from outside: nothing was published, all that is done is in the journal.
    pub interrupted: bool,
    /// What the user should know about the store.
    pub notes: Vec<String>,
    /// Seconds of computing in this run, by stage.
    pub seconds: Seconds,
    /// The models that took longest in this run, longest first: id and seconds.
    pub slowest: Vec<(String, f64)>,
    /// From start to end.
    pub elapsed: Duration,
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
    let mut collector = Collector::new(&mut opened.journal, &settings.store)?;
    let manifest = stream(request, progress, build, &mut collector)?;
    let mut report = std::mem::take(&mut collector.report);
    report.notes.append(&mut opened.notes);
    report.interrupted = !manifest.complete;
    settle(&manifest, &opened.journal, &mut report)?;
    if manifest.complete {
        publish_all(settings, &effective, manifest, &opened.journal, &report.failures)?;
    }
    report.elapsed = started.elapsed();
    Ok(report)
}

/// Sets up all threads, and collects on this one until the last parcel has come out.
fn stream(request: &Request, progress: &mut Progress, build: &Build, collector: &mut Collector) -> Result<Manifest> {
    let settings = request.settings;
    let bench = Bench::new(settings.busy_limit(), allowed(settings));
    let budget = Budget::new(settings.busy_limit(), memory_of(settings.limits.memory_mb));
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
    log: Log,
    last_commit: Instant,
    report: Report,
}

impl<'a> Collector<'a> {
    fn new(journal: &'a mut Journal, dir: &Path) -> Result<Self> {
        Ok(Self { journal, log: Log::open(dir)?, last_commit: Instant::now(), report: Report::default() })
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
        self.log.model(&job, load.as_ref().err())?;
        self.note_times(&job.id, &job.seconds());
        if self.journal.unsynced() >= GROUP || self.last_commit.elapsed() > GROUP_TIME {
            self.commit()?;
        }
        Ok(())
    }

    fn commit(&mut self) -> Result<()> {
        self.journal.commit()?;
        self.log.flush()?;
        self.last_commit = Instant::now();
        Ok(())
    }

    fn note_times(&mut self, id: &str, seconds: &Seconds) {
        let report = &mut self.report;
        report.computed += 1;
        report.seconds.iter_mut().zip(seconds).for_each(|(sum, s)| *sum += s);
        report.slowest.push((id.to_owned(), seconds.iter().sum()));
        report.slowest.sort_by(|a, b| b.1.total_cmp(&a.1));
        report.slowest.truncate(SLOWEST);
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

impl Report {
    /// The end of a run in words: counts, failures by reason, times by stage, slowest models.
    pub fn summary(&self) -> String {
        let mut lines = self.notes.clone();
        let elapsed = self.elapsed.as_secs_f64();
        lines.push(format!(
            "{} models done, {} failed; {} computed in {elapsed:.1} s",
            self.done,
            self.failures.len(),
            self.computed
        ));
        let mut reasons: BTreeMap<(Stage, &str), usize> = BTreeMap::new();
        for failure in &self.failures {
            *reasons.entry((failure.error.stage, &failure.error.why)).or_default() += 1;
        }
        let mut reasons: Vec<_> = reasons.into_iter().collect();
        reasons.sort_by_key(|((stage, why), count)| (std::cmp::Reverse(*count), *stage, why.to_owned()));
        lines.extend(
            reasons.iter().map(|((stage, why), count)| format!("  failed {count} times: {}: {why}", stage.name())),
        );
        if self.computed > 0 {
            let times = Stage::ALL.iter().zip(self.seconds).map(|(stage, s)| format!("{} {s:.1} s", stage.name()));
            lines.push(format!("computing time: {}", times.collect::<Vec<_>>().join(", ")));
            lines.push("slowest models:".into());
            lines.extend(self.slowest.iter().map(|(id, seconds)| format!("  {seconds:7.2} s  {id}")));
        }
        lines.join("\n")
    }
}
