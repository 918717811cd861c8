//! The full check of a published store.

use super::format::{ENTRY, HEADER};
use super::reader::{Store, bytes_of};

/// A damaged stretch of a published file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Damage {
    /// What lies there.
    pub place: String,
    /// From the start of the file, bytes.
    pub offset: u64,
    /// Bytes.
    pub length: u64,
}

impl Store {
    /// Checks every byte of the published file: the checksum of every section, zeros between them, and that every
    /// summary decodes. Returns what is damaged; empty when all is well.
    ///
    /// Cost: one pass over the file.
    pub fn verify(&self) -> Vec<Damage> {
        let mut damages = self.damaged_sections();
        damages.extend(self.damaged_gaps());
        damages.extend(self.undecodable_summaries(damages.is_empty()));
        damages
    }

    fn damaged_sections(&self) -> Vec<Damage> {
        let sections = self.sections().iter();
        let bad = sections.filter(|s| crc32fast::hash(bytes_of(self.bytes(), s)) != s.crc);
        bad.map(|s| Damage {
            place: format!("{:?}{}", s.kind, s.method.map(|m| format!(" of {}", m.name())).unwrap_or_default()),
            offset: s.offset,
            length: s.length,
        })
        .collect()
    }

    /// Bytes that belong to no section must be zero.
    fn damaged_gaps(&self) -> Vec<Damage> {
        let table_end = HEADER + ENTRY * self.sections().len();
        let mut taken: Vec<_> = self.sections().iter().map(|s| (s.offset, s.offset + s.length)).collect();
        taken.push((0, table_end as u64));
        taken.push((self.layout().file_length, self.layout().file_length));
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
