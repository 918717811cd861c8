//! Building the tree: cuts where the boxes come out small (the surface area heuristic over bins).

use super::{Child, LEAF, Node};
use crate::geometry::sides::Sides;

/// Places tried for a cut.
const BINS: usize = 8;

/// A triangle while the tree is built.
#[derive(Clone, Copy)]
pub(super) struct Item {
    pub bounds: Bounds,
    pub index: u32,
}

#[derive(Clone, Copy)]
pub(super) struct Bounds {
    pub low: [f32; 3],
    pub high: [f32; 3],
    pub sides: Sides,
}

impl Bounds {
    const EMPTY: Self = Self { low: [f32::INFINITY; 3], high: [f32::NEG_INFINITY; 3], sides: 0 };

    fn join(&mut self, other: &Self) {
        for axis in 0..3 {
            self.low[axis] = lesser(self.low[axis], other.low[axis]);
            self.high[axis] = greater(self.high[axis], other.high[axis]);
        }
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

/// The lesser of two numbers: one instruction, where `f32::min` also looks for what is none.
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Adds the node of all items, of which the first is number `first`, and the nodes below it.
pub(super) fn build(nodes: &mut Vec<Node>, items: &mut [Item], first: u32, level: usize) -> u32 {
    let index = nodes.len();
    nodes.push(Node::EMPTY);
    let half = cut(items, level);
    let (left, right) = items.split_at_mut(half);
    let quarters = [cut(left, level), left.len(), half + cut(right, level), half + right.len()];
    let mut start = 0;
    for (i, end) in quarters.into_iter().enumerate() {
        let part = &mut items[start..end];
        if part.is_empty() {
            continue;
        }
        let bounds = Bounds::of(part);
        let (from, count) = (first + start as u32, part.len() as u32);
        let child = if part.len() <= LEAF {
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

/// Parts items in two where the boxes come out smallest for their numbers (the surface area heuristic), or, deep down,
/// in the middle. Returns the size of the first part; what fits in a leaf stays whole.
fn cut(items: &mut [Item], level: usize) -> usize {
    if items.len() <= LEAF {
        return items.len();
    }
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for item in items.iter() {
        for axis in 0..3 {
            let middle = item.bounds.middle(axis);
            (low[axis], high[axis]) = (lesser(low[axis], middle), greater(high[axis], middle));
        }
    }
    let extent: [f32; 3] = std::array::from_fn(|i| high[i] - low[i]);
    let axis = (0..3).fold(0, |best, i| if extent[i] > extent[best] { i } else { best });
    if level < super::FREE_LEVELS && extent[axis] > 0.0 {
        let scale = BINS as f32 / extent[axis];
        let bin = |item: &Item| (((item.bounds.middle(axis) - low[axis]) * scale) as usize).min(BINS - 1);
        let best = best_bin(items, bin);
        return partition(items, |item| bin(item) <= best);
    }
    let half = items.len() / 2;
    items.select_nth_unstable_by(half, |a, b| {
        a.bounds.middle(axis).total_cmp(&b.bounds.middle(axis)).then(a.index.cmp(&b.index))
    });
    half
}

/// The last bin of the first part. The first and the last bin are never empty.
fn best_bin(items: &[Item], bin: impl Fn(&Item) -> usize) -> usize {
    let mut bins = [(Bounds::EMPTY, 0u32); BINS];
    for item in items {
        let (bounds, count) = &mut bins[bin(item)];
        bounds.join(&item.bounds);
        *count += 1;
    }
    let mut behind = [0.0f32; BINS];
    let (mut all, mut count) = (Bounds::EMPTY, 0);
    for i in (1..BINS).rev() {
        all.join(&bins[i].0);
        count += bins[i].1;
        behind[i - 1] = all.half_area() * count as f32;
    }
    let (mut all, mut count, mut best) = (Bounds::EMPTY, 0, (f32::INFINITY, BINS / 2));
    for i in 0..BINS - 1 {
        all.join(&bins[i].0);
        count += bins[i].1;
        let cost = all.half_area() * count as f32 + behind[i];
        if cost < best.0 {
            best = (cost, i);
        }
    }
    best.1
}

/// Moves the items that belong to the first part to the front; returns how many.
fn partition(items: &mut [Item], first: impl Fn(&Item) -> bool) -> usize {
    let mut count = 0;
    for i in 0..items.len() {
        if first(&items[i]) {
            items.swap(i, count);
            count += 1;
        }
    }
    count
}
