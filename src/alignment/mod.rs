//! The frames we compare with. Each is a function from a mesh to a [`Frame`]; raster, descriptor and distance are
//! the same for all.
//!
//! Known to `geometry` and `brep` only; stage 7 takes its fallback frames from here.

pub mod cpca;
mod hull;
pub mod mbb;
pub mod mpa;
pub mod npca;
pub mod pca;
pub mod prst;
pub mod rectilinearity;
#[cfg(test)]
pub(crate) mod shapes;

use crate::brep::Mesh;
use crate::brep::measure::Measures;
use crate::cancel::{Cancel, Cancelled};
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
    /// The bounding box of least volume.
    Mbb,
    /// The frame in which the faces are most nearly along the axes (Lian).
    Rectilinearity,
    /// The directions of least projected area (Johan).
    Mpa,
    /// The principal axes of the planar-reflective symmetry transform (Podolak).
    Prst,
}

impl Method {
    /// All methods.
    pub const ALL: [Self; 9] = [
        Self::Symmetry,
        Self::Pca,
        Self::Cpca,
        Self::Npca,
        Self::File,
        Self::Mbb,
        Self::Rectilinearity,
        Self::Mpa,
        Self::Prst,
    ];

    /// What a run computes where nothing else is asked for: the paper's comparison and the authors' poses. The others
    /// cost more than the rest of the method together.
    pub const USUAL: [Self; 5] = [Self::Symmetry, Self::Pca, Self::Cpca, Self::Npca, Self::File];

    /// The name in settings, stores and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Symmetry => "symmetry",
            Self::Pca => "pca",
            Self::Cpca => "cpca",
            Self::Npca => "npca",
            Self::File => "file",
            Self::Mbb => "mbb",
            Self::Rectilinearity => "rectilinearity",
            Self::Mpa => "mpa",
            Self::Prst => "prst",
        }
    }
}

/// What frames are made from beside the mesh.
pub struct Given<'a> {
    /// Of the mesh: the centroid is the origin, D the unit of tolerances.
    pub measures: &'a Measures,
    /// The frame that stage 7 found.
    pub symmetry: &'a Frame,
    /// The motion that the model was given after reading.
    pub pose: &'a Isometry,
    /// Measures projected areas.
    pub shadows: &'a mpa::Shadows<'a>,
}

/// The frame of a model by `method`, its origin at the area centroid (for [`Method::Symmetry`] where stage 7 put it).
pub fn frame(method: Method, mesh: &Mesh, given: &Given, cancel: &Cancel) -> Result<Frame, Cancelled> {
    let measures = given.measures;
    let axes = match method {
        Method::Symmetry => return Ok(*given.symmetry),
        Method::Pca => pca::axes(mesh),
        Method::Cpca => cpca::axes(mesh),
        Method::Npca => npca::axes(mesh),
        Method::File => [0, 1, 2].map(|i| given.pose.rotation.column(i).into_owned()),
        Method::Mbb => mbb::axes(mesh, measures.tolerance.size(), cancel)?,
        Method::Rectilinearity => rectilinearity::rectilinearity(mesh).axes,
        Method::Mpa => mpa::axes(mesh, given.shadows, cancel)?,
        Method::Prst => prst::axes(mesh, measures, cancel)?,
    };
    Ok(Frame { axes, origin: measures.centroid })
}

/// Axes in order of falling `keys`; of keys that differ by less than `tie` (a share of the larger one), the axis
/// along which the surface varies more comes first.
pub(crate) fn ordered(mesh: &Mesh, axes: [Vector; 3], keys: [f64; 3], tie: f64) -> [Vector; 3] {
    let covariance = cpca::covariance(mesh);
    let variance = |i: usize| axes[i].dot(&(covariance * axes[i]));
    let mut left = vec![0, 1, 2];
    let mut next = || {
        let most = left.iter().map(|&i| keys[i]).fold(f64::NEG_INFINITY, f64::max);
        let tied = (0..left.len()).filter(|&at| keys[left[at]] >= most - tie * most.abs());
        let first = tied.max_by(|&a, &b| variance(left[a]).total_cmp(&variance(left[b]))).unwrap_or(0);
        axes[left.remove(first)]
    };
    [next(), next(), next()]
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
    (0..mesh.triangles.len()).filter_map(|t| triangle(mesh, t))
}

/// One of them, if it has an area.
fn triangle(mesh: &Mesh, t: usize) -> Option<([Point; 3], Vector, f64)> {
    let corners = mesh.corners(t);
    let doubled = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
    let length = doubled.norm();
    (length > 0.0 && length.is_finite()).then(|| (corners, doubled / length, 0.5 * length))
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
        let symmetry = Frame { axes: [Vector::x(), Vector::y(), Vector::z()], origin: Point::origin() };
        let given = Given { measures: &measures, symmetry: &symmetry, pose: &pose, shadows: &|_, _, _| Err(Cancelled) };
        let found = frame(Method::File, &mesh, &given, &Cancel::new()).unwrap();
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
