//! Non-uniform rational B-splines.

use crate::geometry::Point;

/// A B-spline curve; knots are written out with their multiplicities (control points + degree + 1 of them).
#[derive(Clone, Debug)]
pub struct NurbsCurve {
    pub degree: usize,
    pub knots: Vec<f64>,
    pub points: Vec<Point>,
    /// Empty: all weights are 1.
    pub weights: Vec<f64>,
    /// Whether the file calls the curve closed; a hint only.
    pub closed: bool,
}

/// A B-spline surface; control point (i, j) is at `points[i * columns + j]`, i along u, j along v.
#[derive(Clone, Debug)]
pub struct NurbsSurface {
    pub degree_u: usize,
    pub degree_v: usize,
    pub knots_u: Vec<f64>,
    pub knots_v: Vec<f64>,
    /// Number of control points along v.
    pub columns: usize,
    pub points: Vec<Point>,
    /// Empty: all weights are 1.
    pub weights: Vec<f64>,
}
