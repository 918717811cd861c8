//! OCCT `.brep`: the text that BRepTools of OpenCASCADE writes (CASCADE Topology V1 to V3).
//!
//! Method: tables of placements, curves, surfaces and shapes one after the other ([`file`]); shapes use earlier ones
//! only, so that there are no cycles. Compounds are walked down to solids, shells and loose faces ([`assembly`]), and
//! each of those is built once ([`build`]). The entity number of a shape is its position in the section `TShapes`,
//! counted from 1 (references such as `+12 0` count from the end). Lengths are mm: the format has no unit.
//!
//! Cost: linear in the bytes; a body used several times is built once.
//!
//! What it does not promise: curves in parameter space are read only where an edge has no curve in space;
//! triangulations only where a face has no surface. The binary form is not read.

mod assembly;
mod build;
mod curves;
mod edges;
mod file;
mod free_curves;
mod locations;
mod shapes;
mod surfaces;
#[cfg(test)]
mod tests;
mod text;
mod triangulations;

use memchr::memmem;
use rustc_hash::FxHashMap;

use self::assembly::{Assembly, assemble};
use self::build::Builder;
use super::{Options, Reading};
use crate::brep::{BodyId, Occurrence};
use crate::cancel::{Cancel, Cancelled};
use crate::stages::{ModelError, Stage};

/// What the binary form starts with.
const BINARY: &[u8] = b"Open CASCADE Topology V";
const BINARY_WITHIN: usize = 64;

/// Whether the first bytes are those of a `.brep` file, text or binary.
pub(super) fn is_brep(bytes: &[u8]) -> bool {
    is_binary(bytes) || file::title(bytes).is_some()
}

fn is_binary(bytes: &[u8]) -> bool {
    memmem::find(&bytes[..bytes.len().min(BINARY_WITHIN)], BINARY).is_some()
}

/// Reads the B-rep of a `.brep` file.
///
/// Errors: where the text cannot be read to its end, holds no face that can be read, or passes a limit; and when
/// cancelled.
pub(super) fn read(bytes: &[u8], options: &Options, cancel: &Cancel) -> Result<Reading, ModelError> {
    let stopped = |c: Cancelled| ModelError::cancelled(Stage::Parse, c);
    let failed = |why: String| ModelError::new(Stage::Parse, why);
    if is_binary(bytes) {
        return Err(failed("a binary .brep file: only the text form is read".into()));
    }
    let title = file::title(bytes).ok_or_else(|| failed("not a .brep file".into()))?;
    let tables = file::tables(bytes, title, cancel);
    cancel.check().map_err(stopped)?;
    let file = tables.map_err(|text::Lost(why)| failed(format!("the file cannot be read on: {why}")))?;
    let assembly = assemble(&file, options.most_occurrences, cancel).map_err(stopped)?;
    let mut builder = Builder::new(&file);
    place(&mut builder, &assembly, options, cancel)?;
    builder.add_free_curves(&assembly.free, cancel).map_err(stopped)?;
    let has_dangling = !file.shapes.dangling.is_empty();
    if has_dangling {
        let (first, count) = (file.shapes.dangling[0] + 1, file.shapes.dangling.len());
        builder.notes.warn(format!("{count} uses of shapes that are not there, the first in #{first}"));
    }
    let Builder { model, mut notes, .. } = builder;
    assembly.faults.iter().for_each(|fault| notes.skip(fault.entity, fault.clone()));
    let (skipped, warnings) = notes.finish();
    if model.occurrences.is_empty() {
        return Err(match skipped.first() {
            Some(first) => ModelError::at(Stage::Parse, first.entity, format!("no face could be read: {}", first.why)),
            None => failed("no faces".into()),
        });
    }
    Ok(Reading { model, skipped, warnings })
}

/// Builds each body once and places it wherever the assembly says.
fn place(builder: &mut Builder, assembly: &Assembly, options: &Options, cancel: &Cancel) -> Result<(), ModelError> {
    let mut bodies: FxHashMap<u32, Option<BodyId>> = FxHashMap::default();
    let mut uses: FxHashMap<u32, usize> = FxHashMap::default();
    assembly.placed.iter().for_each(|placed| *uses.entry(placed.shape).or_default() += 1);
    for placed in &assembly.placed {
        let body = match bodies.get(&placed.shape) {
            Some(known) => *known,
            None => {
                let made = builder.body(placed.shape, cancel).map_err(|c| ModelError::cancelled(Stage::Parse, c))?;
                bodies.insert(placed.shape, made);
                made
            }
        };
        if builder.model.faces.len() > options.most_faces {
            return Err(ModelError::new(Stage::Parse, format!("more than {} faces", options.most_faces)));
        }
        if let Some(body) = body {
            // Only what is there several times needs a path to be told apart.
            let path = if uses[&placed.shape] > 1 { placed.path.as_slice() } else { &[] };
            let path = path.iter().map(u32::to_string).collect::<Vec<_>>().join(".");
            builder.model.occurrences.push(Occurrence { path, body, placement: placed.placement });
        }
    }
    Ok(())
}
