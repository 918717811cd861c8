//! The paper's figures of one model, as PNG files.

use std::io;
use std::path::{Path, PathBuf};

use tiny_skia::{Color, Paint as Fill, Pixmap, PremultipliedColorU8, Rect, Transform};

use crate::brep::PlacedFaceId;
use crate::cancel::Cancel;
use crate::geometry::{Frame, Plane, Point};
use crate::silhouette::Silhouette;
use crate::stages::merge::{Label, Symmetries};
use crate::stages::parse::Parsed;
use crate::stages::projection_sweep::CanonicalFrame;

use super::camera::extent;
use super::text;
use super::{Camera, Canvas, GREY, Paint, Rgb, SAMPLES, Scene, area_curve, png, shaded};

/// Pixels on a side of a figure.
const SIDE: usize = 800;
const BLUE: Rgb = [52, 108, 214];
const RED: Rgb = [216, 58, 52];
const GREEN: Rgb = [46, 160, 84];
/// The symmetry plane in figure 3.
const SLATE: Rgb = [110, 118, 135];
const PURPLE: Rgb = [150, 90, 190];
/// First, second and third canonical plane, as in the paper's figure 5.
const PLANES: [Rgb; 3] = [RED, BLUE, GREEN];
/// Planes reach beyond the model by this share of D.
const OVERHANG: f64 = 0.06;
/// Width of the borders of planes and of axes, pixels.
const LINE: f64 = 1.6;
/// Axes reach beyond their planes by this share of D, and the middle of their names by this much more.
const AXIS: f64 = 0.07;
/// Pixels to a point of the font.
const FONT: usize = 2;
/// White between two silhouettes, pixels.
const GAP: usize = 12;

/// Writes the figures of a model into `dir`: `<name>-symmetry.png` (figure 3), `<name>-silhouettes.png`,
/// `<name>-areas.png` (figure 4) and `<name>-frame.png` (figure 5). Returns the files.
///
/// Errors: a file cannot be written.
pub fn render_all(
    dir: &Path,
    name: &str,
    parsed: &Parsed,
    symmetries: &Symmetries,
    canonical: &CanonicalFrame,
    views: &[Silhouette; 3],
) -> io::Result<Vec<PathBuf>> {
    let pictures = [
        ("symmetry", png(&symmetry(parsed, symmetries, &canonical.frame))?),
        ("silhouettes", png(&silhouettes(views))?),
        ("areas", areas(canonical)?),
        ("frame", png(&frame(parsed, &canonical.frame))?),
    ];
    std::fs::create_dir_all(dir)?;
    let write = |(figure, picture): &(&str, Vec<u8>)| {
        let path = dir.join(format!("{name}-{figure}.png"));
        std::fs::write(&path, picture).map(|()| path)
    };
    pictures.iter().map(write).collect()
}

/// The dominant symmetry (figure 3): mirrored faces blue on one side and red on the other, the rest grey, the plane.
pub fn symmetry(parsed: &Parsed, symmetries: &Symmetries, frame: &Frame) -> Pixmap {
    let best = symmetries.planes.first().filter(|_| symmetries.label != Label::None);
    let plane = best.map(|found| found.plane);
    let mut paints = vec![Paint::Plain(GREY); parsed.mesh.faces.len()];
    if let Some(found) = best {
        let paired = found.pairs.iter().flat_map(|(a, b)| [*a, *b]);
        paired.chain(found.selfs.iter().copied()).for_each(|id| paints[id.index()] = Paint::Split(BLUE, RED));
        let whole = |id: &PlacedFaceId| parsed.mesh.points_of(*id).iter().all(|p| on_plane(&found.plane, p, parsed));
        found.selfs.iter().filter(|id| whole(id)).for_each(|id| paints[id.index()] = Paint::Plain(PURPLE));
    }
    let sheet = plane.map(|plane| sheet(parsed, frame, 0, &plane));
    let also = sheet.map(Vec::from).unwrap_or_default();
    let scene =
        Scene { mesh: &parsed.mesh, measures: &parsed.measures, frame, plane, also: &also, cancel: &Cancel::new() };
    let mut canvas = shaded(&scene, &|id| paints[id.index()], SIDE, SAMPLES);
    if let Some(corners) = sheet {
        lay(&mut canvas, corners, SLATE);
    }
    canvas.resolved()
}

/// Whether a point lies on the plane, but for a thousandth of the model's size.
fn on_plane(plane: &Plane, p: &Point, parsed: &Parsed) -> bool {
    plane.signed_distance(p).abs() < parsed.measures.tolerance.length(1e-3)
}

/// The model with the three canonical planes and their normals, the axes (figure 5).
pub fn frame(parsed: &Parsed, frame: &Frame) -> Pixmap {
    let plane = |i: usize| Plane::through(&frame.origin, &frame.axes[i]);
    let sheets = [0, 1, 2].map(|i| sheet(parsed, frame, i, &plane(i)));
    let tips = [0, 1, 2].map(|i| tip(parsed, frame, i, AXIS));
    let names = [0, 1, 2].map(|i| tip(parsed, frame, i, 1.6 * AXIS));
    let also: Vec<_> = sheets.iter().flatten().chain(&names).copied().collect();
    let scene = Scene {
        mesh: &parsed.mesh,
        measures: &parsed.measures,
        frame,
        plane: None,
        also: &also,
        cancel: &Cancel::new(),
    };
    let mut canvas = shaded(&scene, &|_| Paint::Plain(GREY), SIDE, SAMPLES);
    for (corners, colour) in sheets.into_iter().zip(PLANES) {
        lay(&mut canvas, corners, colour);
    }
    for (tip, colour) in tips.into_iter().zip(PLANES) {
        canvas.line([frame.origin, tip], 1.5 * LINE, colour, true);
    }
    let mut picture = canvas.resolved();
    for (i, point) in names.iter().enumerate() {
        let [x, y] = canvas.pixel_of(point);
        text::write(&mut picture, &format!("e{i}"), [x, y - 0.5 * text::height(FONT) as f32], FONT);
    }
    picture
}

/// The end of an axis: beyond the model's end towards the eye.
fn tip(parsed: &Parsed, frame: &Frame, i: usize, beyond: f64) -> Point {
    let axis = Camera::from_corner(&parsed.mesh, &parsed.measures, frame, SIDE).facing(&frame.axes[i]);
    let (_, high) = extent(&parsed.mesh, &parsed.measures, &axis);
    let end = axis.dot(&(parsed.measures.centroid - frame.origin)) + high;
    frame.origin + axis * (end + parsed.measures.tolerance.length(OVERHANG + beyond))
}

/// The corners of the plane at right angles to axis `i`, a little larger than the model.
fn sheet(parsed: &Parsed, frame: &Frame, i: usize, plane: &Plane) -> [Point; 4] {
    let middle = plane.project(&parsed.measures.centroid);
    let overhang = parsed.measures.tolerance.length(OVERHANG);
    let [a, b] = [&frame.axes[(i + 1) % 3], &frame.axes[(i + 2) % 3]];
    let [(left, right), (low, high)] = [a, b].map(|axis| extent(&parsed.mesh, &parsed.measures, axis));
    let corner = |x: f64, y: f64| middle + a * x + b * y;
    let (left, right, low, high) = (left - overhang, right + overhang, low - overhang, high + overhang);
    [corner(left, low), corner(right, low), corner(right, high), corner(left, high)]
}

/// Lays a translucent plane with its border over the picture.
fn lay(canvas: &mut Canvas, corners: [Point; 4], colour: Rgb) {
    canvas.square(corners, colour);
    (0..4).for_each(|i| canvas.line([corners[i], corners[(i + 1) % 4]], LINE, colour, false));
}

/// The projected areas of the planes tried (figure 4), the chosen one marked, as a PNG file.
///
/// # Errors
/// What the drawing library says.
pub fn areas(canonical: &CanonicalFrame) -> io::Result<Vec<u8>> {
    let sweep = &canonical.sweep;
    area_curve(&sweep.angles, &sweep.areas, sweep.chosen)
}

/// The three silhouettes side by side, each framed in the colour of its plane.
pub fn silhouettes(views: &[Silhouette; 3]) -> Pixmap {
    let side = views[0].side();
    let (width, height) = (3 * side + 4 * GAP, side + 2 * GAP);
    let mut picture = Pixmap::new(width as u32, height as u32).expect("the gaps alone make the size positive");
    picture.fill(Color::WHITE);
    for (i, view) in views.iter().enumerate() {
        let left = GAP + i * (side + GAP);
        border(&mut picture, left, side, PLANES[i]);
        draw_bits(&mut picture, view, left);
    }
    picture
}

fn border(picture: &mut Pixmap, left: usize, side: usize, [r, g, b]: Rgb) {
    let mut fill = Fill::default();
    for (colour, wide) in [(Color::from_rgba8(r, g, b, 255), 4.0), (Color::WHITE, 0.0)] {
        fill.set_color(colour);
        let (x, y, size) = (left as f32 - wide, GAP as f32 - wide, side as f32 + 2.0 * wide);
        if let Some(rect) = Rect::from_xywh(x, y, size, size) {
            picture.fill_rect(rect, &fill, Transform::identity(), None);
        }
    }
}

fn draw_bits(picture: &mut Pixmap, view: &Silhouette, left: usize) {
    let width = picture.width() as usize;
    let black = PremultipliedColorU8::from_rgba(30, 30, 36, 255).expect("no channel is above alpha");
    for y in 0..view.side() {
        let row = (GAP + view.side() - 1 - y) * width + left;
        for x in (0..view.side()).filter(|x| view.get(*x as isize, y as isize)) {
            picture.pixels_mut()[row + x] = black;
        }
    }
}
