//! How many steps a free-form surface needs along u and v, from samples of it.

use super::chart::{Chart, MAX_LINES};
use super::edges::Fineness;
use crate::brep::Surface;
use crate::brep::surface::Jet;
use crate::geometry::{Point, Vector};

/// Where rows of samples are taken, as shares of the other direction.
const LINES: [f64; 4] = [0.0, 0.35, 0.65, 1.0];
/// How far a row may bend within the surface between two steps, as a share of the distance to the next row: triangles
/// between rows that bend more fold over, however flat the surface is.
const SIDEWAYS: f64 = 0.25;

/// Bows smaller than this share of the deflection are too small for the turn of the normal to matter, as for edges.
const HARDLY: f64 = 0.05;

/// How far the rows of samples in one direction are from straight.
#[derive(Clone, Copy, Default)]
struct Bend {
    /// Steps in which the rows were sampled.
    samples: f64,
    /// Largest distance of a sample from the middle of its neighbours along the normal, mm.
    sagitta: f64,
    /// The same across the row within the surface.
    sideways: f64,
    /// Largest angle between the normals of a sample's neighbours.
    angle: f64,
    /// Length of the shortest row, mm.
    length: f64,
}

/// From second differences and turns of the normal on a coarse grid over the rectangle [u0, u1, v0, v1].
pub(super) fn sampled_steps(chart: &Chart, rectangle: [f64; 4], fineness: &Fineness) -> [usize; 2] {
    let [u0, u1, v0, v1] = rectangle;
    let samples = samples(chart, rectangle);
    let at = |s: f64, t: f64| chart.tangents([u0 + s * (u1 - u0), v0 + t * (v1 - v0)]);
    let along_u = Bend::of(samples[0], &at);
    if chart.surface.is_ruled_along_v() {
        return [whole(along_u.need(fineness)), 1];
    }
    let along_v = Bend::of(samples[1], &|s, t| at(t, s));
    let twist = twist_need([at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(1.0, 1.0)].map(|j| j.point), fineness);
    let [nu, nv] = [along_u, along_v].map(|bend| bend.need(fineness).max(twist));
    [
        nu.max(along_u.need_sideways(along_v.length / nv, fineness)),
        nv.max(along_v.need_sideways(along_u.length / nu, fineness)),
    ]
    .map(whole)
}

/// In how many steps to sample each direction: twice for each knot span that the rectangle covers.
fn samples(chart: &Chart, [u0, u1, v0, v1]: [f64; 4]) -> [usize; 2] {
    let spans = match &*chart.surface {
        Surface::Nurbs(nurbs) => nurbs.spans(),
        Surface::Extrusion { profile, .. } => [profile.breaks().len().max(4), 1],
        Surface::Revolution { profile, .. } => [4, profile.breaks().len().max(4)],
        _ => [4, 4],
    };
    let [d0, d1, e0, e1] = chart.domain;
    let covered = [(u1 - u0) / (d1 - d0), (v1 - v0) / (e1 - e0)];
    let count = |axis: usize| {
        let share = if covered[axis] > 0.0 { covered[axis].min(1.0) } else { 1.0 };
        ((2.0 * share * spans[axis] as f64).ceil() as usize + 2).clamp(8, MAX_LINES / 4)
    };
    [count(0), count(1)]
}

fn whole(need: f64) -> usize {
    if need.is_finite() { need.ceil().clamp(1.0, MAX_LINES as f64) as usize } else { 1 }
}

impl Bend {
    fn of(samples: usize, jet: &dyn Fn(f64, f64) -> Jet) -> Self {
        let mut bend = Self { samples: samples as f64, length: f64::INFINITY, ..Self::default() };
        for line in LINES {
            let row: Vec<Jet> = (0..=samples).map(|i| jet(i as f64 / samples as f64, line)).collect();
            bend.add(&row);
        }
        bend
    }

    fn add(&mut self, row: &[Jet]) {
        for three in row.windows(3) {
            let bow = (three[0].point.coords + three[2].point.coords) * 0.5 - three[1].point.coords;
            let normal = three[1].normal().try_normalize(f64::MIN_POSITIVE).unwrap_or_else(Vector::zeros);
            let along =
                (three[2].point - three[0].point).try_normalize(f64::MIN_POSITIVE).unwrap_or_else(Vector::zeros);
            self.sagitta = self.sagitta.max(bow.dot(&normal).abs());
            self.sideways = self.sideways.max(bow.dot(&normal.cross(&along)).abs());
            let (a, b) = (three[0].normal(), three[2].normal());
            if a.norm() > 0.0 && b.norm() > 0.0 {
                self.angle = self.angle.max(a.cross(&b).norm().atan2(a.dot(&b)));
            }
        }
        let length = row.windows(2).map(|w| (w[1].point - w[0].point).norm()).sum();
        self.length = self.length.min(length);
    }

    /// Steps for the deflection and for the angle of the normals, unless those turn where nothing is to be seen.
    fn need(&self, fineness: &Fineness) -> f64 {
        let by_angle = 0.5 * self.samples * self.angle / fineness.angle;
        let seen = self.steps(self.sagitta, HARDLY * fineness.deflection);
        self.steps(self.sagitta, fineness.deflection).max(by_angle.min(seen)).clamp(1.0, MAX_LINES as f64)
    }

    /// Steps so that no triangle folds over between rows that are `apart` mm from each other.
    fn need_sideways(&self, apart: f64, fineness: &Fineness) -> f64 {
        self.steps(self.sideways, (SIDEWAYS * apart).max(fineness.deflection))
    }

    /// Bows shrink with the square of the steps.
    fn steps(&self, bow: f64, most: f64) -> f64 {
        0.5 * self.samples * (bow / most).sqrt()
    }
}

/// How many steps in each direction a surface needs whose corners do not lie in a plane: the diagonals of a cell are
/// apart by a quarter of the second mixed difference, whatever rows and columns look like.
fn twist_need([a, b, c, d]: [Point; 4], fineness: &Fineness) -> f64 {
    let apart = (a.coords - b.coords - c.coords + d.coords) * 0.25;
    let normal = (d - a).cross(&(c - b)).try_normalize(f64::MIN_POSITIVE).unwrap_or_else(Vector::zeros);
    let need = (apart.dot(&normal).abs() / fineness.deflection).sqrt();
    if need.is_finite() { need } else { 1.0 }
}
