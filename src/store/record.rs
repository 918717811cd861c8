//! What a run keeps of one model.

use std::collections::BTreeMap;

use crate::alignment::Method;
use crate::geometry::{Frame, Point, Vector};
use crate::stages::ModelError;
use crate::stages::descriptor::{Descriptor, HARMONICS, MAGNITUDES, PHASES};
use crate::stages::merge::Label;
use crate::stages::projection_sweep::Source;

/// BLAKE3 of a model's bytes.
pub type Hash = [u8; 32];

/// Side of a thumbnail in pixels.
pub const THUMBNAIL: usize = 96;

/// Mirror planes kept of each model, best first; there are counts for the rest.
pub const PLANES_KEPT: usize = 16;
/// Pairs of faces, faces mapped onto themselves, skipped entities and warnings kept of each, at most.
pub const EVIDENCE_KEPT: usize = 64;

/// A model that was lost, and why.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Failure {
    /// Its path inside the input.
    pub id: String,
    /// `None` where the bytes could not even be read.
    pub hash: Option<Hash>,
    /// Where and why it was lost.
    pub error: ModelError,
}

/// A mirror plane with its evidence, in the coordinates the run worked in (the file's own, in mm, unless
/// `--random-pose` moved the model).
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PlaneEvidence {
    /// Unit normal n of the plane n.x = offset.
    pub normal: [f64; 3],
    /// Of the plane n.x = offset, mm.
    pub offset_mm: f64,
    /// Share of the surface's area whose mirror image lies on the surface, 0 to 1.
    pub coverage: f64,
    /// Root mean square of the distances of mirrored corners to their images, mm.
    pub residual_mm: f64,
    /// Names of faces that mirror each other: the first [`EVIDENCE_KEPT`] of `pair_count`.
    pub pairs: Vec<(String, String)>,
    /// All pairs.
    pub pair_count: usize,
    /// Names of faces mapped onto themselves: the first [`EVIDENCE_KEPT`] of `self_count`.
    pub selfs: Vec<String>,
    /// All faces mapped onto themselves.
    pub self_count: usize,
}

/// The axis of a body of revolution.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct AxisEvidence {
    /// A point on the axis, mm.
    pub point_mm: [f64; 3],
    /// Unit.
    pub direction: [f64; 3],
}

/// What a model is and what was found in it: the evidence beside its descriptors.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Summary {
    /// Schema of a STEP file, else format and version.
    pub schema: String,
    /// Millimetres in one length unit of the file.
    pub unit_mm: f64,
    /// Placed solids.
    pub solids: usize,
    /// Placed faces.
    pub faces: usize,
    /// Edges of placed bodies.
    pub edges: usize,
    /// Triangles of the mesh.
    pub triangles: usize,
    /// Area of all faces, mm^2.
    pub area_mm2: f64,
    /// Volume of all solids, mm^3.
    pub volume_mm3: f64,
    /// Area centroid, mm.
    pub centroid_mm: [f64; 3],
    /// Minimum, then maximum.
    pub bbox_mm: [f64; 6],
    /// Entities left out with the reason: the first [`EVIDENCE_KEPT`] of `skipped_count`.
    pub skipped: Vec<(u64, String)>,
    /// All entities left out.
    pub skipped_count: usize,
    /// The first [`EVIDENCE_KEPT`] of `warning_count`.
    pub warnings: Vec<String>,
    /// All warnings.
    pub warning_count: usize,
    /// How symmetric it is.
    pub label: Label,
    /// Best first: the first [`PLANES_KEPT`] of `plane_count`.
    pub planes: Vec<PlaneEvidence>,
    /// All planes found.
    pub plane_count: usize,
    /// The axis of a body of revolution.
    pub axes: Vec<AxisEvidence>,
    /// Which method gave the symmetry frame its first axis.
    pub source: Source,
    /// Projected areas along the three axes of the symmetry frame, mm^2.
    pub areas_mm2: [f64; 3],
    /// The second axis of the symmetry frame is a convention.
    pub axisymmetric: bool,
    /// For each method, the views whose silhouette was described against its convex hull.
    pub hull: BTreeMap<Method, [bool; 3]>,
}

/// A model's pose by one method, described.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Pose {
    /// What aligned it.
    pub method: Method,
    /// Axes row by row, then the origin in mm.
    pub frame: [f64; 12],
    /// [`MAGNITUDES`] numbers: view by view, harmonic by harmonic.
    pub magnitude: Vec<f32>,
    /// [`PHASES`] numbers: by view, starting point, harmonic, then (re, im).
    pub phase: Vec<f32>,
}

impl Pose {
    /// The record of `descriptor` in `frame`.
    pub fn new(method: Method, frame: &Frame, descriptor: &Descriptor) -> Self {
        let magnitude = descriptor.magnitude.as_flattened().to_vec();
        let phase = descriptor.phase.as_flattened().as_flattened().as_flattened().to_vec();
        Self { method, frame: frame_numbers(frame), magnitude, phase }
    }

    /// Whether the descriptors have the lengths the format asks for.
    pub fn is_whole(&self) -> bool {
        self.magnitude.len() == MAGNITUDES && self.phase.len() == PHASES
    }
}

/// All that is kept of a model that was done.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ModelRecord {
    /// The evidence.
    pub summary: Summary,
    /// [`THUMBNAIL`] x [`THUMBNAIL`] grey levels, row by row.
    pub thumbnail: Vec<u8>,
    /// One for each method of the run, in the run's order.
    pub poses: Vec<Pose>,
}

impl ModelRecord {
    /// Whether the record fits the format and the methods of the run.
    pub fn is_whole(&self, methods: &[Method]) -> bool {
        self.thumbnail.len() == THUMBNAIL * THUMBNAIL
            && self.poses.iter().map(|p| p.method).eq(methods.iter().copied())
            && self.poses.iter().all(Pose::is_whole)
    }
}

/// Axes row by row, then the origin.
pub fn frame_numbers(frame: &Frame) -> [f64; 12] {
    let mut numbers = [0.0; 12];
    for (i, axis) in frame.axes.iter().enumerate() {
        numbers[3 * i..3 * i + 3].copy_from_slice(axis.as_slice());
    }
    numbers[9..].copy_from_slice(frame.origin.coords.as_slice());
    numbers
}

/// The frame that [`frame_numbers`] wrote.
pub fn frame_of(numbers: &[f64; 12]) -> Frame {
    let row = |i: usize| Vector::new(numbers[i], numbers[i + 1], numbers[i + 2]);
    Frame { axes: [row(0), row(3), row(6)], origin: Point::from(row(9)) }
}

// The descriptor is stored as it lies in memory; these say that nothing was padded or reordered.
const _: () = assert!(MAGNITUDES == 3 * HARMONICS);
const _: () = assert!(PHASES == 3 * 2 * HARMONICS * 2);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_survives_its_numbers() {
        let frame = Frame::from_two(Point::new(1.0, 2.0, 3.0), &Vector::z(), &Vector::x());
        assert_eq!(frame_of(&frame_numbers(&frame)), frame);
        assert_eq!(frame_numbers(&frame)[..3], [0.0, 0.0, 1.0]);
        assert_eq!(frame_numbers(&frame)[9..], [1.0, 2.0, 3.0]);
    }

    #[test]
    fn phases_are_stored_by_view_start_harmonic_and_part() {
        let mut descriptor =
            Descriptor { magnitude: [[0.0; HARMONICS]; 3], phase: [[[[0.0; 2]; HARMONICS]; 2]; 3], hull: [false; 3] };
        descriptor.magnitude[2][5] = 7.0;
        descriptor.phase[1][1][3][1] = 9.0;
        let frame = Frame::from_two(Point::origin(), &Vector::x(), &Vector::y());
        let pose = Pose::new(Method::Pca, &frame, &descriptor);
        assert!(pose.is_whole());
        assert_eq!(pose.magnitude[2 * HARMONICS + 5], 7.0);
        assert_eq!(pose.phase[((2 + 1) * HARMONICS + 3) * 2 + 1], 9.0);
    }
}
