//! Which segments pass below a point, without asking all of them.

use super::chart::Uv;
use super::domain::crosses_below;
use crate::geometry::cells::starts;

/// Segments in columns along one coordinate: about as many columns as segments in each, so that the thousands of holes
/// of a plate do not cost their square.
pub(super) struct Columns<'a> {
    segments: &'a [[Uv; 2]],
    along: usize,
    from: f64,
    width: f64,
    /// The segments of one column after the other, and where those of each column end.
    members: Vec<u32>,
    ends: Vec<usize>,
}

impl<'a> Columns<'a> {
    pub fn new(segments: &'a [[Uv; 2]], along: usize) -> Self {
        let ends = segments.iter().flatten().map(|p| p[along]);
        let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        let count = (segments.len() as f64).sqrt().ceil().max(1.0);
        let (ends, members) = (vec![0; count as usize], Vec::new());
        let mut columns = Self { segments, along, from: low, width: (high - low) / count, members, ends };
        let touched = |columns: &Self, [a, b]: &[Uv; 2]| {
            let (first, last) = (columns.at(a), columns.at(b));
            first.min(last)..=first.max(last)
        };
        for segment in segments {
            let touched = touched(&columns, segment);
            columns.ends[touched].iter_mut().for_each(|end| *end += 1);
        }
        // Each column's end grows from its start as its members come.
        columns.members.resize(starts(&mut columns.ends), 0);
        for (i, segment) in segments.iter().enumerate() {
            for column in touched(&columns, segment) {
                columns.members[columns.ends[column]] = i as u32;
                columns.ends[column] += 1;
            }
        }
        columns
    }

    /// The column of a point; the last one also for what is beyond or not a number.
    fn at(&self, p: &Uv) -> usize {
        // `as` saturates.
        (((p[self.along] - self.from) / self.width) as usize).min(self.ends.len() - 1)
    }

    /// How many segments pass below `p`.
    pub fn below(&self, p: &Uv) -> usize {
        let column = self.at(p);
        let start = column.checked_sub(1).map_or(0, |before| self.ends[before]);
        let near = self.members[start..self.ends[column]].iter().map(|&i| &self.segments[i as usize]);
        near.filter(|[a, b]| crosses_below(a, b, p, self.along)).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_as_all_segments_do() {
        let corner = |i: usize| [(i as f64 * 0.754_877_666).fract(), (i as f64 * 0.569_840_291).fract()];
        let segments: Vec<[Uv; 2]> = (0..200).map(|i| [corner(i), corner(i + 1)]).collect();
        for along in [0, 1] {
            let columns = Columns::new(&segments, along);
            for p in (0..50).map(|i| corner(1000 + i)) {
                assert_eq!(columns.below(&p), segments.iter().filter(|[a, b]| crosses_below(a, b, &p, along)).count());
            }
        }
    }
}
