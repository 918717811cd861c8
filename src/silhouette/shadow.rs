//! The area of one shadow, by slices: in each the length that lies within the outlines.

use std::ops::Range;

use crate::brep::Wireframe;
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::cells::{self, first_centre};
use crate::geometry::order::{less, more};
use crate::geometry::{Point, Vector};

use super::outline::{Outline, outlines};

/// Area of a mesh's shadow on the plane of `along` and `across` (at right angles, unit vectors), mm^2: the mesh is cut
/// into `count` slices across `across`. `centre` is near the mesh.
///
/// # Errors
/// When cancelled.
pub fn area(
    wireframe: &Wireframe,
    [along, across]: [&Vector; 2],
    centre: &Point,
    count: u32,
    cancel: &Cancel,
) -> Result<f64, Cancelled> {
    let count = count.clamp(1, 65_536) as usize;
    let place = |p: &Point| [along, across].map(|axis| axis.dot(&(p - centre)));
    let mut places: Vec<_> = wireframe.vertices.iter().map(place).collect();
    let (low, high) =
        places.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (less(l, p[1]), more(h, p[1])));
    let thickness = (high - low) / count as f64;
    if !(thickness > 0.0 && thickness.is_finite()) {
        return Ok(0.0);
    }
    // Heights in slices.
    places.iter_mut().for_each(|[_, y]| *y = (*y - low) / thickness);
    let line = |outline: Outline| Line::new(outline.upwards(|i| places[i]), count);
    let mut lines: Vec<_> = outlines(wireframe, &along.cross(across), cancel)?.filter_map(line).collect();
    lines.sort_unstable_by_key(|line| line.slices.start);
    Ok(thickness * covered(&lines, count, cancel)?)
}

/// An outline that crosses slices, from its lower end.
struct Line {
    from: [f64; 2],
    slope: f64,
    slices: Range<usize>,
    /// Layers more beyond it than before it.
    gained: i32,
}

impl Line {
    /// That of an outline on its way up, unless it lies between two of `count` slices.
    fn new(([from, to], gained): ([[f64; 2]; 2], i32), count: usize) -> Option<Self> {
        let slices = first_centre(from[1], count)..first_centre(to[1], count);
        let slope = (to[0] - from[0]) / (to[1] - from[1]);
        (!slices.is_empty()).then_some(Self { from, slope, slices, gained })
    }

    fn crossing(&self, slice: usize) -> f64 {
        self.from[0] + self.slope * (cells::centre(slice) - self.from[1])
    }
}

/// The lengths of all slices that lie within some lines together; the lines come in the order of their first slices.
fn covered(mut lines: &[Line], count: usize, cancel: &Cancel) -> Result<f64, Cancelled> {
    let mut covered = 0.0;
    // Where each line crosses the slice at hand: nearly in the order of the slice before it.
    let mut now: Vec<(f64, &Line)> = Vec::new();
    for slice in 0..count {
        cancel.check()?;
        let begun = lines.iter().take_while(|line| line.slices.start == slice).count();
        now.retain(|(_, line)| line.slices.end > slice);
        now.extend(lines[..begun].iter().map(|line| (0.0, line)));
        lines = &lines[begun..];
        now.iter_mut().for_each(|(x, line)| *x = line.crossing(slice));
        now.sort_unstable_by(|(a, _), (b, _)| a.total_cmp(b));
        covered += length(&now);
    }
    Ok(covered)
}

/// The length that lies within some lines, which come in the order of their crossings.
fn length(crossings: &[(f64, &Line)]) -> f64 {
    let (mut layers, mut length) = (0, 0.0);
    for (x, line) in crossings {
        let before = layers;
        layers += line.gained;
        match (before > 0, layers > 0) {
            (false, true) => length -= x,
            (true, false) => length += x,
            _ => {}
        }
    }
    length
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::shapes;

    fn area(mesh: &crate::brep::Mesh, along: Vector, across: Vector) -> f64 {
        super::area(&Wireframe::of(mesh), [&along, &across], &Point::origin(), 64, &Cancel::new()).unwrap()
    }

    #[test]
    fn a_box_casts_its_sides() {
        let mesh = shapes::cuboid(2.0, 3.0, 5.0);
        assert!((area(&mesh, Vector::y(), Vector::x()) - 6.0).abs() < 1e-9);
        assert!((area(&mesh, Vector::y(), Vector::z()) - 15.0).abs() < 1e-9);
    }

    /// 40 blocks of 2 behind one another, each half covered by the next, then as many apart, and a sheet over a block.
    #[test]
    fn what_lies_behind_counts_once() {
        let row = |step: f64| {
            let block = |i: u32| {
                shapes::mapped(&shapes::cuboid(2.0, 1.0, 3.0), |p| p + Vector::new(step, 4.0, 0.0) * f64::from(i))
            };
            (1..40).map(block).fold(block(0), |all, next| shapes::joined(&all, &next))
        };
        assert!((area(&row(1.0), Vector::x(), Vector::z()) - 41.0 * 3.0).abs() < 1e-9);
        assert!((area(&row(3.0), Vector::x(), Vector::z()) - 80.0 * 3.0).abs() < 1e-9);
        let covered = shapes::joined(&shapes::cuboid(2.0, 3.0, 5.0), &shapes::rectangle(4.0, 1.5));
        assert!((area(&covered, Vector::x(), Vector::y()) - 9.0).abs() < 1e-9);
    }

    /// Against the union of the triangles' intervals in each slice.
    #[test]
    fn layers_add_up_to_what_triangles_cast() {
        let open = shapes::mesh(
            shapes::ellipsoid([1.0, 0.5, 2.0], 12).points,
            shapes::ellipsoid([1.0, 0.5, 2.0], 12).triangles.split_off(70),
        );
        let both = shapes::joined(&open, &shapes::turned(&shapes::letter_f(0.4), &shapes::rotation(0.4, 0.2, 1.1)));
        let (along, across, count) = (Vector::new(0.6, 0.0, 0.8), Vector::y(), 64);
        let heights = both.points.iter().map(|p| p.y);
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), y| (l.min(y), h.max(y)));
        let thickness = (high - low) / f64::from(count);
        let expected: f64 = (0..count)
            .map(|slice| {
                let height = low + (f64::from(slice) + 0.5) * thickness;
                let mut parts: Vec<_> =
                    (0..both.triangles.len()).filter_map(|t| cast(both.corners(t), &along, height)).collect();
                parts.sort_by(|a, b| a[0].total_cmp(&b[0]));
                let union = parts
                    .iter()
                    .fold((0.0, f64::NEG_INFINITY), |(sum, end), [a, b]| (sum + (b - a.max(end).min(*b)), b.max(end)));
                union.0 * thickness
            })
            .sum();
        let found = area(&both, along, across);
        assert!((found - expected).abs() < 1e-9 * expected, "{found} {expected}");
    }

    /// The interval that a triangle casts from a slice at a height of y.
    fn cast(corners: [Point; 3], along: &Vector, height: f64) -> Option<[f64; 2]> {
        let crossing = |p: Point, q: Point| {
            let share = (height - p.y) / (q.y - p.y);
            (p.y < height && height <= q.y || q.y < height && height <= p.y)
                .then(|| along.dot(&(p + (q - p) * share).coords))
        };
        let [a, b, c] = corners;
        let ends: Vec<_> = [crossing(a, b), crossing(b, c), crossing(c, a)].into_iter().flatten().collect();
        let [p, q] = ends[..] else { return None };
        Some([p.min(q), p.max(q)])
    }
}
