//! Stage 6: validated symmetries -> the dominant symmetry.

use crate::brep::PlacedFaceId;
use crate::geometry::{Plane, Point, Vector};

/// How much of the surface the best plane maps onto the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Label {
    /// Coverage >= 0.995.
    Exact,
    /// Coverage >= 0.9.
    NearGlobal,
    /// Coverage >= 0.1.
    Partial,
    None,
}

/// A mirror plane with its evidence.
#[derive(Clone, Debug)]
pub struct SymmetryPlane {
    pub plane: Plane,
    /// Surface support: the share of the whole surface's area whose mirror image lies on the surface.
    pub coverage: f64,
    /// Root mean square of the distances of mirrored corners (or samples) to their images, mm.
    pub residual: f64,
    /// Faces that are each other's mirror image.
    pub pairs: Vec<(PlacedFaceId, PlacedFaceId)>,
    /// Faces that the plane cuts into mirror images.
    pub selfs: Vec<PlacedFaceId>,
}

/// The axis of a body of revolution.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    pub point: Point,
    pub direction: Vector,
}

/// The symmetries of a model, best plane first.
#[derive(Clone, Debug)]
pub struct Symmetries {
    pub label: Label,
    pub planes: Vec<SymmetryPlane>,
    pub axes: Vec<Axis>,
}
