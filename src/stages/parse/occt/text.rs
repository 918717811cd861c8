//! The words of a text, one after the other.

use std::borrow::Cow;

use crate::cancel::Cancel;

/// Why the text cannot be read on: it ends, or there is something else than must be there.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lost(pub Cow<'static, str>);

/// What reading words gives.
pub(super) type Found<T> = Result<T, Lost>;

/// Words between white space.
#[derive(Clone, Debug)]
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Words<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// The next word; empty at the end.
    fn ahead(&self) -> (usize, usize) {
        let rest = &self.bytes[self.at..];
        let start = self.at + rest.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(rest.len());
        let length = self.bytes[start..].iter().position(u8::is_ascii_whitespace);
        (start, length.map_or(self.bytes.len(), |n| start + n))
    }

    /// The next word without taking it; empty at the end.
    pub fn peek(&self) -> &'a [u8] {
        let (from, to) = self.ahead();
        &self.bytes[from..to]
    }

    /// Takes a word.
    pub fn word(&mut self) -> Found<&'a [u8]> {
        let (from, to) = self.ahead();
        self.at = to;
        if from == to { Err(Lost("the file ends".into())) } else { Ok(&self.bytes[from..to]) }
    }

    /// Passes a word that must be there.
    pub fn expect(&mut self, expected: &str) -> Found<()> {
        let word = self.word()?;
        if word == expected.as_bytes() { Ok(()) } else { Err(wrong(expected, word)) }
    }

    /// A number; not finite where it is written so, as in `nan` or `-1.#IND`.
    pub fn real(&mut self) -> Found<f64> {
        let word = self.word()?;
        match fast_float2::parse(word) {
            Ok(value) => Ok(value),
            Err(_) if word.contains(&b'#') || word.ends_with(b"nan)") => Ok(f64::NAN),
            Err(_) => Err(wrong("a number", word)),
        }
    }

    /// `N` numbers.
    pub fn reals<const N: usize>(&mut self) -> Found<[f64; N]> {
        let mut values = [0.0; N];
        for value in &mut values {
            *value = self.real()?;
        }
        Ok(values)
    }

    /// A whole number.
    pub fn integer(&mut self) -> Found<i64> {
        let word = self.word()?;
        std::str::from_utf8(word).ok().and_then(|w| w.parse().ok()).ok_or_else(|| wrong("a whole number", word))
    }

    /// The number of an entry of a list, from 1; 0 is none.
    pub fn index(&mut self) -> Found<u32> {
        let value = self.integer()?;
        u32::try_from(value).map_err(|_| Lost("a number of an entry was expected".into()))
    }

    /// How many things follow: no more than there are bytes left.
    pub fn count(&mut self) -> Found<usize> {
        let value = self.integer()?;
        let count = usize::try_from(value).ok().filter(|n| *n <= self.bytes.len() - self.at);
        count.ok_or_else(|| Lost("more things are announced than the file can hold".into()))
    }

    /// 0 or 1.
    pub fn flag(&mut self) -> Found<bool> {
        Ok(self.integer()? != 0)
    }

    /// Passes words.
    pub fn skip(&mut self, count: usize) -> Found<()> {
        (0..count).try_for_each(|_| self.word().map(drop))
    }
}

/// An error when the work should stop; the caller asks again, whatever the reason says.
pub(super) fn cancelled(cancel: &Cancel) -> Found<()> {
    cancel.check().map_err(|c| Lost(c.to_string().into()))
}

fn wrong(expected: &str, found: &[u8]) -> Lost {
    let shown: String = String::from_utf8_lossy(found).chars().filter(|c| !c.is_control()).take(40).collect();
    Lost(format!("{expected} was expected where `{shown}` is").into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_numbers_and_the_end() {
        let mut words = Words::new(b" Curves 2\r\n1.5 -1.#IND 7x");
        words.expect("Curves").unwrap();
        assert_eq!(words.count().unwrap(), 2);
        assert_eq!(words.real().unwrap(), 1.5);
        assert!(words.real().unwrap().is_nan());
        assert_eq!(words.integer().unwrap_err().0, "a whole number was expected where `7x` is");
        assert_eq!(words.word().unwrap_err().0, "the file ends");
    }

    #[test]
    fn counts_beyond_the_file_are_refused() {
        assert!(Words::new(b"4000000000 1 2").count().is_err());
        assert!(Words::new(b"-1 1 2").count().is_err());
    }
}
