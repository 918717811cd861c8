//! The eight stages in their order.
use super::line::Line;
use crate::store::ModelRecord;
/// Makes the line of stages.
pub type Build = dyn for<'s, 'e> Fn(Line<'s, 'e, Vec<u8>>) -> std::io::Result<Line<'s, 'e, ModelRecord>>;
