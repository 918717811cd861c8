//! Loops as files have them: in any order and direction, with slits, points and edges that are hardly there.

use super::*;

/// A square of side 2a about the origin, as edges that run counter-clockwise.
fn square(b: &mut Builder, a: f64) -> Vec<(EdgeId, bool)> {
    let v = [[-a, -a], [a, -a], [a, a], [-a, a]].map(|[x, y]| b.vertex(x, y, 0.0));
    (0..4).map(|i| (b.edge(v[i], v[(i + 1) % 4], None), true)).collect()
}

fn reversed(ring: &[(EdgeId, bool)]) -> Vec<(EdgeId, bool)> {
    ring.iter().rev().map(|&(edge, forward)| (edge, !forward)).collect()
}

#[test]
fn loops_may_come_in_any_order_and_direction() {
    for (outer_first, outer_turned, hole_turned) in
        [(true, false, true), (true, false, false), (false, true, true), (false, true, false), (false, false, false)]
    {
        let mut b = Builder::new();
        let (outer, (hole, _)) = (square(&mut b, 2.0), b.circle(1.0, 0.0));
        let outer = if outer_turned { reversed(&outer) } else { outer };
        let hole = [(hole, !hole_turned)];
        let loops: [&[_]; 2] = if outer_first { [&outer, &hole] } else { [&hole, &outer] };
        b.face(Surface::Plane(at_height(0.0)), true, &loops);
        b.check_area(16.0 - PI, 0.02);
    }
}

#[test]
fn an_edge_there_and_back_is_a_slit_without_area() {
    let mut b = Builder::new();
    let mut ring = square(&mut b, 1.0);
    let (corner, inside) = (b.0.edges[ring[0].0.index()].start, b.vertex(0.0, 0.0, 0.0));
    let slit = b.edge(corner, inside, None);
    ring.splice(0..0, [(slit, true), (slit, false)]);
    b.face(Surface::Plane(at_height(0.0)), true, &[&ring]);
    b.check_area(4.0, 1e-9);
}

#[test]
fn edges_without_length_or_nearly_so_do_no_harm() {
    for length in [0.0, 1e-12, 1e-6, 1e-3] {
        let mut b = Builder::new();
        let v = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [length - 1.0, 1.0], [-1.0, 1.0]];
        let v = v.map(|[x, y]| b.vertex(x, y, 0.0));
        let ring: Vec<_> = (0..5).map(|i| (b.edge(v[i], v[(i + 1) % 5], None), true)).collect();
        b.face(Surface::Plane(at_height(0.0)), true, &[&ring]);
        b.check_area(4.0, 1e-9);
    }
}

#[test]
fn a_vertex_loop_is_the_apex_of_a_cone() {
    let mut b = Builder::new();
    let (base, _) = b.circle(3.0, 0.0);
    let apex = b.vertex(0.0, 0.0, 4.0);
    b.face(
        Surface::Cone { placement: at_height(0.0), radius: 3.0, half_angle: -(0.75_f64).atan() },
        true,
        &[&[(base, true)]],
    );
    b.vertex_loop(0, apex);
    b.discs(Some((base, 0.0)), None);
    b.check(24.0 * PI, 12.0 * PI);
}

#[test]
fn a_vertex_loop_alone_bounds_nothing() {
    let mut b = Builder::new();
    let pole = b.vertex(0.0, 0.0, 3.0);
    b.face(Surface::Sphere { placement: at_height(0.0), radius: 3.0 }, true, &[]);
    b.vertex_loop(0, pole);
    b.check(36.0 * PI, 36.0 * PI);
}

#[test]
fn a_sphere_with_a_seam_only_is_whole() {
    let mut b = Builder::new();
    let (south, north) = (b.vertex(0.0, 0.0, -3.0), b.vertex(0.0, 0.0, 3.0));
    let seam = b.edge(south, north, Some(upright(0.0, 0.0, 3.0)));
    b.face(Surface::Sphere { placement: at_height(0.0), radius: 3.0 }, true, &[&[(seam, true), (seam, false)]]);
    b.check(36.0 * PI, 36.0 * PI);
}

#[test]
fn a_torus_with_both_seams_is_whole() {
    let mut b = Builder::new();
    let (equator, vertex) = b.circle(7.0, 0.0);
    let meridian = b.edge(vertex, vertex, Some(upright(5.0, 0.0, 2.0)));
    let seams = [(equator, true), (meridian, true), (equator, false), (meridian, false)];
    b.face(Surface::Torus { placement: at_height(0.0), major: 5.0, minor: 2.0 }, true, &[&seams]);
    b.check(40.0 * PI * PI, 40.0 * PI * PI);
}

#[test]
fn a_belt_of_a_sphere_lies_between_two_circles() {
    let mut b = Builder::new();
    let ((low, _), (high, _)) = (b.circle(4.0, -3.0), b.circle(3.0, 4.0));
    b.face(Surface::Sphere { placement: at_height(0.0), radius: 5.0 }, true, &[&[(high, false)], &[(low, true)]]);
    b.discs(Some((low, -3.0)), Some((high, 4.0)));
    // Archimedes' belt 2 pi R h; the slice's volume is pi h (3 a^2 + 3 b^2 + h^2) / 6.
    b.check(95.0 * PI, 434.0 / 3.0 * PI);
}

#[test]
fn half_a_torus_lies_between_circles_round_its_tube() {
    let mut b = Builder::new();
    let (v0, v1) = (b.vertex(7.0, 0.0, 0.0), b.vertex(-7.0, 0.0, 0.0));
    let first = b.edge(v0, v0, Some(upright(5.0, 0.0, 2.0)));
    let last = b.edge(v1, v1, Some(upright(-5.0, 0.0, 2.0)));
    let torus = Surface::Torus { placement: at_height(0.0), major: 5.0, minor: 2.0 };
    b.face(torus, true, &[&[(first, false)], &[(last, false)]]);
    let wall = Placement { origin: Point::origin(), x: Vector::x(), y: Vector::z(), z: -Vector::y() };
    b.face(Surface::Plane(wall), true, &[&[(first, true)]]);
    b.face(Surface::Plane(wall), true, &[&[(last, true)]]);
    let mesh = b.check(20.0 * PI * PI + 8.0 * PI, 20.0 * PI * PI);
    assert!(mesh.faces[0].centroid.y > 1.0);
}

#[test]
fn a_ring_thinner_than_the_deflection_keeps_its_area() {
    let mut b = Builder::new();
    let ((outer, _), (inner, _)) = (b.circle(1.0, 0.0), b.circle(0.999, 0.0));
    b.face(Surface::Plane(at_height(0.0)), true, &[&[(outer, true)], &[(inner, false)]]);
    b.check_area(PI * (1.0 - 0.999 * 0.999), 0.03);
}

#[test]
fn an_edge_without_a_curve_leaves_a_plane_with_a_warning() {
    // A quarter of a wall of radius 2: the upper arc is missing, its chord lies 0.59 inside.
    let mut b = Builder::new();
    let corners = [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 2.0, 1.0], [2.0, 0.0, 1.0]];
    let v = corners.map(|[x, y, z]| b.vertex(x, y, z));
    let arc = b.edge(v[0], v[1], Some(Curve::Circle { placement: at_height(0.0), radius: 2.0 }));
    let ring = [
        (arc, true),
        (b.edge(v[1], v[2], None), true),
        (b.edge(v[2], v[3], None), true),
        (b.edge(v[3], v[0], None), true),
    ];
    b.face(Surface::Cylinder { placement: at_height(0.0), radius: 2.0 }, true, &[&ring]);
    let (mesh, skipped, warnings) = tessellate(&b.0, &Options::default(), &Cancel::new()).unwrap();
    assert_eq!((mesh.faces.len(), skipped.len(), warnings.len()), (1, 0, 1));
    assert!(warnings[0].contains("#1"), "{warnings:?}");
}
