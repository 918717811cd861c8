//! Stage 8: frame -> three silhouettes, their contours, and the Fourier descriptors.
//!
//! In: the wireframe of a mesh, the mesh's measures and a frame. Out: a [`Descriptor`].
//! Method: the paper's section VI. View i looks along axis i of the frame; its picture has axis i + 1 to the right and
//! axis i + 2 up (mod 3). The outer contour of the silhouette is sampled at 256 points equally spaced by arc length,
//! their distances from the silhouette's centroid are transformed, and F_k / |F_0| is kept, k = 1 to 32: magnitudes,
//! which ignore the turn of the picture, and complex numbers from two starting points on the view's first axis, which
//! do not. A silhouette in several parts is described against its convex hull (Dalitz et al. 2013).
//! Cost: about a millisecond a view for ten thousand triangles.
//! It does not promise anything about holes: only outer contours are described.

pub mod contour;
pub mod fourier;
pub mod hull;

use crate::brep::Wireframe;
use crate::brep::measure::Measures;
use crate::cancel::Cancel;
use crate::geometry::Frame;
use crate::silhouette::Silhouette;
use crate::silhouette::draw::Raster;
use crate::stages::{ModelError, Stage};

use contour::Contour;
use fourier::{Path, Start};

/// Harmonics kept of each contour.
pub const HARMONICS: usize = 32;
/// Numbers in a magnitude descriptor: three views of [`HARMONICS`] magnitudes.
pub const MAGNITUDES: usize = 3 * HARMONICS;
/// Numbers in a phase descriptor: three views, two starting points, [`HARMONICS`] complex coefficients.
pub const PHASES: usize = 3 * 2 * HARMONICS * 2;

/// Settings of the descriptor.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Pixels on a side of a silhouette. 256 to 512 retrieve alike, 64 is too coarse.
    pub side: u32,
    /// Points on a contour; at least 66 for 32 harmonics. 256 as in the shape-descriptor literature.
    pub points: u32,
    /// Gaps of this share of D between the parts of a silhouette are closed.
    pub gap: f64,
    /// Share of the silhouette that the outer contour must enclose, else the convex hull is used.
    pub enclosed: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { side: 512, points: 256, gap: 0.01, enclosed: 0.95 }
    }
}

impl Options {
    fn side(&self) -> usize {
        self.side.clamp(16, 8192) as usize
    }

    fn points(&self) -> usize {
        self.points.clamp(2 * HARMONICS as u32 + 2, 65_536) as usize
    }

    /// Half the widest gap that is closed, pixels.
    fn closing_radius(&self) -> usize {
        (0.5 * self.gap.clamp(0.0, 0.2) * self.side() as f64).ceil() as usize
    }

    /// Pixels to the mm for a model of size `size`: the bounding ball fits with room for the closing.
    fn scale(&self, size: f64) -> f64 {
        (self.side() - 2 * self.closing_radius() - 4) as f64 / size
    }
}

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

impl Descriptor {
    /// The magnitudes in a row, [`MAGNITUDES`] numbers, as stores and distances take them.
    pub fn magnitudes(&self) -> &[f32] {
        self.magnitude.as_flattened()
    }

    /// The complex coefficients in a row, [`PHASES`] numbers, as stores and distances take them.
    pub fn phases(&self) -> &[f32] {
        self.phase.as_flattened().as_flattened().as_flattened()
    }
}

/// Describes a model in a frame (the paper's section VI).
///
/// Errors: the work was cancelled, or a silhouette is empty.
pub fn descriptor(
    wireframe: &Wireframe,
    measures: &Measures,
    frame: &Frame,
    options: &Options,
    cancel: &Cancel,
) -> Result<Descriptor, ModelError> {
    let mut found =
        Descriptor { magnitude: [[0.0; HARMONICS]; 3], phase: [[[[0.0; 2]; HARMONICS]; 2]; 3], hull: [false; 3] };
    for (i, picture) in silhouettes(wireframe, measures, frame, options, cancel)?.iter().enumerate() {
        let view = describe(picture, options)
            .ok_or_else(|| ModelError::new(Stage::Descriptor, "a silhouette without a contour"))?;
        found.magnitude[i] = fourier::magnitudes(&view.phase[0]);
        found.phase[i] = view.phase;
        found.hull[i] = view.hull;
    }
    Ok(found)
}

/// The three silhouettes of a model in a frame; view i looks along axis i.
pub fn silhouettes(
    wireframe: &Wireframe,
    measures: &Measures,
    frame: &Frame,
    options: &Options,
    cancel: &Cancel,
) -> Result<[Silhouette; 3], ModelError> {
    let size = measures.tolerance.size();
    if !(size > 0.0 && size.is_finite()) {
        return Err(ModelError::new(Stage::Descriptor, "the model has no extent"));
    }
    let raster = Raster { centre: measures.centroid, scale: options.scale(size), side: options.side() };
    let [x, y, z] = frame.axes.map(|axis| raster.project(wireframe, &axis));
    let draw = |sides| raster.draw(wireframe, sides, cancel).map_err(|c| ModelError::cancelled(Stage::Descriptor, c));
    Ok([draw([&y, &z])?, draw([&z, &x])?, draw([&x, &y])?])
}

/// The coefficients of one view from both starting points.
struct ViewDescriptor {
    phase: [[[f32; 2]; HARMONICS]; 2],
    hull: bool,
}

fn describe(picture: &Silhouette, options: &Options) -> Option<ViewDescriptor> {
    let centroid = picture.centroid()?;
    let unbroken = unbroken_contour(picture, options);
    let hull = unbroken.is_none();
    let contour = unbroken.map_or_else(|| hull::hull(picture), |contour| Some(contour.smoothed()))?;
    let path = Path::new(&contour);
    let from = |start: Start| {
        let points = path.resampled(centroid, start, options.points());
        let signature = if hull {
            hull::signature(picture, &points, centroid)
        } else {
            fourier::centroid_distances(&points, centroid)
        };
        fourier::coefficients(&signature)
    };
    Some(ViewDescriptor { phase: [from(Start::Positive)?, from(Start::Negative)?], hull })
}

/// The outer contour that encloses nearly the whole silhouette, if need be after closing gaps.
fn unbroken_contour(picture: &Silhouette, options: &Options) -> Option<Contour> {
    // A lone outer contour encloses all.
    let encloses = |(contour, alone): &(Contour, bool)| {
        *alone || contour.enclosed(picture) as f64 >= options.enclosed * picture.area() as f64
    };
    Contour::largest(picture)
        .filter(encloses)
        .or_else(|| Contour::largest(&picture.closed(options.closing_radius())).filter(encloses))
        .map(|(contour, _)| contour)
}

#[cfg(test)]
mod tests;
