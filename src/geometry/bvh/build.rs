//! Building the tree: cuts where the boxes come out small (the surface area heuristic over bins).

use super::{Child, LEAF, Node};
use crate::geometry::order::{less, more};
use crate::geometry::sides::Sides;

/// Places tried for a cut.
const BINS: usize = 8;
/// How much larger than those of two neighbours the box of both may be.
const NEIGHBOURS: f32 = 1.25;

/// Triangles that stay together while the tree is built.
#[derive(Clone, Copy)]
pub(super) struct Item {
    pub bounds: Bounds,
    /// The first of the triangles, and how many they are.
    pub first: u32,
    pub count: u32,
}

impl Item {
    /// Takes the triangle of the next item in, if there is room in a leaf and they are neighbours: if the box of all is
    /// no larger than theirs together.
    pub fn joined(&self, next: &Self) -> Option<Self> {
        let mut bounds = self.bounds;
        bounds.join(&next.bounds);
        let apart = self.bounds.half_area() + next.bounds.half_area();
        let count = self.count + next.count;
        (count as usize <= LEAF && bounds.half_area() <= NEIGHBOURS * apart).then_some(Self { bounds, count, ..*self })
    }
}

/// A box, each end as wide as a vector register: the fourth number means nothing.
#[derive(Clone, Copy)]
pub(super) struct Bounds {
    pub low: [f32; 4],
    pub high: [f32; 4],
    pub sides: Sides,
}

impl Bounds {
    const EMPTY: Self = Self { low: [f32::INFINITY; 4], high: [f32::NEG_INFINITY; 4], sides: 0 };

    fn join(&mut self, other: &Self) {
        self.low = lesser(self.low, other.low);
        self.high = greater(self.high, other.high);
        self.sides |= other.sides;
    }

    fn of(items: &[Item]) -> Self {
        items.iter().fold(Self::EMPTY, |mut all, item| {
            all.join(&item.bounds);
            all
        })
    }

    /// Twice the middle along an axis.
    fn middle(&self, axis: usize) -> f32 {
        self.low[axis] + self.high[axis]
    }

    /// Half the area of the box, to which the number of queries that enter it is proportional.
    fn half_area(&self) -> f32 {
        let [a, b, c] = std::array::from_fn(|i| self.high[i] - self.low[i]);
        a * b + b * c + c * a
    }
}

/// The lesser one of each two numbers.
fn lesser(a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
    std::array::from_fn(|i| less(a[i], b[i]))
}

fn greater(a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
    std::array::from_fn(|i| more(a[i], b[i]))
}

/// Adds the node of all items, of which the first is number `first`, and the nodes below it. Leaves hold items.
pub(super) fn build(nodes: &mut Vec<Node>, items: &mut [Item], first: u32, level: usize) -> u32 {
    let index = nodes.len();
    nodes.push(Node::EMPTY);
    let half = cut(items, level).0;
    let (left, right) = items.split_at_mut(half);
    let (a, [first_box, second_box]) = cut(left, level);
    let (b, [third_box, fourth_box]) = cut(right, level);
    let ends = [a, left.len(), half + b, half + right.len()];
    let quarters = ends.into_iter().zip([first_box, second_box, third_box, fourth_box]);
    let mut start = 0;
    for (i, (end, bounds)) in quarters.enumerate() {
        let part = &mut items[start..end];
        if part.is_empty() {
            continue;
        }
        let (from, count) = (first + start as u32, part.len() as u32);
        let child = if is_leaf(part) {
            Child { first: from, count }
        } else {
            Child { first: build(nodes, part, from, level + 1), count: 0 }
        };
        let node = &mut nodes[index];
        for axis in 0..3 {
            (node.low[axis][i], node.high[axis][i]) = (bounds.low[axis], bounds.high[axis]);
        }
        (node.sides[i], node.children[i]) = (bounds.sides, child);
        start = end;
    }
    index as u32
}

fn is_leaf(items: &[Item]) -> bool {
    items.len() <= 1 || (items.len() <= LEAF && items.iter().map(|item| item.count as usize).sum::<usize>() <= LEAF)
}

/// Parts items in two where the boxes come out smallest for their numbers (the surface area heuristic), or, deep down,
/// in the middle. Returns the size of the first part and the boxes of both; what fits in a leaf stays whole.
fn cut(items: &mut [Item], level: usize) -> (usize, [Bounds; 2]) {
    if is_leaf(items) {
        return (items.len(), [Bounds::of(items), Bounds::EMPTY]);
    }
    let (mut low, mut high) = (Bounds::EMPTY.low, Bounds::EMPTY.high);
    for Item { bounds, .. } in items.iter() {
        let middle = std::array::from_fn(|i| bounds.low[i] + bounds.high[i]);
        (low, high) = (lesser(low, middle), greater(high, middle));
    }
    let extent: [f32; 3] = std::array::from_fn(|i| high[i] - low[i]);
    let axis = (0..3).fold(0, |best, i| if extent[i] > extent[best] { i } else { best });
    if level < super::FREE_LEVELS && extent[axis] > 0.0 {
        let scale = BINS as f32 / extent[axis];
        // A byte takes the fewest instructions to be held within its range.
        let bin = |item: &Item| usize::from(((item.bounds.middle(axis) - low[axis]) * scale) as u8).min(BINS - 1);
        let (best, bounds) = best_bin(items, bin);
        return (partition(items, |item| bin(item) <= best), bounds);
    }
    let half = items.len() / 2;
    items.select_nth_unstable_by(half, |a, b| {
        a.bounds.middle(axis).total_cmp(&b.bounds.middle(axis)).then(a.first.cmp(&b.first))
    });
    (half, [Bounds::of(&items[..half]), Bounds::of(&items[half..])])
}

/// The last bin of the first part, and the boxes of both parts. The first and the last bin are never empty.
fn best_bin(items: &[Item], bin: impl Fn(&Item) -> usize) -> (usize, [Bounds; 2]) {
    let mut bins = [(Bounds::EMPTY, 0u32); BINS];
    for item in items {
        let (bounds, count) = &mut bins[bin(item)];
        bounds.join(&item.bounds);
        *count += item.count;
    }
    let mut behind = [(Bounds::EMPTY, 0u32); BINS];
    for i in (1..BINS).rev() {
        behind[i - 1] = behind[i];
        behind[i - 1].0.join(&bins[i].0);
        behind[i - 1].1 += bins[i].1;
    }
    let (mut all, mut count) = (Bounds::EMPTY, 0);
    let mut best = (f32::INFINITY, BINS / 2, Bounds::EMPTY);
    for i in 0..BINS - 1 {
        all.join(&bins[i].0);
        count += bins[i].1;
        let cost = all.half_area() * count as f32 + behind[i].0.half_area() * behind[i].1 as f32;
        if cost < best.0 {
            best = (cost, i, all);
        }
    }
    (best.1, [best.2, behind[best.1].0])
}

/// Moves the items that belong to the first part to the front; returns how many. Which do nobody foresees, the
/// processor neither: items are moved without a question.
fn partition(items: &mut [Item], first: impl Fn(&Item) -> bool) -> usize {
    let mut count = 0;
    for i in 0..items.len() {
        let belongs = first(&items[i]);
        items.swap(i, count);
        count += usize::from(belongs);
    }
    count
}
