//! Silhouettes: pictures of 1 bit to the pixel, their rows held in words; and the areas of shadows.

pub mod draw;
pub mod outline;
pub mod shadow;

use std::ops::Range;

/// A square picture of bits; row 0 is the lowest, x grows with the bit's number.
#[derive(Clone, PartialEq)]
pub struct Silhouette {
    side: usize,
    words: usize,
    bits: Vec<u64>,
}

impl Silhouette {
    /// An empty picture.
    pub fn new(side: usize) -> Self {
        let words = side.div_ceil(64);
        Self { side, words, bits: vec![0; words * side] }
    }

    /// Pixels on a side.
    pub fn side(&self) -> usize {
        self.side
    }

    /// Whether a pixel is covered; outside the picture none is.
    pub fn get(&self, x: isize, y: isize) -> bool {
        // Negative ones come out as large ones.
        let [x, y] = [x, y].map(|c| c as usize);
        x < self.side && y < self.side && self.bits[y * self.words + x / 64] >> (x % 64) & 1 == 1
    }

    /// The bits of a row, lowest x first.
    pub fn row(&self, y: usize) -> &[u64] {
        &self.bits[y * self.words..(y + 1) * self.words]
    }

    /// The bits of a row, to be changed.
    fn row_mut(&mut self, y: usize) -> &mut [u64] {
        &mut self.bits[y * self.words..(y + 1) * self.words]
    }

    /// Calls `run` for the covered pixels of each row, from the lowest row up and from left to right, as many as stand
    /// side by side at once: row, first pixel, end.
    pub fn each_run(&self, mut run: impl FnMut(usize, usize, usize)) {
        for (y, row) in self.bits.chunks_exact(self.words.max(1)).enumerate() {
            let (mut carry, mut begun) = (0, None);
            for (number, &word) in row.iter().enumerate() {
                let mut changes = word ^ (word << 1 | carry);
                carry = word >> 63;
                while changes != 0 {
                    let x = 64 * number + changes.trailing_zeros() as usize;
                    changes &= changes - 1;
                    match begun.take() {
                        Some(first) => run(y, first, x),
                        None => begun = Some(x),
                    }
                }
            }
            if let Some(first) = begun {
                run(y, first, self.side);
            }
        }
    }

    /// Covered pixels.
    pub fn area(&self) -> usize {
        let mut area = 0;
        self.each_run(|_, first, end| area += end - first);
        area
    }

    /// Centroid of the covered pixels (pixel centres are at halves); `None` for an empty picture.
    pub fn centroid(&self) -> Option<[f64; 2]> {
        let (mut doubled, mut count) = ([0; 2], 0);
        self.each_run(|y, first, end| {
            doubled = [doubled[0] + (end - first) * (first + end), doubled[1] + (end - first) * (2 * y + 1)];
            count += end - first;
        });
        (count > 0).then(|| doubled.map(|sum| 0.5 * sum as f64 / count as f64))
    }

    /// Covered pixels of row `y` with first <= x < end.
    pub fn count(&self, y: usize, first: usize, end: usize) -> usize {
        let (words, [low, high]) = ends(first, end);
        let ones = match &self.row(y)[words] {
            [] => 0,
            [word] => (word & low & high).count_ones(),
            [left, between @ .., right] => {
                (left & low).count_ones()
                    + (right & high).count_ones()
                    + between.iter().map(|w| w.count_ones()).sum::<u32>()
            }
        };
        ones as usize
    }

    /// Covers the pixels of row `y` with first <= x < end.
    pub fn fill(&mut self, y: usize, first: usize, end: usize) {
        if first < end {
            fill(self.row_mut(y), first, end - 1);
        }
    }

    /// The pixels within `radius` of a covered one: a dilation by a disc.
    pub(crate) fn dilated(&self, radius: usize) -> Self {
        let mut grown = Self::new(self.side);
        let r = radius as isize;
        for dy in -r..=r {
            let reach = ((r * r - dy * dy) as f64).sqrt().round() as usize;
            for y in 0..self.side {
                let Some(target) = y.checked_add_signed(dy).filter(|t| *t < self.side) else { continue };
                let wide = widened(self.row(y), reach);
                let row = &mut grown.bits[target * self.words..(target + 1) * self.words];
                row.iter_mut().zip(wide).for_each(|(word, more)| *word |= more);
            }
        }
        grown
    }

    /// Closes gaps up to twice `radius` wide (dilation, then erosion, by a disc).
    pub fn closed(&self, radius: usize) -> Self {
        let mut outside = self.dilated(radius);
        outside.invert();
        let mut closed = outside.dilated(radius);
        closed.invert();
        closed.bits.iter_mut().zip(&self.bits).for_each(|(word, own)| *word |= own);
        closed
    }

    fn invert(&mut self) {
        self.bits.iter_mut().for_each(|w| *w = !*w);
        let spare = self.words * 64 - self.side;
        if spare > 0 {
            self.bits.iter_mut().skip(self.words - 1).step_by(self.words).for_each(|w| *w &= u64::MAX >> spare);
        }
    }

    /// The picture as text, `#` and `.`, highest row first.
    pub fn to_text(&self) -> String {
        let row = |y: usize| (0..self.side).map(move |x| if self.get(x as isize, y as isize) { '#' } else { '.' });
        (0..self.side).rev().flat_map(|y| row(y).chain(['\n'])).collect()
    }

    /// The picture that [`Silhouette::to_text`] writes.
    pub fn from_text(text: &str) -> Self {
        let rows: Vec<_> = text.split_whitespace().rev().collect();
        let mut picture = Self::new(rows.len());
        for (y, row) in rows.iter().enumerate() {
            for (x, _) in row.bytes().enumerate().filter(|(x, c)| *c == b'#' && *x < rows.len()) {
                picture.fill(y, x, x + 1);
            }
        }
        picture
    }
}

impl std::fmt::Debug for Silhouette {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "\n{}", self.to_text())
    }
}

/// The words of a row that hold first <= x < end, and which bits those are in the first and in the last of them.
#[inline]
fn ends(first: usize, end: usize) -> (Range<usize>, [u64; 2]) {
    if first >= end {
        return (0..0, [0; 2]);
    }
    (first / 64..(end - 1) / 64 + 1, masks(first, end - 1))
}

/// The bits from the first pixel on in its word, and those up to the last one in its.
#[inline]
fn masks(first: usize, last: usize) -> [u64; 2] {
    [u64::MAX << (first % 64), u64::MAX >> (63 - last % 64)]
}

/// Covers the pixels of a row from the first to the last of some.
#[inline]
fn fill(row: &mut [u64], first: usize, last: usize) {
    let (left, right, [low, high]) = (first / 64, last / 64, masks(first, last));
    if left >= right {
        row[left] |= low & high;
    } else {
        row[left] |= low;
        row[right] |= high;
        row[left + 1..right].fill(u64::MAX);
    }
}

/// A row with every covered pixel spread `reach` to both sides.
fn widened(row: &[u64], reach: usize) -> Vec<u64> {
    let mut wide = row.to_vec();
    for _ in 0..reach {
        let narrow = wide.clone();
        for (i, word) in wide.iter_mut().enumerate() {
            let from_below = if i > 0 { narrow[i - 1] >> 63 } else { 0 };
            let from_above = narrow.get(i + 1).map_or(0, |next| next << 63);
            *word |= narrow[i] << 1 | narrow[i] >> 1 | from_below | from_above;
        }
    }
    wide
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_and_centroids_cross_words() {
        let mut picture = Silhouette::new(130);
        picture.fill(3, 60, 130);
        assert_eq!(picture.area(), 70);
        assert_eq!(picture.count(3, 63, 66), 3);
        assert_eq!(picture.centroid(), Some([95.0, 3.5]));
        assert_eq!(Silhouette::new(9).centroid(), None);
        let mut runs = Vec::new();
        picture.fill(3, 2, 3);
        picture.each_run(|y, first, end| runs.push([y, first, end]));
        assert_eq!(runs, [[3, 2, 3], [3, 60, 130]]);
        let mut full = Silhouette::new(64);
        full.fill(63, 0, 64);
        full.each_run(|y, first, end| runs.push([y, first, end]));
        assert_eq!(runs[2..], [[63, 0, 64]]);
    }

    #[test]
    fn closing_fills_a_narrow_gap_and_keeps_a_wide_one() {
        let mut picture = Silhouette::new(100);
        (20..80).for_each(|y| picture.fill(y, 10, 40));
        (20..80).for_each(|y| picture.fill(y, 44, 60));
        (20..80).for_each(|y| picture.fill(y, 80, 90));
        let closed = picture.closed(3);
        assert!(closed.get(42, 50) && !closed.get(70, 50));
        assert!(!closed.get(5, 50) && !closed.get(95, 50) && !closed.get(50, 15));
    }
}
