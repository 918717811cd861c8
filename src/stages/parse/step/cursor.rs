//! Parameters of an instance, read one after the other where they lie in the file.
//!
//! Nothing here is recursive: a list is entered and left by a counter, and skipping counts parentheses.

use memchr::memchr;

use super::effort::Effort;
use super::keyword::Kind;
use super::lexer::{kind_at, number, skip_space};
use super::records::{File, Ids};
use crate::stages::parse::fault::{Fault, Read};

/// A place in the parameters of an instance; each call reads one parameter and the comma behind it.
#[derive(Clone, Debug)]
pub(super) struct Cursor<'a, 'r> {
    bytes: &'a [u8],
    at: usize,
    entity: u64,
    /// Lists entered and not yet left.
    depth: u32,
    parts: &'r [(Kind, usize)],
    rest: &'static [Kind],
    effort: &'a Effort,
    /// Up to here the effort is counted.
    counted: usize,
}

impl<'a, 'r> Cursor<'a, 'r> {
    /// At the first parameter of the list that opens at `place`.
    pub fn at(file: File<'a>, entity: u64, place: usize) -> Self {
        let mut cursor = Self::new(file, entity, place, &[], &[]);
        cursor.open(place);
        cursor
    }

    fn new(file: File<'a>, entity: u64, at: usize, parts: &'r [(Kind, usize)], rest: &'static [Kind]) -> Self {
        Self { bytes: file.bytes, at, entity, depth: 0, parts, rest, effort: &file.table.effort, counted: at }
    }

    /// At the first parameter of those `parts` whose kinds are listed, in the order of the list.
    pub fn over_parts(file: File<'a>, entity: u64, parts: &'r [(Kind, usize)], kinds: &'static [Kind]) -> Self {
        let mut cursor = Self::new(file, entity, file.bytes.len(), parts, kinds);
        cursor.next_part();
        cursor
    }

    /// The place behind the value, or list, at `place`.
    pub fn behind(file: File<'a>, place: usize) -> usize {
        let mut cursor = Self::new(file, 0, place, &[], &[]);
        cursor.skip_balanced();
        cursor.at
    }

    /// Starts behind the opening parenthesis at `at`; at nothing if there is none.
    fn open(&mut self, at: usize) {
        let at = skip_space(self.bytes, at);
        let opened = self.bytes.get(at) == Some(&b'(');
        self.at = if opened { skip_space(self.bytes, at + 1) } else { self.bytes.len() };
        self.counted = if opened { at } else { self.at };
    }

    /// Goes on with the next part of `rest` that the instance has.
    fn next_part(&mut self) -> bool {
        while let Some((kind, rest)) = self.rest.split_first() {
            self.rest = rest;
            if let Some(&(_, at)) = self.parts.iter().find(|p| p.0 == *kind) {
                self.open(at);
                return true;
            }
        }
        false
    }

    /// The next byte of the current list; `None` at its end.
    fn peek(&mut self) -> Option<u8> {
        loop {
            match self.bytes.get(self.at) {
                None | Some(b';') => return None,
                Some(b')') if self.depth > 0 || !self.next_part() => return None,
                Some(b')') => {}
                Some(b) => return Some(*b),
            }
        }
    }

    /// Whether the list has no more parameters.
    pub fn at_end(&mut self) -> bool {
        self.peek().is_none()
    }

    fn fault(&self, why: &'static str) -> Fault {
        Fault::new(self.entity, why)
    }

    /// Behind white space and a comma.
    #[inline]
    fn finish_value(&mut self) {
        self.at = skip_space(self.bytes, self.at);
        if self.bytes.get(self.at) == Some(&b',') {
            self.at = skip_space(self.bytes, self.at + 1);
        }
        self.effort.spend(self.at - self.counted);
        self.counted = self.at;
    }

    /// Skips one parameter of any form.
    pub fn skip(&mut self) {
        // Most of what is skipped are empty names and stars with a parameter right behind the comma.
        let length = match &self.bytes[self.at..] {
            [b'\'', b'\'', b',', b'#' | b'(' | b'*', ..] => 3,
            [b'*', b',', b'#' | b'*', ..] => 2,
            _ => 0,
        };
        if length > 0 {
            self.at += length;
        } else if self.peek().is_some() {
            self.skip_balanced();
            self.finish_value();
        }
    }

    /// Skips `count` parameters.
    pub fn skip_many(&mut self, count: usize) -> &mut Self {
        (0..count).for_each(|_| self.skip());
        self
    }

    /// To the comma or closing parenthesis that ends the value at the cursor, or just behind a closed list.
    fn skip_balanced(&mut self) {
        let mut depth = 0_u32;
        while let Some(b) = self.bytes.get(self.at) {
            match b {
                b';' => return,
                b',' if depth == 0 => return,
                b'(' => depth += 1,
                b')' if depth == 0 => return,
                b')' => {
                    depth -= 1;
                    if depth == 0 {
                        self.at += 1;
                        return;
                    }
                }
                b'\'' => {
                    self.at += 1;
                    self.at += memchr(b'\'', &self.bytes[self.at..]).unwrap_or(self.bytes.len() - self.at);
                }
                b'/' if self.bytes.get(self.at + 1) == Some(&b'*') => {
                    self.at = skip_space(self.bytes, self.at);
                    continue;
                }
                _ => {}
            }
            self.at = (self.at + 1).min(self.bytes.len());
        }
    }

    /// The number behind `#`.
    pub fn reference(&mut self) -> Read<u64> {
        if self.peek() != Some(b'#') {
            return Err(self.fault("a reference was expected"));
        }
        let (id, after) = number(self.bytes, self.at + 1).ok_or_else(|| self.fault("a bad reference"))?;
        self.at = after;
        self.finish_value();
        Ok(id)
    }

    /// A reference; `None` for `$` or `*` or a missing one.
    pub fn optional_reference(&mut self) -> Read<Option<u64>> {
        match self.peek() {
            Some(b'#') => self.reference().map(Some),
            Some(b'$' | b'*' | b',') => {
                self.skip();
                Ok(None)
            }
            None => Ok(None),
            Some(_) => Err(self.fault("a reference was expected")),
        }
    }

    /// A finite number; integers and typed parameters (`LENGTH_MEASURE(1.)`) too.
    pub fn real(&mut self) -> Read<f64> {
        let value = match self.peek() {
            Some(b) if b.is_ascii_alphabetic() => {
                let after = kind_at(self.bytes, self.at).1;
                if self.bytes.get(after) != Some(&b'(') {
                    return Err(self.fault("a number was expected"));
                }
                self.at = skip_space(self.bytes, after + 1);
                let value = self.plain_real()?;
                self.at = skip_space(self.bytes, self.at);
                if self.bytes.get(self.at) == Some(&b')') {
                    self.at += 1;
                }
                value
            }
            _ => self.plain_real()?,
        };
        self.finish_value();
        Ok(value)
    }

    fn plain_real(&mut self) -> Read<f64> {
        if self.bytes.get(self.at) == Some(&b'+') {
            self.at += 1;
        }
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        if !rest.first().is_some_and(|b| b.is_ascii_digit() || matches!(b, b'-' | b'.')) {
            return Err(self.fault("a number was expected"));
        }
        let (value, length): (f64, usize) = fast_float2::parse_partial(rest).map_err(|_| self.fault("a bad number"))?;
        if !value.is_finite() {
            return Err(self.fault("a number that is not finite"));
        }
        self.at += length;
        Ok(value)
    }

    /// A number; `None` for `$` or `*` or a missing one.
    pub fn optional_real(&mut self) -> Read<Option<f64>> {
        match self.peek() {
            None => Ok(None),
            Some(b'$' | b'*' | b',') => {
                self.skip();
                Ok(None)
            }
            Some(_) => self.real().map(Some),
        }
    }

    /// A number that must be a whole one from 0 to `most`.
    pub fn count(&mut self, most: usize) -> Read<usize> {
        let value = self.real()?;
        if value.fract() != 0.0 || value < 0.0 || value > most as f64 {
            return Err(self.fault("a whole number within limits was expected"));
        }
        Ok(value as usize)
    }

    /// The word between dots; empty for anything else, which is skipped.
    pub fn word(&mut self) -> &'a [u8] {
        let mut found: &'a [u8] = &[];
        if self.peek() == Some(b'.') {
            let rest = &self.bytes[self.at + 1..];
            found = memchr(b'.', &rest[..rest.len().min(80)]).map_or(&[], |end| &rest[..end]);
        }
        self.skip();
        found
    }

    /// `.T.` or `.F.`; `None` for `.U.`, `$`, `*` and everything else.
    pub fn flag(&mut self) -> Option<bool> {
        if let [b'.', letter @ (b'T' | b'F'), b'.', b')', ..] = self.bytes[self.at..] {
            self.at += 3;
            return Some(letter == b'T');
        }
        match self.word() {
            b"T" | b"t" | b"TRUE" => Some(true),
            b"F" | b"f" | b"FALSE" => Some(false),
            _ => None,
        }
    }

    /// Whether the next parameter is a list.
    pub fn is_list(&mut self) -> bool {
        self.peek() == Some(b'(')
    }

    /// Whether the next parameter is a reference.
    pub fn is_reference(&mut self) -> bool {
        self.peek() == Some(b'#')
    }

    /// Enters a list, calls `read` until its end (each call must read something) and leaves it.
    pub fn list(&mut self, mut read: impl FnMut(&mut Self) -> Read<()>) -> Read<()> {
        if self.peek() != Some(b'(') {
            return Err(self.fault("a list was expected"));
        }
        self.at = skip_space(self.bytes, self.at + 1);
        self.depth += 1;
        while !self.at_end() {
            let before = self.at;
            read(self)?;
            if self.at == before {
                return Err(self.fault("a list that cannot be read"));
            }
        }
        self.depth -= 1;
        if self.bytes.get(self.at) != Some(&b')') {
            return Err(self.fault("a list that does not end"));
        }
        self.at += 1;
        self.finish_value();
        Ok(())
    }

    /// A list of references.
    pub fn references(&mut self) -> Read<Ids> {
        let mut ids = Ids::new();
        self.list(|c| {
            ids.push(c.reference()?);
            Ok(())
        })?;
        Ok(ids)
    }

    /// A list of references in which `$` and other things are passed over.
    pub fn references_leniently(&mut self) -> Read<Vec<u64>> {
        if !self.is_list() {
            return Ok(self.optional_reference()?.into_iter().collect());
        }
        let mut ids = Vec::new();
        self.list(|c| {
            if c.is_reference() {
                ids.push(c.reference()?)
            } else {
                c.skip()
            }
            Ok(())
        })?;
        Ok(ids)
    }

    /// A list of finite numbers.
    pub fn reals(&mut self) -> Read<Vec<f64>> {
        let mut values = Vec::new();
        self.list(|c| {
            values.push(c.real()?);
            Ok(())
        })?;
        Ok(values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cancel::Cancel;
    use crate::stages::parse::step::lexer::scan;
    use crate::stages::parse::step::records::File;

    fn with(text: &str, check: impl Fn(&File)) {
        let table = scan(text.as_bytes(), &Cancel::new()).unwrap();
        check(&File { bytes: text.as_bytes(), table: &table });
    }

    #[test]
    fn parameters_of_all_forms_are_read() {
        with("#1=FOO('a''b',$,*,.T.,3,1.E-3,(-.5,+2),LENGTH_MEASURE( 7. ),#12/*x*/,.METRE.);", |file| {
            let record = file.record(1).unwrap();
            let mut c = record.fields(&[]);
            c.skip();
            assert_eq!(c.optional_reference().unwrap(), None);
            assert_eq!(c.optional_real().unwrap(), None);
            assert_eq!(c.flag(), Some(true));
            assert_eq!(c.count(10).unwrap(), 3);
            assert_eq!(c.real().unwrap(), 1e-3);
            assert_eq!(c.reals().unwrap(), [-0.5, 2.0]);
            assert_eq!(c.real().unwrap(), 7.0);
            assert_eq!(c.reference().unwrap(), 12);
            assert_eq!(c.word(), b"METRE");
            assert!(c.at_end());
            assert!(c.real().is_err());
        });
    }

    #[test]
    fn parts_of_complex_instances_come_in_the_asked_order() {
        with("#1=(EDGE_CURVE(#4,.F.) EDGE(#2,#3) REPRESENTATION_ITEM('n'));", |file| {
            let record = file.record(1).unwrap();
            let mut c = record.fields(&[Kind::RepresentationItem, Kind::Edge, Kind::EdgeCurve]);
            c.skip();
            assert_eq!([c.reference().unwrap(), c.reference().unwrap(), c.reference().unwrap()], [2, 3, 4]);
            assert_eq!(c.flag(), Some(false));
            assert!(c.at_end());
        });
    }

    #[test]
    fn numbers_that_are_not_finite_are_refused() {
        with("#1=FOO(1E999,NAN,inf);", |file| {
            let record = file.record(1).unwrap();
            let mut c = record.fields(&[]);
            assert_eq!(c.real().unwrap_err().why, "a number that is not finite");
            c.skip();
            assert!(c.real().is_err());
        });
    }

    #[test]
    fn deep_nesting_does_not_recurse() {
        let text = format!("#1=FOO({}{},4.);", "(".repeat(200_000), ")".repeat(200_000));
        with(&text, |file| {
            let record = file.record(1).unwrap();
            assert_eq!(record.fields(&[]).skip_many(1).real().unwrap(), 4.0);
        });
    }
}
