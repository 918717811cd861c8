//! How a mesh becomes a silhouette: every pixel that a triangle touches.
//!
//! Most of a mesh lies behind what is drawn already, or before it. A face, and then a triangle, whose box of pixels is
//! covered is therefore left out, and faces that take up much of the picture come first.

use std::cmp::Reverse;

use crate::brep::{Mesh, MeshFace, PlacedFaceId};
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::order::{ascending, less, more};
use crate::geometry::{Point, Vector};

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

/// Where the points of a mesh lie along one direction of a picture.
pub struct Coordinates {
    /// In pixels from the picture's border.
    exact: Vec<f64>,
    /// The pixels that hold them.
    cells: Vec<u16>,
    /// The first and the last pixel of each face.
    faces: Vec<[u16; 2]>,
}

impl Raster {
    /// Projects the points of a mesh on an axis, a unit vector.
    pub fn project(&self, mesh: &Mesh, axis: &Vector) -> Coordinates {
        let (middle, end) = (0.5 * self.side as f64, self.side as f64);
        let along = |p: &Point| (middle + self.scale * axis.dot(&(p - self.centre))).clamp(0.0, end);
        let exact: Vec<_> = mesh.points.iter().map(along).collect();
        let cells: Vec<_> = exact.iter().map(|&c| (c as u16).min(self.side as u16 - 1)).collect();
        let points = |face: &MeshFace| face.points.start as usize..face.points.end as usize;
        let faces = mesh.faces.iter().map(|face| bounds(&cells[points(face)])).collect();
        Coordinates { exact, cells, faces }
    }

    /// Draws a mesh by the coordinates of its points: every pixel that a triangle touches, so that thin sheets seen
    /// edge-on do not vanish.
    pub fn draw(&self, mesh: &Mesh, [x, y]: [&Coordinates; 2], cancel: &Cancel) -> Result<Silhouette, Cancelled> {
        let mut picture = Silhouette::new(self.side);
        let boxed = |number: usize| Pixels { x: x.faces[number], y: y.faces[number] };
        let mut faces: Vec<_> = (0..mesh.faces.len()).map(|n| (Reverse(boxed(n).area()), n as u32)).collect();
        faces.sort_unstable();
        for number in faces.into_iter().map(|(_, number)| number as usize) {
            let pixels = boxed(number);
            if pixels.are_covered(&picture) {
                continue;
            }
            let triangles = &mesh.triangles[mesh.triangles_of(PlacedFaceId(number as u32))];
            if pixels.are_filled_by(triangles, [x, y]) {
                pixels.fill(&mut picture);
            } else {
                draw_face(&mut picture, triangles, [x, y], cancel)?;
            }
        }
        Ok(picture)
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

    fn are_covered(&self, picture: &Silhouette) -> bool {
        let ([first, last], [low, high]) = (self.x.map(usize::from), self.y.map(usize::from));
        picture.covers(low..high + 1, first, last + 1)
    }

    fn fill(&self, picture: &mut Silhouette) {
        let ([first, last], [low, high]) = (self.x.map(usize::from), self.y.map(usize::from));
        picture.rows_mut(low..high + 1).for_each(|row| fill(row, first, last));
    }

    /// Whether two triangles are a quadrilateral with a corner in each corner of the box: it touches all pixels there.
    fn are_filled_by(&self, triangles: &[[u32; 3]], [x, y]: [&Coordinates; 2]) -> bool {
        let [one, other] = triangles else { return false };
        // The corners of the box that a triangle leaves out, a bit for each: one alone if its corners are the others.
        let left_out = |triangle: &[u32; 3]| {
            triangle.iter().fold(0b1111, |left, &i| {
                let (x, y) = (x.cells[i as usize], y.cells[i as usize]);
                match (x == self.x[0], x == self.x[1], y == self.y[0], y == self.y[1]) {
                    (true, false, true, false) => left & 0b1110,
                    (false, true, true, false) => left & 0b1101,
                    (true, false, false, true) => left & 0b1011,
                    (false, true, false, true) => left & 0b0111,
                    _ => left,
                }
            })
        };
        // Opposite ones: the triangles share the diagonal between the two others.
        matches!((left_out(one), left_out(other)), (1, 8) | (8, 1) | (2, 4) | (4, 2))
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

/// The side of a triangle, from its lower end.
struct Side {
    from: Corner,
    slope: f64,
}

impl Side {
    fn up(from: Corner, to: Corner) -> Self {
        Self { from, slope: (to.x - from.x) / (to.y - from.y) }
    }

    /// Where it passes a height.
    #[inline]
    fn at(&self, height: f64) -> f64 {
        self.from.x + self.slope * (height - self.from.y)
    }
}

/// Covers every pixel that one of the triangles of a face touches.
fn draw_face(
    picture: &mut Silhouette,
    triangles: &[[u32; 3]],
    [x, y]: [&Coordinates; 2],
    cancel: &Cancel,
) -> Result<(), Cancelled> {
    for some in triangles.chunks(4096) {
        cancel.check()?;
        for corners in some {
            let corners = corners.map(|i| i as usize);
            let pixels = Pixels { x: bounds(&corners.map(|i| x.cells[i])), y: bounds(&corners.map(|i| y.cells[i])) };
            if !pixels.are_covered(picture) {
                touch(picture, corners.map(|i| Corner { x: x.exact[i], y: y.exact[i], row: y.cells[i] }), &pixels);
            }
        }
    }
    Ok(())
}

/// Covers every pixel that the triangle touches.
fn touch(picture: &mut Silhouette, corners: [Corner; 3], pixels: &Pixels) {
    let [low, high] = pixels.y;
    if low == high || pixels.x[0] == pixels.x[1] {
        return pixels.fill(picture);
    }
    let [a, b, c] = ascending(corners, |corner| corner.y);
    let (long, lower, upper) = (Side::up(a, c), Side::up(a, b), Side::up(b, c));
    let end = picture.side() as u32 - 1;
    let (mut short, mut entered, mut top) = (&lower, [a.x; 2], f64::from(low));
    for (row, bits) in (low..=high).zip(picture.rows_mut(low.into()..usize::from(high) + 1)) {
        top += 1.0;
        if row == b.row {
            short = &upper;
            entered = [less(entered[0], b.x), more(entered[1], b.x)];
        }
        let left = if row < high { ordered(long.at(top), short.at(top)) } else { [c.x; 2] };
        let span = [less(entered[0], left[0]), more(entered[1], left[1])];
        let [first, last] = span.map(|x| (x as u32).min(end) as usize);
        fill(bits, first, last);
        entered = left;
    }
}

#[inline]
fn ordered(a: f64, b: f64) -> [f64; 2] {
    [less(a, b), more(a, b)]
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

    /// Quadrilaterals with a corner in each corner of their box, and others: as one face and as two of a triangle each.
    #[test]
    fn two_triangles_cover_the_same_as_one_face_and_as_two() {
        let raster = Raster { centre: Point::new(8.0, 8.0, 0.0), scale: 1.0, side: 16 };
        let mut filled = 0;
        for number in 0..400 {
            let off = |i: u32| f64::from((number * (2 * i + 3) + i * i) % 10) * 0.12;
            let corner = |x: f64, y: f64, i: u32| Point::new(x + off(2 * i), y + off(2 * i + 1), 0.0);
            let points = vec![corner(2.0, 3.0, 0), corner(9.0, 3.0, 1), corner(9.0, 12.0, 2), corner(2.0, 12.0, 3)];
            let triangles = match number % 3 {
                0 => vec![[0, 1, 2], [0, 2, 3]],
                1 => vec![[1, 3, 0], [3, 1, 2]],
                _ => vec![[0, 1, 2], [0, 1, 3]],
            };
            let whole = shapes::mesh(points, triangles);
            let mut halves = whole.clone();
            let (mut first, mut second) = (whole.faces[0].clone(), whole.faces[0].clone());
            (first.triangles, second.triangles) = (0..1, 1..2);
            halves.faces = vec![first, second];
            let [one, two] = [&whole, &halves].map(|mesh| drawn(mesh, &raster, [Vector::x(), Vector::y()]));
            assert_eq!(one, two, "{number}");
            let [x, y] = [Vector::x(), Vector::y()].map(|axis| raster.project(&whole, &axis));
            let pixels = Pixels { x: x.faces[0], y: y.faces[0] };
            filled += usize::from(pixels.are_filled_by(&whole.triangles, [&x, &y]));
        }
        assert!((20..300).contains(&filled), "{filled}");
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
