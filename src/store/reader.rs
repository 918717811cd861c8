//! The mapped, read-only view of a published store.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

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
    /// Of each section, whether its checksum is right: found out when it is first asked for.
    whole: Vec<OnceLock<bool>>,
    ids: Ids,
    /// The copies of ids and hashes that are whole.
    ids_section: Section,
    hashes_section: Section,
    methods: Vec<Method>,
    failures: Vec<Failure>,
    settings: String,
}

fn is_missing(error: &std::io::Error) -> bool {
    error.kind() == std::io::ErrorKind::NotFound
}

/// There is no published file: what to do about it.
fn missing(dir: &Path) -> RunError {
    let why = if super::journal_path(dir).exists() {
        "is not finished: what was computed is in its journal; run the same command again to finish and publish it"
    } else {
        "is no store: `symalign run FOLDER --store DIR` makes one, --store names another"
    };
    RunError::Store { path: dir.into(), why: why.into() }
}

impl Store {
    /// Maps the published file of the store folder `dir` and checks its head, ids, hashes, failures and settings, of
    /// which there are two copies each. A section of rows is checked when it is first asked for, so that damage is an
    /// error and never a wrong number; [`Store::verify`] checks all.
    ///
    /// Errors: no such file, both copies damaged (with the section), or a format version this program does not read.
    pub fn open(dir: &Path) -> Result<Self> {
        let path = super::published_path(dir);
        let file =
            File::open(&path).map_err(|e| if is_missing(&e) { missing(dir) } else { RunError::file(&path, e) })?;
        // SAFETY: a published file is only ever replaced by rename, never written in place, so the mapped bytes do
        // not change; a user who edits or truncates the file while it is mapped breaks this, as for any map.
        #[allow(unsafe_code)]
        let map = unsafe { Mmap::map(&file) }.map_err(|e| RunError::file(&path, e))?;
        Self::from_map(path.clone(), map).map_err(|why| RunError::Store { path, why })
    }

    fn from_map(path: PathBuf, map: Mmap) -> std::result::Result<Self, String> {
        let layout = Layout::of(&map)?;
        let small = |kind| whole_copy(&map, &layout, kind);
        let bytes = |kind| small(kind).map(|section| bytes_of(&map, &section));
        let settings = std::str::from_utf8(bytes(Kind::Settings)?).map_err(|e| format!("settings: {e}"))?.to_owned();
        let ids_section = small(Kind::Ids)?;
        let hashes_section = small(Kind::Hashes)?;
        let ids = Ids::of(bytes_of(&map, &ids_section), layout.models)?;
        let failures = encoding::decode(bytes(Kind::Failures)?).map_err(|e| format!("failures: {e}"))?;
        let frames = layout.sections.iter().filter(|s| s.kind == Kind::Frames);
        let methods: Vec<Method> = frames.filter_map(|s| s.method).collect();
        let whole = layout.sections.iter().map(|_| OnceLock::new()).collect();
        let store = Self { path, map, layout, whole, ids, ids_section, hashes_section, methods, failures, settings };
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
            let lengths: Vec<_> = self.layout.find(kind, method).map(|i| self.layout.sections[i].length).collect();
            if lengths.is_empty() || lengths.iter().any(|found| *found != length as u64) {
                return Err(format!("section {kind:?} should have {length} bytes, it has {lengths:?}"));
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
        self.ids.get(bytes_of(&self.map, &self.ids_section), i)
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
        let rows = bytes_of(&self.map, &self.hashes_section);
        std::array::from_fn(|k| rows[32 * i + k])
    }

    /// The methods whose frames the store holds, in the order of the run.
    pub fn methods(&self) -> &[Method] {
        &self.methods
    }

    /// Magnitude descriptors, [`MAGNITUDES`] numbers a model: row i is model i.
    ///
    /// Errors: a method that the store does not hold, or damage; so for all that follows.
    pub fn magnitudes(&self, method: Method) -> Result<&[f32]> {
        self.numbers(Kind::Magnitudes, method)
    }

    /// Phase descriptors, [`PHASES`] numbers a model: row i is model i.
    pub fn phases(&self, method: Method) -> Result<&[f32]> {
        self.numbers(Kind::Phases, method)
    }

    /// The frame of model `i` by `method`.
    pub fn frame(&self, method: Method, i: usize) -> Result<Frame> {
        let rows: &[[f64; 12]] = self.numbers(Kind::Frames, method)?;
        rows.get(i).map(frame_of).ok_or_else(|| self.error(format!("no row {i}")))
    }

    /// The section of a method as rows of numbers.
    fn numbers<T>(&self, kind: Kind, method: Method) -> Result<&[T]>
    where
        [T]: FromBytes + zerocopy::Immutable + zerocopy::KnownLayout<PointerMetadata = usize>,
    {
        if !self.methods.contains(&method) {
            let known: Vec<_> = self.methods.iter().map(|method| method.name()).collect();
            return Err(RunError::Usage(format!(
                "the store has no frame `{}`, only {}",
                method.name(),
                known.join(", ")
            )));
        }
        let bytes = self.section(kind, Some(method))?;
        <[T]>::ref_from_bytes(bytes).map_err(|_| self.error(format!("section {kind:?} holds no whole rows")))
    }

    /// The evidence for model `i`.
    pub fn summary(&self, i: usize) -> Result<Summary> {
        let bytes = self.summary_bytes(i)?.ok_or_else(|| "its bytes are out of range".to_owned());
        let summary = bytes.and_then(encoding::decode);
        summary.map_err(|why| self.error(format!("summary of {}: {why}", self.id(i))))
    }

    fn summary_bytes(&self, i: usize) -> Result<Option<&[u8]>> {
        let (offsets, all) = (self.section(Kind::SummaryOffsets, None)?, self.section(Kind::Summaries, None)?);
        let at = |row| usize::try_from(u64_at(offsets, 8 * row)).ok();
        Ok(at(i).zip(at(i + 1)).and_then(|(start, end)| all.get(start..end)))
    }

    /// The picture of model `i`: [`THUMBNAIL`] x [`THUMBNAIL`] grey levels, row by row.
    pub fn thumbnail(&self, i: usize) -> Result<&[u8]> {
        let size = THUMBNAIL * THUMBNAIL;
        Ok(&self.section(Kind::Thumbnails, None)?[size * i..size * (i + 1)])
    }

    /// The models that were lost, sorted by id.
    pub fn failures(&self) -> &[Failure] {
        &self.failures
    }

    /// The settings that the results depend on, as TOML.
    pub fn settings(&self) -> &str {
        &self.settings
    }

    /// All that is kept of model `i`.
    pub fn record(&self, i: usize) -> Result<ModelRecord> {
        let poses = self.methods.iter().map(|&method| self.pose(method, i)).collect::<Result<_>>()?;
        Ok(ModelRecord { summary: self.summary(i)?, thumbnail: self.thumbnail(i)?.to_vec(), poses })
    }

    fn pose(&self, method: Method, i: usize) -> Result<Pose> {
        let magnitude = self.magnitudes(method)?[i * MAGNITUDES..(i + 1) * MAGNITUDES].to_vec();
        let phase = self.phases(method)?[i * PHASES..(i + 1) * PHASES].to_vec();
        Ok(Pose { method, frame: super::record::frame_numbers(&self.frame(method, i)?), magnitude, phase })
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

    /// Whether the checksum of section `i` is right.
    pub(super) fn is_whole(&self, i: usize) -> bool {
        *self.whole[i].get_or_init(|| crc_is_right(&self.map, &self.layout.sections[i]))
    }

    /// The bytes of a section, or of its copy where it is damaged.
    fn section(&self, kind: Kind, method: Option<Method>) -> Result<&[u8]> {
        let whole = self.layout.find(kind, method).find(|i| self.is_whole(*i));
        let bytes = whole.map(|i| bytes_of(&self.map, &self.layout.sections[i]));
        bytes.ok_or_else(|| self.error(damaged(&self.layout, kind, method)))
    }
}

/// The bytes of a section that [`Layout::of`] found to lie inside the file.
pub(super) fn bytes_of<'a>(file: &'a [u8], section: &Section) -> &'a [u8] {
    &file[section.offset as usize..(section.offset + section.length) as usize]
}

fn crc_is_right(file: &[u8], section: &Section) -> bool {
    crc32fast::hash(bytes_of(file, section)) == section.crc
}

/// The first copy that is whole of a section that belongs to no method.
fn whole_copy(file: &[u8], layout: &Layout, kind: Kind) -> std::result::Result<Section, String> {
    let mut copies = layout.find(kind, None).map(|i| layout.sections[i]);
    copies.find(|section| crc_is_right(file, section)).ok_or_else(|| damaged(layout, kind, None))
}

/// What is said of a section without a whole copy.
fn damaged(layout: &Layout, kind: Kind, method: Option<Method>) -> String {
    match layout.find(kind, method).next().map(|i| &layout.sections[i]) {
        Some(section) => format!(
            "section {} at byte {} is damaged; the same `run` again publishes it anew and computes nothing twice",
            section.name(),
            section.offset
        ),
        None => format!("section {kind:?} is missing"),
    }
}
