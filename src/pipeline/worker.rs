//! The one worker that runs all eight stages, and the bench where models are worked on.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use cpu_time::ProcessTime;
use crossbeam_channel::{Receiver, Sender, bounded};

use super::guard::guarded;
use super::parcel::{Allowed, Job, Parcel, Passed};
use super::shelf::Shelf;
use crate::stages::{ModelError, Scratch, Stage};

/// Takes parcels, works on those that have not failed, passes all of them on.
pub fn work<I, O>(
    stage: Stage,
    bench: &Bench,
    inbox: &Receiver<Parcel<I>>,
    outbox: &Sender<Parcel<O>>,
    step: &(dyn Fn(&Job, I, &mut Scratch) -> Result<O, ModelError> + Sync),
) {
    for Parcel { job, load } in inbox {
        let load = load.and_then(|input| bench.work_on(stage, &job, |scratch| step(&job, input, scratch)));
        if outbox.send(Parcel { job, load }).is_err() {
            return; // nobody downstream: stop quietly
        }
    }
}

/// Where models are worked on: so many at the same time, each within its limits.
pub struct Bench {
    /// One token for each model that may be worked on; taken and put back.
    permits: (Sender<()>, Receiver<()>),
    allowed: Allowed,
    busy: [AtomicUsize; Stage::ALL.len()],
    in_flight: Mutex<BTreeMap<u64, Arc<Job>>>,
    /// What steps work in, and what files are read into.
    pub scratch: Shelf<Scratch>,
    pub files: Shelf<Vec<u8>>,
    pace: Mutex<Pace>,
}

/// How much of the machine the run gets, from one look to the next.
struct Pace {
    wall: Instant,
    processor: ProcessTime,
}

impl Pace {
    fn start() -> Self {
        Self { wall: Instant::now(), processor: ProcessTime::now() }
    }

    /// Seconds since the last look in which the run had less than one processor: others were served first.
    fn starved(&mut self) -> f64 {
        let last = std::mem::replace(self, Self::start());
        let wall = (self.wall - last.wall).as_secs_f64();
        let computed = self.processor.duration_since(last.processor).as_secs_f64();
        (wall - computed).max(0.0)
    }
}

impl Bench {
    /// `places` models at the same time, to each what is `allowed`.
    pub fn new(places: usize, allowed: Allowed) -> Self {
        let permits = bounded(places.max(1));
        for _ in 0..places.max(1) {
            // There is room for each of them: the channel was made that large.
            let _ = permits.0.try_send(());
        }
        Self {
            permits,
            allowed,
            busy: Default::default(),
            in_flight: Mutex::default(),
            scratch: Shelf::default(),
            files: Shelf::default(),
            pace: Mutex::new(Pace::start()),
        }
    }

    /// Runs a step of a model when a place is free; panics and passed limits become failures.
    pub fn work_on<T>(
        &self,
        stage: Stage,
        job: &Job,
        step: impl FnOnce(&mut Scratch) -> Result<T, ModelError>,
    ) -> Result<T, ModelError> {
        let _permit = Permit::take(&self.permits);
        self.busy[stage as usize].fetch_add(1, Ordering::Relaxed);
        job.start(stage);
        let account = job.cancel.account();
        let result = account.within(|| {
            let mut scratch = self.scratch.lend(account);
            let made = guarded(stage, || step(&mut scratch))?;
            self.scratch.put_back(scratch, account);
            Ok(made)
        });
        let passed = job.stop();
        self.busy[stage as usize].fetch_sub(1, Ordering::Relaxed);
        passed.map_or(result, |passed| Err(self.failure(stage, passed)))
    }

    fn failure(&self, stage: Stage, passed: Passed) -> ModelError {
        let limit = match passed {
            Passed::Time => format!("time limit of {} s", self.allowed.time.as_secs_f64()),
            Passed::Memory => format!("memory limit of {} MB", self.allowed.memory >> 20),
        };
        ModelError::new(stage, format!("{limit} passed in stage {}", stage.name()))
    }

    /// A model sets out.
    pub fn enter(&self, job: &Arc<Job>) {
        self.jobs().insert(job.number, Arc::clone(job));
    }

    /// A model has arrived.
    pub fn leave(&self, job: &Job) {
        self.jobs().remove(&job.number);
    }

    /// Cancels the models that passed a limit.
    pub fn check_limits(&self) {
        // Two numbers: whole even if a holder panicked.
        let starved = self.pace.lock().unwrap_or_else(PoisonError::into_inner).starved();
        self.jobs().values().for_each(|job| job.check(self.allowed, starved));
    }

    /// Bytes that all models in flight take together, and those that are kept for the next ones.
    pub fn memory(&self) -> u64 {
        let taken: u64 = self.jobs().values().map(|job| job.cancel.account().bytes()).sum();
        taken + self.scratch.bytes() + self.files.bytes()
    }

    /// Cancels all models in flight.
    pub fn cancel_all(&self) {
        self.jobs().values().for_each(|job| job.cancel.cancel());
    }

    /// Workers of a stage that are computing.
    pub fn busy(&self, stage: Stage) -> usize {
        self.busy[stage as usize].load(Ordering::Relaxed)
    }

    /// The model that has been computed on longest: its id, stage and seconds.
    pub fn slowest(&self) -> Option<(String, Stage, f64)> {
        let jobs = self.jobs();
        let running = jobs.values().filter_map(|job| job.running().map(|(stage, seconds)| (job, stage, seconds)));
        let slowest = running.max_by(|a, b| a.2.total_cmp(&b.2));
        slowest.map(|(job, stage, seconds)| (job.id.clone(), stage, seconds))
    }

    fn jobs(&self) -> MutexGuard<'_, BTreeMap<u64, Arc<Job>>> {
        // The map is whole even if a holder panicked: each change is one call.
        self.in_flight.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A place at the bench, given back when dropped.
struct Permit<'a>(&'a Sender<()>);

impl<'a> Permit<'a> {
    fn take((back, tokens): &'a (Sender<()>, Receiver<()>)) -> Self {
        // Cannot fail: the bench holds both ends.
        let _ = tokens.recv();
        Self(back)
    }
}

impl Drop for Permit<'_> {
    fn drop(&mut self) {
        // Cannot fail or wait: the token that was taken left its room.
        let _ = self.0.try_send(());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn bench(places: usize, seconds: f64) -> Bench {
        Bench::new(places, Allowed { time: Duration::from_secs_f64(seconds), memory: 1 << 20 })
    }

    fn job(number: u64) -> Arc<Job> {
        Arc::new(Job::new(number, format!("model {number}"), [0; 32], 0))
    }

    #[test]
    fn failures_pass_through_and_panics_become_failures() {
        let bench = bench(2, 60.0);
        let (feed, inbox) = bounded(8);
        let (outbox, results) = bounded(8);
        for (number, load) in [(0, Ok(4)), (1, Err(ModelError::new(Stage::Parse, "torn"))), (2, Ok(0)), (3, Ok(6))] {
            feed.send(Parcel { job: job(number), load }).unwrap();
        }
        drop(feed);
        work(Stage::Merge, &bench, &inbox, &outbox, &|_, divisor: i32, _| Ok(12 / divisor));
        let loads: Vec<_> = results.try_iter().map(|parcel| parcel.load).collect();
        assert_eq!((&loads[0], &loads[3]), (&Ok(3), &Ok(2)));
        assert_eq!(loads[1], Err(ModelError::new(Stage::Parse, "torn")));
        let bug = loads[2].as_ref().unwrap_err();
        assert!(bug.stage == Stage::Merge && bug.why.contains("divide by zero"), "{bug}");
    }

    #[test]
    fn no_more_models_are_worked_on_than_there_are_places() {
        let bench = bench(2, 60.0);
        let (now, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
        std::thread::scope(|scope| {
            for number in 0..8 {
                let (bench, now, most) = (&bench, &now, &most);
                scope.spawn(move || {
                    bench.work_on(Stage::Parse, &job(number), |_| {
                        most.fetch_max(now.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
                        std::thread::sleep(Duration::from_millis(5));
                        now.fetch_sub(1, Ordering::SeqCst);
                        Ok(())
                    })
                });
            }
        });
        assert_eq!(most.into_inner(), 2);
    }

    /// What a model fails with that goes on until it is cancelled, and takes memory after the first check.
    fn failure_of_endless_work(bench: &Bench, bytes: u64) -> String {
        let endless = job(0);
        bench.enter(&endless);
        let result = std::thread::scope(|scope| {
            let worker = scope.spawn(|| {
                bench.work_on(Stage::Validate, &endless, |_| {
                    endless.cancel.account().add(bytes);
                    let end = Instant::now() + Duration::from_secs(20);
                    while Instant::now() < end {
                        endless.cancel.check().map_err(|c| ModelError::cancelled(Stage::Validate, c))?;
                        std::thread::sleep(Duration::from_millis(1));
                    }
                    Ok(())
                })
            });
            while !worker.is_finished() {
                bench.check_limits();
                std::thread::sleep(Duration::from_millis(1));
            }
            worker.join().unwrap()
        });
        result.unwrap_err().why
    }

    #[test]
    fn a_model_that_takes_too_much_is_cancelled_and_fails_with_the_limit() {
        assert_eq!(failure_of_endless_work(&bench(1, 0.02), 10), "time limit of 0.02 s passed in stage validate");
        let too_large = failure_of_endless_work(&bench(1, 15.0), (1 << 20) + 1);
        assert_eq!(too_large, "memory limit of 1 MB passed in stage validate");
    }
}
