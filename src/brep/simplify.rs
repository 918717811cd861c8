//! Surfaces written in a general way that are planes, quadrics or tori in truth.

use super::{Curve, Placement, Surface};
use crate::geometry::Vector;
#[cfg(test)]
use crate::geometry::any_perpendicular;

/// Directions count as parallel or perpendicular up to this sine or cosine.
const PARALLEL: f64 = 1e-9;

impl Surface {
    /// The same surface as plane, cylinder, cone, sphere or torus, with the same normal direction, where it is one:
    /// offsets of those, lines and circles extruded or turned. The parametrisation may differ. `None`: as it is.
    pub fn simplified(&self) -> Option<Self> {
        match self {
            Self::Offset { basis, distance } => {
                let simple = basis.simplified();
                offset(simple.as_ref().unwrap_or(basis), *distance)
            }
            Self::Extrusion { profile, direction } => extruded(core(profile), direction),
            Self::Revolution { profile, axis } => turned(core(profile), axis),
            _ => None,
        }
    }
}

/// The untrimmed curve, where it runs the same way.
fn core(curve: &Curve) -> &Curve {
    match curve {
        Curve::Trimmed { basis, forward: true, .. } => core(basis),
        other => other,
    }
}

fn offset(basis: &Surface, distance: f64) -> Option<Surface> {
    let surface = match basis {
        Surface::Plane(p) => Surface::Plane(Placement { origin: p.origin + p.z * distance, ..*p }),
        Surface::Cylinder { placement, radius } if radius + distance > 0.0 => {
            Surface::Cylinder { placement: *placement, radius: radius + distance }
        }
        Surface::Sphere { placement, radius } if radius + distance > 0.0 => {
            Surface::Sphere { placement: *placement, radius: radius + distance }
        }
        Surface::Torus { placement, major, minor } if minor + distance > 0.0 => {
            Surface::Torus { placement: *placement, major: *major, minor: minor + distance }
        }
        Surface::Cone { placement, radius, half_angle } => {
            let radius = radius + distance / half_angle.cos();
            Surface::Cone { placement: *placement, radius, half_angle: *half_angle }
        }
        _ => return None,
    };
    Some(surface)
}

fn extruded(profile: &Curve, direction: &Vector) -> Option<Surface> {
    let along = direction.try_normalize(f64::MIN_POSITIVE)?;
    match profile {
        Curve::Line { origin, direction: line } => {
            let x = line.try_normalize(f64::MIN_POSITIVE)?;
            let z = x.cross(&along).try_normalize(1e-6)?;
            Some(Surface::Plane(Placement { origin: *origin, x, y: z.cross(&x), z }))
        }
        Curve::Circle { placement, radius } if placement.z.cross(&along).norm() <= PARALLEL => {
            // Turned the other way round the normal of the extrusion points inwards: not our cylinder.
            (placement.z.dot(&along) > 0.0).then_some(Surface::Cylinder { placement: *placement, radius: *radius })
        }
        _ => None,
    }
}

fn turned(profile: &Curve, axis: &Placement) -> Option<Surface> {
    match profile {
        Curve::Line { origin, direction } => turned_line(axis, axis.local(origin), direction),
        Curve::Circle { placement, radius } => turned_circle(axis, placement, *radius),
        _ => None,
    }
}

/// A line in one plane with the axis: cylinder or cone (a plane has its pole inside and is left as it is).
fn turned_line(axis: &Placement, at: Vector, direction: &Vector) -> Option<Surface> {
    let d = Vector::new(direction.dot(&axis.x), direction.dot(&axis.y), direction.dot(&axis.z)) / direction.norm();
    let distance = at.x.hypot(at.y);
    let out = Vector::new(at.x, at.y, 0.0).try_normalize(f64::MIN_POSITIVE)?;
    let skew = out.x * d.y - out.y * d.x;
    // Upwards only: for a line that runs down the normal points to the axis.
    if skew.abs() > PARALLEL || d.z <= 0.05 || distance <= 0.0 {
        return None;
    }
    let slope = out.dot(&d) / d.z;
    if slope.abs() <= PARALLEL {
        return Some(Surface::Cylinder { placement: *axis, radius: distance });
    }
    let placement = Placement { origin: axis.origin + axis.z * at.z, ..*axis };
    Some(Surface::Cone { placement, radius: distance, half_angle: slope.atan() })
}

/// A circle in one plane with the axis: a sphere about a point of the axis, or a torus that does not cut itself.
fn turned_circle(axis: &Placement, circle: &Placement, radius: f64) -> Option<Surface> {
    let centre = axis.local(&circle.origin);
    let distance = centre.x.hypot(centre.y);
    if circle.z.dot(&axis.z).abs() > PARALLEL {
        return None;
    }
    let placement = Placement { origin: axis.origin + axis.z * centre.z, ..*axis };
    // At its outermost point the profile must run upwards for the normal to point outwards.
    let out = if distance > 1e-9 * radius { axis.x * centre.x + axis.y * centre.y } else { return None };
    let upwards = circle.z.cross(&out).dot(&axis.z) > 0.0;
    let coplanar = circle.z.dot(&out).abs() <= PARALLEL * distance;
    (upwards && coplanar && distance > radius).then_some(Surface::Torus { placement, major: distance, minor: radius })
}

/// Some placement with the given z axis.
#[cfg(test)]
fn about(z: Vector) -> Placement {
    let x = any_perpendicular(&z);
    Placement { origin: crate::geometry::Point::origin(), x, y: z.cross(&x), z }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;

    /// The simplified surface goes through a point of the general one, with its normal.
    fn assert_same_with_normal(general: &Surface) {
        let simple = general.simplified().unwrap();
        let jet = general.jet(0.7, 0.4);
        let [u, v] = simple.project(&jet.point, None).unwrap();
        assert!((simple.point(u, v) - jet.point).norm() < 1e-12);
        assert!(simple.jet(u, v).normal().dot(&jet.normal()) > 0.0);
    }

    #[test]
    fn a_turned_circle_is_a_torus_with_the_same_normal() {
        let axis = about(Vector::z());
        let circle = Placement { origin: axis.point(5.0, 0.0, 1.0), x: axis.x, y: axis.z, z: -axis.y };
        let profile = Box::new(Curve::Circle { placement: circle, radius: 2.0 });
        let general = Surface::Revolution { profile, axis };
        assert_same_with_normal(&general);
    }

    #[test]
    fn a_turned_line_is_a_cone_with_the_same_normal() {
        let axis = about(Vector::z());
        let line = Curve::Line { origin: axis.point(3.0, 0.0, 1.0), direction: axis.z + axis.x * 0.5 };
        let general = Surface::Revolution { profile: Box::new(line), axis };
        assert_same_with_normal(&general);
    }

    #[test]
    fn an_offset_cone_moves_along_its_normal() {
        let basis = Surface::Cone { placement: about(Vector::z()), radius: 3.0, half_angle: 0.3 };
        let simple = Surface::Offset { basis: Box::new(basis.clone()), distance: 0.5 }.simplified().unwrap();
        let jet = basis.jet(0.3, 0.2);
        let moved: Point = jet.point + jet.normal().normalize() * 0.5;
        let [u, v] = simple.project(&moved, None).unwrap();
        assert!((simple.point(u, v) - moved).norm() < 1e-12);
    }
}
