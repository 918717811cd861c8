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

/// Samples of depth, of what is seen there, and, once the surfaces are shaded, of colour.
pub struct Canvas {
    camera: Camera,
    side: usize,
    samples: usize,
    depths: Vec<f32>,
    /// Which of the surfaces.
    seen: Vec<u32>,
    surfaces: Vec<Surface>,
    colours: Vec<Rgb>,
}

/// What a triangle looks like.
struct Surface {
    face: u32,
    paint: Paint,
    light: Ramp,
    across: Ramp,
}

impl Surface {
    fn colour(&self, x: usize, y: usize) -> Rgb {
        let colour = match self.paint {
            Paint::Split(_, negative) if self.across.at(x, y) < 0.0 => negative,
            Paint::Plain(colour) | Paint::Split(colour, _) => colour,
        };
        let light = self.light.at(x, y).clamp(0.0, 1.0);
        colour.map(|c| (f64::from(c) * light) as u8)
    }
}

/// The surface of samples where none is seen.
const NOTHING: u32 = u32::MAX;
const WHITE: Rgb = [255; 3];
/// How dark the outlines of faces are.
const OUTLINE: f32 = 0.45;
/// How opaque planes are.
const PLANE: f32 = 0.38;

impl Canvas {
    /// A white picture of `side` by `side` pixels with `samples` by `samples` samples each.
    pub fn new(camera: Camera, side: usize, samples: usize) -> Self {
        let count = (side * samples).pow(2);
        let (depths, seen) = (vec![f32::NEG_INFINITY; count], vec![NOTHING; count]);
        Self { camera, side, samples, depths, seen, surfaces: Vec::new(), colours: Vec::new() }
    }

    /// Where the picture is taken from.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Places a triangle where nothing nearer is placed yet.
    pub fn triangle(&mut self, corners: [&Corner; 3], paint: Paint, face: u32) {
        let flat = corners.map(|c| [c.at[0], c.at[1]]);
        let width = self.side * self.samples;
        let Some(triangle) = Triangle::new(flat, width) else { return };
        let ramp = |value: fn(&Corner) -> f64| Ramp::new(&flat, corners.map(value));
        let depths = ramp(|c| c.at[2]);
        let surface = self.surfaces.len() as u32;
        let mut shows = false;
        for (y, span) in triangle.spans() {
            let row = y * width + span.start..y * width + span.end.max(span.start);
            for ((x, nearest), seen) in span.zip(&mut self.depths[row.clone()]).zip(&mut self.seen[row]) {
                let depth = depths.at(x, y) as f32;
                if depth > *nearest {
                    (*nearest, *seen, shows) = (depth, surface, true);
                }
            }
        }
        if shows {
            self.surfaces.push(Surface { face, paint, light: ramp(|c| c.light), across: ramp(|c| c.across) });
        }
    }

    /// Gives the samples their colours: those of the surfaces that are seen, darker where one face borders on another
    /// or on the background.
    pub fn shade(&mut self) {
        let width = self.side * self.samples;
        let mut colours = vec![WHITE; self.seen.len()];
        for (y, row) in colours.chunks_exact_mut(width.max(1)).enumerate() {
            let seen = &self.seen[y * width..];
            let below = &self.seen[(y + 1).min(width - 1) * width..];
            for (x, colour) in row.iter_mut().enumerate() {
                let (own, right) = (seen[x], seen[(x + 1).min(width - 1)]);
                if let Some(surface) = self.surfaces.get(own as usize) {
                    *colour = surface.colour(x, y);
                }
                if self.borders(own, right) || self.borders(own, below[x]) {
                    *colour = blend(*colour, [0; 3], OUTLINE);
                }
            }
        }
        self.colours = colours;
    }

    /// Whether surfaces belong to different faces.
    #[inline]
    fn borders(&self, a: u32, b: u32) -> bool {
        let face = |surface: u32| self.surfaces.get(surface as usize).map(|s| s.face);
        a != b && face(a) != face(b)
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

    /// The colours of the pixels, row by row from the top.
    pub fn pixels(&self) -> impl Iterator<Item = Rgb> {
        let rows = self.colours.chunks_exact((self.side * self.samples * self.samples).max(1));
        rows.flat_map(|row| self.means(row))
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

    /// The mean of the samples of each pixel of a row.
    fn means(&self, row: &[Rgb]) -> Vec<Rgb> {
        let n = self.samples;
        let mut sums = vec![[0u32; 3]; self.side];
        for samples in row.chunks_exact(self.side * n) {
            for (sum, pixel) in sums.iter_mut().zip(samples.chunks_exact(n)) {
                pixel.iter().for_each(|colour| (0..3).for_each(|c| sum[c] += u32::from(colour[c])));
            }
        }
        let count = (n * n) as u32;
        sums.into_iter().map(|sum| sum.map(|s| (s / count) as u8)).collect()
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
