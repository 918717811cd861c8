use proptest::prelude::*;

use super::*;
use crate::alignment::shapes;
use crate::brep::Mesh;
use crate::distance;
use crate::geometry::{Point, Vector};

/// A tripod-like shape without any symmetry: three boxes.
fn odd_shape() -> Mesh {
    let at = |m: &Mesh, x: f64, y: f64, z: f64| shapes::mapped(m, |p| p + Vector::new(x, y, z));
    let base = shapes::cuboid(6.0, 4.0, 1.0);
    let post = at(&shapes::cuboid(1.0, 1.5, 3.0), 0.5, 0.5, 0.9);
    let arm = at(&shapes::cuboid(3.0, 1.0, 1.0), 0.5, 1.0, 3.0);
    shapes::joined(&shapes::joined(&base, &post), &arm)
}

fn own_frame(mesh: &Mesh) -> Frame {
    Frame { axes: [Vector::x(), Vector::y(), Vector::z()], origin: shapes::measures(mesh).centroid }
}

fn described(mesh: &Mesh, frame: &Frame) -> Descriptor {
    descriptor(&Wireframe::of(mesh), &shapes::measures(mesh), frame, &Options::default(), &Cancel::new()).unwrap()
}

#[test]
fn the_views_look_along_their_axes() {
    // A 1 x 2 x 4 box: widths and heights of the pictures are (y, z), (z, x), (x, y).
    let mesh = shapes::cuboid(1.0, 2.0, 4.0);
    let options = Options { side: 64, ..Options::default() };
    let views =
        silhouettes(&Wireframe::of(&mesh), &shapes::measures(&mesh), &own_frame(&mesh), &options, &Cancel::new())
            .unwrap();
    let extent = |s: &Silhouette| {
        let rows = (0..64).filter(|&y| s.count(y, 0, 64) > 0).count();
        let widest = (0..64).map(|y| s.count(y, 0, 64)).max().unwrap();
        [widest as f64, rows as f64].map(|c| c / options.scale(21f64.sqrt()))
    };
    for (found, expected) in views.iter().map(extent).zip([[2.0, 4.0], [4.0, 1.0], [1.0, 2.0]]) {
        assert!(found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 0.2), "{found:?} {expected:?}");
    }
}

#[test]
fn a_disc_has_no_harmonics() {
    let mesh = shapes::ellipsoid([1.0; 3], 64);
    let found = described(&mesh, &own_frame(&mesh));
    assert!(found.magnitudes().iter().all(|m| *m < 2e-3), "{:?}", found.magnitude[0]);
}

#[test]
fn an_ellipse_has_even_harmonics_only() {
    let mesh = shapes::ellipsoid([2.0, 1.0, 1.0], 64);
    let [_, _, view] = described(&mesh, &own_frame(&mesh)).magnitude;
    assert!(view[1] > 0.1, "{view:?}");
    assert!(view.iter().step_by(2).all(|m| *m < 1e-3), "{view:?}");
}

#[test]
fn parts_far_apart_are_described_against_the_hull() {
    let far = shapes::mapped(&shapes::cuboid(1.0, 1.0, 1.0), |p| p + Vector::new(5.0, 0.0, 0.0));
    let mesh = shapes::joined(&shapes::cuboid(1.0, 1.0, 1.0), &far);
    let found = described(&mesh, &own_frame(&mesh));
    assert_eq!(found.hull, [false, true, true]);
}

#[test]
fn parts_with_a_crack_between_them_are_closed() {
    let far = shapes::mapped(&shapes::cuboid(1.0, 1.0, 1.0), |p| p + Vector::new(1.015, 0.0, 0.0));
    let mesh = shapes::joined(&shapes::cuboid(1.0, 1.0, 1.0), &far);
    assert_eq!(described(&mesh, &own_frame(&mesh)).hull, [false; 3]);
}

#[test]
fn a_mesh_without_extent_is_an_error() {
    let empty = Mesh::default();
    let measures = shapes::measures(&shapes::rectangle(1.0, 1.0));
    let frame = Frame { axes: [Vector::x(), Vector::y(), Vector::z()], origin: Point::origin() };
    assert!(descriptor(&Wireframe::of(&empty), &measures, &frame, &Options::default(), &Cancel::new()).is_err());
}

#[test]
fn turned_axes_are_no_difference_to_the_phase_distance() {
    let mesh = odd_shape();
    let frame = own_frame(&mesh);
    let still = described(&mesh, &frame);
    let other = described(&shapes::letter_f(1.0), &own_frame(&shapes::letter_f(1.0)));
    let apart = distance::phase(still.phases(), other.phases());
    for signs in 1..8 {
        let axes = [0, 1, 2].map(|i| if signs >> i & 1 == 1 { -frame.axes[i] } else { frame.axes[i] });
        let flipped = described(&mesh, &Frame { axes, ..frame });
        let moved = distance::phase(still.phases(), flipped.phases());
        assert!(moved < 0.01 * apart, "signs {signs}: {moved} of {apart}");
    }
}

#[test]
fn a_mirrored_model_in_its_own_frame_is_the_same() {
    let mesh = odd_shape();
    let mirrored = shapes::mapped(&mesh, |p| Point::new(p.x, -p.y, p.z));
    let (a, b) = (described(&mesh, &own_frame(&mesh)), described(&mirrored, &own_frame(&mirrored)));
    assert!(distance::phase(a.phases(), b.phases()) < 0.01);
    assert!(distance::magnitude(a.magnitudes(), b.magnitudes()) < 0.01);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn a_moved_model_in_its_moved_frame_is_the_same(
        roll in -3.0..3.0, pitch in -1.5..1.5, yaw in -3.0..3.0, decade in -3i32..4,
    ) {
        let turn = shapes::rotation(roll, pitch, yaw);
        let scale = 10f64.powi(decade);
        let mesh = odd_shape();
        let moved = shapes::mapped(&mesh, |p| Point::from(turn * p.coords * scale + Vector::repeat(7.0 * scale)));
        let frame = own_frame(&mesh);
        let moved_frame = Frame { axes: frame.axes.map(|a| turn * a), origin: Point::origin() };
        let (a, b) = (described(&mesh, &frame), described(&moved, &moved_frame));
        prop_assert!(distance::phase(a.phases(), b.phases()) < 0.01);
        prop_assert!(distance::magnitude(a.magnitudes(), b.magnitudes()) < 0.01);
    }

    #[test]
    fn magnitudes_ignore_the_turn_of_the_picture(angle in 0.0..3.0f64) {
        let mesh = odd_shape();
        let frame = own_frame(&mesh);
        let (x, y) = (frame.axes[0], frame.axes[1]);
        let turned = Frame { axes: [x * angle.cos() + y * angle.sin(), y * angle.cos() - x * angle.sin(), frame.axes[2]], ..frame };
        let (a, b) = (described(&mesh, &frame), described(&mesh, &turned));
        let moved = distance::magnitude_views(a.magnitudes(), b.magnitudes())[2];
        prop_assert!(moved < 0.02, "moved by {moved}");
    }
}
