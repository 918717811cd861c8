//! Whether curves and surfaces can be evaluated: what the readers of plain numbers check when they have read them.

use crate::brep::nurbs::{MAX_DEGREE, NurbsCurve, NurbsSurface};
use crate::brep::{Curve, Placement, Surface};
use crate::geometry::{Point, Vector};

/// Why a curve or surface cannot be used.
pub(super) type Why = &'static str;

const NOT_FINITE: Why = "a number that is not finite";
const NOT_POSITIVE: Why = "a length that is not positive";

/// The largest coordinate of a point, mm.
const FARTHEST: f64 = 1e12;

/// The most evaluations of plain curves and surfaces that one of a nested one may take.
const MOST_EVALUATIONS: usize = 1000;

/// Checks all numbers of a curve, and that it is not nested so deep that its evaluation takes for ever.
///
/// # Errors
/// The reason, where it cannot be evaluated.
pub(super) fn curve(curve: &Curve) -> Result<(), Why> {
    nested(curve)?;
    match curve {
        Curve::Line { origin, direction } => {
            points(std::slice::from_ref(origin))?;
            direction_of(direction)
        }
        Curve::Circle { placement, radius } => placed(placement, &[*radius]),
        Curve::Ellipse { placement, semi_x, semi_y } | Curve::Hyperbola { placement, semi_x, semi_y } => {
            placed(placement, &[*semi_x, *semi_y])
        }
        Curve::Parabola { placement, focal } => placed(placement, &[*focal]),
        Curve::Nurbs(nurbs) => nurbs_curve(nurbs),
        Curve::Polyline(line) if line.len() < 2 => Err("a polyline of fewer than two points"),
        Curve::Polyline(line) => points(line),
        Curve::Trimmed { basis, range: [a, b], .. } => {
            self::curve(basis)?;
            finite(&[*a, *b])?;
            if a == b { Err("a trimmed curve without length") } else { Ok(()) }
        }
        Curve::Composite(pieces) if pieces.is_empty() => Err("a composite curve without pieces"),
        Curve::Composite(pieces) => pieces.iter().try_for_each(|(piece, _)| bounded(piece)),
        Curve::Offset { basis, distance, reference } => {
            self::curve(basis)?;
            finite(&[*distance])?;
            direction_of(reference)
        }
    }
}

/// Checks that a curve is not nested so deep that its evaluation takes for ever; asked for each level, since making a
/// curve of another one evaluates that one.
pub(super) fn nested(curve: &Curve) -> Result<(), Why> {
    if evaluations(curve) > MOST_EVALUATIONS { Err("curves nested too deep") } else { Ok(()) }
}

/// About how many evaluations of plain curves one of this curve takes: a trimmed one looks at several points for the
/// period of its basis, an offset one for its derivatives.
fn evaluations(curve: &Curve) -> usize {
    match curve {
        Curve::Trimmed { basis, .. } => evaluations(basis).saturating_mul(9),
        Curve::Offset { basis, .. } => evaluations(basis).saturating_mul(4),
        Curve::Composite(pieces) => pieces.iter().map(|(piece, _)| evaluations(piece)).max().unwrap_or(1),
        _ => 1,
    }
}

fn surface_evaluations(surface: &Surface) -> usize {
    match surface {
        Surface::Offset { basis, .. } => surface_evaluations(basis).saturating_mul(10),
        Surface::Rectangular { basis, .. } => surface_evaluations(basis),
        Surface::Revolution { profile, .. } | Surface::Extrusion { profile, .. } => evaluations(profile),
        _ => 1,
    }
}

fn bounded(piece: &Curve) -> Result<(), Why> {
    curve(piece)?;
    if piece.domain().iter().all(|t| t.is_finite()) { Ok(()) } else { Err("a piece of a composite curve without end") }
}

/// Checks all numbers of a surface, and that it is not nested so deep that its evaluation takes for ever.
///
/// # Errors
/// The reason, where it cannot be evaluated.
pub(super) fn surface(surface: &Surface) -> Result<(), Why> {
    if surface_evaluations(surface) > MOST_EVALUATIONS {
        return Err("surfaces nested too deep");
    }
    match surface {
        Surface::Plane(placement) => placed(placement, &[]),
        Surface::Cylinder { placement, radius } | Surface::Sphere { placement, radius } => {
            placed(placement, &[*radius])
        }
        Surface::Cone { placement, radius, half_angle } => {
            placed(placement, &[])?;
            finite(&[*radius, *half_angle])?;
            let bent = (1e-9..std::f64::consts::FRAC_PI_2 - 1e-9).contains(&half_angle.abs());
            if bent && *radius >= 0.0 { Ok(()) } else { Err("a cone with an impossible angle or radius") }
        }
        Surface::Torus { placement, major, minor } => {
            finite(&[*major])?;
            placed(placement, &[*minor])
        }
        Surface::Nurbs(nurbs) => nurbs_surface(nurbs),
        Surface::Revolution { profile, axis } => {
            curve(profile)?;
            placed(axis, &[])
        }
        Surface::Extrusion { profile, direction } => {
            curve(profile)?;
            direction_of(direction)
        }
        Surface::Offset { basis, distance } => {
            self::surface(basis)?;
            finite(&[*distance])
        }
        Surface::Rectangular { basis, bounds: [u0, u1, v0, v1] } => {
            self::surface(basis)?;
            finite(&[*u0, *u1, *v0, *v1])?;
            if u0 < u1 && v0 < v1 { Ok(()) } else { Err("a trimmed surface without area") }
        }
    }
}

fn finite(values: &[f64]) -> Result<(), Why> {
    if values.iter().all(|v| v.is_finite()) { Ok(()) } else { Err(NOT_FINITE) }
}

fn points(points: &[Point]) -> Result<(), Why> {
    points.iter().try_for_each(in_reach)
}

/// Checks that a point is finite and not so far out that it is no part of a model but would set its size.
pub(super) fn in_reach(point: &Point) -> Result<(), Why> {
    finite(point.coords.as_slice())?;
    if point.iter().all(|c| c.abs() <= FARTHEST) { Ok(()) } else { Err("a point further out than 1e12 mm") }
}

fn direction_of(direction: &Vector) -> Result<(), Why> {
    finite(direction.as_slice())?;
    if direction.norm_squared() > 0.0 { Ok(()) } else { Err("a direction of no length") }
}

/// A placement with finite axes and lengths above 0.
fn placed(placement: &Placement, lengths: &[f64]) -> Result<(), Why> {
    points(&[placement.origin])?;
    // Axes are normalised when they are read: those that have no length are not finite then.
    let axes = [placement.x, placement.y, placement.z];
    if !axes.iter().flat_map(|a| a.iter()).all(|c| c.is_finite()) {
        return Err("axes that are no frame");
    }
    finite(lengths)?;
    if lengths.iter().all(|l| *l > 0.0) { Ok(()) } else { Err(NOT_POSITIVE) }
}

fn nurbs_curve(nurbs: &NurbsCurve) -> Result<(), Why> {
    points(&nurbs.points)?;
    weights(&nurbs.weights, nurbs.points.len())?;
    knots(&nurbs.knots, nurbs.degree, nurbs.points.len())
}

fn nurbs_surface(nurbs: &NurbsSurface) -> Result<(), Why> {
    points(&nurbs.points)?;
    weights(&nurbs.weights, nurbs.points.len())?;
    if nurbs.columns == 0 || !nurbs.points.len().is_multiple_of(nurbs.columns) {
        return Err("rows of control points of unequal length");
    }
    knots(&nurbs.knots_u, nurbs.degree_u, nurbs.rows())?;
    knots(&nurbs.knots_v, nurbs.degree_v, nurbs.columns)
}

fn weights(weights: &[f64], count: usize) -> Result<(), Why> {
    finite(weights)?;
    if !weights.is_empty() && weights.len() != count {
        return Err("not as many weights as control points");
    }
    if weights.iter().all(|w| *w > 0.0) { Ok(()) } else { Err("a weight that is not positive") }
}

/// Knots written out that fit `count` control points.
fn knots(knots: &[f64], degree: usize, count: usize) -> Result<(), Why> {
    finite(knots)?;
    if degree == 0 || degree > MAX_DEGREE {
        return Err("a B-spline of an impossible degree");
    }
    if count <= degree || knots.len() != count + degree + 1 {
        return Err("knots that do not fit the control points");
    }
    if !knots.is_sorted() || knots[degree] >= knots[count] {
        return Err("knots that do not grow");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spline(degree: usize, knots: &[f64], count: usize) -> Curve {
        let points = (0..count).map(|i| Point::new(i as f64, 0.0, 0.0)).collect();
        Curve::Nurbs(NurbsCurve { degree, knots: knots.to_vec(), points, weights: vec![], closed: false })
    }

    #[test]
    fn splines_that_cannot_be_evaluated_are_refused() {
        assert_eq!(curve(&spline(1, &[0.0, 0.0, 1.0, 1.0], 2)), Ok(()));
        assert_eq!(curve(&spline(1, &[0.0, 0.0, 1.0], 2)), Err("knots that do not fit the control points"));
        assert_eq!(curve(&spline(1, &[0.0, 1.0, 1.0, 2.0], 2)), Err("knots that do not grow"));
        assert_eq!(curve(&spline(1, &[0.0, 0.0, f64::NAN, 1.0], 2)), Err(NOT_FINITE));
        assert_eq!(curve(&spline(0, &[0.0, 1.0, 1.0], 2)), Err("a B-spline of an impossible degree"));
    }

    #[test]
    fn axes_and_lengths_are_checked() {
        let frame = Placement { origin: Point::origin(), x: Vector::x(), y: Vector::y(), z: Vector::z() };
        assert_eq!(curve(&Curve::Circle { placement: frame, radius: 0.0 }), Err(NOT_POSITIVE));
        let bent = Placement { x: Vector::zeros() / 0.0, ..frame };
        assert_eq!(surface(&Surface::Plane(bent)), Err("axes that are no frame"));
    }
}
