//! CONIC ARC (104): A x^2 + B x y + C y^2 + D x + E y + F = 0 in a plane z = constant.

use std::f64::consts::TAU;

use super::curves::level;
use super::file::Record;
use crate::brep::{Curve, Placement};
use crate::geometry::{Point, Vector};
use crate::stages::parse::fault::Read;

/// A discriminant smaller than this, as a share of its terms, is that of a parabola.
const FLAT: f64 = 1e-9;

/// The coefficients, and the level, start and end of the arc in units of the file.
struct Conic {
    a: f64,
    b: f64,
    c: f64,
    d: f64,
    e: f64,
    f: f64,
}

/// The arc in the direction from its start to its end; ellipses run counter-clockwise.
pub(super) fn conic_arc(record: &Record, unit: f64) -> Read<(Curve, [f64; 2])> {
    let mut fields = record.fields();
    let [a, b, c, d, e, f] = fields.reals()?;
    let [z, x1, y1, x2, y2] = fields.reals()?;
    let conic = Conic { a, b, c, d, e, f };
    let ends = [Point::new(x1, y1, z) * unit, Point::new(x2, y2, z) * unit];
    let discriminant = 4.0 * a * c - b * b;
    let parabolic = discriminant.abs() <= FLAT * (4.0 * (a * c).abs() + b * b);
    let found = if parabolic { conic.parabola(z, unit) } else { conic.central(z, unit) };
    let curve = found.ok_or_else(|| record.fault("a conic that is none"))?;
    Ok(match curve {
        Curve::Ellipse { .. } => {
            let [from, to] = ends.map(|p| angle(&curve, &p));
            let span = (to - from).rem_euclid(TAU);
            (curve, [from, from + if span < 1e-9 { TAU } else { span }])
        }
        _ => forwards(curve, &ends),
    })
}

/// The eccentric angle of a point on an ellipse.
fn angle(ellipse: &Curve, p: &Point) -> f64 {
    let Curve::Ellipse { placement, semi_x, semi_y } = ellipse else { return 0.0 };
    let q = placement.local(p);
    (q.y / semi_y).atan2(q.x / semi_x)
}

/// An open conic between its ends; turned about its axis where it would run from the end to the start.
fn forwards(mut curve: Curve, ends: &[Point; 2]) -> (Curve, [f64; 2]) {
    let [from, to] = ends.map(|p| open_parameter(&curve, &p));
    if from <= to {
        return (curve, [from, to]);
    }
    if let Curve::Parabola { placement, .. } | Curve::Hyperbola { placement, .. } = &mut curve {
        *placement = Placement { y: -placement.y, z: -placement.z, ..*placement };
    }
    (curve, [-from, -to])
}

fn open_parameter(curve: &Curve, p: &Point) -> f64 {
    match curve {
        Curve::Parabola { placement, focal } => placement.local(p).y / (2.0 * focal),
        Curve::Hyperbola { placement, semi_y, .. } => (placement.local(p).y / semi_y).asinh(),
        _ => 0.0,
    }
}

impl Conic {
    /// An ellipse or one branch of a hyperbola: the equation about its centre, along its axes.
    fn central(&self, z: f64, unit: f64) -> Option<Curve> {
        let Self { a, b, c, d, e, f } = *self;
        let discriminant = 4.0 * a * c - b * b;
        let (cx, cy) = ((b * e - 2.0 * c * d) / discriminant, (b * d - 2.0 * a * e) / discriminant);
        let rest = f + 0.5 * (d * cx + e * cy);
        let turn = 0.5 * b.atan2(a - c);
        let (s, k) = turn.sin_cos();
        let along = a * k * k + b * k * s + c * s * s;
        let across = a * s * s - b * k * s + c * k * k;
        // along x^2 + across y^2 = -rest
        let (p, q) = (-rest / along, -rest / across);
        let frame = |quarter: bool| {
            let x = if quarter { Vector::new(-s, k, 0.0) } else { Vector::new(k, s, 0.0) };
            let centre = level(cx * unit, cy * unit, z * unit);
            Placement { x, y: Vector::z().cross(&x), ..centre }
        };
        let size = |square: f64| square.abs().sqrt() * unit;
        match (p > 0.0, q > 0.0) {
            (true, true) => Some(Curve::Ellipse { placement: frame(false), semi_x: size(p), semi_y: size(q) }),
            (true, false) => Some(Curve::Hyperbola { placement: frame(false), semi_x: size(p), semi_y: size(q) }),
            (false, true) => Some(Curve::Hyperbola { placement: frame(true), semi_x: size(q), semi_y: size(p) }),
            (false, false) => None,
        }
    }

    /// The axis of a parabola is the direction in which the equation has no square.
    fn parabola(&self, z: f64, unit: f64) -> Option<Curve> {
        let Self { a, b, c, d, e, f } = *self;
        let square = a + c;
        // The direction across the axis: (a, b; b, c) has only this one.
        let across = if a.abs() >= c.abs() { Vector::new(a, 0.5 * b, 0.0) } else { Vector::new(0.5 * b, c, 0.0) };
        let across = across.try_normalize(f64::MIN_POSITIVE)?;
        let axis = across.cross(&Vector::z());
        let linear = Vector::new(d, e, 0.0);
        let (p, q) = (linear.dot(&axis), linear.dot(&across));
        // square w^2 + q w + p t + f = 0, with t along the axis and w across.
        let w = -q / (2.0 * square);
        let t = -(f + 0.5 * q * w) / p;
        let opening = -p / square;
        let x = axis * opening.signum();
        let vertex = axis * t + across * w;
        let centre = level(vertex.x * unit, vertex.y * unit, z * unit);
        let placement = Placement { x, y: Vector::z().cross(&x), ..centre };
        Some(Curve::Parabola { placement, focal: 0.25 * opening.abs() * unit })
    }
}
