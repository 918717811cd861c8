//! Planes found again by nearness, in constant time.

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use super::cells::floor;
use super::{Plane, Point};

/// Width of a cell of normal components.
const NORMAL_CELL: f64 = 0.05;

/// Planes in a hash table of quantised normals and distances from a reference point.
#[derive(Clone, Debug)]
pub struct PlaneIndex {
    reference: Point,
    /// Largest angle between planes that count as one, radians, and its tangent.
    angle: f64,
    tangent: f64,
    /// Largest distance of the reference point's feet along the normal, mm.
    distance: f64,
    /// Cells to the mm of distance.
    per_mm: f64,
    planes: Vec<Plane>,
    cells: FxHashMap<[i32; 4], SmallVec<[u32; 2]>>,
}

impl PlaneIndex {
    /// An empty index; planes are one within `angle` (radians, below 0.05) and `distance` (mm, above 0) as seen from
    /// `reference`.
    pub fn new(reference: Point, angle: f64, distance: f64) -> Self {
        let per_mm = 1.0 / (8.0 * distance);
        let (planes, cells) = (Vec::new(), FxHashMap::default());
        Self { reference, angle, tangent: angle.tan(), distance, per_mm, planes, cells }
    }

    /// The planes in the order in which they came.
    pub fn planes(&self) -> &[Plane] {
        &self.planes
    }

    /// Whether two planes are one.
    pub fn same(&self, a: &Plane, b: &Plane) -> bool {
        let cosine = a.normal.dot(&b.normal);
        let (s, t) = (a.signed_distance(&self.reference), cosine.signum() * b.signed_distance(&self.reference));
        (s - t).abs() <= self.distance && a.normal.cross(&b.normal).norm() <= self.tangent * cosine.abs()
    }

    /// Position of the first plane that is the same as this one.
    pub fn find(&self, plane: &Plane) -> Option<usize> {
        let at = self.coordinates(plane);
        let slack = [self.angle, self.angle, self.angle, self.distance];
        let range = |i: usize| self.cell(i, at[i] - slack[i])..=self.cell(i, at[i] + slack[i]);
        let mut best: Option<u32> = None;
        for x in range(0) {
            for y in range(1) {
                for z in range(2) {
                    for d in range(3) {
                        let cell = self.cells.get(&[x, y, z, d]).into_iter().flatten();
                        let same = cell.copied().find(|&i| self.same(&self.planes[i as usize], plane));
                        best = best.into_iter().chain(same).min();
                    }
                }
            }
        }
        best.map(|i| i as usize)
    }

    /// Adds a plane and returns its position.
    pub fn add(&mut self, plane: Plane) -> usize {
        let index = self.planes.len() as u32;
        self.planes.push(plane);
        for side in [plane, Plane { normal: -plane.normal, offset: -plane.offset }] {
            let at = self.coordinates(&side);
            let key = std::array::from_fn(|i| self.cell(i, at[i]));
            self.cells.entry(key).or_default().push(index);
        }
        index as usize
    }

    fn coordinates(&self, plane: &Plane) -> [f64; 4] {
        let n = plane.normal;
        [n.x, n.y, n.z, plane.signed_distance(&self.reference)]
    }

    fn cell(&self, i: usize, x: f64) -> i32 {
        let per_unit = if i < 3 { 1.0 / NORMAL_CELL } else { self.per_mm };
        // Normals along the axes, by far the most frequent, have components in the middle of their cells.
        floor(x * per_unit + 0.5)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vector;

    #[test]
    fn planes_are_found_with_either_normal() {
        let mut index = PlaneIndex::new(Point::new(1.0, 1.0, 1.0), 0.01, 0.1);
        let planes: Vec<_> = (0..50)
            .map(|i| {
                let angle = f64::from(i) * 0.06;
                Plane::through(&Point::new(f64::from(i), 0.0, 0.0), &Vector::new(angle.cos(), angle.sin(), 0.2))
            })
            .collect();
        for (i, plane) in planes.iter().enumerate() {
            assert_eq!(index.find(plane), None);
            assert_eq!(index.add(*plane), i);
        }
        for (i, plane) in planes.iter().enumerate() {
            let moved = Plane { normal: -plane.normal, offset: -plane.offset + 0.09 };
            assert_eq!(index.find(&moved), Some(i));
            assert_eq!(index.find(&Plane { normal: -plane.normal, offset: -plane.offset + 0.11 }), None);
        }
    }
}
