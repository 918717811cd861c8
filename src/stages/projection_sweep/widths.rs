//! The widths of many convex polygons in a direction, added up.
//!
//! A convex polygon is half as wide as its sides, seen along that direction, are long (Cauchy). Sides that point the same
//! way there add up like vectors; sorted by their angle those are a first part of them and the rest.

use super::cover::sides;
use super::slices::Flat;

/// The sides of convex polygons, each with how far it is turned.
#[derive(Debug, Default)]
pub(super) struct Sides(Vec<(u64, Flat)>);

impl Sides {
    /// Adds those of a polygon, given by its corners in order, as often as it is there.
    pub fn push(&mut self, corners: &[Flat], times: usize) {
        let long = |[a, b]: [Flat; 2]| [b[0] - a[0], b[1] - a[1]].map(|c| c * times as f64);
        let long = sides(corners).map(long).map(upward).filter(|side| *side != [0.0; 2]);
        self.0.extend(long.map(|side| (turn(side), side)));
    }

    /// Adds all of some others.
    pub fn append(&mut self, mut others: Self) {
        if self.0.is_empty() {
            *self = others;
        } else {
            self.0.append(&mut others.0);
        }
    }
}

/// The sum of the widths of convex polygons as a function of the direction.
#[derive(Debug, Default)]
pub(super) struct Widths {
    /// How far each side is turned, ascending.
    turns: Vec<u64>,
    /// The sum of the first sides, of none, of one, and so on.
    sums: Vec<Flat>,
}

impl Widths {
    /// Of the polygons with such sides.
    pub fn of(Sides(mut sides): Sides) -> Self {
        sides.sort_unstable_by_key(|(turn, _)| *turn);
        let mut sums = vec![[0.0; 2]];
        sums.extend(sides.iter().scan([0.0; 2], |sum: &mut Flat, (_, side)| {
            *sum = [sum[0] + side[0], sum[1] + side[1]];
            Some(*sum)
        }));
        Self { turns: sides.into_iter().map(|(turn, _)| turn).collect(), sums }
    }

    /// The sum of the widths in a direction, a unit vector.
    pub fn along(&self, direction: Flat) -> f64 {
        let Some(all) = self.sums.last() else { return 0.0 };
        let across = turn(upward([-direction[1], direction[0]]));
        let first = self.sums[self.turns.partition_point(|turn| *turn < across)];
        let seen = |sum: Flat| (sum[0] * direction[0] + sum[1] * direction[1]).abs();
        0.5 * (seen(first) + seen([all[0] - first[0], all[1] - first[1]]))
    }
}

/// The vector or its opposite, whichever points up, or to the right.
fn upward([x, y]: Flat) -> Flat {
    if y > 0.0 || (y == 0.0 && x > 0.0) { [x, y] } else { [-x, -y] }
}

/// Grows with the angle of an upward vector: bits of positive numbers compare like the numbers, only faster.
fn turn([x, y]: Flat) -> u64 {
    (1.0 - x / (x.abs() + y)).to_bits()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_of_a_rectangle_and_two_triangles_add_up() {
        let rectangle = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]];
        let triangle = [[1.0, 1.0], [2.0, 1.0], [1.0, 3.0]];
        let mut sides = Sides::default();
        sides.push(&rectangle, 1);
        sides.push(&triangle, 2);
        sides.push(&[[7.0, 7.0]], 1);
        let widths = Widths::of(sides);
        for (direction, width) in [([1.0, 0.0], 4.0 + 2.0), ([0.0, 1.0], 3.0 + 4.0), ([-0.6, 0.8], 4.8 + 4.4)] {
            assert!((widths.along(direction) - width).abs() < 1e-12, "{direction:?}");
        }
        assert_eq!(Widths::default().along([1.0, 0.0]), 0.0);
    }
}
