//! Points inside a face, on a grid as fine as its curvature asks for.

use super::chart::Uv;

/// Grid nodes of one face at most.
const MAX_NODES: usize = 20_000;
/// A node this near to a segment, in cells, is left out.
const CLEARANCE: f64 = 0.4;
/// How far nodes inside are moved along u, in cells, to and fro from row to row: the corners of a rectangular cell lie
/// on a circle, and only exact arithmetic, at five times the cost, could tell which diagonal is Delaunay's.
const STAGGER: f64 = 1.0 / 64.0;

/// A grid over a rectangle of parameter space.
pub(super) struct Grid {
    rectangle: [f64; 4],
    /// Cells along u and v.
    cells: [usize; 2],
    blocked: Vec<bool>,
}

impl Grid {
    /// With the asked number of cells, fewer where that would be too many.
    pub fn new(rectangle: [f64; 4], mut cells: [usize; 2]) -> Self {
        while (cells[0] + 1) * (cells[1] + 1) > MAX_NODES {
            cells = cells.map(|n| n.div_ceil(2));
        }
        Self { rectangle, cells, blocked: vec![false; (cells[0] + 1) * (cells[1] + 1)] }
    }

    /// Rows for a surface that is straight along v: cells at most four times as long as wide, `scale` being the
    /// lengths of unit steps.
    pub fn rows_for_shape([u0, u1, v0, v1]: [f64; 4], cells: [usize; 2], scale: [f64; 2]) -> [usize; 2] {
        let width = scale[0] * (u1 - u0) / cells[0] as f64;
        let height = scale[1] * (v1 - v0) / cells[1] as f64;
        let more = |ratio: f64| if ratio.is_finite() { (0.25 * ratio).ceil().clamp(1.0, 24.0) as usize } else { 1 };
        [cells[0] * more(width / height), cells[1] * more(height / width)]
    }

    fn position(&self, axis: usize, uv: &Uv) -> f64 {
        let (from, to) = (self.rectangle[2 * axis], self.rectangle[2 * axis + 1]);
        if to > from { (uv[axis] - from) / (to - from) * self.cells[axis] as f64 } else { 0.0 }
    }

    fn index(&self, i: usize, j: usize) -> usize {
        i * (self.cells[1] + 1) + j
    }

    /// Keeps nodes away from a segment.
    pub fn block(&mut self, a: &Uv, b: &Uv) {
        let [ax, ay, bx, by] = [self.position(0, a), self.position(1, a), self.position(0, b), self.position(1, b)];
        let count = (2.0 * (bx - ax).abs().max((by - ay).abs())).ceil().clamp(1.0, 2000.0);
        for k in 0..=count as usize {
            let s = k as f64 / count;
            let (x, y) = (ax + s * (bx - ax), ay + s * (by - ay));
            let (i, j) = (x.round(), y.round());
            let outside = i < 0.0 || j < 0.0 || i > self.cells[0] as f64 || j > self.cells[1] as f64;
            if !outside && (x - i).hypot(y - j) <= CLEARANCE {
                let index = self.index(i as usize, j as usize);
                self.blocked[index] = true;
            }
        }
    }

    /// Makes opposite sides of the rectangle alike along `axis`: they are the same line of the surface.
    pub fn join_sides(&mut self, axis: usize) {
        let last = self.cells[axis];
        for k in 0..=self.cells[1 - axis] {
            let node = |at: usize| if axis == 0 { self.index(at, k) } else { self.index(k, at) };
            let (a, b) = (node(0), node(last));
            let either = self.blocked[a] || self.blocked[b];
            self.blocked[a] = either;
            self.blocked[b] = either;
        }
    }

    /// The nodes that are not blocked, column by column; `sides`: also those on the border of the rectangle.
    pub fn nodes(&self, sides: bool) -> impl Iterator<Item = Uv> + '_ {
        let [u0, u1, v0, v1] = self.rectangle;
        let at = |from: f64, to: f64, i: f64, n: usize| {
            if i == n as f64 { to } else { from + (to - from) * i / n as f64 }
        };
        // Nodes on the sides stay: opposite sides may be the same line of the surface.
        let cells = self.cells;
        let staggered =
            move |i: usize, j: usize| match (i.is_multiple_of(cells[0]) || j.is_multiple_of(cells[1]), j % 2) {
                (true, _) => i as f64,
                (false, 0) => i as f64 + STAGGER,
                (false, _) => i as f64 - STAGGER,
            };
        let inner = move |i: usize, n: usize| sides || (i > 0 && i < n);
        let columns = (0..=self.cells[0]).filter(move |&i| inner(i, self.cells[0]));
        columns.flat_map(move |i| {
            let rows = (0..=self.cells[1]).filter(move |&j| inner(j, self.cells[1]));
            let free = rows.filter(move |&j| !self.blocked[self.index(i, j)]);
            free.map(move |j| [at(u0, u1, staggered(i, j), self.cells[0]), at(v0, v1, j as f64, self.cells[1])])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_keep_away_from_segments() {
        let mut grid = Grid::new([0.0, 4.0, 0.0, 4.0], [4, 4]);
        assert_eq!(grid.nodes(false).count(), 9);
        grid.block(&[0.0, 2.1], &[4.0, 2.1]);
        assert_eq!(grid.nodes(false).count(), 6);
        grid.block(&[0.0, 0.0], &[0.0, 4.0]);
        grid.join_sides(0);
        assert_eq!(grid.nodes(true).count(), 12, "three columns of four: both sides are blocked");
    }
}
