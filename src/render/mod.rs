//! Pictures of models: shaded, anti-aliased, hidden surfaces hidden.
//!
//! Known to `geometry`, `brep` and (in [`figures`]) the outputs of the stages. [`shaded`] draws a mesh by a z-buffer
//! with more samples than pixels; PNGs are encoded by tiny-skia, and curves drawn by kuva.

mod camera;
mod canvas;
pub mod figures;
mod plot;
mod text;
mod triangle;

use tiny_skia::Pixmap;

use crate::brep::measure::Measures;
use crate::brep::{Mesh, MeshFace, PlacedFaceId};
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::{Frame, Plane, Point, Vector};

pub use camera::Camera;
use canvas::Corner;
pub use canvas::{Canvas, Paint, Rgb};
pub use plot::area_curve;
use triangle::cell;

/// Pixels on a side of a thumbnail.
pub const THUMBNAIL: usize = 96;

/// Samples to a pixel, along each side: 3 is the least that shows no stairs.
const SAMPLES: usize = 3;
/// Thumbnails are looked at in passing.
const THUMBNAIL_SAMPLES: usize = 2;
/// The share of light that reaches faces turned away from the lamp.
const AMBIENT: f64 = 0.5;
/// Plain surfaces.
pub const GREY: Rgb = [176, 180, 186];

/// What is drawn: a mesh as seen from the corner of its frame.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    /// The model.
    pub mesh: &'a Mesh,
    /// What it measures.
    pub measures: &'a Measures,
    /// The frame it is seen in.
    pub frame: &'a Frame,
    /// The plane that [`Paint::Split`] splits at.
    pub plane: Option<Plane>,
    /// Points beside the model that the picture must hold.
    pub also: &'a [Point],
    /// Leaves the rest of the picture out when cancelled.
    pub cancel: &'a Cancel,
}

/// Draws the faces, each in its paint, on white, with their outlines; `side` pixels wide and high, of `samples` by
/// `samples` samples each.
///
/// The picture is not yet resolved, so that planes may be laid over it.
pub fn shaded(scene: &Scene, paint: &dyn Fn(PlacedFaceId) -> Paint, side: usize, samples: usize) -> Canvas {
    let camera = Camera::from_corner(scene.mesh, scene.measures, scene.frame, side * samples).including(scene.also);
    let mut canvas = Canvas::new(camera, side, samples);
    let corners = corners(scene, &camera, side * samples);
    let of_face = |id| scene.mesh.triangles[scene.mesh.triangles_of(id)].iter().map(move |triangle| (id, triangle));
    let triangles = nearest_first(scene.mesh, &corners).flat_map(of_face);
    for (id, triangle) in triangles.take_while(|_| !scene.cancel.is_cancelled()) {
        canvas.triangle(triangle.map(|i| &corners[i as usize]), paint(id), id.0);
    }
    canvas.shade();
    canvas
}

/// The faces in the order of their nearest points: what comes late is mostly hidden.
fn nearest_first(mesh: &Mesh, corners: &[Corner]) -> impl Iterator<Item = PlacedFaceId> {
    let nearest = |face: &MeshFace| {
        let corners = &corners[face.points.start as usize..face.points.end as usize];
        corners.iter().map(|c| c.at[2]).fold(f64::NEG_INFINITY, f64::max)
    };
    let mut faces: Vec<_> = mesh.faces.iter().map(nearest).zip(0..).collect();
    faces.sort_unstable_by(|a: &(f64, u32), b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    faces.into_iter().map(|(_, number)| PlacedFaceId(number))
}

/// A grey picture of the model for stores and galleries: [`THUMBNAIL`]^2 bytes, row by row from the top, 255 is white.
///
/// # Errors
/// When cancelled.
pub fn thumbnail(mesh: &Mesh, measures: &Measures, frame: &Frame, cancel: &Cancel) -> Result<Vec<u8>, Cancelled> {
    let scene = Scene { mesh, measures, frame, plane: None, also: &[], cancel };
    let canvas = shaded(&scene, &|_| Paint::Plain(GREY), THUMBNAIL, THUMBNAIL_SAMPLES);
    cancel.check()?;
    Ok(canvas.pixels().into_iter().map(luminance).collect())
}

/// The PNG file of a picture.
pub fn png(picture: &Pixmap) -> std::io::Result<Vec<u8>> {
    picture.encode_png().map_err(std::io::Error::other)
}

fn luminance([r, g, b]: Rgb) -> u8 {
    ((u32::from(r) * 299 + u32::from(g) * 587 + u32::from(b) * 114 + 500) / 1000) as u8
}

/// The points of the mesh as the camera sees them. Their light follows Lambert's law on both sides, with normals averaged
/// over the triangles that meet there (points belong to one face, so that edges stay sharp).
fn corners(scene: &Scene, camera: &Camera, width: usize) -> Vec<Corner> {
    let mut normals = vec![Vector::zeros(); scene.mesh.points.len()];
    for (t, corners) in scene.mesh.triangles.iter().enumerate() {
        let normal = scene.mesh.doubled_normal(t);
        corners.iter().for_each(|&i| normals[i as usize] += normal);
    }
    let lamp = camera.lamp();
    let light = |normal: &Vector| {
        let length = normal.norm();
        if length > 0.0 { AMBIENT + (1.0 - AMBIENT) * lamp.dot(normal).abs() / length } else { AMBIENT }
    };
    let across = |p: &Point| scene.plane.map_or(0.0, |plane| plane.signed_distance(p));
    let corner = |(p, normal)| {
        let at = camera.project(p);
        Corner { at, cell: cell([at[0], at[1]], width), light: light(normal), across: across(p) }
    };
    scene.mesh.points.iter().zip(&normals).map(corner).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::shapes;

    fn own_frame(measures: &Measures) -> Frame {
        Frame { axes: [Vector::x(), Vector::y(), Vector::z()], origin: measures.centroid }
    }

    #[test]
    fn a_thumbnail_shows_three_sides_of_a_box_in_three_greys() {
        let mesh = shapes::cuboid(1.0, 1.0, 1.0);
        let measures = shapes::measures(&mesh);
        let cancel = Cancel::new();
        let picture = thumbnail(&mesh, &measures, &own_frame(&measures), &cancel).unwrap();
        cancel.cancel();
        assert!(thumbnail(&mesh, &measures, &own_frame(&measures), &cancel).is_err());
        assert_eq!(picture.len(), THUMBNAIL * THUMBNAIL);
        assert_eq!(picture[0], 255, "the corner is background");
        assert!(picture[THUMBNAIL * 48 + 48] < 240, "the middle is the box");
    }

    #[test]
    fn the_nearer_of_two_sheets_hides_the_other() {
        let near = shapes::mapped(&shapes::rectangle(2.0, 2.0), |p| p + Vector::new(0.0, 0.0, 1.0));
        let mut mesh = shapes::joined(&near, &shapes::rectangle(2.0, 2.0));
        let (mut first, mut second) = (mesh.faces[0].clone(), mesh.faces[0].clone());
        (first.triangles, second.triangles) = (0..2, 2..4);
        mesh.faces = vec![first, second];
        let measures = shapes::measures(&mesh);
        let frame = own_frame(&measures);
        let scene =
            Scene { mesh: &mesh, measures: &measures, frame: &frame, plane: None, also: &[], cancel: &Cancel::new() };
        let paint = |id: PlacedFaceId| Paint::Plain(if id.0 == 0 { [200, 0, 0] } else { [0, 0, 200] });
        let canvas = shaded(&scene, &paint, 64, SAMPLES);
        let [x, y, _] =
            canvas.camera().project(&Point::new(1.0, 1.0, if canvas.camera().lamp().z > 0.0 { 1.0 } else { 0.0 }));
        let picture = canvas.resolved();
        let pixel = picture.pixel(x as u32 / SAMPLES as u32, y as u32 / SAMPLES as u32).unwrap();
        assert!(pixel.red().abs_diff(pixel.blue()) > 80, "{pixel:?}");
    }
}
