//! Publishing: a draft beside the target, synced, renamed, the folder synced.

use std::fs::{self, File, OpenOptions};
use std::io::{BufReader, Read};
use std::os::unix::fs::FileExt;
use std::path::Path;

use super::encoding::encode;
use super::format::{Kind, Layout, Section, align};
use super::record::{Failure, Hash, ModelRecord, THUMBNAIL};
use crate::alignment::Method;
use crate::error::{Result, RunError};
use crate::stages::descriptor::{MAGNITUDES, PHASES};

/// What is to be published. The records are fetched one at a time, so that they need not be in memory together.
pub struct Contents<'a> {
    /// The settings that the results depend on, as TOML.
    pub settings: &'a str,
    /// Methods of every record, in their order.
    pub methods: &'a [Method],
    /// Id and content hash of every model done, in any order; each id once.
    pub models: Vec<(String, Hash)>,
    /// In any order.
    pub failures: Vec<Failure>,
}

/// Writes the published file of the store folder `dir` (which is there), replacing an older one atomically.
///
/// `fetch` gives the record of one of `contents.models`. The bytes depend on the contents only. On an error the
/// older file is still there, whole.
pub fn publish(
    dir: &Path,
    mut contents: Contents,
    fetch: &mut dyn FnMut(&str, &Hash) -> Result<ModelRecord>,
) -> Result<()> {
    contents.models.sort_unstable();
    contents.failures.sort_unstable_by(|a, b| a.id.cmp(&b.id));
    let target = super::published_path(dir);
    let draft = dir.join("models.symalign.draft");
    let io = |e| RunError::file(&draft, e);
    let file = OpenOptions::new().read(true).write(true).create(true).truncate(true).open(&draft).map_err(io)?;
    let written = Draft::write(&file, &draft, &contents, fetch).and_then(|()| file.sync_all().map_err(io));
    if written.is_err() {
        // Best effort: half a draft on a full disk is in the way, and the next one replaces it anyway.
        let _ = fs::remove_file(&draft);
    }
    written?;
    fs::rename(&draft, &target).map_err(|e| RunError::file(&target, e))?;
    sync_folder(dir)
}

/// Makes a rename or a new file in `dir` survive a power cut.
pub fn sync_folder(dir: &Path) -> Result<()> {
    File::open(dir).and_then(|folder| folder.sync_all()).map_err(|e| RunError::file(dir, e))
}

/// The unpublished file and where its sections go.
struct Draft<'a> {
    file: &'a File,
    path: &'a Path,
    sections: Vec<Section>,
    end: u64,
}

impl<'a> Draft<'a> {
    fn write(
        file: &'a File,
        path: &'a Path,
        contents: &Contents,
        fetch: &mut dyn FnMut(&str, &Hash) -> Result<ModelRecord>,
    ) -> Result<()> {
        let count = 12 + 3 * contents.methods.len();
        let mut draft = Draft { file, path, sections: Vec::with_capacity(count), end: Layout::head_length(count) };
        draft.small_sections(contents)?;
        draft.reserve_rows(contents);
        let offsets = draft.rows(contents, fetch)?;
        // What names all the rest is there twice, so that one damaged bit costs no more than a section of rows.
        draft.small_sections(contents)?;
        draft.append(Kind::SummaryOffsets, &offsets)?;
        debug_assert_eq!(draft.sections.len(), count);
        draft.finish(contents.models.len() as u64)
    }

    fn put(&self, bytes: &[u8], offset: u64) -> Result<()> {
        self.file.write_all_at(bytes, offset).map_err(|e| RunError::file(self.path, e))
    }

    /// Plans a section of `length` bytes at the end of the file and returns where it starts.
    fn reserve(&mut self, kind: Kind, method: Option<Method>, length: u64) -> u64 {
        let offset = align(self.end);
        self.sections.push(Section { kind, method, offset, length, crc: 0 });
        self.end = offset + length;
        offset
    }

    fn append(&mut self, kind: Kind, bytes: &[u8]) -> Result<()> {
        let offset = self.reserve(kind, None, bytes.len() as u64);
        self.put(bytes, offset)
    }

    fn small_sections(&mut self, contents: &Contents) -> Result<()> {
        let ids: Vec<&String> = contents.models.iter().map(|(id, _)| id).collect();
        let hashes: Vec<Hash> = contents.models.iter().map(|(_, hash)| *hash).collect();
        self.append(Kind::Settings, contents.settings.as_bytes())?;
        self.append(Kind::Ids, &self.encoded(&ids)?)?;
        self.append(Kind::Failures, &self.encoded(&contents.failures)?)?;
        self.append(Kind::Hashes, hashes.as_flattened())
    }

    fn encoded<T: serde::Serialize>(&self, value: &T) -> Result<Vec<u8>> {
        encode(value).map_err(|why| RunError::Store { path: self.path.into(), why })
    }

    fn reserve_rows(&mut self, contents: &Contents) {
        let models = contents.models.len() as u64;
        self.reserve(Kind::Thumbnails, None, models * (THUMBNAIL * THUMBNAIL) as u64);
        for (kind, row) in [(Kind::Magnitudes, 4 * MAGNITUDES), (Kind::Phases, 4 * PHASES), (Kind::Frames, 96)] {
            for &method in contents.methods {
                self.reserve(kind, Some(method), models * row as u64);
            }
        }
    }

    /// Writes row by row into the reserved sections, and the summaries after them; returns where those start.
    fn rows(
        &mut self,
        contents: &Contents,
        fetch: &mut dyn FnMut(&str, &Hash) -> Result<ModelRecord>,
    ) -> Result<Vec<u8>> {
        let index = self.reserve(Kind::SummaryOffsets, None, 8 * (contents.models.len() as u64 + 1));
        let start = align(self.end);
        let mut offsets = vec![0u64];
        for (i, (id, hash)) in contents.models.iter().enumerate() {
            let record = fetch(id, hash)?;
            if !record.is_whole(contents.methods) {
                let why = format!("the record of {id} does not fit the format");
                return Err(RunError::Store { path: self.path.into(), why });
            }
            self.row(i as u64, &record)?;
            let summary = self.encoded(&record.summary)?;
            let offset = offsets[i];
            self.put(&summary, start + offset)?;
            offsets.push(offset + summary.len() as u64);
        }
        let bytes: Vec<u8> = offsets.iter().flat_map(|o| o.to_le_bytes()).collect();
        self.put(&bytes, index)?;
        self.reserve(Kind::Summaries, None, offsets[contents.models.len()]);
        Ok(bytes)
    }

    fn row(&self, i: u64, record: &ModelRecord) -> Result<()> {
        self.put_row(Kind::Thumbnails, None, i, &record.thumbnail)?;
        for pose in &record.poses {
            let method = Some(pose.method);
            self.put_row(Kind::Magnitudes, method, i, &little_endian(&pose.magnitude, f32::to_le_bytes))?;
            self.put_row(Kind::Phases, method, i, &little_endian(&pose.phase, f32::to_le_bytes))?;
            self.put_row(Kind::Frames, method, i, &little_endian(&pose.frame, f64::to_le_bytes))?;
        }
        Ok(())
    }

    fn put_row(&self, kind: Kind, method: Option<Method>, i: u64, row: &[u8]) -> Result<()> {
        let section = self.sections.iter().find(|s| s.kind == kind && s.method == method);
        match section {
            Some(section) => self.put(row, section.offset + i * row.len() as u64),
            None => Err(RunError::Store { path: self.path.into(), why: format!("no section {kind:?}") }),
        }
    }

    /// Sums up the sections as they now are on disk and writes both copies of the head.
    fn finish(mut self, models: u64) -> Result<()> {
        let tail = align(self.end);
        let file_length = tail + Layout::tail_length(self.sections.len());
        let io = |e| RunError::file(self.path, e);
        self.file.set_len(file_length).map_err(io)?;
        for section in &mut self.sections {
            section.crc = checksum(self.file, section).map_err(io)?;
        }
        let layout = Layout { models, file_length, sections: std::mem::take(&mut self.sections) };
        self.put(&layout.tail(), tail)?;
        self.put(&layout.head(), 0)
    }
}

fn little_endian<T: Copy, const B: usize>(numbers: &[T], to_bytes: fn(T) -> [u8; B]) -> Vec<u8> {
    numbers.iter().flat_map(|n| to_bytes(*n)).collect()
}

/// CRC-32 of a section, read back through a buffer.
fn checksum(file: &File, section: &Section) -> std::io::Result<u32> {
    let mut reader = BufReader::with_capacity(1 << 16, At { file, offset: section.offset }).take(section.length);
    let mut hasher = crc32fast::Hasher::new();
    let mut buffer = [0; 1 << 14];
    loop {
        match reader.read(&mut buffer)? {
            0 => return Ok(hasher.finalize()),
            n => hasher.update(&buffer[..n]),
        }
    }
}

/// Reads a file from an offset on without moving its cursor.
struct At<'a> {
    file: &'a File,
    offset: u64,
}

impl Read for At<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let n = self.file.read_at(buffer, self.offset)?;
        self.offset += n as u64;
        Ok(n)
    }
}
