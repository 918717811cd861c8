//! Edges -> polylines in space, once for all faces that use them.

use std::f64::consts::TAU;

use super::Options;
use crate::brep::{Curve, EdgeId, Model, Surface};
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::{Point, Vector};
use crate::memory::{empty, held};

/// A curve is halved this often at most.
const MAX_DEPTH: u32 = 9;
/// Segments of an edge on a free-form face at least: straight edges need not be straight in its parameter space.
const FREE_FORM_SEGMENTS: usize = 4;
/// Points of one edge at most.
const MAX_POINTS: usize = 4096;

/// The polylines of all edges of a model in one arena.
#[derive(Default)]
pub(super) struct EdgeLines {
    /// Points on the edges.
    points: Vec<Point>,
    /// The point of the curve half way between a point and the next one of its edge.
    middles: Vec<Point>,
    /// Where the points of each edge begin and end.
    ranges: Vec<[u32; 2]>,
    /// Edges of faces in whose parameter space straight edges need not be straight.
    free_form: Vec<bool>,
    /// Beyond this number of points edges become straight.
    most_points: usize,
    /// The parameters at which the edge at hand is cut.
    parameters: Vec<f64>,
}

/// What the edges of a body are cut by.
#[derive(Clone, Copy)]
pub(super) struct Fineness {
    /// Largest distance between chord and curve, mm.
    pub deflection: f64,
    /// Largest turn of the tangent along a chord, radians.
    pub angle: f64,
}

impl EdgeLines {
    /// Bytes of memory that they hold.
    pub fn bytes(&self) -> usize {
        let points = held(&self.points) + held(&self.middles);
        points + held(&self.ranges) + held(&self.free_form) + held(&self.parameters)
    }

    /// Tessellates the edges; `spans`: where each begins and ends on its curve, `most_points`: of all together.
    pub fn fill(
        &mut self,
        model: &Model,
        spans: &[Option<[f64; 2]>],
        fineness: &Fineness,
        most_points: usize,
        cancel: &Cancel,
    ) -> Result<(), Cancelled> {
        empty(&mut self.points, 4 * spans.len());
        empty(&mut self.middles, 4 * spans.len());
        empty(&mut self.ranges, spans.len());
        self.most_points = most_points;
        mark_edges_of_free_form_faces(model, &mut self.free_form);
        for (index, span) in spans.iter().enumerate() {
            cancel.check()?;
            let range = self.add(model, EdgeId(index as u32), *span, fineness);
            self.ranges.push(range);
        }
        Ok(())
    }

    /// Points of all edges.
    pub fn count(&self) -> usize {
        self.points.len()
    }

    /// Points and middles of an edge; the last middle repeats the last point.
    pub fn line(&self, edge: EdgeId) -> (&[Point], &[Point]) {
        let range = self.ranges[edge.index()].map(|i| i as usize);
        (&self.points[range[0]..range[1]], &self.middles[range[0]..range[1]])
    }

    /// What is to be said where there were too many points.
    pub fn warning(&self) -> Option<String> {
        let full = self.points.len() > self.most_points;
        full.then(|| format!("the edges have more than {} points: some were taken as straight", self.most_points))
    }

    /// Tessellates an edge again.
    pub fn replace(&mut self, model: &Model, edge: EdgeId, span: Option<[f64; 2]>, fineness: &Fineness) {
        self.ranges[edge.index()] = self.add(model, edge, span, fineness);
    }

    fn add(&mut self, model: &Model, id: EdgeId, span: Option<[f64; 2]>, fineness: &Fineness) -> [u32; 2] {
        let [start, end] = model.ends(id);
        let first = self.points.len();
        let least = if self.free_form[id.index()] { FREE_FORM_SEGMENTS } else { 1 };
        match (&model.edges[id.index()].curve, span) {
            (Some(curve), Some([from, to])) if !matches!(**curve, Curve::Line { .. }) && first <= self.most_points => {
                self.follow(curve, [from, to], fineness, least);
                let last = self.points.len() - 1;
                self.points[first] = start;
                self.points[last] = end;
                self.middles[last] = end;
            }
            _ => self.straight(&start, &end, least),
        }
        [first as u32, self.points.len() as u32]
    }

    fn straight(&mut self, start: &Point, end: &Point, segments: usize) {
        let step = (end - start) / segments as f64;
        for i in 0..=segments {
            self.points.push(if i == segments { *end } else { start + step * i as f64 });
            self.middles.push(start + step * (i as f64 + 0.5).min(segments as f64));
        }
    }

    fn follow(&mut self, curve: &Curve, span: [f64; 2], fineness: &Fineness, least: usize) {
        let period = curve.period();
        let at = |t: f64| curve.point(curve.wrap(t, period));
        let out = &mut self.parameters;
        out.clear();
        match curve {
            Curve::Circle { radius, .. } => conic_parameters(span, *radius, fineness, least, out),
            Curve::Ellipse { semi_x, semi_y, .. } => conic_parameters(span, semi_x.max(*semi_y), fineness, least, out),
            _ => adaptive_parameters(curve, span, period, fineness, least, out),
        }
        for pair in self.parameters.windows(2) {
            self.points.push(at(pair[0]));
            self.middles.push(at(0.5 * (pair[0] + pair[1])));
        }
        let last = at(span[1]);
        self.points.push(last);
        self.middles.push(last);
    }
}

fn mark_edges_of_free_form_faces(model: &Model, flags: &mut Vec<bool>) {
    empty(flags, model.edges.len());
    flags.resize(model.edges.len(), false);
    for face in &model.faces {
        let Some((surface, _)) = model.surface_of(face) else { continue };
        if matches!(
            surface,
            Surface::Nurbs(_) | Surface::Revolution { .. } | Surface::Extrusion { .. } | Surface::Offset { .. }
        ) {
            face.loops.iter().flat_map(|l| &l.uses).for_each(|u| flags[u.edge.index()] = true);
        }
    }
}

/// The largest step of the angle on a circle of radius `radius`.
pub(super) fn angular_step(radius: f64, fineness: &Fineness) -> f64 {
    let share = (fineness.deflection / radius.abs().max(f64::MIN_POSITIVE)).min(1.0);
    fineness.angle.min(2.0 * (1.0 - share).acos()).max(2e-3)
}

/// Equal steps of the angle: whatever the pose, the same points. A whole turn is cut into quarters, so that it stays its
/// own mirror image.
fn conic_parameters(span: [f64; 2], radius: f64, fineness: &Fineness, least: usize, out: &mut Vec<f64>) {
    let width = span[1] - span[0];
    let count = ((width.abs() / angular_step(radius, fineness) - 1e-9).ceil() as usize).clamp(least, MAX_POINTS);
    let count = if width.abs() > TAU - 1e-9 { count.next_multiple_of(4) } else { count };
    let step = width / count as f64;
    out.extend((0..=count).map(|i| span[0] + step * i as f64));
}

/// Halves the pieces between the curve's breaks until chord and tangents are near enough.
fn adaptive_parameters(
    curve: &Curve,
    span: [f64; 2],
    period: Option<f64>,
    fineness: &Fineness,
    least: usize,
    parameters: &mut Vec<f64>,
) {
    let piece = Piece { curve, period, fineness };
    let stops = stops(curve, span, period);
    let pieces = (least.max(2) / (stops.len() - 1).max(1)).max(1);
    parameters.push(span[0]);
    for pair in stops.windows(2) {
        for i in 0..pieces {
            let share = |i: usize| pair[0] + (pair[1] - pair[0]) * i as f64 / pieces as f64;
            let ends = [share(i), share(i + 1)];
            piece.halve(ends, ends.map(|t| piece.start(t)), MAX_DEPTH, parameters);
        }
        if parameters.len() > MAX_POINTS {
            break;
        }
    }
    *parameters.last_mut().expect("it starts with one") = span[1];
}

/// The ends of the span and the breaks of the curve between them, in order along the span.
fn stops(curve: &Curve, [from, to]: [f64; 2], period: Option<f64>) -> Vec<f64> {
    let (low, high) = (from.min(to), from.max(to));
    let clear = 1e-9 * (high - low);
    let mut stops = vec![low, high];
    let breaks = curve.breaks();
    for turn in if period.is_some() { -2..=2 } else { 0..=0 } {
        let shift = period.unwrap_or(0.0) * f64::from(turn);
        stops.extend(breaks.iter().map(|t| t + shift).filter(|t| *t > low + clear && *t < high - clear));
    }
    stops.sort_by(f64::total_cmp);
    if from > to {
        stops.reverse();
    }
    stops
}

/// What a piece of a curve is cut by.
struct Piece<'a> {
    curve: &'a Curve,
    period: Option<f64>,
    fineness: &'a Fineness,
}

impl Piece<'_> {
    /// Point and tangent.
    fn start(&self, t: f64) -> [Vector; 2] {
        let [p, d, _] = self.curve.derivatives(self.curve.wrap(t, self.period));
        [p, d]
    }

    /// Adds the end of the piece from `a` to `b`, whose points and tangents are given, after what is needed before it.
    fn halve(&self, [a, b]: [f64; 2], [[p, d], [r, e]]: [[Vector; 2]; 2], depth: u32, out: &mut Vec<f64>) {
        let m = 0.5 * (a + b);
        let direction = (r - p).try_normalize(f64::MIN_POSITIVE).unwrap_or_default();
        let at = |t: f64| self.curve.point(self.curve.wrap(t, self.period)).coords;
        // The quarters as well: an S crosses its chord in the middle.
        let off =
            [0.25, 0.5, 0.75].map(|s| at(a + s * (b - a)) - p).map(|q| (q - direction * direction.dot(&q)).norm());
        let off = off.into_iter().fold(0.0, f64::max);
        let Fineness { deflection, angle } = *self.fineness;
        let bent = off > 0.05 * deflection && d.cross(&e).norm().atan2(d.dot(&e)) > angle;
        if depth > 0 && (off > deflection || bent) {
            let middle = self.start(m);
            self.halve([a, m], [[p, d], middle], depth - 1, out);
            self.halve([m, b], [middle, [r, e]], depth - 1, out);
        } else {
            out.push(b);
        }
    }
}

/// How fine the edges and faces of a model of the given size are cut.
impl Fineness {
    pub fn new(options: &Options, size: f64) -> Self {
        Self { deflection: options.deflection * size, angle: options.angle }
    }

    /// With chords so many times as long.
    pub fn coarser(self, times: f64) -> Self {
        Self { deflection: self.deflection * times * times, angle: self.angle * times }
    }
}
