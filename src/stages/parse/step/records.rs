//! Instances of a file by their number, simple and complex ones.

use std::borrow::Cow;

use smallvec::SmallVec;

use super::cursor::Cursor;
use super::keyword::Kind;
use super::lexer::{Entry, Table, kind_at, skip_space};
use crate::geometry::Vector;
use crate::stages::parse::fault::{Fault, Read};

/// Numbers of instances: most lists name few.
pub(super) type Ids = SmallVec<[u64; 8]>;

/// The bytes of a file with the table of its instances.
#[derive(Clone, Copy, Debug)]
pub(super) struct File<'a> {
    pub bytes: &'a [u8],
    pub table: &'a Table,
}

impl<'a> File<'a> {
    /// The table entry of an instance.
    pub fn entry(&self, id: u64) -> Option<Entry> {
        self.place(id).map(|place| self.table.entries[place])
    }

    /// Where an instance stands in the table.
    pub fn place(&self, id: u64) -> Option<usize> {
        let entries = &self.table.entries;
        let first = entries.first()?.id;
        // Most files number their instances without gaps: then this guess is right.
        let guess = usize::try_from(id.checked_sub(first)?).ok()?;
        if entries.get(guess).is_some_and(|e| e.id == id) {
            return Some(guess);
        }
        entries.binary_search_by_key(&id, |e| e.id).ok()
    }

    /// The table entry of an instance that is to be read.
    ///
    /// # Errors
    /// Where there is none, where the file was read too often already, and when cancelled.
    pub fn find(&self, id: u64) -> Read<Entry> {
        self.table.effort.check(id)?;
        self.entry(id).ok_or_else(|| Fault::new(id, "there is no such instance"))
    }

    /// The record of an instance.
    ///
    /// # Errors
    /// As [`Self::find`].
    #[inline]
    pub fn record(&self, id: u64) -> Read<Record<'a>> {
        Ok(self.record_of(self.find(id)?))
    }

    /// The three numbers of an instance of this type without a name that has nothing else, written without spaces;
    /// `None` says nothing.
    pub fn plain_triple(&self, entry: Entry, kind: Kind) -> Option<Vector> {
        let text = if entry.kind() == kind { &self.bytes[entry.start()..] } else { return None };
        let mut rest = text.strip_prefix(b"('',(")?;
        let mut values = [0.0_f64; 3];
        for (value, end) in values.iter_mut().zip([b',', b',', b')']) {
            let length;
            (*value, length) = plain_real(rest)?;
            rest = rest[length..].strip_prefix(&[end])?;
        }
        self.table.effort.spend(text.len() - rest.len());
        Some(Vector::from(values))
    }

    /// The parts of a complex instance, each with the place of its parameters.
    fn parts(&self, start: usize) -> Vec<(Kind, usize)> {
        let mut found = Vec::new();
        let mut at = skip_space(self.bytes, start);
        while self.bytes.get(at).is_some_and(u8::is_ascii_alphabetic) {
            let (kind, after) = kind_at(self.bytes, at);
            found.push((kind, after));
            at = skip_space(self.bytes, Cursor::behind(*self, after));
        }
        self.table.effort.spend(at - start);
        found
    }

    /// The record of a table entry.
    #[inline]
    pub fn record_of(&self, entry: Entry) -> Record<'a> {
        let (kind, start) = (entry.kind(), entry.start());
        let parts = if kind == Kind::Complex { self.parts(start) } else { Vec::new() };
        Record { id: entry.id, kind, file: *self, start, parts }
    }
}

/// The finite number that a text starts with, and its length.
fn plain_real(text: &[u8]) -> Option<(f64, usize)> {
    // What most components of directions are.
    match text {
        [digit @ b'0'..=b'9', b'.', b',' | b')', ..] => return Some((f64::from(digit - b'0'), 2)),
        [b'-', digit @ b'0'..=b'9', b'.', b',' | b')', ..] => return Some((-f64::from(digit - b'0'), 3)),
        [b'-' | b'.' | b'0'..=b'9', ..] => {}
        _ => return None,
    }
    fast_float2::parse_partial(text).ok().filter(|(value, _): &(f64, usize)| value.is_finite())
}

/// An instance: of one type, or of several (a complex instance) with the parameters of each.
#[derive(Clone, Debug)]
pub(super) struct Record<'a> {
    pub id: u64,
    pub kind: Kind,
    file: File<'a>,
    /// Behind the keyword.
    start: usize,
    parts: Vec<(Kind, usize)>,
}

impl<'a> Record<'a> {
    /// The kind, or the kinds of the parts of a complex instance.
    pub fn kinds(&self) -> impl Iterator<Item = Kind> + '_ {
        let own = (self.kind != Kind::Complex).then_some(self.kind);
        own.into_iter().chain(self.parts.iter().map(|p| p.0))
    }

    /// Whether the instance is, among others, of this very type.
    pub fn is(&self, kind: Kind) -> bool {
        if self.kind == Kind::Complex { self.parts.iter().any(|p| p.0 == kind) } else { self.kind == kind }
    }

    /// The parameters. Those of a complex instance are read part by part in the order of `inheritance`, which is the
    /// order in which a simple instance has them.
    pub fn fields<'r>(&'r self, inheritance: &'static [Kind]) -> Cursor<'a, 'r> {
        if self.kind == Kind::Complex {
            Cursor::over_parts(self.file, self.id, &self.parts, inheritance)
        } else {
            Cursor::at(self.file, self.id, self.start)
        }
    }

    /// The parameters of one part of a complex instance, or of a simple instance of this type.
    pub fn part<'r>(&'r self, kind: Kind) -> Option<Cursor<'a, 'r>> {
        if self.kind == kind {
            return Some(self.fields(&[]));
        }
        let &(_, at) = self.parts.iter().find(|p| p.0 == kind)?;
        Some(Cursor::at(self.file, self.id, at))
    }

    /// An error that blames this instance.
    pub fn fault(&self, why: impl Into<Cow<'static, str>>) -> Fault {
        Fault::new(self.id, why)
    }
}
