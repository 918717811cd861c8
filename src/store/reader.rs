//! The mapped, read-only view of a published store.

use std::fs::File;
use std::path::{Path, PathBuf};

use memmap2::Mmap;
use zerocopy::FromBytes;

use super::encoding;
use super::format::{Kind, Layout, Section, u64_at};
use super::ids::Ids;
use super::record::{Failure, Hash, ModelRecord, Pose, Summary, THUMBNAIL, frame_of};
use crate::alignment::Method;
use crate::error::{Result, RunError};
use crate::geometry::Frame;
use crate::stages::descriptor::{MAGNITUDES, PHASES};

/// A published store: models in the order of their ids' bytes, row i of every section is model i.
pub struct Store {
    path: PathBuf,
    map: Mmap,
    layout: Layout,
    ids: Ids,
    methods: Vec<Method>,
    failures: Vec<Failure>,
    settings: String,
}

impl Store {
    /// Maps the published file of the store folder `dir` and checks its header, table, ids, failures and settings;
    /// the large sections are checked by [`Store::verify`].
    ///
    /// Errors: no such file, damage (with the section), or a format version this program does not read.
    pub fn open(dir: &Path) -> Result<Self> {
        let path = super::published_path(dir);
        let file = File::open(&path).map_err(|e| RunError::file(&path, e))?;
        // SAFETY: a published file is only ever replaced by rename, never written in place, so the mapped bytes do
        // not change; a user who edits or truncates the file while it is mapped breaks this, as for any map.
        #[allow(unsafe_code)]
        let map = unsafe { Mmap::map(&file) }.map_err(|e| RunError::file(&path, e))?;
        Self::from_map(path.clone(), map).map_err(|why| RunError::Store { path, why })
    }

    fn from_map(path: PathBuf, map: Mmap) -> std::result::Result<Self, String> {
        let layout = Layout::of(&map)?;
        let small = |kind| checked(&map, &layout, kind);
        let settings = std::str::from_utf8(small(Kind::Settings)?).map_err(|e| format!("settings: {e}"))?.to_owned();
        let ids = Ids::of(small(Kind::Ids)?, layout.models)?;
        let failures = encoding::decode(small(Kind::Failures)?).map_err(|e| format!("failures: {e}"))?;
        let frames = layout.sections.iter().filter(|s| s.kind == Kind::Frames);
        let methods: Vec<Method> = frames.filter_map(|s| s.method).collect();
        let store = Self { path, map, layout, ids, methods, failures, settings };
        store.check_shapes()?;
        Ok(store)
    }

    /// Every section of rows has as many rows as there are models.
    fn check_shapes(&self) -> std::result::Result<(), String> {
        let per_method = self.methods.iter().flat_map(|m| {
            [(Kind::Magnitudes, 4 * MAGNITUDES), (Kind::Phases, 4 * PHASES), (Kind::Frames, 96)]
                .map(|(kind, row)| (kind, Some(*m), row * self.len()))
        });
        let others = [
            (Kind::Hashes, None, 32 * self.len()),
            (Kind::Thumbnails, None, THUMBNAIL * THUMBNAIL * self.len()),
            (Kind::SummaryOffsets, None, 8 * (self.len() + 1)),
        ];
        for (kind, method, length) in per_method.chain(others) {
            match self.layout.find(kind, method) {
                Some(section) if section.length == length as u64 => {}
                found => return Err(format!("section {kind:?} should have {length} bytes, found {found:?}")),
            }
        }
        Ok(())
    }

    /// Number of models done.
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// Whether no model was done.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The id of model `i`.
    pub fn id(&self, i: usize) -> &str {
        self.ids.get(self.section(Kind::Ids, None).unwrap_or_default(), i)
    }

    /// The row of the model with this id.
    pub fn find(&self, id: &str) -> Option<usize> {
        let (mut low, mut high) = (0, self.len());
        while low < high {
            let middle = low.midpoint(high);
            match self.id(middle).cmp(id) {
                std::cmp::Ordering::Less => low = middle + 1,
                std::cmp::Ordering::Equal => return Some(middle),
                std::cmp::Ordering::Greater => high = middle,
            }
        }
        None
    }

    /// BLAKE3 of the bytes of model `i`.
    pub fn hash(&self, i: usize) -> Hash {
        let rows = self.section(Kind::Hashes, None).unwrap_or_default();
        std::array::from_fn(|k| rows[32 * i + k])
    }

    /// The methods whose frames the store holds, in the order of the run.
    pub fn methods(&self) -> &[Method] {
        &self.methods
    }

    /// Magnitude descriptors, [`MAGNITUDES`] numbers a model: row i is model i. `None`: not in this store.
    pub fn magnitudes(&self, method: Method) -> Option<&[f32]> {
        <[f32]>::ref_from_bytes(self.section(Kind::Magnitudes, Some(method))?).ok()
    }

    /// Phase descriptors, [`PHASES`] numbers a model: row i is model i. `None`: not in this store.
    pub fn phases(&self, method: Method) -> Option<&[f32]> {
        <[f32]>::ref_from_bytes(self.section(Kind::Phases, Some(method))?).ok()
    }

    /// The frame of model `i` by `method`. `None`: not in this store.
    pub fn frame(&self, method: Method, i: usize) -> Option<Frame> {
        let rows = <[[f64; 12]]>::ref_from_bytes(self.section(Kind::Frames, Some(method))?).ok()?;
        rows.get(i).map(frame_of)
    }

    /// The evidence for model `i`; an error where the bytes are damaged.
    pub fn summary(&self, i: usize) -> Result<Summary> {
        let decoded = self.summary_bytes(i).ok_or_else(|| "its bytes are out of range".to_owned());
        let summary = decoded.and_then(encoding::decode);
        summary.map_err(|why| self.error(format!("summary of {}: {why}", self.id(i))))
    }

    fn summary_bytes(&self, i: usize) -> Option<&[u8]> {
        let offsets = self.section(Kind::SummaryOffsets, None)?;
        let (start, end) = (u64_at(offsets, 8 * i), u64_at(offsets, 8 * i + 8));
        self.section(Kind::Summaries, None)?.get(usize::try_from(start).ok()?..usize::try_from(end).ok()?)
    }

    /// The picture of model `i`: [`THUMBNAIL`] x [`THUMBNAIL`] grey levels, row by row.
    pub fn thumbnail(&self, i: usize) -> &[u8] {
        let size = THUMBNAIL * THUMBNAIL;
        &self.section(Kind::Thumbnails, None).unwrap_or_default()[size * i..size * (i + 1)]
    }

    /// The models that were lost, sorted by id.
    pub fn failures(&self) -> &[Failure] {
        &self.failures
    }

    /// The settings that the results depend on, as TOML.
    pub fn settings(&self) -> &str {
        &self.settings
    }

    /// All that is kept of model `i`; an error where the bytes are damaged.
    pub fn record(&self, i: usize) -> Result<ModelRecord> {
        let poses = self.methods.iter().map(|&method| self.pose(method, i)).collect::<Option<Vec<_>>>();
        let poses = poses.ok_or_else(|| self.error(format!("no row {i}")))?;
        Ok(ModelRecord { summary: self.summary(i)?, thumbnail: self.thumbnail(i).to_vec(), poses })
    }

    fn pose(&self, method: Method, i: usize) -> Option<Pose> {
        let magnitude = self.magnitudes(method)?.chunks_exact(MAGNITUDES).nth(i)?.to_vec();
        let phase = self.phases(method)?.chunks_exact(PHASES).nth(i)?.to_vec();
        Some(Pose { method, frame: super::record::frame_numbers(&self.frame(method, i)?), magnitude, phase })
    }

    /// The published file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Where the sections lie in the published file.
    pub fn sections(&self) -> &[Section] {
        &self.layout.sections
    }

    /// All bytes of the published file.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.map
    }

    pub(super) fn layout(&self) -> &Layout {
        &self.layout
    }

    pub(super) fn error(&self, why: String) -> RunError {
        RunError::Store { path: self.path.clone(), why }
    }

    /// The bytes of a section.
    fn section(&self, kind: Kind, method: Option<Method>) -> Option<&[u8]> {
        self.layout.find(kind, method).map(|section| bytes_of(&self.map, section))
    }
}

/// The bytes of a section that [`Layout::of`] found to lie inside the file.
pub(super) fn bytes_of<'a>(file: &'a [u8], section: &Section) -> &'a [u8] {
    &file[section.offset as usize..(section.offset + section.length) as usize]
}

/// The bytes of a section that belongs to no method, checked against its checksum.
fn checked<'a>(file: &'a [u8], layout: &Layout, kind: Kind) -> std::result::Result<&'a [u8], String> {
    let section = layout.find(kind, None).ok_or_else(|| format!("section {kind:?} is missing"))?;
    let bytes = bytes_of(file, section);
    if crc32fast::hash(bytes) == section.crc { Ok(bytes) } else { Err(format!("section {kind:?} is damaged")) }
}
