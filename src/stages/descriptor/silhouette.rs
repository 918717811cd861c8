//! Silhouettes: pictures of 1 bit to the pixel, filled by our own spans.

use crate::brep::Mesh;
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::{Point, Vector};

/// A square picture of bits; row 0 is the lowest, x grows with the bit's number.
#[derive(Clone, PartialEq)]
pub struct Silhouette {
    side: usize,
    words: usize,
    bits: Vec<u64>,
}

/// Where the model lies in the picture.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// The direction of growing x, a unit vector.
    pub right: Vector,
    /// The direction of growing y, a unit vector.
    pub up: Vector,
    /// The point in the middle of the picture.
    pub centre: Point,
    /// Pixels to the mm.
    pub scale: f64,
}

impl Silhouette {
    /// An empty picture.
    pub fn new(side: usize) -> Self {
        let words = side.div_ceil(64);
        Self { side, words, bits: vec![0; words * side] }
    }

    /// Draws a mesh: every pixel that a triangle touches, so that thin sheets seen edge-on do not vanish.
    pub fn draw(mesh: &Mesh, view: &View, side: usize, cancel: &Cancel) -> Result<Self, Cancelled> {
        let mut picture = Self::new(side);
        let middle = 0.5 * side as f64;
        let flat = |p: &Point| {
            let d = p - view.centre;
            [view.right.dot(&d), view.up.dot(&d)].map(|c| (middle + view.scale * c).clamp(0.0, side as f64))
        };
        let points: Vec<_> = mesh.points.iter().map(flat).collect();
        let mut spans = vec![NOTHING; side];
        for (number, triangle) in mesh.triangles.iter().enumerate() {
            if number % 4096 == 0 {
                cancel.check()?;
            }
            picture.touch(triangle.map(|i| points[i as usize]), &mut spans);
        }
        Ok(picture)
    }

    /// Pixels on a side.
    pub fn side(&self) -> usize {
        self.side
    }

    /// Whether a pixel is covered; outside the picture none is.
    pub fn get(&self, x: isize, y: isize) -> bool {
        let inside = |c: isize| (0..self.side as isize).contains(&c);
        inside(x) && inside(y) && self.row(y as usize)[x as usize / 64] >> (x as usize % 64) & 1 == 1
    }

    /// The bits of a row, lowest x first.
    pub fn row(&self, y: usize) -> &[u64] {
        &self.bits[y * self.words..(y + 1) * self.words]
    }

    /// Covered pixels.
    pub fn area(&self) -> usize {
        self.bits.iter().map(|w| w.count_ones() as usize).sum()
    }

    /// Centroid of the covered pixels (pixel centres are at halves); `None` for an empty picture.
    pub fn centroid(&self) -> Option<[f64; 2]> {
        let (mut x, mut y, mut count) = (0.0, 0.0, 0.0);
        for row in 0..self.side {
            for (number, &word) in self.row(row).iter().enumerate() {
                let ones = f64::from(word.count_ones());
                x += ones * (64 * number) as f64 + bit_positions(word).map(|b| b as f64 + 0.5).sum::<f64>();
                y += ones * (row as f64 + 0.5);
                count += ones;
            }
        }
        (count > 0.0).then(|| [x / count, y / count])
    }

    /// Covered pixels of row `y` with first <= x < end.
    pub fn count(&self, y: usize, first: usize, end: usize) -> usize {
        let masked = |(number, mask): (usize, u64)| (self.row(y)[number] & mask).count_ones() as usize;
        masks(first, end).map(masked).sum()
    }

    /// Covers the pixels of row `y` with first <= x < end.
    pub fn fill(&mut self, y: usize, first: usize, end: usize) {
        let row = &mut self.bits[y * self.words..(y + 1) * self.words];
        masks(first, end).for_each(|(number, mask)| row[number] |= mask);
    }

    /// Covers every pixel that the triangle touches; `spans` is scratch, one for each row, empty before and after.
    fn touch(&mut self, [a, b, c]: [[f64; 2]; 3], spans: &mut [[f64; 2]]) {
        let rows = [a, b, c].map(|p| self.cell(p[1]));
        let (low, high) = (rows[0].min(rows[1]).min(rows[2]), rows[0].max(rows[1]).max(rows[2]));
        if low == high {
            let [first, last] = [a, b, c].iter().fold(NOTHING, |span, p| widened_to(span, p[0]));
            return self.fill(low, self.cell(first), self.cell(last) + 1);
        }
        for (from, to) in [(a, b), (b, c), (c, a)] {
            self.widen(from, to, spans);
        }
        for (y, span) in (low..).zip(&mut spans[low..=high]) {
            let [first, last] = std::mem::replace(span, NOTHING);
            self.fill(y, self.cell(first), self.cell(last) + 1);
        }
    }

    /// Widens the spans of the rows that a segment passes to what it covers there.
    fn widen(&self, a: [f64; 2], b: [f64; 2], spans: &mut [[f64; 2]]) {
        let (a, b) = if a[1] <= b[1] { (a, b) } else { (b, a) };
        let (low, high) = (self.cell(a[1]), self.cell(b[1]));
        let slope = (b[0] - a[0]) / (b[1] - a[1]);
        let mut x = a[0];
        for (y, span) in (low..).zip(&mut spans[low..=high]) {
            let next = if y == high { b[0] } else { a[0] + slope * ((y + 1) as f64 - a[1]) };
            *span = widened_to(widened_to(*span, x), next);
            x = next;
        }
    }

    /// The pixel that a coordinate lies in.
    fn cell(&self, c: f64) -> usize {
        (c as usize).min(self.side - 1)
    }

    /// The pixels within `radius` of a covered one: a dilation by a disc.
    fn dilated(&self, radius: usize) -> Self {
        let mut grown = Self::new(self.side);
        let r = radius as isize;
        for dy in -r..=r {
            let reach = ((r * r - dy * dy) as f64).sqrt().round() as usize;
            for y in 0..self.side {
                let Some(target) = y.checked_add_signed(dy).filter(|t| *t < self.side) else { continue };
                let wide = widened(self.row(y), reach);
                let row = &mut grown.bits[target * self.words..(target + 1) * self.words];
                row.iter_mut().zip(wide).for_each(|(word, more)| *word |= more);
            }
        }
        grown
    }

    /// Closes gaps up to twice `radius` wide (dilation, then erosion, by a disc).
    pub fn closed(&self, radius: usize) -> Self {
        let mut outside = self.dilated(radius);
        outside.invert();
        let mut closed = outside.dilated(radius);
        closed.invert();
        closed.bits.iter_mut().zip(&self.bits).for_each(|(word, own)| *word |= own);
        closed
    }

    fn invert(&mut self) {
        self.bits.iter_mut().for_each(|w| *w = !*w);
        let spare = self.words * 64 - self.side;
        if spare > 0 {
            self.bits.iter_mut().skip(self.words - 1).step_by(self.words).for_each(|w| *w &= u64::MAX >> spare);
        }
    }

    /// The picture as text, `#` and `.`, highest row first.
    pub fn to_text(&self) -> String {
        let row = |y: usize| (0..self.side).map(move |x| if self.get(x as isize, y as isize) { '#' } else { '.' });
        (0..self.side).rev().flat_map(|y| row(y).chain(['\n'])).collect()
    }

    /// The picture that [`Silhouette::to_text`] writes.
    pub fn from_text(text: &str) -> Self {
        let rows: Vec<_> = text.split_whitespace().rev().collect();
        let mut picture = Self::new(rows.len());
        for (y, row) in rows.iter().enumerate() {
            for (x, _) in row.bytes().enumerate().filter(|(x, c)| *c == b'#' && *x < rows.len()) {
                picture.fill(y, x, x + 1);
            }
        }
        picture
    }
}

impl std::fmt::Debug for Silhouette {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "\n{}", self.to_text())
    }
}

/// A span that covers nothing.
const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// The span that also covers `x`. Coordinates are numbers: comparing is all there is to it.
#[inline]
fn widened_to([first, last]: [f64; 2], x: f64) -> [f64; 2] {
    [if x < first { x } else { first }, if x > last { x } else { last }]
}

/// The words of a row that hold first <= x < end, each with the bits asked for.
fn masks(first: usize, end: usize) -> impl Iterator<Item = (usize, u64)> {
    let words = if first < end { first / 64..(end - 1) / 64 + 1 } else { 0..0 };
    words.map(move |number| {
        let low = first.max(64 * number) - 64 * number;
        let high = end.min(64 * number + 64) - 64 * number;
        (number, (u64::MAX << low) & (u64::MAX >> (64 - high)))
    })
}

fn bit_positions(mut word: u64) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        let position = word.trailing_zeros();
        word &= word.wrapping_sub(1);
        (position < 64).then_some(position)
    })
}

/// A row with every covered pixel spread `reach` to both sides.
fn widened(row: &[u64], reach: usize) -> Vec<u64> {
    let mut wide = row.to_vec();
    for _ in 0..reach {
        let narrow = wide.clone();
        for (i, word) in wide.iter_mut().enumerate() {
            let from_below = if i > 0 { narrow[i - 1] >> 63 } else { 0 };
            let from_above = narrow.get(i + 1).map_or(0, |next| next << 63);
            *word |= narrow[i] << 1 | narrow[i] >> 1 | from_below | from_above;
        }
    }
    wide
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::shapes;
    use tiny_skia::{FillRule, Mask, PathBuilder, Transform};

    fn front(scale: f64, centre: Point) -> View {
        View { right: Vector::x(), up: Vector::y(), centre, scale }
    }

    #[test]
    fn a_letter_is_drawn_upright() {
        let view = front(2.0, Point::new(2.0, 2.5, 0.0));
        // Shrunk a little towards the origin, so that the arms reach into the rows below them: touched is covered.
        let f = shapes::mapped(&shapes::letter_f(1.0), |p| Point::from(p.coords * 0.98 + Vector::repeat(0.01)));
        let picture = Silhouette::draw(&f, &view, 12, &Cancel::new()).unwrap();
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
        let view = View { right: Vector::x(), up: Vector::z(), centre: Point::new(2.0, 1.0, 0.0), scale: 1.9 };
        let picture = Silhouette::draw(&shapes::rectangle(4.0, 2.0), &view, 10, &Cancel::new()).unwrap();
        assert_eq!(picture.area(), 8);
    }

    #[test]
    fn it_covers_what_tiny_skia_covers_and_at_most_one_pixel_more() {
        let mesh = shapes::turned(&shapes::letter_f(1.3), &shapes::rotation(0.3, 0.5, 0.7));
        let measures = shapes::measures(&mesh);
        let view = front(40.0, measures.centroid);
        let picture = Silhouette::draw(&mesh, &view, 256, &Cancel::new()).unwrap();
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
            a.bits.iter().zip(&b.bits).map(|(p, q)| (p | q).count_ones() as usize).sum::<usize>()
        };
        assert_eq!(union(&picture, &reference), picture.area(), "a pixel of the reference is missing");
        let wide = reference.dilated(2);
        assert_eq!(union(&picture, &wide), wide.area(), "a pixel is far from the reference");
        assert!(picture.area() > reference.area());
    }

    #[test]
    fn counts_and_centroids_cross_words() {
        let mut picture = Silhouette::new(130);
        picture.fill(3, 60, 130);
        assert_eq!(picture.area(), 70);
        assert_eq!(picture.count(3, 63, 66), 3);
        assert_eq!(picture.centroid(), Some([95.0, 3.5]));
        assert_eq!(Silhouette::new(9).centroid(), None);
    }

    #[test]
    fn closing_fills_a_narrow_gap_and_keeps_a_wide_one() {
        let mut picture = Silhouette::new(100);
        (20..80).for_each(|y| picture.fill(y, 10, 40));
        (20..80).for_each(|y| picture.fill(y, 44, 60));
        (20..80).for_each(|y| picture.fill(y, 80, 90));
        let closed = picture.closed(3);
        assert!(closed.get(42, 50) && !closed.get(70, 50));
        assert!(!closed.get(5, 50) && !closed.get(95, 50) && !closed.get(50, 15));
    }
}
