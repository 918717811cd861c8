//! The journal of a run: what was done, in the order it was done, safe against a stop at any instant.
//!
//! Records are self-delimiting and carry a checksum. A torn tail is cut off; damage in the middle is skipped. Both are
//! reported, and cost the models in them only. The layout is told in `FORMAT.md`.

use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};

use super::encoding::{decode, encode};
use super::format::{VERSION, u32_at, u64_at, version_error};
use super::record::{Hash, ModelRecord};
use super::verify::Damage;
use super::writer::sync_folder;
use crate::error::{Result, RunError};
use crate::stages::ModelError;

/// Starts every record; lets reading go on behind damage.
const MARK: [u8; 4] = *b"\xABrec";
/// Mark, kind, length, checksum.
const HEAD: usize = 20;
/// No record is longer than this, bytes.
const LONGEST: u64 = 1 << 30;
/// The first record says which format and settings the others were made with.
const SETTINGS: u32 = 1;
/// A model done or lost.
const MODEL: u32 = 2;
/// Bytes of a model's content hash and its outcome flag at the start of its payload.
const KEY: usize = 33;

/// The outcome of one model.
pub type Outcome = std::result::Result<ModelRecord, ModelError>;

/// Where a payload lies, and whether it tells of a model done (not lost).
#[derive(Clone, Copy, Debug)]
struct Place {
    offset: u64,
    length: usize,
    done: bool,
}

/// An open journal: its last outcome for each content hash.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    /// Bytes of whole records.
    length: u64,
    index: HashMap<Hash, Place>,
    damage: Vec<Damage>,
    unsynced: usize,
}

/// What the first record of a journal holds: format version, settings.
type Made = (u32, String);

impl Journal {
    /// A new, empty journal for these settings, replacing any that was there.
    pub fn create(path: &Path, settings: &str) -> Result<Self> {
        Self::create_with(path, settings, &mut |_| Ok(()))
    }

    /// [`Journal::create`], with what `fill` appends. At `path` it is there whole or not at all.
    pub fn create_with(path: &Path, settings: &str, fill: &mut dyn FnMut(&mut Self) -> Result<()>) -> Result<Self> {
        let draft = path.with_extension("symalign.draft");
        let mut journal = Self::of(&draft, OpenOptions::new().read(true).write(true).create(true).truncate(true))?;
        let made = [&VERSION.to_le_bytes()[..], settings.as_bytes()].concat();
        // Twice: without its settings a journal is worth nothing, so one damaged copy must not lose them.
        journal.write(SETTINGS, &made)?;
        journal.write(SETTINGS, &made)?;
        fill(&mut journal)?;
        journal.commit()?;
        std::fs::rename(&draft, path).map_err(|e| RunError::file(path, e))?;
        path.clone_into(&mut journal.path);
        path.parent().map_or(Ok(()), sync_folder)?;
        Ok(journal)
    }

    /// Opens the journal at `path` and returns it with the settings it was made with. A torn tail is cut off, and where
    /// more is damaged, the journal is written anew without it.
    ///
    /// `None`: there is none.
    ///
    /// Errors: it cannot be read, both copies of the settings are damaged, or it has another format version.
    pub fn open(path: &Path) -> Result<Option<(Self, String)>> {
        if !path.exists() {
            return Ok(None);
        }
        let mut journal = Self::of(path, OpenOptions::new().read(true).write(true))?;
        let made = journal.scan()?;
        let settings = journal.settings(made)?;
        let damage = std::mem::take(&mut journal.damage);
        if damage.iter().any(|damage| damage.offset < journal.length) {
            journal = journal.mended(&settings)?;
        } else if !damage.is_empty() {
            journal.file.set_len(journal.length).map_err(|e| RunError::file(path, e))?;
        }
        Ok(Some((Self { damage, ..journal }, settings)))
    }

    /// A copy of what is whole, in the place of this journal.
    fn mended(self, settings: &str) -> Result<Self> {
        let mut places: Vec<_> = self.index.values().collect();
        places.sort_unstable_by_key(|place| place.offset);
        Self::create_with(&self.path, settings, &mut |copy| {
            places.iter().try_for_each(|place| copy.append_payload(&self.payload(place)?))
        })
    }

    /// Reads the journal at `path` without changing it: its number of models, and what is damaged. The tail of a
    /// journal that is being written may be torn.
    pub fn verify(path: &Path) -> Result<(usize, Vec<Damage>)> {
        let mut journal = Self::of(path, OpenOptions::new().read(true))?;
        let made = journal.scan()?;
        journal.settings(made)?;
        let mut places: Vec<_> = journal.index.iter().collect();
        places.sort_unstable_by_key(|(_, place)| place.offset);
        for (hash, place) in places {
            if let Err(error) = journal.outcome(hash) {
                let (offset, length) = (place.offset, (HEAD + place.length) as u64);
                journal.damage.push(Damage { place: error.to_string(), offset, length });
            }
        }
        Ok((journal.len(), journal.damage))
    }

    fn of(path: &Path, options: &OpenOptions) -> Result<Self> {
        let file = options.open(path).map_err(|e| RunError::file(path, e))?;
        let path = path.to_owned();
        Ok(Self { path, file, length: 0, index: HashMap::new(), damage: Vec::new(), unsynced: 0 })
    }

    fn settings(&self, made: Option<Made>) -> Result<String> {
        match made {
            Some((VERSION, settings)) => Ok(settings),
            Some((version, _)) => Err(self.error(version_error(version))),
            None => Err(self.error("both copies of its settings are damaged; start over with --fresh".into())),
        }
    }

    fn file_length(&self) -> Result<u64> {
        Ok(self.file.metadata().map_err(|e| RunError::file(&self.path, e))?.len())
    }

    /// The outcome of the model with these bytes was recorded; `Some(true)`: done, `Some(false)`: lost.
    pub fn knows(&self, hash: &Hash) -> Option<bool> {
        self.index.get(hash).map(|place| place.done)
    }

    /// All recorded models, in no order; true: done, false: lost.
    pub fn outcomes(&self) -> impl Iterator<Item = (&Hash, bool)> {
        self.index.iter().map(|(hash, place)| (hash, place.done))
    }

    /// The last recorded outcome of the model with these bytes.
    pub fn outcome(&self, hash: &Hash) -> Result<Option<Outcome>> {
        let Some(place) = self.index.get(hash) else { return Ok(None) };
        let payload = self.payload(place)?;
        let body = &payload[KEY..];
        let outcome = if place.done { decode(body).map(Ok) } else { decode(body).map(Err) };
        outcome.map(Some).map_err(|why| self.error(format!("record at byte {}: {why}", place.offset)))
    }

    fn payload(&self, place: &Place) -> Result<Vec<u8>> {
        let mut record = vec![0; HEAD + place.length];
        self.file.read_exact_at(&mut record, place.offset).map_err(|e| RunError::file(&self.path, e))?;
        match check(&record) {
            Some(_) => Ok(record.split_off(HEAD)),
            None => Err(self.error(format!("the record at byte {} was damaged since it was read", place.offset))),
        }
    }

    /// Appends an outcome. It is durable after the next [`Journal::commit`].
    pub fn append(&mut self, hash: &Hash, outcome: &Outcome) -> Result<()> {
        let done = outcome.is_ok();
        let body = match outcome {
            Ok(record) => encode(record),
            Err(error) => encode(error),
        };
        let body = body.map_err(|why| self.error(why))?;
        self.append_payload(&[&hash[..], &[u8::from(done)], &body].concat())
    }

    fn append_payload(&mut self, payload: &[u8]) -> Result<()> {
        let offset = self.length;
        self.write(MODEL, payload)?;
        self.remember(offset, payload);
        self.unsynced += 1;
        Ok(())
    }

    fn write(&mut self, kind: u32, payload: &[u8]) -> Result<()> {
        let record = record(kind, payload);
        let written = self.file.write_all_at(&record, self.length);
        if let Err(error) = written {
            // Best effort: a torn tail would be cut off at the next start anyway.
            let _ = self.file.set_len(self.length);
            return Err(RunError::file(&self.path, error));
        }
        self.length += record.len() as u64;
        Ok(())
    }

    /// Makes all that was appended durable.
    pub fn commit(&mut self) -> Result<()> {
        self.file.sync_data().map_err(|e| RunError::file(&self.path, e))?;
        self.unsynced = 0;
        Ok(())
    }

    /// Outcomes appended since the last commit.
    pub fn unsynced(&self) -> usize {
        self.unsynced
    }

    /// Stretches that were damaged; the models in them have to be computed anew.
    pub fn damage(&self) -> &[Damage] {
        &self.damage
    }

    /// Number of distinct models with a recorded outcome.
    pub fn len(&self) -> usize {
        self.index.len()
    }

    /// Whether no outcome is recorded.
    pub fn is_empty(&self) -> bool {
        self.index.is_empty()
    }

    fn error(&self, why: String) -> RunError {
        RunError::Store { path: self.path.clone(), why }
    }

    /// Reads all records and returns what the first one holds; leaves `length` behind the last whole record.
    fn scan(&mut self) -> Result<Option<Made>> {
        let total = self.file_length()?;
        let (mut at, mut made) = (0, None);
        while at < total {
            match self.record_at(at, total)? {
                Some((kind, payload)) => {
                    let end = at + (HEAD + payload.len()) as u64;
                    self.note_damage("records", at);
                    if kind == SETTINGS && payload.len() >= 4 && made.is_none() {
                        // Records of the first version began with the text itself.
                        let version = u32_at(&payload, 0);
                        let (version, text) = if version > 1000 { (1, 0) } else { (version, 4) };
                        let settings = String::from_utf8(payload[text..].to_vec());
                        made = settings.ok().map(|settings| (version, settings));
                    } else if kind == MODEL && payload.len() >= KEY {
                        self.remember(at, &payload);
                    }
                    (at, self.length) = (end, end);
                }
                None => at = self.next_mark(at + 1, total)?,
            }
        }
        self.note_damage("the last record, not written to its end or changed since", total);
        Ok(made)
    }

    /// What lies between the last whole record and `at` is damaged.
    fn note_damage(&mut self, place: &str, at: u64) {
        if at > self.length {
            let (place, offset) = (place.to_owned(), self.length);
            self.damage.push(Damage { place, offset, length: at - offset });
        }
    }

    fn remember(&mut self, offset: u64, payload: &[u8]) {
        let hash = std::array::from_fn(|i| payload[i]);
        self.index.insert(hash, Place { offset, length: payload.len(), done: payload[KEY - 1] == 1 });
    }

    /// The whole, undamaged record at `at`.
    fn record_at(&self, at: u64, total: u64) -> Result<Option<(u32, Vec<u8>)>> {
        let io = |e| RunError::file(&self.path, e);
        let mut head = [0; HEAD];
        if total - at < HEAD as u64 {
            return Ok(None);
        }
        self.file.read_exact_at(&mut head, at).map_err(io)?;
        let length = u64_at(&head, 8);
        if head[..4] != MARK || length > LONGEST || length > total - at - HEAD as u64 {
            return Ok(None);
        }
        let mut record = vec![0; HEAD + length as usize];
        self.file.read_exact_at(&mut record, at).map_err(io)?;
        Ok(check(&record).map(|kind| (kind, record.split_off(HEAD))))
    }

    /// The next place from `at` on where a record may start, or the end.
    fn next_mark(&self, at: u64, total: u64) -> Result<u64> {
        let mut rest = Vec::new();
        let mut start = at;
        while start < total {
            let chunk = (total - start).min(1 << 20);
            rest.resize(chunk as usize, 0);
            self.file.read_exact_at(&mut rest, start).map_err(|e| RunError::file(&self.path, e))?;
            if let Some(found) = memchr::memmem::find(&rest, &MARK) {
                return Ok(start + found as u64);
            }
            // Chunks overlap, so that a mark across their border is found; the last chunk ends the search.
            start += if start + chunk == total { chunk } else { chunk - MARK.len() as u64 };
        }
        Ok(total)
    }
}

/// Mark, kind, length of the payload, CRC-32 of kind, length and payload; then the payload.
fn record(kind: u32, payload: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEAD + payload.len());
    bytes.extend(MARK);
    bytes.extend(kind.to_le_bytes());
    bytes.extend((payload.len() as u64).to_le_bytes());
    bytes.extend([0; 4]);
    bytes.extend(payload);
    let crc = checksum(&bytes);
    bytes[16..HEAD].copy_from_slice(&crc.to_le_bytes());
    bytes
}

/// The kind of a record whose checksum is right.
fn check(record: &[u8]) -> Option<u32> {
    (checksum(record) == u32_at(record, 16)).then(|| u32_at(record, 4))
}

fn checksum(record: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&record[4..16]);
    hasher.update(&record[HEAD..]);
    hasher.finalize()
}

#[cfg(test)]
mod tests;
