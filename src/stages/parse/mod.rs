//! Stage 1: the bytes of a CAD file -> B-rep, mesh and measures.
//!
//! In: the bytes of a STEP (`step`), IGES (`iges`) or OCCT `.brep` file (`occt`); what a file is, its first bytes
//! say. Out: [`Parsed`].
//!
//! Method: a reader for each format makes the same [`Model`]; then the faces are tessellated and measured.
//!
//! Cost, and what it does not promise: as the readers say, and [`tessellate`].

mod chains;
mod cut;
mod fault;
mod iges;
mod moved;
mod notes;
mod occt;
mod on_surface;
mod sound;
mod step;

use super::{ModelError, Stage};
use crate::brep::measure::{Measures, measure};
use crate::brep::{Mesh, Model, Skipped, Wireframe, tessellate};
use crate::cancel::Cancel;
use crate::geometry::Isometry;

/// Limits of reading, and how finely faces are tessellated.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// The most bodies that an assembly may place; far above real ones, below what a few nested usages can multiply to.
    pub most_occurrences: usize,
    /// The most faces that are read, counted once for each body.
    pub most_faces: usize,
    /// How finely faces are cut.
    pub tessellation: tessellate::Options,
}

impl Default for Options {
    fn default() -> Self {
        Self { most_occurrences: 200_000, most_faces: 2_000_000, tessellation: tessellate::Options::default() }
    }
}

/// The B-rep of a file, before its faces are tessellated.
#[derive(Clone, Debug)]
pub struct Reading {
    /// The B-rep.
    pub model: Model,
    /// Entities that were left out, with the reason.
    pub skipped: Vec<Skipped>,
    /// Things that were mended or guessed.
    pub warnings: Vec<String>,
}

/// A model as read: what the later stages work on.
#[derive(Clone, Debug)]
pub struct Parsed {
    /// The B-rep.
    pub model: Model,
    /// The faces of all occurrences, tessellated, in place.
    pub mesh: Mesh,
    /// The edges of the mesh.
    pub wireframe: Wireframe,
    /// Area, volume, centroid, box and size.
    pub measures: Measures,
    /// Entities that were left out, with the reason.
    pub skipped: Vec<Skipped>,
    /// Things that were mended or guessed.
    pub warnings: Vec<String>,
}

/// Memory that is filled anew for each model.
#[derive(Default)]
pub struct Scratch {
    step: step::Scratch,
    tessellation: tessellate::Scratch,
}

impl Scratch {
    /// Bytes of memory that it holds.
    pub fn bytes(&self) -> usize {
        self.step.bytes() + self.tessellation.bytes()
    }
}

/// Reads a file, moves it by `pose` where there is one, tessellates and measures it.
///
/// # Errors
/// As [`read`]; and where no face can be tessellated or the model is too large or small for mm in `f64`.
pub fn parse(bytes: &[u8], options: &Options, pose: Option<&Isometry>, cancel: &Cancel) -> Result<Parsed, ModelError> {
    parse_in(&mut Scratch::default(), bytes, options, pose, cancel)
}

/// [`parse`] in memory that others have done with.
///
/// # Errors
/// As [`parse`].
pub fn parse_in(
    scratch: &mut Scratch,
    bytes: &[u8],
    options: &Options,
    pose: Option<&Isometry>,
    cancel: &Cancel,
) -> Result<Parsed, ModelError> {
    let Reading { model, mut skipped, mut warnings } = read_in(&mut scratch.step, bytes, options, cancel)?;
    let model = match pose {
        Some(pose) => model.moved(pose),
        None => model,
    };
    let meshed = tessellate::tessellate_in(&mut scratch.tessellation, &model, &options.tessellation, cancel);
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
    let wireframe = Wireframe::of(&mesh);
    Ok(Parsed { model, mesh, wireframe, measures, skipped, warnings })
}

/// The same STEP file with everything in it moved by a proper isometry: all its entities stay as they are, and a new
/// product above the file's own places them.
///
/// # Errors
/// Where the bytes are no STEP file, or one that cannot be moved by adding entities; and when cancelled.
pub fn relocated(bytes: &[u8], by: &Isometry, options: &Options, cancel: &Cancel) -> Result<Vec<u8>, ModelError> {
    if occt::is_brep(bytes) || iges::is_iges(bytes) {
        let why = "only a STEP file can be written as STEP; write this one as .glb, .stl or .obj";
        return Err(ModelError::new(Stage::Parse, why));
    }
    step::relocated(bytes, by, options, cancel)
}

/// Reads the B-rep of a file, in mm.
///
/// # Errors
/// Where the bytes are of no format that is read, hold no face that can be read, or pass a limit; and when cancelled.
pub fn read(bytes: &[u8], options: &Options, cancel: &Cancel) -> Result<Reading, ModelError> {
    read_in(&mut step::Scratch::default(), bytes, options, cancel)
}

fn read_in(
    scratch: &mut step::Scratch,
    bytes: &[u8],
    options: &Options,
    cancel: &Cancel,
) -> Result<Reading, ModelError> {
    if occt::is_brep(bytes) {
        return occt::read(bytes, options, cancel);
    }
    if iges::is_iges(bytes) {
        return iges::read(bytes, options, cancel);
    }
    step::read(scratch, bytes, options, cancel)
}
