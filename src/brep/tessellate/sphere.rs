//! The poles of a sphere are nowhere on the sphere itself: they may be put where the face's edges are not.

use crate::brep::Placement;
use crate::geometry::{Point, Vector, any_perpendicular};

/// The placement whose z axis keeps the largest angle from all border points, out of the given axes and the
/// diagonals between them; the given one stays where it is nearly as good.
pub(super) fn turned_away(placement: &Placement, border: &[Point]) -> Placement {
    let directions: Vec<Vector> =
        border.iter().filter_map(|p| (p - placement.origin).try_normalize(f64::MIN_POSITIVE)).collect();
    let clearance = |axis: &Vector| {
        let nearest = directions.iter().map(|d| d.dot(axis).abs()).fold(0.0, f64::max);
        (1.0 - nearest * nearest).max(0.0).sqrt()
    };
    let mut best = (clearance(&placement.z) + 0.2, placement.z);
    for x in -1..=1 {
        for y in -1..=1 {
            for z in 0..=1 {
                let mix = placement.x * f64::from(x) + placement.y * f64::from(y) + placement.z * f64::from(z);
                let Some(axis) = mix.try_normalize(0.5) else { continue };
                let clear = clearance(&axis);
                if clear > best.0 + 1e-9 {
                    best = (clear, axis);
                }
            }
        }
    }
    if best.1 == placement.z {
        return *placement;
    }
    let x = any_perpendicular(&best.1);
    Placement { origin: placement.origin, x, y: best.1.cross(&x), z: best.1 }
}
