//! Stage 8: frame -> three silhouettes, their contours, and the Fourier descriptors.

/// Harmonics kept of each contour.
pub const HARMONICS: usize = 32;
/// Numbers in a magnitude descriptor: three views of [`HARMONICS`] magnitudes.
pub const MAGNITUDES: usize = 3 * HARMONICS;
/// Numbers in a phase descriptor: three views, two starting points, [`HARMONICS`] complex coefficients.
pub const PHASES: usize = 3 * 2 * HARMONICS * 2;

/// The descriptor of one model in one frame (the paper's section VI).
#[derive(Clone, Debug, PartialEq)]
pub struct Descriptor {
    /// `[view][k]`: |F_k| / |F_0|, k = 1..=32; view i looks along axis i of the frame.
    pub magnitude: [[f32; HARMONICS]; 3],
    /// `[view][start][k]`: complex F_k / |F_0| as (re, im), the contour starting where the view's first remaining
    /// axis meets it on the positive (start 0) or the negative side (start 1), traced counter-clockwise.
    pub phase: [[[[f32; 2]; HARMONICS]; 2]; 3],
    /// Views whose silhouette fell into components and was described against its convex hull.
    pub hull: [bool; 3],
}
