//! Room in flight: so many models, and so much memory; a large model waits instead of adding to the peak.
//!
//! The queues alone could hold dozens of models. An interrupted run finishes what is in flight, so that has to be few.

use std::sync::{Condvar, Mutex, PoisonError};

/// Bytes of memory a model takes on its way, for each byte of its file: B-rep, mesh and samples. Measured on text of
/// analytic faces; an estimate is enough, since it only spreads large models over time.
const BYTES_PER_BYTE: u64 = 25;
/// And for any model: silhouettes, samples and queues.
const BASE: u64 = 8 << 20;
/// Where the machine does not tell its memory.
const FALLBACK: u64 = 4 << 30;

/// Models in flight for each that may be computed: one is computed on, one is at hand when that ends.
const MODELS_PER_PLACE: usize = 2;

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
    /// For `places` models computed at the same time, and `megabytes` for all models together; 0: half of the
    /// machine's memory.
    pub fn new(places: usize, megabytes: u64) -> Self {
        let most_bytes = if megabytes == 0 { machine_memory() / 2 } else { megabytes.saturating_mul(1 << 20) };
        let most_models = places.max(1) * MODELS_PER_PLACE;
        Self { most_models, most_bytes, used: Mutex::default(), freed: Condvar::new() }
    }

    /// Waits until there is room for a model whose file has `bytes` bytes; a model too large for all of the budget
    /// gets room when it is alone.
    pub fn take(&self, bytes: u64) {
        let need = need(bytes);
        let used = self.used.lock().unwrap_or_else(PoisonError::into_inner);
        let full = |used: &mut Used| {
            used.models >= self.most_models || (used.models > 0 && used.bytes + need > self.most_bytes)
        };
        let mut used = self.freed.wait_while(used, full).unwrap_or_else(PoisonError::into_inner);
        used.models += 1;
        used.bytes += need;
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
    BASE + bytes * BYTES_PER_BYTE
}

/// Physical memory in bytes, from `/proc/meminfo`.
fn machine_memory() -> u64 {
    let text = std::fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let kilobytes =
        text.lines().find_map(|line| line.strip_prefix("MemTotal:")?.trim().strip_suffix(" kB")?.parse().ok());
    kilobytes.map_or(FALLBACK, |kb: u64| kb * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::time::Duration;

    /// Whether taking room for `bytes` has to wait until `free` was called.
    fn waits(budget: &Budget, bytes: u64, free: impl FnOnce()) -> bool {
        let entered = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                budget.take(bytes);
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
        let budget = Budget::new(8, 20);
        budget.take(u32::MAX.into());
        assert!(waits(&budget, 10, || budget.give_back(u32::MAX.into())));
        budget.take(10);
        budget.give_back(10);
        budget.give_back(10);
        assert_eq!(*budget.used.lock().unwrap(), Used::default());
    }

    #[test]
    fn no_more_than_two_models_for_each_place_are_in_flight() {
        let budget = Budget::new(1, 1000);
        budget.take(1);
        budget.take(1);
        assert!(waits(&budget, 1, || budget.give_back(1)));
    }
}
