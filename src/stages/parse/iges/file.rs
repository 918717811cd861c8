//! Directory entries, and the parameters of each.

use std::cell::Cell;

use super::global::{Global, global};
use super::lines::Sections;
use super::values::{Value, values};
use crate::cancel::Cancel;
use crate::stages::parse::fault::{Fault, Read};

/// Two lines of the directory: what an entity is. Its number is that of the first line, which is odd.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub kind: u32,
    pub form: i32,
    /// The transformation matrix, 0 for none.
    pub transform: u64,
    /// Not to be shown.
    pub blanked: bool,
    /// It exists only as a part of others.
    pub dependent: bool,
    /// What it is for: 0 geometry, 1 annotation, 2 definition, 3 other, 4 logical, 5 in parameter space, 6 construction.
    pub purpose: u32,
    /// The first of its parameter lines and how many there are.
    first: u32,
    lines: u32,
}

/// An IGES file: entries by number, parameters where they are asked for.
pub(super) struct File<'a> {
    pub entries: Vec<Entry>,
    pub global: Global,
    parameters: Vec<&'a [u8]>,
    /// Things that may still be made.
    budget: Cell<usize>,
    cancel: Cancel,
}

/// An entity with its parameters, behind the type.
#[derive(Clone, Debug)]
pub(super) struct Record {
    pub entity: u64,
    pub entry: Entry,
    values: Vec<Value>,
}

/// A place in the parameters of a record.
#[derive(Clone, Debug)]
pub(super) struct Fields<'r> {
    record: &'r Record,
    at: usize,
}

impl<'a> File<'a> {
    pub fn new(sections: Sections<'a>, bytes: usize, cancel: &Cancel) -> Self {
        let entries = sections.directory.chunks_exact(2).map(|pair| entry(pair[0], pair[1])).collect();
        let global = global(&sections.global);
        Self { entries, global, parameters: sections.parameters, budget: Cell::new(bytes), cancel: cancel.clone() }
    }

    /// All entries with their numbers.
    pub fn numbered(&self) -> impl Iterator<Item = (u64, &Entry)> {
        self.entries.iter().enumerate().map(|(i, entry)| (2 * i as u64 + 1, entry))
    }

    /// The entry of an entity.
    pub fn entry(&self, entity: u64) -> Read<&Entry> {
        let index = usize::try_from(entity / 2).ok().filter(|_| entity % 2 == 1);
        index.and_then(|i| self.entries.get(i)).ok_or_else(|| Fault::new(entity, "there is no such entity"))
    }

    /// An entity with its parameters.
    ///
    /// # Errors
    /// Where it is not there, nothing more may be made, and when cancelled.
    pub fn record(&self, entity: u64) -> Read<Record> {
        let entry = *self.entry(entity)?;
        let first = (entry.first as usize).saturating_sub(1);
        let lines = self.parameters.get(first..).unwrap_or_default();
        let lines = &lines[..lines.len().min(entry.lines.max(1) as usize)];
        self.spend(entity, lines.len())?;
        self.cancel.check().map_err(|c| Fault::new(entity, c.to_string()))?;
        let mut values = values(&lines.concat(), self.global.delimiters);
        if values.first() != Some(&Value::Real(f64::from(entry.kind))) {
            return Err(Fault::new(entity, "its parameters are not there"));
        }
        values.remove(0);
        Ok(Record { entity, entry, values })
    }

    /// Counts `count` things made for an entity. In a file in which nothing is shared each has some bytes of its own:
    /// more things than bytes means that pointers multiply beyond any use.
    pub fn spend(&self, entity: u64, count: usize) -> Read<()> {
        let left = self.budget.get().checked_sub(count);
        self.budget.set(left.ok_or_else(|| Fault::new(entity, "pointers multiply beyond the file's size"))?);
        Ok(())
    }
}

/// Columns of 8 characters.
fn entry(first: &[u8], second: &[u8]) -> Entry {
    let number = |line: &[u8], column: usize| -> i64 {
        let text = std::str::from_utf8(&line[8 * column..8 * column + 8]).unwrap_or_default();
        text.trim().parse().unwrap_or(0)
    };
    let whole = |line: &[u8], column: usize| u32::try_from(number(line, column)).unwrap_or(0);
    let status = number(first, 8).max(0) as u64;
    Entry {
        kind: whole(first, 0),
        form: number(second, 4) as i32,
        transform: u64::from(whole(first, 6)),
        blanked: status / 1_000_000 % 100 == 1,
        dependent: status / 10_000 % 2 == 1,
        purpose: (status / 100 % 100) as u32,
        first: whole(first, 1),
        lines: whole(second, 3),
    }
}

impl Record {
    /// From the first parameter on.
    pub fn fields(&self) -> Fields<'_> {
        Fields { record: self, at: 0 }
    }

    pub fn fault(&self, why: impl Into<std::borrow::Cow<'static, str>>) -> Fault {
        Fault::new(self.entity, why)
    }
}

impl Fields<'_> {
    fn next(&mut self) -> Option<&Value> {
        self.at += 1;
        self.record.values.get(self.at - 1)
    }

    /// A number; 0 where it is left out.
    pub fn real(&mut self) -> Read<f64> {
        match self.next() {
            Some(Value::Real(value)) => Ok(*value),
            Some(Value::Nothing) => Ok(0.0),
            Some(Value::Text(_)) => Err(self.record.fault("a number was expected")),
            None => Err(self.record.fault("too few parameters")),
        }
    }

    /// A number, or `otherwise` where there is none.
    pub fn real_or(&mut self, otherwise: f64) -> f64 {
        match self.next() {
            Some(Value::Real(value)) => *value,
            _ => otherwise,
        }
    }

    /// `N` numbers.
    pub fn reals<const N: usize>(&mut self) -> Read<[f64; N]> {
        let mut values = [0.0; N];
        for value in &mut values {
            *value = self.real()?;
        }
        Ok(values)
    }

    /// `count` numbers.
    pub fn many(&mut self, count: usize) -> Read<Vec<f64>> {
        (0..count).map(|_| self.real()).collect()
    }

    /// A whole number.
    pub fn integer(&mut self) -> Read<i64> {
        let value = self.real()?;
        if value.fract() == 0.0 && value.abs() < 1e15 {
            Ok(value as i64)
        } else {
            Err(self.record.fault("a whole number was expected"))
        }
    }

    /// How many things follow: no more than there are parameters left.
    pub fn count(&mut self) -> Read<usize> {
        let value = self.integer()?;
        let left = self.record.values.len().saturating_sub(self.at);
        let count = usize::try_from(value).ok().filter(|n| *n <= left);
        count.ok_or_else(|| self.record.fault("too few parameters for what they announce"))
    }

    /// A flag: anything but 0.
    pub fn flag(&mut self) -> Read<bool> {
        Ok(self.real()? != 0.0)
    }

    /// A pointer to another entity; `None` where it is 0 or left out.
    pub fn optional_pointer(&mut self) -> Read<Option<u64>> {
        let value = self.integer()?;
        Ok(Some(value.unsigned_abs()).filter(|d| *d != 0))
    }

    /// A pointer to another entity.
    pub fn pointer(&mut self) -> Read<u64> {
        self.optional_pointer()?.ok_or_else(|| self.record.fault("a pointer was expected"))
    }

    /// `count` pointers, those left out left out.
    pub fn pointers(&mut self, count: usize) -> Read<Vec<u64>> {
        let all = (0..count).map(|_| self.optional_pointer()).collect::<Read<Vec<_>>>()?;
        Ok(all.into_iter().flatten().collect())
    }

    /// Passes parameters.
    pub fn skip(&mut self, count: usize) -> &mut Self {
        self.at = self.at.saturating_add(count);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_have_fixed_columns() {
        let first = format!("{:8}{:8}{:8}{:8}{:8}{:8}{:8}{:8}{}", 144, 7, 0, 0, 0, 0, 21, 0, "01010500");
        let second = format!("{:8}{:8}{:8}{:8}{:8}{:>32}", 144, 0, 0, 3, -1, "");
        let read = entry(first.as_bytes(), second.as_bytes());
        assert_eq!((read.kind, read.form, read.transform, read.first, read.lines), (144, -1, 21, 7, 3));
        assert_eq!((read.blanked, read.dependent, read.purpose), (true, true, 5));
        let logical = first.replace("01010500", " 0020000");
        let read = entry(logical.as_bytes(), second.as_bytes());
        assert_eq!((read.blanked, read.dependent, read.purpose), (false, false, 0));
    }
}
