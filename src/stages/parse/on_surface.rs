//! Curves given in the parameter space of a surface -> curves in space.

use super::sound::Why;
use crate::brep::nurbs::NurbsCurve;
use crate::brep::{Curve, Surface};
use crate::geometry::{Point, Vector};

/// Pieces between two breaks of the given curve at first, and at most how often each is halved.
const FIRST_PIECES: usize = 4;
const MAX_HALVINGS: u32 = 6;
/// The middle of a piece may be this far from the true curve, as a share of the length of the piece.
const NEAR: f64 = 1e-6;
/// The most pieces of one curve.
const MAX_PIECES: usize = 4096;

/// A point of a curve in space with its derivative by the parameter.
#[derive(Clone, Copy)]
pub(super) struct Knot {
    pub t: f64,
    pub point: Vector,
    pub derivative: Vector,
}

/// From the parameters in which a file's curves are given to those of a surface of ours.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chart {
    pub scale: [f64; 2],
    pub offset: [f64; 2],
    /// The file's first parameter is our second, before scale and offset.
    pub swapped: bool,
}

impl Default for Chart {
    fn default() -> Self {
        Self { scale: [1.0, 1.0], offset: [0.0, 0.0], swapped: false }
    }
}

impl Chart {
    /// Whether S_u x S_v by the file's parameters is against ours.
    pub fn turns(&self) -> bool {
        (self.scale[0] * self.scale[1] < 0.0) != self.swapped
    }

    fn turned(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let [u, v] = if self.swapped { [v, u] } else { [u, v] };
        [u * self.scale[0], v * self.scale[1]]
    }
}

/// The image of the piece of `flat` (a curve in the plane z = 0: u and v) between two parameters, as a cubic spline
/// through points of the surface with its true tangents there.
///
/// # Errors
/// Where the range is empty or the image is not finite.
pub(super) fn traced(surface: &Surface, chart: &Chart, flat: &Curve, range: [f64; 2]) -> Result<NurbsCurve, Why> {
    let [a, b] = range;
    if !(a.is_finite() && b.is_finite() && a < b) {
        return Err("a range that is empty");
    }
    let period = flat.period();
    let at = |t: f64| {
        let [uv, d, _] = flat.derivatives(flat.wrap(t, period));
        let ([u, v], [du, dv]) = (chart.turned([uv.x, uv.y]), chart.turned([d.x, d.y]));
        let jet = surface.jet(u + chart.offset[0], v + chart.offset[1]);
        let derivative = jet.du * du + jet.dv * dv;
        Knot { t, point: jet.point.coords, derivative }
    };
    let inner = flat.breaks().into_iter().filter(|t| *t > a && *t < b);
    let mut stops: Vec<f64> = inner.chain([a, b]).collect();
    stops.sort_by(f64::total_cmp);
    stops.dedup();
    let mut knots = vec![at(a)];
    for pair in stops.windows(2) {
        for i in 0..FIRST_PIECES {
            let end = at(pair[0] + (pair[1] - pair[0]) * (i + 1) as f64 / FIRST_PIECES as f64);
            let last = knots[knots.len() - 1];
            halve(&at, last, end, MAX_HALVINGS, &mut knots);
        }
        if knots.len() > MAX_PIECES {
            return Err("a curve with too many pieces");
        }
    }
    let spline = hermite(&knots);
    if spline.points.iter().all(|p| p.iter().all(|c| c.is_finite())) {
        Ok(spline)
    } else {
        Err("its image is not finite")
    }
}

/// Adds the end of a piece, after what is needed before it.
fn halve(at: &impl Fn(f64) -> Knot, start: Knot, end: Knot, depth: u32, out: &mut Vec<Knot>) {
    let middle = at(0.5 * (start.t + end.t));
    let width = end.t - start.t;
    let guess = (start.point + end.point) * 0.5 + (start.derivative - end.derivative) * (width / 8.0);
    let length = (end.point - middle.point).norm() + (middle.point - start.point).norm();
    if depth > 0 && (guess - middle.point).norm() > NEAR * length {
        halve(at, start, middle, depth - 1, out);
        halve(at, middle, end, depth - 1, out);
    } else {
        out.push(end);
    }
}

/// The cubic spline with double inner knots that has these points and derivatives; two of them at least.
pub(super) fn hermite(knots: &[Knot]) -> NurbsCurve {
    let mut points = vec![knots[0].point];
    for pair in knots.windows(2) {
        let third = (pair[1].t - pair[0].t) / 3.0;
        points.push(pair[0].point + pair[0].derivative * third);
        points.push(pair[1].point - pair[1].derivative * third);
    }
    let (first, last) = (knots[0], knots[knots.len() - 1]);
    points.push(last.point);
    let inner = knots[1..knots.len() - 1].iter().flat_map(|k| [k.t; 2]);
    let all = [first.t; 4].into_iter().chain(inner).chain([last.t; 4]).collect();
    NurbsCurve {
        degree: 3,
        knots: all,
        points: points.into_iter().map(Point::from).collect(),
        weights: Vec::new(),
        closed: (first.point - last.point).norm() == 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::Placement;

    #[test]
    fn a_line_round_a_cylinder_is_a_helix() {
        let placement = Placement { origin: Point::origin(), x: Vector::x(), y: Vector::y(), z: Vector::z() };
        let cylinder = Surface::Cylinder { placement, radius: 2.0 };
        let flat = Curve::Line { origin: Point::origin(), direction: Vector::new(1.0, 3.0, 0.0) };
        let spline = traced(&cylinder, &Chart { scale: [1.0, 0.5], ..Chart::default() }, &flat, [0.0, 4.0]).unwrap();
        let helix = Curve::Nurbs(spline);
        for i in 0..=40 {
            let t = 0.1 * f64::from(i);
            let there = Vector::new(2.0 * t.cos(), 2.0 * t.sin(), 1.5 * t);
            assert!((helix.point(t).coords - there).norm() < 1e-5);
        }
        assert_eq!(helix.domain(), [0.0, 4.0]);
    }

    #[test]
    fn an_empty_range_is_refused() {
        let placement = Placement { origin: Point::origin(), x: Vector::x(), y: Vector::y(), z: Vector::z() };
        let flat = Curve::Line { origin: Point::origin(), direction: Vector::x() };
        assert!(traced(&Surface::Plane(placement), &Chart::default(), &flat, [1.0, 1.0]).is_err());
        assert!(traced(&Surface::Plane(placement), &Chart::default(), &flat, [0.0, f64::NAN]).is_err());
    }
}
