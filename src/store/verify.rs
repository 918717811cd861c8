//! The full check of a published store.

use super::format::{ENTRY, HEADER, Layout};
use super::reader::Store;

/// A damaged stretch of a published file or a journal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Damage {
    /// What lies there.
    pub place: String,
    /// From the start of the file, bytes.
    pub offset: u64,
    /// Bytes.
    pub length: u64,
}

impl std::fmt::Display for Damage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} at byte {}, {} bytes", self.place, self.offset, self.length)
    }
}

impl Store {
    /// Checks every byte of the published file: both copies of the head, the checksum of every section, zeros between
    /// them, and that every summary decodes. Returns what is damaged; empty when all is well.
    ///
    /// Cost: one pass over the file.
    pub fn verify(&self) -> Vec<Damage> {
        let mut damages = self.damaged_heads();
        damages.extend(self.damaged_sections());
        damages.extend(self.damaged_gaps());
        damages.extend(self.undecodable_summaries(damages.is_empty()));
        damages
    }

    fn damaged_heads(&self) -> Vec<Damage> {
        let length = Layout::tail_length(self.sections().len());
        let places = [("header and table at the start", 0), ("header and table at the end", self.tail_start())];
        let copies = Layout::copies(self.bytes()).into_iter().zip(places);
        let bad = copies.filter(|(copy, _)| copy.as_ref() != Ok(self.layout()));
        bad.map(|(_, (place, offset))| Damage { place: place.into(), offset, length }).collect()
    }

    /// Where the second copy of the head starts.
    fn tail_start(&self) -> u64 {
        self.layout().file_length - Layout::tail_length(self.sections().len())
    }

    fn damaged_sections(&self) -> Vec<Damage> {
        let sections = self.sections().iter().enumerate();
        let bad = sections.filter(|(i, _)| !self.is_whole(*i));
        bad.map(|(_, s)| Damage { place: s.name(), offset: s.offset, length: s.length }).collect()
    }

    /// Bytes that belong to no section must be zero.
    fn damaged_gaps(&self) -> Vec<Damage> {
        let table_end = HEADER + ENTRY * self.sections().len();
        let mut taken: Vec<_> = self.sections().iter().map(|s| (s.offset, s.offset + s.length)).collect();
        taken.push((0, table_end as u64));
        taken.push((self.tail_start(), self.layout().file_length));
        taken.sort_unstable();
        let gaps = taken.windows(2).map(|pair| (pair[0].1, pair[1].0)).filter(|(start, end)| start < end);
        let dirty = gaps.filter(|&(start, end)| self.bytes()[start as usize..end as usize].iter().any(|b| *b != 0));
        dirty
            .map(|(offset, end)| Damage { place: "padding (should be zero)".into(), offset, length: end - offset })
            .collect()
    }

    fn undecodable_summaries(&self, sections_are_good: bool) -> Vec<Damage> {
        if !sections_are_good {
            return Vec::new();
        }
        let bad = (0..self.len()).filter_map(|i| self.summary(i).err());
        bad.map(|error| Damage { place: error.to_string(), offset: 0, length: 0 }).collect()
    }
}
