//! A z-buffer with several samples to a pixel.

use tiny_skia::{Color, Pixmap, PremultipliedColorU8};

use crate::geometry::Point;
use crate::geometry::order::more;

use super::Camera;
use super::triangle::{Ramp, Samples, Triangle, cell};

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
    /// The samples whose centres it lies before: columns, rows.
    pub cell: [u32; 2],
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
    /// Gives samples of a row, from the first on, the colours of the surface there.
    fn colour(&self, row: &mut [Rgb], first: usize, y: usize) {
        let (light, across) = (self.light.row(y), self.across.row(y));
        let lit = |colour: [f64; 3], x| {
            let light = light.at(x).clamp(0.0, 1.0);
            colour.map(|c| (c * light) as u8)
        };
        let samples = (first..).zip(row);
        match self.paint {
            Paint::Plain(colour) => {
                let colour = colour.map(f64::from);
                samples.for_each(|(x, sample)| *sample = lit(colour, x));
            }
            Paint::Split(positive, negative) => {
                let [positive, negative] = [positive, negative].map(|colour| colour.map(f64::from));
                let colour = |x| if across.at(x) < 0.0 { negative } else { positive };
                samples.for_each(|(x, sample)| *sample = lit(colour(x), x));
            }
        }
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
        let (flat, cells) = (corners.map(|c| [c.at[0], c.at[1]]), corners.map(|c| c.cell));
        let width = self.side * self.samples;
        let Some(samples) = Samples::of(&cells).filter(|samples| !self.hides(samples, &corners)) else { return };
        let Some(triangle) = Triangle::new(flat, &samples, width) else { return };
        let ramp = |value: fn(&Corner) -> f64| Ramp::new(&flat, corners.map(value));
        let depths = ramp(|c| c.at[2]);
        let surface = self.surfaces.len() as u32;
        let mut shows = false;
        triangle.each_span(|y, span| {
            let (depths, row) = (depths.row(y), y * width + span.start..y * width + span.end);
            for ((x, nearest), seen) in span.zip(&mut self.depths[row.clone()]).zip(&mut self.seen[row]) {
                let depth = depths.at(x) as f32;
                if depth > *nearest {
                    (*nearest, *seen, shows) = (depth, surface, true);
                }
            }
        });
        if shows {
            self.surfaces.push(Surface { face, paint, light: ramp(|c| c.light), across: ramp(|c| c.across) });
        }
    }

    /// Whether a triangle lies behind what is placed in all of its box of samples: the triangles that come late do.
    fn hides(&self, samples: &Samples, corners: &[&Corner; 3]) -> bool {
        let [a, b, c] = corners.map(|corner| corner.at[2]);
        let (nearest, width) = (more(more(a, b), c) as f32, self.side * self.samples);
        let mut rows = samples.rows.clone();
        rows.all(|y| {
            let row = &self.depths[y * width..(y + 1) * width];
            row[samples.columns.clone()].iter().all(|depth| *depth >= nearest)
        })
    }

    /// Gives the samples their colours: those of the surfaces that are seen, darker where one face borders on another
    /// or on the background.
    pub fn shade(&mut self) {
        let width = (self.side * self.samples).max(1);
        let mut colours = vec![WHITE; self.seen.len()];
        for (y, row) in colours.chunks_exact_mut(width).enumerate() {
            let seen = &self.seen[y * width..(y + 1) * width];
            let below = &self.seen[(y + 1).min(width - 1) * width..];
            let mut first = 0;
            for run in seen.chunk_by(|a, b| a == b) {
                let (own, end) = (run[0], first + run.len());
                let row = &mut row[first..end];
                if let Some(surface) = self.surfaces.get(own as usize) {
                    surface.colour(row, first, y);
                }
                self.outline(row, own, &below[first..end], seen.get(end));
                first = end;
            }
        }
        self.colours = colours;
    }

    /// Darkens those samples of one surface that border on another face below, and the last one also to the right.
    fn outline(&self, row: &mut [Rgb], own: u32, below: &[u32], right: Option<&u32>) {
        for (colour, below) in row.iter_mut().zip(below) {
            if self.borders(own, *below) {
                *colour = blend(*colour, [0; 3], OUTLINE);
            }
        }
        if let (Some(colour), Some(below), Some(right)) = (row.last_mut(), below.last(), right)
            && self.borders(own, *right)
            && !self.borders(own, *below)
        {
            *colour = blend(*colour, [0; 3], OUTLINE);
        }
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

    /// The colours of the pixels, row by row from the top: the means of their samples.
    pub fn pixels(&self) -> Vec<Rgb> {
        let (n, width) = (self.samples, self.side * self.samples);
        // Exact for sums of up to 64 by 64 bytes.
        let share = (1 << 32) / (n * n).max(1) as u64 + 1;
        let mean = |sum: u32| ((u64::from(sum) * share) >> 32) as u8;
        let mut pixels = Vec::with_capacity(self.side * self.side);
        let mut sums = vec![[0; 3]; width];
        for rows in self.colours.chunks_exact((width * n).max(1)) {
            sums.fill([0; 3]);
            for row in rows.chunks_exact(width) {
                let colours = row.as_flattened().iter();
                sums.as_flattened_mut().iter_mut().zip(colours).for_each(|(sum, c)| *sum += u32::from(*c));
            }
            let add = |sum: [u32; 3], sample: &[u32; 3]| [0, 1, 2].map(|c| sum[c] + sample[c]);
            pixels.extend(sums.chunks_exact(n).map(|pixel| pixel.iter().fold([0; 3], add).map(mean)));
        }
        pixels
    }

    /// The picture of the pixels.
    pub fn resolved(&self) -> Pixmap {
        let side = self.side.clamp(1, 16_384);
        let mut picture = Pixmap::new(side as u32, side as u32).expect("a side between 1 and 16384 is a valid size");
        picture.fill(Color::WHITE);
        for (pixel, [r, g, b]) in picture.pixels_mut().iter_mut().zip(self.pixels()) {
            *pixel = PremultipliedColorU8::from_rgba(r, g, b, 255).unwrap_or(*pixel);
        }
        picture
    }

    /// Calls `draw` for each sample inside a triangle with the depth there.
    fn samples_of(&mut self, corners: [[f64; 3]; 3], mut draw: impl FnMut(&mut Self, usize, f32)) {
        let flat = corners.map(|[x, y, _]| [x, y]);
        let width = self.side * self.samples;
        let Some(samples) = Samples::of(&flat.map(|corner| cell(corner, width))) else { return };
        let Some(triangle) = Triangle::new(flat, &samples, width) else { return };
        let depths = Ramp::new(&flat, corners.map(|c| c[2]));
        triangle.each_span(|y, span| {
            let depths = depths.row(y);
            span.for_each(|x| draw(self, y * width + x, depths.at(x) as f32));
        });
    }
}

fn blend(under: Rgb, over: Rgb, share: f32) -> Rgb {
    [0, 1, 2].map(|i| (f32::from(under[i]) * (1.0 - share) + f32::from(over[i]) * share) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::shapes;
    use crate::geometry::{Frame, Vector};

    /// An empty picture; places in it are given in samples, so that the camera does not matter.
    fn canvas(side: usize, samples: usize) -> Canvas {
        let mesh = shapes::cuboid(1.0, 1.0, 1.0);
        let frame = Frame { axes: [Vector::x(), Vector::y(), Vector::z()], origin: Point::origin() };
        let camera = Camera::from_corner(&mesh, &shapes::measures(&mesh), &frame, side * samples);
        Canvas::new(camera, side, samples)
    }

    /// A fully lit grey face over some columns and rows.
    fn rectangle(canvas: &mut Canvas, face: u32, columns: [f64; 2], rows: [f64; 2], depth: f64, grey: u8) {
        let width = canvas.side * canvas.samples;
        let corner = |x, y| Corner { at: [x, y, depth], cell: cell([x, y], width), light: 1.0, across: 0.0 };
        let [a, b] = columns.map(|x| corner(x, rows[0]));
        let [d, c] = columns.map(|x| corner(x, rows[1]));
        canvas.triangle([&a, &b, &c], Paint::Plain([grey; 3]), face);
        canvas.triangle([&a, &c, &d], Paint::Plain([grey; 3]), face);
    }

    #[test]
    fn faces_behind_a_bar_show_above_and_below_it_and_are_outlined_once() {
        let mut canvas = canvas(8, 1);
        rectangle(&mut canvas, 0, [0.0, 8.0], [2.0, 4.0], 2.0, 210);
        rectangle(&mut canvas, 1, [1.0, 3.0], [0.0, 3.0], 1.0, 110);
        rectangle(&mut canvas, 2, [4.0, 6.0], [3.0, 7.0], 1.0, 50);
        canvas.shade();
        // Outlines leave 55 % of 255, 210, 110 and 50.
        let letter = |[grey, ..]: &Rgb| match grey {
            255 => '.',
            140 => ',',
            210 => 'A',
            115 => 'a',
            110 => 'B',
            60 => 'b',
            50 => 'C',
            27 => 'c',
            _ => '?',
        };
        let picture: Vec<String> = canvas.pixels().chunks(8).map(|row| row.iter().map(letter).collect()).collect();
        let expected = [",Bb.....", ",bb,,,,,", "AAAAAAAA", "aaaaaaaa", "...,Cc..", "...,Cc..", "...,cc..", "........"];
        assert_eq!(picture, expected);
    }

    #[test]
    fn pixels_of_one_colour_have_that_colour() {
        // A ninth has no end in binary: rounded down it would leave 254, 6 and 99.
        let mut canvas = canvas(2, 3);
        canvas.colours = vec![[255, 7, 100]; 36];
        assert_eq!(canvas.pixels(), [[255, 7, 100]; 4]);
    }
}
