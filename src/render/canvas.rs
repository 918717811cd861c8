//! A z-buffer with several samples to a pixel.

use tiny_skia::{Color, Pixmap, PremultipliedColorU8};

use crate::geometry::Point;

use super::Camera;
use super::triangle::{Ramp, Triangle};

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

/// A corner of a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    /// Where it lies in the picture, as the camera projects it.
    pub at: [f64; 3],
    /// Its light, 0 to 1.
    pub light: f64,
    /// Its signed distance from the scene's plane.
    pub across: f64,
}

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
        let flat = corners.map(|c| [c.at[0], c.at[1]]);
        let width = self.side * self.samples;
        let Some(triangle) = Triangle::new(flat, width) else { return };
        let ramp = |value: fn(&Corner) -> f64| Ramp::new(&flat, [&corners[0], &corners[1], &corners[2]].map(value));
        let (depths, lights, across) = (ramp(|c| c.at[2]), ramp(|c| c.light), ramp(|c| c.across));
        for (y, span) in triangle.spans() {
            for x in span {
                let (at, depth) = (y * width + x, depths.at(x, y) as f32);
                if depth > self.depths[at] {
                    let colour = match paint {
                        Paint::Split(_, negative) if across.at(x, y) < 0.0 => negative,
                        Paint::Plain(colour) | Paint::Split(colour, _) => colour,
                    };
                    let light = lights.at(x, y).clamp(0.0, 1.0);
                    self.depths[at] = depth;
                    self.faces[at] = face;
                    self.colours[at] = colour.map(|c| (f64::from(c) * light) as u8);
                }
            }
        }
    }

    /// Lays a translucent square over what lies behind it.
    pub fn square(&mut self, corners: [Point; 4], colour: Rgb) {
        let flat = corners.map(|p| self.camera.project(&p));
        for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
            self.samples_of([flat[a], flat[b], flat[c]], |canvas, at, depth| {
                if depth > canvas.depths[at] {
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
            self.samples_of(corners.map(|i| flat[i]), |canvas, at, depth| {
                if over || depth >= canvas.depths[at] {
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
        for y in 0..width {
            let (row, below) = (y * width, (y + 1).min(width - 1) * width);
            for x in 0..width {
                let face = self.faces[row + x];
                if face != self.faces[row + (x + 1).min(width - 1)] || face != self.faces[below + x] {
                    self.colours[row + x] = blend(self.colours[row + x], [0; 3], OUTLINE);
                }
            }
        }
    }

    /// The colours of the pixels, row by row from the top.
    pub fn pixels(&self) -> impl Iterator<Item = Rgb> {
        (0..self.side * self.side).map(|i| self.mean(i % self.side, i / self.side))
    }

    /// The picture: the mean of the samples of each pixel.
    pub fn resolved(&self) -> Pixmap {
        let side = self.side.clamp(1, 16_384);
        let mut picture = Pixmap::new(side as u32, side as u32).expect("a side between 1 and 16384 is a valid size");
        picture.fill(Color::WHITE);
        for (pixel, [r, g, b]) in picture.pixels_mut().iter_mut().zip(self.pixels()) {
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

    /// Calls `draw` for each sample inside a triangle with the depth there.
    fn samples_of(&mut self, corners: [[f64; 3]; 3], mut draw: impl FnMut(&mut Self, usize, f32)) {
        let flat = corners.map(|[x, y, _]| [x, y]);
        let width = self.side * self.samples;
        let Some(triangle) = Triangle::new(flat, width) else { return };
        let depths = Ramp::new(&flat, corners.map(|c| c[2]));
        for (y, span) in triangle.spans() {
            span.for_each(|x| draw(self, y * width + x, depths.at(x, y) as f32));
        }
    }
}

fn blend(under: Rgb, over: Rgb, share: f32) -> Rgb {
    [0, 1, 2].map(|i| (f32::from(under[i]) * (1.0 - share) + f32::from(over[i]) * share) as u8)
}
