//! What travels between the workers: a model's identity, and what the last stage made of it or why it failed.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::cancel::Cancel;
use crate::stages::{ModelError, Stage};
use crate::store::Hash;

/// A model on its way; a failure travels as data.
pub struct Parcel<T> {
    pub job: std::sync::Arc<Job>,
    pub load: Result<T, ModelError>,
}

/// One model's passage through the pipeline.
#[derive(Debug)]
pub struct Job {
    /// Position in the order of reading.
    pub number: u64,
    pub id: String,
    pub hash: Hash,
    /// Size of the file.
    pub bytes: u64,
    /// Tells the stages to stop.
    pub cancel: Cancel,
    clock: Mutex<Clock>,
}

/// Seconds a model took, stage by stage in the order of [`Stage::ALL`].
pub type Seconds = [f64; Stage::ALL.len()];

/// Seconds under the names of the stages.
pub fn by_stage(seconds: &Seconds) -> Value {
    let named = Stage::ALL.iter().zip(seconds).map(|(stage, s)| (stage.name().to_owned(), (*s).into()));
    Value::Object(named.collect())
}

#[derive(Debug, Default)]
struct Clock {
    spent: Seconds,
    running: Option<(Stage, Instant)>,
    /// Seconds of all stages at the last check, and how many of them were spent waiting for the machine.
    checked: f64,
    starved: f64,
    passed: Option<Passed>,
}

/// The largest share of the time on the clock that does not count as computing: what waits for nothing must end, too.
const MOST_STARVED: f64 = 0.9;

/// What one model may take.
#[derive(Clone, Copy, Debug)]
pub struct Allowed {
    /// Of computing in all stages together.
    pub time: Duration,
    /// Bytes of memory at the same time.
    pub memory: u64,
}

/// The limit that a model passed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Passed {
    Time,
    Memory,
}

impl Job {
    /// A model that has not started: its bytes are in memory.
    pub fn new(number: u64, id: String, hash: Hash, bytes: u64) -> Self {
        let cancel = Cancel::new();
        cancel.account().add(bytes);
        Self { number, id, hash, bytes, cancel, clock: Mutex::default() }
    }

    /// Takes over the memory that its file's bytes are in: all of it is on its account, not only what the bytes fill.
    #[allow(clippy::ptr_arg)] // A slice does not know its list's capacity.
    pub fn take_over(&self, file: &Vec<u8>) {
        self.cancel.account().add((file.capacity() - file.len()) as u64);
    }

    /// The seconds spent so far in stages that ended.
    pub fn seconds(&self) -> Seconds {
        self.clock().spent
    }

    /// Starts the clock of a stage.
    pub fn start(&self, stage: Stage) {
        self.clock().running = Some((stage, Instant::now()));
    }

    /// Stops the clock; the limit that the model had been found to pass.
    pub fn stop(&self) -> Option<Passed> {
        let mut clock = self.clock();
        if let Some((stage, since)) = clock.running.take() {
            clock.spent[stage as usize] += since.elapsed().as_secs_f64();
        }
        clock.passed
    }

    /// The stage that is working on the model, and the seconds of all its stages until now.
    pub fn running(&self) -> Option<(Stage, f64)> {
        let clock = self.clock();
        let (stage, since) = clock.running?;
        Some((stage, clock.spent.iter().sum::<f64>() + since.elapsed().as_secs_f64()))
    }

    /// Cancels the model if it is computed on and takes more than `allowed`. Since the last check the run was `starved`
    /// for some seconds, which do not count.
    pub fn check(&self, allowed: Allowed, starved: f64) {
        let Some((_, seconds)) = self.running() else { return };
        let starved = {
            let mut clock = self.clock();
            // No more than what passed for this model since then.
            clock.starved += starved.min(MOST_STARVED * (seconds - clock.checked).max(0.0));
            clock.checked = seconds;
            clock.starved
        };
        let passed = if seconds - starved > allowed.time.as_secs_f64() {
            Passed::Time
        } else if self.cancel.account().bytes() > allowed.memory {
            Passed::Memory
        } else {
            return;
        };
        self.clock().passed.get_or_insert(passed);
        self.cancel.cancel();
    }

    fn clock(&self) -> std::sync::MutexGuard<'_, Clock> {
        // A panic while the clock is held leaves numbers, no broken state.
        self.clock.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}
