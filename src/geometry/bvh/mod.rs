//! A tree of boxes over triangles, for distances from points to a surface.
//!
//! Four boxes to the node, side by side in single precision and a little too large, so that one pass of vector
//! instructions tells the distances of all four; triangles are measured in double precision. Nodes also know which way
//! their triangles face ([`sides`]): most of what is near a point of a thin part faces the other way.

mod build;
mod triangle;

use arrayvec::ArrayVec;

use super::order::{less, more};
use super::sides::{self, Sides};
use super::{Aabb, Point, Vector};
use build::{Bounds, Item, build};
use triangle::Slab;
pub use triangle::{Triangle, nearest_on_triangle};

/// Children of a node: what a vector register of any x86-64 or ARM processor holds.
const WIDE: usize = 4;
/// Triangles in a leaf: fewer make the tree deeper, more test needless triangles.
const LEAF: usize = 4;
/// Levels cut where the boxes come out small; below, in the middle, so that no tree is deep.
const FREE_LEVELS: usize = 16;
/// Entries that wait on the way through a tree: three for each level, of which the middle cuts of 2^32 triangles need
/// another 16.
const WAITING: usize = 3 * (FREE_LEVELS + 16) + WIDE;
/// What boxes and distances are enlarged by, as shares of the tree's size and of themselves, to make up for rounding.
const PAD: f32 = 1e-6;
const SLACK: f32 = 1.0 + 1e-5;

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

/// What is looked for around a point: triangles within `radius`. Those that face none of `sides` may be passed over.
#[derive(Clone, Copy, Debug)]
pub struct Around<'a> {
    /// From where, mm.
    pub point: &'a Point,
    /// How far, mm.
    pub radius: f64,
    /// Which way the triangles face that will be accepted.
    pub sides: Sides,
}

/// Four children: boxes (axis by axis), the ways their triangles face, and where they are.
#[derive(Clone, Debug)]
struct Node {
    low: [[f32; WIDE]; 3],
    high: [[f32; WIDE]; 3],
    sides: [Sides; WIDE],
    children: [Child; WIDE],
}

#[derive(Clone, Copy, Debug, Default)]
struct Child {
    /// The node, or the first triangle of a leaf.
    first: u32,
    /// Triangles of a leaf; 0 for nodes.
    count: u32,
}

impl Node {
    const EMPTY: Self = Self {
        low: [[f32::INFINITY; WIDE]; 3],
        high: [[f32::NEG_INFINITY; WIDE]; 3],
        sides: [0; WIDE],
        children: [Child { first: 0, count: 0 }; WIDE],
    };

    /// Squared distances from `p` to the boxes, 0 inside.
    #[inline]
    fn squared_distances(&self, p: &[f32; 3]) -> [f32; WIDE] {
        let mut sum = [0.0; WIDE];
        for (axis, p) in p.iter().enumerate() {
            for (i, sum) in sum.iter_mut().enumerate() {
                let (below, above) = (self.low[axis][i] - p, p - self.high[axis][i]);
                let outside = if below > above { below } else { above };
                let outside = if outside > 0.0 { outside } else { 0.0 };
                *sum += outside * outside;
            }
        }
        sum
    }
}

/// Ends a visit.
const STOP: f64 = -1.0;

/// Positions of the triangles found last, the latest first.
#[derive(Clone, Copy, Debug)]
pub struct Recent([u32; 4]);

impl Default for Recent {
    fn default() -> Self {
        Self([u32::MAX; 4])
    }
}

impl Recent {
    /// The triangle found last.
    pub fn latest(&self) -> Option<u32> {
        (self.0[0] != u32::MAX).then_some(self.0[0])
    }

    fn push(&mut self, position: u32) {
        self.0.rotate_right(1);
        self.0[0] = position;
    }
}

/// Triangles under a tree of boxes. Building takes n log n, a query for a small radius about log n.
#[derive(Clone, Debug, Default)]
pub struct Bvh {
    nodes: Vec<Node>,
    triangles: Vec<Triangle>,
    /// The slab of each triangle.
    slabs: Vec<Slab>,
    /// Boxes and slabs are in coordinates from here, in units of half the tree's size.
    centre: Point,
    shrink: f64,
}

impl Bvh {
    /// The tree over some `count` triangles, each with the caller's number; triangles without area are left out.
    pub fn new(count: usize, corners: impl IntoIterator<Item = ([Point; 3], u32)>) -> Self {
        let mut triangles = Vec::with_capacity(count);
        triangles.extend(corners.into_iter().filter_map(|(corners, id)| Triangle::new(corners, id)));
        let bounds = Aabb::of(triangles.iter().flat_map(|t| &t.corners));
        if bounds.is_empty() {
            return Self::default();
        }
        let shrink = 2.0 / (bounds.max - bounds.min).amax();
        let mut tree = Self { triangles, centre: bounds.centre(), shrink, ..Self::default() };
        let mut items = tree.items();
        build(&mut tree.nodes, &mut items, 0, 0);
        tree.settle(&items);
        tree.slabs = tree.triangles.iter().map(|t| Slab::of(t, &tree.centre, shrink)).collect();
        tree
    }

    /// The caller's number for the triangle at a position.
    pub fn id_of(&self, position: u32) -> Option<u32> {
        self.triangles.get(position as usize).map(|t| t.id)
    }

    /// Coordinates as those of the boxes.
    #[inline]
    fn local(&self, p: &Point) -> [f32; 3] {
        let d = (p - self.centre) * self.shrink;
        [d.x as f32, d.y as f32, d.z as f32]
    }

    /// The triangles one by one, neighbours of one number together: most faces are listed in rows, and fewer items make
    /// a tree sooner.
    fn items(&self) -> Vec<Item> {
        let mut items: Vec<Item> = Vec::with_capacity(self.triangles.len());
        for (index, triangle) in (0..).zip(&self.triangles) {
            let item = self.item(triangle, index);
            if let Some(last) = items.last_mut()
                && self.triangles[last.first as usize].id == triangle.id
                && let Some(joined) = last.joined(&item)
            {
                *last = joined;
            } else {
                items.push(item);
            }
        }
        items
    }

    fn item(&self, triangle: &Triangle, index: u32) -> Item {
        let [a, b, c] = triangle.corners.each_ref().map(|p| self.local(p));
        let end = |pick: fn(f32, f32) -> f32, pad: f32| {
            std::array::from_fn(|i| if i < 3 { pick(pick(a[i], b[i]), c[i]) + pad } else { 0.0 })
        };
        let (low, high) = (end(less, -PAD), end(more, PAD));
        Item { bounds: Bounds { low, high, sides: sides::of(&triangle.normal) }, first: index, count: 1 }
    }

    /// Puts the triangles into the order of their items, and their positions into the leaves.
    fn settle(&mut self, items: &[Item]) {
        let mut starts = Vec::with_capacity(items.len() + 1);
        let mut ordered = Vec::with_capacity(self.triangles.len());
        for item in items {
            starts.push(ordered.len() as u32);
            ordered.extend_from_slice(&self.triangles[item.first as usize..(item.first + item.count) as usize]);
        }
        starts.push(ordered.len() as u32);
        for child in self.nodes.iter_mut().flat_map(|node| &mut node.children).filter(|child| child.count > 0) {
            let [from, to] = [child.first, child.first + child.count].map(|item| starts[item as usize]);
            *child = Child { first: from, count: to - from };
        }
        self.triangles = ordered;
    }

    /// Whether some triangle that `accept` takes is there. The triangles that were found last are looked at first:
    /// neighbouring points often have the same.
    pub fn any_around(&self, around: &Around, recent: &mut Recent, accept: impl Fn(&Triangle) -> bool) -> bool {
        let limit = around.radius * around.radius;
        let (p, reach) = (self.local(around.point), self.reach(around, limit));
        let holds = |t: &Triangle| accept(t) && t.nearest(around.point, limit).is_some();
        for i in 0..recent.0.len() {
            let position = recent.0[i] as usize;
            if position < self.triangles.len()
                && !self.slabs[position].is_beyond(&p, reach)
                && holds(&self.triangles[position])
            {
                recent.0[..=i].rotate_right(1);
                return true;
            }
        }
        let mut found = false;
        self.visit(around, limit, |position, triangle, limit| {
            found = holds(triangle);
            if found {
                recent.push(position);
                return STOP;
            }
            limit
        });
        found
    }

    /// The nearest of the triangles that `accept` takes, if one is within `radius` of `p`.
    pub fn nearest_within(&self, p: &Point, radius: f64, accept: impl Fn(&Triangle) -> bool) -> Option<Nearest> {
        self.nearest_around(&Around { point: p, radius, sides: sides::ALL }, &mut { u32::MAX }, accept)
    }

    /// The nearest of the triangles that `accept` takes, if one is there; of equally near ones the one with the least
    /// number. `guess`, the position of a triangle, is looked at first and becomes that of the nearest: a good one spares
    /// most of the way.
    pub fn nearest_around(
        &self,
        around: &Around,
        guess: &mut u32,
        accept: impl Fn(&Triangle) -> bool,
    ) -> Option<Nearest> {
        let (mut best, first) = (None::<Nearest>, *guess);
        let mut look = |position: u32, triangle: &Triangle, limit: f64| {
            if accept(triangle)
                && let Some((squared, point)) = triangle.nearest(around.point, limit)
                && best.is_none_or(|b| (squared, triangle.id) < (b.squared, b.id))
            {
                best = Some(Nearest { point, squared, normal: triangle.normal, id: triangle.id });
                *guess = position;
                return squared;
            }
            limit
        };
        let mut limit = around.radius * around.radius;
        if let Some(triangle) = self.triangles.get(first as usize) {
            limit = look(first, triangle, limit);
        }
        self.visit(around, limit, look);
        best
    }

    /// The distance at a squared distance in the coordinates of the boxes, and a little more.
    #[inline]
    fn reach(&self, around: &Around, limit: f64) -> f32 {
        let farthest = ((around.point - self.centre).amax() * self.shrink) as f32;
        (limit.sqrt() * self.shrink) as f32 * SLACK + PAD * (2.0 + farthest)
    }

    /// Shows `look` the triangles of all leaves nearer than the limit (a squared distance), nearer children first. It
    /// gives the limit from then on; below 0 ends the visit.
    #[inline]
    fn visit(&self, around: &Around, mut limit: f64, mut look: impl FnMut(u32, &Triangle, f64) -> f64) {
        let p = self.local(around.point);
        let mut reach = self.reach(around, limit);
        let mut waiting = ArrayVec::<(Child, f32), WAITING>::new();
        waiting.extend((!self.nodes.is_empty()).then_some((Child::default(), 0.0)));
        while let Some((Child { first, count: triangles }, squared)) = waiting.pop() {
            if squared > reach * reach {
                continue;
            }
            if triangles > 0 {
                for position in first..first + triangles {
                    if self.slabs[position as usize].is_beyond(&p, reach) {
                        continue;
                    }
                    let after = look(position, &self.triangles[position as usize], limit);
                    if after < 0.0 {
                        return;
                    }
                    if after < limit {
                        (limit, reach) = (after, self.reach(around, after));
                    }
                }
                continue;
            }
            let node = &self.nodes[first as usize];
            let (distances, limit, base) = (node.squared_distances(&p), reach * reach, waiting.len());
            for (i, &squared) in distances.iter().enumerate() {
                if squared > limit || node.sides[i] & around.sides == 0 {
                    continue;
                }
                waiting.push((node.children[i], squared));
                // Kept in order, the nearest last.
                let mut at = waiting.len() - 1;
                while at > base && waiting[at - 1].1 < squared {
                    waiting.swap(at - 1, at);
                    at -= 1;
                }
            }
        }
    }
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

    fn around(point: &Point, radius: f64) -> Around<'_> {
        Around { point, radius, sides: sides::ALL }
    }

    #[test]
    fn the_tree_agrees_with_looking_at_all() {
        // Far from the origin, where single precision has nothing left of the distances.
        let off = Vector::new(1e6, -3e5, 7e5);
        let triangles: Vec<_> = sheet(12).into_iter().map(|(t, id)| (t.map(|p| p + off), id)).collect();
        let tree = Bvh::new(0, triangles.clone());
        let (mut first, mut second) = (0, Recent::default());
        for i in 0..200 {
            let p = Point::new(i as f64 * 0.07, (i * i % 97) as f64 * 0.12, (i % 5) as f64 * 0.3) + off;
            let distance = |t: &[Point; 3]| (nearest_on_triangle(&p, t) - p).norm_squared();
            let all = triangles.iter().map(|(t, _)| distance(t)).fold(f64::INFINITY, f64::min);
            let found = tree.nearest_around(&around(&p, 100.0), &mut first, |_| true).unwrap();
            assert_eq!(found.squared, all);
            assert_eq!(tree.any_around(&around(&p, 0.5), &mut second, |_| true), all <= 0.25);
        }
    }

    #[test]
    fn neighbours_of_one_number_share_a_leaf_and_are_all_found() {
        // Rows of twelve cells, each row a face; the last triangle is of the first face and far away.
        let mut triangles: Vec<_> = sheet(12).into_iter().map(|(t, id)| (t, id / 12)).collect();
        triangles.push((triangles[0].0.map(|p| p + Vector::new(500.0, 0.0, 90.0)), 0));
        let tree = Bvh::new(triangles.len(), triangles.clone());
        assert_eq!(tree.items().len(), 12 * 12 / 4 + 1);
        let leaves: Vec<_> = tree.nodes.iter().flat_map(|n| &n.children).filter(|c| c.count > 0).collect();
        assert_eq!(leaves.iter().map(|c| c.count as usize).sum::<usize>(), triangles.len());
        for (corners, id) in &triangles {
            let middle = nalgebra::center(&corners[0], &nalgebra::center(&corners[1], &corners[2]));
            let found = tree.nearest_within(&middle, 0.1, |_| true).unwrap();
            assert!(found.id == *id && found.squared < 1e-20, "{middle}: {found:?}");
        }
    }

    #[test]
    fn triangles_that_are_not_accepted_do_not_count() {
        let tree = Bvh::new(18, sheet(3));
        let p = Point::new(0.1, 0.1, 0.5);
        assert!(tree.any_around(&around(&p, 1.0), &mut Recent::default(), |t| t.normal.z > 0.0));
        assert!(!tree.any_around(&around(&p, 1.0), &mut Recent::default(), |t| t.normal.z < 0.0));
        assert_eq!(tree.nearest_within(&p, 9.0, |t| t.id != 0).unwrap().id, 1);
        assert!(Bvh::default().nearest_within(&p, 9.0, |_| true).is_none());
        let below = Around { sides: sides::of(&-Vector::z()), ..around(&p, 9.0) };
        assert!(tree.nearest_around(&below, &mut 99, |_| true).is_none());
    }

    #[test]
    fn triangles_in_one_place_make_a_tree_too() {
        let heap: Vec<_> = (0..1000).map(|i| (sheet(1)[0].0, i)).collect();
        let tree = Bvh::new(1000, heap);
        assert!(tree.any_around(&around(&Point::new(0.2, 0.2, 0.1), 0.2), &mut Recent::default(), |t| t.id == 999));
    }
}
