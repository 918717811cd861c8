//! The lesser and the larger of two numbers, and three things in order.
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

/// Three things, that with the least key first; those with equal ones stay in their order.
#[inline]
pub fn ascending<T>([mut a, mut b, mut c]: [T; 3], key: impl Fn(&T) -> f64) -> [T; 3] {
    if key(&b) < key(&a) {
        (a, b) = (b, a);
    }
    if key(&c) < key(&b) {
        (b, c) = (c, b);
        if key(&b) < key(&a) {
            (a, b) = (b, a);
        }
    }
    [a, b, c]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_things_come_in_order_whatever_theirs_was() {
        for [a, b, c] in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
            assert_eq!(ascending([a, b, c], |&i| f64::from(i)), [0, 1, 2]);
        }
        assert_eq!(ascending(["bc", "a", "de"], |word| word.len() as f64), ["a", "bc", "de"]);
    }
}
