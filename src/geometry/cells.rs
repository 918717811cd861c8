//! Cells of width 1 in a row: pixels, samples, slices.

/// The first of `count` cells whose centre (at halves) is not before `c`; `count` if there is none.
#[inline]
pub fn first_centre(c: f64, count: usize) -> usize {
    // Not by `ceil`: that is a call of the C library on processors without SSE 4.1.
    let from_first = (c - 0.5).clamp(0.0, count as f64);
    // Nor by 64 bits: those take several instructions each way.
    let whole = from_first as u32;
    whole as usize + usize::from(f64::from(whole) < from_first)
}

/// The centre of a cell.
#[inline]
pub fn centre(cell: usize) -> f64 {
    f64::from(cell as u32) + 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centres_lie_at_halves() {
        let first = [-3.0, 0.5, 0.50001, 1.5, 3.2, 3.5, 3.6, f64::INFINITY].map(|c| first_centre(c, 4));
        assert_eq!(first, [0, 0, 1, 1, 3, 3, 4, 4]);
    }
}
