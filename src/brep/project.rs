//! The point of a curve or surface nearest to a given point: Newton's method from a hint or from the best of a few
//! samples.

use super::starts::{Samples, anywhere, best_by, least_distance};
use super::surface::{Jet, Surface};
use super::{Curve, Placement};
use crate::geometry::{Point, Vector};

/// Newton steps before giving up; from a good start three or four are enough.
const STEPS: usize = 30;
/// A step this small, as a share of the parameter range, ends the iteration.
const SMALL_STEP: f64 = 1e-12;
/// Lines and points this near to a plane, as a sine or a share of the size, lie in it.
const COPLANAR: f64 = 1e-9;

/// A parameter interval, closed in itself where the period is given.
struct Range {
    from: f64,
    to: f64,
    period: Option<f64>,
}

impl Range {
    fn new(from: f64, to: f64, period: Option<f64>) -> Self {
        Self { from, to, period }
    }

    fn width(&self) -> f64 {
        let width = self.to - self.from;
        if width.is_finite() { width } else { 1.0 }
    }

    fn hold(&self, t: f64) -> f64 {
        match self.period {
            Some(period) if period.is_finite() => self.from + (t - self.from).rem_euclid(period),
            _ => t.min(self.to).max(self.from),
        }
    }
}

/// The parameter of the point of `curve` nearest to `p`.
pub(super) fn closest_parameter(curve: &Curve, p: &Point, hint: Option<f64>) -> f64 {
    let error = |t| {
        let [q, d, dd] = curve.derivatives(t);
        [q - p.coords, d, dd]
    };
    let off = |t| curve.point(t) - p;
    match curve {
        Curve::Nurbs(nurbs) => {
            closest_by(curve, hint, error, off, nurbs.pieces().map(|points| least_distance(points, p)))
        }
        _ => closest_by(curve, hint, error, off, anywhere()),
    }
}

/// The parameters of the point of `surface` nearest to `p`, for surfaces without a closed form; `periods` are its own.
pub(super) fn closest_on_surface(
    surface: &Surface,
    periods: [Option<f64>; 2],
    p: &Point,
    hint: Option<[f64; 2]>,
) -> Option<[f64; 2]> {
    if let Surface::Extrusion { profile, direction } = surface {
        return project_extrusion(profile, direction, p, hint);
    }
    let [u0, u1, v0, v1] = surface.domain();
    let ranges = [Range::new(u0, u1, periods[0]), Range::new(v0, v1, periods[1])];
    let start = match hint {
        Some(hint) => hint,
        None => *Samples::of(surface).nearest(p, 1).first()?,
    };
    newton_on_surface(surface, &ranges, p, start)
}

/// Minimises |S(u, v) - p|^2 by Newton's method.
fn newton_on_surface(surface: &Surface, ranges: &[Range; 2], p: &Point, hint: [f64; 2]) -> Option<[f64; 2]> {
    let mut uv = [ranges[0].hold(hint[0]), ranges[1].hold(hint[1])];
    let mut jet = surface.jet(uv[0], uv[1]);
    for _ in 0..STEPS {
        let r = jet.point - p;
        let mut step = newton_step(&jet, &r, &uv, ranges);
        // The place a step leads to, and whether it is the last one, behind which no derivatives are asked for.
        let reached = |step: [f64; 2]| {
            let next = [0, 1].map(|i| ranges[i].hold(uv[i] + step[i]));
            let [u, v] = [0, 1].map(|i| (next[i] - uv[i]).abs() / ranges[i].width());
            let moved = u.max(v);
            (next, !moved.is_finite() || moved <= SMALL_STEP)
        };
        let at = |([u, v], last): ([f64; 2], bool)| if last { Jet::at(surface.point(u, v)) } else { surface.jet(u, v) };
        let mut next = reached(step);
        let mut value = at(next);
        for _ in 0..8 {
            if (value.point - p).norm_squared() <= r.norm_squared() {
                break;
            }
            step = [0.5 * step[0], 0.5 * step[1]];
            next = reached(step);
            value = at(next);
        }
        (uv, jet) = (next.0, value);
        if next.1 {
            break;
        }
    }
    (uv[0].is_finite() && uv[1].is_finite()).then_some(uv)
}

/// The next step, with the Gauss-Newton matrix where the full one is not positive.
fn newton_step(jet: &Jet, r: &Vector, uv: &[f64; 2], ranges: &[Range; 2]) -> [f64; 2] {
    let gradient = [r.dot(&jet.du), r.dot(&jet.dv)];
    let gauss = [jet.du.norm_squared(), jet.du.dot(&jet.dv), jet.dv.norm_squared()];
    let full = [gauss[0] + r.dot(&jet.duu), gauss[1] + r.dot(&jet.duv), gauss[2] + r.dot(&jet.dvv)];
    let floor = 0.01 * gauss[0] * gauss[2];
    let positive = full[0] > 0.0 && full[0] * full[2] - full[1] * full[1] > floor;
    let step = solve(if positive { full } else { gauss }, gradient);
    keep_inside(uv, step, ranges, &gauss, &gradient)
}

/// Where a step would leave the domain through a side, only the other parameter moves.
fn keep_inside(uv: &[f64; 2], step: [f64; 2], ranges: &[Range; 2], gauss: &[f64; 3], gradient: &[f64; 2]) -> [f64; 2] {
    let blocked = |i: usize| {
        let (range, to) = (&ranges[i], uv[i] + step[i]);
        range.period.is_none() && ((uv[i] <= range.from && to < uv[i]) || (uv[i] >= range.to && to > uv[i]))
    };
    let along = |i: usize| if gauss[2 * i] > 0.0 { -gradient[i] / gauss[2 * i] } else { 0.0 };
    match (blocked(0), blocked(1)) {
        (false, false) => step,
        (true, false) => [0.0, along(1)],
        (false, true) => [along(0), 0.0],
        (true, true) => [0.0, 0.0],
    }
}

/// The step that solves the 2 by 2 system; along one parameter only where the matrix is singular (poles).
fn solve([a, b, c]: [f64; 3], gradient: [f64; 2]) -> [f64; 2] {
    let determinant = a * c - b * b;
    if determinant > 1e-14 * a * c && determinant > 0.0 {
        return [(b * gradient[1] - c * gradient[0]) / determinant, (b * gradient[0] - a * gradient[1]) / determinant];
    }
    if a >= c && a > 0.0 {
        [-gradient[0] / a, 0.0]
    } else if c > 0.0 {
        [0.0, -gradient[1] / c]
    } else {
        [0.0, 0.0]
    }
}

/// Along the direction a point keeps its u: the profile is projected along it, which is a curve again.
fn project_extrusion(profile: &Curve, direction: &Vector, p: &Point, hint: Option<[f64; 2]>) -> Option<[f64; 2]> {
    let axis = direction.try_normalize(f64::MIN_POSITIVE)?;
    let flat = |v: Vector| v - axis * axis.dot(&v);
    let target = flat(p.coords);
    let error = |t: f64| {
        let [q, d, dd] = profile.derivatives(t);
        [flat(q) - target, flat(d), flat(dd)]
    };
    let off = |t| flat(profile.point(t).coords) - target;
    let u = closest_by(profile, hint.map(|h| h[0]), error, off, anywhere());
    let v = (p.coords - profile.derivatives(u)[0]).dot(&axis) / direction.norm();
    Some([u, v])
}

/// The profile turned into the half plane of `p`, either side of the axis; the nearer one counts.
pub(super) fn project_revolution(
    profile: &Curve,
    axis: &Placement,
    p: &Point,
    hint: Option<[f64; 2]>,
) -> Option<[f64; 2]> {
    let q = axis.local(p);
    if let Some(out) = plane_of_circle(profile, axis) {
        return Some(project_turned_circle(profile, axis, &out, &q, hint.map(|h| h[1])));
    }
    let rho = q.x.hypot(q.y);
    // Distance from the axis and height; the distance of a profile point has one sign along a sensible profile.
    let local = |a: &Vector| Vector::new(a.dot(&axis.x), a.dot(&axis.y), a.dot(&axis.z));
    let error = |t: f64| {
        let [c, d, dd] = profile.derivatives(t);
        let (c, d, dd) = (local(&(c - axis.origin.coords)), local(&d), local(&dd));
        let r = c.x.hypot(c.y).max(1e-300);
        let rd = (c.x * d.x + c.y * d.y) / r;
        let rdd = (d.x * d.x + d.y * d.y + c.x * dd.x + c.y * dd.y - rd * rd) / r;
        [Vector::new(r - rho, 0.0, c.z - q.z), Vector::new(rd, 0.0, d.z), Vector::new(rdd, 0.0, dd.z)]
    };
    let v = closest_by(profile, hint.map(|h| h[1]), error, |t| error(t)[0], anywhere());
    let at = local(&(profile.derivatives(v)[0] - axis.origin.coords));
    Some([q.y.atan2(q.x) - at.y.atan2(at.x), v])
}

/// For a circle in one plane with the axis: the direction in that plane out from the axis, to the side where the
/// circle's parameters begin.
fn plane_of_circle(profile: &Curve, axis: &Placement) -> Option<Vector> {
    let circle = match profile {
        Curve::Trimmed { basis, .. } => &**basis,
        other => other,
    };
    let Curve::Circle { placement, radius } = circle else { return None };
    let off = (placement.origin - axis.origin).dot(&placement.z).abs();
    if placement.z.dot(&axis.z).abs() > COPLANAR || off > COPLANAR * radius {
        return None;
    }
    let out = placement.z.cross(&axis.z).normalize();
    Some(if out.dot(&placement.x) < 0.0 { -out } else { out })
}

/// The point is turned into the plane of the circle on either side of the axis; `q`: its coordinates about the axis.
/// Where both sides are as near, as on a circle about the axis, the one nearer to the hint counts.
fn project_turned_circle(profile: &Curve, axis: &Placement, out: &Vector, q: &Vector, hint: Option<f64>) -> [f64; 2] {
    let rho = q.x.hypot(q.y);
    let [near, far] = [1.0, -1.0].map(|side| {
        let at = axis.point(0.0, 0.0, q.z) + out * (side * rho);
        let v = profile.project(&at, hint);
        (side, v, (profile.point(v) - at).norm())
    });
    let apart = |v: f64| {
        let off = v - hint.unwrap_or(near.1);
        (off - std::f64::consts::TAU * (off / std::f64::consts::TAU).round()).abs()
    };
    let alike = (near.2 - far.2).abs() <= COPLANAR * (rho + q.z.abs());
    let other = if alike { apart(far.1) < apart(near.1) } else { far.2 < near.2 };
    let (side, v, _) = if other { far } else { near };
    let beginning = out.dot(&axis.y).atan2(out.dot(&axis.x));
    let turn = if side < 0.0 { std::f64::consts::PI } else { 0.0 };
    [q.y.atan2(q.x) - beginning + turn, v]
}

/// The parameter of a curve that makes the vector `off(t)` shortest; `error` gives two derivatives as well.
/// A step that makes it longer is halved; where the second-order term would turn the step round it is left out. `least`:
/// for each piece between breaks a square of the length that none is shorter than.
fn closest_by(
    curve: &Curve,
    hint: Option<f64>,
    error: impl Fn(f64) -> [Vector; 3],
    off: impl Fn(f64) -> Vector,
    least: impl Iterator<Item = f64>,
) -> f64 {
    let [a, b] = curve.domain();
    let range = Range::new(a, b, curve.period());
    let size = |t: f64| off(t).norm_squared();
    let mut t = match hint {
        Some(hint) => range.hold(hint),
        None if (b - a).is_finite() => best_by(curve, &size, least),
        None => 0.0,
    };
    let mut jet = error(t);
    for _ in 0..STEPS {
        let [r, d, dd] = jet;
        let full = d.norm_squared() + r.dot(&dd);
        let bend = if full > 0.1 * d.norm_squared() { full } else { d.norm_squared() };
        let mut step = if bend > 0.0 { -r.dot(&d) / bend } else { 0.0 };
        let mut next = range.hold(t + step);
        let mut value = error(next);
        for _ in 0..8 {
            if value[0].norm_squared() <= r.norm_squared() {
                break;
            }
            step *= 0.5;
            next = range.hold(t + step);
            value = error(next);
        }
        let moved = (next - t).abs() / range.width();
        (t, jet) = (next, value);
        if moved.is_nan() || moved <= SMALL_STEP {
            break;
        }
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::nurbs::NurbsSurface;

    #[test]
    fn a_circle_turned_about_an_axis_that_cuts_it_is_found_on_both_sides() {
        // Radius 200, the axis 20 from the centre: both sides pass within 0.3 of each other near the axis.
        let axis = Placement { origin: Point::new(1.0, 2.0, 3.0), x: Vector::x(), y: Vector::y(), z: Vector::z() };
        let placement =
            Placement { origin: Point::new(1.0, 22.0, 3.0), x: Vector::y(), y: Vector::z(), z: Vector::x() };
        let profile = Box::new(Curve::Circle { placement, radius: 200.0 });
        let surface = Surface::Revolution { profile, axis };
        for v in [1.4, 1.6708, 1.6710, 1.7, 4.0] {
            for u in [0.0, 2.5, 5.0] {
                let p = surface.point(u, v);
                let [a, b] = surface.project(&p, None).unwrap();
                assert!((surface.point(a, b) - p).norm() < 1e-9, "{u} {v}: {a} {b}");
            }
        }
    }

    #[test]
    fn points_near_a_collapsed_side_are_found() {
        // u times a parabola from (-1, 0) to (1, 0): the side u = 0 is one point.
        let arc = [[-1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [1.0, 0.0, 0.0]].map(Point::from);
        let fan = NurbsSurface {
            degree_u: 1,
            degree_v: 2,
            knots_u: vec![0.0, 0.0, 1.0, 1.0],
            knots_v: vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
            columns: 3,
            points: [Point::origin(); 3].into_iter().chain(arc).collect(),
            weights: vec![],
        };
        let fan = Surface::Nurbs(fan);
        for end in [-1.0, 1.0] {
            let p = Point::new(0.02 * end, 0.0, 0.0);
            let [u, v] = fan.project(&p, None).unwrap();
            assert!((u - 0.02).abs() < 1e-9 && (v - 0.5 - 0.5 * end).abs() < 1e-9, "{u} {v}");
        }
    }
}
