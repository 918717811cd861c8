//! Minimum projected area (Johan, Li, Wei and Iskandarsyah 2011).
//!
//! In: a mesh, and something that measures its shadows. Out: the direction in which the shadow is smallest, then the
//! one at right angles to it in which it is smallest, then their cross product.
//! Method: the paper searches the directions by a particle swarm. Here the shadows are swept along great circles, which
//! costs hardly more than one shadow each: circles about the principal axes of surface and normals and about the
//! largest normals (shadows are smallest where large faces are seen edge-on). The best directions found are improved
//! along two circles through each until nothing moves.
//! Cost: some twenty cuts of the model, as many times that of the symmetry frame's sweep. It does not promise the least shadow of all.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::brep::Mesh;
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::{Vector, any_perpendicular};

use super::rectilinearity::weighted_normals;
use super::{cpca, npca};

/// The areas of shadows at angles (radians) that grow: see [`Shadows`].
pub type Sweep<'a> = Box<dyn FnMut(&[f64]) -> Result<Vec<f64>, Cancelled> + 'a>;
/// `(axis, start, slices)`: what measures the shadows seen along the directions at right angles to `axis`, angles
/// counted from `start` towards `axis` x `start`, by cutting the model into so many slices across the axis.
pub type Shadows<'a> = dyn Fn(&Vector, &Vector, u32) -> Result<Sweep<'a>, Cancelled> + 'a;

/// Slices of the first search and of all that follows: see stage 7 for the second number.
const SLICES: (u32, u32) = (64, 256);
/// Angle between two directions of the first search, radians: 2 degrees.
const STEP: f64 = PI / 90.0;
/// Large normals about which there are circles, and the sine by which circles differ at least.
const NORMALS: usize = 3;
const APART: f64 = 0.05;
/// Minima taken of each circle, and directions that are improved.
const TAKEN: usize = 3;
const IMPROVED: usize = 2;
/// Rounds of improvement at most, and the turn (radians) that ends it.
const ROUNDS: usize = 4;
const STILL: f64 = 1e-6;
/// Width at which golden section stops, radians.
const WIDTH: f64 = 1e-6;

/// A direction with the area of the shadow along it.
type Seen = (f64, Vector);

/// The axes of least projected area.
pub fn axes(mesh: &Mesh, shadows: &Shadows, cancel: &Cancel) -> Result<[Vector; 3], Cancelled> {
    let poles = poles(mesh);
    let mut seen: Vec<Seen> = Vec::new();
    for pole in &poles {
        cancel.check()?;
        // Somewhere fixed to the model.
        let start = across(pole, &poles);
        let mut circle = Circle::new(shadows, pole, &start, SLICES.0)?;
        seen.extend(circle.minima(&steps(0.0, PI - STEP), TAKEN)?);
    }
    seen.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut starts: Vec<Seen> = Vec::new();
    for found in seen {
        if starts.len() < IMPROVED && starts.iter().all(|s| s.1.cross(&found.1).norm() > APART) {
            starts.push(found);
        }
    }
    let mut best: Option<Seen> = None;
    for (_, start) in starts {
        let found = improved(shadows, start, &poles, cancel)?;
        if best.is_none_or(|b| found.0 < b.0) {
            best = Some(found);
        }
    }
    let Some((_, first)) = best else { return Ok(cpca::axes(mesh)) };
    let mut circle = Circle::new(shadows, &first, &across(&first, &poles), SLICES.1)?;
    let second = circle.minima(&steps(0.0, PI - STEP), 1)?.first().map_or_else(|| any_perpendicular(&first), |s| s.1);
    Ok([first, second, first.cross(&second)])
}

/// Axes of the circles that are searched first.
fn poles(mesh: &Mesh) -> Vec<Vector> {
    let normals = weighted_normals(mesh);
    let largest = normals.iter().take(NORMALS).filter_map(|n| n.try_normalize(0.0));
    let mut poles: Vec<Vector> = Vec::new();
    for axis in cpca::axes(mesh).into_iter().chain(npca::axes(mesh)).chain(largest) {
        if poles.iter().all(|p| p.cross(&axis).norm() > APART) {
            poles.push(axis);
        }
    }
    poles
}

/// The direction at right angles to `axis` nearest to the first pole that is well away from it.
fn across(axis: &Vector, poles: &[Vector]) -> Vector {
    let away = poles.iter().map(|p| p - axis * axis.dot(p)).find(|p| p.norm() > 0.3);
    away.map_or_else(|| any_perpendicular(axis), |p| p.normalize())
}

/// Follows the shadow downhill along two circles through the direction, in turn.
fn improved(shadows: &Shadows, start: Vector, poles: &[Vector], cancel: &Cancel) -> Result<Seen, Cancelled> {
    let mut best = (f64::INFINITY, start);
    for _ in 0..ROUNDS {
        let before = best.1;
        let pole = across(&best.1, poles);
        for axis in [pole, best.1.cross(&pole)] {
            cancel.check()?;
            let axis = (axis - best.1 * best.1.dot(&axis)).normalize();
            let mut circle = Circle::new(shadows, &axis, &best.1, SLICES.1)?;
            if let Some(found) = circle.minima(&steps(-5.0 * STEP, 5.0 * STEP), 1)?.first() {
                best = *found;
            }
        }
        if before.cross(&best.1).norm() < STILL {
            break;
        }
    }
    Ok(best)
}

fn steps(from: f64, to: f64) -> Vec<f64> {
    let count = ((to - from) / STEP).round() as usize;
    (0..count + 1).map(|k| from + STEP * k as f64).collect()
}

/// The shadows along the directions of a great circle.
struct Circle<'a> {
    axis: Vector,
    start: Vector,
    sweep: Sweep<'a>,
}

impl<'a> Circle<'a> {
    fn new(shadows: &Shadows<'a>, axis: &Vector, start: &Vector, slices: u32) -> Result<Self, Cancelled> {
        Ok(Self { axis: *axis, start: *start, sweep: shadows(axis, start, slices)? })
    }

    fn direction(&self, angle: f64) -> Vector {
        self.start * angle.cos() + self.axis.cross(&self.start) * angle.sin()
    }

    /// The lowest local minima at the given angles, each closed in on between its neighbours.
    fn minima(&mut self, angles: &[f64], most: usize) -> Result<Vec<Seen>, Cancelled> {
        let areas = (self.sweep)(angles)?;
        // After half a turn the shadows repeat: there the first and the last are neighbours.
        let around = angles.len() as f64 * STEP > PI - 0.5 * STEP;
        let count = areas.len();
        let before = |k: usize| if k > 0 { Some(k - 1) } else { around.then_some(count - 1) };
        let after = |k: usize| if k + 1 < count { Some(k + 1) } else { around.then_some(0) };
        let is_low = |&k: &usize| [before(k), after(k)].iter().flatten().all(|&other| areas[k] <= areas[other]);
        let mut low: Vec<_> = (0..count).filter(is_low).collect();
        low.sort_by(|&a, &b| areas[a].total_cmp(&areas[b]));
        let closed_in = |&k: &usize| {
            let angle = self.golden_section(angles[k])?;
            let area = (self.sweep)(&[angle])?[0];
            let kept = if area < areas[k] { (area, angle) } else { (areas[k], angles[k]) };
            Ok((kept.0, self.direction(kept.1)))
        };
        low.iter().take(most).map(closed_in).collect()
    }

    fn golden_section(&mut self, centre: f64) -> Result<f64, Cancelled> {
        let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
        let (mut low, mut high) = (centre - STEP, centre + STEP);
        while high - low > WIDTH {
            let inner = [high - ratio * (high - low), low + ratio * (high - low)];
            let areas = (self.sweep)(&inner)?;
            (low, high) = if areas[0] <= areas[1] { (low, inner[1]) } else { (inner[0], high) };
        }
        Ok(0.5 * (low + high))
    }
}

/// The directions that a sweep's angles stand for must not repeat.
const _: () = assert!(STEP < FRAC_PI_2);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::{shapes, triangles};

    /// The shadow of a convex mesh by Cauchy's formula: half the sum of S |n.d|.
    fn of_convex<'a>(mesh: &'a Mesh) -> impl Fn(&Vector, &Vector, u32) -> Result<Sweep<'a>, Cancelled> + 'a {
        move |axis, start, _| {
            let (start, side) = (*start, axis.cross(start));
            let area = move |angle: &f64| {
                let direction = start * angle.cos() + side * angle.sin();
                triangles(mesh).map(|(_, normal, area)| 0.5 * area * normal.dot(&direction).abs()).sum()
            };
            Ok(Box::new(move |angles: &[f64]| Ok(angles.iter().map(area).collect())))
        }
    }

    #[test]
    fn a_box_is_seen_along_its_longest_side_first() {
        let turn = shapes::rotation(0.5, 0.9, -1.3);
        let mesh = shapes::turned(&shapes::cuboid(1.0, 2.0, 4.0), &turn);
        let found = axes(&mesh, &of_convex(&mesh), &Cancel::new()).unwrap();
        for (axis, side) in found.iter().zip([2, 1, 0]) {
            assert!(axis.dot(&turn.column(side)).abs() > 1.0 - 1e-10, "{found:?}");
        }
    }

    #[test]
    fn the_least_shadow_of_an_oblique_prism_is_along_its_slant() {
        // A parallelepiped with edges a, b, c casts the shadow |a.(b x d)| + ..; along c = (1, 0, 3) it is 2 sqrt(0.9).
        let lean = |p: &crate::geometry::Point| crate::geometry::Point::new(p.x + p.z / 3.0, p.y, p.z);
        let mesh = shapes::mapped(&shapes::cuboid(1.0, 2.0, 9.0), lean);
        let found = axes(&mesh, &of_convex(&mesh), &Cancel::new()).unwrap();
        let slant = Vector::new(1.0, 0.0, 3.0).normalize();
        assert!(found[0].dot(&slant).abs() > 1.0 - 1e-10, "{found:?}");
    }
}
