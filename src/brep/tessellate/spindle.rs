//! Tori whose circle reaches over the axis: they cut themselves on it in two points, between an outer part like an
//! apple and an inner one like a lemon. A face lies on one of them, and the two points are its poles.

use std::f64::consts::{PI, TAU};

use crate::brep::{Placement, Surface};
use crate::geometry::Point;

/// One of the two parts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    placement: Placement,
    major: f64,
    minor: f64,
    inner: bool,
}

impl Part {
    /// The part that the border lies on, the outer one where there is no border; `None` for other surfaces.
    pub fn of(surface: &Surface, border: &[Point]) -> Option<Self> {
        let &Surface::Torus { placement, major, minor } = surface else { return None };
        let [outer, inner] = [false, true].map(|inner| Self { placement, major, minor, inner });
        let off = |part: &Self| border.iter().map(|p| part.distance(p)).sum::<f64>();
        (minor > major).then(|| if off(&inner) < off(&outer) { inner } else { outer })
    }

    /// From one pole to the other.
    pub fn range(&self) -> [f64; 2] {
        let pole = (-self.major / self.minor).acos();
        if self.inner { [pole, TAU - pole] } else { [-pole, pole] }
    }

    /// Distance from the axis, against the direction of u on the inner part, and height.
    fn profile(&self, p: &Point) -> [f64; 2] {
        let q = self.placement.local(p);
        let rho = q.x.hypot(q.y);
        [if self.inner { -rho } else { rho }, q.z]
    }

    fn distance(&self, p: &Point) -> f64 {
        let [rho, z] = self.profile(p);
        ((rho - self.major).hypot(z) - self.minor).abs()
    }

    /// The parameters of the nearest point.
    pub fn project(&self, p: &Point) -> [f64; 2] {
        let q = self.placement.local(p);
        let [rho, z] = self.profile(p);
        let turn = if self.inner { PI } else { 0.0 };
        let [low, high] = self.range();
        let v = z.atan2(rho - self.major);
        let v = if self.inner { v.rem_euclid(TAU) } else { v };
        [q.y.atan2(q.x) + turn, v.clamp(low, high)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vector;

    #[test]
    fn points_of_both_parts_are_found() {
        let placement = Placement { origin: Point::origin(), x: Vector::x(), y: Vector::y(), z: Vector::z() };
        let torus = Surface::Torus { placement, major: 1.0, minor: 2.0 };
        for uv in [[0.3, 1.9], [2.0, -1.0], [-1.0, 2.5], [1.0, PI]] {
            let p = torus.point(uv[0], uv[1]);
            let part = Part::of(&torus, &[p]).unwrap();
            assert_eq!(part.inner, uv[1].cos() < -0.5);
            let [u, v] = part.project(&p);
            assert!((torus.point(u, v) - p).norm() < 1e-12 && (v - uv[1]).abs() < 1e-12, "{u} {v} for {uv:?}");
        }
    }
}
