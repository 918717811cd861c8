//! How a mesh becomes a silhouette: every pixel that a triangle touches.
//!
//! A pixel is covered if an [outline](super::outline) passes it or if it lies within some.

use crate::brep::Wireframe;
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::order::{less, more};
use crate::geometry::{Point, Vector};

use super::outline::outlines;
use super::{Silhouette, fill};

/// A square picture and where the model lies in it.
#[derive(Clone, Copy, Debug)]
pub struct Raster {
    /// The point in the middle of the picture.
    pub centre: Point,
    /// Pixels to the mm.
    pub scale: f64,
    /// Pixels on a side.
    pub side: usize,
}

/// Where the vertices of a wireframe lie along one direction of a picture, pixels from its border.
pub struct Coordinates {
    axis: Vector,
    of: Vec<f64>,
}

impl Raster {
    /// Projects the vertices of a wireframe on an axis, a unit vector.
    pub fn project(&self, wireframe: &Wireframe, axis: &Vector) -> Coordinates {
        let (middle, end) = (0.5 * self.side as f64, self.side as f64);
        let along = |p: &Point| (middle + self.scale * axis.dot(&(p - self.centre))).clamp(0.0, end);
        Coordinates { axis: *axis, of: wireframe.vertices.iter().map(along).collect() }
    }

    /// Draws a wireframe by the coordinates of its vertices: every pixel that a triangle touches, so that thin sheets seen
    /// edge-on do not vanish.
    pub fn draw(
        &self,
        wireframe: &Wireframe,
        [x, y]: [&Coordinates; 2],
        cancel: &Cancel,
    ) -> Result<Silhouette, Cancelled> {
        let mut picture = Silhouette::new(self.side);
        let mut lines = Lines::new(self.side);
        for outline in outlines(wireframe, &x.axis.cross(&y.axis), cancel)? {
            let (ends, gained) = outline.upwards(|i| [x.of[i], y.of[i]]);
            lines.add(&mut picture, ends, gained);
        }
        lines.fill(&mut picture, cancel)?;
        Ok(picture)
    }
}

/// No line.
const NONE: u32 = u32::MAX;

/// The lines of a picture that pass from one row of pixels to another.
struct Lines {
    all: Vec<Line>,
    /// Of each row the last one found that begins there.
    begin: Vec<u32>,
}

/// A line, from its lower end.
#[derive(Clone, Copy)]
struct Line {
    /// The pixel where it comes into the row at hand.
    pixel: u32,
    /// Where it ends: pixel and row.
    end: [u32; 2],
    /// Layers more to its right than to its left.
    gained: i32,
    /// Where it leaves the row at hand, and how far that moves from row to row, pixels times 2^32.
    leaves: i64,
    step: i64,
    /// The one found before it in the row where it begins.
    before: u32,
}

/// A pixel, as lines are counted on from row to row.
const PIXEL: f64 = (1_u64 << 32) as f64;

impl Lines {
    fn new(side: usize) -> Self {
        Self { all: Vec::new(), begin: vec![NONE; side] }
    }

    /// Adds a line by its ends, the lower one first, with so many layers more to its right than to its left. One that
    /// stays in a row is drawn at once.
    fn add(&mut self, picture: &mut Silhouette, [from, to]: [[f64; 2]; 2], gained: i32) {
        let [pixel, row] = from.map(|c| cell(c, self.begin.len()));
        let end = to.map(|c| cell(c, self.begin.len()));
        if row == end[1] {
            return fill(picture.row_mut(row as usize), pixel.min(end[0]) as usize, pixel.max(end[0]) as usize);
        }
        let slope = (to[0] - from[0]) / (to[1] - from[1]);
        let first = from[0] + slope * (f64::from(row + 1) - from[1]);
        let [leaves, step] = [first, slope].map(|c| (c * PIXEL) as i64);
        let before = std::mem::replace(&mut self.begin[row as usize], self.all.len() as u32);
        self.all.push(Line { pixel, end, gained, leaves, step, before });
    }

    /// Covers what the lines pass and what lies within them, row by row.
    fn fill(self, picture: &mut Silhouette, cancel: &Cancel) -> Result<(), Cancelled> {
        let mut passed = Passed::new(self.begin.len());
        // Those that pass the row at hand.
        let mut now: Vec<Line> = Vec::new();
        for (row, &begin) in self.begin.iter().enumerate() {
            cancel.check()?;
            let begun = std::iter::successors(self.all.get(begin as usize), |one| self.all.get(one.before as usize));
            now.extend(begun);
            let bits = picture.row_mut(row);
            let mut number = 0;
            while let Some(line) = now.get_mut(number) {
                if line.pass(row as u32, bits, &mut passed) {
                    number += 1;
                } else {
                    now.swap_remove(number);
                }
            }
            passed.fill(bits);
        }
        Ok(())
    }
}

impl Line {
    /// Covers what it passes of a row; whether it goes on to the next one.
    #[inline]
    fn pass(&mut self, row: u32, bits: &mut [u64], passed: &mut Passed) -> bool {
        let goes_on = row < self.end[1];
        let left = if goes_on { ((self.leaves >> 32) as i32).clamp(0, passed.last) as u32 } else { self.end[0] };
        fill(bits, less(self.pixel, left) as usize, more(self.pixel, left) as usize);
        if goes_on {
            passed.add(left as usize, self.gained);
            self.leaves = self.leaves.wrapping_add(self.step);
            self.pixel = left;
        }
        goes_on
    }
}

/// The pixel of a row that holds a coordinate.
#[inline]
fn cell(c: f64, side: usize) -> u32 {
    (c as u32).min(side as u32 - 1)
}

/// Where lines pass the upper border of a row.
struct Passed {
    /// A bit for each pixel where one does.
    pixels: Vec<u64>,
    /// Layers more after each pixel than before it.
    gained: Vec<i32>,
    /// The last pixel.
    last: i32,
}

impl Passed {
    fn new(side: usize) -> Self {
        Self { pixels: vec![0; side.div_ceil(64)], gained: vec![0; side], last: side as i32 - 1 }
    }

    #[inline]
    fn add(&mut self, pixel: usize, gained: i32) {
        self.pixels[pixel / 64] |= 1 << (pixel % 64);
        self.gained[pixel] += gained;
    }

    /// Covers what lies within the lines, and forgets them.
    fn fill(&mut self, bits: &mut [u64]) {
        let (mut layers, mut first) = (0, 0);
        for (number, word) in self.pixels.iter_mut().enumerate() {
            while *word != 0 {
                let pixel = 64 * number + word.trailing_zeros() as usize;
                *word &= *word - 1;
                let before = layers;
                layers += std::mem::take(&mut self.gained[pixel]);
                match (before > 0, layers > 0) {
                    (false, true) => first = pixel,
                    (true, false) => fill(bits, first, pixel),
                    _ => {}
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::shapes;
    use crate::brep::Mesh;
    use tiny_skia::{FillRule, Mask, PathBuilder, Transform};

    fn drawn(mesh: &Mesh, raster: &Raster, axes: [Vector; 2]) -> Silhouette {
        let wireframe = Wireframe::of(mesh);
        let [x, y] = axes.map(|axis| raster.project(&wireframe, &axis));
        raster.draw(&wireframe, [&x, &y], &Cancel::new()).unwrap()
    }

    #[test]
    fn a_letter_is_drawn_upright() {
        let raster = Raster { centre: Point::new(2.0, 2.5, 0.0), scale: 2.0, side: 12 };
        // Shrunk a little towards the origin, so that the arms reach into the rows below them: touched is covered.
        let f = shapes::mapped(&shapes::letter_f(1.0), |p| Point::from(p.coords * 0.98 + Vector::repeat(0.01)));
        let picture = drawn(&f, &raster, [Vector::x(), Vector::y()]);
        let expected = "
            ............
            ..######....
            ..######....
            ..######....
            ..##........
            ..####......
            ..####......
            ..####......
            ..##........
            ..##........
            ..##........
            ............";
        assert_eq!(picture, Silhouette::from_text(expected));
    }

    #[test]
    fn a_sheet_seen_edge_on_does_not_vanish() {
        let raster = Raster { centre: Point::new(2.0, 1.0, 0.0), scale: 1.9, side: 10 };
        let picture = drawn(&shapes::rectangle(4.0, 2.0), &raster, [Vector::x(), Vector::z()]);
        assert_eq!(picture.area(), 8);
    }

    /// How far a pixel and a triangle overlap along the direction in which they do so least (separating axes), pixels.
    fn overlap(corners: &[[f64; 2]; 3], [column, row]: [usize; 2]) -> f64 {
        let square = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|[x, y]| [column as f64 + x, row as f64 + y]);
        let normal = |i: usize| {
            let ([ax, ay], [bx, by]) = (corners[i], corners[(i + 1) % 3]);
            // Two corners in one place leave the other sides to tell.
            let length = (bx - ax).hypot(by - ay).max(1e-9);
            [(by - ay) / length, (ax - bx) / length]
        };
        let along = |points: &[[f64; 2]], [nx, ny]: [f64; 2]| {
            let all = points.iter().map(|[x, y]| nx * x + ny * y);
            all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], c| [low.min(c), high.max(c)])
        };
        let overlap = |axis: [f64; 2]| {
            let ([a, b], [c, d]) = (along(corners, axis), along(&square, axis));
            b.min(d) - a.max(c)
        };
        [[1.0, 0.0], [0.0, 1.0], normal(0), normal(1), normal(2)].map(overlap).into_iter().fold(f64::INFINITY, f64::min)
    }

    /// Triangles of any size, open and overlapping, some of them turned away and some seen edge-on.
    #[test]
    fn every_pixel_that_a_triangle_touches_is_covered_and_no_other() {
        let raster = Raster { centre: Point::new(10.0, 10.0, 0.0), scale: 1.0, side: 20 };
        for number in 0..60_u32 {
            let share = |i: u32, step: f64| (f64::from(number * 31 + i) * step).fract();
            let corner = |i: u32| {
                let reach = [1.5, 6.0, 19.0][(i / 3 % 3) as usize];
                let [x, y] = [(i, 0.754_877_666), (i / 3, 0.569_840_29)].map(|(i, step)| 19.0 * share(i, step));
                let [dx, dy] = [0.438_579, 0.921_317].map(|step| reach * share(i, step));
                Point::new((x + dx).min(19.9), (y + dy).min(19.9), 0.3 + share(i, 0.311) * f64::from(i / 12 % 2))
            };
            let points: Vec<_> = (0..3 * (1 + number % 9)).map(corner).collect();
            let triangles: Vec<_> = (0..points.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
            let mesh = shapes::mesh(points, triangles);
            let views = [[Vector::x(), Vector::y()], [Vector::y(), Vector::x()], [Vector::z(), Vector::y()]];
            for axes in views {
                let picture = drawn(&mesh, &raster, axes);
                let flat = |p: Point| axes.map(|axis| 10.0 + axis.dot(&(p - raster.centre)));
                let corners: Vec<_> = (0..mesh.triangles.len()).map(|t| mesh.corners(t).map(flat)).collect();
                for pixel in (0..400).map(|i| [i % 20, i / 20]) {
                    let most = corners.iter().map(|c| overlap(c, pixel)).fold(f64::NEG_INFINITY, f64::max);
                    let is_covered = picture.get(pixel[0] as isize, pixel[1] as isize);
                    assert!(most.abs() < 1e-6 || is_covered == (most > 0.0), "{number} {pixel:?} {most}");
                }
            }
        }
    }

    #[test]
    fn it_covers_what_tiny_skia_covers_and_at_most_one_pixel_more() {
        let mesh = shapes::turned(&shapes::letter_f(1.3), &shapes::rotation(0.3, 0.5, 0.7));
        let measures = shapes::measures(&mesh);
        let raster = Raster { centre: measures.centroid, scale: 40.0, side: 256 };
        let picture = drawn(&mesh, &raster, [Vector::x(), Vector::y()]);
        let mut reference = Silhouette::new(256);
        let mut mask = Mask::new(256, 256).unwrap();
        for t in 0..mesh.triangles.len() {
            let [a, b, c] = mesh
                .corners(t)
                .map(|p| (p - measures.centroid) * 40.0)
                .map(|d| (d.x as f32 + 128.0, d.y as f32 + 128.0));
            let mut path = PathBuilder::new();
            path.move_to(a.0, a.1);
            path.line_to(b.0, b.1);
            path.line_to(c.0, c.1);
            path.close();
            mask.fill_path(&path.finish().unwrap(), FillRule::Winding, false, Transform::identity());
        }
        for (i, _) in mask.data().iter().enumerate().filter(|(_, covered)| **covered > 0) {
            reference.fill(i / 256, i % 256, i % 256 + 1);
        }
        let union = |a: &Silhouette, b: &Silhouette| {
            let rows = (0..256).flat_map(|y| a.row(y).iter().zip(b.row(y)));
            rows.map(|(p, q)| (p | q).count_ones() as usize).sum::<usize>()
        };
        assert_eq!(union(&picture, &reference), picture.area(), "a pixel of the reference is missing");
        let wide = reference.dilated(2);
        assert_eq!(union(&picture, &wide), wide.area(), "a pixel is far from the reference");
        assert!(picture.area() > reference.area());
    }
}
