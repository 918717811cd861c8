//! The curve of the projected area over the angle, and its minimum.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::cancel::{Cancel, Cancelled};

use super::{Options, Sweep};

/// Something that measures projected areas on planes turned about one axis.
pub trait Shadows {
    /// Areas (mm^2) on the planes at the given angles (radians, ascending) from the first.
    fn areas(&mut self, angles: &[f64], cancel: &Cancel) -> Result<Vec<f64>, Cancelled>;
}

/// An angle with the area there and a quarter turn on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Choice {
    pub angle: f64,
    pub area: f64,
    pub third_area: f64,
}

/// Local minima that are refined at most: the lowest ones.
const REFINED: usize = 4;
/// How far below its sample a minimum may lie between two steps, in steps (radians) times the largest area: a convex
/// slice's shadow changes by at most its shadow a quarter turn on; twice that leaves room for gaps.
const DEEPER: f64 = 2.0;
/// Width at which golden section stops, radians (1e-4 degrees).
const ANGLE: f64 = 2e-6;

/// How much the areas differ, as a share of the largest; 0 where all are 0.
pub(super) fn contrast(areas: &[f64]) -> f64 {
    let (least, most) = areas.iter().fold((f64::INFINITY, 0.0_f64), |(l, m), &a| (l.min(a), m.max(a)));
    if most > 0.0 { (most - least) / most } else { 0.0 }
}

/// The areas at one angle.
pub(super) fn at(shadows: &mut dyn Shadows, angle: f64, cancel: &Cancel) -> Result<Choice, Cancelled> {
    let areas = shadows.areas(&[angle, angle + FRAC_PI_2], cancel)?;
    Ok(Choice { angle, area: areas[0], third_area: areas[1] })
}

/// The angle of the smallest area; among equal minima that with the larger third area, then the nearest to the start.
pub(super) fn smallest(
    shadows: &mut dyn Shadows,
    sweep: &Sweep,
    options: &Options,
    cancel: &Cancel,
) -> Result<Choice, Cancelled> {
    let mut minima = Vec::new();
    let step = options.step_deg.to_radians();
    for k in local_minima(&sweep.areas, step) {
        let sampled = (sweep.angles[k], sweep.areas[k]);
        let angle = if options.refine { golden_section(shadows, sampled, step, cancel)? } else { sampled.0 };
        minima.push(at(shadows, angle, cancel)?);
    }
    let least = minima.iter().map(|m| m.area).fold(f64::INFINITY, f64::min);
    minima.retain(|m| m.area <= least * (1.0 + options.equal_minima));
    let largest = minima.iter().map(|m| m.third_area).fold(0.0, f64::max);
    minima.retain(|m| m.third_area >= largest * (1.0 - options.equal_minima));
    let nearest = minima.into_iter().min_by(|a, b| from_start(a.angle).total_cmp(&from_start(b.angle)));
    nearest.map_or_else(|| at(shadows, 0.0, cancel), Ok)
}

/// How far the plane at `angle` is turned from the first, 0 to pi/2.
fn from_start(angle: f64) -> f64 {
    let turned = angle.rem_euclid(PI);
    turned.min(PI - turned)
}

/// Positions of the local minima of the closed curve that may hold the smallest area, lowest first.
fn local_minima(areas: &[f64], step: f64) -> Vec<usize> {
    let n = areas.len();
    let low = |k: usize| areas[k] <= areas[(k + 1) % n] && areas[k] <= areas[(k + n - 1) % n];
    let mut minima: Vec<_> = (0..n).filter(|&k| low(k)).collect();
    minima.sort_by(|&a, &b| areas[a].total_cmp(&areas[b]).then(a.cmp(&b)));
    minima.truncate(REFINED);
    let most = areas.iter().copied().fold(0.0, f64::max);
    let least = minima.first().map_or(0.0, |&k| areas[k]);
    minima.retain(|&k| areas[k] - DEEPER * step.abs() * most <= least);
    minima
}

/// The angle of the smallest area within `step` of a sampled one: area curves are concave between their kinks, so a
/// minimum is a kink, which golden section closes in on.
fn golden_section(
    shadows: &mut dyn Shadows,
    (centre, sampled): (f64, f64),
    step: f64,
    cancel: &Cancel,
) -> Result<f64, Cancelled> {
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = (centre - step, centre + step);
    let (mut a, mut b) = (high - ratio * (high - low), low + ratio * (high - low));
    let first = shadows.areas(&[a, b], cancel)?;
    let (mut at_a, mut at_b) = (first[0], first[1]);
    while high - low > ANGLE {
        if at_a <= at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - ratio * (high - low);
            at_a = shadows.areas(&[a], cancel)?[0];
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + ratio * (high - low);
            at_b = shadows.areas(&[b], cancel)?[0];
        }
    }
    let (angle, area) = if at_a <= at_b { (a, at_a) } else { (b, at_b) };
    Ok(if area < sampled { angle } else { centre })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minima_are_found_across_the_seam_of_the_curve() {
        assert_eq!(local_minima(&[1.0, 2.0, 3.0, 0.5, 4.0, 3.0], 0.1), vec![3, 0]);
        assert_eq!(local_minima(&[1.0, 2.0, 3.0, 0.5, 4.0, 3.0], 0.01), vec![3]);
        assert_eq!(contrast(&[4.0, 3.0, 2.0]), 0.5);
        assert_eq!(contrast(&[0.0, 0.0]), 0.0);
    }

    /// |sin| about 0.3: a kink between two steps.
    struct Kink;
    impl Shadows for Kink {
        fn areas(&mut self, angles: &[f64], _: &Cancel) -> Result<Vec<f64>, Cancelled> {
            Ok(angles.iter().map(|a| 1.0 + (a - 0.3).sin().abs()).collect())
        }
    }

    #[test]
    fn a_kink_between_two_steps_is_found_to_a_ten_thousandth_of_a_degree() {
        let options = Options::default();
        let angles = options.angles();
        let areas = Kink.areas(&angles, &Cancel::new()).unwrap();
        let found = smallest(&mut Kink, &Sweep { angles, areas, chosen: 0.0 }, &options, &Cancel::new()).unwrap();
        assert!((found.angle - 0.3).abs() < 2e-6, "{found:?}");
        assert!((found.area - 1.0).abs() < 1e-5 && (found.third_area - 2.0).abs() < 1e-5);
    }
}
