//! One pass over the bytes: where each instance starts and what type it has.
//!
//! Nothing is decoded or copied: 16 bytes an instance, whatever the order of the ids.

use memchr::{memchr, memchr3, memmem};

use super::effort::Effort;
use super::eight::{find, leading_number};
use super::keyword::Kind;
use crate::cancel::{Cancel, Cancelled};
use crate::memory::empty;

/// How many statements pass between two looks at the cancel flag.
const CHECK_EVERY: usize = 1 << 14;
/// The longest keyword that is compared: longer ones are of no known type.
const LONGEST_KEYWORD: usize = 80;
/// Numbers of so many digits fit into 64 bits.
const SAFE_DIGITS: usize = 19;
/// Offsets are kept in 56 bits, beside the 8 bits of the kind.
const LONGEST_FILE: usize = 1 << 56;

/// An instance: its number, where the text behind its keyword (of a complex one: behind its parenthesis) starts, and
/// its kind.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub id: u64,
    start_and_kind: u64,
}

impl Entry {
    fn new(id: u64, start: usize, kind: Kind) -> Self {
        Self { id, start_and_kind: (start as u64) << 8 | u64::from(kind.code()) }
    }

    pub fn start(self) -> usize {
        (self.start_and_kind >> 8) as usize
    }

    pub fn kind(self) -> Kind {
        Kind::from_code((self.start_and_kind & 0xff) as u8)
    }
}

/// What one pass over the file found.
#[derive(Debug, Default)]
pub(super) struct Table {
    /// All complete instances by ascending id, each id once.
    pub entries: Vec<Entry>,
    /// Where the parameters of FILE_SCHEMA start.
    pub schema: Option<usize>,
    /// Whether the file starts or ends as Part 21 says.
    pub marked: bool,
    /// Whether the end marker is there.
    pub ended: bool,
    pub warnings: Vec<String>,
    pub effort: Effort,
}

/// Finds all instances of all DATA sections, and what lies outside of any section too.
pub(super) fn scan(bytes: &[u8], cancel: &Cancel) -> Result<Table, Cancelled> {
    scan_in(Vec::new(), bytes, cancel)
}

/// [`scan`] in memory that others have done with.
pub(super) fn scan_in(mut entries: Vec<Entry>, bytes: &[u8], cancel: &Cancel) -> Result<Table, Cancelled> {
    let bytes = &bytes[..bytes.len().min(LONGEST_FILE)];
    let effort = Effort::new(bytes.len(), cancel);
    empty(&mut entries, bytes.len() / 40);
    let mut table = Table { entries, effort, ..Table::default() };
    let mut broken_strings = 0_usize;
    let (mut at, mut count, mut ended) = (0, 0, false);
    loop {
        count += 1;
        if count % CHECK_EVERY == 0 {
            cancel.check()?;
        }
        at = skip_space(bytes, at);
        if at >= bytes.len() || ended {
            break;
        }
        let entry = entry(bytes, at);
        match statement_end(bytes, entry.map_or(at, |entry| behind_name(bytes, entry.start()))) {
            End::Semicolon(end) => {
                match entry {
                    Some(entry) => table.entries.push(entry),
                    None => ended = is_end(bytes, at, &mut table),
                }
                at = end + 1;
            }
            End::BrokenString(resume) => {
                broken_strings += 1;
                at = resume;
            }
            End::File => {
                let tail = String::from_utf8_lossy(&bytes[at..bytes.len().min(at + 40)]).into_owned();
                table.warnings.push(format!("truncated: the last statement does not end: {}", tail.escape_default()));
                break;
            }
        }
    }
    if broken_strings > 0 {
        table.warnings.push(format!("{broken_strings} statements with a string that does not end were left out"));
    }
    table.ended = ended;
    if !ended {
        table.warnings.push("the end marker END-ISO-10303-21 is missing".into());
    }
    sort(&mut table);
    Ok(table)
}

/// The instance at `at`, if there is one.
fn entry(bytes: &[u8], at: usize) -> Option<Entry> {
    let (id, start) = if bytes[at] == b'#' { instance(bytes, at)? } else { return None };
    let (kind, behind) = kind_at(bytes, start);
    Some(Entry::new(id, behind, kind))
}

/// The place behind the name that most instances do not have.
fn behind_name(bytes: &[u8], start: usize) -> usize {
    if bytes[start..].starts_with(b"('',") { start + 4 } else { start }
}

/// Takes note of the statement at `at`, which is no instance; true for the end marker.
fn is_end(bytes: &[u8], at: usize, table: &mut Table) -> bool {
    let mut buffer = [0; LONGEST_KEYWORD];
    let (length, after) = keyword(bytes, at, &mut buffer);
    match &buffer[..length] {
        b"END-ISO-10303-21" => {
            table.marked = true;
            true
        }
        b"ISO-10303-21" => {
            table.marked = true;
            false
        }
        b"FILE_SCHEMA" => {
            table.schema.get_or_insert(after);
            false
        }
        _ => false,
    }
}

/// The number and the start of the text after `=` of an instance at `#`.
fn instance(bytes: &[u8], at: usize) -> Option<(u64, usize)> {
    let (id, digits_end) = number(bytes, at + 1)?;
    let equals = skip_space(bytes, digits_end);
    if bytes.get(equals) != Some(&b'=') {
        return None;
    }
    Some((id, skip_space(bytes, equals + 1)))
}

/// An unsigned decimal number at `at` and the place behind it.
#[inline]
pub(super) fn number(bytes: &[u8], at: usize) -> Option<(u64, usize)> {
    match leading_number(bytes, at) {
        Some((value, digits)) => (digits > 0).then_some((value, at + digits)),
        None => long_number(bytes, at),
    }
}

/// A number of more than seven digits, or at the end of the bytes.
fn long_number(bytes: &[u8], at: usize) -> Option<(u64, usize)> {
    let mut end = at;
    let mut value = 0_u64;
    while let Some(digit) = bytes.get(end).map(|b| b.wrapping_sub(b'0')).filter(|digit| *digit < 10) {
        value = value.wrapping_mul(10).wrapping_add(u64::from(digit));
        end += 1;
    }
    if end - at > SAFE_DIGITS {
        value = std::str::from_utf8(&bytes[at..end]).ok()?.parse().ok()?;
    }
    (end > at).then_some((value, end))
}

/// The kind of the record at `at` and the place behind its keyword (for complex instances: behind the parenthesis).
pub(super) fn kind_at(bytes: &[u8], at: usize) -> (Kind, usize) {
    if bytes.get(at) == Some(&b'(') {
        return (Kind::Complex, at + 1);
    }
    let rest = &bytes[at.min(bytes.len())..];
    if let Some(length) = find(&rest[..rest.len().min(LONGEST_KEYWORD)], b'(') {
        let kind = Kind::of(&rest[..length]);
        if kind != Kind::Other || is_plain(&rest[..length]) {
            return (kind, at + length);
        }
    }
    let mut buffer = [0; LONGEST_KEYWORD];
    let (length, after) = keyword(bytes, at, &mut buffer);
    (Kind::of(&buffer[..length]), after)
}

/// Which bytes a keyword is not written with.
const STRANGE: [bool; 256] = {
    let mut strange = [true; 256];
    let mut b = 0;
    while b < 128 {
        strange[b] = !((b as u8).is_ascii_uppercase() || (b as u8).is_ascii_digit() || b as u8 == b'_');
        b += 1;
    }
    strange
};

/// Whether a keyword is written as it should be. All letters are looked at, which is faster than to stop at the first
/// bad one.
fn is_plain(keyword: &[u8]) -> bool {
    !keyword.iter().fold(keyword.is_empty(), |strange, b| strange | STRANGE[usize::from(*b)])
}

/// Copies the keyword at `at` in upper case without the spaces and line breaks inside; its length, and the place behind.
fn keyword(bytes: &[u8], at: usize, buffer: &mut [u8; LONGEST_KEYWORD]) -> (usize, usize) {
    let (mut length, mut end) = (0, at);
    while length < LONGEST_KEYWORD {
        end = skip_space(bytes, end);
        match bytes.get(end) {
            Some(b) if b.is_ascii_alphanumeric() || matches!(b, b'_' | b'-') => {
                buffer[length] = b.to_ascii_uppercase();
                length += 1;
                end += 1;
            }
            _ => break,
        }
    }
    (length, end)
}

/// Behind white space, comments and print control directives (`\N\`, `\F\`).
#[inline]
pub(super) fn skip_space(bytes: &[u8], at: usize) -> usize {
    match bytes.get(at) {
        Some(0..=b' ' | b'/' | b'\\') => skip_long_space(bytes, at),
        _ => at,
    }
}

/// Kept apart: nearly all calls find a token at once.
fn skip_long_space(bytes: &[u8], mut at: usize) -> usize {
    loop {
        match bytes.get(at) {
            Some(0..=b' ') => at += 1,
            Some(b'/') if bytes.get(at + 1) == Some(&b'*') => {
                at = memmem::find(&bytes[at + 2..], b"*/").map_or(bytes.len(), |n| at + n + 4);
            }
            Some(b'\\') if matches!(bytes.get(at + 1..at + 3), Some(b"N\\" | b"F\\")) => at += 3,
            _ => return at,
        }
    }
}

/// How a statement ends.
enum End {
    Semicolon(usize),
    /// A string runs over the start of another instance, which is here.
    BrokenString(usize),
    File,
}

/// The place behind the statement at `at`, where it ends.
pub(super) fn behind_statement(bytes: &[u8], at: usize) -> Option<usize> {
    match statement_end(bytes, at) {
        End::Semicolon(end) => Some(end + 1),
        End::BrokenString(_) | End::File => None,
    }
}

/// The first semicolon outside strings and comments.
fn statement_end(bytes: &[u8], mut at: usize) -> End {
    while let Some(n) = memchr3(b';', b'\'', b'/', &bytes[at..]) {
        let found = at + n;
        match bytes[found] {
            b';' => return End::Semicolon(found),
            b'\'' if bytes.get(found + 1) == Some(&b'\'') => at = found + 2,
            b'\'' => {
                // A doubled quote inside a string ends it and at once begins it anew: no special case.
                let end = memchr(b'\'', &bytes[found + 1..]).map_or(bytes.len(), |n| found + 1 + n);
                if let Some(resume) = instance_in(bytes, found + 1, end) {
                    return End::BrokenString(resume);
                }
                at = end + 1;
            }
            _ if bytes.get(found + 1) == Some(&b'*') => at = skip_space(bytes, found),
            _ => at = found + 1,
        }
        if at >= bytes.len() {
            break;
        }
    }
    End::File
}

/// The first line of `bytes[from..to]` that starts as an instance does: then this is no string.
fn instance_in(bytes: &[u8], from: usize, to: usize) -> Option<usize> {
    // Only plain space is passed over: looking for the ends of comments again and again would take quadratic time.
    let plain_space = |at: usize| at + bytes[at..to].iter().take_while(|b| **b <= b' ').count();
    let mut at = from;
    while let Some(n) = memchr(b'\n', &bytes[at..to]) {
        at = plain_space(at + n + 1);
        let number = number(&bytes[..to], at + 1).filter(|_| at < to && bytes[at] == b'#');
        if number.is_some_and(|(_, end)| bytes[..to].get(plain_space(end)) == Some(&b'=')) {
            return Some(at);
        }
    }
    None
}

/// Sorts by id; of several instances with one id the first of the file stays.
fn sort(table: &mut Table) {
    let entries = &mut table.entries;
    if !entries.is_sorted_by(|a, b| a.id < b.id) {
        entries.sort_by_key(|e| (e.id, e.start_and_kind));
        let before = entries.len();
        entries.dedup_by_key(|e| e.id);
        if entries.len() < before {
            table.warnings.push(format!("{} instances repeat the number of another one", before - entries.len()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ids(text: &str) -> Vec<(u64, Kind)> {
        let table = scan(text.as_bytes(), &Cancel::new()).unwrap();
        table.entries.iter().map(|e| (e.id, e.kind())).collect()
    }

    #[test]
    fn strings_and_comments_hide_semicolons() {
        let text = "#2=PLANE('it''s; fine',#3);/* #9=LINE(); */ #1 = /* ; */ circle ( 'a/*b' ) ;";
        assert_eq!(ids(text), [(1, Kind::Circle), (2, Kind::Plane)]);
    }

    #[test]
    fn keywords_may_be_broken_over_lines() {
        assert_eq!(ids("#1=CARTESIAN_\r\nPOINT('',(0.,0.,0.));"), [(1, Kind::CartesianPoint)]);
    }

    #[test]
    fn a_truncated_file_keeps_what_was_complete() {
        let table = scan(b"DATA;#1=PLANE('',#2);#2=AXIS2_PLA", &Cancel::new()).unwrap();
        assert_eq!(table.entries.len(), 1);
        assert!(table.warnings[0].starts_with("truncated"));
    }

    #[test]
    fn an_open_string_costs_one_instance() {
        assert_eq!(
            ids("#1=PLANE('O'Brien',#2);\n#2=LINE('',#3);\n#3=CIRCLE('');"),
            [(2, Kind::Line), (3, Kind::Circle)]
        );
    }

    #[test]
    fn complex_instances_and_repeated_ids() {
        assert_eq!(ids("#7=(A()B());#7=PLANE();#3=FOO();"), [(3, Kind::Other), (7, Kind::Complex)]);
    }
}
