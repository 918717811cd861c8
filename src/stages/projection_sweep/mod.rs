//! Stage 7: dominant symmetry -> canonical frame.
//!
//! In: the model's mesh and its symmetries. Out: a [`CanonicalFrame`]: the normal of the symmetry plane, the normal
//! of the plane of smallest projected area among those that contain it, and their cross product.
//! Method: the paper's section V. The default measures the projected areas by exact spans (`slices`), turns through
//! all 180 planes from a direction that moves with the model, and refines the best angles by golden section; the
//! paper's profile turns 90 planes from an arbitrary direction and counts pixels (`pixels`).
//! Without a symmetry the first axis comes from a fallback frame: the rectilinear one (Lian et al. 2010) where the
//! model is rectilinear, else continuous PCA (Vranic 2001); of its three axes the one with the smallest shadow, the
//! same preference by which stage 6 ranks equal symmetries. Where the principal axes across another one are open, all
//! directions there are tried.
//! Cost: one cut of the mesh serves all angles, a few milliseconds for ten thousand triangles.
//! It does not promise a meaningful second axis for axisymmetric shadows: those are flagged and get a convention.

mod cover;
mod curve;
mod cutter;
mod pixels;
mod reference;
mod slabs;
mod slices;
mod widths;
mod wire;

use crate::alignment::npca;
use crate::cancel::Cancel;
use crate::geometry::{Frame, Vector};
use crate::stages::merge::Symmetries;
use crate::stages::parse::Parsed;
use crate::stages::{ModelError, Stage};

pub use curve::Shadows;
pub use pixels::PixelShadows;
use reference::{Turntable, shadow_along};
pub use slices::Slices;

/// How the projected area is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AreaBy {
    /// Union of intervals in slices across the reference axis.
    Spans,
    /// Pixels covered, as the paper counts.
    Pixels,
}

/// What turns the second axis about the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SecondAxis {
    /// The direction of the smallest projected area.
    Sweep,
    /// The direction of the largest variance of the surface in the first plane.
    Pca,
    /// Of the direction of the smallest projected area and the one at right angles to it the one that more of the
    /// surface faces.
    Normals,
}

/// Settings of the sweep.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Planes tried. Planes that contain an axis repeat after 180 degrees: 180 steps of 1 degree see all of them,
    /// the paper's 90 only half.
    pub planes: u32,
    /// Degrees between two planes.
    pub step_deg: f64,
    /// How the projected area is measured.
    pub area_by: AreaBy,
    /// Slices along the reference axis for spans. 256 keeps the area within 0.5 % and finds the angle to 0.01 degrees.
    pub slices: u32,
    /// Side of the picture in which pixels are counted.
    pub pixels: u32,
    /// Whether the best angles are refined between the steps.
    pub refine: bool,
    /// Whether the first plane tried is fixed to the model (largest variance) or arbitrary (the paper).
    pub start_on_model: bool,
    /// Sweep whose areas differ by less than this share of the largest: no angle is preferred (1 % is below what
    /// tessellation does to a body of revolution).
    pub axisymmetric_contrast: f64,
    /// Minima that differ by less than this share count as equal; then the larger third plane decides. Well above
    /// rounding and well below differences that a person would see.
    pub equal_minima: f64,
    /// Coverage from which a symmetry gives the first axis.
    pub min_coverage: f64,
    /// Rectilinearity from which the fallback frame is the rectilinear one.
    pub min_rectilinearity: f64,
    /// What turns the second axis about the first.
    pub second_axis: SecondAxis,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            planes: 180,
            step_deg: 1.0,
            area_by: AreaBy::Spans,
            slices: 256,
            pixels: 256,
            refine: true,
            start_on_model: true,
            axisymmetric_contrast: 0.01,
            equal_minima: 1e-3,
            min_coverage: 0.1,
            min_rectilinearity: 0.5,
            second_axis: SecondAxis::Sweep,
        }
    }
}

impl Options {
    /// The literal section V: 90 planes at 1 degree from an arbitrary start, areas by counting pixels.
    pub fn paper() -> Self {
        Self {
            planes: 90,
            area_by: AreaBy::Pixels,
            refine: false,
            start_on_model: false,
            axisymmetric_contrast: 0.0,
            equal_minima: 0.0,
            ..Self::default()
        }
    }

    /// The angles of the planes tried, radians, ascending.
    fn angles(&self) -> Vec<f64> {
        (0..self.planes.clamp(1, 36_000)).map(|k| (f64::from(k) * self.step_deg).to_radians()).collect()
    }
}

/// Which method gave the first axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Source {
    /// The dominant symmetry plane.
    Symmetry,
    /// The rectilinear frame, for want of a symmetry.
    Rectilinearity,
    /// Continuous principal components, for want of both.
    Cpca,
}

impl Source {
    /// The name in JSON and text.
    pub fn name(self) -> &'static str {
        match self {
            Self::Symmetry => "symmetry",
            Self::Rectilinearity => "rectilinearity",
            Self::Cpca => "cpca",
        }
    }
}

/// The projected area of the model on the planes that contain the reference axis.
#[derive(Clone, Debug, Default)]
pub struct Sweep {
    /// Angles of the plane normals about the reference axis, radians.
    pub angles: Vec<f64>,
    /// Areas of the shadows, mm^2.
    pub areas: Vec<f64>,
    /// The angle chosen, radians, within half a turn of the first.
    pub chosen: f64,
}

/// The canonical pose of a model.
#[derive(Clone, Debug)]
pub struct CanonicalFrame {
    /// The frame.
    pub frame: Frame,
    /// What gave its first axis.
    pub source: Source,
    /// Projected areas along the three axes, mm^2.
    pub areas: [f64; 3],
    /// The projected areas that chose the second axis.
    pub sweep: Sweep,
    /// The areas hardly differ with the angle: the second axis is a convention.
    pub axisymmetric: bool,
}

/// Finds the canonical frame of a model (the paper's section V).
///
/// Errors: the work was cancelled, or the mesh has no extent.
pub fn projection_sweep(
    parsed: &Parsed,
    symmetries: &Symmetries,
    options: &Options,
    cancel: &Cancel,
) -> Result<CanonicalFrame, ModelError> {
    let size = parsed.measures.tolerance.size();
    if !(size > 0.0 && size.is_finite()) || parsed.mesh.triangles.is_empty() {
        return Err(ModelError::new(Stage::ProjectionSweep, "the model has no extent"));
    }
    let cancelled = |c| ModelError::cancelled(Stage::ProjectionSweep, c);
    let covariance = &symmetries.covariance;
    let reference = reference::find(parsed, symmetries, options, cancel).map_err(cancelled)?;
    let table = if options.start_on_model {
        Turntable::on_model(&parsed.mesh, &parsed.measures, covariance, &reference.axis)
    } else {
        Turntable::arbitrary(&parsed.measures, &reference.axis).with_largest_variance(&parsed.mesh, covariance)
    };
    let swept = turn(parsed, &table, options, cancel).map_err(cancelled)?;
    let second = table.direction(swept.choice.angle);
    let first_area = shadow_along(parsed, &second, &reference.axis, options, cancel).map_err(cancelled)?;
    Ok(CanonicalFrame {
        frame: Frame::from_two(reference.origin, &reference.axis, &second),
        source: reference.source,
        areas: [first_area, swept.choice.area, swept.choice.third_area],
        sweep: swept.sweep,
        axisymmetric: swept.axisymmetric,
    })
}

/// The second axis as found by turning the plane.
struct Swept {
    choice: curve::Choice,
    sweep: Sweep,
    axisymmetric: bool,
}

fn turn(
    parsed: &Parsed,
    table: &Turntable,
    options: &Options,
    cancel: &Cancel,
) -> Result<Swept, crate::cancel::Cancelled> {
    let shadows: &mut dyn Shadows = match options.area_by {
        AreaBy::Spans => &mut Slices::cut(&parsed.wireframe, table, options.slices, cancel)?,
        AreaBy::Pixels => &mut PixelShadows::new(&parsed.mesh, &parsed.measures, table, options.pixels),
    };
    let angles = options.angles();
    let areas = shadows.areas(&angles, cancel)?;
    let mut sweep = Sweep { angles, areas, chosen: 0.0 };
    let axisymmetric = curve::contrast(&sweep.areas) < options.axisymmetric_contrast;
    let choice = if axisymmetric || options.second_axis == SecondAxis::Pca {
        curve::at(shadows, table.largest_variance, cancel)?
    } else {
        curve::smallest(shadows, &sweep, options, cancel)?
    };
    let choice = match options.second_axis {
        SecondAxis::Normals => facing(parsed, table, choice),
        _ => choice,
    };
    sweep.chosen = choice.angle.rem_euclid(std::f64::consts::PI);
    Ok(Swept { choice, sweep, axisymmetric })
}

/// The choice, turned a quarter where more of the surface faces that way.
fn facing(parsed: &Parsed, table: &Turntable, choice: curve::Choice) -> curve::Choice {
    let normals = npca::covariance(&parsed.mesh);
    let faced = |angle: f64| table.direction(angle).dot(&(normals * table.direction(angle)));
    let turned = choice.angle + std::f64::consts::FRAC_PI_2;
    if faced(turned) > faced(choice.angle) {
        curve::Choice { angle: turned, area: choice.third_area, third_area: choice.area }
    } else {
        choice
    }
}

/// The unit direction at `angle` from `u` towards `v`.
fn towards(u: &Vector, v: &Vector, angle: f64) -> Vector {
    u * angle.cos() + v * angle.sin()
}

#[cfg(test)]
mod tests;
