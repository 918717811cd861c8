//! Curves moved by a similarity (CURVE_REPLICA).

pub(super) use crate::stages::parse::moved::moved_curve;
