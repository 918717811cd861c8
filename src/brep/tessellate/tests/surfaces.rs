//! The kinds of surfaces that are less common, each as the wall of a solid.

use super::*;
use crate::brep::nurbs::NurbsCurve;

/// A solid with this wall between circles at two heights, with and without a seam along the curve.
fn between_circles(wall: &Surface, [low, high]: [[f64; 2]; 2], seam: Option<Curve>, area: f64, volume: f64) {
    for with_seam in [false, true] {
        let mut b = Builder::new();
        let ((bottom, v0), (top, v1)) = (b.circle(low[0], low[1]), b.circle(high[0], high[1]));
        if with_seam {
            let seam = b.edge(v0, v1, seam.clone());
            b.face(wall.clone(), true, &[&[(bottom, true), (seam, true), (top, false), (seam, false)]]);
        } else {
            b.face(wall.clone(), true, &[&[(bottom, true)], &[(top, false)]]);
        }
        b.discs(Some((bottom, low[1])), Some((top, high[1])));
        b.check(area, volume);
    }
}

/// The circle of radius `radius` in the plane at height `z` as a rational B-spline of four arcs; `arcs` of them.
fn spline_circle(radius: f64, z: f64, arcs: usize) -> (Vec<Point>, Vec<f64>, Vec<f64>) {
    let corners = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]];
    let count = 2 * arcs + 1;
    let points = corners[..count].iter().map(|c| Point::new(f64::from(c[0]) * radius, f64::from(c[1]) * radius, z));
    let weights = (0..count).map(|i| if i % 2 == 0 { 1.0 } else { 0.5_f64.sqrt() }).collect();
    let inner = (0..=arcs).flat_map(|i| [i as f64 / arcs as f64; 2]);
    let knots = [0.0].into_iter().chain(inner).chain([1.0]).collect();
    (points.collect(), weights, knots)
}

/// The surface that runs straight from one circle to the other, u along the circles.
fn spline_wall([low, high]: [[f64; 2]; 2], arcs: usize) -> Surface {
    let (first, weights, knots_u) = spline_circle(low[0], low[1], arcs);
    let (last, ..) = spline_circle(high[0], high[1], arcs);
    let points = first.into_iter().zip(last).flat_map(|(a, b)| [a, b]).collect();
    let weights = weights.into_iter().flat_map(|w| [w, w]).collect();
    let knots_v = vec![0.0, 0.0, 1.0, 1.0];
    Surface::Nurbs(NurbsSurface { degree_u: 2, degree_v: 1, knots_u, knots_v, columns: 2, points, weights })
}

#[test]
fn a_line_turned_about_an_axis_is_a_frustum() {
    let profile = Curve::Line { origin: Point::new(2.0, 0.0, 0.0), direction: Vector::new(-1.0, 0.0, 1.0) };
    let wall = Surface::Revolution { profile: Box::new(profile), axis: at_height(0.0) };
    between_circles(&wall, [[2.0, 0.0], [1.0, 1.0]], None, PI * (5.0 + 3.0 * 2.0_f64.sqrt()), 7.0 / 3.0 * PI);
}

#[test]
fn an_arc_or_circle_turned_about_an_axis_is_a_belt() {
    let circle = upright(0.0, 0.0, 5.0);
    let basis = Box::new(circle.clone());
    let half = Curve::Trimmed { basis, range: [-FRAC_PI_2, FRAC_PI_2], forward: true };
    for profile in [half, circle.clone()] {
        let wall = Surface::Revolution { profile: Box::new(profile), axis: at_height(0.0) };
        between_circles(&wall, [[4.0, -3.0], [3.0, 4.0]], Some(circle.clone()), 95.0 * PI, 434.0 / 3.0 * PI);
    }
}

#[test]
fn a_circle_moved_along_its_axis_is_a_cylinder() {
    let profile = Box::new(Curve::Circle { placement: at_height(0.0), radius: 2.0 });
    let wall = Surface::Extrusion { profile, direction: Vector::z() };
    between_circles(&wall, [[2.0, 0.0], [2.0, 5.0]], None, 28.0 * PI, 20.0 * PI);
}

#[test]
fn an_offset_cylinder_is_a_wider_cylinder() {
    let basis = Box::new(Surface::Cylinder { placement: at_height(0.0), radius: 1.5 });
    let wall = Surface::Offset { basis, distance: 0.5 };
    between_circles(&wall, [[2.0, 0.0], [2.0, 5.0]], None, 28.0 * PI, 20.0 * PI);
}

#[test]
fn a_rational_spline_is_an_exact_frustum() {
    let ends = [[2.0, 0.0], [1.0, 1.0]];
    between_circles(&spline_wall(ends, 4), ends, None, PI * (5.0 + 3.0 * 2.0_f64.sqrt()), 7.0 / 3.0 * PI);
}

#[test]
fn a_flat_spline_that_bends_within_its_plane_does_not_fold_over() {
    // Three quarters of a ring: flat, so curvature asks for no points inside; straight in its parameter space.
    let mut b = Builder::new();
    let wall = spline_wall([[1.2, 0.0], [1.0, 0.0]], 3);
    let arc = |radius: f64| {
        let (points, weights, knots) = spline_circle(radius, 0.0, 3);
        Some(Curve::Nurbs(NurbsCurve { degree: 2, knots, points, weights, closed: false }))
    };
    let v = [[1.2, 0.0], [0.0, -1.2], [0.0, -1.0], [1.0, 0.0]].map(|[x, y]| b.vertex(x, y, 0.0));
    let ring = [
        b.edge(v[0], v[1], arc(1.2)),
        b.edge(v[1], v[2], None),
        b.edge(v[3], v[2], arc(1.0)),
        b.edge(v[3], v[0], None),
    ];
    b.face(wall, true, &[&[(ring[0], true), (ring[1], true), (ring[2], false), (ring[3], true)]]);
    let mesh = b.check_area(0.75 * PI * 0.44, 0.02);
    let turned = (0..mesh.triangles.len()).filter(|&t| mesh.doubled_normal(t).z * mesh.doubled_normal(0).z < 0.0);
    assert_eq!(turned.count(), 0);
}

#[test]
fn a_torus_that_cuts_itself_is_an_apple() {
    let mut b = Builder::new();
    b.face(Surface::Torus { placement: at_height(0.0), major: 1.0, minor: 2.0 }, true, &[]);
    // From pole to pole the tube turns by 4 pi / 3; the integrals of rho and of rho^2 along it.
    let root = 3.0_f64.sqrt();
    b.check(4.0 * PI * (4.0 * PI / 3.0 + 2.0 * root), 2.0 * PI * (8.0 * PI / 3.0 + 3.0 * root));
}

#[test]
fn the_inside_of_a_torus_that_cuts_itself_is_a_lemon() {
    let mut b = Builder::new();
    let (rim, _) = b.circle(1.0, 0.0);
    // Where the tube has crossed the axis the surface normal points to the axis.
    b.face(Surface::Torus { placement: at_height(0.0), major: 1.0, minor: 2.0 }, false, &[&[(rim, true)]]);
    b.discs(Some((rim, 0.0)), None);
    let root = 3.0_f64.sqrt();
    b.check(4.0 * PI * (root - PI / 3.0) + PI, PI * (3.0 * root - 4.0 * PI / 3.0));
}

#[test]
fn a_tube_may_end_in_circles_that_waver() {
    // The ends of a quarter of a torus lie 1e-5 off their planes, to and fro: no cut may pass through them.
    let mut b = Builder::new();
    let ends = [0.0_f64, FRAC_PI_2].map(|u| {
        let tilt = Vector::new(-u.sin(), u.cos(), 0.0) * 1e-5;
        let (x, z) = (Vector::new(u.cos(), u.sin(), 0.0) + tilt, Vector::z());
        let placement = Placement { origin: Point::origin() + x * 5.0, x, y: z, z: x.cross(&z) };
        let start = b.vertex(placement.origin.x + 2.0 * x.x, placement.origin.y + 2.0 * x.y, 0.0);
        b.edge(start, start, Some(Curve::Circle { placement, radius: 2.0 }))
    });
    let torus = Surface::Torus { placement: at_height(0.0), major: 5.0, minor: 2.0 };
    b.face(torus, true, &[&[(ends[0], false)], &[(ends[1], true)]]);
    b.check_area(10.0 * PI * PI, 0.02);
}
