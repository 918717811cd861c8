//! Non-uniform rational B-splines: evaluation with derivatives, without allocation.
//!
//! Method: the recurrence of de Boor and Cox for the basis functions; derivatives from the basis functions one and
//! two degrees lower; the quotient rule for rational ones (Piegl and Tiller, The NURBS Book, chapters 2 to 4).

use std::ops::RangeInclusive;

use super::surface::Jet;
use crate::geometry::{Point, Vector};

/// The highest degree that can be evaluated; readers refuse higher ones.
pub const MAX_DEGREE: usize = 25;

/// A B-spline curve; knots are written out with their multiplicities (control points + degree + 1 of them).
#[derive(Clone, Debug)]
pub struct NurbsCurve {
    /// Degree of the polynomials.
    pub degree: usize,
    /// Knots with their multiplicities, growing: points + degree + 1 of them.
    pub knots: Vec<f64>,
    /// Control points, mm.
    pub points: Vec<Point>,
    /// Empty: all weights are 1.
    pub weights: Vec<f64>,
    /// Whether the file calls the curve closed; a hint only.
    pub closed: bool,
}

/// A B-spline surface; control point (i, j) is at `points[i * columns + j]`, i along u, j along v.
#[derive(Clone, Debug)]
pub struct NurbsSurface {
    /// Degree in u.
    pub degree_u: usize,
    /// Degree in v.
    pub degree_v: usize,
    /// Knots in u with their multiplicities.
    pub knots_u: Vec<f64>,
    /// Knots in v with their multiplicities.
    pub knots_v: Vec<f64>,
    /// Number of control points along v.
    pub columns: usize,
    /// Control points, mm.
    pub points: Vec<Point>,
    /// Empty: all weights are 1.
    pub weights: Vec<f64>,
}

/// The basis functions that do not vanish at a parameter, with two derivatives, for degrees below `N`: most splines
/// are cubic, and clearing tables for the highest degree would cost more than filling them for theirs.
struct Basis<const N: usize> {
    /// Index of the first control point they belong to.
    first: usize,
    /// `values[d][j]`: d-th derivative of the j-th of them.
    values: [[f64; N]; 3],
}

/// Calls a method for up to the `order`-th derivatives with the smallest table that holds this degree.
macro_rules! for_degree {
    ($degree:expr, $order:tt, $self:ident.$method:ident($($argument:expr),*)) => {
        match $degree {
            0..=3 => $self.$method::<4, $order>($($argument),*),
            4..=7 => $self.$method::<8, $order>($($argument),*),
            _ => $self.$method::<{ MAX_DEGREE + 1 }, $order>($($argument),*),
        }
    };
}

impl<const N: usize> Basis<N> {
    /// For any place.
    const NOWHERE: Self = Self { first: 0, values: [[0.0; N]; 3] };

    /// Moves them to `t`, clamped to the domain, with derivatives up to `ORDER`. Needs `degree < N` and
    /// `count + degree + 1` knots. In place: a table is too large to be handed on for each point.
    fn go_to<const ORDER: usize>(&mut self, knots: &[f64], degree: usize, count: usize, t: f64) {
        let t = t.clamp(knots[degree], knots[count].max(knots[degree]));
        let inner = &knots[degree + 1..count];
        let span = degree + inner.partition_point(|&k| k <= t);
        let span = last_filled_span(knots, degree, span);
        let support = &knots[span + 1 - degree..=span + degree];
        self.first = span - degree;
        // For the degrees of most splines the compiler writes the loops out.
        match degree {
            1 => self.fill::<ORDER>(support, 1, t),
            2 => self.fill::<ORDER>(support, 2, t),
            3 => self.fill::<ORDER>(support, 3, t),
            _ => self.fill::<ORDER>(support, degree, t),
        }
    }

    /// From the knots at which functions begin or end, as many on either side of `t` as the degree.
    #[inline(always)]
    fn fill<const ORDER: usize>(&mut self, support: &[f64], degree: usize, t: f64) {
        let [values, first, second] = &mut self.values;
        values[0] = 1.0;
        for q in 1..=degree {
            let supports = (&support[degree - q..degree], &support[degree..degree + q]);
            if q == degree && ORDER > 1 {
                differentiate(supports, first, second);
            }
            if q + ORDER > degree && ORDER > 0 {
                differentiate(supports, values, first);
            }
            raise(supports, t, values);
        }
    }
}

/// Goes back from an empty knot span (the end of the domain) to one that has a length.
fn last_filled_span(knots: &[f64], degree: usize, mut span: usize) -> usize {
    while span > degree && knots[span] >= knots[span + 1] {
        span -= 1;
    }
    span
}

/// Where each of the functions of degree q - 1 begins, and where it ends: q of each.
type Supports<'a> = (&'a [f64], &'a [f64]);

/// Basis functions of degree q - 1 -> degree q, in place.
#[inline(always)]
fn raise<const N: usize>((begins, ends): Supports, t: f64, n: &mut [f64; N]) {
    let mut saved = 0.0;
    for ((n, low), high) in n.iter_mut().zip(begins).zip(ends) {
        let share = if high > low { *n / (high - low) } else { 0.0 };
        (*n, saved) = (saved + (high - t) * share, (t - low) * share);
    }
    n[begins.len()] = saved;
}

/// Functions (or their derivatives) of degree q - 1 -> derivatives of those of degree q.
#[inline(always)]
fn differentiate<const N: usize>((begins, ends): Supports, n: &[f64; N], out: &mut [f64; N]) {
    let (q, mut saved) = (begins.len(), 0.0);
    for (((out, n), low), high) in out.iter_mut().zip(n).zip(begins).zip(ends) {
        let share = if high > low { q as f64 * n / (high - low) } else { 0.0 };
        (*out, saved) = (saved - share, share);
    }
    out[q] = saved;
}

/// A weighted point: the vector times its weight, and the weight.
#[derive(Clone, Copy)]
struct Weighted(Vector, f64);

impl Weighted {
    const ZERO: Self = Self(Vector::new(0.0, 0.0, 0.0), 0.0);

    fn add(&mut self, factor: f64, other: &Self) {
        self.0 += other.0 * factor;
        self.1 += other.1 * factor;
    }
}

impl<const N: usize> Basis<N> {
    /// The sums of the control points at these places, value and derivatives up to `ORDER`; without weights all are 1.
    #[inline(always)]
    fn sums<const ORDER: usize>(
        &self,
        points: &[Point],
        weights: &[f64],
        places: RangeInclusive<usize>,
    ) -> [Weighted; 3] {
        let mut sums = [Weighted::ZERO; 3];
        let mut add = |j: usize, weighted: Weighted| {
            for (sum, values) in sums.iter_mut().zip(&self.values).take(ORDER + 1) {
                sum.add(values[j], &weighted);
            }
        };
        let points = points[places.clone()].iter().enumerate();
        match weights.get(places) {
            Some(weights) => points.zip(weights).for_each(|((j, p), w)| add(j, Weighted(p.coords * *w, *w))),
            None => points.for_each(|(j, p)| add(j, Weighted(p.coords, 1.0))),
        }
        sums
    }
}

/// Quotient rule: the point and two derivatives in one direction.
fn divide(a: &Weighted, d: &Weighted, dd: &Weighted) -> [Vector; 3] {
    let w = 1.0 / a.1;
    let p = a.0 * w;
    let first = (d.0 - p * d.1) * w;
    let second = (dd.0 - first * (2.0 * d.1) - p * dd.1) * w;
    [p, first, second]
}

impl NurbsCurve {
    /// The parameter interval.
    pub fn domain(&self) -> [f64; 2] {
        [self.knots[self.degree], self.knots[self.points.len()]]
    }

    /// Point, first and second derivative; `t` outside the domain is clamped.
    pub fn derivatives(&self, t: f64) -> [Vector; 3] {
        for_degree!(self.degree, 2, self.derivatives_below(t))
    }

    /// The point alone, as [`Self::derivatives`] has it.
    pub fn point(&self, t: f64) -> Point {
        let [p, _, _] = for_degree!(self.degree, 0, self.derivatives_below(t));
        Point::from(p)
    }

    /// Whether the ends of the domain are too far apart, beside the control points, to be one point.
    pub(super) fn is_plainly_open(&self) -> bool {
        let [p, q] = self.domain().map(|t| self.point(t));
        let reach = self.points.iter().map(|c| (c - p).norm_squared()).fold(0.0, f64::max);
        (q - p).norm_squared() > 1e-9 * reach
    }

    /// For degrees below `N`.
    fn derivatives_below<const N: usize, const ORDER: usize>(&self, t: f64) -> [Vector; 3] {
        let mut basis = Basis::<N>::NOWHERE;
        basis.go_to::<ORDER>(&self.knots, self.degree, self.points.len(), t);
        let sums = basis.sums::<ORDER>(&self.points, &self.weights, basis.first..=basis.first + self.degree);
        divide(&sums[0], &sums[1], &sums[2])
    }

    /// The control points of one piece between breaks after the other: it lies in their hull, as weights are positive.
    pub(super) fn pieces(&self) -> impl Iterator<Item = &[Point]> {
        let filled = (self.degree..self.points.len()).filter(|&i| self.knots[i + 1] > self.knots[i]);
        filled.map(|i| &self.points[i - self.degree..=i])
    }

    /// The knots inside the domain, ends included, each once.
    pub fn breaks(&self) -> impl Iterator<Item = f64> + '_ {
        distinct(&self.knots[self.degree..=self.points.len()])
    }
}

impl NurbsSurface {
    /// Number of control points along u.
    pub fn rows(&self) -> usize {
        self.points.len() / self.columns.max(1)
    }

    /// The parameter rectangle [u0, u1, v0, v1].
    pub fn domain(&self) -> [f64; 4] {
        let (rows, columns) = (self.rows(), self.columns);
        [self.knots_u[self.degree_u], self.knots_u[rows], self.knots_v[self.degree_v], self.knots_v[columns]]
    }

    /// Point and derivatives up to second order; parameters outside the domain are clamped.
    pub fn jet(&self, u: f64, v: f64) -> Jet {
        self.jet_to::<2>(u, v)
    }

    /// As [`Self::jet`] with derivatives up to `ORDER`; the others stay zero.
    pub(super) fn jet_to<const ORDER: usize>(&self, u: f64, v: f64) -> Jet {
        for_degree!(self.degree_u.max(self.degree_v), ORDER, self.jet_below(u, v))
    }

    /// For degrees below `N`.
    fn jet_below<const N: usize, const ORDER: usize>(&self, u: f64, v: f64) -> Jet {
        let [mut bu, mut bv] = [Basis::<N>::NOWHERE; 2];
        bu.go_to::<ORDER>(&self.knots_u, self.degree_u, self.rows(), u);
        bv.go_to::<ORDER>(&self.knots_v, self.degree_v, self.columns, v);
        // a: value, u, uu, v, uv, vv
        let mut a = [Weighted::ZERO; 6];
        for i in 0..=self.degree_u {
            let row = self.row_sums::<N, ORDER>(&bv, bu.first + i);
            let [n, d, dd] = [bu.values[0][i], bu.values[1][i], bu.values[2][i]];
            a[0].add(n, &row[0]);
            if ORDER > 0 {
                a[1].add(d, &row[0]);
                a[3].add(n, &row[1]);
            }
            if ORDER > 1 {
                a[2].add(dd, &row[0]);
                a[4].add(d, &row[1]);
                a[5].add(n, &row[2]);
            }
        }
        let [p, du, duu] = divide(&a[0], &a[1], &a[2]);
        let [_, dv, dvv] = divide(&a[0], &a[3], &a[5]);
        let point = Point::from(p);
        if ORDER < 2 {
            return Jet { du, dv, ..Jet::at(point) };
        }
        let duv = (a[4].0 - du * a[3].1 - dv * a[1].1 - p * a[4].1) / a[0].1;
        Jet { point, du, dv, duu, duv, dvv }
    }

    /// The sums along v of one row of control points: value, first, second derivative.
    fn row_sums<const N: usize, const ORDER: usize>(&self, basis: &Basis<N>, row: usize) -> [Weighted; 3] {
        let first = row * self.columns + basis.first;
        basis.sums::<ORDER>(&self.points, &self.weights, first..=first + self.degree_v)
    }

    /// The number of non-empty knot spans along u and v.
    pub fn spans(&self) -> [usize; 2] {
        let (rows, columns) = (self.rows(), self.columns);
        let count = |knots: &[f64]| distinct(knots).count().max(2) - 1;
        [count(&self.knots_u[self.degree_u..=rows]), count(&self.knots_v[self.degree_v..=columns])]
    }
}

/// The values of a sorted list, each once.
fn distinct(knots: &[f64]) -> impl Iterator<Item = f64> + '_ {
    knots.iter().enumerate().filter(|&(i, k)| i == 0 || *k > knots[i - 1]).map(|(_, k)| *k)
}

#[cfg(test)]
impl NurbsSurface {
    /// The patch over the unit square with these corners at (u, v) = (0, 0), (0, 1), (1, 0), (1, 1).
    pub(super) fn bilinear(corners: Vec<Point>) -> Self {
        let knots = vec![0.0, 0.0, 1.0, 1.0];
        let (knots_u, knots_v) = (knots.clone(), knots);
        Self { degree_u: 1, degree_v: 1, knots_u, knots_v, columns: 2, points: corners, weights: vec![] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quarter of the unit circle as a rational parabola.
    fn quarter() -> NurbsCurve {
        NurbsCurve {
            degree: 2,
            knots: vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
            points: [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]].map(Point::from).to_vec(),
            weights: vec![1.0, 0.5_f64.sqrt(), 1.0],
            closed: false,
        }
    }

    #[test]
    fn a_rational_parabola_is_a_circle() {
        for i in 0..=10 {
            let [p, d, _] = quarter().derivatives(i as f64 / 10.0);
            assert!((p.norm() - 1.0).abs() < 1e-14);
            assert!(p.dot(&d).abs() < 1e-14, "the tangent is at right angles to the radius");
        }
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let (curve, t, h) = (quarter(), 0.3, 1e-4);
        let [p, d, dd] = curve.derivatives(t);
        let (a, b) = (curve.derivatives(t - h)[0], curve.derivatives(t + h)[0]);
        assert!(((b - a) / (2.0 * h) - d).norm() < 1e-7);
        assert!(((a + b - p * 2.0) / (h * h) - dd).norm() < 1e-6);
    }

    #[test]
    fn knots_need_not_be_clamped() {
        // Uniform quadratic: at the start of its domain the point is half way between the first two control points.
        let points = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0]].map(Point::from).to_vec();
        let knots = (0..6).map(f64::from).collect();
        let curve = NurbsCurve { degree: 2, knots, points, weights: vec![], closed: false };
        assert_eq!(curve.domain(), [2.0, 3.0]);
        assert!((curve.derivatives(2.0)[0] - Vector::new(1.0, 0.0, 0.0)).norm() < 1e-15);
        assert!((curve.derivatives(3.0)[0] - Vector::new(2.0, 1.0, 0.0)).norm() < 1e-15);
    }

    #[test]
    fn powers_are_splines_of_any_degree() {
        // t^n is the spline of degree n whose control points are the products of n knots each (its blossom), t the one
        // of their means; with a double knot inside.
        let inner = [0.25, 0.5, 0.5, 0.75];
        for degree in [3, 4, 5, 7, 8, 12, MAX_DEGREE] {
            let n = degree as f64;
            let ends = |end: f64| std::iter::repeat_n(end, degree + 1);
            let knots: Vec<f64> = ends(0.0).chain(inner).chain(ends(1.0)).collect();
            let point = |k: &[f64]| Point::new(k.iter().product(), k.iter().sum::<f64>() / n, 0.0);
            let points = knots[1..knots.len() - 1].windows(degree).map(point).collect();
            let curve = NurbsCurve { degree, knots, points, weights: vec![], closed: false };
            for t in [0.0, 0.1, 0.25, 0.5, 0.6, 1.0_f64] {
                let [p, d, dd] = curve.derivatives(t);
                let [power, slope, bend] = [t.powf(n), n * t.powf(n - 1.0), n * (n - 1.0) * t.powf(n - 2.0)];
                assert!((p - Vector::new(power, t, 0.0)).norm() < 1e-12, "degree {degree} at {t}");
                assert!((d - Vector::new(slope, 1.0, 0.0)).norm() < 1e-11 * n, "degree {degree} at {t}");
                assert!((dd - Vector::new(bend, 0.0, 0.0)).norm() < 1e-10 * n * n, "degree {degree} at {t}");
            }
        }
    }

    #[test]
    fn a_bilinear_patch_has_its_corners_and_twist() {
        let points = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 1.0]].map(Point::from).to_vec();
        let surface = NurbsSurface::bilinear(points);
        let jet = surface.jet(0.5, 0.5);
        assert_eq!(jet.point, Point::new(0.5, 0.5, 0.25));
        assert_eq!(jet.du, Vector::new(1.0, 0.0, 0.5));
        assert_eq!(jet.duv, Vector::z());
        assert_eq!(surface.jet_to::<1>(0.5, 0.5), Jet { duv: Vector::zeros(), ..jet });
        assert_eq!(surface.spans(), [1, 1]);
    }
}
