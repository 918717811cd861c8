//! Tolerances: always relative to a model's size.

/// The size a model's tolerances are relative to: D = 2 max |p - centroid| with the area centroid, mm.
/// It does not change with the pose, as the paper's bounding-box diagonal does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    size: f64,
}

impl Tolerance {
    /// For a model of size `size` mm.
    pub fn of(size: f64) -> Self {
        Self { size }
    }

    /// The size D, mm.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// A share of D as a length, mm.
    pub fn length(&self, share: f64) -> f64 {
        self.size * share
    }
}
