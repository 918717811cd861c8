//! The lesser and the larger of two numbers.
//!
//! `f64::min` and `max` look for what is no number; where all are, comparing is all there is to it.

/// The lesser one.
#[inline]
pub fn less(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The larger one.
#[inline]
pub fn more(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
