//! The files of the field: Princeton classifications and matrices, TREC judgements and runs, tables, `metrics.json`.

pub mod cla;
pub mod matrix;
pub mod metrics;
pub mod table;
pub mod trec;

use crate::error::{Result, RunError};
use std::borrow::Cow;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Writes the file `path` by `fill`.
///
/// # Errors
/// Where it cannot be written.
pub fn create(path: &Path, fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
    let write = || {
        let mut file = BufWriter::new(File::create(path)?);
        fill(&mut file)?;
        file.flush()
    };
    write().map_err(|source| RunError::file(path, source))
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

    proptest! {
        #[test]
        fn tokens_come_back(text in "\\PC*|[ %0-9\u{a0}\t]*") {
            prop_assert!(!token(&text).contains(char::is_whitespace));
            prop_assert_eq!(untoken(&token(&text)), text);
        }
    }
}
