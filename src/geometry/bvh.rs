//! A tree of boxes over triangles, for distances from points to a surface.

use super::{Aabb, Point, Vector};

/// Triangles in a leaf: fewer make the tree deeper, more test needless triangles.
const LEAF: usize = 4;

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

/// A box with its children or its triangles.
#[derive(Clone, Debug)]
struct Node {
    bounds: Aabb,
    /// Leaf: the first triangle; else the right child (the left one follows the node).
    start: u32,
    /// Triangles of a leaf; 0 for inner nodes.
    count: u32,
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

/// The nearest triangle to a point.
#[derive(Clone, Copy, Debug)]
pub struct Nearest {
    /// The nearest point of the triangle, mm.
    pub point: Point,
    /// Squared distance, mm^2.
    pub squared: f64,
    /// Unit normal of the triangle.
    pub normal: Vector,
    /// The caller's number for it.
    pub id: u32,
}

/// Triangles under a binary tree of boxes. Building takes n log n, a query for a small radius about log n.
#[derive(Clone, Debug, Default)]
pub struct Bvh {
    nodes: Vec<Node>,
    triangles: Vec<Triangle>,
}

impl Bvh {
    /// The tree over `triangles`, each with the caller's number; triangles without area are left out.
    pub fn new(triangles: impl IntoIterator<Item = ([Point; 3], u32)>) -> Self {
        let triangle = |(corners, id): ([Point; 3], u32)| {
            let [a, b, c] = corners;
            let normal = (b - a).cross(&(c - a)).try_normalize(0.0)?;
            normal.iter().all(|x| x.is_finite()).then_some(Triangle { corners, normal, id })
        };
        let mut tree = Self { nodes: Vec::new(), triangles: triangles.into_iter().filter_map(triangle).collect() };
        if !tree.triangles.is_empty() {
            tree.build(0, tree.triangles.len());
        }
        tree
    }

    /// Adds the node of a range of triangles and all below it, splitting at the median of the longest side.
    fn build(&mut self, start: usize, end: usize) {
        let slice = &mut self.triangles[start..end];
        let bounds = Aabb::of(slice.iter().flat_map(|t| &t.corners));
        let index = self.nodes.len();
        self.nodes.push(Node { bounds, start: start as u32, count: (end - start) as u32 });
        if end - start <= LEAF {
            return;
        }
        let centres = Aabb::of(slice.iter().map(middle).collect::<Vec<_>>().iter());
        let axis = (centres.max - centres.min).imax();
        let half = slice.len() / 2;
        slice.select_nth_unstable_by(half, |s, t| middle(s)[axis].total_cmp(&middle(t)[axis]).then(s.id.cmp(&t.id)));
        self.build(start, start + half);
        let right = self.nodes.len() as u32;
        self.build(start + half, end);
        self.nodes[index].start = right;
        self.nodes[index].count = 0;
    }

    /// Whether some triangle that `accept` takes is within `radius` of `p`.
    pub fn any_within(&self, p: &Point, radius: f64, accept: impl Fn(&Triangle) -> bool) -> bool {
        let limit = radius * radius;
        let mut found = false;
        self.visit(
            p,
            |_| limit,
            |triangle| {
                // Most triangles of a leaf are ruled out by their plane.
                let height = triangle.normal.dot(&(p - triangle.corners[0]));
                found = height * height <= limit
                    && accept(triangle)
                    && (nearest_on_triangle(p, &triangle.corners) - p).norm_squared() <= limit;
                found
            },
        );
        found
    }

    /// The nearest of the triangles that `accept` takes, if one is within `radius` of `p`.
    pub fn nearest_within(&self, p: &Point, radius: f64, accept: impl Fn(&Triangle) -> bool) -> Option<Nearest> {
        let best = std::cell::Cell::new(None::<Nearest>);
        let limit = |_: ()| best.get().map_or(radius * radius, |n| n.squared);
        self.visit(p, limit, |triangle| {
            if accept(triangle) {
                let point = nearest_on_triangle(p, &triangle.corners);
                let squared = (point - p).norm_squared();
                if squared <= limit(()) {
                    best.set(Some(Nearest { point, squared, normal: triangle.normal, id: triangle.id }));
                }
            }
            false
        });
        best.get()
    }

    /// Shows `look` the triangles of all leaves nearer than the limit, nearer children first, until it says stop.
    fn visit(&self, p: &Point, limit: impl Fn(()) -> f64, mut look: impl FnMut(&Triangle) -> bool) {
        // Splitting at the median keeps the tree balanced: 64 entries hold any tree of 2^32 triangles.
        let mut stack = [(0u32, 0.0); 64];
        let mut depth = usize::from(!self.nodes.is_empty());
        while depth > 0 {
            depth -= 1;
            let (index, squared) = stack[depth];
            if squared > limit(()) {
                continue;
            }
            let node = &self.nodes[index as usize];
            if node.count > 0 {
                let range = node.start as usize..(node.start + node.count) as usize;
                if self.triangles[range].iter().any(&mut look) {
                    return;
                }
                continue;
            }
            let (left, right) = (index + 1, node.start);
            let to = |i: u32| squared_distance(&self.nodes[i as usize].bounds, p);
            let (mut far, mut near) = ((right, to(right)), (left, to(left)));
            if far.1 < near.1 {
                std::mem::swap(&mut far, &mut near);
            }
            let limit = limit(());
            for child in [far, near] {
                if child.1 <= limit {
                    stack[depth] = child;
                    depth += 1;
                }
            }
        }
    }
}

/// A point inside the triangle to sort it by.
fn middle(triangle: &Triangle) -> Point {
    let [a, b, c] = &triangle.corners;
    Point::from((a.coords + b.coords + c.coords) / 3.0)
}

/// Squared distance from `p` to the box, 0 inside.
#[inline]
fn squared_distance(bounds: &Aabb, p: &Point) -> f64 {
    let side = |low: f64, x: f64, high: f64| {
        let outside = if low - x > x - high { low - x } else { x - high };
        if outside > 0.0 { outside } else { 0.0 }
    };
    let x = side(bounds.min.x, p.x, bounds.max.x);
    let y = side(bounds.min.y, p.y, bounds.max.y);
    let z = side(bounds.min.z, p.z, bounds.max.z);
    x * x + y * y + z * z
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet(n: usize) -> Vec<([Point; 3], u32)> {
        let cell = |i: usize| {
            let (x, y) = ((i % n) as f64, (i / n) as f64);
            let at = |dx: f64, dy: f64| Point::new(x + dx, y + dy, 0.0);
            ([at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)], i as u32)
        };
        (0..n * n).map(cell).collect()
    }

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

    #[test]
    fn the_tree_agrees_with_looking_at_all() {
        let triangles = sheet(12);
        let tree = Bvh::new(triangles.clone());
        for i in 0..200 {
            let p = Point::new(i as f64 * 0.07, (i * i % 97) as f64 * 0.12, (i % 5) as f64 * 0.3);
            let distance = |t: &[Point; 3]| (nearest_on_triangle(&p, t) - p).norm_squared();
            let all = triangles.iter().map(|(t, _)| distance(t)).fold(f64::INFINITY, f64::min);
            let found = tree.nearest_within(&p, 100.0, |_| true).unwrap();
            assert_eq!(found.squared, all);
            assert_eq!(tree.any_within(&p, 0.5, |_| true), all <= 0.25);
        }
    }

    #[test]
    fn triangles_that_are_not_accepted_do_not_count() {
        let tree = Bvh::new(sheet(3));
        let p = Point::new(0.1, 0.1, 0.5);
        assert!(tree.any_within(&p, 1.0, |t| t.normal.z > 0.0));
        assert!(!tree.any_within(&p, 1.0, |t| t.normal.z < 0.0));
        assert_eq!(tree.nearest_within(&p, 9.0, |t| t.id != 0).unwrap().id, 1);
        assert!(Bvh::default().nearest_within(&p, 9.0, |_| true).is_none());
    }
}
