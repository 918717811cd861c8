//! Large plane faces as pictures. Most samples lie on a few of them, and most of their images too: a bit then tells what
//! a walk through the tree would.

use crate::brep::{Mesh, MeshFace, PlacedFaceId, Wireframe};
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::{Point, Vector, any_perpendicular};
use crate::silhouette::Silhouette;
use crate::silhouette::draw::Raster;

/// The least share of the whole area: one of a fortieth has a hundred samples of two rounds.
const LARGE: f64 = 0.025;
/// Faces of no more triangles than are remembered anyway need no picture.
const FEW_TRIANGLES: usize = 4;
/// The side of a pixel, how far points of the face may be off its plane, and how far images may, as shares of the radius:
/// what lies in a pixel that the face touches is within sqrt(2 * 0.6^2 + (0.45 + 0.05)^2) = 0.985 radii of the face.
const PIXEL: f64 = 0.6;
const FLAT: f64 = 0.05;
const OFF: f64 = 0.45;
/// Pixels on a side at most; a larger face is asked triangle by triangle.
const MOST_PIXELS: f64 = 1024.0;

/// The large plane faces of a mesh.
#[derive(Clone, Debug)]
pub struct Footprints {
    /// In the order of the faces.
    faces: Vec<(PlacedFaceId, Footprint)>,
}

/// A plane face: the pixels that it touches.
#[derive(Clone, Debug)]
pub struct Footprint {
    /// Unit normal of the plane; that of a triangle may differ as far as flatness allows.
    pub normal: Vector,
    axes: [Vector; 2],
    raster: Raster,
    /// How far off the plane points may be, mm.
    off: f64,
    picture: Silhouette,
}

impl Footprints {
    /// Of the faces of a mesh, for points within `radius` (mm) of them.
    ///
    /// # Errors
    /// When cancelled.
    pub fn of(mesh: &Mesh, radius: f64, cancel: &Cancel) -> Result<Self, Cancelled> {
        let large = LARGE * mesh.faces.iter().map(|f| f.area).sum::<f64>();
        let is_large = |f: &MeshFace| f.area >= large && f.triangles.len() > FEW_TRIANGLES;
        let mut faces = Vec::new();
        for (_, id) in mesh.faces.iter().zip((0..).map(PlacedFaceId)).filter(|(face, _)| is_large(face)) {
            faces.extend(Footprint::of(mesh, id, radius, cancel)?.map(|footprint| (id, footprint)));
        }
        Ok(Self { faces })
    }

    /// That of a face, if it has one.
    pub fn get(&self, face: PlacedFaceId) -> Option<&Footprint> {
        let position = self.faces.binary_search_by_key(&face, |(id, _)| *id).ok()?;
        Some(&self.faces[position].1)
    }
}

impl Footprint {
    /// `None` for faces that are not plane, or too large for a picture.
    fn of(mesh: &Mesh, id: PlacedFaceId, radius: f64, cancel: &Cancel) -> Result<Option<Self>, Cancelled> {
        let face = &mesh.faces[id.index()];
        let doubled: Vector = mesh.triangles_of(id).map(|t| mesh.doubled_normal(t)).sum();
        let Some(normal) = doubled.try_normalize(0.0) else { return Ok(None) };
        let first = any_perpendicular(&normal);
        let axes = [first, normal.cross(&first)];
        let (centre, points) = (face.centroid, mesh.points_of(id));
        let reach = |axis: &Vector| points.iter().map(|p| axis.dot(&(p - centre)).abs()).fold(0.0, f64::max);
        // Two more, so that nothing lies in the first pixels.
        let side = 2.0 * (reach(&axes[0]).max(reach(&axes[1])) / (PIXEL * radius)).ceil() + 4.0;
        if !(reach(&normal) <= FLAT * radius && side <= MOST_PIXELS) {
            return Ok(None);
        }
        let (face, raster) =
            (Wireframe::of(&alone(mesh, id)), Raster { centre, scale: 1.0 / (PIXEL * radius), side: side as usize });
        let [x, y] = axes.map(|axis| raster.project(&face, &axis));
        let picture = raster.draw(&face, [&x, &y], cancel)?;
        Ok(Some(Self { normal, axes, raster, off: OFF * radius, picture }))
    }

    /// Whether a point is surely within the radius of the face.
    #[inline]
    pub fn holds(&self, p: &Point) -> bool {
        let from_centre = p - self.raster.centre;
        // Truncated, not rounded down: nothing lies in the first pixels.
        let middle = 0.5 * self.raster.side as f64;
        let pixel = |axis: &Vector| (middle + self.raster.scale * axis.dot(&from_centre)) as isize;
        self.normal.dot(&from_centre).abs() <= self.off && self.picture.get(pixel(&self.axes[0]), pixel(&self.axes[1]))
    }
}

/// A mesh of one face.
fn alone(mesh: &Mesh, id: PlacedFaceId) -> Mesh {
    let face = &mesh.faces[id.index()];
    let points = mesh.points_of(id).to_vec();
    let own = |triangle: &[u32; 3]| triangle.map(|i| i - face.points.start);
    let triangles: Vec<_> = mesh.triangles[mesh.triangles_of(id)].iter().map(own).collect();
    let whole = MeshFace { points: 0..points.len() as u32, triangles: 0..triangles.len() as u32, ..face.clone() };
    Mesh { points, triangles, faces: vec![whole] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::shapes;
    use crate::geometry::bvh::nearest_on_triangle;

    /// The letter F of a prism's top, five high.
    fn letter_f() -> Mesh {
        let prism = shapes::letter_f(1.0);
        let top = |t: &&[u32; 3]| t.iter().all(|&i| prism.points[i as usize].z > 0.5);
        let triangles = prism.triangles.iter().filter(top).copied().collect();
        // The bottom's points belong to no triangle, but to the face.
        let points = prism.points.iter().map(|p| Point::new(p.x, p.y, 1.0)).collect();
        shapes::turned(&shapes::mesh(points, triangles), &shapes::rotation(0.3, 0.5, 0.7))
    }

    #[test]
    fn what_it_holds_is_near_and_what_lies_on_the_face_is_held() {
        let (mesh, radius) = (letter_f(), 0.05);
        let footprints = Footprints::of(&mesh, radius, &Cancel::new()).unwrap();
        let footprint = footprints.get(PlacedFaceId(0)).unwrap();
        let distance = |p: &Point| {
            let to = |t| (nearest_on_triangle(p, &mesh.corners(t)) - p).norm();
            (0..mesh.triangles.len()).map(to).fold(f64::INFINITY, f64::min)
        };
        let mut held = 0;
        for i in 0..4000 {
            let share = |step: f64| (f64::from(i) * step).fract() - 0.5;
            let flat = footprint.axes[0] * share(0.754_877_666) + footprint.axes[1] * share(0.569_840_291);
            let on_plane = footprint.raster.centre + flat * 6.0;
            let p = on_plane + footprint.normal * (share(0.43) * 2.0 * radius);
            held += usize::from(footprint.holds(&p));
            assert!(!footprint.holds(&p) || distance(&p) <= radius, "{p}");
            assert!(footprint.holds(&on_plane) || distance(&on_plane) > 1e-9, "{on_plane}");
        }
        // 8 of 36 in the plane, and of these 0.45: some 400.
        assert!((300..460).contains(&held), "{held}");
    }

    #[test]
    fn bent_faces_and_faces_of_few_triangles_have_none() {
        let has_picture = |mesh: &Mesh, radius: f64| {
            Footprints::of(mesh, radius, &Cancel::new()).unwrap().get(PlacedFaceId(0)).is_some()
        };
        let has_one = |mesh: &Mesh| has_picture(mesh, 0.05);
        assert!(!has_one(&shapes::cuboid(1.0, 1.0, 1.0)) && !has_one(&shapes::rectangle(1.0, 1.0)));
        assert!(has_one(&letter_f()) && !has_picture(&letter_f(), 1e-4) && !has_picture(&letter_f(), f64::NAN));
        let cancel = Cancel::new();
        cancel.cancel();
        assert!(Footprints::of(&letter_f(), 0.05, &cancel).is_err());
    }
}
