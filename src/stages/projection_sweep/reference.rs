//! The axis that the planes turn about, and where the turning starts.

use crate::alignment::principal_axes;
use crate::alignment::rectilinearity::rectilinearity;
use crate::brep::Mesh;
use crate::brep::measure::Measures;
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::{Matrix, Point, Vector, any_perpendicular};
use crate::silhouette::shadow;
use crate::stages::merge::{Label, Symmetries};
use crate::stages::parse::Parsed;

use super::{AreaBy, Options, SecondAxis, Source, towards, turn};

/// The first canonical axis.
pub(super) struct Reference {
    pub axis: Vector,
    /// The area centroid, on the symmetry plane if there is one.
    pub origin: Point,
    pub source: Source,
}

/// The normal of the dominant symmetry, else the axis of the fallback frame with the smallest shadow.
pub(super) fn find(
    parsed: &Parsed,
    symmetries: &Symmetries,
    options: &Options,
    cancel: &Cancel,
) -> Result<Reference, Cancelled> {
    let (centroid, covariance) = (parsed.measures.centroid, &symmetries.covariance);
    let dominant = symmetries.planes.first().filter(|p| p.coverage >= options.min_coverage);
    if let Some(found) = dominant.filter(|_| symmetries.label != Label::None) {
        let plane = &found.plane;
        return Ok(Reference { axis: plane.normal, origin: plane.project(&centroid), source: Source::Symmetry });
    }
    let rectilinear = rectilinearity(&parsed.mesh);
    let (axes, source) = if rectilinear.measure >= options.min_rectilinearity {
        (rectilinear.axes, Source::Rectilinearity)
    } else {
        (principal_axes(covariance), Source::Cpca)
    };
    let axis = match lone_axis(covariance, &axes).filter(|_| source == Source::Cpca) {
        Some(lone) => lone_or_across(parsed, covariance, &lone, options, cancel)?,
        None => axes[smallest_shadow(parsed, &axes, options, cancel)?],
    };
    Ok(Reference { axis, origin: centroid, source })
}

/// Of an axis and all directions across it the one with the smallest shadow.
fn lone_or_across(
    parsed: &Parsed,
    covariance: &Matrix,
    lone: &Vector,
    options: &Options,
    cancel: &Cancel,
) -> Result<Vector, Cancelled> {
    let table = Turntable::on_model(&parsed.mesh, &parsed.measures, covariance, lone);
    // By the same measure as the shadow along the axis, whatever turns the second axis.
    let options = &Options { area_by: AreaBy::Spans, second_axis: SecondAxis::Sweep, ..options.clone() };
    let across = turn(parsed, &table, options, cancel)?.choice;
    let along = shadow_along(parsed, &table.u, lone, options, cancel)?;
    Ok(if across.area < along { table.direction(across.angle) } else { *lone })
}

/// The principal axis along which the variance is another than along the two others, where it is the same along these,
/// as about the axis of a propeller: which axes across it are the principal ones is up to rounding.
fn lone_axis(covariance: &Matrix, axes: &[Vector; 3]) -> Option<Vector> {
    let [a, b, c] = axes.map(|axis| axis.dot(&(covariance * axis)));
    let equal = |p: f64, q: f64| (p - q).abs() <= ISOTROPIC * a.abs();
    match (equal(a, b), equal(b, c)) {
        (true, false) => Some(axes[2]),
        (false, true) => Some(axes[0]),
        _ => None,
    }
}

fn smallest_shadow(
    parsed: &Parsed,
    axes: &[Vector; 3],
    options: &Options,
    cancel: &Cancel,
) -> Result<usize, Cancelled> {
    let mut least = (0, f64::INFINITY);
    for i in 0..3 {
        let area = shadow_along(parsed, &axes[(i + 1) % 3], &axes[i], options, cancel)?;
        if area < least.1 {
            least = (i, area);
        }
    }
    Ok(least.0)
}

/// Area of the model's shadow seen along `view`, mm^2, by slices across `across` (at right angles to it).
pub(super) fn shadow_along(
    parsed: &Parsed,
    across: &Vector,
    view: &Vector,
    options: &Options,
    cancel: &Cancel,
) -> Result<f64, Cancelled> {
    let along = across.cross(view);
    shadow::area(&parsed.wireframe, [&along, across], &parsed.measures.centroid, options.slices, cancel)
}

/// An axis and two directions at right angles to it: angle 0 looks along `u`, a quarter turn along `v`.
#[derive(Clone, Debug)]
pub struct Turntable {
    pub axis: Vector,
    pub u: Vector,
    pub v: Vector,
    /// Where coordinates are taken from: near the model, for precision.
    pub centre: Point,
    /// Angle of the largest variance of the surface, radians.
    pub largest_variance: f64,
}

/// Variances in the plane that differ by less than this share of their sum are equal but for rounding.
const ISOTROPIC: f64 = 1e-6;

impl Turntable {
    /// Starts somewhere: the paper's arbitrary starting orientation.
    pub(super) fn arbitrary(measures: &Measures, axis: &Vector) -> Self {
        Self::about(measures, axis, &any_perpendicular(axis))
    }

    /// Starts at a direction at right angles to the axis.
    pub(super) fn about(measures: &Measures, axis: &Vector, start: &Vector) -> Self {
        Self { axis: *axis, u: *start, v: axis.cross(start), centre: measures.centroid, largest_variance: 0.0 }
    }

    /// Starts with `u` at the largest variance of the surface across the axis, so that it moves with the model.
    pub(super) fn on_model(mesh: &Mesh, measures: &Measures, covariance: &Matrix, axis: &Vector) -> Self {
        let any = Self::arbitrary(measures, axis);
        let u = towards(&any.u, &any.v, any.main_angle(mesh, covariance)).normalize();
        Self { u, v: axis.cross(&u), ..any }
    }

    /// The direction at an angle, a unit vector.
    pub(super) fn direction(&self, angle: f64) -> Vector {
        towards(&self.u, &self.v, angle)
    }

    /// Sets the angle of the largest variance as seen from the present start.
    pub(super) fn with_largest_variance(self, mesh: &Mesh, covariance: &Matrix) -> Self {
        Self { largest_variance: self.main_angle(mesh, covariance), ..self }
    }

    /// The angle of the largest variance of the surface; where it is the same all around, that of the point farthest
    /// from the axis.
    fn main_angle(&self, mesh: &Mesh, covariance: &Matrix) -> f64 {
        let (cu, cv) = (covariance * self.u, covariance * self.v);
        let (difference, mixed) = (self.u.dot(&cu) - self.v.dot(&cv), 2.0 * self.u.dot(&cv));
        if difference.hypot(mixed) > ISOTROPIC * (self.u.dot(&cu) + self.v.dot(&cv)) {
            return 0.5 * mixed.atan2(difference);
        }
        let flat = mesh.points.iter().map(|p| (self.u.dot(&(p - self.centre)), self.v.dot(&(p - self.centre))));
        let farthest = flat.max_by(|a, b| a.0.hypot(a.1).total_cmp(&b.0.hypot(b.1)));
        farthest.map_or(0.0, |(x, y)| y.atan2(x))
    }
}
