//! Stage 1: the bytes of a STEP file -> B-rep, mesh and measures.
//!
//! In: the bytes of a Part 21 file (ISO 10303-21) of AP203, AP214 or AP242. Out: [`Parsed`].
//!
//! Method: one pass finds where each instance starts ([`lexer`]); the products and representations say which bodies
//! lie where ([`assembly`]); only what these bodies refer to is decoded, by the parametrisations of ISO 10303-42
//! ([`curves`], [`surfaces`], [`topology`]); then the faces are tessellated and measured.
//!
//! Cost: the pass is linear in the bytes and copies nothing; decoding is linear in the entities that the B-rep needs;
//! a body used several times is built once.
//!
//! What it does not promise: pcurves, styles, names and tolerances are not read; wireframes make no faces; external
//! references are not followed.

mod assembly;
mod bodies;
mod cursor;
mod curves;
mod facets;
mod header;
mod keyword;
mod lexer;
mod notes;
mod placement;
mod records;
mod replica;
mod representation;
mod splines;
mod structure;
mod surfaces;
#[cfg(test)]
mod tests;
mod topology;
mod units;

use rustc_hash::FxHashMap;

use self::assembly::{Assembly, assemble};
use self::placement::Geometry;
use self::records::File;
use self::representation::Placed;
use self::topology::Builder;
use super::{ModelError, Stage};
use crate::brep::measure::{Measures, measure};
use crate::brep::{BodyId, Mesh, Model, Occurrence, Skipped, tessellate};
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::Isometry;

/// Limits of reading, and how finely faces are tessellated.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// The most bodies that an assembly may place; far above real ones, below what a few nested usages can multiply to.
    pub most_occurrences: usize,
    /// The most faces that are read, counted once for each body.
    pub most_faces: usize,
    pub tessellation: tessellate::Options,
}

impl Default for Options {
    fn default() -> Self {
        Self { most_occurrences: 200_000, most_faces: 2_000_000, tessellation: tessellate::Options::default() }
    }
}

/// A model as read: what the later stages work on.
#[derive(Clone, Debug)]
pub struct Parsed {
    pub model: Model,
    /// The faces of all occurrences, tessellated, in place.
    pub mesh: Mesh,
    pub measures: Measures,
    /// Entities that were left out, with the reason.
    pub skipped: Vec<Skipped>,
    /// Things that were mended or guessed.
    pub warnings: Vec<String>,
}

/// Reads a STEP file, moves it by `pose` where there is one, tessellates and measures it.
///
/// # Errors
/// As [`read`]; and where no face can be tessellated or the model is too large or small for mm in `f64`.
pub fn parse(bytes: &[u8], options: &Options, pose: Option<&Isometry>, cancel: &Cancel) -> Result<Parsed, ModelError> {
    let (model, mut skipped, mut warnings) = read(bytes, options, cancel)?;
    let model = match pose {
        Some(pose) => model.moved(pose),
        None => model,
    };
    let meshed = tessellate::tessellate(&model, &options.tessellation, cancel);
    let (mesh, more_skipped, more_warnings) = meshed.map_err(|c| ModelError::cancelled(Stage::Parse, c))?;
    skipped.extend(more_skipped);
    warnings.extend(more_warnings);
    let measures = measure(&model, &mesh);
    let size = measures.tolerance.size();
    if mesh.faces.is_empty() || size.is_nan() || size <= 0.0 || size.is_infinite() {
        return Err(match skipped.first() {
            Some(first) => ModelError::at(Stage::Parse, first.entity, format!("no usable face: {}", first.why)),
            None => ModelError::new(Stage::Parse, "no usable face"),
        });
    }
    Ok(Parsed { model, mesh, measures, skipped, warnings })
}

/// Reads the B-rep of a STEP file, in mm, with what was left out and what was mended or guessed.
///
/// # Errors
/// Where the bytes are no STEP file, hold no face that can be read, or pass a limit; and when cancelled.
pub fn read(
    bytes: &[u8],
    options: &Options,
    cancel: &Cancel,
) -> Result<(Model, Vec<Skipped>, Vec<String>), ModelError> {
    let stopped = |c: Cancelled| ModelError::cancelled(Stage::Parse, c);
    let mut table = lexer::scan(bytes, cancel).map_err(stopped)?;
    let warnings = std::mem::take(&mut table.warnings);
    if table.entries.is_empty() {
        let why = if table.marked { "no entities" } else { "not a STEP file" };
        return Err(ModelError::new(Stage::Parse, why));
    }
    let file = File { bytes, table: &table };
    let assembly = assemble(file, options.most_occurrences, cancel).map_err(stopped)?;
    let units = assembly.placed.first().map(|p| p.units).unwrap_or_default();
    let mut builder = Builder::new(Geometry::new(file, units));
    builder.model.schema = header::schema(&file);
    builder.model.unit_mm = units.length;
    warnings.into_iter().for_each(|w| builder.notes.warn(w));
    build(&mut builder, &assembly, options, cancel)?;
    let Builder { model, mut notes, .. } = builder;
    assembly.faults.iter().for_each(|(id, fault)| notes.skip(*id, fault.clone()));
    let (skipped, warnings) = notes.finish();
    if model.occurrences.is_empty() {
        return Err(no_faces(&assembly, &skipped));
    }
    Ok((model, skipped, warnings))
}

/// Builds each body once and places it wherever the assembly says.
fn build(builder: &mut Builder, assembly: &Assembly, options: &Options, cancel: &Cancel) -> Result<(), ModelError> {
    let stopped = |c: Cancelled| ModelError::cancelled(Stage::Parse, c);
    let mut bodies: FxHashMap<u64, Option<BodyId>> = FxHashMap::default();
    for Placed { item, kind, units, placement, path } in &assembly.placed {
        cancel.check().map_err(stopped)?;
        let body = match bodies.get(item) {
            Some(known) => *known,
            None => {
                let file = builder.geometry.file;
                builder.use_units(*units);
                let record = file.record(*item).map_err(|f| ModelError::at(Stage::Parse, f.entity, f.why))?;
                let made = builder.body(&record, *kind, cancel).map_err(stopped)?;
                bodies.insert(*item, made);
                made
            }
        };
        if builder.model.faces.len() > options.most_faces {
            return Err(ModelError::new(Stage::Parse, format!("more than {} faces", options.most_faces)));
        }
        if let Some(body) = body {
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
