use proptest::prelude::*;

use super::*;
use crate::alignment::{cpca, shapes};
use crate::brep::{Mesh, Model, Wireframe};
use crate::geometry::{Plane, Point};
use crate::stages::merge::{Label, SymmetryPlane};

fn parsed(mesh: Mesh) -> Parsed {
    let measures = shapes::measures(&mesh);
    let wireframe = Wireframe::of(&mesh);
    Parsed { model: Model::empty(), mesh, wireframe, measures, skipped: Vec::new(), warnings: Vec::new() }
}

fn symmetric(parsed: &Parsed, normal: Vector) -> Symmetries {
    let plane = SymmetryPlane {
        plane: Plane::through(&parsed.measures.centroid, &normal),
        coverage: 1.0,
        error: 0.0,
        residual: 0.0,
        pairs: Vec::new(),
        selfs: Vec::new(),
        source: crate::stages::isometry::Source::Corners,
        correlation: None,
    };
    Symmetries { label: Label::Exact, planes: vec![plane], ..none(parsed) }
}

fn none(parsed: &Parsed) -> Symmetries {
    let covariance = cpca::covariance(&parsed.mesh);
    Symmetries { label: Label::None, planes: Vec::new(), axes: Vec::new(), repeats: Default::default(), covariance }
}

fn sweep(mesh: Mesh, normal: Vector, options: &Options) -> CanonicalFrame {
    let parsed = parsed(mesh);
    let symmetries = symmetric(&parsed, normal);
    projection_sweep(&parsed, &symmetries, options, &Cancel::new()).unwrap()
}

#[test]
fn a_box_1_2_4_is_seen_along_its_length() {
    let found = sweep(shapes::cuboid(1.0, 2.0, 4.0), Vector::x(), &Options::default());
    assert!(found.frame.axes[1].z.abs() > 1.0 - 1e-10);
    for (area, expected) in found.areas.iter().zip([8.0, 2.0, 4.0]) {
        assert!((area - expected).abs() < 1e-4, "{:?}", found.areas);
    }
    assert_eq!(found.source, Source::Symmetry);
    assert!(!found.axisymmetric);
}

#[test]
fn spans_and_pixels_measure_the_same_areas() {
    let turn = shapes::rotation(0.4, 0.2, 1.1);
    let f = shapes::turned(&shapes::letter_f(0.7), &turn);
    let parts = shapes::joined(
        &f,
        &shapes::mapped(&shapes::ellipsoid([1.0, 0.5, 2.0], 16), |p| p + Vector::new(4.0, 1.0, 0.0)),
    );
    let parsed = parsed(parts);
    let table = Turntable::arbitrary(&parsed.measures, &Vector::new(0.3, 0.9, 0.3).normalize());
    let cancel = Cancel::new();
    let angles = Options::default().angles();
    let spans = Slices::cut(&parsed.wireframe, &table, 1024, &cancel).unwrap().areas(&angles, &cancel).unwrap();
    let pixels = PixelShadows::new(&parsed.mesh, &parsed.measures, &table, 1024).areas(&angles, &cancel).unwrap();
    for (a, b) in spans.iter().zip(&pixels) {
        assert!((a - b).abs() < 0.004 * a, "spans {a}, pixels {b}");
    }
}

#[test]
fn the_paper_profile_sees_half_of_the_planes() {
    // From the arbitrary start the 90 planes reach one of the two views of the box, whichever comes first.
    let options = Options::paper();
    let found = sweep(shapes::cuboid(1.0, 2.0, 4.0), Vector::x(), &options);
    assert_eq!(found.sweep.angles.len(), 90);
    assert!(found.areas[1] < 4.3, "{:?}", found.areas);
}

#[test]
fn a_cylinder_seen_across_its_axis_is_axisymmetric() {
    let ring: Vec<_> =
        (0..64).map(|i| (f64::from(i) * std::f64::consts::TAU / 64.0).sin_cos()).map(|(s, c)| [c, s]).collect();
    let caps: Vec<_> = (1..63).map(|i| [0, i, i + 1]).collect();
    let found = sweep(shapes::prism(&ring, &caps, 3.0), Vector::z(), &Options::default());
    assert!(found.axisymmetric);
    assert!((found.areas[1] - 6.0).abs() < 0.02, "{:?}", found.areas);
}

#[test]
fn a_hole_through_a_slice_casts_light() {
    // Two boxes side by side with a gap: the shadow has the gap only where it is looked through.
    let far = shapes::mapped(&shapes::cuboid(1.0, 1.0, 1.0), |p| p + Vector::new(3.0, 0.0, 0.0));
    let parsed = parsed(shapes::joined(&shapes::cuboid(1.0, 1.0, 1.0), &far));
    let table = Turntable { u: Vector::y(), v: -Vector::x(), ..Turntable::arbitrary(&parsed.measures, &Vector::z()) };
    let mut slices = Slices::cut(&parsed.wireframe, &table, 16, &Cancel::new()).unwrap();
    let areas = slices.areas(&[0.0, std::f64::consts::FRAC_PI_2], &Cancel::new()).unwrap();
    assert!((areas[0] - 2.0).abs() < 1e-12 && (areas[1] - 1.0).abs() < 1e-12, "{areas:?}");
}

#[test]
fn an_upright_post_on_a_wider_one_casts_its_own_shadow() {
    // A leaning post, 1 wide and 4 high, beside a post 2 wide and 2 high with one 1 wide and 2 high on top.
    let leaning = shapes::mapped(&shapes::cuboid(1.0, 1.0, 4.0), |p| p + Vector::new(0.25 * p.z - 4.0, 0.0, 0.0));
    let narrow = shapes::mapped(&shapes::cuboid(1.0, 1.0, 2.0), |p| p + Vector::new(0.5, 0.5, 2.0));
    let posts = shapes::joined(&shapes::cuboid(2.0, 2.0, 2.0), &narrow);
    let parsed = parsed(shapes::joined(&leaning, &posts));
    let table = Turntable { u: Vector::y(), v: -Vector::x(), ..Turntable::arbitrary(&parsed.measures, &Vector::z()) };
    let mut slices = Slices::cut(&parsed.wireframe, &table, 16, &Cancel::new()).unwrap();
    let areas = slices.areas(&[0.0], &Cancel::new()).unwrap();
    assert!((areas[0] - 10.0).abs() < 1e-12, "{areas:?}");
}

#[test]
fn without_symmetry_a_rectilinear_model_gets_the_rectilinear_frame() {
    let turn = shapes::rotation(0.4, 1.2, 0.8);
    let parsed = parsed(shapes::turned(&shapes::letter_f(0.7), &turn));
    let found = projection_sweep(&parsed, &none(&parsed), &Options::default(), &Cancel::new()).unwrap();
    assert_eq!(found.source, Source::Rectilinearity);
    // Seen along its height it is smallest, then along its width.
    assert!(found.frame.axes[0].dot(&turn.column(1)).abs() > 1.0 - 1e-6, "{:?}", found.frame);
    assert!(found.frame.axes[1].dot(&turn.column(0)).abs() > 1.0 - 1e-6, "{:?}", found.frame);
}

#[test]
fn without_symmetry_a_round_model_gets_continuous_pca() {
    let parsed = parsed(shapes::ellipsoid([1.0, 2.0, 3.0], 24));
    let found = projection_sweep(&parsed, &none(&parsed), &Options::default(), &Cancel::new()).unwrap();
    assert_eq!(found.source, Source::Cpca);
    assert!(found.frame.axes[0].z.abs() > 0.99999, "{:?}", found.frame);
}

#[test]
fn a_model_without_extent_is_an_error() {
    let parsed = parsed(Mesh::default());
    let error = projection_sweep(&parsed, &none(&parsed), &Options::default(), &Cancel::new()).unwrap_err();
    assert_eq!(error.stage, Stage::ProjectionSweep);
}

#[test]
fn a_cancelled_sweep_stops() {
    let parsed = parsed(shapes::cuboid(1.0, 2.0, 4.0));
    let cancel = Cancel::new();
    cancel.cancel();
    assert!(projection_sweep(&parsed, &none(&parsed), &Options::default(), &cancel).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn the_box_minimum_is_found_from_any_start(angle in 0.0..std::f64::consts::PI) {
        let parsed = parsed(shapes::cuboid(1.0, 2.0, 4.0));
        let any = Turntable::arbitrary(&parsed.measures, &Vector::x());
        let u = any.direction(angle);
        let table = Turntable { u, v: any.axis.cross(&u), ..any };
        let found = turn(&parsed, &table, &Options::default(), &Cancel::new()).unwrap();
        prop_assert!(table.direction(found.choice.angle).z.abs() > 1.0 - 1e-10);
        prop_assert!((found.choice.area - 2.0).abs() < 1e-5);
    }

    #[test]
    fn the_frame_moves_with_the_model(
        roll in -3.0..3.0, pitch in -1.5..1.5, yaw in -3.0..3.0, decade in -3i32..4, shift in -100.0..100.0,
    ) {
        let scale = 10f64.powi(decade);
        let turn = shapes::rotation(roll, pitch, yaw);
        // A wedge with slanted sides: symmetric across z, no right angles in the first plane.
        let polygon = [[0.0, 0.0], [5.0, 1.0], [3.0, 2.5], [0.5, 2.0]];
        let still = shapes::prism(&polygon, &[[0, 1, 2], [0, 2, 3]], 1.0);
        let moved = shapes::mapped(&still, |p| Point::from(turn * p.coords * scale + Vector::repeat(shift * scale)));
        let before = sweep(still, Vector::z(), &Options::default());
        let after = sweep(moved, turn * Vector::z(), &Options::default());
        for i in 0..3 {
            let angle = (turn * before.frame.axes[i]).cross(&after.frame.axes[i]).norm();
            prop_assert!(angle < 1e-5, "axis {i} off by {angle}");
            prop_assert!((after.areas[i] / (before.areas[i] * scale * scale) - 1.0).abs() < 1e-6);
        }
    }
}
