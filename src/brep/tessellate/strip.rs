//! Faces that go round their surface: the parameter space is cut open along one line (two on a torus) and the paths
//! are wrapped into the strip between the line and its image one period on.

use rustc_hash::FxHashMap;

use super::bands::band;
use super::boundary::Path;
use super::chart::{Chart, Uv};
use super::domain::{Patch, crosses_below, fill};
use super::edges::Fineness;
use super::interior::Grid;
use super::rings::between_two_rings;
use crate::geometry::Point;

/// How far beside a path or seam it is looked whether the face is there, as a share of a period or of a segment.
const NUDGE: f64 = 1e-4;
/// Cut lines tried besides points of the paths.
const EVEN_CANDIDATES: usize = 16;
/// How far a cut line stays away from paths that it need not touch, as a share of the period: a path that wavers about
/// it would fall to both sides of the strip.
const CLEARANCE: f64 = 1e-3;
/// Cut lines tried at most.
const MAX_CANDIDATES: usize = 200;

/// See the module; `None` where the paths bound nothing finite.
pub(super) fn triangulate(
    chart: &Chart,
    paths: &[Path],
    fineness: &Fineness,
    quick: bool,
    patch: &mut Patch,
) -> Option<()> {
    let along = (0..2)
        .find(|&a| paths.iter().any(|p| p.winding[a] != 0))
        .or_else(|| (0..2).find(|&a| chart.periods[a].is_some()))?;
    chart.periods[along]?;
    if quick && between_two_rings(chart, paths, fineness, patch).is_some() {
        return Some(());
    }
    if (quick || !chart.surface.is_ruled_along_v()) && band(chart, paths, fineness, patch).is_some() {
        return Some(());
    }
    let mut strip = Strip::new(chart, along, paths)?;
    paths.iter().for_each(|p| strip.wrap_path(chart, p));
    strip.orient(chart, paths)?;
    let rectangle = strip.rectangle(chart)?;
    let steps = chart.steps(rectangle, fineness).map(|n| n.max(2));
    let ruled = chart.surface.is_ruled_along_v();
    let mut cells = if ruled { Grid::rows_for_shape(rectangle, steps, chart.scale(rectangle)) } else { steps };
    cells[along] = cells[along].max(6);
    let scale = chart.metric(rectangle, cells);
    let mut grid = Grid::new(rectangle, cells);
    strip.pieces.iter().for_each(|[a, b]| grid.block(a, b));
    (0..2).filter(|&axis| strip.cuts[axis].is_some()).for_each(|axis| grid.join_sides(axis));
    *patch = std::mem::take(&mut strip.patch);
    let [low, high] = strip.open_ends();
    let held = |uv: &Uv| uv[1 - along] > low && uv[1 - along] < high;
    grid.nodes(true).filter(held).for_each(|uv| patch.add(chart, uv));
    patch.sides = paths.iter().map(|p| strip.side_of(p, chart)).collect();
    fill(chart, patch, &strip.segments, scale, |p| strip.inside(p))
}

/// A parameter space cut open.
struct Strip {
    /// The periodic coordinate along which rays are not cast.
    along: usize,
    /// Where each periodic direction is cut.
    cuts: [Option<f64>; 2],
    periods: [f64; 2],
    patch: Patch,
    /// Wrapped segments, as positions and as indices into the patch.
    pieces: Vec<[Uv; 2]>,
    segments: Vec<[u32; 2]>,
    known: FxHashMap<[u64; 2], u32>,
    /// Where paths cross the lower side of the strip on a torus.
    crossings: Vec<f64>,
    /// The lower end (or the corner, on a torus) is inside.
    base: bool,
    /// How often paths go round.
    turns: i32,
}

/// A segment with its ends in space.
#[derive(Clone, Copy)]
struct Piece {
    uv: [Uv; 2],
    points: [Point; 2],
}

impl Strip {
    fn new(chart: &Chart, along: usize, paths: &[Path]) -> Option<Self> {
        let up = 1 - along;
        let mut cuts = [None; 2];
        cuts[along] = Some(best_cut(chart, along, paths)?);
        if chart.periods[up].is_some() {
            cuts[up] = Some(best_cut(chart, up, paths)?);
        }
        Some(Self {
            along,
            cuts,
            periods: chart.periods.map(|p| p.unwrap_or(0.0)),
            patch: Patch::default(),
            pieces: Vec::new(),
            segments: Vec::new(),
            known: FxHashMap::default(),
            crossings: Vec::new(),
            base: false,
            turns: paths.iter().map(|p| p.winding[along]).sum(),
        })
    }

    fn wrap_path(&mut self, chart: &Chart, path: &Path) {
        for i in 0..path.uv.len() {
            let [a, _, b] = path.segment(i, chart.periods);
            let points = [path.points[i], path.points[(i + 1) % path.points.len()]];
            let mut pieces = vec![Piece { uv: [a, b], points }];
            for axis in 0..2 {
                if let Some(cut) = self.cuts[axis] {
                    pieces = pieces.into_iter().flat_map(|p| self.split(p, axis, cut)).collect();
                }
            }
            pieces.iter().for_each(|p| self.add_piece(p));
        }
    }

    /// Cuts a segment where it crosses the cut line or its images, and moves the parts into the strip.
    fn split(&mut self, piece: Piece, axis: usize, cut: f64) -> Vec<Piece> {
        let period = self.periods[axis];
        let snap = |t: f64| if (t - t.round()).abs() < 1e-9 { t.round() } else { t };
        let [ta, tb] = piece.uv.map(|uv| snap((uv[axis] - cut) / period));
        let mut shares = vec![0.0];
        let (low, high) = (ta.min(tb), ta.max(tb));
        let mut k = low.floor() + 1.0;
        while k < high {
            shares.push((k - ta) / (tb - ta));
            k += 1.0;
        }
        shares.push(1.0);
        shares.sort_by(f64::total_cmp);
        if axis != self.along && ta.floor() != tb.floor() {
            self.note_crossings(&piece, ta, tb);
        }
        shares.windows(2).map(|s| self.part(&piece, [s[0], s[1]], axis, cut, [ta, tb])).collect()
    }

    /// The points on the lower side of the strip that a segment passes through (a point on the line lies above it).
    fn note_crossings(&mut self, piece: &Piece, ta: f64, tb: f64) {
        let (low, high) = (ta.min(tb), ta.max(tb));
        let mut k = low.floor() + 1.0;
        while k <= high {
            let s = (k - ta) / (tb - ta);
            let (a, b) = (piece.uv[0][self.along], piece.uv[1][self.along]);
            self.crossings.push(a + s * (b - a));
            k += 1.0;
        }
    }

    fn part(&self, piece: &Piece, shares: [f64; 2], axis: usize, cut: f64, [ta, tb]: [f64; 2]) -> Piece {
        let cell = (ta + 0.5 * (shares[0] + shares[1]) * (tb - ta)).floor();
        let end = |s: f64| {
            let mix = |a: f64, b: f64| {
                if s == 0.0 {
                    a
                } else if s == 1.0 {
                    b
                } else {
                    a + s * (b - a)
                }
            };
            let [a, b] = piece.uv;
            let mut uv = [mix(a[0], b[0]), mix(a[1], b[1])];
            let t = mix(ta, tb) - cell;
            uv[axis] = if t.abs() < 1e-9 {
                cut
            } else if (t - 1.0).abs() < 1e-9 {
                cut + self.periods[axis]
            } else {
                uv[axis] - cell * self.periods[axis]
            };
            let point = match s {
                0.0 => piece.points[0],
                1.0 => piece.points[1],
                _ => piece.points[0] + (piece.points[1] - piece.points[0]) * s,
            };
            (uv, point)
        };
        let ((a, p), (b, q)) = (end(shares[0]), end(shares[1]));
        Piece { uv: [a, b], points: [p, q] }
    }

    fn add_piece(&mut self, piece: &Piece) {
        let ends = [0, 1].map(|k| self.vertex(piece.uv[k], piece.points[k]));
        if ends[0] != ends[1] {
            self.segments.push(ends);
            self.pieces.push(piece.uv);
        }
    }

    /// The vertex at a place; one on a cut line is put on both sides of the strip.
    fn vertex(&mut self, uv: Uv, point: Point) -> u32 {
        for axis in 0..2 {
            let Some(cut) = self.cuts[axis] else { continue };
            let far = cut + self.periods[axis];
            let twin = if uv[axis] == cut {
                far
            } else if uv[axis] == far {
                cut
            } else {
                continue;
            };
            let mut other = uv;
            other[axis] = twin;
            self.vertex_once(other, point);
        }
        self.vertex_once(uv, point)
    }

    fn vertex_once(&mut self, uv: Uv, point: Point) -> u32 {
        // The same point may be reached with another number of periods added and taken away again.
        let key = [0, 1].map(|axis| match self.cuts[axis] {
            Some(cut) => ((uv[axis] - cut) / self.periods[axis] * 1e10).round() as i64 as u64,
            None => (uv[axis] + 0.0).to_bits(),
        });
        let patch = &mut self.patch;
        *self.known.entry(key).or_insert_with(|| {
            patch.points.push(point);
            patch.uv.push(uv);
            patch.uv.len() as u32 - 1
        })
    }

    /// Counts crossings from the lower end, without regard to what that end is.
    fn odd(&self, p: &Uv) -> bool {
        let below = self.pieces.iter().filter(|[a, b]| crosses_below(a, b, p, self.along)).count();
        let cut = self.cuts[self.along].unwrap_or(0.0);
        let wrapped = |x: f64| cut + (x - cut).rem_euclid(self.periods[self.along]);
        let beside = self.crossings.iter().filter(|x| wrapped(**x) < p[self.along]).count();
        (below + beside) % 2 == 1
    }

    fn inside(&self, p: &Uv) -> bool {
        self.odd(p) != self.base
    }

    /// Finds out whether the lower end is inside: ends that are not poles are outside; else the direction of the
    /// paths tells.
    fn orient(&mut self, chart: &Chart, paths: &[Path]) -> Option<()> {
        let up = 1 - self.along;
        let odd_turns = paths.iter().map(|p| p.winding[self.along]).sum::<i32>() % 2 != 0;
        let (low, high) = (chart.poles[2 * up], chart.poles[2 * up + 1]);
        self.base = match (self.cuts[up].is_some(), low, high) {
            (false, false, false) if odd_turns => return None,
            (false, false, _) => false,
            (false, true, false) => odd_turns,
            _ => self.base_by_direction(chart, paths),
        };
        Some(())
    }

    /// Seams lie inside. Where there are none each path votes with its length.
    fn base_by_direction(&self, chart: &Chart, paths: &[Path]) -> bool {
        let votes: i32 = chart.inner().map(|uv| if self.odd(&self.nudged(uv)) { -1 } else { 1 }).sum();
        if votes != 0 {
            return votes > 0;
        }
        let vote = |path: &Path| {
            let left_is_odd = self.left_of(path, chart).is_some_and(|p| self.odd(&p));
            let wanted_odd = left_is_odd != chart.flipped;
            let weight = path.uv.len() as f64;
            if wanted_odd { weight } else { -weight }
        };
        paths.iter().map(vote).sum::<f64>() < 0.0 || paths.is_empty()
    }

    /// The place in the strip, a little beside the given one: seams end at corners of the paths.
    fn nudged(&self, mut uv: Uv) -> Uv {
        uv[self.along] += NUDGE * self.periods[self.along];
        self.wrap(uv)
    }

    fn wrap(&self, mut uv: Uv) -> Uv {
        for (axis, x) in uv.iter_mut().enumerate() {
            if let Some(cut) = self.cuts[axis] {
                *x = cut + (*x - cut).rem_euclid(self.periods[axis]);
            }
        }
        uv
    }

    /// A point just left of the path's longest segment, in the strip.
    fn left_of(&self, path: &Path, chart: &Chart) -> Option<Uv> {
        let scale = [0, 1].map(|axis| if self.periods[axis] > 0.0 { self.periods[axis] } else { 1.0 });
        let length = |i: &usize| {
            let [a, _, b] = path.segment(*i, chart.periods);
            ((b[0] - a[0]) / scale[0]).hypot((b[1] - a[1]) / scale[1])
        };
        let i = (0..path.uv.len()).max_by(|a, b| length(a).total_cmp(&length(b)))?;
        let [a, _, b] = path.segment(i, chart.periods);
        let d = [b[0] - a[0], b[1] - a[1]];
        let left = [-d[1] * scale[0] / scale[1], d[0] * scale[1] / scale[0]];
        let beside = |axis: usize| 0.5 * (a[axis] + b[axis]) + NUDGE * left[axis];
        Some(self.wrap([beside(0), beside(1)]))
    }

    fn side_of(&self, path: &Path, chart: &Chart) -> f64 {
        if self.left_of(path, chart).is_some_and(|p| self.inside(&p)) { 1.0 } else { -1.0 }
    }

    /// The part of the strip that holds the face.
    fn rectangle(&self, chart: &Chart) -> Option<[f64; 4]> {
        let mut rectangle = super::boundary::rectangle(self.patch.uv.iter());
        let up = 1 - self.along;
        for axis in 0..2 {
            if let Some(cut) = self.cuts[axis] {
                rectangle[2 * axis] = cut;
                rectangle[2 * axis + 1] = cut + self.periods[axis];
            }
        }
        if self.cuts[up].is_none() {
            let high_inside = self.base != (self.turns % 2 != 0);
            if self.base {
                rectangle[2 * up] = chart.domain[2 * up];
            }
            if high_inside {
                rectangle[2 * up + 1] = chart.domain[2 * up + 1];
            }
        }
        rectangle.iter().all(|x| x.is_finite()).then_some(rectangle)
    }

    /// The ends of the strip that no pole closes, beyond which there is no face: at the outermost paths.
    fn open_ends(&self) -> [f64; 2] {
        let up = 1 - self.along;
        let high_inside = self.base != (self.turns % 2 != 0);
        let ends = super::boundary::rectangle(self.pieces.iter().flatten());
        let open = self.cuts[up].is_none();
        let low = if open && !self.base { ends[2 * up] } else { f64::NEG_INFINITY };
        let high = if open && !high_inside { ends[2 * up + 1] } else { f64::INFINITY };
        [low, high]
    }
}

/// A cut line that crosses few paths, through a point of each path that goes round and well clear of the others.
fn best_cut(chart: &Chart, axis: usize, paths: &[Path]) -> Option<f64> {
    let period = chart.periods[axis]?;
    let start = chart.domain[2 * axis];
    let all = paths.iter().flat_map(|p| p.uv.iter().map(|uv| uv[axis]));
    let count = paths.iter().map(|p| p.uv.len()).sum::<usize>();
    let evenly = (0..EVEN_CANDIDATES).map(|k| start + period * k as f64 / EVEN_CANDIDATES as f64);
    let candidates = all.step_by(count.div_ceil(MAX_CANDIDATES).max(1)).chain(evenly);
    let cost = |cut: f64| {
        let one = |path: &Path| {
            let rest = |uv: &Uv| ((uv[axis] - cut) / period).rem_euclid(1.0);
            if path.winding[axis] != 0 {
                return if path.uv.iter().any(|uv| rest(uv).min(1.0 - rest(uv)) < 1e-9) { 0.0 } else { 0.1 };
            }
            let r = path.rectangle();
            let clear = |by: f64| {
                ((r[2 * axis] - cut) / period - by).floor() == ((r[2 * axis + 1] - cut) / period + by).floor()
            };
            if clear(CLEARANCE) {
                0.0
            } else if clear(1e-9) {
                0.01
            } else {
                1.0
            }
        };
        paths.iter().map(one).sum::<f64>()
    };
    let priced = candidates.map(|c| (cost(c), c));
    priced.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, c)| start + (c - start).rem_euclid(period))
}
