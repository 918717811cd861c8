//! Ruled surfaces as splines.

use super::curves::Piece;
use crate::brep::Curve;
use crate::brep::nurbs::{NurbsCurve, NurbsSurface};
use crate::geometry::Point;
use crate::stages::parse::on_surface::{Knot, hermite};
use crate::stages::parse::sound::Why;

/// Pieces between breaks of either curve where their splines do not fit each other, and how many there may be.
const PIECES: usize = 24;
const MOST_PIECES: usize = 4096;

/// The surface of the lines between points of equal parameter of two curves over [0, 1] x [0, 1]; `against`: the
/// start of the first is joined to the end of the second.
pub(super) fn between(first: &Piece, second: &Piece, against: bool) -> Result<NurbsSurface, Why> {
    if let (Curve::Line { .. }, Curve::Line { .. }) = (&first.curve, &second.curve) {
        let ([a, b], [c, d]) = (first.ends(), second.ends());
        let (c, d) = if against { (d, c) } else { (c, d) };
        return Ok(joined(linear(a, b), linear(c, d)));
    }
    if let (Some(one), Some(other), false) = (unit_spline(first), unit_spline(second), against)
        && one.degree == other.degree
        && one.knots.len() == other.knots.len()
        && one.knots.iter().zip(&other.knots).all(|(a, b)| (a - b).abs() <= 1e-9)
    {
        return Ok(joined(one, other));
    }
    let mut stops: Vec<f64> = shares(first, false).into_iter().chain(shares(second, against)).collect();
    stops.sort_by(f64::total_cmp);
    stops.dedup_by(|a, b| *a - *b <= 1e-9);
    if stops.len() * PIECES > MOST_PIECES {
        return Err("a curve with too many pieces");
    }
    Ok(joined(followed(first, false, &stops), followed(second, against, &stops)))
}

fn linear(a: Point, b: Point) -> NurbsCurve {
    NurbsCurve { degree: 1, knots: vec![0.0, 0.0, 1.0, 1.0], points: vec![a, b], weights: Vec::new(), closed: false }
}

/// A spline used over all of its domain, with knots from 0 to 1.
fn unit_spline(piece: &Piece) -> Option<NurbsCurve> {
    let Curve::Nurbs(nurbs) = &piece.curve else { return None };
    let [a, b] = nurbs.domain();
    let knots = nurbs.knots.iter().map(|k| (k - a) / (b - a)).collect();
    (piece.range == [a, b]).then(|| NurbsCurve { knots, ..nurbs.clone() })
}

/// The breaks of a piece as shares of its range.
fn shares(piece: &Piece, against: bool) -> Vec<f64> {
    let [a, b] = piece.range;
    let inside = piece.curve.breaks().into_iter().filter(|t| *t > a && *t < b).map(|t| (t - a) / (b - a));
    inside.chain([0.0, 1.0]).map(|s| if against { 1.0 - s } else { s }).collect()
}

/// The piece as a cubic spline over [0, 1] with the same knots for the same stops.
fn followed(piece: &Piece, against: bool, stops: &[f64]) -> NurbsCurve {
    let [a, b] = piece.range;
    let (from, width) = if against { (b, a - b) } else { (a, b - a) };
    let period = piece.curve.period();
    let at = |s: f64| {
        let [point, d, _] = piece.curve.derivatives(piece.curve.wrap(from + s * width, period));
        Knot { t: s, point, derivative: d * width }
    };
    let inner =
        stops.windows(2).flat_map(|w| (0..PIECES).map(move |i| w[0] + (w[1] - w[0]) * i as f64 / PIECES as f64));
    let knots: Vec<Knot> = inner.chain([1.0]).map(at).collect();
    hermite(&knots)
}

/// Two curves with the same knots as the sides v = 0 and v = 1.
fn joined(one: NurbsCurve, other: NurbsCurve) -> NurbsSurface {
    let weighted = !(one.weights.is_empty() && other.weights.is_empty());
    let weight = |of: &NurbsCurve, i: usize| of.weights.get(i).copied().unwrap_or(1.0);
    let count = one.points.len();
    NurbsSurface {
        degree_u: one.degree,
        degree_v: 1,
        columns: 2,
        points: (0..count).flat_map(|i| [one.points[i], other.points[i]]).collect(),
        weights: (0..if weighted { count } else { 0 }).flat_map(|i| [weight(&one, i), weight(&other, i)]).collect(),
        knots_u: one.knots,
        knots_v: vec![0.0, 0.0, 1.0, 1.0],
    }
}

#[cfg(test)]
mod tests {
    use super::super::curves::level;
    use super::*;
    use crate::geometry::Vector;

    #[test]
    fn a_line_and_an_arc_are_joined_at_equal_shares() {
        let line = Curve::Line { origin: Point::new(0.0, 0.0, 5.0), direction: Vector::x() };
        let line = Piece { entity: 1, curve: line, range: [0.0, 1.0] };
        let arc = Curve::Circle { placement: level(0.0, 0.0, 0.0), radius: 2.0 };
        let arc = Piece { entity: 3, curve: arc, range: [0.0, 1.0] };
        let surface = between(&line, &arc, true).unwrap();
        let there = surface.jet(0.25, 0.5).point;
        let middle = Point::new(0.5 * (0.25 + 2.0 * 0.75_f64.cos()), 0.75_f64.sin(), 2.5);
        assert!((there - middle).norm() < 1e-6, "{there}");
    }
}
