//! Similarities: how an occurrence lies in its assembly.

use super::{Matrix, Point, Vector};

/// p -> linear * p + translation, where `linear` is an orthogonal matrix times a factor.
///
/// A STEP placement is rigid; a Cartesian transformation operator may also scale or mirror.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// An orthogonal matrix times a factor.
    pub linear: Matrix,
    /// mm.
    pub translation: Vector,
}

impl Transform {
    /// Nothing moves.
    pub fn identity() -> Self {
        Self { linear: Matrix::identity(), translation: Vector::zeros() }
    }

    /// From the axes (columns of the linear part) and the origin of a placement.
    pub fn from_axes(origin: &Point, x: &Vector, y: &Vector, z: &Vector) -> Self {
        Self { linear: Matrix::from_columns(&[*x, *y, *z]), translation: origin.coords }
    }

    /// The image of a point.
    pub fn point(&self, p: &Point) -> Point {
        Point::from(self.linear * p.coords + self.translation)
    }

    /// The image of a vector (lengths scale).
    pub fn vector(&self, v: &Vector) -> Vector {
        self.linear * v
    }

    /// The image of a unit direction, of length 1 again.
    pub fn direction(&self, v: &Vector) -> Vector {
        (self.linear * v).normalize()
    }

    /// First `inner`, then `self`.
    pub fn after(&self, inner: &Self) -> Self {
        Self { linear: self.linear * inner.linear, translation: self.linear * inner.translation + self.translation }
    }

    /// The way back; `None` where the linear part is singular.
    pub fn inverse(&self) -> Option<Self> {
        let linear = self.linear.try_inverse()?;
        Some(Self { linear, translation: -(linear * self.translation) })
    }

    /// The factor by which lengths grow.
    pub fn scale(&self) -> f64 {
        self.linear.determinant().abs().cbrt()
    }

    /// True where left and right are swapped, which turns surface normals inside out.
    pub fn mirrors(&self) -> bool {
        self.linear.determinant() < 0.0
    }
}
