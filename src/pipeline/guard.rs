//! Panics become failures of one model.

use std::any::Any;
use std::cell::{Cell, RefCell};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Once;

use crate::stages::{ModelError, Stage};

thread_local! {
    static GUARDED: Cell<bool> = const { Cell::new(false) };
    /// Where this thread last panicked.
    static PLACE: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Runs a step; a panic inside becomes an error of `stage` that tells where it happened.
pub fn guarded<T>(stage: Stage, step: impl FnOnce() -> Result<T, ModelError>) -> Result<T, ModelError> {
    silence();
    let before = GUARDED.replace(true);
    // The step owns or drops all that it could leave half done: nothing is looked at after a panic.
    let result = catch_unwind(AssertUnwindSafe(step));
    GUARDED.set(before);
    result.unwrap_or_else(|payload| {
        let place = PLACE.take().unwrap_or_else(|| "in a helper thread".into());
        Err(ModelError::new(stage, format!("a bug: panicked {place}: {}", message(&*payload))))
    })
}

/// Lets `count` threads help inside stages (rayon's), no more than models are computed at the same time. Their panics
/// reach the step that they help, and are told by its failure.
pub fn helpers(count: usize) {
    silence();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count).start_handler(|_| GUARDED.set(true));
    // An error means that there is a pool already, which does as well.
    let _ = pool.build_global();
}

fn message(payload: &dyn Any) -> &str {
    let owned = payload.downcast_ref::<String>().map(String::as_str);
    owned.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("no message")
}

/// Makes panics in guarded steps speak through their failure only; others are printed as ever.
fn silence() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let default = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if GUARDED.get() {
                PLACE.set(info.location().map(|place| format!("at {}:{}", place.file(), place.line())));
            } else {
                default(info);
            }
        }));
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_a_failure_that_tells_where() {
        let error = guarded::<()>(Stage::Merge, || panic!("no {}", "planes")).unwrap_err();
        assert_eq!(error.stage, Stage::Merge);
        assert!(error.why.contains("guard.rs:") && error.why.contains("no planes"), "{}", error.why);
        assert_eq!(guarded(Stage::Merge, || Ok(3)), Ok(3));
    }
}
