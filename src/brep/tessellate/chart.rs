//! The surface of one face, made ready for tessellation.

use std::borrow::Cow;
use std::cell::OnceCell;

use super::bending::sampled_steps;
use super::boundary::Path;
use super::edges::{Fineness, angular_step};
use super::spindle::Part;
use crate::brep::Surface;
use crate::brep::starts::Samples;
use crate::brep::surface::Jet;
use crate::cancel::Cancel;
use crate::geometry::Point;

/// Places from which the nearest point of a free-form surface is looked for.
const MAX_STARTS: usize = 8;
/// Grid lines of one face in each direction at most.
pub(super) const MAX_LINES: usize = 512;

/// Turns of a periodic surface that a path spans at most.
const MAX_IMAGES: i32 = 64;

/// A point of a parameter space.
pub(super) type Uv = [f64; 2];

/// A surface with what is asked again and again.
pub(super) struct Chart<'a> {
    pub surface: Cow<'a, Surface>,
    pub domain: [f64; 4],
    pub periods: [Option<f64>; 2],
    /// The face normal is against S_u x S_v.
    pub flipped: bool,
    /// Parameters outside the domain must be brought back before evaluation.
    wraps: bool,
    /// Collapsed sides: [u low, u high, v low, v high].
    pub poles: [bool; 4],
    samples: OnceCell<Samples>,
    /// Points in space that lie on the face, away from its border.
    inner: &'a [Point],
    /// Which part of a torus that cuts itself.
    part: Option<Part>,
    /// Stops the long loops over one face; the caller asks again, whatever they found.
    pub cancel: Option<&'a Cancel>,
}

impl<'a> Chart<'a> {
    /// For the surface of a face; `border`: points of its loops, which the poles of a sphere are kept away from.
    pub fn new(surface: &'a Surface, same_sense: bool, border: &[Point], size: f64) -> Self {
        let surface = match surface {
            Surface::Rectangular { basis, .. } => Cow::Borrowed(&**basis),
            other => Cow::Borrowed(other),
        };
        let surface = match surface.simplified() {
            Some(simple) => Cow::Owned(simple),
            None => surface,
        };
        let surface = match &*surface {
            Surface::Sphere { placement, radius } if !border.is_empty() => {
                let placement = super::sphere::turned_away(placement, border);
                Cow::Owned(Surface::Sphere { placement, radius: *radius })
            }
            _ => surface,
        };
        let (domain, periods) = (surface.domain(), surface.periods());
        let wraps = !matches!(*surface, Surface::Plane(_) | Surface::Cylinder { .. } | Surface::Cone { .. })
            && !matches!(*surface, Surface::Sphere { .. } | Surface::Torus { .. });
        let (flipped, poles, samples, inner) = (!same_sense, [false; 4], OnceCell::new(), [].as_slice());
        let (part, cancel) = (None, None);
        let mut chart = Self { surface, domain, periods, flipped, wraps, poles, samples, inner, part, cancel };
        chart.poles = chart.find_poles(size);
        chart.spindle(border);
        chart
    }

    /// Whether the work on the face should stop.
    pub fn is_cancelled(&self) -> bool {
        self.cancel.is_some_and(Cancel::is_cancelled)
    }

    /// Point and first derivatives, also outside the domain of a periodic surface.
    pub fn tangents(&self, uv: Uv) -> Jet {
        let [u, v] = if self.wraps { self.wrapped(uv) } else { uv };
        self.surface.tangents(u, v)
    }

    pub fn point(&self, uv: Uv) -> Point {
        let [u, v] = if self.wraps { self.wrapped(uv) } else { uv };
        self.surface.point(u, v)
    }

    fn wrapped(&self, mut uv: Uv) -> Uv {
        for (i, x) in uv.iter_mut().enumerate() {
            let (from, to) = (self.domain[2 * i], self.domain[2 * i + 1]);
            if let Some(period) = self.periods[i]
                && !(from..=to).contains(x)
            {
                *x = from + (*x - from).rem_euclid(period);
            }
        }
        uv
    }

    /// Sides of the domain where the surface has shrunk to a point: seen from the speed along the side.
    fn find_poles(&self, size: f64) -> [bool; 4] {
        let mut poles = [false; 4];
        match &*self.surface {
            Surface::Plane(_) | Surface::Cylinder { .. } | Surface::Torus { .. } | Surface::Extrusion { .. } => {}
            Surface::Sphere { .. } => poles = [false, false, true, true],
            Surface::Cone { .. } => {}
            _ => {
                let [u0, u1, v0, v1] = self.domain;
                if self.domain.iter().all(|d| d.is_finite()) {
                    let middle = |s: f64, a: f64, b: f64| a + s * (b - a);
                    let still = |side: usize| {
                        [0.13, 0.38, 0.71].iter().all(|&s| match side {
                            0 | 1 => {
                                self.tangents([self.domain[side], middle(s, v0, v1)]).dv.norm() * (v1 - v0)
                                    < 1e-6 * size
                            }
                            _ => {
                                self.tangents([middle(s, u0, u1), self.domain[side]]).du.norm() * (u1 - u0)
                                    < 1e-6 * size
                            }
                        })
                    };
                    poles = [still(0), still(1), still(2), still(3)];
                }
            }
        }
        poles
    }

    /// Bounds a torus that cuts itself to the part where the border is: a surface with two poles.
    fn spindle(&mut self, border: &[Point]) {
        self.part = Part::of(&self.surface, border);
        if let Some(part) = &self.part {
            [self.domain[2], self.domain[3]] = part.range();
            self.periods[1] = None;
            self.poles = [false, false, true, true];
        }
    }

    /// Notes points of the face's inside and bounds a cone at its apex, on the side where the paths are.
    pub fn settle(&mut self, paths: &[Path], inner: &'a [Point]) {
        self.inner = inner;
        let Surface::Cone { radius, half_angle, .. } = &*self.surface else { return };
        let apex = -radius / half_angle.tan();
        let heights = || paths.iter().flat_map(|p| &p.uv).map(|uv| uv[1]);
        let above = heights().sum::<f64>() / heights().count().max(1) as f64 > apex;
        let side = if above { 2 } else { 3 };
        self.domain[side] = apex;
        self.poles[side] = true;
    }

    /// Parameters of points that are known to lie inside the face.
    pub fn inner(&self) -> impl Iterator<Item = Uv> + '_ {
        self.inner.iter().filter_map(|p| self.nearest(p, None, 0.0)).map(|(_, uv)| uv)
    }

    /// The places one or more periods from `uv` that may lie in the rectangle.
    pub fn images(&self, uv: Uv, around: [f64; 4]) -> impl Iterator<Item = Uv> {
        let axis = |axis: usize| {
            let period = self.periods[axis].unwrap_or(0.0);
            let turns = |to: f64| if period > 0.0 { (to - uv[axis]) / period } else { 0.0 };
            let (low, high) = (turns(around[2 * axis]).floor() as i32, turns(around[2 * axis + 1]).ceil() as i32);
            (low..=high.min(low.saturating_add(MAX_IMAGES))).map(move |k| uv[axis] + f64::from(k) * period)
        };
        let vs: Vec<f64> = axis(1).collect();
        axis(0).flat_map(move |u| vs.clone().into_iter().map(move |v| [u, v]))
    }

    /// Whether the surface has no border: closed in both directions, by a period or by poles.
    pub fn is_closed(&self) -> bool {
        let closed = |axis: usize| self.periods[axis].is_some() || (self.poles[2 * axis] && self.poles[2 * axis + 1]);
        closed(0) && closed(1)
    }

    /// Which side of the domain a point lies on, if that side is a pole; `None` away from poles. The apex of a cone
    /// counts as low side for points above it: the caller says where the face is by `near`.
    pub fn pole_at(&self, uv: Uv, size: f64) -> Option<usize> {
        if let Surface::Cone { radius, half_angle, .. } = &*self.surface {
            let slope = half_angle.tan();
            return ((radius + uv[1] * slope).abs() <= 1e-6 * size).then_some(2);
        }
        (0..4).find(|&side| {
            let (axis, along) = (side / 2, self.domain[2 * (side / 2) + 1] - self.domain[2 * (side / 2)]);
            self.poles[side] && (uv[axis] - self.domain[side]).abs() <= 1e-6 * along
        })
    }

    /// Whether nearest points are found by iteration from samples.
    pub fn is_free_form(&self) -> bool {
        matches!(*self.surface, Surface::Nurbs(_) | Surface::Offset { .. })
    }

    /// Whether there may be several places that look nearest from nearby: a turned profile passes a point on both
    /// sides of the axis.
    fn is_sampled(&self) -> bool {
        let turned = matches!(*self.surface, Surface::Revolution { .. }) && self.domain.iter().all(|d| d.is_finite());
        turned || self.is_free_form()
    }

    /// The nearest point of the surface and how far it is: from `hint` if that leads to one nearer than `good`, else
    /// from several samples, as a coiled surface has many places that look nearest from nearby.
    pub fn nearest(&self, p: &Point, hint: Option<Uv>, good: f64) -> Option<(f64, Uv)> {
        if let Some(part) = &self.part {
            let uv = part.project(p);
            return Some(((self.point(uv) - p).norm(), uv));
        }
        let project = |hint| self.surface.project_within(self.periods, p, hint);
        let from = |hint: Option<Uv>| project(hint).map(|uv| (self.distance(p, uv), uv));
        if !self.is_sampled() {
            let near = from(hint);
            return match (near, hint) {
                (Some(found), Some(_)) if found.0 > good => from(None).filter(|n| n.0 < found.0).or(near),
                _ => near,
            };
        }
        let mut best = if self.is_free_form() { hint.and_then(|hint| from(Some(hint))) } else { from(hint) };
        if best.is_none_or(|b| b.0 > good) {
            for start in self.samples.get_or_init(|| Samples::of(&self.surface)).nearest(p, MAX_STARTS) {
                let found = from(Some(start));
                best = [best, found].into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0));
                if best.is_some_and(|b| b.0 <= good) {
                    break;
                }
            }
        }
        best
    }

    /// How far `p` is from the point of the surface at `uv`, which is the nearest one.
    fn distance(&self, p: &Point, uv: Uv) -> f64 {
        let (placement, tube, radius) = match &*self.surface {
            Surface::Cylinder { placement, radius } => {
                let q = placement.local(p);
                return (q.x.hypot(q.y) - radius).abs();
            }
            Surface::Sphere { placement, radius } => (placement, 0.0, radius),
            Surface::Torus { placement, major, minor } => (placement, *major, minor),
            _ => return (self.point(uv) - p).norm(),
        };
        let q = placement.local(p);
        ((q.x.hypot(q.y) - tube).hypot(q.z) - radius).abs()
    }

    /// How long a unit step of u and of v is around the middle of the rectangle, mm.
    pub fn scale(&self, [u0, u1, v0, v1]: [f64; 4]) -> [f64; 2] {
        let mut longest = [0.0_f64; 2];
        for (s, t) in [(0.5, 0.5), (0.2, 0.3), (0.8, 0.7)] {
            let jet = self.tangents([u0 + s * (u1 - u0), v0 + t * (v1 - v0)]);
            longest = [longest[0].max(jet.du.norm()), longest[1].max(jet.dv.norm())];
        }
        longest.map(|l| if l.is_finite() && l > 0.0 { l } else { 1.0 })
    }

    /// Lengths of unit steps in which the cells of a grid are squares, so that Delaunay triangles are about as long
    /// and as wide as the cells: in true lengths they would span a narrow face that bends along its whole length.
    pub fn metric(&self, rectangle: [f64; 4], cells: [usize; 2]) -> [f64; 2] {
        let widths = [rectangle[1] - rectangle[0], rectangle[3] - rectangle[2]];
        if cells == [1, 1] || widths.iter().any(|w| !w.is_finite() || *w <= 0.0) {
            return self.scale(rectangle);
        }
        [cells[0] as f64 / widths[0], cells[1] as f64 / widths[1]]
    }

    /// In how many steps to cut the rectangle along u and v, by curvature.
    pub fn steps(&self, rectangle: [f64; 4], fineness: &Fineness) -> [usize; 2] {
        let [u0, u1, v0, v1] = rectangle;
        let turns =
            |width: f64, radius: f64| ((width / angular_step(radius, fineness)) - 1e-9).ceil().max(1.0) as usize;
        let counts = match &*self.surface {
            Surface::Plane(_) => [1, 1],
            Surface::Cylinder { radius, .. } => [turns(u1 - u0, *radius), 1],
            Surface::Cone { radius, half_angle, .. } => {
                let widest = [v0, v1].map(|v| (radius + v * half_angle.tan()).abs());
                [turns(u1 - u0, widest[0].max(widest[1])), 1]
            }
            Surface::Sphere { radius, .. } => [turns(u1 - u0, *radius), turns(v1 - v0, *radius)],
            Surface::Torus { major, minor, .. } => {
                [turns(u1 - u0, major.abs() + minor.abs()), turns(v1 - v0, minor.abs())]
            }
            _ => sampled_steps(self, rectangle, fineness),
        };
        counts.map(|n| n.clamp(1, MAX_LINES))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::Placement;
    use crate::geometry::Vector;
    use std::f64::consts::{FRAC_PI_4, TAU};

    fn axes() -> Placement {
        Placement { origin: Point::origin(), x: Vector::x(), y: Vector::y(), z: Vector::z() }
    }

    #[test]
    fn images_lie_whole_turns_away() {
        let surface = Surface::Cylinder { placement: axes(), radius: 1.0 };
        let chart = Chart::new(&surface, true, &[], 1.0);
        let images: Vec<Uv> = chart.images([1.0, 5.0], [-TAU, TAU, 0.0, 9.0]).collect();
        assert_eq!(images, [[1.0 - 2.0 * TAU, 5.0], [1.0 - TAU, 5.0], [1.0, 5.0], [1.0 + TAU, 5.0]]);
    }

    #[test]
    fn a_cone_ends_at_its_apex_on_the_side_of_its_paths() {
        let surface = Surface::Cone { placement: axes(), radius: 1.0, half_angle: FRAC_PI_4 };
        for (v, side) in [(2.0, 2), (-3.0, 3)] {
            let mut chart = Chart::new(&surface, true, &[], 1.0);
            chart.settle(&[Path { uv: vec![[0.0, v]], ..Path::default() }], &[]);
            assert!(chart.poles[side] && (chart.domain[side] + 1.0).abs() < 1e-12);
            assert!(!chart.poles[5 - side]);
        }
    }

    #[test]
    fn closed_surfaces_have_no_border() {
        let closed = |surface: Surface| Chart::new(&surface, true, &[], 1.0).is_closed();
        assert!(closed(Surface::Sphere { placement: axes(), radius: 1.0 }));
        assert!(closed(Surface::Torus { placement: axes(), major: 3.0, minor: 1.0 }));
        assert!(closed(Surface::Torus { placement: axes(), major: 1.0, minor: 3.0 }));
        assert!(!closed(Surface::Cylinder { placement: axes(), radius: 1.0 }));
    }

    #[test]
    fn steps_follow_the_radius() {
        let surface = Surface::Cylinder { placement: axes(), radius: 1.0 };
        let chart = Chart::new(&surface, true, &[], 1.0);
        let steps = |deflection: f64, angle: f64| chart.steps([0.0, TAU, 0.0, 1.0], &Fineness { deflection, angle });
        // By the angle TAU / 0.35 = 17.95; by the deflection TAU / (2 acos(1 - 0.005)) = 31.4.
        assert_eq!((steps(1.0, 0.35), steps(0.005, 0.35)), ([18, 1], [32, 1]));
    }
}
