//! Sets of directions, coarse: 54 cells of the sphere, one bit each, so that what faces the wrong way is passed over
//! without a look.

use std::f64::consts::PI;
use std::sync::LazyLock;

use super::Vector;

/// The cells on a side of the cube are parted here, at 15 degrees from the middle: directions along the axes, by far
/// the most frequent, are in the middles of theirs.
const PARTED: f64 = 0.267_949_192_431_122_7;
/// Cells: nine on each side of a cube.
const CELLS: usize = 54;

/// A set of directions: a bit for each cell.
pub type Sides = u64;

/// All directions.
pub const ALL: Sides = u64::MAX;

/// The cell of a direction (of any length but zero).
pub fn cell(direction: &Vector) -> usize {
    let [x, y, z] = [direction.x, direction.y, direction.z];
    let (side, main, u, v) = match [x.abs(), y.abs(), z.abs()] {
        [a, b, c] if a >= b && a >= c => (0, x, y, z),
        [_, b, c] if b >= c => (1, y, z, x),
        _ => (2, z, x, y),
    };
    let edge = PARTED * main.abs();
    let third = |c: f64| 1 + usize::from(c > edge) - usize::from(c < -edge);
    9 * (2 * side + usize::from(main < 0.0)) + 3 * third(u) + third(v)
}

/// The set with one direction's cell.
pub fn of(direction: &Vector) -> Sides {
    1 << cell(direction)
}

/// For each cell, the cells that hold directions within an angle of some direction in it.
#[derive(Clone, Debug)]
pub struct Neighbours([Sides; CELLS]);

impl Neighbours {
    /// Of directions that form an angle of at least this cosine; with `both`, of their opposites too.
    pub fn within(cosine: f64, both: bool) -> Self {
        let angle = cosine.clamp(-1.0, 1.0).acos() + 1e-6;
        let near = |i: usize, j: usize| {
            let Gap { same, opposite } = GAPS[i][j];
            same <= angle || (both && opposite <= angle)
        };
        Self(std::array::from_fn(|i| (0..CELLS).filter(|&j| near(i, j)).fold(0, |set, j| set | 1 << j)))
    }

    /// A set that holds all directions within the angle of this one, and more.
    pub fn of(&self, direction: &Vector) -> Sides {
        self.0[cell(direction)]
    }
}

/// Angles between the nearest directions of two cells, and of one and the opposite of the other; below 0 where they may
/// be equal.
#[derive(Clone, Copy)]
struct Gap {
    same: f64,
    opposite: f64,
}

/// Those of all cells.
static GAPS: LazyLock<[[Gap; CELLS]; CELLS]> = LazyLock::new(|| {
    let cones: [_; CELLS] = std::array::from_fn(cone);
    let gap = |(a, r): &(Vector, f64), (b, s): &(Vector, f64)| {
        let apart = a.dot(b).clamp(-1.0, 1.0).acos();
        Gap { same: apart - r - s, opposite: PI - apart - r - s }
    };
    std::array::from_fn(|i| std::array::from_fn(|j| gap(&cones[i], &cones[j])))
});

/// The middle of a cell and the angle from there to its farthest corner.
fn cone(cell: usize) -> (Vector, f64) {
    let bounds = [-1.0, -PARTED, PARTED, 1.0];
    let main = if (cell / 9).is_multiple_of(2) { 1.0 } else { -1.0 };
    let (i, j) = (cell % 9 / 3, cell % 3);
    let corner = |k: usize| {
        let mut d = Vector::zeros();
        d[cell / 18] = main;
        d[(cell / 18 + 1) % 3] = bounds[i + k % 2];
        d[(cell / 18 + 2) % 3] = bounds[j + k / 2];
        d.normalize()
    };
    let corners: [_; 4] = std::array::from_fn(corner);
    let middle = corners.iter().sum::<Vector>().normalize();
    let farthest = corners.iter().map(|c| c.dot(&middle)).fold(1.0, f64::min);
    (middle, farthest.acos())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Directions all over the sphere, along the axes and the cells' edges too.
    fn directions() -> Vec<Vector> {
        let steps = [-1.0, -0.7, -PARTED, -0.1, 0.0, 0.2, PARTED, 0.9, 1.0];
        let all = steps.iter().flat_map(|&x| steps.iter().flat_map(move |&y| steps.map(|z| Vector::new(x, y, z))));
        all.filter_map(|d| d.try_normalize(1e-9)).collect()
    }

    #[test]
    fn a_direction_is_in_the_cone_of_its_cell() {
        for d in directions() {
            let (middle, radius) = cone(cell(&d));
            assert!(d.dot(&middle) >= radius.cos() - 1e-9, "{d}");
        }
    }

    #[test]
    fn neighbours_hold_all_that_is_within_the_angle() {
        let cosine = 30f64.to_radians().cos();
        let (one, both) = (Neighbours::within(cosine, false), Neighbours::within(cosine, true));
        for a in directions() {
            for b in directions() {
                assert!(a.dot(&b) < cosine || one.of(&a) & of(&b) != 0);
                assert!(a.dot(&b).abs() < cosine || both.of(&a) & of(&b) != 0);
            }
        }
    }

    #[test]
    fn directions_along_other_axes_are_passed_over() {
        let near = Neighbours::within(30f64.to_radians().cos(), false);
        assert_eq!(near.of(&Vector::z()) & (of(&Vector::x()) | of(&-Vector::y()) | of(&-Vector::z())), 0);
    }
}
