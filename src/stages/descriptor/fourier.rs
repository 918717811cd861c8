//! Centroid distance signatures and their Fourier descriptors (the paper's section VI; Zhang and Lu 2002).

use std::cell::RefCell;

use realfft::RealFftPlanner;

use super::HARMONICS;
use super::contour::Contour;

/// Which half of the view's first axis a contour starts at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Where the axis to the right leaves the contour.
    Positive,
    /// Where its opposite does.
    Negative,
}

/// A place on a closed polygon: the side that starts at a point, and how far along it (0 to 1).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    side: usize,
    share: f64,
}

/// A contour and the lengths of its sides.
pub struct Path<'a> {
    points: &'a [[f64; 2]],
    lengths: Vec<f64>,
    length: f64,
}

thread_local! {
    /// Holds the transforms of the lengths asked for so far.
    static PLANNER: RefCell<RealFftPlanner<f64>> = RefCell::new(RealFftPlanner::new());
}

impl<'a> Path<'a> {
    /// Measures the sides of a contour.
    pub fn new(contour: &'a Contour) -> Self {
        let points = contour.points.as_slice();
        let ends = points.iter().cycle().skip(1);
        let lengths: Vec<_> = points.iter().zip(ends).map(|(a, b)| distance(*a, *b)).collect();
        Self { points, length: lengths.iter().sum(), lengths }
    }

    /// `count` points equally spaced by arc length, counter-clockwise, from where the half axis from `centre` meets the
    /// contour last; where it does not meet it, from the point seen nearest to that direction.
    pub fn resampled(&self, centre: [f64; 2], start: Start, count: usize) -> Vec<[f64; 2]> {
        let (points, n) = (self.points, self.points.len());
        let place = last_crossing(points, centre, start).unwrap_or_else(|| nearest_in_direction(points, centre, start));
        let next = |side: usize| if side + 1 < n { side + 1 } else { 0 };
        let step = self.length / count as f64;
        let (mut side, mut along) = (place.side, place.share * self.lengths[place.side]);
        let mut passed = 0;
        let mut resampled = Vec::with_capacity(count);
        for _ in 0..count {
            while along > self.lengths[side] && passed < 2 * n {
                along -= self.lengths[side];
                (side, passed) = (next(side), passed + 1);
            }
            let share = if self.lengths[side] > 0.0 { along / self.lengths[side] } else { 0.0 };
            resampled.push(between(points[side], points[next(side)], share));
            along += step;
        }
        resampled
    }
}

/// Distances of the points from `centre`.
pub fn centroid_distances(points: &[[f64; 2]], centre: [f64; 2]) -> Vec<f64> {
    points.iter().map(|p| distance(*p, centre)).collect()
}

/// F_k / |F_0| for k = 1..=[`HARMONICS`] of a real signature, as (re, im); `None` where F_0 vanishes.
pub fn coefficients(signature: &[f64]) -> Option<[[f32; 2]; HARMONICS]> {
    let transform = PLANNER.with_borrow_mut(|planner| planner.plan_fft_forward(signature.len()));
    let mut spectrum = transform.make_output_vec();
    transform.process(&mut signature.to_vec(), &mut spectrum).ok()?;
    let scale = spectrum.first()?.norm();
    if !(scale > 0.0 && scale.is_finite()) || spectrum.len() <= HARMONICS {
        return None;
    }
    Some(std::array::from_fn(|k| [(spectrum[k + 1].re / scale) as f32, (spectrum[k + 1].im / scale) as f32]))
}

/// Magnitudes of complex coefficients.
pub fn magnitudes(coefficients: &[[f32; 2]; HARMONICS]) -> [f32; HARMONICS] {
    coefficients.map(|[re, im]| re.hypot(im))
}

/// Where the half axis meets the polygon farthest from `centre`.
fn last_crossing(points: &[[f64; 2]], centre: [f64; 2], start: Start) -> Option<Place> {
    let mut best: Option<(f64, Place)> = None;
    let mut corners = points.iter().chain(points.first()).map(|p| seen(*p, centre, start));
    let mut a = corners.next()?;
    for (side, b) in corners.enumerate() {
        if (a[1] < 0.0) != (b[1] < 0.0) {
            let share = a[1] / (a[1] - b[1]);
            let x = a[0] + share * (b[0] - a[0]);
            if x >= 0.0 && best.is_none_or(|(farthest, _)| x > farthest) {
                best = Some((x, Place { side, share }));
            }
        }
        a = b;
    }
    best.map(|(_, place)| place)
}

fn nearest_in_direction(points: &[[f64; 2]], centre: [f64; 2], start: Start) -> Place {
    let off = |i: &usize| {
        let [x, y] = seen(points[*i], centre, start);
        y.abs().atan2(x)
    };
    let side = (0..points.len()).min_by(|i, j| off(i).total_cmp(&off(j))).unwrap_or(0);
    Place { side, share: 0.0 }
}

/// Coordinates from the centre, x along the half axis; the turn of half a circle keeps the sense of rotation.
fn seen(p: [f64; 2], centre: [f64; 2], start: Start) -> [f64; 2] {
    let [x, y] = [p[0] - centre[0], p[1] - centre[1]];
    match start {
        Start::Positive => [x, y],
        Start::Negative => [-x, -y],
    }
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn between(a: [f64; 2], b: [f64; 2], share: f64) -> [f64; 2] {
    [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rectangle() -> Contour {
        Contour { points: vec![[0.0, 0.0], [6.0, 0.0], [6.0, 2.0], [0.0, 2.0]] }
    }

    #[test]
    fn points_start_on_the_half_axis_and_run_counter_clockwise() {
        let points = Path::new(&rectangle()).resampled([3.0, 1.0], Start::Positive, 16);
        assert_eq!(points[..4], [[6.0, 1.0], [6.0, 2.0], [5.0, 2.0], [4.0, 2.0]]);
        let points = Path::new(&rectangle()).resampled([3.0, 1.0], Start::Negative, 16);
        assert_eq!(points[..3], [[0.0, 1.0], [0.0, 0.0], [1.0, 0.0]]);
    }

    #[test]
    fn a_half_axis_that_leads_past_the_contour_takes_the_nearest_point() {
        let points = Path::new(&rectangle()).resampled([9.0, 1.5], Start::Positive, 16);
        assert_eq!(points[0], [6.0, 0.0]);
    }

    #[test]
    fn a_cosine_has_one_harmonic() {
        // r = 2 + cos(3 t): F_0 = 2 N, F_3 = N / 2.
        let signature: Vec<_> =
            (0..256).map(|i| 2.0 + (3.0 * f64::from(i) * std::f64::consts::TAU / 256.0).cos()).collect();
        let found = coefficients(&signature).unwrap();
        for (k, [re, im]) in found.iter().enumerate() {
            let expected = if k == 2 { 0.25 } else { 0.0 };
            assert!((re - expected).abs() < 1e-6 && im.abs() < 1e-6);
        }
        assert_eq!(magnitudes(&found)[2], 0.25);
        assert_eq!(coefficients(&[0.0; 256]), None);
    }
}
