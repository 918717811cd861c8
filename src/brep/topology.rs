//! What edges say about themselves: where an edge begins and ends on its curve, its tangents.

use super::{Curve, EdgeId, EdgeUse, Model};
use crate::geometry::{Point, Vector};

/// Points this near, as a share of the size of the curve, are the same point.
const SAME_POINT: f64 = 1e-6;

impl Model {
    /// The points where an edge starts and ends.
    pub fn ends(&self, edge: EdgeId) -> [Point; 2] {
        let edge = &self.edges[edge.index()];
        [edge.start, edge.end].map(|v| self.vertices[v.index()].point)
    }

    /// The parameters of the edge's start and end on its curve; the second is the smaller one where the edge runs
    /// against its curve, and lies one period away for closed edges. `None` for edges without a curve.
    pub fn edge_span(&self, id: EdgeId) -> Option<[f64; 2]> {
        let edge = &self.edges[id.index()];
        let curve = edge.curve.as_deref()?;
        let [start, end] = self.ends(id);
        let sign = if edge.same_sense { 1.0 } else { -1.0 };
        let from = parameter_of(curve, &start);
        if edge.start == edge.end {
            return Some(closed_span(curve, from, sign));
        }
        let to = parameter_of(curve, &end);
        let Some(period) = curve.period() else { return Some([from, to]) };
        let ahead = ((to - from) * sign).rem_euclid(period);
        let nothing = ahead.min(period - ahead) <= 1e-9 * period;
        let turn = if nothing && (start - end).norm() > 0.0 {
            0.0
        } else if nothing {
            period
        } else {
            ahead
        };
        Some([from, from + sign * turn])
    }

    /// The unit tangent at the start or end of an edge, in the direction in which the loop runs along it. Where the
    /// first derivative vanishes the next that does not gives the direction. `None` for edges without a direction.
    pub fn tangent(&self, at: EdgeUse, at_end: bool) -> Option<Vector> {
        let [start, end] = self.ends(at.edge);
        let along = if at.forward { 1.0 } else { -1.0 };
        let straight = || (end - start).try_normalize(f64::MIN_POSITIVE).map(|t| t * along);
        let Some(curve) = self.edges[at.edge.index()].curve.as_deref() else { return straight() };
        let [from, to] = self.edge_span(at.edge)?;
        let late = at_end == at.forward;
        let sense = if to < from { -along } else { along };
        let inward = if late { from - to } else { to - from };
        let t = curve.wrap_towards(if late { to } else { from }, inward);
        direction_at(curve, t, inward).map(|d| d * sense).or_else(straight)
    }
}

impl Curve {
    /// Brings the parameter of an end point into the domain, to that side of a closed curve's seam from which the
    /// curve goes on by `inward`.
    fn wrap_towards(&self, t: f64, inward: f64) -> f64 {
        let Some(period) = self.period() else { return t };
        let start = self.domain()[0];
        let held = start + (t - start).rem_euclid(period);
        if inward < 0.0 && held - start <= 1e-9 * period {
            start + period
        } else if inward > 0.0 && start + period - held <= 1e-9 * period {
            start
        } else {
            held
        }
    }
}

/// Projects an end point; the ends of bounded curves are tried first, as most edges span their whole curve.
fn parameter_of(curve: &Curve, p: &Point) -> f64 {
    if matches!(curve, Curve::Line { .. } | Curve::Circle { .. } | Curve::Ellipse { .. }) {
        return curve.project(p, None);
    }
    let [a, b] = curve.domain();
    if !(a.is_finite() && b.is_finite()) {
        return curve.project(p, None);
    }
    let (first, last, middle) = (curve.point(a), curve.point(b), curve.point(0.5 * (a + b)));
    let near = SAME_POINT * ((first - middle).norm() + (last - middle).norm());
    if (p - first).norm() <= near {
        a
    } else if (p - last).norm() <= near {
        b
    } else {
        curve.project(p, None)
    }
}

/// Once round: the period, else the whole domain, else nothing.
fn closed_span(curve: &Curve, from: f64, sign: f64) -> [f64; 2] {
    let [a, b] = curve.domain();
    match curve.period() {
        Some(period) => [from, from + sign * period],
        None if a.is_finite() && b.is_finite() && sign > 0.0 => [a, b],
        None if a.is_finite() && b.is_finite() => [b, a],
        None => [from, from],
    }
}

/// The unit direction of growing parameter at an end; `inward` points along the parameter into the curve.
fn direction_at(curve: &Curve, t: f64, inward: f64) -> Option<Vector> {
    let [_, d, dd] = curve.derivatives(t);
    let step = if inward.is_finite() { inward.abs() } else { 1.0 };
    let size = d.norm() * step + dd.norm() * step * step;
    if d.norm() * step > 1e-7 * size {
        return d.try_normalize(f64::MIN_POSITIVE);
    }
    // The curve starts like dd t^2 / 2: into the curve it leaves along dd, whatever the sign of t.
    let sign = if inward < 0.0 { -1.0 } else { 1.0 };
    if dd.norm() > 0.0 && dd.norm() * step * step > 1e-7 * size {
        return dd.try_normalize(f64::MIN_POSITIVE).map(|n| n * sign);
    }
    // Higher order still: the chord to a point just inside.
    let chord = curve.point(t + 1e-3 * inward) - curve.point(t);
    chord.try_normalize(f64::MIN_POSITIVE).map(|n| n * sign)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::{Edge, Placement, Vertex, VertexId};
    use crate::geometry::Point;
    use std::f64::consts::{PI, TAU};
    use std::sync::Arc;

    fn unit_circle() -> Curve {
        let placement = Placement { origin: Point::origin(), x: Vector::x(), y: Vector::y(), z: Vector::z() };
        Curve::Circle { placement, radius: 1.0 }
    }

    fn model(curve: Curve, ends: [[f64; 3]; 2], closed: bool, same_sense: bool) -> Model {
        let mut model = Model::empty();
        model.vertices = ends.map(|p| Vertex { entity: 0, point: p.into() }).to_vec();
        let end = VertexId(u32::from(!closed));
        model.edges = vec![Edge { entity: 0, curve: Some(Arc::new(curve)), start: VertexId(0), end, same_sense }];
        model
    }

    #[test]
    fn a_reversed_arc_runs_backwards() {
        let quarter = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let span = model(unit_circle(), quarter, false, true).edge_span(EdgeId(0)).unwrap();
        assert!((span[1] - span[0] - PI / 2.0).abs() < 1e-12);
        let span = model(unit_circle(), quarter, false, false).edge_span(EdgeId(0)).unwrap();
        assert!((span[1] - span[0] + 1.5 * PI).abs() < 1e-12);
        let span = model(unit_circle(), quarter, true, true).edge_span(EdgeId(0)).unwrap();
        assert!((span[1] - span[0] - TAU).abs() < 1e-12);
    }

    #[test]
    fn tangents_follow_the_loop() {
        let arc = model(unit_circle(), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], false, true);
        let at = |forward, end| arc.tangent(EdgeUse { edge: EdgeId(0), forward }, end).unwrap();
        assert!((at(true, false) - Vector::y()).norm() < 1e-12);
        assert!((at(true, true) + Vector::x()).norm() < 1e-12);
        assert!((at(false, false) - Vector::x()).norm() < 1e-12);
        assert!((at(false, true) + Vector::y()).norm() < 1e-12);
        let back = model(unit_circle(), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], false, false);
        let leaving = back.tangent(EdgeUse { edge: EdgeId(0), forward: true }, false).unwrap();
        assert!((leaving + Vector::y()).norm() < 1e-12);
    }

    #[test]
    fn a_vanishing_derivative_gives_way_to_the_next() {
        // Two control points coincide: C'(0) = 0, C''(0) points along x.
        let points = [[0.0; 3], [0.0; 3], [1.0, 0.0, 0.0]].map(Point::from).to_vec();
        let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        let curve =
            Curve::Nurbs(crate::brep::nurbs::NurbsCurve { degree: 2, knots, points, weights: vec![], closed: false });
        let model = model(curve, [[0.0; 3], [1.0, 0.0, 0.0]], false, true);
        let at = |forward, end| model.tangent(EdgeUse { edge: EdgeId(0), forward }, end).unwrap();
        assert!((at(true, false) - Vector::x()).norm() < 1e-12);
        assert!((at(false, true) + Vector::x()).norm() < 1e-12);
    }
}
