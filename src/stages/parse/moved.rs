//! Curves and surfaces moved by a similarity.

use crate::brep::nurbs::{NurbsCurve, NurbsSurface};
use crate::brep::{Curve, Placement, Surface};
use crate::geometry::Transform;

/// The image of a curve with the same parametrisation.
pub(super) fn moved_curve(curve: Curve, by: &Transform) -> Curve {
    let scale = by.scale();
    let place = |p: &Placement| moved_placement(p, by);
    match curve {
        Curve::Line { origin, direction } => {
            Curve::Line { origin: by.point(&origin), direction: by.vector(&direction) }
        }
        Curve::Circle { placement, radius } => Curve::Circle { placement: place(&placement), radius: radius * scale },
        Curve::Ellipse { placement, semi_x, semi_y } => {
            Curve::Ellipse { placement: place(&placement), semi_x: semi_x * scale, semi_y: semi_y * scale }
        }
        Curve::Parabola { placement, focal } => Curve::Parabola { placement: place(&placement), focal: focal * scale },
        Curve::Hyperbola { placement, semi_x, semi_y } => {
            Curve::Hyperbola { placement: place(&placement), semi_x: semi_x * scale, semi_y: semi_y * scale }
        }
        Curve::Nurbs(nurbs) => {
            let points = nurbs.points.iter().map(|p| by.point(p)).collect();
            Curve::Nurbs(NurbsCurve { points, ..nurbs })
        }
        Curve::Polyline(points) => Curve::Polyline(points.iter().map(|p| by.point(p)).collect()),
        Curve::Trimmed { basis, range, forward } => {
            Curve::Trimmed { basis: Box::new(moved_curve(*basis, by)), range, forward }
        }
        Curve::Composite(pieces) => {
            Curve::Composite(pieces.into_iter().map(|(piece, sense)| (moved_curve(piece, by), sense)).collect())
        }
        Curve::Offset { basis, distance, reference } => {
            // reference x tangent turns over in a mirror.
            let turned = if by.mirrors() { -by.direction(&reference) } else { by.direction(&reference) };
            Curve::Offset { basis: Box::new(moved_curve(*basis, by)), distance: distance * scale, reference: turned }
        }
    }
}

/// The image of a surface, and whether its normal S_u x S_v is against the image of the normal, as happens in mirrors
/// where the parametrisation stays.
pub(super) fn moved_surface(surface: Surface, by: &Transform) -> (Surface, bool) {
    let scale = by.scale();
    let place = |p: &Placement| about_moved_axis(p, by);
    let moved = match surface {
        Surface::Plane(p) => Surface::Plane(place(&p)),
        Surface::Cylinder { placement, radius } => {
            Surface::Cylinder { placement: place(&placement), radius: radius * scale }
        }
        Surface::Cone { placement, radius, half_angle } => {
            Surface::Cone { placement: place(&placement), radius: radius * scale, half_angle }
        }
        Surface::Sphere { placement, radius } => {
            Surface::Sphere { placement: place(&placement), radius: radius * scale }
        }
        Surface::Torus { placement, major, minor } => {
            Surface::Torus { placement: place(&placement), major: major * scale, minor: minor * scale }
        }
        general => return moved_general(general, by),
    };
    (moved, false)
}

/// Surfaces made of others or of control points.
fn moved_general(surface: Surface, by: &Transform) -> (Surface, bool) {
    let mirrors = by.mirrors();
    match surface {
        Surface::Nurbs(nurbs) => {
            let points = nurbs.points.iter().map(|p| by.point(p)).collect();
            (Surface::Nurbs(NurbsSurface { points, ..nurbs }), mirrors)
        }
        Surface::Revolution { profile, axis } => {
            // In a mirror the image turns the other way about the image of the axis.
            let z = if mirrors { -by.direction(&axis.z) } else { by.direction(&axis.z) };
            let x = by.direction(&axis.x);
            let axis = Placement { origin: by.point(&axis.origin), x, y: z.cross(&x), z };
            (Surface::Revolution { profile: Box::new(moved_curve(*profile, by)), axis }, mirrors)
        }
        Surface::Extrusion { profile, direction } => {
            let profile = Box::new(moved_curve(*profile, by));
            (Surface::Extrusion { profile, direction: by.vector(&direction) }, mirrors)
        }
        Surface::Offset { basis, distance } => {
            let (basis, turned) = moved_surface(*basis, by);
            let distance = distance * by.scale() * if turned { -1.0 } else { 1.0 };
            (Surface::Offset { basis: Box::new(basis), distance }, turned)
        }
        Surface::Rectangular { basis, bounds } => moved_rectangle(*basis, bounds, by),
        elementary => moved_surface(elementary, by),
    }
}

/// In a mirror u (on planes v) runs backwards on elementary surfaces; lengths along them grow.
fn moved_rectangle(basis: Surface, bounds: [f64; 4], by: &Transform) -> (Surface, bool) {
    let scale = by.scale();
    let backwards = |[a, b]: [f64; 2], turn: bool| if turn { [-b, -a] } else { [a, b] };
    let flat = matches!(basis, Surface::Plane(_));
    let [along_u, along_v] = match &basis {
        Surface::Plane(_) => [scale, scale],
        Surface::Cylinder { .. } | Surface::Cone { .. } => [1.0, scale],
        _ => [1.0, 1.0],
    };
    let (basis, turned) = moved_surface(basis, by);
    let mirrored = by.mirrors() && !turned;
    let [u0, u1] = backwards([bounds[0] * along_u, bounds[1] * along_u], mirrored && !flat);
    let [v0, v1] = backwards([bounds[2] * along_v, bounds[3] * along_v], mirrored && flat);
    (Surface::Rectangular { basis: Box::new(basis), bounds: [u0, u1, v0, v1] }, turned)
}

/// x and z are carried along; y makes the axes right-handed.
fn about_moved_axis(placement: &Placement, by: &Transform) -> Placement {
    let (x, z) = (by.direction(&placement.x), by.direction(&placement.z));
    Placement { origin: by.point(&placement.origin), x, y: z.cross(&x), z }
}

/// x and y are carried along, so that parameters stay; z is their cross product.
fn moved_placement(placement: &Placement, by: &Transform) -> Placement {
    let (x, y) = (by.direction(&placement.x), by.direction(&placement.y));
    Placement { origin: by.point(&placement.origin), x, y, z: x.cross(&y) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, Vector};

    fn upright() -> Placement {
        Placement { origin: Point::new(1.0, 2.0, 3.0), x: Vector::x(), y: Vector::y(), z: Vector::z() }
    }

    /// Every point of `surface` goes to a point of the image, and the normals go as the flag says.
    fn assert_moves(surface: Surface, by: &Transform) {
        let (image, turned) = moved_surface(surface.clone(), by);
        for uv in [[0.3, 0.4], [1.1, 0.2]] {
            let jet = surface.jet(uv[0], uv[1]);
            let [u, v] = image.project(&by.point(&jet.point), None).unwrap();
            let found = image.jet(u, v);
            assert!((found.point - by.point(&jet.point)).norm() < 1e-9);
            let along = found.normal().dot(&by.vector(&jet.normal()));
            assert_eq!(along < 0.0, turned, "{image:?}");
            let [u0, u1, v0, v1] = image.domain();
            assert!((u0 <= u && u <= u1 && v0 <= v && v <= v1) || image.periods()[0].is_some(), "{image:?} {u} {v}");
        }
    }

    #[test]
    fn surfaces_follow_a_mirror_that_enlarges() {
        let by = Transform::from_axes(
            &Point::new(5.0, 0.0, 1.0),
            &Vector::new(0.0, 2.0, 0.0),
            &Vector::new(2.0, 0.0, 0.0),
            &Vector::new(0.0, 0.0, 2.0),
        );
        assert!(by.mirrors());
        let arc =
            Curve::Circle { placement: Placement { origin: Point::new(4.0, 2.0, 3.0), ..upright() }, radius: 1.0 };
        let cylinder = Surface::Cylinder { placement: upright(), radius: 2.0 };
        let turning = Placement { x: Vector::x(), y: Vector::z(), z: -Vector::y(), ..upright() };
        let extrusion = Surface::Extrusion { profile: Box::new(arc.clone()), direction: Vector::new(0.0, 1.0, 3.0) };
        let plane = Surface::Plane(upright());
        let rectangle =
            |basis: &Surface| Surface::Rectangular { basis: Box::new(basis.clone()), bounds: [0.0, 1.5, 0.1, 0.5] };
        let surfaces = [
            rectangle(&plane),
            plane,
            Surface::Cone { placement: upright(), radius: 2.0, half_angle: 0.3 },
            Surface::Sphere { placement: upright(), radius: 2.0 },
            Surface::Torus { placement: upright(), major: 5.0, minor: 2.0 },
            Surface::Revolution { profile: Box::new(arc), axis: turning },
            rectangle(&cylinder),
            Surface::Offset { basis: Box::new(extrusion.clone()), distance: 0.25 },
            extrusion,
            Surface::Offset { basis: Box::new(cylinder), distance: 0.5 },
        ];
        for surface in surfaces {
            assert_moves(surface.clone(), &by);
            assert_moves(surface, &Transform::from_axes(&Point::origin(), &Vector::y(), &Vector::z(), &Vector::x()));
        }
    }

    #[test]
    fn a_mirrored_circle_keeps_its_parameters() {
        let placement = Placement { origin: Point::origin(), x: Vector::x(), y: Vector::y(), z: Vector::z() };
        let mirror = Transform::from_axes(&Point::new(1.0, 0.0, 0.0), &Vector::x(), &-Vector::y(), &Vector::z());
        let Curve::Circle { placement, radius } = moved_curve(Curve::Circle { placement, radius: 2.0 }, &mirror) else {
            panic!("a circle stays a circle")
        };
        assert_eq!(
            (placement.origin, placement.y, placement.z, radius),
            (Point::new(1.0, 0.0, 0.0), -Vector::y(), -Vector::z(), 2.0)
        );
    }
}
