//! Convex hulls up to a tolerance (quickhull: Barber, Dobkin and Huhdanpaa 1996).
//!
//! In: points. Out: the corners and facet normals of a hull that no point lies farther outside than the tolerance, or
//! that has as many corners as are allowed. The point farthest outside is always next, so which points become corners
//! does not depend on the pose.
//! Cost: points times the facets that are built anew; the tolerance keeps facets away from rounding.

use rustc_hash::FxHashSet;

use crate::cancel::{Cancel, Cancelled};
use crate::geometry::{Point, Vector, isometry::mean};

/// Corners and outward facet normals.
pub struct Hull {
    pub corners: Vec<Point>,
    pub normals: Vec<Vector>,
}

/// A triangle of the hull, counter-clockwise from outside, with the points that it sees.
struct Facet {
    corners: [usize; 3],
    normal: Vector,
    offset: f64,
    outside: Vec<usize>,
    /// The farthest of them and its distance.
    farthest: Option<(f64, usize)>,
}

impl Facet {
    /// `None` for corners on a line.
    fn new(points: &[Point], corners: [usize; 3]) -> Option<Self> {
        let [a, b, c] = corners.map(|i| points[i]);
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0)?;
        Some(Self { corners, normal, offset: normal.dot(&a.coords), outside: Vec::new(), farthest: None })
    }

    fn distance(&self, p: &Point) -> f64 {
        self.normal.dot(&p.coords) - self.offset
    }

    fn edges(&self) -> [(usize, usize); 3] {
        let [a, b, c] = self.corners;
        [(a, b), (b, c), (c, a)]
    }
}

/// The hull of `points` with at most `most` corners; `None` where all lie within `tolerance` (mm) of a plane.
pub fn hull(points: &[Point], tolerance: f64, most: usize, cancel: &Cancel) -> Result<Option<Hull>, Cancelled> {
    let Some(first) = simplex(points, tolerance) else { return Ok(None) };
    let mut facets: Vec<Facet> = Vec::new();
    for [i, j, k, opposite] in [[0, 1, 2, 3], [0, 2, 3, 1], [0, 3, 1, 2], [1, 3, 2, 0]] {
        let Some(facet) = Facet::new(points, [first[i], first[j], first[k]]) else { return Ok(None) };
        let outward = facet.distance(&points[first[opposite]]) < 0.0;
        facets.extend(if outward { Some(facet) } else { Facet::new(points, [first[i], first[k], first[j]]) });
    }
    deal(points, &mut facets, 0..points.len(), tolerance);
    for _ in first.len()..most {
        cancel.check()?;
        let farthest = facets.iter().filter_map(|f| f.farthest).max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        let Some((_, next)) = farthest else { break };
        extend(points, &mut facets, next, tolerance);
    }
    let mut corners: Vec<_> = facets.iter().flat_map(|f| f.corners).collect();
    corners.sort_unstable();
    corners.dedup();
    let corners = corners.into_iter().map(|i| points[i]).collect();
    Ok(Some(Hull { corners, normals: facets.iter().map(|f| f.normal).collect() }))
}

/// Four points far apart: the farthest from the mean, from that, from their line, from their plane.
fn simplex(points: &[Point], tolerance: f64) -> Option<[usize; 4]> {
    let farthest = |distance: &dyn Fn(&Point) -> f64| {
        let best = (0..points.len()).max_by(|&i, &j| distance(&points[i]).total_cmp(&distance(&points[j])))?;
        (distance(&points[best]) > tolerance).then_some(best)
    };
    let centre = mean(points);
    let a = farthest(&|p| (p - centre).norm())?;
    let b = farthest(&|p| (p - points[a]).norm())?;
    let along = (points[b] - points[a]).normalize();
    let c = farthest(&|p| (p - points[a]).cross(&along).norm())?;
    let normal = along.cross(&(points[c] - points[a])).normalize();
    let d = farthest(&|p| (p - points[a]).dot(&normal).abs())?;
    Some([a, b, c, d])
}

/// Replaces the facets that see the point by a cone from it to their rim.
fn extend(points: &[Point], facets: &mut Vec<Facet>, next: usize, tolerance: f64) {
    let (seen, mut kept): (Vec<_>, Vec<_>) =
        std::mem::take(facets).into_iter().partition(|f| f.distance(&points[next]) > 1e-6 * tolerance);
    let edges: FxHashSet<_> = seen.iter().flat_map(Facet::edges).collect();
    let rim = seen.iter().flat_map(Facet::edges).filter(|&(a, b)| !edges.contains(&(b, a)));
    let mut cone: Vec<_> = rim.filter_map(|(a, b)| Facet::new(points, [a, b, next])).collect();
    deal(points, &mut cone, seen.into_iter().flat_map(|f| f.outside).filter(|&i| i != next), tolerance);
    kept.append(&mut cone);
    *facets = kept;
}

/// Gives every point that lies outside to the first facet that sees it.
fn deal(points: &[Point], facets: &mut [Facet], outside: impl Iterator<Item = usize>, tolerance: f64) {
    for i in outside {
        let seen = facets.iter_mut().map(|f| (f.distance(&points[i]), f)).find(|(distance, _)| *distance > tolerance);
        let Some((distance, facet)) = seen else { continue };
        facet.outside.push(i);
        if facet.farthest.is_none_or(|(most, _)| distance > most) {
            facet.farthest = Some((distance, i));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::shapes;

    #[test]
    fn the_hull_of_a_box_with_points_inside_is_the_box() {
        let outer = shapes::cuboid(2.0, 3.0, 4.0);
        let inner = shapes::mapped(&outer, |p| Point::from(p.coords * 0.4 + Vector::repeat(0.5)));
        let points = [outer.points, inner.points].concat();
        let found = hull(&points, 1e-6, 99, &Cancel::new()).unwrap().unwrap();
        assert_eq!((found.corners.len(), found.normals.len()), (8, 12));
        assert!(found.normals.iter().all(|n| (n.amax() - 1.0).abs() < 1e-12));
    }

    #[test]
    fn corners_are_bounded_and_a_flat_set_has_no_hull() {
        let ball = shapes::ellipsoid([1.0; 3], 24).points;
        assert_eq!(hull(&ball, 1e-9, 50, &Cancel::new()).unwrap().unwrap().corners.len(), 50);
        assert!(hull(&shapes::rectangle(1.0, 2.0).points, 1e-6, 50, &Cancel::new()).unwrap().is_none());
    }
}
