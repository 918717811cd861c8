//! The area of one shadow, by the same slices as [`super::Slices`] but without joining what they cut.
//!
//! A triangle casts an interval from every slice that it crosses; what a connected piece casts is the union of those.

use crate::brep::Mesh;
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::{Point, Vector};

/// Intervals held at a time: bounds the memory at some 20 MB.
const INTERVALS: usize = 1 << 20;

/// Area of the mesh's shadow on the plane of `across` and `along` (at right angles, unit vectors), mm^2: the mesh is cut
/// into `count` slices across `across`. `centre` is near the mesh.
pub fn area(
    mesh: &Mesh,
    [across, along]: [&Vector; 2],
    centre: &Point,
    count: u32,
    cancel: &Cancel,
) -> Result<f64, Cancelled> {
    let count = count.clamp(1, 65_536) as usize;
    let corner = |p: &Point| {
        let d = p - centre;
        (across.dot(&d), along.dot(&d))
    };
    let corners: Vec<_> = mesh.points.iter().map(corner).collect();
    let (low, high) = corners.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), c| (l.min(c.0), h.max(c.0)));
    let thickness = (high - low) / count as f64;
    if !(thickness > 0.0 && thickness.is_finite()) {
        return Ok(0.0);
    }
    let level = |height: f64| ((height - low) / thickness - 0.5).ceil().clamp(0.0, count as f64) as u32;
    let corners: Vec<_> = corners.into_iter().map(|(height, x)| Corner { height, x, level: level(height) }).collect();
    let cut = Cut { mesh, corners, low, thickness };
    let block = (count * INTERVALS / cut.intervals().max(INTERVALS)).max(1);
    let mut length = 0.0;
    for first in (0..count).step_by(block) {
        length += cut.lengths(first as u32..(first + block).min(count) as u32, cancel)?;
    }
    Ok(thickness * length)
}

/// A point of the mesh: its height, where it is along the shadow, and the first slice at or above it.
#[derive(Clone, Copy)]
struct Corner {
    height: f64,
    x: f64,
    level: u32,
}

struct Cut<'a> {
    mesh: &'a Mesh,
    corners: Vec<Corner>,
    low: f64,
    thickness: f64,
}

impl Cut<'_> {
    /// The corners of a triangle, lowest first.
    fn corners(&self, triangle: &[u32; 3]) -> [Corner; 3] {
        let mut corners = triangle.map(|i| self.corners[i as usize]);
        corners.sort_unstable_by(|a, b| a.height.total_cmp(&b.height));
        corners
    }

    /// How many slices the triangles cross, in all.
    fn intervals(&self) -> usize {
        let crossed = |t: &[u32; 3]| {
            let levels = t.map(|i| self.corners[i as usize].level);
            (levels[0].max(levels[1]).max(levels[2]) - levels[0].min(levels[1]).min(levels[2])) as usize
        };
        self.mesh.triangles.iter().map(crossed).sum()
    }

    /// The lengths of the shadows of some slices, summed.
    fn lengths(&self, slices: std::ops::Range<u32>, cancel: &Cancel) -> Result<f64, Cancelled> {
        let mut intervals = vec![Vec::new(); slices.len()];
        for (number, triangle) in self.mesh.triangles.iter().enumerate() {
            if number % 4096 == 0 {
                cancel.check()?;
            }
            let [a, b, c] = self.corners(triangle);
            for slice in a.level.max(slices.start)..c.level.min(slices.end) {
                let height = self.low + (f64::from(slice) + 0.5) * self.thickness;
                let (p, q) = (
                    crossing(&a, &c, height),
                    if slice < b.level { crossing(&a, &b, height) } else { crossing(&b, &c, height) },
                );
                intervals[(slice - slices.start) as usize].push((p.min(q), p.max(q)));
            }
        }
        Ok(intervals.iter_mut().map(|intervals| union_length(intervals)).sum())
    }
}

/// Where the side from `a` up to `b` is at a height.
fn crossing(a: &Corner, b: &Corner, height: f64) -> f64 {
    let share = ((height - a.height) / (b.height - a.height)).clamp(0.0, 1.0);
    a.x + share * (b.x - a.x)
}

/// Length of the union of intervals.
fn union_length(intervals: &mut [(f64, f64)]) -> f64 {
    intervals.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let (mut length, mut covered) = (0.0, f64::NEG_INFINITY);
    for &(low, high) in intervals.iter() {
        if high > covered {
            length += high - low.max(covered);
            covered = high;
        }
    }
    length
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::shapes;

    #[test]
    fn a_box_casts_its_sides() {
        let mesh = shapes::cuboid(2.0, 3.0, 5.0);
        let area = |across: Vector, along: Vector| area(&mesh, [&across, &along], &Point::origin(), 64, &Cancel::new());
        assert!((area(Vector::x(), Vector::y()).unwrap() - 6.0).abs() < 1e-9);
        assert!((area(Vector::z(), Vector::y()).unwrap() - 15.0).abs() < 1e-9);
    }

    #[test]
    fn intervals_that_overlap_count_once() {
        assert_eq!(union_length(&mut [(4.0, 6.0), (0.0, 2.0), (1.0, 3.0), (1.5, 2.5)]), 5.0);
    }
}
