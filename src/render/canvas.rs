//! A z-buffer with several samples to a pixel.

use tiny_skia::{Color, Pixmap, PremultipliedColorU8};

use crate::geometry::Point;

use super::Camera;

/// Red, green, blue.
pub type Rgb = [u8; 3];

/// The colour of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Paint {
    /// One colour.
    Plain(Rgb),
    /// The first colour on the positive side of the scene's plane, the second on the other.
    Split(Rgb, Rgb),
}

/// A corner of a triangle: where it is, its light (0 to 1), its signed distance from the scene's plane.
pub type Corner = (Point, f64, f64);

/// Samples of depth, colour and face.
pub struct Canvas {
    camera: Camera,
    side: usize,
    samples: usize,
    depths: Vec<f32>,
    colours: Vec<Rgb>,
    faces: Vec<u32>,
}

/// The face of samples that no face covers.
const NO_FACE: u32 = u32::MAX;
/// How dark the outlines of faces are.
const OUTLINE: f32 = 0.45;
/// How opaque planes are.
const PLANE: f32 = 0.38;

impl Canvas {
    /// A white picture of `side` by `side` pixels with `samples` by `samples` samples each.
    pub fn new(camera: Camera, side: usize, samples: usize) -> Self {
        let count = (side * samples).pow(2);
        let (depths, colours) = (vec![f32::NEG_INFINITY; count], vec![[255; 3]; count]);
        Self { camera, side, samples, depths, colours, faces: vec![NO_FACE; count] }
    }

    /// Where the picture is taken from.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Draws a triangle where nothing nearer is drawn yet.
    pub fn triangle(&mut self, corners: &[Corner; 3], paint: Paint, face: u32) {
        let flat = corners.map(|(p, _, _)| self.camera.project(&p));
        let values = [0, 1, 2].map(|i| [flat[i][2], corners[i].1, corners[i].2]);
        self.samples_of(&flat, &values, |canvas, at, [depth, light, across]| {
            if depth as f32 <= canvas.depths[at] {
                return;
            }
            let colour = match paint {
                Paint::Plain(colour) => colour,
                Paint::Split(positive, negative) => {
                    if across >= 0.0 {
                        positive
                    } else {
                        negative
                    }
                }
            };
            canvas.depths[at] = depth as f32;
            canvas.faces[at] = face;
            canvas.colours[at] = colour.map(|c| (f64::from(c) * light.clamp(0.0, 1.0)) as u8);
        });
    }

    /// Lays a translucent square over what lies behind it.
    pub fn square(&mut self, corners: [Point; 4], colour: Rgb) {
        let flat = corners.map(|p| self.camera.project(&p));
        for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
            let values = [a, b, c].map(|i| [flat[i][2], 0.0, 0.0]);
            self.samples_of(&[flat[a], flat[b], flat[c]], &values, |canvas, at, [depth, ..]| {
                if depth as f32 > canvas.depths[at] {
                    canvas.colours[at] = blend(canvas.colours[at], colour, PLANE);
                }
            });
        }
    }

    /// Draws a line, `wide` pixels wide, where nothing nearer is drawn yet; with `over` also there.
    pub fn line(&mut self, ends: [Point; 2], wide: f64, colour: Rgb, over: bool) {
        let [a, b] = ends.map(|p| self.camera.project(&p));
        let (x, y) = (b[0] - a[0], b[1] - a[1]);
        let half = 0.5 * wide * self.samples as f64 / x.hypot(y).max(1e-9);
        let corner = |p: [f64; 3], side: f64| [p[0] - side * y * half, p[1] + side * x * half, p[2]];
        let flat = [corner(a, 1.0), corner(b, 1.0), corner(b, -1.0), corner(a, -1.0)];
        for corners in [[0, 1, 2], [0, 2, 3]] {
            let values = corners.map(|i| [flat[i][2], 0.0, 0.0]);
            self.samples_of(&corners.map(|i| flat[i]), &values, |canvas, at, [depth, ..]| {
                if over || depth as f32 >= canvas.depths[at] {
                    canvas.colours[at] = colour;
                }
            });
        }
    }

    /// Where a point lies in the picture, in pixels to the right and down.
    pub fn pixel_of(&self, p: &Point) -> [f32; 2] {
        let [x, y, _] = self.camera.project(p);
        [x, y].map(|c| (c / self.samples as f64) as f32)
    }

    /// Darkens the samples where one face borders on another or on the background.
    pub fn outline(&mut self) {
        let width = self.side * self.samples;
        for at in 0..self.faces.len() {
            let right = if (at + 1) % width == 0 { at } else { at + 1 };
            let below = if at + width < self.faces.len() { at + width } else { at };
            let differs = self.faces[right] != self.faces[at] || self.faces[below] != self.faces[at];
            if differs {
                self.colours[at] = blend(self.colours[at], [0; 3], OUTLINE);
            }
        }
    }

    /// The picture: the mean of the samples of each pixel.
    pub fn resolved(&self) -> Pixmap {
        let side = self.side.clamp(1, 16_384);
        let mut picture = Pixmap::new(side as u32, side as u32).expect("a side between 1 and 16384 is a valid size");
        picture.fill(Color::WHITE);
        for (i, pixel) in picture.pixels_mut().iter_mut().enumerate() {
            let [r, g, b] = self.mean(i % side, i / side);
            *pixel = PremultipliedColorU8::from_rgba(r, g, b, 255).unwrap_or(*pixel);
        }
        picture
    }

    fn mean(&self, x: usize, y: usize) -> Rgb {
        let n = self.samples;
        let mut sum = [0u32; 3];
        for row in 0..n {
            let start = (y * n + row) * self.side * n + x * n;
            for colour in &self.colours[start..start + n] {
                (0..3).for_each(|c| sum[c] += u32::from(colour[c]));
            }
        }
        sum.map(|s| (s / (n * n) as u32) as u8)
    }

    /// Calls `draw` for each sample inside a triangle with the values there, which are linear over it.
    fn samples_of(
        &mut self,
        flat: &[[f64; 3]; 3],
        values: &[[f64; 3]; 3],
        mut draw: impl FnMut(&mut Self, usize, [f64; 3]),
    ) {
        let [a, b, c] = flat;
        let doubled = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        let width = self.side * self.samples;
        let (top, bottom) = (a[1].min(b[1]).min(c[1]), a[1].max(b[1]).max(c[1]));
        if !(doubled.abs() > 1e-9 && bottom.is_finite() && top.is_finite()) {
            return;
        }
        for y in first_sample(top, width)..first_sample(bottom, width) {
            let height = y as f64 + 0.5;
            let (left, right) = span_at(flat, height);
            for x in first_sample(left, width)..first_sample(right, width) {
                let d = [x as f64 + 0.5 - a[0], height - a[1]];
                let s = (d[0] * (c[1] - a[1]) - d[1] * (c[0] - a[0])) / doubled;
                let t = (d[1] * (b[0] - a[0]) - d[0] * (b[1] - a[1])) / doubled;
                let value = [0, 1, 2]
                    .map(|i| values[0][i] + s * (values[1][i] - values[0][i]) + t * (values[2][i] - values[0][i]));
                draw(self, y * width + x, value);
            }
        }
    }
}

/// The first sample (sample centres are at halves) not before a coordinate.
fn first_sample(c: f64, width: usize) -> usize {
    ((c - 0.5).ceil().max(0.0) as usize).min(width)
}

/// What a triangle covers of the horizontal line at `y`.
fn span_at(flat: &[[f64; 3]; 3], y: f64) -> (f64, f64) {
    let mut span = (f64::INFINITY, f64::NEG_INFINITY);
    for (from, to) in [(0, 1), (1, 2), (2, 0)] {
        let (a, b) = (flat[from], flat[to]);
        if (a[1] <= y) != (b[1] <= y) {
            let x = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
            span = (span.0.min(x), span.1.max(x));
        }
    }
    span
}

fn blend(under: Rgb, over: Rgb, share: f32) -> Rgb {
    [0, 1, 2].map(|i| (f32::from(under[i]) * (1.0 - share) + f32::from(over[i]) * share) as u8)
}
