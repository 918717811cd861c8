//! Surfaces in space.

use super::nurbs::NurbsSurface;
use super::project::{closest_on_surface, project_revolution};
use super::{Curve, Placement};
use crate::geometry::{Point, Vector};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A parametric surface, as STEP (ISO 10303-42) parametrises it; angles in radians, lengths in mm.
#[derive(Clone, Debug)]
pub enum Surface {
    /// origin + u x + v y.
    Plane(Placement),
    /// origin + radius (cos u x + sin u y) + v z.
    Cylinder {
        /// Its centre (or a point of its axis) and axes; z is the axis or normal.
        placement: Placement,
        /// mm; of a cone where z is 0.
        radius: f64,
    },
    /// origin + (radius + v tan half_angle)(cos u x + sin u y) + v z; a zero radius puts the apex at the origin.
    Cone {
        /// Its centre (or a point of its axis) and axes; z is the axis or normal.
        placement: Placement,
        /// mm; of a cone where z is 0.
        radius: f64,
        /// Angle between axis and surface, radians.
        half_angle: f64,
    },
    /// origin + radius cos v (cos u x + sin u y) + radius sin v z.
    Sphere {
        /// Its centre (or a point of its axis) and axes; z is the axis or normal.
        placement: Placement,
        /// mm; of a cone where z is 0.
        radius: f64,
    },
    /// origin + (major + minor cos v)(cos u x + sin u y) + minor sin v z.
    Torus {
        /// Its centre (or a point of its axis) and axes; z is the axis or normal.
        placement: Placement,
        /// Radius of the circle that the tube runs along, mm.
        major: f64,
        /// Radius of the tube, mm.
        minor: f64,
    },
    /// A B-spline surface, rational or not.
    Nurbs(NurbsSurface),
    /// `profile` turned by u about the axis (placement z through its origin); v is the profile's parameter.
    Revolution {
        /// The curve that is moved.
        profile: Box<Curve>,
        /// What it turns about: z through the origin.
        axis: Placement,
    },
    /// profile(u) + v direction.
    Extrusion {
        /// The curve that is moved.
        profile: Box<Curve>,
        /// Where it is moved to for a parameter of 1, mm.
        direction: Vector,
    },
    /// `basis` moved by `distance` along its unit normal.
    Offset {
        /// The surface it is made from.
        basis: Box<Surface>,
        /// How far it is moved along the normal, mm.
        distance: f64,
    },
    /// A rectangle of `basis` (RECTANGULAR_TRIMMED_SURFACE): bounds [u0, u1, v0, v1].
    Rectangular {
        /// The surface it is made from.
        basis: Box<Surface>,
        /// Least and greatest u, least and greatest v.
        bounds: [f64; 4],
    },
}

/// A point of a surface with its partial derivatives up to second order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// The point, mm.
    pub point: Point,
    /// First derivative in u.
    pub du: Vector,
    /// First derivative in v.
    pub dv: Vector,
    /// Second derivative in u.
    pub duu: Vector,
    /// Mixed derivative.
    pub duv: Vector,
    /// Second derivative in v.
    pub dvv: Vector,
}

impl Jet {
    /// A point without its derivatives: they are zero.
    pub(super) fn at(point: Point) -> Self {
        let zero = Vector::zeros();
        Self { point, du: zero, dv: zero, duu: zero, duv: zero, dvv: zero }
    }

    /// S_u x S_v: the surface normal times the area element.
    pub fn normal(&self) -> Vector {
        self.du.cross(&self.dv)
    }
}

/// The type of a surface with the sizes that stay the same when it is moved or mirrored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SurfaceKind {
    /// A plane.
    Plane,
    /// A cylinder.
    Cylinder {
        /// mm.
        radius: f64,
    },
    /// A cone.
    Cone {
        /// Angle between axis and surface, radians.
        half_angle: f64,
    },
    /// A sphere.
    Sphere {
        /// mm.
        radius: f64,
    },
    /// A torus.
    Torus {
        /// Radius of the circle that the tube runs along, mm.
        major: f64,
        /// Radius of the tube, mm.
        minor: f64,
    },
    /// A B-spline surface, rational or not.
    Nurbs,
    /// A curve turned about an axis, of no simpler kind.
    Revolution,
    /// A curve moved along a line, of no simpler kind.
    Extrusion,
    /// Another surface moved along its normal.
    Offset,
}

impl Surface {
    /// The point at (u, v).
    pub fn point(&self, u: f64, v: f64) -> Point {
        self.jet_to::<0>(u, v).point
    }

    /// Point and first derivatives at (u, v); whether the second ones are there, is left open.
    pub(super) fn tangents(&self, u: f64, v: f64) -> Jet {
        self.jet_to::<1>(u, v)
    }

    /// Point and derivatives at (u, v); bounded surfaces clamp the parameters to their domain.
    pub fn jet(&self, u: f64, v: f64) -> Jet {
        self.jet_to::<2>(u, v)
    }

    /// With derivatives up to `ORDER` and perhaps more.
    fn jet_to<const ORDER: usize>(&self, u: f64, v: f64) -> Jet {
        match self {
            Self::Plane(placement) => plane(placement, u, v),
            Self::Cylinder { placement, radius } => turned::<ORDER>(placement, u, [*radius, 0.0, 0.0], [v, 1.0, 0.0]),
            Self::Cone { placement, radius, half_angle } => {
                let slope = half_angle.tan();
                turned::<ORDER>(placement, u, [radius + v * slope, slope, 0.0], [v, 1.0, 0.0])
            }
            Self::Sphere { placement, radius } => ring::<ORDER>(placement, 0.0, *radius, u, v),
            Self::Torus { placement, major, minor } => ring::<ORDER>(placement, *major, *minor, u, v),
            Self::Nurbs(nurbs) => nurbs.jet_to::<ORDER>(u, v),
            Self::Revolution { profile, axis } => revolution(profile, axis, u, v),
            Self::Extrusion { profile, direction } => {
                let [p, du, duu] = profile.derivatives(u);
                Jet { du, dv: *direction, duu, ..Jet::at(Point::from(p + direction * v)) }
            }
            Self::Offset { basis, distance } => offset(basis, *distance, u, v),
            Self::Rectangular { basis, .. } => basis.jet_to::<ORDER>(u, v),
        }
    }

    /// The unit normal S_u x S_v; `None` where it vanishes (poles).
    pub fn normal(&self, u: f64, v: f64) -> Option<Vector> {
        let normal = self.tangents(u, v).normal();
        normal.try_normalize(f64::MIN_POSITIVE).filter(|n| n.iter().all(|c| c.is_finite()))
    }

    /// The parameter rectangle [u0, u1, v0, v1]; infinite where the surface is.
    pub fn domain(&self) -> [f64; 4] {
        let infinite = [f64::NEG_INFINITY, f64::INFINITY];
        let ([u0, u1], [v0, v1]) = match self {
            Self::Plane(_) => (infinite, infinite),
            Self::Cylinder { .. } | Self::Cone { .. } => ([0.0, TAU], infinite),
            Self::Sphere { .. } => ([0.0, TAU], [-FRAC_PI_2, FRAC_PI_2]),
            Self::Torus { .. } => ([0.0, TAU], [0.0, TAU]),
            Self::Nurbs(nurbs) => return nurbs.domain(),
            Self::Revolution { profile, .. } => ([0.0, TAU], profile.domain()),
            Self::Extrusion { profile, .. } => (profile.domain(), infinite),
            Self::Offset { basis, .. } => return basis.domain(),
            Self::Rectangular { bounds, .. } => return *bounds,
        };
        [u0, u1, v0, v1]
    }

    /// The periods in u and v: after them the surface repeats; a NURBS closed in a direction has its width there.
    pub fn periods(&self) -> [Option<f64>; 2] {
        match self {
            Self::Plane(_) => [None, None],
            Self::Cylinder { .. } | Self::Cone { .. } | Self::Sphere { .. } => [Some(TAU), None],
            Self::Torus { .. } => [Some(TAU), Some(TAU)],
            Self::Nurbs(nurbs) => nurbs_periods(nurbs),
            Self::Revolution { profile, .. } => [Some(TAU), profile.period()],
            Self::Extrusion { profile, .. } => [profile.period(), None],
            Self::Offset { basis, .. } | Self::Rectangular { basis, .. } => basis.periods(),
        }
    }

    /// The parameters of the point of the surface nearest to `p`: closed forms for planes and quadrics and tori,
    /// else Newton's method from `hint`, else from the best of a grid of samples. `None` where nothing finite comes
    /// out.
    pub fn project(&self, p: &Point, hint: Option<[f64; 2]>) -> Option<[f64; 2]> {
        self.project_within(self.periods(), p, hint)
    }

    /// As [`Self::project`], for who has asked for the periods already: they cost more than the projection.
    pub(super) fn project_within(
        &self,
        periods: [Option<f64>; 2],
        p: &Point,
        hint: Option<[f64; 2]>,
    ) -> Option<[f64; 2]> {
        let uv = match self {
            Self::Plane(placement) => {
                let d = p - placement.origin;
                [d.dot(&placement.x), d.dot(&placement.y)]
            }
            Self::Cylinder { placement, .. } => {
                let q = placement.local(p);
                [q.y.atan2(q.x), q.z]
            }
            Self::Cone { placement, radius, half_angle } => {
                let q = placement.local(p);
                project_cone(q, *radius, *half_angle)
            }
            Self::Sphere { placement, .. } => {
                let q = placement.local(p);
                [q.y.atan2(q.x), q.z.atan2(q.x.hypot(q.y))]
            }
            Self::Torus { placement, major, .. } => {
                let q = placement.local(p);
                [q.y.atan2(q.x), q.z.atan2(q.x.hypot(q.y) - major)]
            }
            Self::Revolution { profile, axis } => project_revolution(profile, axis, p, hint)?,
            Self::Rectangular { basis, .. } => basis.project_within(periods, p, hint)?,
            Self::Nurbs(_) | Self::Extrusion { .. } | Self::Offset { .. } => {
                closest_on_surface(self, periods, p, hint)?
            }
        };
        (uv[0].is_finite() && uv[1].is_finite()).then_some(uv)
    }

    /// The type with the intrinsic sizes, after [`Surface::simplified`].
    pub fn kind(&self) -> SurfaceKind {
        match self {
            Self::Plane(_) => SurfaceKind::Plane,
            Self::Cylinder { radius, .. } => SurfaceKind::Cylinder { radius: *radius },
            Self::Cone { half_angle, .. } => SurfaceKind::Cone { half_angle: half_angle.abs() },
            Self::Sphere { radius, .. } => SurfaceKind::Sphere { radius: *radius },
            Self::Torus { major, minor, .. } => SurfaceKind::Torus { major: *major, minor: *minor },
            Self::Nurbs(_) => SurfaceKind::Nurbs,
            Self::Revolution { .. } => SurfaceKind::Revolution,
            Self::Extrusion { .. } => SurfaceKind::Extrusion,
            Self::Offset { .. } => SurfaceKind::Offset,
            Self::Rectangular { basis, .. } => basis.kind(),
        }
    }

    /// Whether the surface is curved along one parameter at most, v being along straight lines (plane, cylinder,
    /// cone, extrusion).
    pub fn is_ruled_along_v(&self) -> bool {
        matches!(self, Self::Plane(_) | Self::Cylinder { .. } | Self::Cone { .. } | Self::Extrusion { .. })
    }
}

fn plane(placement: &Placement, u: f64, v: f64) -> Jet {
    Jet { du: placement.x, dv: placement.y, ..Jet::at(placement.point(u, v, 0.0)) }
}

/// A profile given as distance from the axis and height, each with two derivatives by v, turned by u.
fn turned<const ORDER: usize>(placement: &Placement, u: f64, rho: [f64; 3], height: [f64; 3]) -> Jet {
    let (s, c) = u.sin_cos();
    let out = placement.x * c + placement.y * s;
    let around = placement.y * c - placement.x * s;
    let mut jet = Jet::at(placement.origin + out * rho[0] + placement.z * height[0]);
    if ORDER > 0 {
        (jet.du, jet.dv) = (around * rho[0], out * rho[1] + placement.z * height[1]);
    }
    if ORDER > 1 {
        (jet.duu, jet.duv) = (out * -rho[0], around * rho[1]);
        jet.dvv = out * rho[2] + placement.z * height[2];
    }
    jet
}

/// A circle of radius `minor` at `major` from the axis, turned: a torus, or with `major` 0 a sphere.
fn ring<const ORDER: usize>(placement: &Placement, major: f64, minor: f64, u: f64, v: f64) -> Jet {
    let (s, c) = v.sin_cos();
    turned::<ORDER>(placement, u, [major + minor * c, -minor * s, -minor * c], [minor * s, minor * c, -minor * s])
}

fn revolution(profile: &Curve, axis: &Placement, u: f64, v: f64) -> Jet {
    let (s, c) = u.sin_cos();
    let [p, d, dd] = profile.derivatives(v);
    let p = p - axis.origin.coords;
    let across = |a: &Vector| a - axis.z * axis.z.dot(a);
    let turn = |a: &Vector| across(a) * c + axis.z.cross(a) * s + axis.z * axis.z.dot(a);
    let turn_d = |a: &Vector| axis.z.cross(a) * c - across(a) * s;
    Jet {
        point: axis.origin + turn(&p),
        du: turn_d(&p),
        dv: turn(&d),
        duu: -(across(&p) * c + axis.z.cross(&p) * s),
        duv: turn_d(&d),
        dvv: turn(&dd),
    }
}

/// Steps for central differences: a small share of the domain, or of a turn.
fn difference_steps([u0, u1, v0, v1]: [f64; 4]) -> [f64; 2] {
    [u1 - u0, v1 - v0].map(|width| if width.is_finite() { 1e-4 * width } else { 1e-3 })
}

/// The derivatives by central differences of the normal; at poles of the basis the normal is that of a point nearby.
fn offset(basis: &Surface, distance: f64, u: f64, v: f64) -> Jet {
    let [u0, u1, v0, v1] = basis.domain();
    let [h, k] = difference_steps([u0, u1, v0, v1]);
    let (mu, mv) = match basis.periods() {
        [Some(_), Some(_)] => (u, v),
        [Some(_), None] => (u, v.clamp(v0 + k, v1 - k)),
        [None, Some(_)] => (u.clamp(u0 + h, u1 - h), v),
        [None, None] => (u.clamp(u0 + h, u1 - h), v.clamp(v0 + k, v1 - k)),
    };
    let at = |u: f64, v: f64| {
        let jet = basis.jet(u, v);
        let normal = jet.normal().try_normalize(f64::MIN_POSITIVE).or_else(|| basis.normal(mu + 0.1 * h, mv + 0.1 * k));
        jet.point.coords + normal.unwrap_or_default() * distance
    };
    let (p, west, east, south, north) = (at(mu, mv), at(mu - h, mv), at(mu + h, mv), at(mu, mv - k), at(mu, mv + k));
    let corners = at(mu + h, mv + k) - at(mu - h, mv + k) - at(mu + h, mv - k) + at(mu - h, mv - k);
    Jet {
        point: Point::from(at(u, v)),
        du: (east - west) / (2.0 * h),
        dv: (north - south) / (2.0 * k),
        duu: (east + west - p * 2.0) / (h * h),
        duv: corners / (4.0 * h * k),
        dvv: (north + south - p * 2.0) / (k * k),
    }
}

/// Closed in a direction: both ends of the iso-curves agree, compared with the size of the control net.
fn nurbs_periods(nurbs: &NurbsSurface) -> [Option<f64>; 2] {
    let [u0, u1, v0, v1] = nurbs.domain();
    let size = crate::geometry::Aabb::of(&nurbs.points).diagonal();
    let at = |[u, v]: [f64; 2]| nurbs.jet_to::<0>(u, v).point;
    let same = |a: [f64; 2], b: [f64; 2]| (at(a) - at(b)).norm() <= 1e-6 * size;
    let shares = [0.0, 0.31, 0.5, 0.77, 1.0];
    let closed_u = shares.iter().all(|s| same([u0, v0 + s * (v1 - v0)], [u1, v0 + s * (v1 - v0)]));
    let closed_v = shares.iter().all(|s| same([u0 + s * (u1 - u0), v0], [u0 + s * (u1 - u0), v1]));
    // A surface with a collapsed side is not closed along the other direction for that alone: the iso-curves must
    // have a length.
    let middle = nurbs.jet(0.5 * (u0 + u1), 0.5 * (v0 + v1));
    let long_u = middle.du.norm() * (u1 - u0) > 1e-6 * size;
    let long_v = middle.dv.norm() * (v1 - v0) > 1e-6 * size;
    [(closed_u && long_u).then_some(u1 - u0), (closed_v && long_v).then_some(v1 - v0)]
}

/// The nearest point on the straight profile, on the side of the axis where `q` is.
fn project_cone(q: Vector, radius: f64, half_angle: f64) -> [f64; 2] {
    let (s, c) = half_angle.sin_cos();
    let rho = q.x.hypot(q.y);
    let v = ((rho - radius) * s + q.z * c) * c;
    // Beyond the apex the profile has a negative distance from the axis: the other half of the double cone.
    let other = ((-rho - radius) * s + q.z * c) * c;
    let miss = |rho: f64, v: f64| {
        ((rho - radius) * c - q.z * s).abs() + if radius + v * s / c < 0.0 { rho.max(0.0) } else { 0.0 }
    };
    if radius + other * s / c < 0.0 && miss(-rho, other) < miss(rho, v) {
        let u = q.y.atan2(q.x) + PI;
        return [u, other];
    }
    [q.y.atan2(q.x), v]
}
