//! What was made of instances: a number and a kind for each, where the instance stands in the table.

use super::records::File;
use crate::brep::{EdgeId, SurfaceId, VertexId};
use crate::memory::{empty, kept};

/// Something of the model that stands for an instance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Made {
    Vertex(VertexId),
    Edge(EdgeId),
    /// A curve, by an edge that has it.
    Curve(EdgeId),
    Surface(SurfaceId),
}

/// Bits of the kind, below those of the number.
const KIND_BITS: u32 = 3;
/// The largest number that is kept; what lies beyond is made anew.
const MOST: u32 = u32::MAX >> KIND_BITS;

/// What was made of the instances of a file: 4 bytes each, found as fast as the instance.
pub(super) struct Known(Vec<u32>);

impl Known {
    /// Nothing was made yet; noted in memory that others have done with.
    pub fn new(mut memory: Vec<u32>, file: &File) -> Self {
        empty(&mut memory, file.table.entries.len());
        memory.resize(file.table.entries.len(), 0);
        Self(memory)
    }

    /// The memory, for others.
    pub fn done(self) -> Vec<u32> {
        kept(self.0)
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.0.fill(0);
    }

    /// What the instance at a place of the table became.
    pub fn get(&self, place: Option<usize>) -> Option<Made> {
        let made = *self.0.get(place?)?;
        let number = made >> KIND_BITS;
        match made & ((1 << KIND_BITS) - 1) {
            1 => Some(Made::Vertex(VertexId(number))),
            2 => Some(Made::Edge(EdgeId(number))),
            3 => Some(Made::Curve(EdgeId(number))),
            4 => Some(Made::Surface(SurfaceId(number))),
            _ => None,
        }
    }

    /// Notes what the instance at a place became.
    pub fn set(&mut self, place: Option<usize>, made: Made) {
        let (number, kind) = match made {
            Made::Vertex(id) => (id.0, 1),
            Made::Edge(id) => (id.0, 2),
            Made::Curve(id) => (id.0, 3),
            Made::Surface(id) => (id.0, 4),
        };
        if let Some(slot) = place.and_then(|place| self.0.get_mut(place))
            && number < MOST
        {
            *slot = number << KIND_BITS | kind;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_made_is_found_until_it_is_forgotten() {
        let mut known = Known(vec![0; 5]);
        let surface = Made::Surface(SurfaceId(1));
        let all = [Made::Vertex(VertexId(0)), Made::Edge(EdgeId(7)), Made::Curve(EdgeId(MOST - 1)), surface];
        all.iter().enumerate().for_each(|(place, made)| known.set(Some(place), *made));
        known.set(Some(4), Made::Edge(EdgeId(MOST)));
        known.set(None, all[0]);
        known.set(Some(9), all[0]);
        let found: Vec<_> = [Some(0), Some(1), Some(2), Some(3)].map(|place| known.get(place).unwrap()).to_vec();
        assert_eq!(found, all);
        assert_eq!([known.get(Some(4)), known.get(Some(9)), known.get(None)], [None; 3]);
        known.clear();
        assert_eq!(known.get(Some(1)), None);
    }
}
