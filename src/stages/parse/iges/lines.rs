//! The physical file: lines of 80 columns, of which column 73 says to which section they belong.

use crate::cancel::{Cancel, Cancelled};

/// Column 73, counted from 0.
const LETTER: usize = 72;
/// Columns of a record without line ends.
const WIDTH: usize = 80;
/// What is looked for in the first lines, so many of them.
const LOOKED_AT: usize = 8;

/// The lines of each section, without the letters and numbers behind.
#[derive(Debug, Default)]
pub(super) struct Sections<'a> {
    /// 72 columns each.
    pub global: Vec<&'a [u8]>,
    /// 72 columns each; two lines are an entry.
    pub directory: Vec<&'a [u8]>,
    /// 64 columns each.
    pub parameters: Vec<&'a [u8]>,
}

/// The form of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// Lines of 80 columns.
    Fixed,
    /// The compressed form, which starts with a C.
    Compressed,
    /// The binary form, which starts with a B.
    Binary,
}

/// Which form of IGES the first lines show, if any.
pub(super) fn form(bytes: &[u8]) -> Option<Form> {
    let start = &bytes[..bytes.len().min((WIDTH + 2) * LOOKED_AT)];
    lines(start).take(LOOKED_AT).find_map(|line| {
        let (letter, number) = line.get(LETTER..)?.split_first()?;
        let numbered = number.iter().any(u8::is_ascii_digit);
        let form = match letter.to_ascii_uppercase() {
            b'S' => Form::Fixed,
            b'C' => Form::Compressed,
            b'B' => Form::Binary,
            _ => return None,
        };
        (numbered && number.iter().all(|b| b.is_ascii_digit() || b.is_ascii_whitespace())).then_some(form)
    })
}

/// Lines without their ends; where a file has no line ends, its records.
fn lines(bytes: &[u8]) -> Box<dyn Iterator<Item = &[u8]> + '_> {
    let start = &bytes[..bytes.len().min(2 * WIDTH)];
    if start.len() == 2 * WIDTH && !start.iter().any(|b| matches!(b, b'\n' | b'\r')) {
        return Box::new(bytes.chunks(WIDTH));
    }
    Box::new(bytes.split(|b| matches!(b, b'\n' | b'\r')).filter(|line| !line.is_empty()))
}

/// Sorts the lines into their sections.
///
/// # Errors
/// Only when cancelled. Lines without a letter are passed over.
pub(super) fn sections<'a>(bytes: &'a [u8], cancel: &Cancel) -> Result<Sections<'a>, Cancelled> {
    let mut sections = Sections::default();
    for (count, line) in lines(bytes).enumerate() {
        if count % 4096 == 0 {
            cancel.check()?;
        }
        let Some(letter) = line.get(LETTER) else { continue };
        match letter.to_ascii_uppercase() {
            b'G' => sections.global.push(&line[..LETTER]),
            b'D' => sections.directory.push(&line[..LETTER]),
            b'P' => sections.parameters.push(&line[..LETTER - 8]),
            b'T' => break,
            _ => {}
        }
    }
    Ok(sections)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(text: &str, letter: char, number: usize) -> String {
        format!("{text:<72}{letter}{number:7}")
    }

    #[test]
    fn sections_come_with_any_line_ends_or_none() {
        let all = [line("start", 'S', 1), line("1H,", 'G', 1), line("100,1.;", 'P', 1), line("", 'T', 1)];
        for end in ["\n", "\r\n", "\r", ""] {
            let text = all.join(end);
            assert_eq!(form(text.as_bytes()), Some(Form::Fixed));
            let found = sections(text.as_bytes(), &Cancel::new()).unwrap();
            assert_eq!((found.global.len(), found.directory.len(), found.parameters.len()), (1, 0, 1));
            assert_eq!(found.parameters[0].len(), 64);
        }
    }

    #[test]
    fn other_files_are_no_iges() {
        assert_eq!(form(b"ISO-10303-21;\nHEADER;"), None);
        assert_eq!(form(line("", 'C', 1).as_bytes()), Some(Form::Compressed));
        assert_eq!(form(line("", 'S', 1).replace('1', "x").as_bytes()), None);
    }
}
