//! Cells of width 1 in a row: pixels, samples, slices; and where groups start that lie in a row.

/// The first of `count` cells whose centre (at halves) is not before `c`; `count` if there is none.
#[inline]
pub fn first_centre(c: f64, count: usize) -> usize {
    // Not by `ceil`: that is a call of the C library on processors without SSE 4.1.
    let from_first = (c - 0.5).clamp(0.0, count as f64);
    // Nor by 64 bits: those take several instructions each way.
    let whole = from_first as u32;
    whole as usize + usize::from(f64::from(whole) < from_first)
}

/// The largest whole number that is not above `x`, within the range of the type. Not by `f64::floor`: that is a call of
/// the C library on processors without SSE 4.1.
#[inline]
pub fn floor(x: f64) -> i32 {
    let whole = x as i32;
    whole.saturating_sub(i32::from(f64::from(whole) > x))
}

/// Turns the sizes of groups that lie one after the other into where each starts; the size of all.
pub fn starts(sizes: &mut [usize]) -> usize {
    let mut total = 0;
    sizes.iter_mut().for_each(|size| total += std::mem::replace(size, total));
    total
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
    fn numbers_are_rounded_down() {
        let down = [-1e300, -2.5, -2.0, -0.1, 0.0, 0.9, 3.0, 1e300].map(floor);
        assert_eq!(down, [i32::MIN, -3, -2, -1, 0, 0, 3, i32::MAX]);
    }

    #[test]
    fn groups_start_where_those_before_them_end() {
        let mut sizes = [3, 0, 2];
        assert_eq!((starts(&mut sizes), sizes), (5, [0, 3, 3]));
    }

    #[test]
    fn centres_lie_at_halves() {
        let first = [-3.0, 0.5, 0.50001, 1.5, 3.2, 3.5, 3.6, f64::INFINITY].map(|c| first_centre(c, 4));
        assert_eq!(first, [0, 0, 1, 1, 3, 3, 4, 4]);
    }
}
