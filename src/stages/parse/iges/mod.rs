//! IGES: files of fixed 80-column lines (IGES 5.3, ANS US PRO/IPO-100-1996, and the versions before).
//!
//! Method: lines are sorted into sections ([`lines`]); the directory says what there is ([`file`]). Visible entities
//! that are not parts of others make bodies ([`assembly`]): solids with topology ([`topology`]: 186, 514), and all
//! faces without ([`trimmed`]: trimmed surfaces 144, bounded surfaces 143 and 108, bare surfaces) together one sheet
//! body whose edges are joined where they lie together ([`stitch`]). Subfigures (308, 408) and solid assemblies (184)
//! place bodies. Entity numbers are those of the directory: the odd number of an entry's first line.
//!
//! Cost: linear in the lines, and in the entities that the faces need.
//!
//! What it does not promise: annotation, blanked entities, finite elements, constructive solid geometry, and the
//! compressed and binary forms are not read; curves in parameter space are read only for the direction of loops, and
//! where there is no curve in space.

mod assembly;
mod conic;
mod curves;
mod file;
mod global;
mod lines;
mod placement;
mod recognise;
mod ruled;
mod splines;
mod stitch;
mod surfaces;
#[cfg(test)]
mod tests;
mod topology;
mod trimmed;
mod values;

use std::sync::Arc;

use rustc_hash::FxHashMap;

use self::assembly::{Assembly, Placed, Source, assemble};
use self::curves::Space;
use self::file::File;
use self::lines::Form;
use self::stitch::Stitcher;
use self::topology::Builder;
use super::{Options, Reading};
use crate::brep::{BodyId, Curve, FreeCurve, Occurrence, Shell};
use crate::cancel::{Cancel, Cancelled};
use crate::stages::{ModelError, Stage};

/// Whether the first lines are those of an IGES file, in any of its forms.
pub(super) fn is_iges(bytes: &[u8]) -> bool {
    lines::form(bytes).is_some()
}

/// Reads the B-rep of an IGES file.
///
/// Errors: where the file holds no face that can be read, or passes a limit; and when cancelled.
pub(super) fn read(bytes: &[u8], options: &Options, cancel: &Cancel) -> Result<Reading, ModelError> {
    let stopped = |c: Cancelled| ModelError::cancelled(Stage::Parse, c);
    let failed = |why: &str| ModelError::new(Stage::Parse, why);
    match lines::form(bytes) {
        Some(Form::Fixed) => {}
        Some(Form::Compressed) => return Err(failed("a compressed IGES file: only the fixed form is read")),
        Some(Form::Binary) => return Err(failed("a binary IGES file: only the fixed form is read")),
        None => return Err(failed("not an IGES file")),
    }
    let sections = lines::sections(bytes, cancel).map_err(stopped)?;
    let file = File::new(sections, bytes.len(), cancel);
    if file.entries.is_empty() {
        return Err(failed("no entities"));
    }
    let assembly = assemble(&file, options.most_occurrences, cancel).map_err(stopped)?;
    let mut builder = Builder::new(&file);
    build(&mut builder, &assembly, options, cancel)?;
    free_curves(&mut builder, &assembly, cancel).map_err(stopped)?;
    cancel.check().map_err(stopped)?;
    let Builder { model, mut notes, .. } = builder;
    assembly.faults.into_iter().for_each(|fault| notes.skip(fault.entity, fault));
    let (skipped, warnings) = notes.finish();
    if model.occurrences.is_empty() {
        return Err(match skipped.first() {
            Some(first) => ModelError::at(Stage::Parse, first.entity, format!("no face could be read: {}", first.why)),
            None => failed("no faces"),
        });
    }
    Ok(Reading { model, skipped, warnings })
}

/// Builds each body once and places it wherever the assembly says.
fn build(builder: &mut Builder, assembly: &Assembly, options: &Options, cancel: &Cancel) -> Result<(), ModelError> {
    let stopped = |c: Cancelled| ModelError::cancelled(Stage::Parse, c);
    let mut bodies: FxHashMap<&Source, Option<BodyId>> = FxHashMap::default();
    for Placed { source, placement, path } in &assembly.placed {
        cancel.check().map_err(stopped)?;
        let body = match bodies.get(source) {
            Some(known) => *known,
            None => {
                let made = match source {
                    Source::Solid(entity) => builder.solid(*entity, cancel),
                    Source::Loose(owner) => loose(builder, &assembly.loose[owner], cancel),
                };
                let made = made.map_err(stopped)?;
                bodies.insert(source, made);
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

/// Adds the curves and points that bound no face.
fn free_curves(builder: &mut Builder, assembly: &Assembly, cancel: &Cancel) -> Result<(), Cancelled> {
    for &(entity, placement) in &assembly.free {
        cancel.check()?;
        let is_point = builder.file.entry(entity).is_ok_and(|entry| entry.kind == 116);
        let read = if is_point {
            builder.file.point(entity).map(|point| vec![Curve::Polyline(vec![point])])
        } else {
            let pieces = builder.file.pieces(entity, Space::Model);
            pieces.map(|pieces| pieces.into_iter().map(|piece| piece.bounded()).collect())
        };
        match read {
            Ok(curves) => builder.model.free_curves.extend(curves.into_iter().map(|curve| FreeCurve {
                entity,
                curve: Arc::new(curve),
                placement,
            })),
            Err(fault) => builder.notes.skip(entity, fault),
        }
    }
    Ok(())
}

/// One sheet body of faces without topology; its number is that of the first face.
fn loose(builder: &mut Builder, entities: &[u64], cancel: &Cancel) -> Result<Option<BodyId>, Cancelled> {
    let mut faces = Vec::new();
    for &entity in entities {
        cancel.check()?;
        match builder.file.raw_face(entity) {
            Ok(face) => faces.extend(face),
            Err(fault) => builder.notes.skip(entity, fault),
        }
    }
    let Some(first) = faces.first().map(|face| face.entity) else { return Ok(None) };
    let shell = builder.model.shells.len() as u32;
    let resolution = builder.file.global.resolution;
    let faces = Stitcher::new(&mut builder.model, &faces, resolution).add(faces, shell, cancel)?;
    builder.model.shells.push(Shell { entity: first, closed: false, faces });
    Ok(Some(builder.push_body(first, false, vec![shell])))
}
