//! Axis-aligned bounding boxes.

use super::Point;

/// The smallest box with sides along the coordinate axes that holds all points added; empty at first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The least coordinates, mm.
    pub min: Point,
    /// The greatest coordinates, mm.
    pub max: Point,
}

impl Default for Aabb {
    fn default() -> Self {
        Self { min: Point::from([f64::INFINITY; 3]), max: Point::from([f64::NEG_INFINITY; 3]) }
    }
}

impl Aabb {
    /// The box of `points`.
    pub fn of<'a>(points: impl IntoIterator<Item = &'a Point>) -> Self {
        let mut aabb = Self::default();
        points.into_iter().for_each(|p| aabb.add(p));
        aabb
    }

    /// Grows to hold `p`.
    pub fn add(&mut self, p: &Point) {
        self.min = self.min.inf(p);
        self.max = self.max.sup(p);
    }

    /// Grows to hold `other`.
    pub fn join(&mut self, other: &Self) {
        self.min = self.min.inf(&other.min);
        self.max = self.max.sup(&other.max);
    }

    /// True when nothing was added.
    pub fn is_empty(&self) -> bool {
        self.min.x > self.max.x
    }

    /// Length of the diagonal, mm; 0 when empty.
    pub fn diagonal(&self) -> f64 {
        if self.is_empty() { 0.0 } else { (self.max - self.min).norm() }
    }

    /// The middle of the box.
    pub fn centre(&self) -> Point {
        nalgebra::center(&self.min, &self.max)
    }
}
