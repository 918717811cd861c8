//! Surfaces in space.

use super::nurbs::NurbsSurface;
use super::{Curve, Placement};
use crate::geometry::Vector;

/// A parametric surface, as STEP (ISO 10303-42) parametrises it; angles in radians, lengths in mm.
#[derive(Clone, Debug)]
pub enum Surface {
    /// origin + u x + v y.
    Plane(Placement),
    /// origin + radius (cos u x + sin u y) + v z.
    Cylinder {
        placement: Placement,
        radius: f64,
    },
    /// origin + (radius + v tan half_angle)(cos u x + sin u y) + v z; a zero radius puts the apex at the origin.
    Cone {
        placement: Placement,
        radius: f64,
        half_angle: f64,
    },
    /// origin + radius cos v (cos u x + sin u y) + radius sin v z.
    Sphere {
        placement: Placement,
        radius: f64,
    },
    /// origin + (major + minor cos v)(cos u x + sin u y) + minor sin v z.
    Torus {
        placement: Placement,
        major: f64,
        minor: f64,
    },
    Nurbs(NurbsSurface),
    /// `profile` turned by u about the axis (placement z through its origin); v is the profile's parameter.
    Revolution {
        profile: Box<Curve>,
        axis: Placement,
    },
    /// profile(u) + v direction.
    Extrusion {
        profile: Box<Curve>,
        direction: Vector,
    },
    /// `basis` moved by `distance` along its unit normal.
    Offset {
        basis: Box<Surface>,
        distance: f64,
    },
    /// A rectangle of `basis` (RECTANGULAR_TRIMMED_SURFACE): bounds [u0, u1, v0, v1].
    Rectangular {
        basis: Box<Surface>,
        bounds: [f64; 4],
    },
}
