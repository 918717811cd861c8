//! PCA of vertices, the baseline of the paper's figures 1 and 6.
//!
//! The vertices are the distinct points of the tessellation: what a user gets who exports the model as a mesh and
//! runs PCA on it, as the mesh-retrieval literature does. B-rep vertices would be a worse reading: a ball has none
//! or two, a full cylinder two on one generator, so that most machined parts would have no principal axes at all.
//! Points on an edge are stored once for each adjoining face and count once here. How densely curved faces are
//! tessellated sways the result; that is this baseline's known weakness, not ours to mend.

use rustc_hash::FxHashSet;

use crate::brep::Mesh;
use crate::geometry::{Matrix, Point, Vector, isometry::mean};

use super::principal_axes;

/// Principal axes of the distinct mesh points, largest variance first.
pub fn axes(mesh: &Mesh) -> [Vector; 3] {
    let points = distinct(&mesh.points);
    let centre = mean(&points);
    let covariance: Matrix = points.iter().map(|p| (p - centre) * (p - centre).transpose()).sum();
    principal_axes(&covariance)
}

/// The points without repetitions, sorted.
fn distinct(points: &[Point]) -> Vec<Point> {
    // Two of three are repetitions: sorting costs more than to leave them out first.
    let mut seen = FxHashSet::with_capacity_and_hasher(points.len() / 2, Default::default());
    let is_new = |p: &&Point| seen.insert((p.x.to_bits(), p.y.to_bits(), p.z.to_bits()));
    let mut points: Vec<_> = points.iter().filter(is_new).copied().collect();
    points.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z)));
    points.dedup();
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_shared_by_faces_counts_once() {
        let p = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]].map(Point::from);
        assert_eq!(distinct(&p).len(), 2);
    }
}
