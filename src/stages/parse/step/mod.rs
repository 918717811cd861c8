//! STEP: Part 21 files (ISO 10303-21) of AP203, AP214 or AP242.
//!
//! Method: one pass finds where each instance starts ([`lexer`]); the products and representations say which bodies
//! lie where ([`assembly`]); only what these bodies refer to is decoded, by the parametrisations of ISO 10303-42
//! ([`curves`], [`surfaces`], [`topology`]).
//!
//! Cost: the pass is linear in the bytes and copies nothing; decoding is linear in the entities that the B-rep needs;
//! a body used several times is built once.
//!
//! What it does not promise: pcurves, styles, names and tolerances are not read, nor are the lines of edges, of which
//! the vertices tell all; wireframes make no faces; external references are not followed.

mod assembly;
mod bodies;
mod cursor;
mod curves;
mod effort;
mod eight;
mod facets;
mod free_curves;
mod header;
mod keyword;
mod known;
mod lexer;
mod placement;
mod records;
mod relocate;
mod representation;
mod splines;
mod structure;
mod surfaces;
#[cfg(test)]
mod tests;
mod topology;
mod units;

use std::sync::Arc;

use rustc_hash::FxHashMap;

use self::assembly::{Assembly, assemble};
use self::bodies::BodyKind;
use self::known::Known;
use self::lexer::Entry;
use self::placement::Geometry;
use self::records::File;
use self::representation::Placed;
use self::topology::Builder;
use super::{Options, Reading};
use crate::brep::{BodyId, Curve, FreeCurve, Occurrence, Skipped};
use crate::cancel::{Cancel, Cancelled};
use crate::memory::{held, kept};
use crate::stages::{ModelError, Stage};
pub(super) use relocate::relocated;

/// Memory that is filled anew for each file. What is read takes it out and puts it back; where reading fails, or
/// the file is large, it is gone.
#[derive(Default)]
pub(super) struct Scratch {
    entries: Vec<Entry>,
    known: Vec<u32>,
}

impl Scratch {
    /// Bytes of memory that it holds.
    pub fn bytes(&self) -> usize {
        held(&self.entries) + held(&self.known)
    }
}

/// Reads the B-rep of a STEP file, in mm.
///
/// Errors: where the bytes are no STEP file, hold no face that can be read, or pass a limit; and when cancelled.
pub(super) fn read(
    scratch: &mut Scratch,
    bytes: &[u8],
    options: &Options,
    cancel: &Cancel,
) -> Result<Reading, ModelError> {
    let stopped = |c: Cancelled| ModelError::cancelled(Stage::Parse, c);
    let mut table = lexer::scan_in(std::mem::take(&mut scratch.entries), bytes, cancel).map_err(stopped)?;
    let warnings = std::mem::take(&mut table.warnings);
    if table.entries.is_empty() {
        let why = if table.marked { "no entities" } else { "not a STEP, IGES or .brep file" };
        return Err(ModelError::new(Stage::Parse, why));
    }
    let file = File { bytes, table: &table };
    let assembly = assemble(file, options.most_occurrences, cancel).map_err(stopped)?;
    let units = assembly.placed.first().map(|p| p.units).unwrap_or_default();
    let known = Known::new(std::mem::take(&mut scratch.known), &file);
    let mut builder = Builder::new(Geometry::new(file, units), known);
    builder.model.schema = header::schema(&file);
    builder.model.unit_mm = units.length;
    warnings.into_iter().for_each(|w| builder.notes.warn(w));
    build(&mut builder, &assembly, options, cancel)?;
    cancel.check().map_err(stopped)?;
    let Builder { model, mut notes, known, .. } = builder;
    *scratch = Scratch { known: known.done(), entries: kept(table.entries) };
    assembly.faults.iter().for_each(|(id, fault)| notes.skip(*id, fault.clone()));
    let (skipped, warnings) = notes.finish();
    if model.occurrences.is_empty() {
        return Err(no_faces(&assembly, &skipped));
    }
    Ok(Reading { model, skipped, warnings })
}

/// What an item of a representation makes: a body, and curves beside it.
type Made = (Option<BodyId>, Vec<(u64, Arc<Curve>)>);

/// Builds each body once and places it wherever the assembly says.
fn build(builder: &mut Builder, assembly: &Assembly, options: &Options, cancel: &Cancel) -> Result<(), ModelError> {
    let stopped = |c: Cancelled| ModelError::cancelled(Stage::Parse, c);
    let mut known: FxHashMap<u64, Made> = FxHashMap::default();
    for Placed { item, kind, units, placement, path } in &assembly.placed {
        cancel.check().map_err(stopped)?;
        if !known.contains_key(item) {
            let file = builder.geometry.file;
            builder.use_units(*units);
            let record = file.record(*item).map_err(|f| ModelError::at(Stage::Parse, f.entity, f.why))?;
            let body = builder.body(&record, *kind, cancel).map_err(stopped)?;
            let curves = match kind {
                BodyKind::Set => builder.free_curves(*item, cancel).map_err(stopped)?,
                _ => Vec::new(),
            };
            known.insert(*item, (body, curves));
        }
        let (body, curves) = &known[item];
        let placed = |(entity, curve): &(u64, Arc<Curve>)| FreeCurve {
            entity: *entity,
            curve: curve.clone(),
            placement: *placement,
        };
        let room = options.most_occurrences.saturating_sub(builder.model.free_curves.len());
        builder.model.free_curves.extend(curves.iter().take(room).map(placed));
        if builder.model.faces.len() > options.most_faces {
            return Err(ModelError::new(Stage::Parse, format!("more than {} faces", options.most_faces)));
        }
        if let Some(body) = *body {
            let path = path.iter().map(u64::to_string).collect::<Vec<_>>().join(".");
            builder.model.occurrences.push(Occurrence { path, body, placement: *placement });
        }
    }
    Ok(())
}

/// Why a file made no face.
fn no_faces(assembly: &Assembly, skipped: &[Skipped]) -> ModelError {
    match (skipped.first(), assembly.placed.first()) {
        (Some(first), _) => ModelError::at(Stage::Parse, first.entity, format!("no face could be read: {}", first.why)),
        (None, Some(_)) => ModelError::new(Stage::Parse, "wireframe only: no faces"),
        (None, None) if assembly.has_representations => ModelError::new(Stage::Parse, "no B-rep in any representation"),
        (None, None) => ModelError::new(Stage::Parse, "no shape representation"),
    }
}
