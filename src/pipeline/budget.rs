//! Room in memory: a large model waits instead of adding to the peak.

use std::sync::{Condvar, Mutex, PoisonError};

/// Bytes of memory a model takes on its way, for each byte of its file: B-rep, mesh and samples. Measured on text of
/// analytic faces; an estimate is enough, since it only spreads large models over time.
const BYTES_PER_BYTE: u64 = 25;
/// And for any model: silhouettes, samples and queues.
const BASE: u64 = 8 << 20;
/// Where the machine does not tell its memory.
const FALLBACK: u64 = 4 << 30;

/// Memory for the models in flight.
pub struct Budget {
    total: u64,
    used: Mutex<u64>,
    freed: Condvar,
}

impl Budget {
    /// `megabytes` for all models together; 0: half of the machine's memory.
    pub fn new(megabytes: u64) -> Self {
        let total = if megabytes == 0 { machine_memory() / 2 } else { megabytes.saturating_mul(1 << 20) };
        Self { total, used: Mutex::new(0), freed: Condvar::new() }
    }

    /// Waits until there is room for a model whose file has `bytes` bytes; a model too large for all of the budget
    /// gets room when it is alone.
    pub fn take(&self, bytes: u64) {
        let need = need(bytes);
        let used = self.used.lock().unwrap_or_else(PoisonError::into_inner);
        let full = |used: &mut u64| *used > 0 && *used + need > self.total;
        let mut used = self.freed.wait_while(used, full).unwrap_or_else(PoisonError::into_inner);
        *used += need;
    }

    /// Gives the room back.
    pub fn give_back(&self, bytes: u64) {
        *self.used.lock().unwrap_or_else(PoisonError::into_inner) -= need(bytes);
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

    #[test]
    fn a_model_waits_until_there_is_room_and_a_giant_runs_alone() {
        let budget = Budget::new(20);
        budget.take(u32::MAX.into());
        let entered = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                budget.take(10);
                entered.store(true, Ordering::SeqCst);
            });
            std::thread::sleep(Duration::from_millis(20));
            assert!(!entered.load(Ordering::SeqCst));
            budget.give_back(u32::MAX.into());
        });
        budget.take(10);
        budget.give_back(10);
        budget.give_back(10);
        assert_eq!(*budget.used.lock().unwrap(), 0);
    }
}
