//! Curves moved by a similarity (CURVE_REPLICA).

use crate::brep::nurbs::NurbsCurve;
use crate::brep::{Curve, Placement};
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

/// x and y are carried along, so that parameters stay; z is their cross product.
fn moved_placement(placement: &Placement, by: &Transform) -> Placement {
    let (x, y) = (by.direction(&placement.x), by.direction(&placement.y));
    Placement { origin: by.point(&placement.origin), x, y, z: x.cross(&y) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, Vector};

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
