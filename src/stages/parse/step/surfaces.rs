//! Surface entities -> [`Surface`].

use super::curves::parameter_unit;
use super::keyword::Kind;
use super::placement::Geometry;
use super::records::Record;
use super::splines;
use crate::brep::{Curve, Surface};
use crate::stages::parse::fault::{Fault, Read};
use crate::stages::parse::moved::moved_surface;
use crate::stages::parse::sound;

/// How deep surfaces may be made of surfaces.
const DEEPEST_SURFACE: u32 = 16;

const ELEMENTARY: &[Kind] = &[
    Kind::RepresentationItem,
    Kind::ElementarySurface,
    Kind::Plane,
    Kind::CylindricalSurface,
    Kind::ConicalSurface,
    Kind::SphericalSurface,
    Kind::ToroidalSurface,
];
const SWEPT: &[Kind] =
    &[Kind::RepresentationItem, Kind::SweptSurface, Kind::SurfaceOfRevolution, Kind::SurfaceOfLinearExtrusion];

impl Geometry<'_> {
    /// Any surface that can be evaluated.
    pub fn surface(&self, id: u64) -> Read<Surface> {
        let surface = self.nested_surface(id, 0)?;
        sound::surface(&surface).map_err(|why| Fault::new(id, why))?;
        Ok(surface)
    }

    fn nested_surface(&self, id: u64, depth: u32) -> Read<Surface> {
        if depth > DEEPEST_SURFACE {
            return Err(Fault::new(id, "surfaces nested too deep"));
        }
        self.spend(id, 1)?;
        let record = self.file.record(id)?;
        for kind in record.kinds() {
            if let Some(surface) = self.surface_of_kind(&record, kind, depth)? {
                return Ok(surface);
            }
        }
        Err(record.fault("not a surface that is known"))
    }

    fn surface_of_kind(&self, record: &Record, kind: Kind, depth: u32) -> Read<Option<Surface>> {
        Ok(Some(match kind {
            Kind::Plane
            | Kind::CylindricalSurface
            | Kind::ConicalSurface
            | Kind::SphericalSurface
            | Kind::ToroidalSurface
            | Kind::DegenerateToroidalSurface => self.elementary(record, kind)?,
            Kind::BSplineSurface
            | Kind::BSplineSurfaceWithKnots
            | Kind::RationalBSplineSurface
            | Kind::QuasiUniformSurface
            | Kind::UniformSurface
            | Kind::BezierSurface => Surface::Nurbs(splines::surface(self, record)?),
            Kind::SurfaceOfRevolution | Kind::SurfaceOfLinearExtrusion => self.swept(record, kind)?,
            Kind::OffsetSurface => {
                let mut cursor = record.fields(&[Kind::RepresentationItem, Kind::OffsetSurface]);
                let basis = Box::new(self.nested_surface(cursor.skip_many(1).reference()?, depth + 1)?);
                Surface::Offset { basis, distance: cursor.real()? * self.units.length }
            }
            Kind::RectangularTrimmedSurface => self.rectangular(record, depth)?,
            Kind::SurfaceReplica => self.surface_replica(record, depth)?,
            Kind::CurveBoundedSurface => {
                let mut cursor = record.fields(&[Kind::RepresentationItem, Kind::CurveBoundedSurface]);
                self.nested_surface(cursor.skip_many(1).reference()?, depth + 1)?
            }
            _ => return Ok(None),
        }))
    }

    /// SURFACE_REPLICA: a surface moved by a similarity.
    fn surface_replica(&self, record: &Record, depth: u32) -> Read<Surface> {
        let mut cursor = record.fields(&[Kind::RepresentationItem, Kind::SurfaceReplica]);
        let parent = self.nested_surface(cursor.skip_many(1).reference()?, depth + 1)?;
        let by = self.transform(cursor.reference()?)?;
        if by.mirrors() {
            return Err(record.fault("a mirrored copy of a surface"));
        }
        Ok(moved_surface(parent, &by).0)
    }

    fn elementary(&self, record: &Record, kind: Kind) -> Read<Surface> {
        let mut cursor = record.fields(ELEMENTARY);
        let placement = self.placement(cursor.skip_many(1).reference()?)?;
        Ok(match kind {
            Kind::Plane => Surface::Plane(placement),
            Kind::CylindricalSurface => Surface::Cylinder { placement, radius: self.length(record, &mut cursor)? },
            Kind::SphericalSurface => Surface::Sphere { placement, radius: self.length(record, &mut cursor)? },
            Kind::ConicalSurface => {
                let radius = cursor.real()? * self.units.length;
                let half_angle = cursor.real()? * self.units.angle;
                let bent = (1e-9..std::f64::consts::FRAC_PI_2 - 1e-9).contains(&half_angle.abs());
                if !bent || radius < 0.0 {
                    return Err(record.fault("a cone with an impossible angle or radius"));
                }
                Surface::Cone { placement, radius, half_angle }
            }
            _ => {
                let major = cursor.real()?.abs() * self.units.length;
                Surface::Torus { placement, major, minor: self.length(record, &mut cursor)? }
            }
        })
    }

    fn swept(&self, record: &Record, kind: Kind) -> Read<Surface> {
        let mut cursor = record.fields(SWEPT);
        let profile = Box::new(self.nested_curve(cursor.skip_many(1).reference()?, 0)?);
        let along = cursor.reference()?;
        Ok(match kind {
            Kind::SurfaceOfRevolution => Surface::Revolution { profile, axis: self.axis(along)? },
            _ => Surface::Extrusion { profile, direction: self.vector(along)? },
        })
    }

    /// AXIS1_PLACEMENT with some x axis.
    fn axis(&self, id: u64) -> Read<crate::brep::Placement> {
        self.placement(id)
    }

    /// Bounds in radians where the basis has an angle as parameter and in mm where it has a length.
    fn rectangular(&self, record: &Record, depth: u32) -> Read<Surface> {
        let mut cursor = record.fields(&[Kind::RepresentationItem, Kind::RectangularTrimmedSurface]);
        let basis = self.nested_surface(cursor.skip_many(1).reference()?, depth + 1)?;
        let [unit_u, unit_v] = self.parameter_units(&basis);
        let [mut u0, mut u1] = [cursor.real()? * unit_u, cursor.real()? * unit_u];
        let [mut v0, mut v1] = [cursor.real()? * unit_v, cursor.real()? * unit_v];
        if !cursor.flag().unwrap_or(true) {
            (u0, u1) = (u1, u0);
        }
        if !cursor.flag().unwrap_or(true) {
            (v0, v1) = (v1, v0);
        }
        let [periodic_u, periodic_v] = periods(&basis);
        let bounds = [ordered(u0, u1, periodic_u), ordered(v0, v1, periodic_v)].concat();
        match bounds[..] {
            [u0, u1, v0, v1] if u0 < u1 && v0 < v1 => {
                Ok(Surface::Rectangular { basis: Box::new(basis), bounds: [u0, u1, v0, v1] })
            }
            _ => Err(record.fault("a trimmed surface without area")),
        }
    }

    fn parameter_units(&self, surface: &Surface) -> [f64; 2] {
        let (length, angle) = (self.units.length, self.units.angle);
        match surface {
            Surface::Plane(_) => [length, length],
            Surface::Cylinder { .. } | Surface::Cone { .. } => [angle, length],
            Surface::Sphere { .. } | Surface::Torus { .. } => [angle, angle],
            Surface::Nurbs(_) => [1.0, 1.0],
            Surface::Revolution { profile, .. } => [angle, parameter_unit(profile, angle)],
            Surface::Extrusion { profile, .. } => [parameter_unit(profile, angle), 1.0],
            Surface::Offset { basis, .. } | Surface::Rectangular { basis, .. } => self.parameter_units(basis),
        }
    }
}

/// Whether u and v are angles that repeat after a turn.
fn periods(surface: &Surface) -> [bool; 2] {
    let turning = |profile: &Curve| matches!(profile, Curve::Circle { .. } | Curve::Ellipse { .. });
    match surface {
        Surface::Cylinder { .. } | Surface::Cone { .. } | Surface::Sphere { .. } => [true, false],
        Surface::Torus { .. } => [true, true],
        Surface::Revolution { profile, .. } => [true, turning(profile)],
        Surface::Extrusion { profile, .. } => [turning(profile), false],
        Surface::Offset { basis, .. } | Surface::Rectangular { basis, .. } => periods(basis),
        Surface::Plane(_) | Surface::Nurbs(_) => [false, false],
    }
}

/// The bounds with the smaller one first: over the turn for angles, by swapping for others.
fn ordered(a: f64, b: f64, periodic: bool) -> [f64; 2] {
    if periodic {
        let span = (b - a).rem_euclid(std::f64::consts::TAU);
        [a, a + if span < 1e-12 { std::f64::consts::TAU } else { span }]
    } else {
        [a.min(b), a.max(b)]
    }
}
