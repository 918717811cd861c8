//! The layout of the published file: its header and its table of sections. `FORMAT.md` tells it in words.

use std::fs::File;
use std::os::unix::fs::FileExt;
use std::path::Path;

use crate::alignment::Method;

/// The first bytes of a published file.
pub const MAGIC: [u8; 8] = *b"SYMALIGN";
/// Version of the published file and of the journal.
pub const VERSION: u32 = 2;
/// Bytes of the header.
pub const HEADER: usize = 64;
/// Bytes of an entry in the table of sections.
pub const ENTRY: usize = 40;
/// Sections start at multiples of this many bytes.
pub const ALIGN: u64 = 64;
/// More sections than any version has; a larger count is damage.
const SECTIONS_MAX: u32 = 1024;
/// The method code of sections that belong to no method.
const NO_METHOD: u32 = u32::MAX;

// Numbers are mapped as they lie on disk.
const _: () = assert!(cfg!(target_endian = "little"), "the store is mapped little-endian");

/// What a section holds. N is the number of models.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// The effective settings, TOML text.
    Settings,
    /// The ids, sorted: bincode `Vec<String>`.
    Ids,
    /// The failures, sorted by id: bincode `Vec<Failure>`.
    Failures,
    /// BLAKE3 of each model's bytes: u8 `[N][32]`.
    Hashes,
    /// Grey pictures: u8 `[N][96 * 96]`.
    Thumbnails,
    /// f32 `[N][96]`.
    Magnitudes,
    /// f32 `[N][384]`.
    Phases,
    /// f64 `[N][12]`.
    Frames,
    /// Where each summary starts in [`Kind::Summaries`], and their end: u64 `[N + 1]`.
    SummaryOffsets,
    /// bincode `Summary`, one after the other.
    Summaries,
}

impl Kind {
    const ALL: [(Self, u32); 10] = [
        (Self::Settings, 1),
        (Self::Ids, 2),
        (Self::Failures, 3),
        (Self::Hashes, 4),
        (Self::Thumbnails, 5),
        (Self::Magnitudes, 6),
        (Self::Phases, 7),
        (Self::Frames, 8),
        (Self::SummaryOffsets, 9),
        (Self::Summaries, 10),
    ];

    fn code(self) -> u32 {
        Self::ALL.iter().find(|(kind, _)| *kind == self).map_or(0, |(_, code)| *code)
    }

    fn of(code: u32) -> Option<Self> {
        Self::ALL.iter().find(|(_, c)| *c == code).map(|(kind, _)| *kind)
    }
}

/// The code of a method on disk: fixed, whatever order the program lists them in.
fn method_code(method: Method) -> u32 {
    match method {
        Method::Symmetry => 0,
        Method::Pca => 1,
        Method::Cpca => 2,
        Method::Npca => 3,
        Method::File => 4,
        Method::Mbb => 5,
        Method::Rectilinearity => 6,
        Method::Mpa => 7,
        Method::Prst => 8,
    }
}

/// A run of bytes of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Section {
    /// What it holds.
    pub kind: Kind,
    /// `None` for sections that belong to no method.
    pub method: Option<Method>,
    /// From the start of the file.
    pub offset: u64,
    /// Bytes.
    pub length: u64,
    /// CRC-32 (IEEE) of the bytes.
    pub crc: u32,
}

impl Section {
    /// What the section is, in words.
    pub fn name(&self) -> String {
        format!("{:?}{}", self.kind, self.method.map(|m| format!(" of {}", m.name())).unwrap_or_default())
    }

    fn to_bytes(self) -> [u8; ENTRY] {
        let mut bytes = [0; ENTRY];
        put(&mut bytes, 0, &self.kind.code().to_le_bytes());
        put(&mut bytes, 4, &self.method.map_or(NO_METHOD, method_code).to_le_bytes());
        put(&mut bytes, 8, &self.offset.to_le_bytes());
        put(&mut bytes, 16, &self.length.to_le_bytes());
        put(&mut bytes, 24, &self.crc.to_le_bytes());
        bytes
    }

    fn of(bytes: &[u8]) -> Option<Self> {
        let code = u32_at(bytes, 4);
        let method = Method::ALL.into_iter().find(|m| method_code(*m) == code);
        if method.is_none() && code != NO_METHOD {
            return None;
        }
        let kind = Kind::of(u32_at(bytes, 0))?;
        Some(Self { kind, method, offset: u64_at(bytes, 8), length: u64_at(bytes, 16), crc: u32_at(bytes, 24) })
    }
}

/// What a program of version [`VERSION`] says to a store of another one.
pub fn version_error(version: u32) -> String {
    format!(
        "format version {version}, this program reads {VERSION}; use the program that wrote it, another --store, or run \
         --fresh to start over"
    )
}

/// Header and table of sections of a published file: the head. It is there twice, so that one damaged bit does not
/// cost all: at the start, and the other way round, table then header, at the end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    pub models: u64,
    pub file_length: u64,
    pub sections: Vec<Section>,
}

impl Layout {
    /// Bytes of a header with `sections` table entries: where the first section may start.
    pub fn head_length(sections: usize) -> u64 {
        align((HEADER + ENTRY * sections) as u64)
    }

    /// Bytes of the second copy of a head with `sections` table entries.
    pub fn tail_length(sections: usize) -> u64 {
        (HEADER + ENTRY * sections) as u64
    }

    /// The second copy of the head: the table, then the header.
    pub fn tail(&self) -> Vec<u8> {
        let bytes = self.head();
        let table = &bytes[HEADER..HEADER + ENTRY * self.sections.len()];
        [table, &bytes[..HEADER]].concat()
    }

    /// Header and table as bytes, zero-padded to [`Layout::head_length`].
    pub fn head(&self) -> Vec<u8> {
        let mut bytes = vec![0; Self::head_length(self.sections.len()) as usize];
        for (i, section) in self.sections.iter().enumerate() {
            put(&mut bytes, HEADER + ENTRY * i, &section.to_bytes());
        }
        let table = crc32fast::hash(&bytes[HEADER..HEADER + ENTRY * self.sections.len()]);
        put(&mut bytes, 0, &MAGIC);
        put(&mut bytes, 8, &VERSION.to_le_bytes());
        put(&mut bytes, 12, &(self.sections.len() as u32).to_le_bytes());
        put(&mut bytes, 16, &self.models.to_le_bytes());
        put(&mut bytes, 24, &self.file_length.to_le_bytes());
        put(&mut bytes, 32, &table.to_le_bytes());
        let own = crc32fast::hash(&bytes[..HEADER - 4]);
        put(&mut bytes, HEADER - 4, &own.to_le_bytes());
        bytes
    }

    /// Reads and checks the head: magic, version, checksums, and that every section lies inside the file. Where the
    /// first copy is damaged, the second one holds.
    pub fn of(file: &[u8]) -> Result<Self, String> {
        let [first, second] = Self::copies(file);
        first.or_else(|why| second.map_err(|_| why))
    }

    /// Both copies of the head.
    pub fn copies(file: &[u8]) -> [Result<Self, String>; 2] {
        let second = file.len().checked_sub(HEADER).and_then(|at| {
            let header = &file[at..];
            let length = ENTRY * (u32_at(header, 12).min(SECTIONS_MAX) as usize);
            Some((header, &file[at.checked_sub(length)?..at]))
        });
        let cut_off = || Err("the header is cut off".into());
        [
            Self::parse(file, file.get(HEADER..).unwrap_or_default(), file.len()),
            second.map_or_else(cut_off, |(header, table)| Self::parse(header, table, file.len())),
        ]
    }

    /// A head whose table is at the start of `table`.
    fn parse(header: &[u8], table: &[u8], file_length: usize) -> Result<Self, String> {
        let count = check_header(header)?;
        let table = table.get(..ENTRY * count as usize).ok_or("the table of sections is cut off")?;
        if crc32fast::hash(table) != u32_at(header, 32) {
            return Err("the table of sections is damaged (checksum differs)".into());
        }
        let entry = |bytes| Section::of(bytes).ok_or("a section of a kind this program does not know".to_string());
        let sections = table.chunks_exact(ENTRY).map(entry).collect::<Result<Vec<_>, _>>()?;
        let layout = Self { models: u64_at(header, 16), file_length: u64_at(header, 24), sections };
        layout.check_bounds(file_length as u64)?;
        Ok(layout)
    }

    fn check_bounds(&self, length: u64) -> Result<(), String> {
        if self.file_length != length {
            return Err(format!("the file should have {} bytes, it has {length}", self.file_length));
        }
        let inside = |s: &Section| s.offset.is_multiple_of(ALIGN) && s.offset.checked_add(s.length) <= Some(length);
        match self.sections.iter().find(|s| !inside(s)) {
            Some(bad) => Err(format!("section {bad:?} does not lie inside the file")),
            None => Ok(()),
        }
    }

    /// The sections of this kind and method, as places in `sections`: small ones are there twice.
    pub fn find(&self, kind: Kind, method: Option<Method>) -> impl Iterator<Item = usize> {
        self.sections.iter().enumerate().filter(move |(_, s)| s.kind == kind && s.method == method).map(|(i, _)| i)
    }
}

/// Checks the fixed header and returns the number of sections.
fn check_header(file: &[u8]) -> Result<u32, String> {
    if file.get(..8) != Some(&MAGIC) {
        return Err("not a symalign store (expected \"SYMALIGN\" at its start)".into());
    }
    if file.len() < HEADER {
        return Err("the header is cut off".into());
    }
    if crc32fast::hash(&file[..HEADER - 4]) != u32_at(file, HEADER - 4) {
        return Err("the header is damaged (checksum differs)".into());
    }
    let version = u32_at(file, 8);
    if version != VERSION {
        return Err(version_error(version));
    }
    let count = u32_at(file, 12);
    if count > SECTIONS_MAX { Err(format!("{count} sections")) } else { Ok(count) }
}

/// The format version that a published file says it has; `None` where both copies of its header are damaged.
pub fn version_of(path: &Path) -> std::io::Result<Option<u32>> {
    let file = File::open(path)?;
    let length = file.metadata()?.len();
    let mut header = [0; HEADER];
    for at in [0, length.saturating_sub(HEADER as u64)] {
        let read = file.read_exact_at(&mut header, at);
        if read.is_ok() && header[..8] == MAGIC && crc32fast::hash(&header[..HEADER - 4]) == u32_at(&header, HEADER - 4)
        {
            return Ok(Some(u32_at(&header, 8)));
        }
    }
    Ok(None)
}

/// The next multiple of [`ALIGN`].
pub fn align(offset: u64) -> u64 {
    offset.next_multiple_of(ALIGN)
}

fn put(bytes: &mut [u8], at: usize, value: &[u8]) {
    bytes[at..at + value.len()].copy_from_slice(value);
}

/// The little-endian u32 at `at`; the caller knows that it is there.
pub fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(std::array::from_fn(|i| bytes[at + i]))
}

/// The little-endian u64 at `at`; the caller knows that it is there.
pub fn u64_at(bytes: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(std::array::from_fn(|i| bytes[at + i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Head to 192, two sections, the copy of the head from 384 on.
    fn layout() -> Layout {
        let ids = Section { kind: Kind::Ids, method: None, offset: 192, length: 10, crc: 5 };
        let frames = Section { kind: Kind::Frames, method: Some(Method::Npca), offset: 256, length: 96, crc: u32::MAX };
        Layout { models: 1, file_length: 528, sections: vec![ids, frames] }
    }

    fn file() -> Vec<u8> {
        let mut file = layout().head();
        file.resize(384, 0);
        file.extend(layout().tail());
        file
    }

    #[test]
    fn a_layout_survives_its_bytes() {
        assert_eq!((layout().head().len(), file().len()), (192, 528));
        assert_eq!(Layout::copies(&file()), [Ok(layout()), Ok(layout())]);
    }

    #[test]
    fn every_flipped_bit_of_a_head_is_found_and_the_other_copy_holds() {
        for (copy, bytes) in [(0, 0..HEADER + 2 * ENTRY), (1, 384..528)] {
            for bit in bytes.start * 8..bytes.end * 8 {
                let mut file = file();
                file[bit / 8] ^= 1 << (bit % 8);
                let copies = Layout::copies(&file);
                assert!(copies[copy].is_err() && copies[1 - copy].is_ok(), "bit {bit}");
                assert_eq!(Layout::of(&file), Ok(layout()), "bit {bit}");
            }
        }
    }

    #[test]
    fn every_shorter_file_is_refused() {
        let file = file();
        assert!((0..file.len()).all(|n| Layout::of(&file[..n]).is_err()));
    }

    #[test]
    fn method_codes_do_not_change() {
        assert_eq!(Method::ALL.map(method_code), [0, 1, 2, 3, 4, 5, 6, 7, 8]);
    }
}
