//! Projected areas by counting pixels, as the paper does; also the reference that holds the exact spans.

use tiny_skia::{FillRule, Mask, PathBuilder, Transform};

use crate::brep::Mesh;
use crate::brep::measure::Measures;
use crate::cancel::{Cancel, Cancelled};

use super::curve::Shadows;
use super::reference::Turntable;

/// Triangles to one path: fastest of those measured (one path for all is twice as slow).
const CHUNK: usize = 64;

/// Draws the mesh on each plane and counts the pixels whose centres are covered.
pub struct PixelShadows<'a> {
    mesh: &'a Mesh,
    table: &'a Turntable,
    side: u32,
    /// Pixels to the mm: the bounding ball about the centroid just fits.
    scale: f64,
}

impl<'a> PixelShadows<'a> {
    /// Pictures of `side` by `side` pixels that hold the whole model.
    pub(super) fn new(mesh: &'a Mesh, measures: &Measures, table: &'a Turntable, side: u32) -> Self {
        let side = side.clamp(8, 4096);
        Self { mesh, table, side, scale: f64::from(side) / measures.tolerance.size() }
    }

    /// The picture of the model on the plane at an angle, 255 where covered.
    fn draw(&self, angle: f64) -> Option<Mask> {
        let across = self.table.direction(angle + std::f64::consts::FRAC_PI_2);
        let middle = 0.5 * f64::from(self.side);
        let flat = |i: u32| {
            let d = self.mesh.points[i as usize] - self.table.centre;
            [across.dot(&d), self.table.axis.dot(&d)].map(|c| (middle + self.scale * c) as f32)
        };
        let mut mask = Mask::new(self.side, self.side)?;
        for chunk in self.mesh.triangles.chunks(CHUNK) {
            let mut path = PathBuilder::new();
            chunk.iter().for_each(|t| push_oriented(&mut path, t.map(flat)));
            if let Some(path) = path.finish() {
                mask.fill_path(&path, FillRule::Winding, false, Transform::identity());
            }
        }
        Some(mask)
    }
}

/// Adds a triangle counter-clockwise: front and back faces in one winding path would cancel out.
fn push_oriented(path: &mut PathBuilder, [a, b, c]: [[f32; 2]; 3]) {
    let doubled = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let (b, c) = if doubled < 0.0 { (c, b) } else { (b, c) };
    path.move_to(a[0], a[1]);
    path.line_to(b[0], b[1]);
    path.line_to(c[0], c[1]);
    path.close();
}

impl Shadows for PixelShadows<'_> {
    fn areas(&mut self, angles: &[f64], cancel: &Cancel) -> Result<Vec<f64>, Cancelled> {
        let pixel = 1.0 / (self.scale * self.scale);
        let count = |mask: Mask| mask.data().iter().filter(|covered| **covered > 0).count();
        angles.iter().map(|&angle| cancel.check().map(|()| self.draw(angle).map_or(0, count) as f64 * pixel)).collect()
    }
}
