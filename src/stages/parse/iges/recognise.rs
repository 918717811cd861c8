//! Planes, quadrics and tori that the file writes as swept surfaces.

use super::placement::placement;
use crate::brep::{Curve, Placement, Surface};
use crate::geometry::Vector;

/// Directions count as parallel or perpendicular up to this sine or cosine: files have ten digits.
const PARALLEL: f64 = 1e-8;

/// The elementary surface that a swept one is, and whether its normal is the opposite one. `bounds`: the rectangle
/// [u0, u1, v0, v1] that counts. `None`: as it is.
pub(super) fn recognised(surface: &Surface, bounds: [f64; 4]) -> Option<(Surface, bool)> {
    let elementary = match surface {
        Surface::Revolution { profile, axis } => match core(profile) {
            Curve::Line { origin, direction } => {
                turned_line(axis, [origin + direction * bounds[2], origin + direction * bounds[3]])
            }
            Curve::Circle { placement, radius } => turned_circle(axis, placement, *radius),
            _ => None,
        },
        Surface::Extrusion { profile, direction } => extruded(core(profile), direction),
        _ => None,
    }?;
    // Somewhere off the middle: the middle may be a pole.
    let [u, v] = [bounds[0] + 0.37 * (bounds[1] - bounds[0]), bounds[2] + 0.61 * (bounds[3] - bounds[2])];
    let jet = surface.jet(u, v);
    let uv = elementary.project(&jet.point, None)?;
    let found = elementary.jet(uv[0], uv[1]);
    let along = found.normal().dot(&jet.normal());
    (along != 0.0).then_some((elementary, along < 0.0))
}

fn core(curve: &Curve) -> &Curve {
    match curve {
        Curve::Trimmed { basis, forward: true, .. } => core(basis),
        other => other,
    }
}

/// A line in one plane with the axis, or at right angles to it: plane, cylinder or cone.
fn turned_line(axis: &Placement, ends: [crate::geometry::Point; 2]) -> Option<Surface> {
    let local = ends.map(|p| axis.local(&p));
    let radius = local.map(|q| q.x.hypot(q.y));
    let along = (local[1] - local[0]).try_normalize(f64::MIN_POSITIVE)?;
    let at = |q: &Vector| axis.point(0.0, 0.0, q.z);
    if along.z.abs() <= PARALLEL {
        return Some(Surface::Plane(Placement { origin: at(&local[0]), ..*axis }));
    }
    // The end farther from the axis: the other may lie on it.
    let far = if radius[0] >= radius[1] { 0 } else { 1 };
    let out = Vector::new(local[far].x, local[far].y, 0.0).try_normalize(f64::MIN_POSITIVE)?;
    if (out.x * along.y - out.y * along.x).abs() > PARALLEL {
        return None;
    }
    let placement = Placement { origin: at(&local[far]), ..*axis };
    let slope = out.dot(&along) / along.z;
    if slope.abs() <= PARALLEL {
        return Some(Surface::Cylinder { placement, radius: radius[far] });
    }
    Some(Surface::Cone { placement, radius: radius[far], half_angle: slope.atan() })
}

/// A circle in one plane with the axis: a sphere, or a torus that does not cut itself.
fn turned_circle(axis: &Placement, circle: &Placement, radius: f64) -> Option<Surface> {
    let centre = axis.local(&circle.origin);
    let distance = centre.x.hypot(centre.y);
    let normal_out = circle.z.dot(&(axis.x * centre.x + axis.y * centre.y));
    if circle.z.dot(&axis.z).abs() > PARALLEL || normal_out.abs() > PARALLEL * distance.max(radius) {
        return None;
    }
    let placement = Placement { origin: axis.point(0.0, 0.0, centre.z), ..*axis };
    if distance <= PARALLEL * radius {
        Some(Surface::Sphere { placement, radius })
    } else {
        (distance > radius).then_some(Surface::Torus { placement, major: distance, minor: radius })
    }
}

fn extruded(profile: &Curve, direction: &Vector) -> Option<Surface> {
    let along = direction.try_normalize(f64::MIN_POSITIVE)?;
    match profile {
        Curve::Line { origin, direction: line } => {
            let x = line.try_normalize(f64::MIN_POSITIVE)?;
            let z = x.cross(&along).try_normalize(1e-6)?;
            Some(Surface::Plane(placement(*origin, z, Some(x))))
        }
        Curve::Circle { placement, radius } if placement.z.cross(&along).norm() <= PARALLEL => {
            Some(Surface::Cylinder { placement: *placement, radius: *radius })
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::curves::level;
    use super::*;
    use crate::geometry::Point;

    fn turned(a: [f64; 3], b: [f64; 3]) -> Option<(Surface, bool)> {
        let (a, b) = (Point::from(a), Point::from(b));
        let profile = Box::new(Curve::Line { origin: a, direction: b - a });
        let surface = Surface::Revolution { profile, axis: level(0.0, 0.0, 0.0) };
        recognised(&surface, [0.0, 3.0, 0.0, 1.0])
    }

    #[test]
    fn turned_lines_are_planes_cylinders_and_cones() {
        assert!(matches!(turned([1.0, 0.0, 2.0], [3.0, 0.0, 2.0]), Some((Surface::Plane(_), true))));
        assert!(matches!(turned([3.0, 0.0, 0.0], [3.0, 0.0, 2.0]), Some((Surface::Cylinder { .. }, false))));
        assert!(matches!(turned([3.0, 0.0, 2.0], [3.0, 0.0, 0.0]), Some((Surface::Cylinder { .. }, true))));
        let Some((Surface::Cone { half_angle, .. }, false)) = turned([0.0, 0.0, 0.0], [1.0, 0.0, 1.0]) else {
            panic!("a line through the axis turns into a cone")
        };
        assert!((half_angle - 45_f64.to_radians()).abs() < 1e-12);
        assert!(turned([1.0, 0.0, 0.0], [1.0, 1.0, 1.0]).is_none(), "a hyperboloid");
    }

    #[test]
    fn turned_circles_are_spheres_and_tori() {
        let upright = |x: f64| Placement { x: Vector::x(), y: Vector::z(), z: -Vector::y(), ..level(x, 0.0, 1.0) };
        let of = |x: f64| {
            let profile = Box::new(Curve::Circle { placement: upright(x), radius: 2.0 });
            recognised(&Surface::Revolution { profile, axis: level(0.0, 0.0, 0.0) }, [0.0, 3.0, 0.0, 1.0])
        };
        assert!(matches!(of(0.0), Some((Surface::Sphere { .. }, false))));
        assert!(matches!(of(5.0), Some((Surface::Torus { .. }, false))));
        assert!(of(1.0).is_none());
    }
}
