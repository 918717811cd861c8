//! Stage 7: dominant symmetry -> canonical frame.

use crate::geometry::Frame;

/// Which method gave the first axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Source {
    Symmetry,
    Rectilinearity,
    Cpca,
}

/// The projected area of the model on the planes that contain the reference axis.
#[derive(Clone, Debug, Default)]
pub struct Sweep {
    /// Angles of the plane normals about the reference axis, radians.
    pub angles: Vec<f64>,
    /// Areas of the shadows, mm^2.
    pub areas: Vec<f64>,
}

/// The canonical pose of a model.
#[derive(Clone, Debug)]
pub struct CanonicalFrame {
    pub frame: Frame,
    pub source: Source,
    /// Projected areas along the three axes, mm^2.
    pub areas: [f64; 3],
    pub sweep: Sweep,
    /// The areas hardly differ with the angle: the second axis is a convention.
    pub axisymmetric: bool,
}
