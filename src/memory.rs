//! How much memory the work on each model takes: counted where memory is given out.
//!
//! A program that makes [`Counting`] its global allocator can ask an [`Account`] what the threads that work on a model
//! have taken and not given back; elsewhere all accounts say what was put on them only. A stage that lets other
//! threads help wraps their part in [`Account::within`]. Each thread keeps up to 64 kB to itself until its part is done.
//!
//! This holds the uses of `unsafe` of the crate beside the store's map: an allocator cannot be written, nor the
//! system's be told anything, without. Cost: two additions of the thread's own for each piece of memory.

use std::alloc::{GlobalAlloc, Layout};
use std::cell::Cell;
use std::sync::atomic::{AtomicBool, AtomicI64, Ordering};

/// Accounts there are: two models in flight for each core of the largest machines. Models beyond are not counted.
const ACCOUNTS: usize = 1024;

/// A counter on a cache line of its own: each is written by another thread.
#[repr(align(128))]
struct Counter {
    taken: AtomicBool,
    bytes: AtomicI64,
}

static COUNTERS: [Counter; ACCOUNTS] =
    [const { Counter { taken: AtomicBool::new(false), bytes: AtomicI64::new(0) } }; ACCOUNTS];

/// The place of [`COUNTERS`] that stands for no account.
const NOBODY: usize = usize::MAX;

/// What a thread has taken or given back, bytes, before it says so: the counter is asked a few times a second, and to
/// write it for each piece of memory is as slow as to find the piece.
const UNSAID: i64 = 64 << 10;

thread_local! {
    /// The account that this thread works for, and what is not yet on it.
    static CURRENT: Cell<(usize, i64)> = const { Cell::new((NOBODY, 0)) };
}

/// The memory that one model takes; free for another one when dropped.
#[derive(Debug)]
pub struct Account(usize);

impl Default for Account {
    fn default() -> Self {
        Self::open()
    }
}

impl Account {
    /// An account that nobody else has, with nothing on it.
    pub fn open() -> Self {
        let free = |counter: &Counter| {
            counter.taken.compare_exchange(false, true, Ordering::AcqRel, Ordering::Relaxed).is_ok()
        };
        let place = COUNTERS.iter().position(free).unwrap_or(NOBODY);
        let account = Self(place);
        if let Some(counter) = account.counter() {
            counter.bytes.store(0, Ordering::Relaxed);
        }
        account
    }

    /// Puts memory on the account that was taken before it was opened.
    pub fn add(&self, bytes: u64) {
        if let Some(counter) = self.counter() {
            counter.bytes.fetch_add(bytes as i64, Ordering::Relaxed);
        }
    }

    /// Takes memory off the account that is still there, but for others now.
    pub fn remove(&self, bytes: u64) {
        if let Some(counter) = self.counter() {
            counter.bytes.fetch_sub(bytes as i64, Ordering::Relaxed);
        }
    }

    /// Bytes taken and not given back.
    pub fn bytes(&self) -> u64 {
        self.counter().map_or(0, |counter| counter.bytes.load(Ordering::Relaxed).max(0) as u64)
    }

    /// Does work that counts on this account, on whatever thread.
    pub fn within<T>(&self, work: impl FnOnce() -> T) -> T {
        let _back = Back(say(self.0));
        work()
    }

    fn counter(&self) -> Option<&'static Counter> {
        COUNTERS.get(self.0)
    }
}

impl Drop for Account {
    fn drop(&mut self) {
        if let Some(counter) = self.counter() {
            counter.taken.store(false, Ordering::Release);
        }
    }
}

/// Makes a thread work for the account it worked for before, also after a panic.
struct Back(usize);

impl Drop for Back {
    fn drop(&mut self) {
        say(self.0);
    }
}

/// Puts on the thread's account what is not yet there, and makes the thread work for another one; the one before.
fn say(next: usize) -> usize {
    let (place, unsaid) = CURRENT.replace((next, 0));
    if let Some(counter) = COUNTERS.get(place) {
        counter.bytes.fetch_add(unsaid, Ordering::Relaxed);
    }
    place
}

/// Bytes that a list holds, also where it is empty; what its items hold themselves is not counted.
#[allow(clippy::ptr_arg)] // A slice does not know its list's capacity.
pub fn held<T>(list: &Vec<T>) -> usize {
    list.capacity() * size_of::<T>()
}

/// Bytes of a piece of memory that is kept for other models at most: what a model of some thousand faces takes. What a
/// large one took is given back.
pub const MOST_KEPT: usize = 2 << 20;

/// Empties a list and makes room for so many items. What was in it is not moved to where there is room.
pub fn empty<T>(list: &mut Vec<T>, items: usize) {
    list.clear();
    if list.capacity() < items {
        *list = Vec::new();
        list.reserve_exact(items);
    }
}

/// A list whose memory others will use, or an empty one where it is too large to be kept.
pub fn kept<T>(list: Vec<T>) -> Vec<T> {
    if held(&list) > MOST_KEPT { Vec::new() } else { list }
}

/// An allocator, counting.
pub struct Counting<A>(pub A);

fn count(bytes: i64) {
    let (place, unsaid) = CURRENT.get();
    CURRENT.set((place, unsaid + bytes));
    if (unsaid + bytes).abs() > UNSAID {
        say(place);
    }
}

/// From this size on, bytes, a piece of memory is the system's again as soon as it is free. Smaller ones are taken and
/// given back for every model: asking the system for them would cost a tenth of the time.
#[cfg(target_env = "gnu")]
const LARGE: i32 = 4 << 20;

/// Places for each core that threads take memory from.
#[cfg(target_env = "gnu")]
const PLACES: usize = 2;

/// Has large pieces of memory given back as soon as they are free. Left alone, glibc keeps for each thread that once
/// freed a large piece pieces of up to that size, and a run of large models comes to twice the memory.
pub fn give_back_large_pieces() {
    // SAFETY: sets three numbers of the allocator.
    #[cfg(target_env = "gnu")]
    #[allow(unsafe_code)]
    unsafe {
        libc::mallopt(libc::M_MMAP_THRESHOLD, LARGE);
        libc::mallopt(libc::M_TRIM_THRESHOLD, 4 * LARGE);
        // Places that threads take memory from. What one stage takes another gives back: a few places keep less memory
        // than one for each thread, but where there is only one for each core, threads wait for each other.
        let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        libc::mallopt(libc::M_ARENA_MAX, (PLACES * cores.min(1024)) as i32);
    }
}

// SAFETY: every call is passed on to the other allocator as it came; counting takes no memory and cannot panic (the
// thread's variable has no destructor and is there from the thread's start to its end).
#[allow(unsafe_code)]
unsafe impl<A: GlobalAlloc> GlobalAlloc for Counting<A> {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as i64);
        unsafe { self.0.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as i64);
        unsafe { self.0.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        count(-(layout.size() as i64));
        unsafe { self.0.dealloc(memory, layout) }
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(size as i64 - layout.size() as i64);
        unsafe { self.0.realloc(memory, layout, size) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::alloc::System;

    /// Takes and gives back through the counting allocator, which is not the test program's.
    fn taken(bytes: usize) -> impl FnOnce() {
        let layout = Layout::array::<u8>(bytes).unwrap();
        // SAFETY: the layout is not empty, and what is given back was taken with it.
        #[allow(unsafe_code)]
        let memory = unsafe { Counting(System).alloc(layout) } as usize;
        move || {
            #[allow(unsafe_code)]
            unsafe {
                Counting(System).dealloc(memory as *mut u8, layout);
            }
        }
    }

    #[test]
    fn each_account_holds_what_was_taken_for_it() {
        let (a, b) = (Account::open(), Account::open());
        let give_back = a.within(|| taken(1000));
        let _kept = b.within(|| std::thread::scope(|scope| scope.spawn(|| a.within(|| taken(50))).join().unwrap()));
        assert_eq!((a.bytes(), b.bytes()), (1050, 0));
        taken(7)();
        a.within(give_back);
        a.add(5);
        a.remove(2);
        assert_eq!(a.bytes(), 53);
        assert_eq!(b.within(|| a.within(|| CURRENT.get().0)), a.0);
        assert_eq!(CURRENT.get().0, NOBODY);
    }

    #[test]
    fn an_account_is_free_again_and_empty() {
        let first = Account::open();
        first.add(10);
        let place = first.0;
        drop(first);
        let later: Vec<_> = (0..50).map(|_| Account::open()).collect();
        let again = later.iter().find(|account| account.0 == place);
        // Tests that run beside this one may have taken it.
        assert!(again.is_none_or(|account| account.bytes() == 0));
    }
}
