//! How a mesh becomes a silhouette: every pixel that a triangle touches.
//!
//! Most of a mesh lies behind what is drawn already, or before it. A face, and then a triangle, whose box of pixels is
//! covered is therefore left out, and faces that take up much of the picture come first.

use crate::brep::{Mesh, MeshFace};
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::{Point, Vector};

use super::Silhouette;

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

/// Where the points of a mesh lie along one direction of a picture.
pub struct Coordinates {
    /// In pixels from the picture's border.
    exact: Vec<f64>,
    /// The pixels that hold them.
    cells: Vec<u16>,
}

impl Raster {
    /// Projects the points of a mesh on an axis, a unit vector.
    pub fn project(&self, mesh: &Mesh, axis: &Vector) -> Coordinates {
        let (middle, end) = (0.5 * self.side as f64, self.side as f64);
        let along = |p: &Point| (middle + self.scale * axis.dot(&(p - self.centre))).clamp(0.0, end);
        let exact: Vec<_> = mesh.points.iter().map(along).collect();
        let cells = exact.iter().map(|&c| (c as u16).min(self.side as u16 - 1)).collect();
        Coordinates { exact, cells }
    }

    /// Draws a mesh by the coordinates of its points: every pixel that a triangle touches, so that thin sheets seen
    /// edge-on do not vanish.
    pub fn draw(&self, mesh: &Mesh, [x, y]: [&Coordinates; 2], cancel: &Cancel) -> Result<Silhouette, Cancelled> {
        let mut brush = Brush { picture: Silhouette::new(self.side), spans: vec![NOTHING; self.side] };
        let boxed = |(number, face): (usize, &MeshFace)| {
            let points = face.points.start as usize..face.points.end as usize;
            let pixels = Pixels { x: bounds(&x.cells[points.clone()]), y: bounds(&y.cells[points]) };
            (std::cmp::Reverse(pixels.area()), number, pixels)
        };
        let mut faces: Vec<_> = mesh.faces.iter().enumerate().map(boxed).collect();
        faces.sort_unstable_by_key(|(area, number, _)| (*area, *number));
        for (_, number, pixels) in faces {
            if !brush.covers(&pixels) {
                let triangles = &mesh.faces[number].triangles;
                let triangles = &mesh.triangles[triangles.start as usize..triangles.end as usize];
                brush.face(triangles, [x, y], cancel)?;
            }
        }
        Ok(brush.picture)
    }
}

/// A box of pixels: first and last column, first and last row.
#[derive(Clone, Copy)]
struct Pixels {
    x: [u16; 2],
    y: [u16; 2],
}

impl Pixels {
    fn area(&self) -> u32 {
        let side = |[first, last]: [u16; 2]| u32::from(last.saturating_sub(first)) + 1;
        side(self.x) * side(self.y)
    }
}

/// The least and the largest of some cells.
#[inline]
fn bounds(cells: &[u16]) -> [u16; 2] {
    cells.iter().fold([u16::MAX, 0], |[least, most], &c| [least.min(c), most.max(c)])
}

/// A corner of a triangle in the picture and the row of pixels that it lies in.
#[derive(Clone, Copy)]
struct Corner {
    x: f64,
    y: f64,
    row: u16,
}

/// A picture being drawn.
struct Brush {
    picture: Silhouette,
    /// Scratch, one for each row: what a triangle covers there. Empty between two triangles.
    spans: Vec<[f64; 2]>,
}

impl Brush {
    fn covers(&self, pixels: &Pixels) -> bool {
        let ([first, last], [low, high]) = (pixels.x.map(usize::from), pixels.y.map(usize::from));
        self.picture.covers(low..high + 1, first, last + 1)
    }

    /// Covers every pixel that one of the triangles touches.
    fn face(&mut self, triangles: &[[u32; 3]], [x, y]: [&Coordinates; 2], cancel: &Cancel) -> Result<(), Cancelled> {
        for some in triangles.chunks(4096) {
            cancel.check()?;
            for corners in some {
                let corners = corners.map(|i| i as usize);
                let pixels =
                    Pixels { x: bounds(&corners.map(|i| x.cells[i])), y: bounds(&corners.map(|i| y.cells[i])) };
                if !self.covers(&pixels) {
                    self.touch(corners.map(|i| Corner { x: x.exact[i], y: y.exact[i], row: y.cells[i] }), &pixels);
                }
            }
        }
        Ok(())
    }

    /// Covers every pixel that the triangle touches.
    fn touch(&mut self, corners: [Corner; 3], pixels: &Pixels) {
        let ([first, last], [low, high]) = (pixels.x.map(usize::from), pixels.y.map(usize::from));
        if low == high {
            return self.picture.fill(low, first, last + 1);
        }
        let [a, b, c] = corners;
        for (from, to) in [(a, b), (b, c), (c, a)] {
            self.widen(from, to);
        }
        for (y, span) in (low..).zip(&mut self.spans[low..=high]) {
            let [first, last] = std::mem::replace(span, NOTHING).map(|c| (c as usize).min(self.picture.side() - 1));
            self.picture.fill(y, first, last + 1);
        }
    }

    /// Widens the spans of the rows that a segment passes to what it covers there.
    fn widen(&mut self, a: Corner, b: Corner) {
        let (a, b) = if a.y <= b.y { (a, b) } else { (b, a) };
        let (low, high) = (usize::from(a.row), usize::from(b.row));
        let slope = (b.x - a.x) / (b.y - a.y);
        let mut x = a.x;
        for (y, span) in (low..).zip(&mut self.spans[low..=high]) {
            let next = if y == high { b.x } else { a.x + slope * ((y + 1) as f64 - a.y) };
            *span = widened_to(widened_to(*span, x), next);
            x = next;
        }
    }
}

/// A span that covers nothing.
const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// The span that also covers `x`. Coordinates are numbers: comparing is all there is to it.
#[inline]
fn widened_to([first, last]: [f64; 2], x: f64) -> [f64; 2] {
    [if x < first { x } else { first }, if x > last { x } else { last }]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::shapes;
    use tiny_skia::{FillRule, Mask, PathBuilder, Transform};

    fn drawn(mesh: &Mesh, raster: &Raster, [right, up]: [Vector; 2]) -> Silhouette {
        let [x, y] = [right, up].map(|axis| raster.project(mesh, &axis));
        raster.draw(mesh, [&x, &y], &Cancel::new()).unwrap()
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
