//! The frames we compare with. Each is a function from a mesh to a [`Frame`]; raster, descriptor and distance are
//! the same for all.
//!
//! Known to `geometry` and `brep` only; stage 7 takes its fallback frames from here.

pub mod cpca;
pub mod npca;
pub mod pca;
pub mod rectilinearity;
#[cfg(test)]
pub(crate) mod shapes;

use crate::brep::Mesh;
use crate::brep::measure::Measures;
use crate::geometry::{Frame, Isometry, Matrix, Point, Vector, any_perpendicular};

/// A way to find a model's canonical frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// The dominant mirror symmetry, then the smallest projected area: the paper's method.
    Symmetry,
    /// Principal components of the vertices.
    Pca,
    /// Continuous principal components of the surface (Vranic).
    Cpca,
    /// Principal components of the surface normals.
    Npca,
    /// The file's own axes, carried along by `--random-pose`: the frame an author chose.
    File,
}

impl Method {
    /// All methods.
    pub const ALL: [Self; 5] = [Self::Symmetry, Self::Pca, Self::Cpca, Self::Npca, Self::File];

    /// The name in settings, stores and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Symmetry => "symmetry",
            Self::Pca => "pca",
            Self::Cpca => "cpca",
            Self::Npca => "npca",
            Self::File => "file",
        }
    }
}

/// The frame of a model by `method`, its origin at the area centroid (for [`Method::Symmetry`] where stage 7 put it).
///
/// `symmetry` is the frame that stage 7 found; `pose` is the motion that the model was given after reading.
pub fn frame(method: Method, mesh: &Mesh, measures: &Measures, symmetry: &Frame, pose: &Isometry) -> Frame {
    let axes = match method {
        Method::Symmetry => return *symmetry,
        Method::Pca => pca::axes(mesh),
        Method::Cpca => cpca::axes(mesh),
        Method::Npca => npca::axes(mesh),
        Method::File => [0, 1, 2].map(|i| pose.rotation.column(i).into_owned()),
    };
    Frame { axes, origin: measures.centroid }
}

/// Two eigenvalues closer than this share of the largest count as equal: rounding decides between their axes.
const EQUAL_EIGENVALUES: f64 = 1e-9;

/// The eigenvectors of a symmetric matrix, largest eigenvalue first, as the literature sorts principal axes.
///
/// Equal eigenvalues leave axes undefined; then the missing ones are fixed by the coordinate axes, so that the
/// result is a total function of the matrix.
pub(crate) fn principal_axes(covariance: &Matrix) -> [Vector; 3] {
    let fallback = [Vector::x(), Vector::y(), Vector::z()];
    if !covariance.iter().all(|c| c.is_finite()) {
        return fallback;
    }
    let eigen = covariance.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| eigen.eigenvalues[j].total_cmp(&eigen.eigenvalues[i]).then(i.cmp(&j)));
    let [a, b, c] = order.map(|i| eigen.eigenvectors.column(i).into_owned());
    let [la, lb, lc] = order.map(|i| eigen.eigenvalues[i]);
    let equal = |p: f64, q: f64| p - q <= EQUAL_EIGENVALUES * la.abs();
    match (equal(la, lb), equal(lb, lc)) {
        (true, true) => fallback,
        (true, false) => [any_perpendicular(&c), c.cross(&any_perpendicular(&c)), c],
        (false, true) => [a, any_perpendicular(&a), a.cross(&any_perpendicular(&a))],
        (false, false) => [a, b, c],
    }
}

/// The triangles of a mesh that have an area: corners, unit normal, area.
pub(crate) fn triangles(mesh: &Mesh) -> impl Iterator<Item = ([Point; 3], Vector, f64)> + '_ {
    (0..mesh.triangles.len()).filter_map(|t| {
        let doubled = mesh.doubled_normal(t);
        let length = doubled.norm();
        (length > 0.0 && length.is_finite()).then(|| (mesh.corners(t), doubled / length, 0.5 * length))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_eigenvalues_are_settled_by_the_coordinate_axes() {
        assert_eq!(principal_axes(&Matrix::identity()), [Vector::x(), Vector::y(), Vector::z()]);
        let flat = principal_axes(&Matrix::from_diagonal(&Vector::new(2.0, 1.0, 2.0)));
        assert!(flat[2].y.abs() > 1.0 - 1e-12);
        assert!(flat[0].dot(&flat[1]).abs() < 1e-12 && flat[0].dot(&flat[2]).abs() < 1e-12);
    }

    #[test]
    fn the_file_frame_turns_with_the_pose() {
        let mesh = shapes::cuboid(1.0, 2.0, 4.0);
        let measures = shapes::measures(&mesh);
        let turn = shapes::rotation(0.3, 1.0, -0.4);
        let pose = Isometry {
            rotation: turn,
            translation: Vector::new(1.0, 2.0, 3.0),
            chirality: crate::geometry::Chirality::Proper,
        };
        let own = Frame { axes: [Vector::x(), Vector::y(), Vector::z()], origin: Point::origin() };
        let found = frame(Method::File, &mesh, &measures, &own, &pose);
        assert!((found.axes[2] - turn * Vector::z()).norm() < 1e-15);
    }

    #[test]
    fn the_three_pcas_of_a_cuboid_are_its_sides_in_every_pose() {
        let turn = shapes::rotation(0.7, -0.2, 2.0);
        let mesh = shapes::turned(&shapes::cuboid(1.0, 2.0, 4.0), &turn);
        let column = |i: usize| turn.column(i).into_owned();
        for (axes, expected) in
            [(pca::axes(&mesh), [2, 1, 0]), (cpca::axes(&mesh), [2, 1, 0]), (npca::axes(&mesh), [0, 1, 2])]
        {
            for (axis, side) in axes.iter().zip(expected) {
                assert!(axis.dot(&column(side)).abs() > 1.0 - 1e-12);
            }
        }
    }
}
