//! Curves in space and in parameter spaces, as OCCT writes them -> [`Curve`].
//!
//! Parametrisations are those of OCCT. Where ours differs, [`parameter_scale`] says by how much.

use super::text::{Found, Lost, Words};
use crate::brep::nurbs::{MAX_DEGREE, NurbsCurve};
use crate::brep::{Curve, Placement};
use crate::geometry::{Point, Vector};
use crate::stages::parse::sound::{self, Why};

/// How deep curves and surfaces may be made of others.
pub(super) const DEEPEST: u32 = 16;

/// A curve as read, or why it cannot be used.
pub(super) type Made = Result<Curve, Why>;

/// The number of dimensions of what is read: curves in parameter space lie in the plane z = 0.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Space {
    Plane,
    Space,
}

/// Reads one curve; what is wrong with its numbers is found out when all of it is read.
pub(super) fn curve(words: &mut Words, space: Space) -> Found<Made> {
    let curve = nested(words, space, 0)?;
    Ok(sound::curve(&curve).map(|()| curve))
}

pub(super) fn nested(words: &mut Words, space: Space, depth: u32) -> Found<Curve> {
    if depth > DEEPEST {
        return Err(Lost("curves nested too deep".into()));
    }
    Ok(match words.integer()? {
        1 => Curve::Line { origin: point(words, space)?, direction: vector(words, space)?.normalize() },
        2 => Curve::Circle { placement: axes(words, space)?, radius: words.real()? },
        3 => Curve::Ellipse { placement: axes(words, space)?, semi_x: words.real()?, semi_y: words.real()? },
        4 => Curve::Parabola { placement: axes(words, space)?, focal: words.real()? },
        5 => Curve::Hyperbola { placement: axes(words, space)?, semi_x: words.real()?, semi_y: words.real()? },
        6 => Curve::Nurbs(bezier(words, space)?),
        7 => Curve::Nurbs(b_spline(words, space)?),
        8 => trimmed(words, space, depth)?,
        9 => offset(words, space, depth)?,
        other => return Err(Lost(format!("there is no curve of type {other}").into())),
    })
}

/// How many units of our parameter one of OCCT's is: a parabola has its length along y there.
pub(super) fn parameter_scale(curve: &Curve) -> f64 {
    match curve {
        Curve::Parabola { focal, .. } => 0.5 / focal,
        Curve::Trimmed { basis, .. } | Curve::Offset { basis, .. } => parameter_scale(basis),
        _ => 1.0,
    }
}

pub(super) fn point(words: &mut Words, space: Space) -> Found<Point> {
    Ok(Point::from(vector(words, space)?))
}

pub(super) fn vector(words: &mut Words, space: Space) -> Found<Vector> {
    let [x, y] = words.reals()?;
    let z = if space == Space::Space { words.real()? } else { 0.0 };
    Ok(Vector::new(x, y, z))
}

/// The axes of a conic: in space always right-handed, in a plane either way round.
fn axes(words: &mut Words, space: Space) -> Found<Placement> {
    if space == Space::Space {
        return Ok(frame(words)?.0);
    }
    let (origin, x, y) = (point(words, space)?, vector(words, space)?, vector(words, space)?);
    let x = x.normalize();
    let across = Vector::new(-x.y, x.x, 0.0);
    let y = if across.dot(&y) < 0.0 { -across } else { across };
    Ok(Placement { origin, x, y, z: x.cross(&y) })
}

/// Origin, z, x and y, made orthonormal with y right-handed; whether the axes that are written are left-handed.
pub(super) fn frame(words: &mut Words) -> Found<(Placement, bool)> {
    let origin = point(words, Space::Space)?;
    let [z, x, y] = [vector(words, Space::Space)?, vector(words, Space::Space)?, vector(words, Space::Space)?];
    let z = z.normalize();
    let x = (x - z * z.dot(&x)).normalize();
    let right = z.cross(&x);
    Ok((Placement { origin, x, y: right, z }, right.dot(&y) < 0.0))
}

/// Control points with their weights where there are any.
pub(super) fn poles(words: &mut Words, space: Space, count: usize, rational: bool) -> Found<(Vec<Point>, Vec<f64>)> {
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for _ in 0..count {
        points.push(point(words, space)?);
        if rational {
            weights.push(words.real()?);
        }
    }
    Ok((points, weights))
}

fn bezier(words: &mut Words, space: Space) -> Found<NurbsCurve> {
    let (rational, degree) = (words.flag()?, words.count()?);
    let (points, weights) = poles(words, space, degree + 1, rational)?;
    Ok(NurbsCurve { degree, knots: bezier_knots(degree), points, weights, closed: false })
}

/// The knots of one Bezier piece over [0, 1].
pub(super) fn bezier_knots(degree: usize) -> Vec<f64> {
    let ends = |value: f64| std::iter::repeat_n(value, degree + 1);
    ends(0.0).chain(ends(1.0)).collect()
}

fn b_spline(words: &mut Words, space: Space) -> Found<NurbsCurve> {
    let (rational, periodic) = (words.flag()?, words.flag()?);
    let (degree, count, knot_count) = (words.count()?, words.count()?, words.count()?);
    let (mut points, mut weights) = poles(words, space, count, rational)?;
    let knots = Knots::read(words, knot_count, degree, count, periodic)?;
    wrap(&mut points, knots.extra);
    wrap(&mut weights, knots.extra);
    Ok(NurbsCurve { degree, knots: knots.values, points, weights, closed: periodic })
}

/// Repeats the first `extra` entries at the end; does nothing with an empty list.
pub(super) fn wrap<T: Clone>(values: &mut Vec<T>, extra: usize) {
    values.extend_from_within(..extra.min(values.len()));
}

/// Knots written out with their multiplicities.
pub(super) struct Knots {
    pub values: Vec<f64>,
    /// How many control points are repeated at the end, where the spline is periodic.
    pub extra: usize,
}

impl Knots {
    /// Reads `knot_count` knots with multiplicities of a spline with `count` control points. Lists that do not fit
    /// the control points come out empty, so that the spline is refused.
    pub fn read(words: &mut Words, knot_count: usize, degree: usize, count: usize, periodic: bool) -> Found<Self> {
        let mut values = Vec::new();
        let (mut first, mut fits) = (0, degree <= MAX_DEGREE);
        for i in 0..knot_count {
            let (knot, times) = (words.real()?, words.integer()?);
            let times = usize::try_from(times).unwrap_or(0);
            if i == 0 {
                first = times;
            }
            fits &= times > 0 && times <= degree + 1 && values.len() + times <= count + degree + 1;
            if fits {
                values.extend(std::iter::repeat_n(knot, times));
            }
        }
        if periodic && fits && count > 0 && first <= degree && values.len() == count + first {
            return Ok(Self::unrolled(&values, degree + 1 - first, first));
        }
        Ok(Self { values: if fits && !periodic { values } else { Vec::new() }, extra: 0 })
    }

    /// A periodic knot list with `extra` knots of the neighbouring periods on either side; `first` is the
    /// multiplicity of the first and the last knot.
    fn unrolled(values: &[f64], extra: usize, first: usize) -> Self {
        let once = &values[..values.len() - first];
        let Some(period) = values.last().zip(values.first()).map(|(b, a)| b - a) else {
            return Self { values: Vec::new(), extra: 0 };
        };
        let n = once.len();
        let at = |i: usize| once[i % n] + period * (i / n) as f64;
        // Before the first knot lie the last ones of the period before.
        let turns = extra.div_ceil(n);
        let before = (turns * n - extra..turns * n).map(|i| at(i) - period * turns as f64);
        let after = (n + first..n + first + extra).map(at);
        Self { values: before.chain(values.iter().copied()).chain(after).collect(), extra }
    }
}

fn trimmed(words: &mut Words, space: Space, depth: u32) -> Found<Curve> {
    let range: [f64; 2] = words.reals()?;
    let basis = nested(words, space, depth + 1)?;
    let scale = parameter_scale(&basis);
    Ok(Curve::Trimmed { basis: Box::new(basis), range: range.map(|t| t * scale), forward: true })
}

/// OCCT moves the curve along tangent x direction, we along direction x tangent.
fn offset(words: &mut Words, space: Space, depth: u32) -> Found<Curve> {
    let distance = words.real()?;
    let reference = if space == Space::Space { vector(words, space)?.normalize() } else { Vector::z() };
    let basis = Box::new(nested(words, space, depth + 1)?);
    Ok(Curve::Offset { basis, distance: -distance, reference })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Made {
        curve(&mut Words::new(text.as_bytes()), Space::Space).unwrap()
    }

    #[test]
    fn a_periodic_spline_is_written_out() {
        // Four control points, degree 2, knots 0 to 4: the first span goes between the middles of the first sides.
        let curve = read("7 0 1 2 4 5  0 0 0  2 0 0  2 2 0  0 2 0  0 1 1 1 2 1 3 1 4 1").unwrap();
        assert_eq!(curve.domain(), [0.0, 4.0]);
        assert_eq!(curve.point(0.0), Point::new(1.0, 0.0, 0.0));
        assert_eq!(curve.point(1.0), Point::new(2.0, 1.0, 0.0));
        assert_eq!(curve.point(4.0), curve.point(0.0));
        assert_eq!(curve.period(), Some(4.0));
    }

    #[test]
    fn a_trimmed_parabola_has_our_parameters() {
        // Focal length 2: x = t^2 / 8, y = t.
        let curve = read("8 0 4  4 0 0 0  0 0 1  1 0 0  0 1 0  2").unwrap();
        let [a, b] = curve.domain();
        assert_eq!((curve.point(a), curve.point(b)), (Point::origin(), Point::new(2.0, 4.0, 0.0)));
    }

    #[test]
    fn an_offset_goes_to_the_right_of_the_tangent_seen_along_its_direction() {
        // OCCT: tangent x direction = x cross z = -y.
        let curve = read("9 0.5  0 0 1  1 0 0 0 1 0 0").unwrap();
        assert_eq!(curve.point(3.0), Point::new(3.0, -0.5, 0.0));
    }

    #[test]
    fn bad_numbers_cost_one_curve_and_bad_words_all() {
        let why = |text: &str| read(text).unwrap_err();
        assert_eq!(why("2 0 0 0 0 0 1 1 0 0 0 1 0 -4"), "a length that is not positive");
        assert_eq!(why("1 0 0 nan 1 0 0"), "a number that is not finite");
        let knots = "7 0 1 2 4 2  0 0 0  2 0 0  2 2 0  0 2 0  0 9 1 9";
        assert_eq!(why(knots), "knots that do not fit the control points");
        assert_eq!(why("7 0 1 2 0 1  0 1"), "knots that do not fit the control points");
        assert!(curve(&mut Words::new(b"1 0 0 x"), Space::Space).is_err());
        assert!(curve(&mut Words::new("8 0 1 ".repeat(100_000).as_bytes()), Space::Space).is_err());
    }
}
