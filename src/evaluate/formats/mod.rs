//! The files of the field: Princeton classifications and matrices, TREC judgements and runs, tables, `metrics.json`.

pub mod cla;
pub mod matrix;
pub mod metrics;
pub mod results;
pub mod table;
pub mod trec;

use crate::error::{Result, RunError};
use std::borrow::Cow;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// A file that appears whole under its name or not at all; what is there under that name may be read meanwhile.
pub struct Draft {
    path: PathBuf,
    draft: PathBuf,
    out: BufWriter<File>,
}

impl Draft {
    /// Begins the file `path` beside it.
    ///
    /// # Errors
    /// Where it cannot be made.
    pub fn create(path: &Path) -> Result<Self> {
        let mut name = path.as_os_str().to_owned();
        name.push(".draft");
        let draft = PathBuf::from(name);
        let file = File::create(&draft).map_err(|source| RunError::file(&draft, source))?;
        Ok(Self { path: path.to_owned(), draft, out: BufWriter::new(file) })
    }

    /// Appends `bytes`.
    ///
    /// # Errors
    /// Where they cannot be written.
    pub fn write(&mut self, bytes: &[u8]) -> Result<()> {
        self.out.write_all(bytes).map_err(|source| RunError::file(&self.draft, source))
    }

    /// Gives the file its name.
    ///
    /// # Errors
    /// Where it cannot be written or renamed.
    pub fn publish(mut self) -> Result<()> {
        let renamed = self.out.flush().and_then(|()| std::fs::rename(&self.draft, &self.path));
        renamed.map_err(|source| RunError::file(&self.path, source))
    }
}

/// Writes the file `path` by `fill`.
///
/// # Errors
/// Where it cannot be written.
pub fn create(path: &Path, fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
    let mut draft = Draft::create(path)?;
    fill(&mut draft.out).map_err(|source| RunError::file(path, source))?;
    draft.publish()
}

/// The name of a method as the start of file names: `:` and what parts folders become `-`.
pub fn file_name(method: &str) -> String {
    method.replace([':', '/', '\\'], "-")
}

/// `text` as one token of a format that is divided by white space: white space and `%` as in URLs (`%20`).
pub fn token(text: &str) -> Cow<'_, str> {
    let plain = |c: char| !c.is_whitespace() && c != '%';
    if text.chars().all(plain) {
        return text.into();
    }
    let mut token = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        if plain(c) {
            token.push(c);
        } else {
            c.encode_utf8(&mut [0; 4]).bytes().for_each(|byte| token.push_str(&format!("%{byte:02X}")));
        }
    }
    token.into()
}

/// The text of a [`token`]; where it is not one of ours, as it is.
pub fn untoken(token: &str) -> String {
    let mut bytes = Vec::with_capacity(token.len());
    let mut rest = token.as_bytes();
    while let Some((&first, tail)) = rest.split_first() {
        let code = (first == b'%').then(|| std::str::from_utf8(tail.get(..2)?).ok()).flatten();
        match code.and_then(|code| u8::from_str_radix(code, 16).ok()) {
            Some(byte) => {
                bytes.push(byte);
                rest = &tail[2..];
            }
            None => {
                bytes.push(first);
                rest = tail;
            }
        }
    }
    String::from_utf8(bytes).unwrap_or_else(|_| token.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn white_space_is_escaped() {
        assert_eq!(token("a b%.step"), "a%20b%25.step");
        assert_eq!(untoken("50%"), "50%");
    }

    #[test]
    fn a_draft_takes_the_place_of_a_file_when_it_is_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.csv");
        std::fs::write(&path, "old").unwrap();
        let mut draft = Draft::create(&path).unwrap();
        draft.write(b"new").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        draft.publish().unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    proptest! {
        #[test]
        fn tokens_come_back(text in "\\PC*|[ %0-9\u{a0}\t]*") {
            prop_assert!(!token(&text).contains(char::is_whitespace));
            prop_assert_eq!(untoken(&token(&text)), text);
        }
    }
}
