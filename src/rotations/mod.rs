//! The rotations under which a model looks the same: its symmetries as pose estimation counts them.
//!
//! Mirror planes are no rotations, but the product of two is one; and a propeller has rotations without any mirror. All
//! rotations of a bounded body fix its area centroid, so that each is a 3 by 3 matrix. Candidates come from
//!
//! 1. pairs of mirror planes: twice the angle between them about the line in which they meet;
//! 2. faces: a rotation maps two faces that are not in line with the centroid onto two faces of equal area at equal
//!    distances, and is fixed by them; the two rarest kinds of faces are tried;
//! 3. the principal axes of the surface, by whole parts of a turn: for bodies whose faces are split unevenly.
//!
//! Each is verified by the share of the surface that it maps onto the surface, as mirror planes are; and the products
//! of those found are tried until there are no more. Bodies of revolution keep the rotation that turns them over.
//!
//! Cost: a few thousand samples for each candidate that is right, some dozens for one that is wrong. It does not
//! promise rotations by less than a degree, which no sample can tell from none.

pub mod bop;
mod candidates;

use crate::cancel::{Cancel, Cancelled};
use crate::geometry::revolution::{TURNS, turn};
use crate::geometry::{Axis, Isometry, Matrix, Point, Vector, any_perpendicular};
use crate::stages::merge::Symmetries;
use crate::stages::parse::Parsed;
use crate::stages::validate::support::SurfaceField;

/// What counts as a symmetry.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Least share of the surface that a rotation maps onto the surface.
    pub exact: f64,
    /// Samples of the surface.
    pub samples: usize,
    /// A sample lies on the surface within this share of D.
    pub on_surface: f64,
    /// Normals agree up to this angle, degrees.
    pub normal_angle_deg: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { exact: 0.995, samples: 20_000, on_surface: 0.004, normal_angle_deg: 30.0 }
    }
}

/// Rotations nearer than this are one: the Frobenius norm of their difference, about 0.6 degrees.
const SAME: f64 = 0.015;
/// More rotations than a body of real teeth has; a larger group is not closed.
const MOST: usize = 720;

/// The rotations that map a model onto itself.
#[derive(Clone, Debug, Default)]
pub struct Rotations {
    /// Without the identity; for a body of revolution without those that [`Rotations::axes`] has.
    pub discrete: Vec<Isometry>,
    /// Any turn about these maps the model onto itself: one for a body of revolution, three for a ball.
    pub axes: Vec<Axis>,
}

/// Finds the rotations of a model whose mirror planes and axes are known.
///
/// # Errors
/// Only when cancelled.
pub fn rotations(
    parsed: &Parsed,
    symmetries: &Symmetries,
    options: &Options,
    cancel: &Cancel,
) -> Result<Rotations, Cancelled> {
    let cosine = options.normal_angle_deg.to_radians().cos();
    let field = SurfaceField::new(parsed, options.samples, options.on_surface, cosine, cancel)?;
    let search = Search { parsed, field, needed: options.exact, centre: parsed.measures.centroid, cancel };
    if search.is_ball()? {
        let axes = [Vector::x(), Vector::y(), Vector::z()].map(|direction| Axis { point: search.centre, direction });
        return Ok(Rotations { discrete: Vec::new(), axes: axes.to_vec() });
    }
    for axis in &symmetries.axes {
        if search.is_axis(&axis.direction)? {
            let across = turn(&any_perpendicular(&axis.direction), std::f64::consts::PI);
            let discrete = if search.maps(&across)? { vec![search.about_centre(&across)] } else { Vec::new() };
            return Ok(Rotations { discrete, axes: vec![*axis] });
        }
    }
    let mut found = Vec::new();
    for candidate in candidates::candidates(parsed, symmetries, options.exact) {
        if is_new(&found, &candidate) && search.maps(&candidate)? {
            found.push(candidate);
        }
    }
    search.close(&mut found)?;
    found.sort_by(|a, b| in_order(a).partial_cmp(&in_order(b)).unwrap_or(std::cmp::Ordering::Equal));
    Ok(Rotations { discrete: found.iter().map(|r| search.about_centre(r)).collect(), axes: Vec::new() })
}

/// What the steps share.
struct Search<'a> {
    parsed: &'a Parsed,
    field: SurfaceField,
    needed: f64,
    centre: Point,
    cancel: &'a Cancel,
}

impl Search<'_> {
    /// The rotation about the centroid.
    fn about_centre(&self, rotation: &Matrix) -> Isometry {
        Isometry::about(&self.centre, rotation)
    }

    /// Whether the rotation maps the surface onto itself.
    fn maps(&self, rotation: &Matrix) -> Result<bool, Cancelled> {
        self.cancel.check()?;
        let isometry = self.about_centre(rotation);
        // What 500 samples say is off by 0.02 at most.
        Ok(self.field.reaches(&isometry, self.needed - 0.02).is_some()
            && self.field.support(&self.parsed.mesh, &isometry, self.cancel)?.share >= self.needed)
    }

    fn is_axis(&self, direction: &Vector) -> Result<bool, Cancelled> {
        for angle in TURNS {
            if !self.maps(&turn(direction, angle))? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn is_ball(&self) -> Result<bool, Cancelled> {
        Ok(self.parsed.measures.area > 0.0 && self.is_axis(&Vector::x())? && self.is_axis(&Vector::y())?)
    }

    /// Adds the products of those found that are right as well, until there are no more.
    fn close(&self, found: &mut Vec<Matrix>) -> Result<(), Cancelled> {
        let mut at = 0;
        while at < found.len() && found.len() < MOST {
            for i in 0..=at {
                for product in [found[at] * found[i], found[i] * found[at]] {
                    if is_new(found, &product) && self.maps(&product)? {
                        found.push(product);
                    }
                }
            }
            at += 1;
        }
        Ok(())
    }
}

/// Whether a rotation is neither the identity nor among those found.
fn is_new(found: &[Matrix], rotation: &Matrix) -> bool {
    (rotation - Matrix::identity()).norm() > SAME && found.iter().all(|other| (rotation - other).norm() > SAME)
}

/// What rotations are sorted by: the angle in steps of 1e-4 radians, then the axis.
fn in_order(rotation: &Matrix) -> (i64, [f64; 9]) {
    let cosine = (0.5 * (rotation.trace() - 1.0)).clamp(-1.0, 1.0);
    let axis = Vector::new(
        rotation[(2, 1)] - rotation[(1, 2)],
        rotation[(0, 2)] - rotation[(2, 0)],
        rotation[(1, 0)] - rotation[(0, 1)],
    );
    let mut lead = [0.0; 9];
    // Half turns have no axis of this kind: there all entries decide.
    if axis.norm() > 1e-3 {
        lead[..3].copy_from_slice(axis.normalize().as_slice());
    } else {
        lead.copy_from_slice(rotation.as_slice());
    }
    ((cosine.acos() * 1e4).round() as i64, lead.map(|c| (c * 1e6).round()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Transform;
    use crate::stages::fixture::{cuboid, prism, regular, solid};
    use crate::stages::{corner_filter, isometry, merge, pair_match, validate};

    fn found(polygons: &[Vec<Point>]) -> Rotations {
        let turned =
            Transform { linear: turn(&Vector::new(1.0, 2.0, 0.5), 0.7), translation: Vector::new(3.0, 0.0, 1.0) };
        let (parsed, cancel) = (solid(polygons, &turned), Cancel::new());
        let outlines = corner_filter::corner_filter(&parsed, &Default::default(), &cancel).unwrap();
        let matches = pair_match::pair_match(&parsed, &outlines, &Default::default(), &cancel).unwrap();
        let candidates = isometry::isometry(&parsed, &outlines, &matches, &Default::default(), &cancel).unwrap();
        let options = Default::default();
        let validated = validate::validate(&parsed, &outlines, &matches, &candidates, &options, &cancel).unwrap();
        let symmetries = merge::merge(&parsed, &outlines, &matches, &validated, &Default::default(), &cancel).unwrap();
        let found = rotations(&parsed, &symmetries, &Options::default(), &cancel).unwrap();
        for rotation in &found.discrete {
            assert!((rotation.rotation.determinant() - 1.0).abs() < 1e-9);
            assert!((rotation.apply(&parsed.measures.centroid) - parsed.measures.centroid).norm() < 1e-9);
        }
        found
    }

    #[test]
    fn a_box_turns_by_180_degrees_about_three_axes() {
        let rotations = found(&cuboid(1.0, 2.0, 4.0));
        assert_eq!((rotations.discrete.len(), rotations.axes.len()), (3, 0));
        assert!(rotations.discrete.iter().all(|r| (r.rotation.trace() + 1.0).abs() < 1e-9));
    }

    #[test]
    fn a_cube_has_23_rotations_and_a_prism_over_n_corners_2n_less_1() {
        assert_eq!(found(&cuboid(2.0, 2.0, 2.0)).discrete.len(), 23);
        for n in [3, 5, 8] {
            assert_eq!(found(&prism(&regular(n, 2.0), 1.0)).discrete.len(), 2 * n - 1, "{n}");
        }
    }

    /// A pinwheel: mirrored by its middle plane only, but turned by thirds onto itself.
    #[test]
    fn a_pinwheel_with_three_blades_has_two_rotations_without_a_mirror_along_its_axis() {
        let inner = regular(3, 1.0);
        let outer = regular(18, 3.0);
        let base: Vec<_> = (0..3).flat_map(|i| [inner[i], outer[6 * i + 3], outer[6 * i + 4]]).collect();
        let rotations = found(&prism(&base, 1.0));
        assert_eq!(rotations.discrete.len(), 2);
        assert!(rotations.discrete.iter().all(|r| r.rotation.trace().abs() < 1e-6));
    }

    #[test]
    fn a_scalene_prism_has_none() {
        assert!(found(&prism(&[[0.0, 0.0], [5.0, 0.0], [1.0, 2.0]], 3.0)).discrete.is_empty());
    }
}
