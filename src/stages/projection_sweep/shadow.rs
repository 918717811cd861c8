//! The area of one shadow, by the same slices as [`super::Slices`] but without joining what they cut.
//!
//! A triangle casts an interval from every slice that it crosses; what a connected piece casts is the union of those.

use std::ops::Range;

use crate::brep::{Mesh, MeshFace};
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::cells::first_centre;
use crate::geometry::order::{ascending, less, more};
use crate::geometry::{Point, Vector};

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
    let level = |height: f64| first_centre((height - low) / thickness, count);
    let corners = corners.into_iter().map(|(height, x)| Corner { height, x, level: level(height) as u32 }).collect();
    let mut cut = Cut { corners, low, thickness, shadows: vec![Union::default(); count] };
    for (extent, face) in cut.widest_first(mesh) {
        if cut.holds(&extent) {
            continue;
        }
        let triangles = &mesh.triangles[face.triangles.start as usize..face.triangles.end as usize];
        for some in triangles.chunks(4096) {
            cancel.check()?;
            some.iter().for_each(|triangle| cut.cast(triangle));
        }
    }
    Ok(thickness * cut.shadows.iter_mut().map(Union::length).sum::<f64>())
}

/// A point of the mesh: its height, where it is along the shadow, and the first slice at or above it.
#[derive(Clone, Copy)]
struct Corner {
    height: f64,
    x: f64,
    level: u32,
}

struct Cut {
    corners: Vec<Corner>,
    low: f64,
    thickness: f64,
    /// Of each slice.
    shadows: Vec<Union>,
}

/// How far something reaches along the shadows, and the slices that it may cross.
#[derive(Clone)]
struct Extent {
    x: [f64; 2],
    slices: Range<usize>,
}

impl Extent {
    fn of(corners: &[Corner]) -> Self {
        let start = (f64::INFINITY, f64::NEG_INFINITY, u32::MAX, 0);
        let ends = corners.iter().fold(start, |(left, right, first, end), c| {
            (less(left, c.x), more(right, c.x), first.min(c.level), end.max(c.level))
        });
        Self { x: [ends.0, ends.1], slices: ends.2.min(ends.3) as usize..ends.3 as usize }
    }

    fn width(&self) -> f64 {
        self.x[1] - self.x[0]
    }
}

impl Cut {
    /// The faces, those first that cast the widest shadows: most of what the others cast lies within these.
    fn widest_first<'a>(&self, mesh: &'a Mesh) -> impl Iterator<Item = (Extent, &'a MeshFace)> + use<'a> {
        let corners = |face: &MeshFace| &self.corners[face.points.start as usize..face.points.end as usize];
        let extents: Vec<_> = mesh.faces.iter().map(|face| Extent::of(corners(face))).collect();
        let mut order: Vec<_> = extents.iter().map(Extent::width).zip(0..).collect();
        order.sort_unstable_by(|a: &(f64, usize), b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        order.into_iter().map(move |(_, number)| (extents[number].clone(), &mesh.faces[number]))
    }

    /// Whether the shadows hold already what lies within an extent.
    fn holds(&self, extent: &Extent) -> bool {
        self.shadows[extent.slices.clone()].iter().all(|shadow| shadow.holds(extent.x[0], extent.x[1]))
    }

    /// Adds what a triangle casts to the shadows of the slices that it crosses.
    fn cast(&mut self, triangle: &[u32; 3]) {
        let corners = triangle.map(|i| self.corners[i as usize]);
        if corners[1].level == corners[0].level && corners[2].level == corners[0].level {
            return;
        }
        let [a, b, c] = ascending(corners, |corner| corner.height);
        let (left, right) = (less(less(a.x, b.x), c.x), more(more(a.x, b.x), c.x));
        let crossed = &self.shadows[a.level as usize..c.level as usize];
        let Some(held) = crossed.iter().position(|shadow| !shadow.holds(left, right)) else { return };
        let (start, long) = (a.level + held as u32, Side::up(&a, &c));
        if start < b.level {
            self.cast_between([&long, &Side::up(&a, &b)], start..b.level, [left, right]);
        }
        if b.level < c.level {
            self.cast_between([&long, &Side::up(&b, &c)], start.max(b.level)..c.level, [left, right]);
        }
    }

    /// Adds what lies between two sides of a triangle that reaches from `left` to `right`.
    fn cast_between(&mut self, [long, short]: [&Side; 2], slices: Range<u32>, [left, right]: [f64; 2]) {
        let shadows = &mut self.shadows[slices.start as usize..slices.end as usize];
        for (slice, shadow) in slices.zip(shadows) {
            if shadow.holds(left, right) {
                continue;
            }
            let height = self.low + (f64::from(slice) + 0.5) * self.thickness;
            let (p, q) = (long.at(height), short.at(height));
            shadow.add(less(p, q), more(p, q));
        }
    }
}

/// A side of a triangle.
struct Side {
    from: f64,
    gain: f64,
    low: f64,
    per_height: f64,
}

impl Side {
    fn up(a: &Corner, b: &Corner) -> Self {
        Self { from: a.x, gain: b.x - a.x, low: a.height, per_height: 1.0 / (b.height - a.height) }
    }

    /// Where it is at a height that it passes.
    #[inline]
    fn at(&self, height: f64) -> f64 {
        self.from + less(more((height - self.low) * self.per_height, 0.0), 1.0) * self.gain
    }
}

/// The union of intervals given one by one.
#[derive(Clone)]
struct Union {
    /// A part of it, which grows with all that touches it: of most shadows the whole.
    main: [f64; 2],
    /// What was apart from the main part when it came.
    others: Vec<[f64; 2]>,
    /// As many others are joined before more are kept.
    most: usize,
}

impl Default for Union {
    fn default() -> Self {
        Self { main: [f64::INFINITY, f64::NEG_INFINITY], others: Vec::new(), most: 32 }
    }
}

impl Union {
    /// Whether the main part holds an interval.
    #[inline]
    fn holds(&self, low: f64, high: f64) -> bool {
        self.main[0] <= low && high <= self.main[1]
    }

    fn add(&mut self, low: f64, high: f64) {
        let touches = |part: &[f64; 2]| low <= part[1] && high >= part[0];
        let grown = |part: &[f64; 2]| [less(part[0], low), more(part[1], high)];
        if touches(&self.main) || self.main[0] > self.main[1] {
            self.main = grown(&self.main);
        } else if let Some(last) = self.others.last_mut().filter(|last| touches(last)) {
            // What comes next lies mostly beside it.
            *last = grown(last);
        } else {
            self.others.push([low, high]);
            if self.others.len() > self.most {
                self.join();
                self.most = 32 + 2 * self.others.len();
            }
        }
    }

    /// Joins all parts that touch: the longest becomes the main part, the others lie apart from each other and from it.
    fn join(&mut self) {
        self.others.push(self.main);
        self.others.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
        self.others.dedup_by(|next, joined| {
            let touching = next[0] <= joined[1];
            if touching {
                joined[1] = joined[1].max(next[1]);
            }
            touching
        });
        let length = |i: &usize| self.others[*i][1] - self.others[*i][0];
        let longest = (0..self.others.len()).max_by(|i, j| length(i).total_cmp(&length(j)));
        self.main = self.others.swap_remove(longest.unwrap_or(0));
    }

    fn length(&mut self) -> f64 {
        if !self.others.is_empty() {
            self.join();
        }
        let main = (self.main[1] - self.main[0]).max(0.0);
        main + self.others.iter().map(|[low, high]| high - low).sum::<f64>()
    }
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
        let mut union = Union::default();
        assert_eq!(union.length(), 0.0);
        [(4.0, 6.0), (0.0, 2.0), (1.0, 3.0), (1.5, 2.5)].into_iter().for_each(|(low, high)| union.add(low, high));
        assert_eq!(union.length(), 5.0);
        assert!(union.holds(0.5, 2.5) && !union.holds(4.5, 5.0));
    }

    #[test]
    fn a_thousand_teeth_are_joined_as_they_close_up() {
        let mut union = Union::default();
        (0..1000).for_each(|i| union.add(f64::from(2 * i), f64::from(2 * i + 1)));
        assert_eq!(union.length(), 1000.0);
        (0..1000).for_each(|i| union.add(f64::from(2 * i + 1), f64::from(2 * i + 2)));
        assert_eq!(union.length(), 2000.0);
        assert!(union.others.is_empty());
    }
}
