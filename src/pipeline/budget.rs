//! Room in flight: so many models, and so much memory; a large model waits instead of adding to the peak.
//!
//! The queues alone could hold dozens of models. An interrupted run finishes what is in flight, so that has to be few.
//! Room is taken before a model is read, by its size, and again before it is computed, by what it will come to.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::machine;
use super::parcel::Allowed;
use crate::settings::Settings;

/// Bytes of memory a model takes on its way, for each byte of its file: B-rep, mesh and samples. Measured on text of
/// analytic faces; an estimate is enough, since what models really take is looked at, too.
const BYTES_PER_BYTE: u64 = 25;
/// And for any model: silhouettes, samples and queues.
const BASE: u64 = 8 << 20;

/// Models in flight for each that may be computed: one is computed on, one is at hand when that ends.
const MODELS_PER_PLACE: usize = 2;

/// The bytes that a setting in MB stands for; 0: half of what this process may use.
pub fn memory_of(megabytes: u64) -> u64 {
    if megabytes == 0 { machine::memory() / 2 } else { megabytes.saturating_mul(1 << 20) }
}

/// What one model may take.
pub fn allowed(settings: &Settings) -> Allowed {
    let limits = &settings.limits;
    let megabytes = if limits.model_memory_mb == 0 { limits.memory_mb } else { limits.model_memory_mb };
    Allowed { time: Duration::from_secs_f64(limits.seconds), memory: memory_of(megabytes) }
}

/// Room for the models in flight.
pub struct Budget {
    most_models: usize,
    most_bytes: u64,
    used: Mutex<Used>,
    freed: Condvar,
}

#[derive(Debug, Default, PartialEq)]
struct Used {
    models: usize,
    bytes: u64,
}

impl Budget {
    /// For `places` models computed at the same time, and `bytes` of memory for all models together.
    pub fn new(places: usize, bytes: u64) -> Self {
        let most_models = places.max(1) * MODELS_PER_PLACE;
        Self { most_models, most_bytes: bytes, used: Mutex::default(), freed: Condvar::new() }
    }

    /// Waits until `bytes` bytes can be read beside the models in flight, or none is left. `counted` tells what these
    /// really take.
    pub fn wait_to_read(&self, bytes: u64, counted: &dyn Fn() -> u64) {
        drop(self.wait(bytes, usize::MAX, counted));
    }

    /// Waits until there is room for a model whose file has `bytes` bytes, and takes it; a model too large for all of
    /// the budget gets room when it is alone.
    pub fn take(&self, bytes: u64, counted: &dyn Fn() -> u64) {
        let mut used = self.wait(need(bytes), self.most_models, counted);
        used.models += 1;
        used.bytes += need(bytes);
    }

    fn wait(&self, need: u64, most_models: usize, counted: &dyn Fn() -> u64) -> MutexGuard<'_, Used> {
        let used = self.used.lock().unwrap_or_else(PoisonError::into_inner);
        let full = |used: &mut Used| {
            let taken = used.bytes.max(counted());
            used.models >= most_models || (used.models > 0 && taken.saturating_add(need) > self.most_bytes)
        };
        self.freed.wait_while(used, full).unwrap_or_else(PoisonError::into_inner)
    }

    /// Gives the room back.
    pub fn give_back(&self, bytes: u64) {
        let mut used = self.used.lock().unwrap_or_else(PoisonError::into_inner);
        used.models -= 1;
        used.bytes -= need(bytes);
        self.freed.notify_all();
    }
}

fn need(bytes: u64) -> u64 {
    BASE.saturating_add(bytes.saturating_mul(BYTES_PER_BYTE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicBool, Ordering};

    const MB: u64 = 1 << 20;

    /// Whether `enter` has to wait until `free` was called.
    fn waits(enter: impl FnOnce() + Send, free: impl FnOnce()) -> bool {
        let entered = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                enter();
                entered.store(true, Ordering::SeqCst);
            });
            std::thread::sleep(Duration::from_millis(20));
            let waited = !entered.load(Ordering::SeqCst);
            free();
            waited
        })
    }

    #[test]
    fn a_model_waits_until_there_is_memory_and_a_giant_runs_alone() {
        let budget = Budget::new(8, 20 * MB);
        budget.take(u32::MAX.into(), &|| 0);
        assert!(waits(|| budget.take(10, &|| 0), || budget.give_back(u32::MAX.into())));
        budget.take(10, &|| 0);
        budget.give_back(10);
        budget.give_back(10);
        assert_eq!(*budget.used.lock().unwrap(), Used::default());
    }

    #[test]
    fn a_model_is_not_read_before_there_is_room() {
        let budget = Budget::new(8, 20 * MB);
        budget.wait_to_read(500 * MB, &|| 0);
        budget.take(10, &|| 0);
        budget.wait_to_read(11 * MB, &|| 0);
        assert!(waits(|| budget.wait_to_read(13 * MB, &|| 0), || budget.give_back(10)));
    }

    #[test]
    fn models_that_take_more_than_was_thought_keep_others_waiting() {
        let budget = Budget::new(8, 100 * MB);
        budget.take(10, &|| 0);
        assert!(waits(|| budget.take(10, &|| 95 * MB), || budget.give_back(10)));
    }

    #[test]
    fn no_more_than_two_models_for_each_place_are_in_flight() {
        let budget = Budget::new(1, 1000 * MB);
        budget.take(1, &|| 0);
        budget.take(1, &|| 0);
        assert!(waits(|| budget.take(1, &|| 0), || budget.give_back(1)));
    }
}
