//! Area, centroid and flux of a trimmed surface: quadrature over the triangles of its parameter space, and over the
//! slivers between the chords of its border and the true edges.
//!
//! The quadrature takes the middles of the sides, which is exact for quadratic functions (Strang and Fix 1973), and of
//! the rules that are so the one that asks for the fewest points: neighbours share them.

use super::boundary::Path;
use super::chart::{Chart, Uv};
use super::domain::Patch;
use super::triangulate::doubled_area;
use crate::brep::Surface;
use crate::geometry::cells::starts;
use crate::geometry::{Point, Vector};
use crate::memory::held;

/// The centre of a triangle, as weights of its corners.
const MIDDLE: [f64; 3] = [1.0 / 3.0; 3];
/// Three points inside, exact for quadratic functions as well.
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
    /// Adds a piece with this normal, of this length.
    fn add(&mut self, place: &Vector, (normal, length): (&Vector, f64), weight: f64) {
        let area = weight * length;
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
pub(super) fn integrate(
    chart: &Chart,
    patch: &Patch,
    paths: &[Path],
    reference: &Point,
    sides: &mut Sides,
) -> Integrals {
    let mut sum = Integrals::default();
    let sense = if chart.flipped { -1.0 } else { 1.0 };
    let piece_at = piece_of(chart);
    let mut at = |uv: Uv, weight: f64| {
        let (point, normal, length) = piece_at(uv);
        let mut one = Integrals::default();
        one.add(&(point - reference), (&normal, length), weight);
        sum.area += one.area;
        sum.moment += one.moment;
        sum.flux += sense * one.flux;
    };
    let areas = patch.triangles.iter().map(|t| 0.5 * doubled_area(&patch.uv, t));
    let total: f64 = areas.clone().sum();
    match *chart.surface {
        Surface::Plane(_) => patch.triangles.iter().zip(areas).for_each(|(t, area)| at(mix(patch, t, MIDDLE), area)),
        // The speed of a profile may jump from piece to piece, and sides lie where it does.
        Surface::Extrusion { .. } | Surface::Revolution { .. } => {
            patch.triangles.iter().zip(areas).for_each(|(t, area)| {
                INNER.iter().for_each(|&w| at(mix(patch, t, w), area / 3.0));
            })
        }
        _ => {
            sides.fill(patch, areas);
            sides.all.iter().for_each(|(side, area)| at(middle(patch, *side), *area));
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

/// Tells the point, the normal and its length at a place; a plane has one normal.
fn piece_of(chart: &Chart) -> impl Fn(Uv) -> (Point, Vector, f64) {
    let plane = match &*chart.surface {
        Surface::Plane(placement) => Some((placement, placement.x.cross(&placement.y))),
        _ => None,
    };
    let plane = plane.map(|(placement, normal)| (placement, normal, normal.norm()));
    move |uv| match plane {
        Some((placement, normal, length)) => (placement.point(uv[0], uv[1], 0.0), normal, length),
        None => {
            let jet = chart.tangents(uv);
            let normal = jet.normal();
            (jet.point, normal, normal.norm())
        }
    }
}

/// The point of a triangle with these weights of its corners.
fn mix(patch: &Patch, triangle: &[u32; 3], w: [f64; 3]) -> Uv {
    let [a, b, c] = triangle.map(|i| patch.uv[i as usize]);
    [0, 1].map(|k| w[0] * a[k] + w[1] * b[k] + w[2] * c[k])
}

/// The ends of a side, the smaller index first, and a third of the area of the triangles beside it.
type Side = ([u32; 2], f64);

/// The sides of the triangles of one patch after the other.
#[derive(Default)]
pub(super) struct Sides {
    all: Vec<Side>,
    /// Where the sides that begin at each point end.
    ends: Vec<usize>,
}

impl Sides {
    /// Bytes of memory that they hold.
    pub fn bytes(&self) -> usize {
        held(&self.all) + held(&self.ends)
    }

    /// Finds each side of a patch once, in the order of their ends.
    fn fill(&mut self, patch: &Patch, areas: impl Iterator<Item = f64>) {
        let Self { all, ends } = self;
        let ordered = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]);
        // Counted by their first ends: those of one point are so few that they are soon in order.
        ends.clear();
        ends.resize(patch.uv.len(), 0);
        patch.triangles.iter().flat_map(|t| ordered(*t)).for_each(|[a, _]| ends[a as usize] += 1);
        all.clear();
        all.resize(starts(ends), ([0; 2], 0.0));
        for (triangle, area) in patch.triangles.iter().zip(areas) {
            for side in ordered(*triangle) {
                let end = &mut ends[side[0] as usize];
                all[*end] = (side, area / 3.0);
                *end += 1;
            }
        }
        let mut start = 0;
        for &end in &*ends {
            all[start..end].sort_unstable_by_key(|([_, b], _)| *b);
            start = end;
        }
        all.dedup_by(|next, first| {
            let same = next.0 == first.0;
            first.1 += if same { next.1 } else { 0.0 };
            same
        });
    }
}

fn middle(patch: &Patch, side: [u32; 2]) -> Uv {
    let [a, b] = side.map(|i| patch.uv[i as usize]);
    [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
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
        let normal = (b - a).cross(&(c - a));
        sum.add(&((a + b + c) / 3.0), (&normal, normal.norm()), 0.5);
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
