//! A model in its canonical pose, as a file that other programs open.
//!
//! The axes e0, e1, e2 of a frame become x, y, z and its origin the origin. [`pose`] gives the axes the signs that
//! they do not have by themselves; [`glb()`], [`stl()`] and [`obj()`] write the triangles, and
//! [`crate::stages::parse::relocated`] moves the B-rep of a STEP file.

mod glb;
mod obj;
mod parts;
mod stl;

pub use glb::glb;
pub use obj::obj;
pub use stl::stl;

use crate::brep::{Mesh, measure::Measures};
use crate::geometry::{Chirality, Frame, Isometry, Matrix, Point, Vector};

/// A model is lopsided along an axis if its third moment exceeds this share of area times the cube of D / 2: above
/// what the triangles of a symmetric model make up by chance.
const LOPSIDED: f64 = 1e-3;

/// The proper motion that takes the frame's origin to the origin and its axes to x, y and z.
///
/// A frame's axes have no sign. Here the two along which the surface is most lopsided point to where it reaches
/// farther from the frame's origin (the sign of the third moment), whatever the pose of the file; where it is not
/// lopsided, the first coordinate of the axis that is not near zero is positive. The third axis makes the three
/// right-handed.
pub fn pose(frame: &Frame, mesh: &Mesh, measures: &Measures) -> Isometry {
    let radius = measures.tolerance.length(0.5);
    let lopsided = frame.axes.map(|axis| {
        let moment = third_moment(mesh, &frame.origin, &axis) / (measures.area * radius.powi(3));
        if moment.abs() > LOPSIDED { moment } else { 0.0 }
    });
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| lopsided[j].abs().total_cmp(&lopsided[i].abs()));
    let mut axes = frame.axes;
    for i in [order[0], order[1]] {
        axes[i] *= if lopsided[i] == 0.0 { lead(&axes[i]) } else { lopsided[i].signum() };
    }
    let last = order[2];
    axes[last] = axes[(last + 1) % 3].cross(&axes[(last + 2) % 3]);
    let rotation = Matrix::from_rows(&axes.map(|axis| axis.transpose()));
    Isometry { rotation, translation: -(rotation * frame.origin.coords), chirality: Chirality::Proper }
}

/// The sign of the first coordinate that is not near zero.
fn lead(axis: &Vector) -> f64 {
    axis.iter().find(|c| c.abs() > 1e-9).map_or(1.0, |c| c.signum())
}

/// The integral of the cubed distance from the plane across `axis` over the triangles, mm^5: over a triangle the mean
/// of a cubed linear function is a tenth of the complete homogeneous polynomial of its values at the corners.
fn third_moment(mesh: &Mesh, origin: &Point, axis: &Vector) -> f64 {
    let of = |t: usize| {
        let [a, b, c] = mesh.corners(t).map(|p| axis.dot(&(p - origin)));
        let mean = (a * a * (a + b + c) + b * b * (b + c + a) + c * c * (c + a + b) + a * b * c) / 10.0;
        0.5 * mesh.doubled_normal(t).norm() * mean
    };
    (0..mesh.triangles.len()).map(of).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::shapes;

    #[test]
    fn the_third_moment_of_a_cuboid_from_one_of_its_ends() {
        // From the end of a 1 x 1 x 2 cuboid along its length: 4 * integral of z^3 over 0..2 + 1 * 2^3 = 16 + 8.
        let mesh = shapes::cuboid(1.0, 1.0, 2.0);
        let low = mesh.points.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
        assert!((third_moment(&mesh, &Point::new(0.0, 0.0, low), &Vector::z()) - 24.0).abs() < 1e-9);
    }

    #[test]
    fn the_pose_is_right_handed_and_does_not_depend_on_the_signs_or_the_pose_of_the_file() {
        let letter = shapes::letter_f(1.5);
        let measures = shapes::measures(&letter);
        let origin = measures.centroid;
        let own = Frame { axes: [Vector::z(), Vector::x(), Vector::y()], origin };
        let expected = pose(&own, &letter, &measures);
        assert!((expected.rotation.determinant() - 1.0).abs() < 1e-12);
        assert!((expected.apply(&origin).coords).norm() < 1e-12);
        let turn = shapes::rotation(0.5, 0.9, -1.3);
        let turned = shapes::turned(&letter, &turn);
        let measures = shapes::measures(&turned);
        let axes = [-Vector::z(), Vector::x(), -Vector::y()].map(|axis| turn * axis);
        let found = pose(&Frame { axes, origin: measures.centroid }, &turned, &measures);
        for (p, q) in letter.points.iter().zip(&turned.points) {
            let (a, b) = (expected.apply(p), found.apply(q));
            // Across the letter's flat side it is its own mirror image.
            assert!((a.yz() - b.yz()).norm() < 1e-9 && (a.x.abs() - b.x.abs()).abs() < 1e-9, "{a} {b}");
        }
    }
}
