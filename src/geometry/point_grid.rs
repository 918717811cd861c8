//! Points by the cell of a grid that they are in, to find those near a place.

use rustc_hash::FxHashMap;

use super::Point;
use super::cells::floor;

/// Ends a chain.
const END: u32 = u32::MAX;

/// Points under their numbers, in cubic cells. Building is linear in the points, a look-up in those of a few cells.
#[derive(Clone, Debug)]
pub struct PointGrid {
    points: Vec<Point>,
    /// In the middle of a cell; near the points, wherever the model lies.
    origin: Point,
    /// Cells to the mm.
    per_mm: f64,
    /// The first point of each cell ..
    first: FxHashMap<[i32; 3], u32>,
    /// .. and the next one in the cell of each point.
    next: Vec<u32>,
}

impl PointGrid {
    /// The grid of `points`, with cells this wide: best a few times the radius that is asked for.
    pub fn new(points: impl IntoIterator<Item = Point>, width: f64) -> Self {
        let points: Vec<_> = points.into_iter().collect();
        let next = vec![END; points.len()];
        let origin = points.first().copied().unwrap_or_default();
        let mut grid = Self { points, origin, per_mm: 1.0 / width, first: FxHashMap::default(), next };
        // From the last, so that chains grow.
        for i in (0..grid.points.len()).rev() {
            let cell = grid.cell(&grid.points[i], 0.0);
            grid.next[i] = grid.first.insert(cell, i as u32).unwrap_or(END);
        }
        grid
    }

    #[inline]
    fn cell(&self, p: &Point, shift: f64) -> [i32; 3] {
        std::array::from_fn(|i| floor((p[i] - self.origin[i] + shift) * self.per_mm + 0.5))
    }

    /// The numbers of the points within `radius` of `p`, cell by cell and in growing order in each.
    pub fn near(&self, p: &Point, radius: f64) -> impl Iterator<Item = u32> {
        let (low, high) = (self.cell(p, -radius), self.cell(p, radius));
        let count: [usize; 3] = std::array::from_fn(|i| (i64::from(high[i]) - i64::from(low[i]) + 1) as usize);
        // Mostly one: then nothing is divided.
        let cells = (0..count.iter().product()).map(move |n| {
            let (xy, z) = if n == 0 { (0, 0) } else { (n / count[2], n % count[2]) };
            let (x, y) = if xy == 0 { (0, 0) } else { (xy / count[1], xy % count[1]) };
            [low[0] + x as i32, low[1] + y as i32, low[2] + z as i32]
        });
        let chain = move |cell| {
            let first = self.first.get(&cell).copied();
            std::iter::successors(first, |&i| Some(self.next[i as usize]).filter(|&next| next != END))
        };
        let p = *p;
        cells.flat_map(chain).filter(move |&i| (self.points[i as usize] - p).norm_squared() <= radius * radius)
    }

    /// A point by its number.
    pub fn point(&self, number: u32) -> &Point {
        &self.points[number as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_within_the_radius_are_found_across_cells() {
        let points = (0..10).map(|i| Point::new(f64::from(i) * 0.5, 0.0, -0.1));
        let grid = PointGrid::new(points, 0.7);
        let mut found: Vec<_> = grid.near(&Point::new(2.1, 0.0, 0.1), 0.7).collect();
        found.sort_unstable();
        // 0.2 aside: up to 0.67 along x, from 1.43 to 2.77.
        assert_eq!(found, [3, 4, 5]);
        assert_eq!(grid.near(&Point::new(9.0, 0.0, 0.0), 0.7).count(), 0);
        assert_eq!(grid.point(4).x, 2.0);
    }
}
