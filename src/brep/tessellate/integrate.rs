//! Area, centroid and flux of a trimmed surface: quadrature over the triangles of its parameter space, and over the
//! slivers between the chords of its border and the true edges.

use super::boundary::Path;
use super::chart::{Chart, Uv};
use super::domain::Patch;
use super::triangulate::doubled_area;
use crate::brep::Surface;
use crate::geometry::{Point, Vector};

/// Weights and places of the quadrature: three points, exact for quadratic functions (Strang and Fix 1973).
const INNER: [[f64; 3]; 3] =
    [[2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0], [1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0], [1.0 / 6.0, 1.0 / 6.0, 2.0 / 3.0]];

/// Integrals over a face.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Integrals {
    pub area: f64,
    /// Integral of p - q, for the reference point q.
    pub moment: Vector,
    /// A third of the integral of (p - q) . n with the face normal n.
    pub flux: f64,
}

impl Integrals {
    fn add(&mut self, place: &Vector, normal: &Vector, weight: f64) {
        let area = weight * normal.norm();
        self.area += area;
        self.moment += place * area;
        self.flux += weight * place.dot(normal) / 3.0;
    }

    /// The area centroid.
    pub fn centroid(&self, reference: &Point) -> Point {
        reference + self.moment / self.area
    }
}

/// Integrates over a patch and the slivers along its paths.
pub(super) fn integrate(chart: &Chart, patch: &Patch, paths: &[Path], reference: &Point) -> Integrals {
    let mut sum = Integrals::default();
    let sense = if chart.flipped { -1.0 } else { 1.0 };
    let mut at = |uv: Uv, weight: f64| {
        let jet = chart.tangents(uv);
        let mut one = Integrals::default();
        one.add(&(jet.point - reference), &jet.normal(), weight);
        sum.area += one.area;
        sum.moment += one.moment;
        sum.flux += sense * one.flux;
    };
    let flat = matches!(*chart.surface, Surface::Plane(_));
    let mut total = 0.0;
    for t in &patch.triangles {
        let corners = t.map(|i| patch.uv[i as usize]);
        let area = 0.5 * doubled_area(&patch.uv, t);
        total += area;
        let mix = |w: [f64; 3]| [0, 1].map(|k| w[0] * corners[0][k] + w[1] * corners[1][k] + w[2] * corners[2][k]);
        if flat {
            at(mix([1.0 / 3.0; 3]), area);
        } else {
            INNER.iter().for_each(|&w| at(mix(w), area / 3.0));
        }
    }
    for (path, side) in paths.iter().zip(&patch.sides) {
        for i in 0..path.uv.len() {
            let (centre, area) = sliver(path.segment(i, chart.periods));
            if area.abs() > 1e-10 * total {
                at(centre, side * area);
            }
        }
    }
    sum
}

/// Centre and signed area of the piece between a chord and the parabola through its ends and the true middle;
/// positive where the edge runs right of its chord, so that a face on its left gains.
fn sliver([a, m, b]: [Uv; 3]) -> (Uv, f64) {
    let middle = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
    let bulge = [m[0] - middle[0], m[1] - middle[1]];
    let area = 2.0 / 3.0 * (bulge[0] * (b[1] - a[1]) - bulge[1] * (b[0] - a[0]));
    ([middle[0] + 0.4 * bulge[0], middle[1] + 0.4 * bulge[1]], area)
}

/// The integrals over plain triangles in space.
pub(super) fn integrate_triangles(points: &[Point], triangles: &[[u32; 3]], reference: &Point) -> Integrals {
    let mut sum = Integrals::default();
    for t in triangles {
        let [a, b, c] = t.map(|i| points[i as usize] - reference);
        sum.add(&((a + b + c) / 3.0), &(b - a).cross(&(c - a)), 0.5);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sliver_is_two_thirds_of_its_rectangle() {
        // The chord runs along u, the edge bulges to the right (down) by 0.3: area 2/3 * 2 * 0.3.
        let (centre, area) = sliver([[0.0, 0.0], [1.0, -0.3], [2.0, 0.0]]);
        assert!((area - 0.4).abs() < 1e-15);
        assert_eq!(centre, [1.0, -0.12]);
    }

    #[test]
    fn a_tetrahedron_has_a_sixth_of_the_box() {
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Point::from);
        let triangles = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let sum = integrate_triangles(&points, &triangles, &Point::new(5.0, -3.0, 2.0));
        assert!((sum.flux - 1.0 / 6.0).abs() < 1e-14);
        assert!((sum.area - (1.5 + 0.75_f64.sqrt())).abs() < 1e-14);
    }
}
