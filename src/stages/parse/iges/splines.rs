//! B-spline and parametric spline entities -> NURBS with written-out knots.

use super::file::{Fields, File, Record};
use crate::brep::Curve;
use crate::brep::nurbs::{MAX_DEGREE, NurbsCurve, NurbsSurface};
use crate::geometry::{Point, Vector};
use crate::stages::parse::fault::Read;

/// RATIONAL B-SPLINE CURVE (126).
pub(super) fn rational_curve(file: &File, record: &Record, unit: f64) -> Read<(Curve, [f64; 2])> {
    let mut fields = record.fields();
    let (count, degree) = (fields.count()? + 1, degree(record, &mut fields)?);
    let closed = fields.skip(1).flag()?;
    let polynomial = fields.flag()?;
    let knots = fields.skip(1).many(count + degree + 1)?;
    let weights = weights(fields.many(count)?, polynomial);
    let points = points(&mut fields, count, unit)?;
    let range: [f64; 2] = fields.reals()?;
    file.spend(record.entity, count)?;
    let curve = NurbsCurve { degree, knots, points, weights, closed };
    let range = inside(range, curve.knots[degree], curve.knots[count]);
    Ok((Curve::Nurbs(curve), range))
}

fn degree(record: &Record, fields: &mut Fields) -> Read<usize> {
    let degree = fields.integer()?;
    let found = usize::try_from(degree).ok().filter(|d| (1..=MAX_DEGREE).contains(d));
    found.ok_or_else(|| record.fault(format!("a B-spline of degree {degree}")))
}

/// Weights that are all the same count for nothing.
fn weights(weights: Vec<f64>, polynomial: bool) -> Vec<f64> {
    let first = weights[0];
    let same = weights.iter().all(|w| (w - first).abs() <= 1e-12 * first.abs());
    if same && (polynomial || first > 0.0) { Vec::new() } else { weights }
}

fn points(fields: &mut Fields, count: usize, unit: f64) -> Read<Vec<Point>> {
    (0..count).map(|_| Ok(Point::from(fields.reals::<3>()?) * unit)).collect()
}

/// A range held inside the domain; the domain where nothing is left.
fn inside([a, b]: [f64; 2], from: f64, to: f64) -> [f64; 2] {
    let near = 1e-9 * (to - from);
    let hold = |t: f64| {
        if t <= from + near {
            from
        } else if t >= to - near {
            to
        } else {
            t
        }
    };
    let range = [hold(a), hold(b)];
    if range[0] < range[1] { range } else { [from, to] }
}

/// RATIONAL B-SPLINE SURFACE (128) and the rectangle of its parameters that counts.
pub(super) fn rational_surface(file: &File, record: &Record) -> Read<(NurbsSurface, [f64; 4])> {
    let mut fields = record.fields();
    let (rows, columns) = (fields.count()? + 1, fields.count()? + 1);
    let (degree_u, degree_v) = (degree(record, &mut fields)?, degree(record, &mut fields)?);
    let polynomial = fields.skip(2).flag()?;
    fields.skip(2);
    let knots_u = fields.many(rows + degree_u + 1)?;
    let knots_v = fields.many(columns + degree_v + 1)?;
    let count = rows.saturating_mul(columns);
    let weights = weights(fields.many(count)?, polynomial);
    let points = points(&mut fields, count, file.global.unit_mm)?;
    let [u0, u1, v0, v1] = fields.reals()?;
    file.spend(record.entity, count)?;
    // The file runs along u first.
    let points = transposed(&points, rows, columns);
    let weights = transposed(&weights, rows, columns);
    let [u0, u1] = inside([u0, u1], knots_u[degree_u], knots_u[rows]);
    let [v0, v1] = inside([v0, v1], knots_v[degree_v], knots_v[columns]);
    Ok((NurbsSurface { degree_u, degree_v, knots_u, knots_v, columns, points, weights }, [u0, u1, v0, v1]))
}

fn transposed<T: Copy>(net: &[T], rows: usize, columns: usize) -> Vec<T> {
    if net.is_empty() {
        return Vec::new();
    }
    (0..rows).flat_map(|i| (0..columns).map(move |j| net[j * rows + i])).collect()
}

/// PARAMETRIC SPLINE CURVE (112): cubics over pieces, each from its own break point.
pub(super) fn parametric_curve(record: &Record, unit: f64) -> Read<(Curve, [f64; 2])> {
    let mut fields = record.fields();
    let count = fields.skip(3).count()?;
    let breaks = fields.many(count + 1)?;
    let mut points = Vec::new();
    for pair in breaks.windows(2) {
        let [x, y, z]: [[f64; 4]; 3] = [fields.reals()?, fields.reals()?, fields.reals()?];
        let width = pair[1] - pair[0];
        let coefficients: [Vector; 4] = [0, 1, 2, 3].map(|i| Vector::new(x[i], y[i], z[i]) * unit);
        let piece = bezier(coefficients, width);
        let skip = usize::from(!points.is_empty());
        points.extend(piece.into_iter().skip(skip).map(Point::from));
    }
    if breaks.len() < 2 {
        return Err(record.fault("a spline without pieces"));
    }
    let range = [breaks[0], breaks[count]];
    let knots = cubic_knots(&breaks);
    Ok((Curve::Nurbs(NurbsCurve { degree: 3, knots, points, weights: Vec::new(), closed: false }), range))
}

/// The control points of the cubic with these coefficients over [0, width].
fn bezier([a, b, c, d]: [Vector; 4], width: f64) -> [Vector; 4] {
    let (b, c, d) = (b * width, c * (width * width), d * (width * width * width));
    [a, a + b / 3.0, a + b * (2.0 / 3.0) + c / 3.0, a + b + c + d]
}

/// Ends fourfold, inner breaks threefold.
fn cubic_knots(breaks: &[f64]) -> Vec<f64> {
    let last = breaks.len() - 1;
    let times = |i: usize| if i == 0 || i == last { 4 } else { 3 };
    breaks.iter().enumerate().flat_map(|(i, t)| std::iter::repeat_n(*t, times(i))).collect()
}

/// PARAMETRIC SPLINE SURFACE (114): bicubics over patches.
pub(super) fn parametric_surface(file: &File, record: &Record) -> Read<NurbsSurface> {
    let mut fields = record.fields();
    let (patches_u, patches_v) = (fields.skip(2).count()?, fields.count()?);
    let (breaks_u, breaks_v) = (fields.many(patches_u + 1)?, fields.many(patches_v + 1)?);
    if patches_u == 0 || patches_v == 0 {
        return Err(record.fault("a spline without pieces"));
    }
    let columns = 3 * patches_v + 1;
    let count = (3 * patches_u + 1).saturating_mul(columns);
    file.spend(record.entity, count)?;
    let mut points = vec![Point::origin(); count];
    for i in 0..patches_u {
        for j in 0..patches_v {
            let widths = [breaks_u[i + 1] - breaks_u[i], breaks_v[j + 1] - breaks_v[j]];
            for (k, point) in patch(&mut fields, widths, file.global.unit_mm)?.into_iter().enumerate() {
                points[(3 * i + k / 4) * columns + 3 * j + k % 4] = point.into();
            }
        }
        // One more patch than there is in each row.
        fields.skip(48);
    }
    let (knots_u, knots_v) = (cubic_knots(&breaks_u), cubic_knots(&breaks_v));
    Ok(NurbsSurface { degree_u: 3, degree_v: 3, knots_u, knots_v, columns, points, weights: Vec::new() })
}

/// The 16 control points of a patch, v running fastest; coefficients come with the powers of u running fastest.
fn patch(fields: &mut Fields, [width_u, width_v]: [f64; 2], unit: f64) -> Read<[Vector; 16]> {
    let [x, y, z]: [[f64; 16]; 3] = [fields.reals()?, fields.reals()?, fields.reals()?];
    let along_u: [[Vector; 4]; 4] = [0, 1, 2, 3].map(|power_v| {
        bezier(
            [0, 1, 2, 3].map(|i| Vector::new(x[4 * power_v + i], y[4 * power_v + i], z[4 * power_v + i]) * unit),
            width_u,
        )
    });
    let rows = [0, 1, 2, 3].map(|row: usize| bezier([0, 1, 2, 3].map(|power: usize| along_u[power][row]), width_v));
    Ok(std::array::from_fn(|k| rows[k / 4][k % 4]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_has_its_bezier_points() {
        // x = t^3 over [0, 2].
        let zero = Vector::zeros();
        let points = bezier([zero, zero, zero, Vector::x()], 2.0).map(|p| p.x);
        assert_eq!(points, [0.0, 0.0, 0.0, 8.0]);
        // x = 1 + t.
        let points = bezier([Vector::x(), Vector::x(), zero, zero], 3.0).map(|p| p.x);
        assert_eq!(points, [1.0, 2.0, 3.0, 4.0]);
    }

    #[test]
    fn nets_are_turned_over() {
        assert_eq!(transposed(&[1, 2, 3, 4, 5, 6], 3, 2), [1, 4, 2, 5, 3, 6]);
    }
}
