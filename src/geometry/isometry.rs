//! Isometries with their handedness, and the best one between two point sets.

use super::{Matrix, Plane, Point, Transform, Vector};

/// Whether an isometry keeps left and right (`Proper`: rotations, translations) or swaps them (`Improper`: mirrors).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Chirality {
    /// Keeps left and right.
    Proper,
    /// Swaps them.
    Improper,
}

/// p -> rotation * p + translation; the determinant of `rotation` is 1 or -1 as the chirality says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Isometry {
    /// Orthogonal.
    pub rotation: Matrix,
    /// mm.
    pub translation: Vector,
    /// Whether `rotation` turns or mirrors.
    pub chirality: Chirality,
}

impl Isometry {
    /// The reflection in `plane`: a Householder matrix.
    pub fn reflection(plane: &Plane) -> Self {
        let n = plane.normal;
        Self {
            rotation: Matrix::identity() - 2.0 * n * n.transpose(),
            translation: n * (2.0 * plane.offset),
            chirality: Chirality::Improper,
        }
    }

    /// A rotation that keeps a point in place.
    pub fn about(point: &Point, rotation: &Matrix) -> Self {
        let translation = point.coords - rotation * point.coords;
        Self { rotation: *rotation, translation, chirality: Chirality::Proper }
    }

    /// Whether it maps every image back to where that came from, up to `tolerance` (mm): reflections do, and half turns.
    pub fn is_involution(&self, tolerance: f64) -> bool {
        let there_and_back = self.rotation * self.translation + self.translation;
        (self.rotation - self.rotation.transpose()).amax() <= 1e-12 && there_and_back.norm() <= tolerance
    }

    /// The image of a point.
    pub fn apply(&self, p: &Point) -> Point {
        Point::from(self.rotation * p.coords + self.translation)
    }

    /// The same map as a similarity.
    pub fn as_transform(&self) -> Transform {
        Transform { linear: self.rotation, translation: self.translation }
    }

    /// The rotation and shift that takes `from` to `to` where it does so within `tolerance` (mm), by three of the points
    /// far apart. `None` also for nearly collinear points.
    pub fn exact(from: &[Point], to: &[Point], tolerance: f64) -> Option<Self> {
        let corners = spanning(from)?;
        let [a, b] = [from, to].map(|points| frame(&corners.map(|i| points[i])));
        let rotation = b? * a?.transpose();
        let translation = to[corners[0]].coords - rotation * from[corners[0]].coords;
        let moved = Self { rotation, translation, chirality: Chirality::Proper };
        from.iter().zip(to).all(|(p, q)| (moved.apply(p) - q).norm_squared() <= tolerance * tolerance).then_some(moved)
    }

    /// The isometry of the asked chirality that takes `from` to `to` with the least squared error, scale 1
    /// (Umeyama 1991, the paper's section IV.C), and its mean squared residual, mm^2.
    ///
    /// `None` for fewer than three pairs or collinear points.
    pub fn fit(from: &[Point], to: &[Point], chirality: Chirality) -> Option<(Self, f64)> {
        let n = from.len();
        if n < 3 || n != to.len() {
            return None;
        }
        let (a, b) = (mean(from), mean(to));
        let covariance = from.iter().zip(to).map(|(p, q)| (q - b) * (p - a).transpose()).sum::<Matrix>();
        let svd = covariance.svd(true, true);
        let (u, v_t) = (svd.u?, svd.v_t?);
        let (first, second) = (svd.singular_values[0], svd.singular_values[1]);
        if second <= 1e-9 * first || !first.is_finite() {
            return None;
        }
        let wanted = if chirality == Chirality::Proper { 1.0 } else { -1.0 };
        let sign = wanted * (u * v_t).determinant().signum();
        let mut diagonal = Vector::new(1.0, 1.0, 1.0);
        diagonal.z = sign;
        let rotation = u * Matrix::from_diagonal(&diagonal) * v_t;
        let translation = b.coords - rotation * a.coords;
        let fitted = Self { rotation, translation, chirality };
        let squared = from.iter().zip(to).map(|(p, q)| (fitted.apply(p) - q).norm_squared()).sum::<f64>();
        Some((fitted, squared / n as f64))
    }
}

/// Points no farther from a line than this share of their length leave a turn about it open.
const COLLINEAR: f64 = 1e-4;

/// The first point, the one farthest from it, and the one farthest from the line through both.
fn spanning(points: &[Point]) -> Option<[usize; 3]> {
    let first = *points.first()?;
    let farthest = |distance: &dyn Fn(&Point) -> f64| {
        (0..points.len()).max_by(|&i, &j| distance(&points[i]).total_cmp(&distance(&points[j])))
    };
    let second = farthest(&|p| (p - first).norm_squared())?;
    let along = points[second] - first;
    let from_line = |p: &Point| (p - first).cross(&along).norm_squared();
    let third = farthest(&from_line)?;
    let spans = from_line(&points[third]) > COLLINEAR.powi(2) * along.norm_squared().powi(2);
    spans.then_some([0, second, third])
}

/// Right-handed axes: from the first point to the second, and to the third at right angles.
fn frame([a, b, c]: &[Point; 3]) -> Option<Matrix> {
    let x = (b - a).try_normalize(0.0)?;
    let z = x.cross(&(c - a)).try_normalize(0.0)?;
    Some(Matrix::from_columns(&[x, z.cross(&x), z]))
}

/// The mean of the points.
pub fn mean(points: &[Point]) -> Point {
    let sum: Vector = points.iter().map(|p| p.coords).sum();
    Point::from(sum / points.len().max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners() -> Vec<Point> {
        [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]].map(Point::from).to_vec()
    }

    #[test]
    fn a_mirror_is_improper() {
        let plane = Plane::through(&Point::new(5.0, 1.0, 0.0), &Vector::new(1.0, 2.0, 3.0));
        let images: Vec<_> = corners().iter().map(|p| plane.reflect(p)).collect();
        let (fitted, residual) = Isometry::fit(&corners(), &images, Chirality::Improper).unwrap();
        assert!(residual < 1e-20);
        assert!((fitted.rotation - plane.reflection().rotation).norm() < 1e-12);
        assert!((fitted.translation - plane.reflection().translation).norm() < 1e-12);
        let (_, proper) = Isometry::fit(&corners(), &images, Chirality::Proper).unwrap();
        assert!(proper > 0.01);
    }

    #[test]
    fn reflections_and_half_turns_map_images_back() {
        let plane = Plane::through(&Point::new(5.0, 1.0, 0.0), &Vector::new(1.0, 2.0, 3.0));
        let mirror = plane.reflection();
        let glide = Isometry { translation: mirror.translation + Vector::new(2.0, -1.0, 0.0), ..mirror };
        let turn = |degrees: f64| {
            let turned = crate::geometry::revolution::turn(&Vector::z(), degrees.to_radians());
            Isometry::about(&Point::new(1.0, 2.0, 3.0), &turned)
        };
        assert_eq!([mirror, glide, turn(180.0), turn(90.0)].map(|i| i.is_involution(1e-9)), [true, false, true, false]);
    }

    #[test]
    fn what_is_turned_exactly_needs_no_fit() {
        let turned = crate::geometry::revolution::turn(&Vector::new(0.6, 0.0, 0.8), 1.0);
        let moved = Isometry::about(&Point::new(4.0, 0.0, 1.0), &turned);
        let mut images: Vec<_> = corners().iter().map(|p| moved.apply(p)).collect();
        let exact = Isometry::exact(&corners(), &images, 1e-12).unwrap();
        assert!((exact.rotation - turned).amax() < 1e-12 && (exact.translation - moved.translation).amax() < 1e-12);
        images[3].x += 1e-6;
        assert!(Isometry::exact(&corners(), &images, 1e-7).is_none());
        let mirrored: Vec<_> = corners().iter().map(|p| Point::new(-p.x, p.y, p.z)).collect();
        assert!(Isometry::exact(&corners(), &mirrored, 1e-7).is_none());
    }

    #[test]
    fn coplanar_corners_have_both_solutions() {
        let flat: Vec<_> = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 2.0, 0.0]].map(Point::from).to_vec();
        let moved: Vec<_> = flat.iter().map(|p| p + Vector::new(1.0, 1.0, 1.0)).collect();
        for chirality in [Chirality::Proper, Chirality::Improper] {
            assert!(Isometry::fit(&flat, &moved, chirality).unwrap().1 < 1e-20);
        }
    }

    #[test]
    fn collinear_points_have_no_isometry() {
        let line: Vec<_> = (0..4).map(|i| Point::new(i as f64, 0.0, 0.0)).collect();
        assert!(Isometry::fit(&line, &line, Chirality::Proper).is_none());
        assert!(Isometry::exact(&line, &line, 1e-9).is_none());
    }
}
