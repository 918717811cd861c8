//! The journal of a run: what was done, in the order it was done, safe against a stop at any instant.
//!
//! Records are self-delimiting and carry a checksum. A torn tail is cut off; damage in the middle is skipped,
//! reported, and costs the models in it only. The layout is told in `FORMAT.md`.

use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};

use super::encoding::{decode, encode};
use super::format::{u32_at, u64_at};
use super::record::{Hash, ModelRecord};
use crate::error::{Result, RunError};
use crate::stages::ModelError;

/// Starts every record; lets reading go on behind damage.
const MARK: [u8; 4] = *b"\xABrec";
/// Mark, kind, length, checksum.
const HEAD: usize = 20;
/// No record is longer than this, bytes.
const LONGEST: u64 = 1 << 30;
/// The first record says which settings the others were made with.
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
    damage: Vec<String>,
    unsynced: usize,
}

impl Journal {
    /// A new, empty journal for these settings, replacing any that was there.
    pub fn create(path: &Path, settings: &str) -> Result<Self> {
        let mut journal = Self::open_file(path, true)?;
        // Twice: without its settings a journal is worth nothing, so one damaged copy must not lose them.
        journal.write(SETTINGS, settings.as_bytes())?;
        journal.write(SETTINGS, settings.as_bytes())?;
        journal.commit()?;
        Ok(journal)
    }

    /// Opens the journal at `path` and returns it with the settings it was made with. A torn tail is cut off.
    ///
    /// `None`: there is none, or it was cut off before its settings were whole.
    ///
    /// Errors: it cannot be read, or there are outcomes but both copies of the settings are damaged.
    pub fn open(path: &Path) -> Result<Option<(Self, String)>> {
        if !path.exists() {
            return Ok(None);
        }
        let mut journal = Self::open_file(path, false)?;
        let settings = journal.scan()?;
        let torn = journal.file_length()? - journal.length;
        if torn > 0 {
            journal.file.set_len(journal.length).map_err(|e| RunError::file(path, e))?;
        }
        match settings {
            Some(settings) => Ok(Some((journal, settings))),
            None if journal.is_empty() => Ok(None),
            None => Err(journal.error("both copies of its settings are damaged; start over with --fresh".into())),
        }
    }

    fn open_file(path: &Path, fresh: bool) -> Result<Self> {
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(fresh).open(path);
        let file = file.map_err(|e| RunError::file(path, e))?;
        let path = path.to_owned();
        Ok(Self { path, file, length: 0, index: HashMap::new(), damage: Vec::new(), unsynced: 0 })
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
        let payload = [&hash[..], &[u8::from(done)], &body].concat();
        let place = Place { offset: self.length, length: payload.len(), done };
        self.write(MODEL, &payload)?;
        self.index.insert(*hash, place);
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

    /// Stretches that were damaged, in words; the models in them have to be computed anew.
    pub fn damage(&self) -> &[String] {
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

    /// Reads all records and returns the settings; leaves `length` behind the last whole record.
    fn scan(&mut self) -> Result<Option<String>> {
        let total = self.file_length()?;
        let (mut at, mut settings) = (0, None);
        while at < total {
            match self.record_at(at, total)? {
                Some((kind, payload)) => {
                    let end = at + (HEAD + payload.len()) as u64;
                    if at > self.length {
                        self.damage.push(format!("bytes {} to {at} are damaged and were skipped", self.length));
                    }
                    if kind == SETTINGS && settings.is_none() {
                        settings = String::from_utf8(payload).ok();
                    } else if kind == MODEL && payload.len() >= KEY {
                        self.remember(at, &payload);
                    }
                    (at, self.length) = (end, end);
                }
                None => at = self.next_mark(at + 1, total)?,
            }
        }
        Ok(settings)
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
mod tests {
    use super::*;
    use crate::stages::Stage;

    fn lost(why: &str) -> Outcome {
        Err(ModelError::new(Stage::Parse, why))
    }

    /// Three lost models with the hashes [1; 32], [2; 32], [3; 32].
    fn journal(dir: &Path) -> PathBuf {
        let path = dir.join("journal");
        let mut journal = Journal::create(&path, "a = 1").unwrap();
        for i in 1..=3 {
            journal.append(&[i; 32], &lost(&format!("reason {i}"))).unwrap();
        }
        journal.commit().unwrap();
        path
    }

    fn known(journal: &Journal) -> Vec<u8> {
        (1..=3).filter(|i| journal.outcome(&[*i; 32]).unwrap() == Some(lost(&format!("reason {i}")))).collect()
    }

    #[test]
    fn outcomes_survive_and_the_last_one_counts() {
        let dir = tempfile::tempdir().unwrap();
        let (mut journal, settings) = Journal::open(&journal(dir.path())).unwrap().unwrap();
        assert_eq!((settings.as_str(), known(&journal)), ("a = 1", vec![1, 2, 3]));
        journal.append(&[1; 32], &lost("again")).unwrap();
        assert_eq!(journal.outcome(&[1; 32]).unwrap(), Some(lost("again")));
        assert_eq!((journal.len(), journal.knows(&[1; 32]), journal.knows(&[9; 32])), (3, Some(false), None));
    }

    #[test]
    fn a_tail_torn_at_any_byte_is_cut_off() {
        let dir = tempfile::tempdir().unwrap();
        let path = journal(dir.path());
        let whole = std::fs::read(&path).unwrap();
        let head = 2 * (HEAD + 5);
        let record = (whole.len() - head) / 3;
        for length in 0..whole.len() {
            std::fs::write(&path, &whole[..length]).unwrap();
            let records = length.saturating_sub(head) / record;
            let Some((journal, _)) = Journal::open(&path).unwrap() else {
                assert!(length < HEAD + 5, "settings lost at {length}");
                continue;
            };
            assert_eq!((journal.len(), journal.damage().len()), (records, 0), "at {length}");
            drop(journal);
            let kept = if length < head { HEAD + 5 } else { head + records * record };
            assert_eq!(std::fs::read(&path).unwrap(), whole[..kept]);
        }
    }

    #[test]
    fn a_flipped_bit_costs_one_record_only() {
        let dir = tempfile::tempdir().unwrap();
        let path = journal(dir.path());
        let whole = std::fs::read(&path).unwrap();
        let head = 2 * (HEAD + 5);
        let record = (whole.len() - head) / 3;
        let second = head + record..head + 2 * record;
        for bit in second.start * 8..second.end * 8 {
            let mut bytes = whole.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            std::fs::write(&path, &bytes).unwrap();
            let (journal, _) = Journal::open(&path).unwrap().unwrap();
            assert_eq!((known(&journal), journal.damage().len()), (vec![1, 3], 1), "bit {bit}");
        }
    }

    #[test]
    fn one_damaged_copy_of_the_settings_loses_nothing() {
        let dir = tempfile::tempdir().unwrap();
        let path = journal(dir.path());
        let whole = std::fs::read(&path).unwrap();
        for copy in [0, HEAD + 5] {
            let mut bytes = whole.clone();
            bytes[copy + HEAD] ^= 1;
            std::fs::write(&path, &bytes).unwrap();
            let (journal, settings) = Journal::open(&path).unwrap().unwrap();
            assert_eq!((settings.as_str(), known(&journal)), ("a = 1", vec![1, 2, 3]));
        }
        let mut bytes = whole.clone();
        bytes[HEAD] ^= 1;
        bytes[HEAD + 5 + HEAD] ^= 1;
        std::fs::write(&path, &bytes).unwrap();
        assert!(Journal::open(&path).unwrap_err().to_string().contains("settings"));
    }
}
