//! Where models come from: files, folders, archives, standard input.
//!
//! [`visit`] hands out one [`Member`] after the other; nothing is unpacked to disk and no more than one member is in
//! memory. A member that cannot be read is handed out with its reason; names are only ever used as ids, so that
//! absolute names and `..` do no harm.

mod expand;
mod kind;
mod names;

use std::fs::File;
use std::io::{BufReader, Read};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use crate::error::{Result, RunError};
use expand::Budget;
pub use kind::{Kind, kind_of};
pub use names::{prefixes, unique};

/// Limits on what is read, so that a small file cannot fill the memory or keep the reader for ever.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Largest model, bytes after decompression.
    pub bytes: u64,
    /// How many times its own size an archive may unpack to (checked beyond the first GiB).
    pub expansion: u64,
}

/// A model's id and bytes, or why it could not be read.
#[derive(Debug)]
pub struct Member {
    /// Its path inside the input, `archive.zip!folder/part.step` for members.
    pub id: String,
    /// Its bytes unpacked, or why they could not be read.
    pub bytes: std::result::Result<Vec<u8>, String>,
}

/// What is called for each member; gives memory that the next one may be read into. `Break` ends the visit.
pub type Each<'a> = dyn FnMut(Member) -> ControlFlow<(), Vec<u8>> + 'a;

/// What is asked before a member of so many bytes is read, and again where it unpacks to more; may wait until there is
/// room. `Break` ends the visit.
pub type Room<'a> = dyn Fn(u64) -> ControlFlow<()> + 'a;

/// [`Room`] without end.
pub fn no_wait(_: u64) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Visits all models of `inputs`: files, folders (recursive, in the order of the names), archives, and `-` for a tar
/// stream on standard input. With several inputs, ids start with the input's name.
///
/// Errors: an input that is not there. All else is the matter of one member.
pub fn visit(inputs: &[PathBuf], limits: &Limits, room: &Room, each: &mut Each) -> Result<()> {
    let mut memory = Vec::new();
    for (input, prefix) in inputs.iter().zip(prefixes(inputs)) {
        let mut visit = Visit { limits, room, each, memory: &mut memory, going: true };
        if input.as_os_str() == "-" {
            visit.tar(&prefix, expand::sniffed(std::io::stdin().lock()), u64::MAX);
        } else {
            let meta = input.metadata().map_err(|e| RunError::file(input, e))?;
            if meta.is_dir() { visit.folder(input, &prefix) } else { visit.named_file(input, &prefix) }
        }
        if !visit.going {
            break;
        }
    }
    Ok(())
}

/// Models in `inputs` as far as they can be counted without reading archives, and whether that is all of them.
pub fn count(inputs: &[PathBuf]) -> (usize, bool) {
    let (mut models, mut all) = (0, true);
    for input in inputs {
        all &= input.as_os_str() != "-";
        for entry in walkdir::WalkDir::new(input).follow_links(true).into_iter().flatten() {
            match kind_of(&entry.file_name().to_string_lossy()) {
                Some(Kind::Model(_)) if entry.file_type().is_file() => models += 1,
                Some(_) if entry.file_type().is_file() => all = false,
                _ => {}
            }
        }
    }
    (models, all)
}

/// What a file that is written while it is read fails with.
const CHANGED: &str = "it changed while it was read; run again";

/// Of a file, what changes when it is written to.
struct State {
    length: u64,
    modified: Option<std::time::SystemTime>,
}

impl State {
    fn of(file: &File) -> std::io::Result<Self> {
        let meta = file.metadata()?;
        Ok(Self { length: meta.len(), modified: meta.modified().ok() })
    }

    fn has_changed(&self, file: &File) -> bool {
        Self::of(file).is_ok_and(|now| (now.length, now.modified) != (self.length, self.modified))
    }
}

/// A visit of one input.
struct Visit<'a, 'b> {
    limits: &'a Limits,
    room: &'a Room<'b>,
    each: &'a mut Each<'b>,
    /// What the next member is read into.
    memory: &'a mut Vec<u8>,
    /// Cleared when the caller has had enough.
    going: bool,
}

impl Visit<'_, '_> {
    fn give(&mut self, id: String, bytes: std::result::Result<Vec<u8>, String>) {
        if self.going {
            match (self.each)(Member { id, bytes }) {
                ControlFlow::Continue(memory) => *self.memory = memory,
                ControlFlow::Break(()) => self.going = false,
            }
        }
    }

    fn folder(&mut self, folder: &Path, prefix: &str) {
        let walk = walkdir::WalkDir::new(folder).follow_links(true).sort_by_file_name();
        for entry in walk {
            if !self.going {
                return;
            }
            match entry {
                Ok(entry) if entry.file_type().is_file() => {
                    let id = format!("{prefix}{}", names::inside(folder, entry.path()));
                    if kind_of(&id).is_some() {
                        self.file(entry.path(), id);
                    }
                }
                Ok(_) => {}
                Err(error) => {
                    let path = error.path().unwrap_or(folder);
                    let id = format!("{prefix}{}", names::inside(folder, path));
                    self.give(id, Err(format!("cannot be read: {error}")));
                }
            }
        }
    }

    /// A file that the user named: its own name is its id.
    fn named_file(&mut self, path: &Path, prefix: &str) {
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        self.file(path, if prefix.is_empty() { name } else { prefix.trim_end_matches('/').to_owned() });
    }

    fn file(&mut self, path: &Path, id: String) {
        let opened = File::open(path).and_then(|file| Ok((State::of(&file)?, file)));
        let (before, file) = match opened {
            Ok(opened) => opened,
            Err(error) => return self.give(id, Err(format!("cannot be read: {error}"))),
        };
        let size = before.length;
        match kind_of(&id) {
            None => return self.model_file(id, Default::default(), &file, &before),
            Some(Kind::Model(packing)) => return self.model_file(id, packing, &file, &before),
            Some(Kind::Zip) => self.zip(&format!("{id}!"), &file, size),
            Some(Kind::SevenZip) => self.seven_zip(&format!("{id}!"), &file, size),
            Some(Kind::Tar(packing)) => match expand::unpacked(packing, &file) {
                Ok(reader) => self.tar(&format!("{id}!"), reader, size),
                Err(error) => self.give(id.clone(), Err(format!("not an archive: {error}"))),
            },
        }
        if before.has_changed(&file) {
            self.give(id, Err(CHANGED.into()));
        }
    }

    fn model_file(&mut self, id: String, packing: kind::Packing, file: &File, before: &State) {
        let bytes = self.read(packing, before.length, file);
        self.give(id, bytes.and_then(|bytes| if before.has_changed(file) { Err(CHANGED.into()) } else { Ok(bytes) }));
    }

    /// All bytes of a model that is `size` bytes as it lies there.
    fn read(&mut self, packing: kind::Packing, size: u64, reader: impl Read) -> std::result::Result<Vec<u8>, String> {
        let room = |bytes| {
            self.going &= (self.room)(bytes).is_continue();
            if self.going { Ok(()) } else { Err("the run was stopped".to_owned()) }
        };
        let reader = expand::unpacked(packing, reader).map_err(|e| e.to_string())?;
        let memory = std::mem::take(self.memory);
        expand::read_limited(reader, memory, size, self.limits.bytes, room)
    }

    /// A member of an archive whose name is `name`.
    fn member(&mut self, prefix: &str, name: &str, size: u64, reader: impl Read) {
        if let Some(Kind::Model(packing)) = kind_of(name) {
            let bytes = self.read(packing, size, reader);
            self.give(format!("{prefix}{}", names::cleaned(name)), bytes);
        }
    }

    fn tar(&mut self, prefix: &str, reader: impl Read, size: u64) {
        let mut archive = tar::Archive::new(Budget::new(reader, size, self.limits.expansion));
        let entries = match archive.entries() {
            Ok(entries) => entries,
            Err(error) => return self.broken(prefix, &error),
        };
        for entry in entries {
            if !self.going {
                return;
            }
            match entry {
                Ok(entry) if entry.header().entry_type().is_file() => {
                    let name = String::from_utf8_lossy(&entry.path_bytes()).into_owned();
                    let size = entry.size();
                    self.member(prefix, &name, size, expand::Whole::new(entry, size));
                }
                Ok(_) => {}
                Err(error) => return self.broken(prefix, &error),
            }
        }
    }

    fn zip(&mut self, prefix: &str, file: &File, size: u64) {
        let mut archive = match zip::ZipArchive::new(BufReader::new(file)) {
            Ok(archive) => archive,
            Err(error) => return self.broken(prefix, &error),
        };
        let mut left = expand::allowance(size, self.limits.expansion);
        for i in 0..archive.len() {
            if !self.going {
                return;
            }
            let name = archive.name_for_index(i).and_then(|name| Some(name.ok()?.into_owned()));
            match archive.by_index(i) {
                Ok(member) if member.is_file() && left > 0 => {
                    let size = member.size();
                    left = left.saturating_sub(size);
                    self.member(prefix, &name.unwrap_or_default(), size, member);
                }
                Ok(member) if member.is_file() => return self.broken(prefix, &expand::TOO_LARGE),
                Ok(_) => {}
                Err(error) => self.lost_member(prefix, &name.unwrap_or_else(|| format!("member {i}")), &error),
            }
        }
    }

    fn seven_zip(&mut self, prefix: &str, file: &File, size: u64) {
        let mut archive = match sevenz_rust2::ArchiveReader::new(BufReader::new(file), sevenz_rust2::Password::empty())
        {
            Ok(archive) => archive,
            Err(error) => return self.broken(prefix, &error),
        };
        let mut left = expand::allowance(size, self.limits.expansion);
        let visited = archive.for_each_entries(|entry, reader| {
            if left == 0 {
                return Err(sevenz_rust2::Error::from(std::io::Error::other(expand::TOO_LARGE)));
            }
            left = left.saturating_sub(entry.size());
            if !entry.is_directory() {
                self.member(prefix, entry.name(), entry.size(), &mut *reader);
                // What a limit left unread must be passed over: the members share one stream.
                std::io::copy(reader, &mut std::io::sink()).map_err(sevenz_rust2::Error::from)?;
            }
            Ok(self.going)
        });
        if let Err(error) = visited {
            self.broken(prefix, &error);
        }
    }

    fn lost_member(&mut self, prefix: &str, name: &str, error: &dyn std::fmt::Display) {
        if matches!(kind_of(name), Some(Kind::Model(_))) {
            self.give(format!("{prefix}{}", names::cleaned(name)), Err(format!("cannot be unpacked: {error}")));
        }
    }

    /// The archive cannot be read on: a failure under its own name.
    fn broken(&mut self, prefix: &str, error: &dyn std::fmt::Display) {
        let id = prefix.trim_end_matches(['!', '/']);
        let id = if id.is_empty() { "-" } else { id };
        self.give(id.to_owned(), Err(format!("the archive cannot be read on: {error}")));
    }
}

#[cfg(test)]
mod tests;
