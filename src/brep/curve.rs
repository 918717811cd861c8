//! Curves in space.

use super::Placement;
use super::nurbs::NurbsCurve;
use super::project::closest_parameter;
use crate::geometry::{Point, Vector};
use std::f64::consts::TAU;

/// A parametric curve, as STEP (ISO 10303-42) parametrises it; angles in radians, lengths in mm.
#[derive(Clone, Debug)]
pub enum Curve {
    /// origin + t * direction; the direction carries the length of the STEP vector.
    Line {
        /// The point of parameter 0, mm.
        origin: Point,
        /// The derivative, mm for each unit of the parameter.
        direction: Vector,
    },
    /// A circle, by the angle in radians.
    Circle {
        /// Its centre (or vertex), axes and, as z, the normal of its plane.
        placement: Placement,
        /// mm.
        radius: f64,
    },
    /// An ellipse, by the angle in radians.
    Ellipse {
        /// Its centre (or vertex), axes and, as z, the normal of its plane.
        placement: Placement,
        /// Semi-axis along x, mm.
        semi_x: f64,
        /// Semi-axis along y, mm.
        semi_y: f64,
    },
    /// origin + x * focal * t^2 + y * 2 * focal * t.
    Parabola {
        /// Its centre (or vertex), axes and, as z, the normal of its plane.
        placement: Placement,
        /// Distance of focus and vertex, mm.
        focal: f64,
    },
    /// origin + x * semi_x * cosh t + y * semi_y * sinh t.
    Hyperbola {
        /// Its centre (or vertex), axes and, as z, the normal of its plane.
        placement: Placement,
        /// Semi-axis along x, mm.
        semi_x: f64,
        /// Semi-axis along y, mm.
        semi_y: f64,
    },
    /// A B-spline, rational or not.
    Nurbs(NurbsCurve),
    /// Straight pieces between points, by the number of the point.
    Polyline(Vec<Point>),
    /// The piece of `basis` between two of its parameters; `forward`: from the first to the second along the basis.
    Trimmed {
        /// The curve it is made from.
        basis: Box<Curve>,
        /// Parameters of the basis curve at its ends.
        range: [f64; 2],
        /// Whether it runs in the direction of the basis curve.
        forward: bool,
    },
    /// Pieces one after the other, each with its sense.
    Composite(Vec<(Curve, bool)>),
    /// `basis` moved by `distance` along `reference` x tangent.
    Offset {
        /// The curve it is made from.
        basis: Box<Curve>,
        /// How far it is moved, mm.
        distance: f64,
        /// The direction that, crossed with the tangent, is moved along.
        reference: Vector,
    },
}

/// Position and derivatives on a conic with the local coordinates and derivatives given for x and y.
fn conic(placement: &Placement, x: [f64; 3], y: [f64; 3]) -> [Vector; 3] {
    let along = |i: usize| placement.x * x[i] + placement.y * y[i];
    [placement.origin.coords + along(0), along(1), along(2)]
}

impl Curve {
    /// The point at `t`.
    pub fn point(&self, t: f64) -> Point {
        match self {
            Self::Nurbs(nurbs) => nurbs.point(t),
            _ => Point::from(self.derivatives(t)[0]),
        }
    }

    /// Point (as a vector), first and second derivative at `t`. Bounded curves clamp `t` to their domain.
    pub fn derivatives(&self, t: f64) -> [Vector; 3] {
        match self {
            Self::Line { origin, direction } => [origin.coords + direction * t, *direction, Vector::zeros()],
            Self::Circle { placement, radius } => ellipse(placement, *radius, *radius, t),
            Self::Ellipse { placement, semi_x, semi_y } => ellipse(placement, *semi_x, *semi_y, t),
            Self::Parabola { placement, focal } => {
                conic(placement, [t * t, 2.0 * t, 2.0].map(|a| a * focal), [2.0 * t, 2.0, 0.0].map(|a| a * focal))
            }
            Self::Hyperbola { placement, semi_x, semi_y } => {
                let (c, s) = (t.cosh(), t.sinh());
                conic(placement, [c, s, c].map(|a| a * semi_x), [s, c, s].map(|a| a * semi_y))
            }
            Self::Nurbs(nurbs) => nurbs.derivatives(t),
            Self::Polyline(points) => polyline(points, t),
            Self::Trimmed { basis, range, forward } => trimmed(basis, *range, *forward, t),
            Self::Composite(pieces) => composite(pieces, t),
            Self::Offset { basis, distance, reference } => offset(basis, *distance, reference, t),
        }
    }

    /// The parameter interval; infinite for lines and open conics, one period for closed conics.
    pub fn domain(&self) -> [f64; 2] {
        match self {
            Self::Line { .. } | Self::Parabola { .. } | Self::Hyperbola { .. } => [f64::NEG_INFINITY, f64::INFINITY],
            Self::Circle { .. } | Self::Ellipse { .. } => [0.0, TAU],
            Self::Nurbs(nurbs) => nurbs.domain(),
            Self::Polyline(points) => [0.0, points.len().saturating_sub(1) as f64],
            Self::Trimmed { basis, range, forward } => trimmed_domain(basis, *range, *forward),
            Self::Composite(pieces) => [0.0, pieces.len() as f64],
            Self::Offset { basis, .. } => basis.domain(),
        }
    }

    /// After how much the parameter comes back to the same point; `None` for open curves. Closed bounded curves
    /// count as periodic with the length of their domain.
    pub fn period(&self) -> Option<f64> {
        match self {
            Self::Circle { .. } | Self::Ellipse { .. } => Some(TAU),
            Self::Line { .. } | Self::Parabola { .. } | Self::Hyperbola { .. } => None,
            Self::Offset { basis, .. } => basis.period(),
            Self::Nurbs(nurbs) if nurbs.is_plainly_open() => None,
            _ => {
                let [a, b] = self.domain();
                let (p, q, middle) = (self.point(a), self.point(b), self.point(0.5 * (a + b)));
                let size = (middle - p).norm() + (middle - self.point(0.75 * a + 0.25 * b)).norm();
                ((p - q).norm() <= 1e-6 * size && b > a).then_some(b - a)
            }
        }
    }

    /// Brings a parameter into the domain where the curve is periodic with `period`.
    pub fn wrap(&self, t: f64, period: Option<f64>) -> f64 {
        match (self, period) {
            (Self::Circle { .. } | Self::Ellipse { .. }, _) | (_, None) => t,
            (_, Some(period)) => {
                let start = self.domain()[0];
                if (start..=start + period).contains(&t) { t } else { start + (t - start).rem_euclid(period) }
            }
        }
    }

    /// The parameter of the point of the curve nearest to `p`: closed forms for lines and circles, else a search
    /// over samples and Newton's method. `hint`: a parameter near the answer, which saves the search.
    pub fn project(&self, p: &Point, hint: Option<f64>) -> f64 {
        match self {
            Self::Line { origin, direction } => (p - origin).dot(direction) / direction.norm_squared(),
            Self::Circle { placement, .. } => {
                let q = placement.local(p);
                q.y.atan2(q.x).rem_euclid(TAU)
            }
            Self::Parabola { placement, focal } if hint.is_none() => {
                closest_parameter(self, p, Some(placement.local(p).y / (2.0 * focal)))
            }
            Self::Hyperbola { placement, semi_y, .. } if hint.is_none() => {
                closest_parameter(self, p, Some((placement.local(p).y / semi_y).asinh()))
            }
            Self::Ellipse { placement, semi_x, semi_y } if hint.is_none() => {
                let q = placement.local(p);
                closest_parameter(self, p, Some((q.y / semi_y).atan2(q.x / semi_x))).rem_euclid(TAU)
            }
            Self::Trimmed { basis, range, forward } => {
                let sign = if *forward { 1.0 } else { -1.0 };
                let t = basis.project(p, hint.map(|t| t * sign));
                into_interval(t * sign, trimmed_domain(basis, *range, *forward), basis.period())
            }
            _ => closest_parameter(self, p, hint),
        }
    }

    /// Parameters at which the curve may bend sharply, inside its domain, ends included (finite domains only).
    pub fn breaks(&self) -> Vec<f64> {
        let [a, b] = self.domain();
        match self {
            Self::Nurbs(nurbs) => nurbs.breaks().collect(),
            Self::Polyline(points) => (0..points.len()).map(|i| i as f64).collect(),
            Self::Composite(pieces) => (0..=pieces.len()).map(|i| i as f64).collect(),
            Self::Offset { basis, .. } => basis.breaks(),
            Self::Trimmed { basis, forward, .. } => {
                let sign = if *forward { 1.0 } else { -1.0 };
                let inside = basis.breaks().into_iter().map(|t| t * sign).filter(|t| (a..=b).contains(t));
                let mut all: Vec<f64> = inside.chain([a, b]).collect();
                all.sort_by(f64::total_cmp);
                all
            }
            _ if a.is_finite() && b.is_finite() => vec![a, b],
            _ => Vec::new(),
        }
    }
}

fn ellipse(placement: &Placement, semi_x: f64, semi_y: f64, t: f64) -> [Vector; 3] {
    let (s, c) = t.sin_cos();
    conic(placement, [c, -s, -c].map(|a| a * semi_x), [s, c, -s].map(|a| a * semi_y))
}

fn polyline(points: &[Point], t: f64) -> [Vector; 3] {
    let zero = Vector::zeros();
    match points {
        [] => [zero; 3],
        [only] => [only.coords, zero, zero],
        _ => {
            let i = (t.max(0.0) as usize).min(points.len() - 2);
            let step = points[i + 1] - points[i];
            [points[i].coords + step * (t - i as f64).clamp(0.0, 1.0), step, zero]
        }
    }
}

/// The parameter runs with the sense of the trimmed curve: it is minus the basis' parameter if that is reversed.
fn trimmed_domain(basis: &Curve, [first, second]: [f64; 2], forward: bool) -> [f64; 2] {
    let (a, mut b) = if forward { (first, second) } else { (-first, -second) };
    if b <= a {
        b += basis.period().map_or(0.0, |period| period * ((a - b) / period).floor() + period);
    }
    if b > a { [a, b] } else { [b, a] }
}

fn trimmed(basis: &Curve, range: [f64; 2], forward: bool, t: f64) -> [Vector; 3] {
    let [a, b] = trimmed_domain(basis, range, forward);
    let t = t.clamp(a, b);
    if forward {
        basis.derivatives(basis.wrap(t, basis.period()))
    } else {
        let [p, d, dd] = basis.derivatives(basis.wrap(-t, basis.period()));
        [p, -d, dd]
    }
}

/// Each piece takes one unit of the parameter.
fn composite(pieces: &[(Curve, bool)], t: f64) -> [Vector; 3] {
    let Some(last) = pieces.len().checked_sub(1) else { return [Vector::zeros(); 3] };
    let i = (t.max(0.0) as usize).min(last);
    let (curve, forward) = &pieces[i];
    let [a, b] = curve.domain();
    let (from, width) = if *forward { (a, b - a) } else { (b, a - b) };
    let [p, d, dd] = curve.derivatives(from + (t - i as f64).clamp(0.0, 1.0) * width);
    [p, d * width, dd * (width * width)]
}

fn offset_point(basis: &Curve, distance: f64, reference: &Vector, t: f64) -> Vector {
    let [p, d, _] = basis.derivatives(t);
    p + reference.cross(&d).try_normalize(0.0).unwrap_or_default() * distance
}

/// The derivatives are central differences: their exact form would need one derivative more of the basis.
fn offset(basis: &Curve, distance: f64, reference: &Vector, t: f64) -> [Vector; 3] {
    let [a, b] = basis.domain();
    let h = if (b - a).is_finite() { 1e-4 * (b - a) } else { 1e-4 };
    let at = |t| offset_point(basis, distance, reference, t);
    let middle = t.clamp(a + h, b - h);
    let (low, mid, high) = (at(middle - h), at(middle), at(middle + h));
    [at(t), (high - low) / (2.0 * h), (high + low - mid * 2.0) / (h * h)]
}

/// The parameter in `[a, b]` nearest to `t`, where adding periods is allowed.
fn into_interval(t: f64, [a, b]: [f64; 2], period: Option<f64>) -> f64 {
    let t = period.map_or(t, |period| a + (t - a).rem_euclid(period));
    if t <= b {
        return t.max(a);
    }
    match period {
        Some(period) if a + period - t < t - b => a,
        _ => b,
    }
}
