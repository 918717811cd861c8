//! Rotations about the centroid that may map a model onto itself.

use crate::alignment::cpca;
use crate::brep::MeshFace;
use crate::geometry::principal::symmetric_eigen;
use crate::geometry::revolution::turn;
use crate::geometry::{Matrix, Vector};
use crate::stages::merge::Symmetries;
use crate::stages::parse::Parsed;

/// Faces are alike up to this share of the area, and distances up to this share of D.
const ALIKE: f64 = 1e-3;
/// Pairs of faces tried at most: as many as the two rarest kinds of real parts make, times ten.
const PAIRS: usize = 20_000;
/// Parts of a turn tried about principal axes.
const PARTS: std::ops::RangeInclusive<u32> = 2..=12;

/// Candidates, the most exact ones first; some several times.
pub(super) fn candidates(parsed: &Parsed, symmetries: &Symmetries, exact: f64) -> Vec<Matrix> {
    let mut found = of_planes(symmetries, exact);
    found.extend(of_faces(parsed));
    found.extend(of_principal_axes(parsed));
    found
}

/// The products of two mirrors.
fn of_planes(symmetries: &Symmetries, exact: f64) -> Vec<Matrix> {
    let mirrors: Vec<_> = symmetries.planes.iter().filter(|p| p.coverage >= exact).map(|p| p.plane).collect();
    let of_pair = |i: usize, j: usize| mirrors[j].reflection().rotation * mirrors[i].reflection().rotation;
    let pairs = (0..mirrors.len()).flat_map(|i| (0..mirrors.len()).map(move |j| (i, j))).filter(|(i, j)| i != j);
    pairs.take(PAIRS).map(|(i, j)| of_pair(i, j)).collect()
}

/// A kind of faces: alike in area and in their distance from the centroid.
struct Alike {
    /// From the model's centroid to the faces' centroids.
    at: Vec<Vector>,
}

/// The rotations that map two faces onto two others of their kinds.
fn of_faces(parsed: &Parsed) -> Vec<Matrix> {
    let size = parsed.measures.tolerance.size();
    let kinds = kinds(parsed);
    let Some((first, second)) = rarest(&kinds, size) else { return Vec::new() };
    let (a, b) = (first.at[0], second);
    let b_kind = kinds.iter().find(|kind| kind.at.contains(&b)).map(|kind| &kind.at[..]).unwrap_or_default();
    let apart = (a - b).norm();
    let fits = |p: &Vector, q: &Vector| ((p - q).norm() - apart).abs() <= ALIKE * size;
    let pairs = first.at.iter().flat_map(|p| b_kind.iter().map(move |q| (p, q)));
    let frame = |u: &Vector, v: &Vector| {
        let x = u.normalize();
        let z = u.cross(v).normalize();
        Matrix::from_columns(&[x, z.cross(&x), z])
    };
    let back = frame(&a, &b).transpose();
    pairs.filter(|(p, q)| fits(p, q)).take(PAIRS).map(|(p, q)| frame(p, q) * back).collect()
}

/// The faces by kind, the rarest kind first; faces in the middle of the model tell nothing.
fn kinds(parsed: &Parsed) -> Vec<Alike> {
    let size = parsed.measures.tolerance.size();
    let offset = |face: &MeshFace| face.centroid - parsed.measures.centroid;
    let mut faces: Vec<_> = parsed.mesh.faces.iter().map(|f| (f.area, offset(f).norm(), offset(f))).collect();
    faces.retain(|f| f.1 > 0.01 * size);
    faces.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut kinds = Vec::new();
    for alike in faces.chunk_by(|a, b| b.0 - a.0 <= ALIKE * b.0) {
        let mut alike = alike.to_vec();
        alike.sort_by(|a, b| a.1.total_cmp(&b.1));
        for same in alike.chunk_by(|a, b| b.1 - a.1 <= ALIKE * size) {
            kinds.push(Alike { at: same.iter().map(|f| f.2).collect() });
        }
    }
    kinds.sort_by_key(|kind| kind.at.len());
    kinds
}

/// The rarest kind, and a face of the rarest kind that is not in line with its first face and the centroid.
fn rarest(kinds: &[Alike], size: f64) -> Option<(&Alike, Vector)> {
    let tilted = |a: &Vector, b: &Vector| a.cross(b).norm() > 0.02 * size * a.norm();
    kinds.iter().find_map(|first| {
        let second = kinds.iter().flat_map(|kind| &kind.at).find(|b| tilted(&first.at[0], b))?;
        Some((first, *second))
    })
}

/// Whole parts of a turn about the principal axes of the surface.
fn of_principal_axes(parsed: &Parsed) -> Vec<Matrix> {
    let (_, axes) = symmetric_eigen(&cpca::covariance(&parsed.mesh));
    let parts = |axis: Vector| PARTS.map(move |n| turn(&axis, std::f64::consts::TAU / f64::from(n)));
    axes.into_iter().flat_map(parts).collect()
}
