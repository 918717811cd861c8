//! Triangles, and how far points are from them.

use crate::geometry::{Point, Vector};

/// The point of the triangle (a, b, c) that is nearest to `p` (Ericson, Real-Time Collision Detection, 5.1.5).
pub fn nearest_on_triangle(p: &Point, [a, b, c]: &[Point; 3]) -> Point {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return *a;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return *b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return *c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let sum = va + vb + vc;
    if sum > 0.0 { a + ab * (vb / sum) + ac * (vc / sum) } else { *a }
}

/// A triangle as the tree holds it.
#[derive(Clone, Debug)]
pub struct Triangle {
    /// Its corners, mm.
    pub corners: [Point; 3],
    /// Unit normal.
    pub normal: Vector,
    /// The caller's number for it.
    pub id: u32,
}

impl Triangle {
    pub(super) fn new(corners: [Point; 3], id: u32) -> Option<Self> {
        let [a, b, c] = corners;
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0)?;
        normal.iter().all(|x| x.is_finite()).then_some(Self { corners, normal, id })
    }

    /// The squared distance from `p` and the nearest point, unless the plane alone is farther away than the limit.
    #[inline]
    pub(super) fn nearest(&self, p: &Point, limit: f64) -> Option<(f64, Point)> {
        let height = self.normal.dot(&(p - self.corners[0]));
        if height * height > limit {
            return None;
        }
        let point = nearest_on_triangle(p, &self.corners);
        let squared = (point - p).norm_squared();
        (squared <= limit).then_some((squared, point))
    }
}

/// What a triangle lies behind, in the single precision of the tree: three planes through its sides, at right angles to
/// it, and its own plane, of which it is neither before nor behind. Tells that most triangles are too far away at a
/// fraction of the price of their distance.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct Slab {
    normals: [[f32; 4]; 3],
    offsets: [f32; 4],
}

impl Slab {
    pub fn of(triangle: &Triangle, centre: &Point, shrink: f64) -> Self {
        let corners = triangle.corners.map(|p| (p - centre) * shrink);
        let mut slab = Self { normals: [[0.0; 4]; 3], offsets: [0.0; 4] };
        for i in 0..4 {
            let along = corners[(i + 1) % 3] - corners[i % 3];
            let normal = if i == 3 { Some(triangle.normal) } else { along.cross(&triangle.normal).try_normalize(0.0) };
            // A side without length bounds nothing.
            let Some(normal) = normal else { continue };
            (0..3).for_each(|axis| slab.normals[axis][i] = normal[axis] as f32);
            slab.offsets[i] = normal.dot(&corners[i % 3]) as f32;
        }
        slab
    }

    /// Whether the triangle is farther from `p` than `reach` for certain.
    #[inline]
    pub fn is_beyond(&self, p: &[f32; 3], reach: f32) -> bool {
        let mut heights = [0.0; 4];
        for (i, height) in heights.iter_mut().enumerate() {
            let [x, y, z] = &self.normals;
            *height = x[i] * p[0] + y[i] * p[1] + z[i] * p[2] - self.offsets[i];
        }
        let [a, b, c, d] = heights;
        (a > reach) | (b > reach) | (c > reach) | (d.abs() > reach)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_point_may_be_inside_on_an_edge_or_a_corner() {
        let triangle = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]].map(Point::from);
        for (from, to) in [
            ([1.0, 1.0, 5.0], [1.0, 1.0, 0.0]),
            ([1.0, -2.0, 1.0], [1.0, 0.0, 0.0]),
            ([4.0, 4.0, 0.0], [2.0, 2.0, 0.0]),
            ([-1.0, -1.0, 0.0], [0.0, 0.0, 0.0]),
            ([9.0, -1.0, 0.0], [4.0, 0.0, 0.0]),
        ] {
            assert_eq!(nearest_on_triangle(&Point::from(from), &triangle), Point::from(to));
        }
    }
}
