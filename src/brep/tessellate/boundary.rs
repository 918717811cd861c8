//! The loops of a face -> closed paths in its parameter space.

use std::ops::{Deref, DerefMut};

use super::border::Border;
use super::chart::{Chart, Uv};
use crate::brep::{Placement, Surface};
use crate::geometry::{Point, polygon};
use crate::memory::held;

/// Points nearer than this share of what is too far are taken to be where they should be.
const GOOD: f64 = 0.02;
/// Neighbouring points that are further apart than this share of the domain are looked at twice.
const FAR_APART: f64 = 0.05;

/// A closed path in parameter space, unwrapped: it may leave the domain of a periodic surface.
#[derive(Clone, Debug, Default)]
pub(super) struct Path {
    /// The points in space, one for each of `uv`.
    pub points: Vec<Point>,
    pub uv: Vec<Uv>,
    /// Where the true edge is half way to the next point.
    pub middles: Vec<Uv>,
    /// How often it goes round the surface in u and v.
    pub winding: [i32; 2],
}

impl Path {
    fn clear(&mut self) {
        self.points.clear();
        self.uv.clear();
        self.middles.clear();
        self.winding = [0, 0];
    }

    /// Signed area in parameter space (of the polygon, for paths that do not go round).
    pub fn signed_area(&self) -> f64 {
        polygon::signed_area(self.uv.iter().copied())
    }

    /// Goes round the surface?
    pub fn winds(&self) -> bool {
        self.winding != [0, 0]
    }

    /// The rectangle [u0, u1, v0, v1] around the path.
    pub fn rectangle(&self) -> [f64; 4] {
        rectangle(self.uv.iter())
    }

    /// The i-th segment with the middle of the true edge, unwrapped: the last one ends whole turns away from the start.
    pub fn segment(&self, i: usize, periods: [Option<f64>; 2]) -> [Uv; 3] {
        let next = if i + 1 < self.uv.len() { self.uv[i + 1] } else { self.end(periods) };
        [self.uv[i], self.middles[i], next]
    }

    /// The start point, as reached at the end.
    pub fn end(&self, periods: [Option<f64>; 2]) -> Uv {
        let turn = |i: usize| f64::from(self.winding[i]) * periods[i].unwrap_or(0.0);
        [self.uv[0][0] + turn(0), self.uv[0][1] + turn(1)]
    }

    /// Moves the path in parameter space.
    pub fn shift(&mut self, by: Uv) {
        for uv in self.uv.iter_mut().chain(&mut self.middles) {
            *uv = [uv[0] + by[0], uv[1] + by[1]];
        }
    }
}

/// The rectangle [u0, u1, v0, v1] around points.
pub(super) fn rectangle<'a>(points: impl Iterator<Item = &'a Uv>) -> [f64; 4] {
    let start = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
    points.fold(start, |r, p| [r[0].min(p[0]), r[1].max(p[0]), r[2].min(p[1]), r[3].max(p[1])])
}

/// The paths of one face after the other, in the same memory.
#[derive(Default)]
pub(super) struct Paths {
    all: Vec<Path>,
    /// How many of them belong to the face.
    count: usize,
}

impl Paths {
    /// Bytes of memory that they hold.
    pub fn bytes(&self) -> usize {
        let of = |path: &Path| held(&path.points) + held(&path.uv) + held(&path.middles);
        held(&self.all) + self.all.iter().map(of).sum::<usize>()
    }

    fn clear(&mut self) {
        self.count = 0;
    }

    /// One path more, without points.
    pub fn add(&mut self) -> &mut Path {
        if self.count == self.all.len() {
            self.all.push(Path::default());
        }
        let path = &mut self.all[self.count];
        self.count += 1;
        path.clear();
        path
    }
}

impl Deref for Paths {
    type Target = [Path];

    fn deref(&self) -> &[Path] {
        &self.all[..self.count]
    }
}

impl DerefMut for Paths {
    fn deref_mut(&mut self) -> &mut [Path] {
        &mut self.all[..self.count]
    }
}

/// Why a loop could not be mapped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unmapped {
    /// How far its points are from the surface, mm.
    pub distance: f64,
}

/// Maps a border into the parameter space of the chart. Points further than `far` (mm) from the surface are an error.
pub(super) fn map_border(
    chart: &Chart,
    border: &Border,
    size: f64,
    far: f64,
    room: &mut Vec<Mapped>,
    out: &mut Paths,
) -> Result<(), Unmapped> {
    out.clear();
    let mut tracer = Tracer { chart, far, good: GOOD * far, size, hint: None };
    border.loops().try_for_each(|[points, middles]| match &*chart.surface {
        Surface::Plane(placement) => map_to_plane(placement, points, middles, far, out.add()),
        _ => tracer.map_loop(points, middles, room, out.add()),
    })
}

fn map_to_plane(
    placement: &Placement,
    points: &[Point],
    middles: &[Point],
    far: f64,
    out: &mut Path,
) -> Result<(), Unmapped> {
    let distance = points.iter().map(|p| (p - placement.origin).dot(&placement.z).abs()).fold(0.0, f64::max);
    if !distance.is_finite() || distance > far {
        return Err(Unmapped { distance });
    }
    let map = |p: &Point| {
        let d = p - placement.origin;
        [d.dot(&placement.x), d.dot(&placement.y)]
    };
    out.points.extend_from_slice(points);
    out.uv.extend(points.iter().map(map));
    out.middles.extend(middles.iter().map(map));
    Ok(())
}

/// A point of a loop, the middle of the edge behind it, and the pole that it lies on.
pub(super) type Mapped = (Uv, Uv, Option<usize>);

/// Projects one point after the other.
struct Tracer<'a> {
    chart: &'a Chart<'a>,
    /// Points further than this from the surface are an error, mm.
    far: f64,
    /// Points nearer than this are not looked for elsewhere on the surface, mm.
    good: f64,
    size: f64,
    hint: Option<Uv>,
}

impl Tracer<'_> {
    fn map_loop(
        &mut self,
        points: &[Point],
        middles: &[Point],
        mapped: &mut Vec<Mapped>,
        out: &mut Path,
    ) -> Result<(), Unmapped> {
        let chart = self.chart;
        self.trace(points, middles, mapped)?;
        if jumps(chart, points, mapped) {
            // Where a coil touches itself the nearest point may be on the next turn: stay on the one where the loop is.
            let (mut patient, mut again) = (Tracer { good: self.far, ..*self }, Vec::new());
            if patient.trace(points, middles, &mut again).is_ok() && !jumps(chart, points, &again) {
                *mapped = again;
            }
        }
        unwrap(chart, points, mapped, chart.flipped, out);
        if out.winds() && mapped.iter().any(|m| m.2.is_some()) {
            // Past a pole a path closes when it is oriented as it should be; if not, try the other way.
            let mut other = Path::default();
            unwrap(chart, points, mapped, !chart.flipped, &mut other);
            if !other.winds() {
                *out = other;
            }
        }
        Ok(())
    }

    fn trace(&mut self, points: &[Point], middles: &[Point], mapped: &mut Vec<Mapped>) -> Result<(), Unmapped> {
        mapped.clear();
        self.hint = None;
        for (p, m) in points.iter().zip(middles) {
            let (uv, pole) = self.map(p)?;
            mapped.push((uv, self.map(m)?.0, pole));
        }
        Ok(())
    }

    fn map(&mut self, p: &Point) -> Result<(Uv, Option<usize>), Unmapped> {
        if self.chart.is_cancelled() {
            return Err(Unmapped { distance: f64::NAN });
        }
        let (distance, uv) = self.chart.nearest(p, self.hint, self.good).ok_or(Unmapped { distance: f64::INFINITY })?;
        if distance.is_nan() || distance > self.far {
            return Err(Unmapped { distance });
        }
        let pole = self.chart.pole_at(uv, self.size);
        self.hint = pole.is_none().then_some(uv);
        Ok((uv, pole))
    }
}

/// Whether neighbouring points of a loop, near each other in space, lie far apart on a surface without a closed form:
/// half way between their parameters the surface is somewhere else.
fn jumps(chart: &Chart, points: &[Point], mapped: &[Mapped]) -> bool {
    let n = points.len();
    let [u0, u1, v0, v1] = chart.domain;
    let jump = |i: usize| {
        let ((a, middle, pole), (b, _, next_pole)) = (mapped[i], mapped[(i + 1) % n]);
        let (p, q) = (points[i], points[(i + 1) % n]);
        let middle = nearest_image(chart, middle, a);
        let b = nearest_image(chart, b, middle);
        let share = ((b[0] - a[0]) / (u1 - u0)).abs().max(((b[1] - a[1]) / (v1 - v0)).abs());
        if pole.or(next_pole).is_some() || share.is_nan() || share < FAR_APART {
            return false;
        }
        let between = chart.point([0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]);
        (between - p).norm().min((between - q).norm()) > 2.0 * (q - p).norm()
    };
    chart.is_free_form() && (0..n).any(jump)
}

/// The place whole periods from `uv` that is nearest to another.
fn nearest_image(chart: &Chart, uv: Uv, to: Uv) -> Uv {
    let turn = |i: usize| chart.periods[i].map_or(uv[i], |p| uv[i] + p * ((to[i] - uv[i]) / p).round());
    [turn(0), turn(1)]
}

/// Joins the mapped points: each comes within half a period of the one before; at a pole the path runs along the
/// collapsed side from where it came in to where it goes out.
fn unwrap(chart: &Chart, points: &[Point], mapped: &[Mapped], flipped: bool, path: &mut Path) {
    // Start away from poles, where one parameter means nothing.
    let start = mapped.iter().position(|m| m.2.is_none()).unwrap_or(0);
    let (points, mapped) = (Turned { all: points, start }, Turned { all: mapped, start });
    let nearest = |uv: Uv, to: Uv| nearest_image(chart, uv, to);
    let n = mapped.all.len();
    let mut last = mapped.at(0).0;
    let mut i = 0;
    while i < n {
        let (raw, middle, pole) = mapped.at(i);
        if let Some(side) = pole {
            let behind = (i..n).find(|&j| mapped.at(j).2.is_none());
            let out = behind.map_or(mapped.at(0).0, |j| mapped.at(j).0);
            let [enter, leave] = along_pole(chart, side, last, raw, out, flipped);
            let middle = |a: Uv, b: Uv| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
            // The middle into the pole was mapped before; it may be anywhere near it.
            push(path, points.at(i), enter, middle(enter, leave));
            push(path, points.at(i), leave, middle(leave, nearest(out, leave)));
            last = nearest(out, leave);
            i = behind.unwrap_or(n);
            continue;
        }
        let uv = nearest(raw, last);
        let next_is_pole = mapped.at(if i + 1 < n { i + 1 } else { 0 }).2.is_some();
        let middle = nearest(middle, uv);
        push(path, points.at(i), uv, middle);
        last = if next_is_pole { uv } else { middle };
        i += 1;
    }
    let closing = nearest(mapped.at(0).0, last);
    let turns = |i: usize| chart.periods[i].map_or(0.0, |p| ((closing[i] - path.uv[0][i]) / p).round());
    path.winding = [turns(0) as i32, turns(1) as i32];
}

/// A closed list that starts somewhere else.
struct Turned<'a, T> {
    all: &'a [T],
    start: usize,
}

impl<T: Copy> Turned<'_, T> {
    fn at(&self, i: usize) -> T {
        let place = self.start + i;
        self.all[if place < self.all.len() { place } else { place - self.all.len() }]
    }
}

fn push(path: &mut Path, point: Point, uv: Uv, middle: Uv) {
    let uv = path.uv.last().map_or(uv, |last| straightened(uv, *last));
    path.points.push(point);
    path.uv.push(uv);
    path.middles.push(straightened(middle, uv));
}

/// A border along u or v stays one: where rounding bends it, slivers between its points would be cut off.
fn straightened(uv: Uv, last: Uv) -> Uv {
    [0, 1].map(|i| if (uv[i] - last[i]).abs() <= 1e-12 * uv[i].abs().max(1.0) { last[i] } else { uv[i] })
}

/// The two ends of the way along a pole: from `last` into it and out to `out`. With the face on the left, the way
/// along an upper side runs towards smaller u, along a lower side towards larger u (for v the other way round).
fn along_pole(chart: &Chart, side: usize, last: Uv, pole: Uv, out: Uv, flipped: bool) -> [Uv; 2] {
    let (axis, free) = (side / 2, 1 - side / 2);
    let high = last[axis] < pole[axis];
    let falling = (high != flipped) == (axis == 1);
    let mut enter = pole;
    enter[free] = last[free];
    let mut leave = pole;
    leave[free] = out[free];
    if let Some(period) = chart.periods[free] {
        let ahead = (out[free] - last[free]).rem_euclid(period);
        let none = ahead.min(period - ahead) < 1e-6 * period;
        let way = if none {
            0.0
        } else if falling {
            ahead - period
        } else {
            ahead
        };
        leave[free] = last[free] + way;
    }
    [enter, leave]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::nurbs::NurbsSurface;

    #[test]
    fn neighbours_far_apart_in_the_parameter_space_are_a_jump() {
        let corners = [[0.0, 0.0, 0.0], [0.0, 2.0, 0.0], [3.0, 0.0, 0.0], [3.0, 2.0, 0.0]].map(Point::from);
        let surface = Surface::Nurbs(NurbsSurface::bilinear(corners.to_vec()));
        let chart = Chart::new(&surface, true, &[], 1.0);
        let points = [[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [0.0, 0.2, 0.0]].map(Point::from);
        let mapped = |u: f64| [[0.0, 0.0], [u, 0.0], [0.0, 0.1]].map(|uv| (uv, uv, None));
        assert!(!jumps(&chart, &points, &mapped(0.1)));
        assert!(jumps(&chart, &points, &mapped(0.9)));
    }
}
