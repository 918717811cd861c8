//! B-spline curves and surfaces in all their encodings -> NURBS with written-out knots.

use super::cursor::Cursor;
use super::keyword::Kind;
use super::placement::Geometry;
use super::records::Record;
use crate::brep::nurbs::{NurbsCurve, NurbsSurface};
use crate::geometry::Point;
use crate::stages::parse::fault::Read;

/// The highest degree: that of OpenCASCADE, and far above any in use.
const HIGHEST_DEGREE: usize = 25;
/// The most control points of one curve or surface.
const MOST_POINTS: usize = 4_000_000;

const CURVE: &[Kind] =
    &[Kind::RepresentationItem, Kind::BSplineCurve, Kind::BSplineCurveWithKnots, Kind::RationalBSplineCurve];
const SURFACE: &[Kind] =
    &[Kind::RepresentationItem, Kind::BSplineSurface, Kind::BSplineSurfaceWithKnots, Kind::RationalBSplineSurface];

/// How a curve without a knot list has its knots.
#[derive(Clone, Copy)]
enum Spacing {
    Uniform,
    QuasiUniform,
    Bezier,
}

impl Spacing {
    fn of(record: &Record) -> Self {
        if record.is(Kind::UniformCurve) || record.is(Kind::UniformSurface) {
            Self::Uniform
        } else if record.is(Kind::BezierCurve) || record.is(Kind::BezierSurface) {
            Self::Bezier
        } else {
            Self::QuasiUniform
        }
    }

    /// The knots of `count` control points (ISO 10303-42, 4.4.41 to 4.4.43).
    fn knots(self, record: &Record, degree: usize, count: usize) -> Read<Vec<f64>> {
        let total = count + degree + 1;
        Ok(match self {
            Self::Uniform => (0..total).map(|i| i as f64 - degree as f64).collect(),
            Self::QuasiUniform => (0..total).map(|i| i.clamp(degree, count) as f64 - degree as f64).collect(),
            Self::Bezier if (count - 1).is_multiple_of(degree) => {
                let last = (count - 1) / degree;
                (0..total).map(|i| (i.saturating_sub(1) / degree).min(last) as f64).collect()
            }
            Self::Bezier => return Err(record.fault("a Bezier form with a wrong number of control points")),
        })
    }
}

/// Any B-spline curve.
pub(super) fn curve(geometry: &Geometry, record: &Record) -> Read<NurbsCurve> {
    let mut cursor = record.fields(CURVE);
    cursor.skip();
    let degree = degree_of(record, &mut cursor)?;
    let ids = cursor.references()?;
    check_count(record, degree, ids.len())?;
    geometry.spend(record.id, ids.len())?;
    let points = ids.into_iter().map(|id| geometry.point(id)).collect::<Read<Vec<_>>>()?;
    let closed = cursor.skip_many(1).flag().unwrap_or(false);
    cursor.skip();
    let knots = if record.is(Kind::BSplineCurveWithKnots) {
        let (counts, values) = (cursor.reals()?, cursor.reals()?);
        cursor.skip();
        written_out(record, &counts, &values, degree, points.len())?
    } else {
        Spacing::of(record).knots(record, degree, points.len())?
    };
    let weights = if record.is(Kind::RationalBSplineCurve) { cursor.reals()? } else { Vec::new() };
    check_weights(record, &weights, points.len())?;
    Ok(NurbsCurve { degree, knots, points, weights, closed })
}

/// Any B-spline surface.
pub(super) fn surface(geometry: &Geometry, record: &Record) -> Read<NurbsSurface> {
    let mut cursor = record.fields(SURFACE);
    cursor.skip();
    let (degree_u, degree_v) = (degree_of(record, &mut cursor)?, degree_of(record, &mut cursor)?);
    let (points, columns) = net(geometry, record, &mut cursor)?;
    geometry.spend(record.id, points.len())?;
    let rows = points.len() / columns;
    check_count(record, degree_u, rows)?;
    check_count(record, degree_v, columns)?;
    cursor.skip_many(4);
    let (knots_u, knots_v) = if record.is(Kind::BSplineSurfaceWithKnots) {
        let (counts_u, counts_v) = (cursor.reals()?, cursor.reals()?);
        let (values_u, values_v) = (cursor.reals()?, cursor.reals()?);
        cursor.skip();
        (
            written_out(record, &counts_u, &values_u, degree_u, rows)?,
            written_out(record, &counts_v, &values_v, degree_v, columns)?,
        )
    } else {
        let spacing = Spacing::of(record);
        (spacing.knots(record, degree_u, rows)?, spacing.knots(record, degree_v, columns)?)
    };
    let weights = if record.is(Kind::RationalBSplineSurface) { grid(&mut cursor)? } else { Vec::new() };
    check_weights(record, &weights, points.len())?;
    Ok(NurbsSurface { degree_u, degree_v, knots_u, knots_v, columns, points, weights })
}

fn degree_of(record: &Record, cursor: &mut Cursor) -> Read<usize> {
    match cursor.count(HIGHEST_DEGREE)? {
        0 => Err(record.fault("a B-spline of degree 0")),
        degree => Ok(degree),
    }
}

/// The control points row by row, and how many are in a row.
fn net(geometry: &Geometry, record: &Record, cursor: &mut Cursor) -> Read<(Vec<Point>, usize)> {
    let (mut points, mut columns) = (Vec::new(), None);
    cursor.list(|rows| {
        let before = points.len();
        rows.list(|row| {
            points.push(geometry.point(row.reference()?)?);
            Ok(())
        })?;
        let length = points.len() - before;
        if length == 0 || length != *columns.get_or_insert(length) {
            return Err(record.fault("rows of control points of unequal length"));
        }
        Ok(())
    })?;
    let columns = columns.ok_or_else(|| record.fault("no control points"))?;
    Ok((points, columns))
}

/// Numbers of a list of lists in one row.
fn grid(cursor: &mut Cursor) -> Read<Vec<f64>> {
    let mut values = Vec::new();
    cursor.list(|rows| {
        values.append(&mut rows.reals()?);
        Ok(())
    })?;
    Ok(values)
}

fn check_count(record: &Record, degree: usize, count: usize) -> Read<()> {
    if count <= degree || count > MOST_POINTS {
        return Err(record.fault(format!("{count} control points for degree {degree}")));
    }
    Ok(())
}

fn check_weights(record: &Record, weights: &[f64], count: usize) -> Read<()> {
    if !weights.is_empty() && weights.len() != count {
        return Err(record.fault("not as many weights as control points"));
    }
    if weights.iter().any(|w| *w <= 0.0) {
        return Err(record.fault("a weight that is not positive"));
    }
    Ok(())
}

/// Knots repeated by their multiplicities.
fn written_out(record: &Record, counts: &[f64], values: &[f64], degree: usize, points: usize) -> Read<Vec<f64>> {
    let total = points + degree + 1;
    let whole = counts.iter().all(|m| m.fract() == 0.0 && (1.0..=total as f64).contains(m));
    if counts.len() != values.len() || !whole || counts.iter().sum::<f64>() != total as f64 {
        return Err(record.fault("knots that do not fit the control points"));
    }
    if !values.is_sorted() || values.first() == values.last() {
        return Err(record.fault("knots that do not grow"));
    }
    let mut knots = Vec::with_capacity(total);
    counts.iter().zip(values).for_each(|(&count, &value)| knots.extend(std::iter::repeat_n(value, count as usize)));
    if knots[degree] >= knots[points] {
        return Err(record.fault("a B-spline without a parameter range"));
    }
    Ok(knots)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cancel::Cancel;
    use crate::stages::parse::fault::Fault;
    use crate::stages::parse::step::lexer::scan;
    use crate::stages::parse::step::records::File;
    use crate::stages::parse::step::units::Units;

    fn read(spline: &str) -> Result<NurbsCurve, Fault> {
        let text = format!(
            "#1=CARTESIAN_POINT('',(0,0.,0.));#2=CARTESIAN_POINT('',(1.,2.,0.));#3=CARTESIAN_POINT('',(3.,0.,0.));#9={spline};"
        );
        let table = scan(text.as_bytes(), &Cancel::new()).unwrap();
        let file = File { bytes: text.as_bytes(), table: &table };
        let record = file.record(9)?;
        curve(&Geometry::new(file, Units::default()), &record)
    }

    #[test]
    fn knots_of_every_spacing_are_written_out() {
        let knots = |text: &str| read(text).unwrap().knots;
        let body = "('',2,(#1,#2,#3),.UNSPECIFIED.,.F.,.F.)";
        assert_eq!(knots(&format!("BEZIER_CURVE{body}")), [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
        assert_eq!(knots(&format!("QUASI_UNIFORM_CURVE{body}")), [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
        assert_eq!(knots(&format!("UNIFORM_CURVE{body}")), [-2.0, -1.0, 0.0, 1.0, 2.0, 3.0]);
        let linear = "('',1,(#1,#2,#3),.UNSPECIFIED.,.F.,.F.,(2,1,2),(0.,3.,5.),.UNSPECIFIED.)";
        assert_eq!(knots(&format!("B_SPLINE_CURVE_WITH_KNOTS{linear}")), [0.0, 0.0, 3.0, 5.0, 5.0]);
    }

    #[test]
    fn rational_curves_in_complex_form() {
        let curve = read(
            "(BOUNDED_CURVE()B_SPLINE_CURVE(2,(#1,#2,#3),.UNSPECIFIED.,.F.,.F.)B_SPLINE_CURVE_WITH_KNOTS((3,3),(0.,1.),\
             .UNSPECIFIED.)CURVE()GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE((1.,0.5,1.))REPRESENTATION_ITEM(''))",
        );
        assert_eq!(curve.unwrap().weights, [1.0, 0.5, 1.0]);
    }

    #[test]
    fn bad_knots_degrees_and_weights_are_refused() {
        let why = |text: &str| read(text).unwrap_err().why.into_owned();
        let knots = "B_SPLINE_CURVE_WITH_KNOTS('',1,(#1,#2,#3),.U.,.F.,.F.,(2,1,999999999),(0.,3.,5.),.U.)";
        assert_eq!(why(knots), "knots that do not fit the control points");
        assert_eq!(why("BEZIER_CURVE('',5,(#1,#2,#3),.U.,.F.,.F.)"), "3 control points for degree 5");
        assert!(why("BEZIER_CURVE('',1000000,(#1,#2,#3),.U.,.F.,.F.)").contains("limits"));
    }
}
