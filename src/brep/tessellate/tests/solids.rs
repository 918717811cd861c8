//! Whole solids and the walls they are made of.

use super::*;
use crate::brep::PlacedFaceId;

#[test]
fn a_box_is_exact() {
    let mut b = Builder::new();
    let v: Vec<_> =
        (0..8).map(|i| b.vertex(f64::from(i & 1), f64::from(i >> 1 & 1) * 2.0, f64::from(i >> 2) * 3.0)).collect();
    let mut edges = BTreeMap::new();
    let corners = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    for c in corners {
        let uses: Vec<_> = (0..4)
            .map(|i| {
                let (from, to) = (c[i], c[(i + 1) % 4]);
                let key = (from.min(to), from.max(to));
                let edge = *edges.entry(key).or_insert_with(|| b.edge(v[key.0], v[key.1], None));
                (edge, from < to)
            })
            .collect();
        let [p, q, r] = [c[0], c[1], c[3]].map(|i| b.0.vertices[i].point);
        let (x, y) = ((q - p).normalize(), (r - p).normalize());
        b.face(Surface::Plane(Placement { origin: p, x, y, z: x.cross(&y) }), true, &[&uses]);
    }
    let mesh = b.check(22.0, 6.0);
    assert_eq!(mesh.triangles.len(), 12);
    let measures = measure(&b.0, &mesh);
    assert!((measures.centroid - Point::new(0.5, 1.0, 1.5)).norm() < 1e-12);
    assert!((measures.tolerance.size() - 14.0_f64.sqrt()).abs() < 1e-12);
}

#[test]
fn a_cylinder_needs_no_seam() {
    for seam in [false, true] {
        let mut b = Builder::new();
        let ((bottom, v0), (top, v1)) = (b.circle(2.0, 0.0), b.circle(2.0, 5.0));
        let wall = Surface::Cylinder { placement: at_height(0.0), radius: 2.0 };
        if seam {
            let seam = b.edge(v0, v1, None);
            b.face(wall, true, &[&[(bottom, true), (seam, true), (top, false), (seam, false)]]);
        } else {
            b.face(wall, true, &[&[(bottom, true)], &[(top, false)]]);
        }
        b.discs(Some((bottom, 0.0)), Some((top, 5.0)));
        let mesh = b.check(PI * 28.0, PI * 20.0);
        let bounds = measure(&b.0, &mesh).bounds;
        assert!((bounds.min - Point::new(-2.0, -2.0, 0.0)).norm() < 1e-12);
        assert!((bounds.max - Point::new(2.0, 2.0, 5.0)).norm() < 1e-12);
    }
}

#[test]
fn a_mirrored_occurrence_keeps_its_outside_outside() {
    let mut b = Builder::new();
    let ((bottom, _), (top, _)) = (b.circle(2.0, 0.0), b.circle(2.0, 5.0));
    b.face(Surface::Cylinder { placement: at_height(0.0), radius: 2.0 }, true, &[&[(bottom, true)], &[(top, false)]]);
    b.discs(Some((bottom, 0.0)), Some((top, 5.0)));
    let mirror = Isometry::reflection(&Plane::through(&Point::new(7.0, 0.0, 0.0), &Vector::new(1.0, 2.0, 0.5)));
    b.0.occurrences[0].placement = mirror.as_transform();
    let mesh = b.check(PI * 28.0, PI * 20.0);
    let flux: f64 =
        (0..mesh.triangles.len()).map(|t| mesh.corners(t)[0].coords.dot(&mesh.doubled_normal(t)) / 6.0).sum();
    assert!((flux / (PI * 20.0) - 1.0).abs() < 0.02);
}

#[test]
fn a_cylinder_wall_may_have_a_window_across_the_seam() {
    let mut b = Builder::new();
    let ((bottom, _), (top, _)) = (b.circle(1.0, 0.0), b.circle(1.0, 3.0));
    let corner = |u: f64, z: f64| [u.cos(), u.sin(), z];
    let at = [corner(-0.5, 1.0), corner(0.5, 1.0), corner(0.5, 2.0), corner(-0.5, 2.0)];
    let v = at.map(|[x, y, z]| b.vertex(x, y, z));
    let arc = |z| Some(Curve::Circle { placement: at_height(z), radius: 1.0 });
    let window = [
        b.edge(v[0], v[1], arc(1.0)),
        b.edge(v[1], v[2], None),
        b.edge(v[3], v[2], arc(2.0)),
        b.edge(v[3], v[0], None),
    ];
    let hole = [(window[3], false), (window[2], true), (window[1], false), (window[0], false)];
    let wall = Surface::Cylinder { placement: at_height(0.0), radius: 1.0 };
    b.face(wall, true, &[&hole, &[(top, false)], &[(bottom, true)]]);
    let (mesh, skipped, _) = tessellate(&b.0, &Options::default(), &Cancel::new()).unwrap();
    assert!(skipped.is_empty());
    assert!((mesh.faces[0].area / (TAU * 3.0 - 1.0) - 1.0).abs() < 1e-4, "{}", mesh.faces[0].area);
}

#[test]
fn whole_spheres_and_tori_need_no_bounds() {
    let mut b = Builder::new();
    b.face(Surface::Sphere { placement: at_height(1.0), radius: 3.0 }, true, &[]);
    b.check(36.0 * PI, 36.0 * PI);
    let mut b = Builder::new();
    b.face(Surface::Torus { placement: at_height(1.0), major: 5.0, minor: 2.0 }, true, &[]);
    b.check(40.0 * PI * PI, 40.0 * PI * PI);
}

#[test]
fn a_half_sphere_knows_its_half() {
    for upper in [true, false] {
        let mut b = Builder::new();
        let (equator, _) = b.circle(2.0, 0.0);
        b.face(Surface::Sphere { placement: at_height(0.0), radius: 2.0 }, true, &[&[(equator, upper)]]);
        let disc = Some((equator, 0.0));
        if upper {
            b.discs(disc, None)
        } else {
            b.discs(None, disc)
        }
        let mesh = b.check(12.0 * PI, 16.0 / 3.0 * PI);
        let up = mesh.faces[0].centroid.z;
        assert!((up - if upper { 1.0 } else { -1.0 }).abs() < 1e-3, "centroid {up}");
    }
}

#[test]
fn a_ball_is_made_as_fine_as_its_error_asks_for_and_no_finer() {
    // A half sphere of radius 0.2 above a disc of radius 10.
    let mut b = Builder::new();
    let ((rim, _), (equator, _)) = (b.circle(10.0, 0.0), b.circle(0.2, 1.0));
    b.discs(None, Some((rim, 0.0)));
    b.face(Surface::Sphere { placement: at_height(1.0), radius: 0.2 }, true, &[&[(equator, true)]]);
    let mesh = tessellate(&b.0, &Options::default(), &Cancel::new()).unwrap().0;
    let triangles = mesh.triangles_of(PlacedFaceId(1));
    let plain: f64 = triangles.clone().map(|t| 0.5 * mesh.doubled_normal(t).norm()).sum();
    assert!((plain / (0.08 * PI) - 1.0).abs() <= 0.015, "{plain}");
    // Steps of 0.3 both ways, the sum of whose squares over 12 is 0.015: 21 x 5 quadrilaterals.
    assert!((150..400).contains(&triangles.len()), "{}", triangles.len());
}

#[test]
fn faces_that_several_threads_make_keep_their_triangles() {
    // Discs of two sizes above each other.
    let mut b = Builder::new();
    let disc = |i: usize| (1.0 + 0.5 * (i % 2) as f64, 1e-3 * i as f64);
    for (radius, z) in (0..PARALLEL_FACES).map(disc) {
        let (rim, _) = b.circle(radius, z);
        b.discs(None, Some((rim, z)));
    }
    let mesh = tessellate(&b.0, &Options::default(), &Cancel::new()).unwrap().0;
    for (i, face) in mesh.faces.iter().enumerate() {
        let (radius, z) = disc(i);
        assert!((face.area / (PI * radius * radius) - 1.0).abs() < 1e-5, "{i}: {}", face.area);
        let corners: Vec<_> = mesh.triangles_of(PlacedFaceId(i as u32)).flat_map(|t| mesh.corners(t)).collect();
        assert!(corners.iter().all(|p| (p.z - z).abs() < 1e-9 && p.x.hypot(p.y) < radius + 1e-9), "{i}");
        assert!(!corners.is_empty() && mesh.points_of(PlacedFaceId(i as u32)).iter().all(|p| (p.z - z).abs() < 1e-9));
    }
}

#[test]
fn a_seam_tells_the_face_where_directions_are_wrong() {
    // A disc of radius 7 whose rim is rounded by the upper outer quarter of a torus.
    for wrong in [false, true] {
        let mut b = Builder::new();
        let ((low, v0), (high, v1)) = (b.circle(7.0, 0.0), b.circle(5.0, 2.0));
        let seam = b.edge(v0, v1, Some(upright(5.0, 0.0, 2.0)));
        let right = [(low, true), (seam, true), (high, false), (seam, false)];
        let turned = [(seam, true), (high, true), (seam, false), (low, false)];
        b.face(
            Surface::Torus { placement: at_height(0.0), major: 5.0, minor: 2.0 },
            true,
            &[if wrong { &turned } else { &right }],
        );
        b.discs(Some((low, 0.0)), Some((high, 2.0)));
        // Pappus: the quarter arc's centroid lies at 5 + 4/pi; the volume is that of the discs of radius 5 + sqrt(4 - z^2).
        b.check(PI * (74.0 + 4.0 * (2.5 * PI + 2.0)), PI * (50.0 + 10.0 * PI + 16.0 / 3.0));
    }
}

#[test]
fn a_seam_to_the_pole_tells_the_cap() {
    for wrong in [false, true] {
        let mut b = Builder::new();
        let (equator, vertex) = b.circle(2.0, 0.0);
        let pole = b.vertex(0.0, 0.0, 2.0);
        let seam = b.edge(vertex, pole, Some(upright(0.0, 0.0, 2.0)));
        let sphere = Surface::Sphere { placement: at_height(0.0), radius: 2.0 };
        b.face(sphere, true, &[&[(equator, !wrong), (seam, true), (seam, false)]]);
        b.discs(Some((equator, 0.0)), None);
        b.check(12.0 * PI, 16.0 / 3.0 * PI);
    }
}

#[test]
fn a_half_sphere_may_be_cut_through_its_poles() {
    let mut b = Builder::new();
    let vertex = b.vertex(2.0, 0.0, 0.0);
    let rim = b.edge(vertex, vertex, Some(upright(0.0, 0.0, 2.0)));
    b.face(Surface::Sphere { placement: at_height(0.0), radius: 2.0 }, true, &[&[(rim, true)]]);
    let wall = Placement { origin: Point::origin(), x: Vector::x(), y: Vector::z(), z: -Vector::y() };
    b.face(Surface::Plane(wall), false, &[&[(rim, false)]]);
    let mesh = b.check(12.0 * PI, 16.0 / 3.0 * PI);
    assert!((mesh.faces[0].centroid.y + 1.0).abs() < 1e-3);
}

#[test]
fn a_cone_runs_to_its_apex() {
    for seam in [false, true] {
        let mut b = Builder::new();
        let (base, v) = b.circle(3.0, 0.0);
        let surface = Surface::Cone { placement: at_height(0.0), radius: 3.0, half_angle: -(0.75_f64).atan() };
        if seam {
            let apex = b.vertex(0.0, 0.0, 4.0);
            let seam = b.edge(v, apex, None);
            b.face(surface, true, &[&[(base, true), (seam, true), (seam, false)]]);
        } else {
            b.face(surface, true, &[&[(base, true)]]);
        }
        b.discs(Some((base, 0.0)), None);
        b.check(24.0 * PI, 12.0 * PI);
    }
}

#[test]
fn a_cone_sector_meets_the_apex() {
    // Three quarters of the cone of radius 3 and height 4 between two walls.
    let mut b = Builder::new();
    let (p, q, apex) = (b.vertex(3.0, 0.0, 0.0), b.vertex(0.0, -3.0, 0.0), b.vertex(0.0, 0.0, 4.0));
    let arc = b.edge(p, q, Some(Curve::Circle { placement: at_height(0.0), radius: 3.0 }));
    let (up, down) = (b.edge(q, apex, None), b.edge(apex, p, None));
    let surface = Surface::Cone { placement: at_height(0.0), radius: 3.0, half_angle: -(0.75_f64).atan() };
    b.face(surface, true, &[&[(arc, true), (up, true), (down, true)]]);
    let (mesh, ..) = tessellate(&b.0, &Options::default(), &Cancel::new()).unwrap();
    assert!((mesh.faces[0].area / (0.75 * 15.0 * PI) - 1.0).abs() < 1e-4, "{}", mesh.faces[0].area);
}

#[test]
fn an_octant_of_a_sphere_has_an_eighth_of_its_area() {
    let mut b = Builder::new();
    let v = [b.vertex(1.0, 0.0, 0.0), b.vertex(0.0, 1.0, 0.0), b.vertex(0.0, 0.0, 1.0)];
    let axes = [Vector::x(), Vector::y(), Vector::z()];
    let edges: Vec<_> = (0..3)
        .map(|i| {
            let (x, y) = (axes[i], axes[(i + 1) % 3]);
            let placement = Placement { origin: Point::origin(), x, y, z: x.cross(&y) };
            (b.edge(v[i], v[(i + 1) % 3], Some(Curve::Circle { placement, radius: 1.0 })), true)
        })
        .collect();
    b.face(Surface::Sphere { placement: at_height(0.0), radius: 1.0 }, true, &[&edges]);
    let (mesh, ..) = tessellate(&b.0, &Options::default(), &Cancel::new()).unwrap();
    assert!((mesh.faces[0].area / FRAC_PI_2 - 1.0).abs() < 1e-4, "{}", mesh.faces[0].area);
}

#[test]
fn a_bilinear_patch_without_bounds_uses_its_domain() {
    let mut b = Builder::new();
    let points = [[0.0, 0.0, 0.0], [0.0, 2.0, 0.0], [3.0, 0.0, 0.0], [3.0, 2.0, 0.0]].map(Point::from).to_vec();
    b.face(Surface::Nurbs(NurbsSurface::bilinear(points)), true, &[]);
    let (mesh, skipped, _) = tessellate(&b.0, &Options::default(), &Cancel::new()).unwrap();
    assert!(skipped.is_empty());
    assert!((mesh.faces[0].area - 6.0).abs() < 1e-9);
}

#[test]
fn edges_far_from_their_surface_are_filled_with_a_plane() {
    let mut b = Builder::new();
    let (rim, _) = b.circle(1.0, 0.0);
    b.face(Surface::Plane(at_height(50.0)), true, &[&[(rim, true)]]);
    let (mesh, skipped, warnings) = tessellate(&b.0, &Options::default(), &Cancel::new()).unwrap();
    assert_eq!((mesh.faces.len(), skipped.len(), warnings.len()), (1, 0, 1));
    assert!((mesh.faces[0].area / PI - 1.0).abs() < 0.02);
}

#[test]
fn a_face_without_extent_is_skipped_with_its_number() {
    let mut b = Builder::new();
    let (rim, _) = b.circle(1.0, 0.0);
    b.face(Surface::Plane(at_height(0.0)), true, &[&[(rim, true)]]);
    b.face(Surface::Plane(at_height(0.0)), true, &[]);
    let (mesh, skipped, _) = tessellate(&b.0, &Options::default(), &Cancel::new()).unwrap();
    assert_eq!(mesh.faces.len(), 1);
    assert_eq!(skipped[0].entity, 2);
}

#[test]
fn cancelling_stops_the_work() {
    let mut b = Builder::new();
    b.face(Surface::Sphere { placement: at_height(0.0), radius: 1.0 }, true, &[]);
    let cancel = Cancel::new();
    cancel.cancel();
    assert!(tessellate(&b.0, &Options::default(), &cancel).is_err());
}
