//! Memory that one model was done with, kept for the next.
//!
//! A piece of it is on the account of the model that it is lent to, and on no account while it lies here; what lies here
//! is counted by itself. What a failed model leaves half done is not put back, and what has become large is given back.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use crate::memory::{Account, MOST_KEPT, held};
use crate::stages::Scratch;

/// What can lie on a shelf.
pub trait Reusable: Default {
    /// Bytes of memory that it holds.
    fn bytes(&self) -> usize;
}

impl Reusable for Vec<u8> {
    fn bytes(&self) -> usize {
        held(self)
    }
}

impl Reusable for Scratch {
    fn bytes(&self) -> usize {
        self.bytes()
    }
}

/// Pieces of memory that nobody uses at the moment: no more than were ever used at the same time.
#[derive(Default)]
pub struct Shelf<T> {
    pieces: Mutex<Vec<T>>,
    bytes: AtomicU64,
}

impl<T: Reusable> Shelf<T> {
    /// The piece that was put back last, whose memory is the most likely to be in a cache; a new one where there is none.
    pub fn take(&self) -> T {
        // A list that is whole even if a holder panicked: each change is one call.
        let piece = self.pieces.lock().unwrap_or_else(PoisonError::into_inner).pop().unwrap_or_default();
        self.bytes.fetch_sub(piece.bytes() as u64, Ordering::Relaxed);
        piece
    }

    /// [`Shelf::take`] for the model that has this account.
    pub fn lend(&self, account: &Account) -> T {
        let piece = self.take();
        account.add(piece.bytes() as u64);
        piece
    }

    /// Puts back what was lent to the model that has this account, and is worked for.
    pub fn put_back(&self, piece: T, account: &Account) {
        let bytes = piece.bytes();
        if bytes <= MOST_KEPT {
            account.remove(bytes as u64);
            self.bytes.fetch_add(bytes as u64, Ordering::Relaxed);
            self.pieces.lock().unwrap_or_else(PoisonError::into_inner).push(piece);
        }
    }

    /// Bytes of memory that lie here.
    pub fn bytes(&self) -> u64 {
        self.bytes.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_goes_from_the_account_to_the_shelf_and_back() {
        let (shelf, first, second) = (Shelf::<Vec<u8>>::default(), Account::open(), Account::open());
        let mut piece = shelf.lend(&first);
        piece.reserve_exact(1000);
        // As the program's allocator says.
        first.add(1000);
        shelf.put_back(piece, &first);
        assert_eq!((first.bytes(), shelf.bytes()), (0, 1000));
        let piece = shelf.lend(&second);
        assert_eq!((piece.capacity(), second.bytes(), shelf.bytes()), (1000, 1000, 0));
        assert_eq!(shelf.take().capacity(), 0);
    }

    #[test]
    fn what_has_become_large_is_given_back() {
        let (shelf, account) = (Shelf::<Vec<u8>>::default(), Account::open());
        shelf.put_back(Vec::with_capacity(MOST_KEPT + 1), &account);
        assert_eq!((shelf.bytes(), shelf.take().capacity()), (0, 0));
        shelf.put_back(Vec::with_capacity(MOST_KEPT), &account);
        assert_eq!(shelf.bytes(), MOST_KEPT as u64);
    }
}
