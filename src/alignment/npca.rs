//! Normal PCA (Papadakis et al. 2007): principal axes of the surface normals, weighted by area.
//!
//! The normals of a closed surface average to zero; on open sheets we keep the mean at zero as well, which makes the
//! result independent of the side that a sheet's normals point to.

use crate::brep::Mesh;
use crate::geometry::{Matrix, Vector};

use super::{principal_axes, triangles};

/// Principal axes of the normals, the direction that most area faces first.
pub fn axes(mesh: &Mesh) -> [Vector; 3] {
    principal_axes(&covariance(mesh))
}

/// Sum of S n n^T over the triangles, mm^2: along a unit vector, how much of the surface faces that way.
pub fn covariance(mesh: &Mesh) -> Matrix {
    triangles(mesh).map(|(_, normal, area)| area * normal * normal.transpose()).sum()
}
