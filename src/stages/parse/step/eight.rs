//! Text eight bytes at a time, as one number: keywords and numbers are so short that a call of a search for long texts
//! costs more than the search.

const ONES: u64 = 0x0101_0101_0101_0101;
const HIGHEST_BITS: u64 = 0x8080_8080_8080_8080;

/// The eight bytes at `at`, the first one lowest.
#[inline]
fn eight(bytes: &[u8], at: usize) -> Option<u64> {
    Some(u64::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

/// The place of the first bit that is set, in bytes.
#[inline]
fn first_byte(bits: u64) -> usize {
    bits.trailing_zeros() as usize / 8
}

/// The first place of a byte.
#[inline]
pub(super) fn find(bytes: &[u8], needle: u8) -> Option<usize> {
    let mut at = 0;
    while let Some(word) = eight(bytes, at) {
        let others = word ^ (ONES * u64::from(needle));
        // A byte is zero if subtracting one borrows: right for the first one, which is the one that counts.
        let zeros = others.wrapping_sub(ONES) & !others & HIGHEST_BITS;
        if zeros != 0 {
            return Some(at + first_byte(zeros));
        }
        at += 8;
    }
    bytes[at..].iter().position(|b| *b == needle).map(|n| at + n)
}

/// The decimal number at `at` and how many digits it has; `None` where it may have more than seven.
#[inline]
pub(super) fn leading_number(bytes: &[u8], at: usize) -> Option<(u64, usize)> {
    let word = eight(bytes, at)? ^ (ONES * u64::from(b'0'));
    // Bytes above nine reach the highest bit, up to the first of them nothing is carried.
    let others = (word.wrapping_add(ONES * 0x76) | word) & HIGHEST_BITS;
    if others == 0 {
        return None;
    }
    let digits = first_byte(others);
    // The digits as the last of eight, then pairs of neighbours as one number.
    let ones = word.checked_shl(64 - 8 * digits as u32).unwrap_or(0);
    let tens = (ones.wrapping_mul((10 << 8) + 1) >> 8) & 0x00ff_00ff_00ff_00ff;
    let hundreds = (tens.wrapping_mul((100 << 16) + 1) >> 16) & 0x0000_ffff_0000_ffff;
    Some((hundreds.wrapping_mul((10_000 << 32) + 1) >> 32, digits))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_up_to_seven_digits_are_read() {
        let read = |text: &str| leading_number(format!("{text}        ").as_bytes(), 0);
        assert_eq!(read("=1"), Some((0, 0)));
        assert_eq!(read("7,"), Some((7, 1)));
        assert_eq!(read("1234567"), Some((1_234_567, 7)));
        assert_eq!(read("0040/9"), Some((40, 4)));
        assert_eq!(read("98\u{e9}1"), Some((98, 2)));
        assert_eq!(read("12345678"), None);
        assert_eq!(leading_number(b"1=PLANE", 0), None, "fewer than eight bytes");
    }

    #[test]
    fn a_byte_is_found_wherever_it_stands() {
        for length in 0..40 {
            let mut text = vec![b'a'; length];
            assert_eq!(find(&text, b'('), None);
            for at in (0..length).rev() {
                text[at] = b'(';
                assert_eq!(find(&text, b'('), Some(at));
            }
        }
    }
}
