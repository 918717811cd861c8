//! B-rep -> triangles: edges first, so that both faces of an edge share its points, then each face in its
//! parameter space.
//!
//! In: a [`Model`]. Out: a [`Mesh`] of all occurrences with exact areas, what was left out, and what was guessed.
//!
//! Method: every edge becomes one polyline. A face's loops, less its seams (`border`), are projected onto the surface,
//! unwrapped over the periods and laid out as closed paths (`boundary`). Level rings that go round the surface have rows of
//! triangles between them (`bands`), other paths that go round it are wrapped into a strip that is cut open (`strip`).
//! Polygons are cut into ears, straight-lined walls into strips; everything else is a constrained Delaunay
//! triangulation with interior points by curvature, and the inside is found by the parity of crossings (`domain`).
//! Edges that are too coarse for a narrow face are cut again (`refine`). Area, centroid and flux are integrals over
//! the true trimmed surface (`integrate`).
//!
//! Cost: linear in edges and faces; a Delaunay face of n points takes O(n log n). One face after the other is made in the
//! same memory (`face::Scratch`) and added to few arrays, so that most faces take no memory of their own.
//!
//! It does not promise: that free-form silhouettes are nearer than the deflection; that a face whose edges do not
//! lie on its surface has the right shape (it is filled with a plane, with a warning).

mod bands;
mod bending;
mod border;
mod boundary;
mod chart;
mod columns;
mod domain;
mod edges;
mod face;
mod fallback;
mod integrate;
mod interior;
mod place;
mod refine;
mod rings;
mod sphere;
mod spindle;
mod strip;
mod triangulate;

#[cfg(test)]
mod tests;

use rayon::prelude::*;
use smallvec::SmallVec;

use super::{EdgeId, Face, Mesh, Model, Skipped};
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::Point;
use edges::{EdgeLines, Fineness};
use face::{Context, Meshes};
use place::Place;

/// What a face has one or two of in most cases, such as loops.
type Few<T> = SmallVec<[T; 2]>;

/// How finely models are tessellated.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Largest distance between a chord and its edge or surface, as a share of the model's diameter,
    /// measured alike in every pose.
    /// 0.001 is half a pixel of a silhouette of 512 pixels.
    pub deflection: f64,
    /// Largest angle between neighbouring chords, radians. 0.35 (20 degrees) keeps small holes round.
    pub angle: f64,
    /// Triangles of one model at most, over all occurrences. Where there would be more the chords are longer, and where
    /// that does not help faces are left out; both are reported. Bounds the memory at about half a gigabyte.
    pub max_triangles: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { deflection: 0.001, angle: 0.35, max_triangles: 8_000_000 }
    }
}

/// Models with fewer faces than this are not worth more than one thread: what is woken for some milliseconds costs as
/// much as it does, and other models wait for the cores.
const PARALLEL_FACES: usize = 2048;
/// Where there would be too many triangles, chords are made this many times as long at most: hexagons for circles.
const COARSEST: f64 = 3.0;
/// Faces that are tessellated before their triangles are counted.
const BATCH: usize = 512;
/// Faces of a batch that a thread takes at a time.
const PART: usize = 8;

/// Memory that is filled anew for each model.
#[derive(Default)]
pub struct Scratch {
    lines: EdgeLines,
    face: face::Scratch,
    meshes: Meshes,
}

impl Scratch {
    /// Bytes of memory that it holds.
    pub fn bytes(&self) -> usize {
        self.lines.bytes() + self.face.bytes() + self.meshes.bytes()
    }
}

/// The mesh of all placed faces, the faces left out (with the reason), and warnings.
pub type Tessellated = (Mesh, Vec<Skipped>, Vec<String>);

/// Tessellates one model.
///
/// # Errors
/// Only when cancelled.
pub fn tessellate(model: &Model, options: &Options, cancel: &Cancel) -> Result<Tessellated, Cancelled> {
    tessellate_in(&mut Scratch::default(), model, options, cancel)
}

/// [`tessellate`] in memory that others have done with.
///
/// # Errors
/// Only when cancelled.
pub fn tessellate_in(
    scratch: &mut Scratch,
    model: &Model,
    options: &Options,
    cancel: &Cancel,
) -> Result<Tessellated, Cancelled> {
    let spans = spans(model, cancel)?;
    let places = place::places(model, &spans);
    let size = place::model_size(model, &places);
    if size.is_nan() || size <= 0.0 || size.is_infinite() {
        let why = "the model has no extent".to_owned();
        return Ok((Mesh::default(), all_skipped(model, &why), vec![why]));
    }
    let part_size = size / place::largest_scale(model);
    let reference = references(model, &places);
    let Scratch { lines, face, meshes } = scratch;
    let most = options.max_triangles;
    let mut coarser = 1.0;
    loop {
        let fineness = Fineness::new(options, part_size).coarser(coarser);
        lines.fill(model, &spans, &fineness, most, cancel)?;
        let degenerate = (0..spans.len()).map(|e| is_point(lines, EdgeId(e as u32), 1e-7 * part_size)).collect();
        let reference = reference.clone();
        let mut context =
            Context { model, cancel, lines: &mut *lines, degenerate, fineness, coarser, size: part_size, reference };
        face_meshes(&context, most, face, meshes)?;
        let share = place::triangles(model, &meshes.faces) as f64 / most as f64;
        if share > 1.0 && coarser < COARSEST {
            // The second time nothing is left to chance.
            coarser = if coarser > 1.0 { COARSEST } else { (1.2 * share.sqrt()).min(COARSEST) };
            continue;
        }
        refine::refine(&mut context, &spans, meshes, face, cancel)?;
        let warning = context.lines.warning();
        let (mesh, skipped, mut warnings) = place::place(model, meshes, most, cancel)?.finish();
        warnings.extend(warning);
        if coarser > 1.0 {
            warnings.push(format!("chords are {coarser:.1} times as long as asked for: too many triangles"));
        }
        return Ok((mesh, skipped, warnings));
    }
}

/// Where each edge begins and ends on its curve.
fn spans(model: &Model, cancel: &Cancel) -> Result<Vec<Option<[f64; 2]>>, Cancelled> {
    let span = |edge: usize| cancel.check().map(|()| model.edge_span(EdgeId(edge as u32)));
    (0..model.edges.len()).map(span).collect()
}

fn all_skipped(model: &Model, why: &str) -> Vec<Skipped> {
    model.faces.iter().map(|f| Skipped { entity: f.entity, why: why.to_owned() }).collect()
}

fn is_point(lines: &EdgeLines, edge: EdgeId, tolerance: f64) -> bool {
    let (points, middles) = lines.line(edge);
    points.iter().chain(middles).all(|p| (p - points[0]).norm() <= tolerance)
}

/// The reference point of each face: the centre of its body.
fn references(model: &Model, places: &[Option<Place>]) -> Vec<Point> {
    let mut points = vec![Point::origin(); model.faces.len()];
    for (body, place) in model.bodies.iter().zip(places) {
        let faces = body.shells.iter().flat_map(|&s| &model.shells[s as usize].faces);
        if let Some(place) = place {
            faces.for_each(|f| points[f.index()] = place.centre);
        }
    }
    points
}

/// The meshes of the faces in their order, of the first ones only where these have more than `most` triangles.
fn face_meshes(
    context: &Context,
    most: usize,
    scratch: &mut face::Scratch,
    meshes: &mut Meshes,
) -> Result<(), Cancelled> {
    let (faces, account) = (&context.model.faces, context.cancel.account());
    // Most points are those of edges, each in two faces.
    meshes.empty(faces.len(), 2 * context.lines.count().min(most));
    for (batch, references) in faces.chunks(BATCH).zip(context.reference.chunks(BATCH)) {
        if faces.len() < PARALLEL_FACES {
            add_meshes(context, (batch, references), scratch, meshes)?;
        } else {
            let of_thread = |scratch: &mut face::Scratch, part| {
                account.within(|| {
                    let mut made = Meshes::default();
                    add_meshes(context, part, scratch, &mut made).map(|()| made)
                })
            };
            let parts = batch.par_chunks(PART).zip(references.par_chunks(PART));
            let made: Vec<Meshes> = parts.map_init(face::Scratch::default, of_thread).collect::<Result<_, _>>()?;
            made.into_iter().for_each(|made| meshes.append(made));
        }
        if meshes.triangles.len() > most {
            break;
        }
    }
    Ok(())
}

/// Tessellates some faces, each with the point that its integrals refer to.
fn add_meshes(
    context: &Context,
    (faces, references): (&[Face], &[Point]),
    scratch: &mut face::Scratch,
    meshes: &mut Meshes,
) -> Result<(), Cancelled> {
    for (face, reference) in faces.iter().zip(references) {
        let mesh = meshes.make(context, face, reference, scratch);
        // Asked afterwards, too: what a cancelled face says means nothing.
        context.cancel.check()?;
        meshes.faces.push(mesh);
    }
    Ok(())
}
