//! Edges that are pieces of their curves.

use crate::brep::Curve;

/// Parameters this near, as a share of their range, are the same.
const SAME: f64 = 1e-9;

/// Whether the vertices of an edge already say which piece of its curve it is, from `a` to `b` along it; `closed`: it
/// starts and ends at one vertex. Elsewhere the curve must be cut for the edge.
pub(super) fn needs_none(curve: &Curve, [a, b]: [f64; 2], closed: bool) -> bool {
    let [from, to] = curve.domain();
    match curve {
        Curve::Line { .. } | Curve::Parabola { .. } | Curve::Hyperbola { .. } => !closed,
        Curve::Circle { .. } | Curve::Ellipse { .. } => closed == (b - a >= (1.0 - SAME) * (to - from)),
        _ => (a - from).abs().max((b - to).abs()) <= SAME * (to - from),
    }
}
