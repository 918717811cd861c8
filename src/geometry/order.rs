//! The lesser and the larger of two numbers.
//!
//! `min` and `max` look for what is no number; where all are, comparing is all there is to it, one instruction.

/// The lesser one.
#[inline]
pub fn less<T: PartialOrd>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

/// The larger one.
#[inline]
pub fn more<T: PartialOrd>(a: T, b: T) -> T {
    if a > b { a } else { b }
}
