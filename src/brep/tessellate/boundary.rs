//! The loops of a face -> closed paths in its parameter space.

use rustc_hash::FxHashMap;

use super::Few;
use super::chart::{Chart, Uv};
use super::edges::EdgeLines;
use crate::brep::{EdgeId, EdgeUse, Face};
use crate::geometry::Point;

/// Points nearer than this share of what is too far are taken to be where they should be.
const GOOD: f64 = 0.02;
/// Neighbouring points that are further apart than this share of the domain are looked at twice.
const FAR_APART: f64 = 0.05;

/// Seams of one face that are taken out: each costs a pass over the loop, and what is left bounds nothing.
const MOST_SEAMS: usize = 256;
/// Points of the border of one face at most: edges may be used again and again.
const MOST_POINTS: usize = 1_000_000;

/// Up to so many edges a seam is found soonest by comparing each with each.
const SHORT: usize = 16;

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
    fn with_capacity(count: usize) -> Self {
        let uv = || Vec::with_capacity(count);
        Self { points: Vec::with_capacity(count), uv: uv(), middles: uv(), winding: [0, 0] }
    }

    /// Signed area in parameter space (of the polygon, for paths that do not go round).
    pub fn signed_area(&self) -> f64 {
        let before = self.uv.last().into_iter().chain(&self.uv);
        0.5 * before.zip(&self.uv).map(|(p, q)| p[0] * q[1] - q[0] * p[1]).sum::<f64>()
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

/// The border of a face in space.
#[derive(Clone, Default)]
pub(super) struct Border {
    /// One closed polyline for each loop, with the middles of the true edges.
    pub loops: Few<[Vec<Point>; 2]>,
    /// A point on each seam: an edge that a loop runs along both ways, so that the face lies on both its sides.
    pub seams: Vec<Point>,
}

impl Border {
    /// The border of a face; `None` where it has far too many points.
    pub fn of(face: &Face, lines: &EdgeLines, degenerate: &[bool]) -> Option<Self> {
        let uses = face.loops.iter().flat_map(|l| &l.uses);
        if uses.map(|u| lines.line(u.edge).0.len()).sum::<usize>() > MOST_POINTS {
            return None;
        }
        let (mut chains, mut seams, mut loops) = (Vec::new(), Vec::new(), Few::with_capacity(face.loops.len()));
        for face_loop in &face.loops {
            if first_pair(&face_loop.uses).is_none() && !face_loop.uses.iter().any(|u| degenerate[u.edge.index()]) {
                loops.push(polyline(&face_loop.uses, lines));
                continue;
            }
            let uses = face_loop.uses.iter().copied().filter(|u| !degenerate[u.edge.index()]).collect();
            split_at_seams(uses, &mut chains, &mut seams);
            loops.extend(chains.drain(..).map(|chain| polyline(&chain, lines)));
        }
        loops.retain(|line| line[0].len() > 1);
        Some(Self { loops, seams: seams.into_iter().map(|edge| half_way(edge, lines)).collect() })
    }
}

/// Takes out edges that a chain runs along in both directions; what lies between them becomes chains of their own.
fn split_at_seams(uses: Vec<EdgeUse>, out: &mut Vec<Vec<EdgeUse>>, seams: &mut Vec<EdgeId>) {
    let mut open = vec![uses];
    while let Some(chain) = open.pop() {
        let pair = if seams.len() < MOST_SEAMS { first_pair(&chain) } else { None };
        match pair {
            Some((i, j)) => {
                seams.push(chain[i].edge);
                open.push(chain[i + 1..j].to_vec());
                open.push(chain[j + 1..].iter().chain(&chain[..i]).copied().collect());
            }
            None if !chain.is_empty() => out.push(chain),
            None => {}
        }
    }
}

/// The places of the first use of an edge that has an opposite one, and of that.
fn first_pair(chain: &[EdgeUse]) -> Option<(usize, usize)> {
    if chain.len() <= SHORT {
        let opposite = |i: usize| {
            let twin = |u: &EdgeUse| u.edge == chain[i].edge && u.forward != chain[i].forward;
            chain[i + 1..].iter().position(twin).map(|n| (i, i + 1 + n))
        };
        return (0..chain.len()).find_map(opposite);
    }
    let mut first: FxHashMap<(EdgeId, bool), usize> = FxHashMap::default();
    let pairs = chain.iter().enumerate().filter_map(|(j, u)| {
        first.entry((u.edge, u.forward)).or_insert(j);
        first.get(&(u.edge, !u.forward)).map(|&i| (i, j))
    });
    pairs.min()
}

/// A point near the middle of an edge.
fn half_way(edge: EdgeId, lines: &EdgeLines) -> Point {
    let (points, middles) = lines.line(edge);
    middles[(points.len() - 1) / 2]
}

fn polyline(chain: &[EdgeUse], lines: &EdgeLines) -> [Vec<Point>; 2] {
    let count = chain.iter().map(|u| lines.line(u.edge).0.len() - 1).sum();
    let (mut points, mut middles) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for edge_use in chain {
        let (p, m) = lines.line(edge_use.edge);
        let n = p.len() - 1;
        if edge_use.forward {
            points.extend_from_slice(&p[..n]);
            middles.extend_from_slice(&m[..n]);
        } else {
            points.extend(p[1..].iter().rev());
            middles.extend(m[..n].iter().rev());
        }
    }
    [points, middles]
}

/// Why a loop could not be mapped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unmapped {
    /// How far its points are from the surface, mm.
    pub distance: f64,
}

/// Maps closed polylines into the parameter space of the chart. Points further than `far` (mm) from the surface are an error.
pub(super) fn paths(chart: &Chart, loops: Few<[Vec<Point>; 2]>, size: f64, far: f64) -> Result<Few<Path>, Unmapped> {
    loops.into_iter().map(|[points, middles]| path(chart, points, middles, size, far)).collect()
}

fn path(chart: &Chart, points: Vec<Point>, middles: Vec<Point>, size: f64, far: f64) -> Result<Path, Unmapped> {
    if let crate::brep::Surface::Plane(_) = *chart.surface {
        return plane_path(chart, points, &middles, far);
    }
    let mut tracer = Tracer { chart, far, good: GOOD * far, size, hint: None };
    let mut mapped = tracer.trace(&points, &middles)?;
    if jumps(chart, &points, &mapped) {
        // Where a coil touches itself the nearest point may be on the next turn: stay on the one where the loop is.
        tracer = Tracer { good: far, hint: None, ..tracer };
        mapped = tracer.trace(&points, &middles).ok().filter(|m| !jumps(chart, &points, m)).unwrap_or(mapped);
    }
    // Start away from poles, where one parameter means nothing.
    let start = mapped.iter().position(|m| m.2.is_none()).unwrap_or(0);
    mapped.rotate_left(start);
    let mut points = points;
    points.rotate_left(start);
    let mut found = unwrap(chart, &points, &mapped, chart.flipped);
    if found.winds() && mapped.iter().any(|m| m.2.is_some()) {
        // Past a pole a path closes when it is oriented as it should be; if not, try the other way.
        let other = unwrap(chart, &points, &mapped, !chart.flipped);
        if !other.winds() {
            found = other;
        }
    }
    Ok(found)
}

fn plane_path(chart: &Chart, points: Vec<Point>, middles: &[Point], far: f64) -> Result<Path, Unmapped> {
    let crate::brep::Surface::Plane(placement) = *chart.surface else { return Err(Unmapped { distance: far }) };
    let map = |p: &Point| {
        let d = p - placement.origin;
        [d.dot(&placement.x), d.dot(&placement.y)]
    };
    let distance = points.iter().map(|p| (p - placement.origin).dot(&placement.z).abs()).fold(0.0, f64::max);
    if !distance.is_finite() || distance > far {
        return Err(Unmapped { distance });
    }
    let uv = points.iter().map(map).collect();
    Ok(Path { uv, middles: middles.iter().map(map).collect(), points, winding: [0, 0] })
}

/// A point of a loop, the middle of the edge behind it, and the pole that it lies on.
type Mapped = (Uv, Uv, Option<usize>);

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
    fn trace(&mut self, points: &[Point], middles: &[Point]) -> Result<Vec<Mapped>, Unmapped> {
        let mut mapped = Vec::with_capacity(points.len());
        for (p, m) in points.iter().zip(middles) {
            let (uv, pole) = self.map(p)?;
            mapped.push((uv, self.map(m)?.0, pole));
        }
        Ok(mapped)
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
fn unwrap(chart: &Chart, points: &[Point], mapped: &[Mapped], flipped: bool) -> Path {
    let mut path = Path::with_capacity(mapped.len());
    let nearest = |uv: Uv, to: Uv| nearest_image(chart, uv, to);
    let n = mapped.len();
    let mut last = mapped[0].0;
    let mut i = 0;
    while i < n {
        let (raw, middle, pole) = mapped[i];
        if let Some(side) = pole {
            let behind = (i..n).find(|&j| mapped[j].2.is_none());
            let out = behind.map_or(mapped[0].0, |j| mapped[j].0);
            let [enter, leave] = along_pole(chart, side, last, raw, out, flipped);
            let middle = |a: Uv, b: Uv| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
            // The middle into the pole was mapped before; it may be anywhere near it.
            push(&mut path, points[i], enter, middle(enter, leave));
            push(&mut path, points[i], leave, middle(leave, nearest(out, leave)));
            last = nearest(out, leave);
            i = behind.unwrap_or(n);
            continue;
        }
        let uv = nearest(raw, last);
        let next_is_pole = mapped[(i + 1) % n].2.is_some();
        let middle = nearest(middle, uv);
        push(&mut path, points[i], uv, middle);
        last = if next_is_pole { uv } else { middle };
        i += 1;
    }
    let closing = nearest(mapped[0].0, last);
    let turns = |i: usize| chart.periods[i].map_or(0.0, |p| ((closing[i] - path.uv[0][i]) / p).round());
    path.winding = [turns(0) as i32, turns(1) as i32];
    path
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
    use crate::brep::Surface;
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

    #[test]
    fn a_chain_falls_apart_at_its_seams() {
        let along = |edge: u32, forward: bool| EdgeUse { edge: EdgeId(edge), forward };
        // Bottom, seam, top, seam: two rings and one seam.
        let (mut chains, mut seams) = (Vec::new(), Vec::new());
        let wall = vec![along(0, true), along(1, true), along(2, false), along(1, false)];
        split_at_seams(wall, &mut chains, &mut seams);
        chains.sort_by_key(|c| c[0].edge);
        assert_eq!(chains, [[along(0, true)], [along(2, false)]]);
        assert_eq!(seams, [EdgeId(1)]);
    }
}
