//! Surfaces as OCCT writes them -> [`Surface`].

use super::curves::{DEEPEST, Knots, Space, bezier_knots, frame, nested, parameter_scale, poles, vector, wrap};
use super::text::{Found, Lost, Words};
use crate::brep::nurbs::NurbsSurface;
use crate::brep::{Curve, Placement, Surface};
use crate::stages::parse::sound::{self, Why};

/// A surface of ours in the place of one of OCCT's.
#[derive(Clone, Debug)]
pub(super) struct Sheet {
    pub surface: Surface,
    /// Our S_u x S_v is against OCCT's: left-handed axes.
    pub turned: bool,
    /// Our parameters for one unit of OCCT's.
    pub scale: [f64; 2],
}

/// A surface as read, or why it cannot be used.
pub(super) type Made = Result<Sheet, Why>;

/// Reads one surface; what is wrong with its numbers is found out when all of it is read.
pub(super) fn surface(words: &mut Words) -> Found<Made> {
    let sheet = nested_surface(words, 0)?;
    Ok(sound::surface(&sheet.surface).map(|()| sheet))
}

fn nested_surface(words: &mut Words, depth: u32) -> Found<Sheet> {
    if depth > DEEPEST {
        return Err(Lost("surfaces nested too deep".into()));
    }
    let plain = |surface: Surface, scale: [f64; 2]| Sheet { surface, turned: false, scale };
    Ok(match words.integer()? {
        kind @ 1..=5 => elementary(words, kind)?,
        6 => {
            let direction = vector(words, Space::Space)?.normalize();
            let profile = Box::new(nested(words, Space::Space, 0)?);
            let scale = [parameter_scale(&profile), 1.0];
            plain(Surface::Extrusion { profile, direction }, scale)
        }
        7 => revolution(words)?,
        8 => plain(Surface::Nurbs(bezier(words)?), [1.0, 1.0]),
        9 => plain(Surface::Nurbs(b_spline(words)?), [1.0, 1.0]),
        10 => rectangular(words, depth)?,
        11 => {
            let distance = words.real()?;
            let basis = nested_surface(words, depth + 1)?;
            let distance = if basis.turned { -distance } else { distance };
            Sheet { surface: Surface::Offset { basis: Box::new(basis.surface), distance }, ..basis }
        }
        other => return Err(Lost(format!("there is no surface of type {other}").into())),
    })
}

/// Plane, cylinder, cone, sphere and torus. Left-handed axes make u run backwards (on planes v).
fn elementary(words: &mut Words, kind: i64) -> Found<Sheet> {
    let (placement, turned) = frame(words)?;
    let back = if turned { -1.0 } else { 1.0 };
    let (surface, scale) = match kind {
        1 => (Surface::Plane(placement), [1.0, back]),
        2 => (Surface::Cylinder { placement, radius: words.real()? }, [back, 1.0]),
        3 => {
            let (radius, half_angle) = (words.real()?, words.real()?);
            // OCCT measures v along the slant.
            (Surface::Cone { placement, radius, half_angle }, [back, half_angle.cos()])
        }
        4 => (Surface::Sphere { placement, radius: words.real()? }, [back, 1.0]),
        _ => (Surface::Torus { placement, major: words.real()?, minor: words.real()? }, [back, 1.0]),
    };
    Ok(Sheet { surface, turned, scale })
}

fn revolution(words: &mut Words) -> Found<Sheet> {
    let origin = vector(words, Space::Space)?.into();
    let z = vector(words, Space::Space)?.normalize();
    let profile: Box<Curve> = Box::new(nested(words, Space::Space, 0)?);
    let x = crate::geometry::any_perpendicular(&z);
    let scale = [1.0, parameter_scale(&profile)];
    let axis = Placement { origin, x, y: z.cross(&x), z };
    Ok(Sheet { surface: Surface::Revolution { profile, axis }, turned: false, scale })
}

fn bezier(words: &mut Words) -> Found<NurbsSurface> {
    let rational = words.flag()? | words.flag()?;
    let (degree_u, degree_v) = (words.count()?, words.count()?);
    let count = (degree_u + 1).saturating_mul(degree_v + 1);
    let (points, weights) = poles(words, Space::Space, count, rational)?;
    let (knots_u, knots_v) = (bezier_knots(degree_u), bezier_knots(degree_v));
    Ok(NurbsSurface { degree_u, degree_v, knots_u, knots_v, columns: degree_v + 1, points, weights })
}

fn b_spline(words: &mut Words) -> Found<NurbsSurface> {
    let rational = words.flag()? | words.flag()?;
    let (periodic_u, periodic_v) = (words.flag()?, words.flag()?);
    let (degree_u, degree_v) = (words.count()?, words.count()?);
    let (rows, columns) = (words.count()?, words.count()?);
    let (knots_u, knots_v) = (words.count()?, words.count()?);
    let (points, weights) = poles(words, Space::Space, rows.saturating_mul(columns), rational)?;
    let u = Knots::read(words, knots_u, degree_u, rows, periodic_u)?;
    let v = Knots::read(words, knots_v, degree_v, columns, periodic_v)?;
    let points = wrapped(points, columns, u.extra, v.extra);
    let weights = wrapped(weights, columns, u.extra, v.extra);
    let columns = columns + v.extra;
    Ok(NurbsSurface { degree_u, degree_v, knots_u: u.values, knots_v: v.values, columns, points, weights })
}

/// A net of `columns` a row with its first rows and columns repeated at the end.
fn wrapped<T: Clone>(net: Vec<T>, columns: usize, extra_rows: usize, extra_columns: usize) -> Vec<T> {
    if net.is_empty() || (extra_rows == 0 && extra_columns == 0) {
        return net;
    }
    let mut wide: Vec<T> = Vec::new();
    for row in net.chunks(columns) {
        wide.extend_from_slice(row);
        wide.extend_from_slice(&row[..extra_columns.min(row.len())]);
    }
    wrap(&mut wide, extra_rows * (columns + extra_columns));
    wide
}

fn rectangular(words: &mut Words, depth: u32) -> Found<Sheet> {
    let [u0, u1, v0, v1] = words.reals()?;
    let basis = nested_surface(words, depth + 1)?;
    let ordered = |a: f64, b: f64| [a.min(b), a.max(b)];
    let [[u0, u1], [v0, v1]] =
        [ordered(u0 * basis.scale[0], u1 * basis.scale[0]), ordered(v0 * basis.scale[1], v1 * basis.scale[1])];
    let surface = Surface::Rectangular { basis: Box::new(basis.surface), bounds: [u0, u1, v0, v1] };
    Ok(Sheet { surface, ..basis })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;

    fn read(text: &str) -> Sheet {
        surface(&mut Words::new(text.as_bytes())).unwrap().unwrap()
    }

    #[test]
    fn left_handed_axes_are_the_same_surface_with_the_other_normal() {
        // OCCT: O + 2 (cos u x + sin u y) + v z with y = -z cross x.
        let sheet = read("2  0 0 0  0 0 1  1 0 0  0 -1 0  2");
        let [u, v] = [0.5 * sheet.scale[0], 3.0 * sheet.scale[1]];
        let there = Point::new(2.0 * 0.5_f64.cos(), -2.0 * 0.5_f64.sin(), 3.0);
        assert!((sheet.surface.point(u, v) - there).norm() < 1e-12);
        assert!(sheet.turned);
    }

    #[test]
    fn a_cone_has_its_parameter_along_the_slant() {
        let sheet = read("3  0 0 0  0 0 1  1 0 0  0 1 0  2  0.5");
        let p = sheet.surface.point(0.0, 4.0 * sheet.scale[1]);
        assert!((p - Point::new(2.0 + 4.0 * 0.5_f64.sin(), 0.0, 4.0 * 0.5_f64.cos())).norm() < 1e-12);
    }

    #[test]
    fn a_rectangle_of_a_left_handed_plane_lies_on_the_other_side() {
        let sheet = read("10 1 2 3 4  1  0 0 0  0 0 1  1 0 0  0 -1 0");
        assert_eq!(sheet.surface.domain(), [1.0, 2.0, -4.0, -3.0]);
    }

    #[test]
    fn a_surface_periodic_in_v_closes() {
        // Two rows of three, degree 1 in both directions; v runs round the triangle.
        let net = "0 0 0  1 0 0  0 1 0   0 0 5  1 0 5  0 1 5";
        let sheet = read(&format!("9 0 0 0 1 1 1 2 3 2 4  {net}  0 2 1 2   0 1 1 1 2 1 3 1"));
        assert_eq!(sheet.surface.domain(), [0.0, 1.0, 0.0, 3.0]);
        assert_eq!(sheet.surface.point(0.0, 1.0), Point::new(1.0, 0.0, 0.0));
        assert_eq!(sheet.surface.point(1.0, 3.0), Point::new(0.0, 0.0, 5.0));
        assert_eq!(sheet.surface.periods(), [None, Some(3.0)]);
    }
}
