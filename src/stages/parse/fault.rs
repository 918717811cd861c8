//! Why one entity of a file could not be read.

use std::borrow::Cow;

/// Why one entity could not be read.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fault {
    pub entity: u64,
    pub why: Cow<'static, str>,
}

impl Fault {
    pub fn new(entity: u64, why: impl Into<Cow<'static, str>>) -> Self {
        Self { entity, why: why.into() }
    }
}

/// The result of reading one entity.
pub(super) type Read<T> = Result<T, Fault>;
