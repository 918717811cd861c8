//! Curves in space.

use super::Placement;
use super::nurbs::NurbsCurve;
use crate::geometry::{Point, Vector};

/// A parametric curve, as STEP (ISO 10303-42) parametrises it; angles in radians, lengths in mm.
#[derive(Clone, Debug)]
pub enum Curve {
    /// origin + t * direction; the direction carries the length of the STEP vector.
    Line {
        origin: Point,
        direction: Vector,
    },
    Circle {
        placement: Placement,
        radius: f64,
    },
    Ellipse {
        placement: Placement,
        semi_x: f64,
        semi_y: f64,
    },
    /// origin + x * focal * t^2 + y * 2 * focal * t.
    Parabola {
        placement: Placement,
        focal: f64,
    },
    /// origin + x * semi_x * cosh t + y * semi_y * sinh t.
    Hyperbola {
        placement: Placement,
        semi_x: f64,
        semi_y: f64,
    },
    Nurbs(NurbsCurve),
    Polyline(Vec<Point>),
    /// The piece of `basis` between two of its parameters; `forward`: from the first to the second along the basis.
    Trimmed {
        basis: Box<Curve>,
        range: [f64; 2],
        forward: bool,
    },
    /// Pieces one after the other, each with its sense.
    Composite(Vec<(Curve, bool)>),
    /// `basis` moved by `distance` along `reference` x tangent.
    Offset {
        basis: Box<Curve>,
        distance: f64,
        reference: Vector,
    },
}
