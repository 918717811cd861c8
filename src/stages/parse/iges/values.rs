//! Free-formatted parameters: numbers and Hollerith strings between delimiters.

use std::borrow::Cow;

/// One parameter.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Real(f64),
    /// A string without its count, or anything else that is no number.
    Text(Vec<u8>),
    /// Left out.
    Nothing,
}

/// What separates parameters and ends records.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Delimiters {
    pub parameter: u8,
    pub record: u8,
}

impl Default for Delimiters {
    fn default() -> Self {
        Self { parameter: b',', record: b';' }
    }
}

/// The parameters up to the record delimiter, or to the end where there is none.
pub(super) fn values(text: &[u8], delimiters: Delimiters) -> Vec<Value> {
    let (mut values, mut at) = (Vec::new(), 0);
    while at < text.len() {
        let (value, next) = one(text, at, delimiters);
        values.push(value);
        if text.get(next).is_none_or(|b| *b == delimiters.record) {
            break;
        }
        at = next + 1;
    }
    values
}

/// The parameter at `at`, and where its delimiter is.
fn one(text: &[u8], at: usize, delimiters: Delimiters) -> (Value, usize) {
    let is_end = |b: &u8| *b == delimiters.parameter || *b == delimiters.record;
    let rest = &text[at..];
    if let Some((from, to)) = hollerith(rest) {
        let end = rest[to..].iter().position(is_end).map_or(text.len(), |n| at + to + n);
        return (Value::Text(rest[from..to].to_vec()), end);
    }
    let end = rest.iter().position(is_end).unwrap_or(rest.len());
    (plain(rest[..end].trim_ascii()), at + end)
}

/// Where the characters of a string such as `3HABC` are, if there is one.
fn hollerith(text: &[u8]) -> Option<(usize, usize)> {
    let start = text.iter().position(|b| *b != b' ')?;
    let digits = text[start..].iter().take_while(|b| b.is_ascii_digit()).count();
    let mark = start + digits;
    if digits == 0 || digits > 9 || !matches!(text.get(mark), Some(b'H' | b'h')) {
        return None;
    }
    let count = text[start..mark].iter().fold(0_usize, |n, d| 10 * n + usize::from(d - b'0'));
    Some((mark + 1, (mark + 1).saturating_add(count).min(text.len())))
}

fn plain(word: &[u8]) -> Value {
    if word.is_empty() {
        return Value::Nothing;
    }
    match number(word) {
        Some(number) => Value::Real(number),
        None => Value::Text(word.to_vec()),
    }
}

/// A number, also with the exponents of Fortran, such as `1.5D+02`.
fn number(word: &[u8]) -> Option<f64> {
    let word = word.strip_prefix(b"+").unwrap_or(word);
    let word: Cow<[u8]> = if word.iter().any(|b| matches!(b, b'D' | b'd')) {
        word.iter().map(|b| if matches!(b, b'D' | b'd') { b'E' } else { *b }).collect()
    } else {
        word.into()
    };
    fast_float2::parse(&word).ok().filter(|value: &f64| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_strings_and_nothing() {
        let found = values(b"110, 1.5D+02,-.5 ,,+3,1.E1 ,4H,;,;, x ; rest", Delimiters::default());
        let real = Value::Real;
        assert_eq!(found[..6], [real(110.0), real(150.0), real(-0.5), Value::Nothing, real(3.0), real(10.0)]);
        assert_eq!(found[6..], [Value::Text(b",;,;".to_vec()), Value::Text(b"x".to_vec())]);
    }

    #[test]
    fn a_string_longer_than_the_text_ends_with_it() {
        assert_eq!(values(b"99Habc", Delimiters::default()), [Value::Text(b"abc".to_vec())]);
        assert_eq!(values(b"1.D999;", Delimiters::default()), [Value::Text(b"1.D999".to_vec())]);
        assert_eq!(values(b"", Delimiters::default()), []);
    }
}
