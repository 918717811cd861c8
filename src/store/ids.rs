//! The ids of a store where they lie in the map: a million are not made into strings to find ten.

use super::format::u64_at;

/// Where each id lies in the section of ids: bincode's `Vec<String>`, a count, then length and bytes of each.
pub(super) struct Ids {
    /// Start of each id in the section, and of what would be the next.
    starts: Vec<u64>,
}

/// Bytes of a count or a length.
const WORD: usize = 8;

impl Ids {
    /// Finds the ids of a section.
    ///
    /// Errors: the section does not hold `models` sorted texts and nothing else.
    pub fn of(section: &[u8], models: u64) -> Result<Self, String> {
        if section.len() < WORD || u64_at(section, 0) != models || models > section.len() as u64 / WORD as u64 {
            return Err(format!("ids: not those of {models} models"));
        }
        let mut starts = Vec::with_capacity(models as usize + 1);
        starts.push(2 * WORD as u64);
        let (mut at, mut previous) = (WORD, &section[..0]);
        for _ in 0..models {
            let id = text_at(section, at).ok_or("ids: one is cut off")?;
            if std::str::from_utf8(id).is_err() || id < previous {
                return Err("ids: one is no text or out of order".into());
            }
            at += WORD + id.len();
            starts.push((at + WORD) as u64);
            previous = id;
        }
        if at == section.len() {
            Ok(Self { starts })
        } else {
            Err(format!("ids: {} bytes left over", section.len() - at))
        }
    }

    /// Number of ids.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// The id of model `i` in the section that the ids were found in.
    pub fn get<'a>(&self, section: &'a [u8], i: usize) -> &'a str {
        let (start, end) = (self.starts[i] as usize, self.starts[i + 1] as usize - WORD);
        std::str::from_utf8(&section[start..end]).unwrap_or_default()
    }
}

/// The bytes of a text whose length lies at `at`.
fn text_at(section: &[u8], at: usize) -> Option<&[u8]> {
    let start = at.checked_add(WORD).filter(|start| *start <= section.len())?;
    let length = usize::try_from(u64_at(section, at)).ok()?;
    section.get(start..start.checked_add(length)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::encoding::encode;

    #[test]
    fn ids_are_found_where_they_lie() {
        let texts = ["", "a/é.step", "b"].map(str::to_owned);
        let section = encode(&texts.to_vec()).unwrap();
        let ids = Ids::of(&section, 3).unwrap();
        assert_eq!(ids.len(), 3);
        assert_eq!([0, 1, 2].map(|i| ids.get(&section, i)), ["", "a/é.step", "b"]);
        assert!(Ids::of(&encode(&Vec::<String>::new()).unwrap(), 0).is_ok_and(|ids| ids.len() == 0));
    }

    #[test]
    fn damaged_ids_are_refused() {
        let section = encode(&vec!["a".to_owned(), "b".to_owned()]).unwrap();
        assert!(Ids::of(&section, 1).is_err());
        assert!((0..section.len()).all(|n| Ids::of(&section[..n], 2).is_err()));
        assert!(Ids::of(&[&section[..], b"x"].concat(), 2).is_err());
        let mut huge = section.clone();
        huge[8..16].fill(0xff);
        assert!(Ids::of(&huge, 2).is_err());
        let unsorted = encode(&vec!["b".to_owned(), "a".to_owned()]).unwrap();
        assert!(Ids::of(&unsorted, 2).is_err());
    }
}
