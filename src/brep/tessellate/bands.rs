//! The band between two level rings that go round a surface once each, or between one of them and a pole: rows of
//! points, and strips of triangles between neighbouring rows. Most fillets, bent tubes and balls are nothing else, and
//! need neither a cut nor a Delaunay triangulation.

use super::Few;
use super::boundary::{Path, rectangle};
use super::chart::{Chart, Uv};
use super::domain::Patch;
use super::edges::Fineness;
use super::rings::{Chain, WIDEST, add_ring, add_wall, level, sides};

/// How far a ring may waver, as a share of the distance to the next row.
const LEVEL: f64 = 0.05;
/// Points of one band at most.
const MOST_POINTS: usize = 20_000;
/// Columns of a band at least.
const LEAST_COLUMNS: usize = 6;

/// The band, where the paths bound one on the side that their direction tells and no seam contradicts.
pub(super) fn band(chart: &Chart, paths: &[Path], fineness: &Fineness, patch: &mut Patch) -> Option<()> {
    let along = (0..2).find(|&axis| paths.iter().any(|p| p.winding[axis] != 0))?;
    let rings: Few<Path> = paths.iter().map(|p| turned(p, along)).collect();
    let band = Band::of(chart, &rings, along)?;
    let steps = chart.steps(band.rectangle(along), fineness);
    let (columns, rows) = (steps[along].max(LEAST_COLUMNS), steps[1 - along]);
    let apart = (band.to - band.from) / rows as f64;
    if columns * rows > MOST_POINTS || rings.iter().any(|ring| waver(ring) > LEVEL * apart) {
        return None;
    }
    patch.clear();
    let [lower, upper] = [(band.lower, band.from), (band.upper, band.to)]
        .map(|(ring, height)| ring.map(|ring| band.add_ring(patch, ring, height)));
    let places = band.columns(patch, [&lower, &upper], columns);
    if places.len() * rows > MOST_POINTS {
        return None;
    }
    let mut below = lower.unwrap_or_else(|| add_row(patch, chart, along, &places, band.from));
    for row in 1..=rows {
        let above = match &upper {
            Some(upper) if row == rows => upper.clone(),
            None if row == rows => add_row(patch, chart, along, &places, band.to),
            _ => add_row(patch, chart, along, &places, band.from + apart * row as f64),
        };
        add_wall(patch, &below, &above, f64::INFINITY)?;
        below = above;
    }
    patch.uv.iter_mut().for_each(|st| *st = back(*st, along));
    patch.sides = sides(&rings, band.lower);
    Some(())
}

/// The parameters as (s, t), s being the one along which the rings run, turned so that left stays left.
fn turn([u, v]: Uv, along: usize) -> Uv {
    if along == 0 { [u, v] } else { [v, -u] }
}

/// The parameters (u, v) of a place (s, t).
fn back([s, t]: Uv, along: usize) -> Uv {
    if along == 0 { [s, t] } else { [-t, s] }
}

/// A path in (s, t), without its middles.
fn turned(path: &Path, along: usize) -> Path {
    let [a, b] = path.winding;
    let winding = if along == 0 { [a, b] } else { [b, -a] };
    let uv = path.uv.iter().map(|&uv| turn(uv, along)).collect();
    Path { points: path.points.clone(), uv, middles: Vec::new(), winding }
}

fn waver(ring: &Path) -> f64 {
    let [_, _, low, high] = rectangle(ring.uv.iter());
    high - low
}

/// What a band lies between: a ring, or a pole where there is none.
struct Band<'a> {
    lower: Option<&'a Path>,
    upper: Option<&'a Path>,
    /// Heights of the two.
    from: f64,
    to: f64,
    /// Where the first column lies, and after how much the surface repeats along the rings.
    start: f64,
    period: f64,
}

impl<'a> Band<'a> {
    fn of(chart: &Chart, rings: &'a [Path], along: usize) -> Option<Self> {
        let (period, across) = (chart.periods[along]?, chart.periods[1 - along]);
        if rings.iter().any(|r| r.winding[0].abs() != 1 || r.winding[1] != 0) {
            return None;
        }
        let is_lower = |ring: &Path| (ring.winding[0] > 0) != chart.flipped;
        let (lower, upper) = match rings {
            [one] if is_lower(one) => (Some(one), None),
            [one] => (None, Some(one)),
            [a, b] if is_lower(a) && !is_lower(b) => (Some(a), Some(b)),
            [a, b] if is_lower(b) && !is_lower(a) => (Some(b), Some(a)),
            _ => return None,
        };
        let pole = |side: usize| (along == 0 && chart.poles[side]).then_some(chart.domain[side]);
        let from = lower.map(level).or_else(|| pole(2))?;
        let to = upper.map(level).or_else(|| pole(3))?;
        let ahead = |t: f64| across.map_or(t, |period| from + (t - from).rem_euclid(period));
        let to = ahead(to);
        let inside = |uv: Uv| (from..to).contains(&ahead(turn(uv, along)[1]));
        let fits = to > from && (to - from).is_finite() && chart.inner().all(inside);
        fits.then_some(Self { lower, upper, from, to, start: rings[0].uv[0][0], period })
    }

    /// The rectangle [u0, u1, v0, v1] of the band.
    fn rectangle(&self, along: usize) -> [f64; 4] {
        let [s0, s1] = [self.start, self.start + self.period];
        if along == 0 { [s0, s1, self.from, self.to] } else { [-self.to, -self.from, s0, s1] }
    }

    /// Adds a ring, moved by whole periods to the height where it is needed.
    fn add_ring(&self, patch: &mut Patch, ring: &Path, height: f64) -> Chain {
        let (chain, by) = (add_ring(patch, ring, self.period, self.start), height - level(ring));
        // Not at all, rather than by what rounding leaves.
        if by.abs() > 1e-6 {
            chain.clone().for_each(|i| patch.uv[i as usize][1] += by);
        }
        chain
    }

    /// Where the columns between the rings lie: at the points of the denser ring where these suffice.
    fn columns(&self, patch: &Patch, rings: [&Option<Chain>; 2], least: usize) -> Vec<f64> {
        match rings.into_iter().flatten().max_by_key(|chain| chain.len()) {
            Some(chain) if suffices(patch, chain, WIDEST * self.period / least as f64) => {
                chain.clone().map(|i| patch.uv[i as usize][0]).collect()
            }
            _ => (0..=least).map(|k| self.start + self.period * k as f64 / least as f64).collect(),
        }
    }
}

/// Whether no two neighbours of a chain are farther apart than `widest`.
fn suffices(patch: &Patch, chain: &Chain, widest: f64) -> bool {
    let points = &patch.uv[chain.start as usize..chain.end as usize];
    points.windows(2).all(|pair| (pair[1][0] - pair[0][0]).abs() <= widest)
}

/// Adds a row of points, the first one repeated at the end.
fn add_row(patch: &mut Patch, chart: &Chart, along: usize, places: &[f64], t: f64) -> Chain {
    let from = patch.uv.len();
    for &s in places {
        patch.uv.push([s, t]);
        patch.points.push(chart.point(back([s, t], along)));
    }
    let last = patch.points.len() - 1;
    patch.points[last] = patch.points[from];
    from as u32..last as u32 + 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::tessellate::integrate::{Sides, integrate};
    use crate::brep::{Placement, Surface};
    use crate::geometry::{Point, Vector};
    use std::f64::consts::{FRAC_PI_2, PI, TAU};

    const FINENESS: Fineness = Fineness { deflection: 1.0, angle: 0.35 };

    fn axes() -> Placement {
        Placement { origin: Point::origin(), x: Vector::x(), y: Vector::y(), z: Vector::z() }
    }

    /// Twenty points round the surface at `v`.
    fn ring(chart: &Chart, v: f64, forward: bool) -> Path {
        let sign = if forward { 1.0 } else { -1.0 };
        let at = |i: f64| [sign * TAU * i / 20.0, v];
        let uv: Vec<Uv> = (0..20).map(|i| at(f64::from(i))).collect();
        let points = uv.iter().map(|&uv| chart.point(uv)).collect();
        let middles = (0..20).map(|i| at(f64::from(i) + 0.5)).collect();
        Path { points, uv, middles, winding: [if forward { 1 } else { -1 }, 0] }
    }

    fn area(chart: &Chart, paths: &[Path]) -> Option<f64> {
        let mut patch = Patch::default();
        band(chart, paths, &FINENESS, &mut patch)?;
        Some(integrate(chart, &patch, paths, &Point::origin(), &mut Sides::default()).area)
    }

    #[test]
    fn a_band_lies_on_the_left_of_its_lower_ring() {
        let surface = Surface::Torus { placement: axes(), major: 3.0, minor: 1.0 };
        let inner = [surface.point(0.0, PI)];
        let mut chart = Chart::new(&surface, true, &[], 1.0);
        let rings = |forward: bool| [ring(&chart, 0.0, forward), ring(&chart, FRAC_PI_2, !forward)];
        // The integral of 3 + cos v over a quarter of the tube, and over the other three.
        let (quarter, rest) = (TAU * (1.5 * PI + 1.0), TAU * (4.5 * PI - 1.0));
        let (short, long) = (rings(true), rings(false));
        assert!((area(&chart, &short).unwrap() / quarter - 1.0).abs() < 1e-4);
        assert!((area(&chart, &long).unwrap() / rest - 1.0).abs() < 1e-4);
        chart.settle(&short, &inner);
        assert!(area(&chart, &short).is_none(), "the seam lies on the other side");
        assert!(area(&chart, &long).is_some());
    }

    #[test]
    fn rings_along_v_bound_a_bent_tube() {
        let surface = Surface::Torus { placement: axes(), major: 3.0, minor: 1.0 };
        let chart = Chart::new(&surface, true, &[], 1.0);
        let across = |path: Path, u: f64| {
            let uv: Vec<Uv> = path.uv.iter().map(|p| [u, p[0]]).collect();
            let points = uv.iter().map(|&uv| chart.point(uv)).collect();
            let middles = path.middles.iter().map(|p| [u, p[0]]).collect();
            Path { points, uv, middles, winding: [0, path.winding[0]] }
        };
        let paths = [across(ring(&chart, 0.0, false), 0.0), across(ring(&chart, 0.0, true), FRAC_PI_2)];
        // A quarter of the torus.
        assert!((area(&chart, &paths).unwrap() / (3.0 * PI * PI) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn a_ring_and_a_pole_bound_half_a_sphere() {
        let surface = Surface::Sphere { placement: axes(), radius: 2.0 };
        for (forward, same_sense) in [(true, true), (false, false)] {
            let chart = Chart::new(&surface, same_sense, &[], 1.0);
            let paths = [ring(&chart, 0.0, forward)];
            let mut patch = Patch::default();
            band(&chart, &paths, &FINENESS, &mut patch).unwrap();
            assert!(patch.points.iter().all(|p| p.z > -1e-12), "the upper half lies on the left");
            assert!((area(&chart, &paths).unwrap() / (8.0 * PI) - 1.0).abs() < 1e-4);
        }
    }

    #[test]
    fn a_ring_that_wavers_is_no_band() {
        let surface = Surface::Sphere { placement: axes(), radius: 2.0 };
        let chart = Chart::new(&surface, true, &[], 1.0);
        let mut wavering = ring(&chart, 0.0, true);
        wavering.uv[3][1] += 0.1;
        assert!(band(&chart, &[wavering], &FINENESS, &mut Patch::default()).is_none());
    }
}
