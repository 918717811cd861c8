//! Planes across the principal axes of the surface and of its normals, polished on the surface.
//!
//! The normal of a symmetry plane is a principal axis. Where two or three principal axes are open (an n-fold body, a
//! cube), all directions between them are tried roughly, for a body of one closed face has nothing else to speak for its
//! planes.

use super::open::Open;
use super::{COARSE_ERROR, Merger, SymmetryPlane};
use crate::alignment::npca;
use crate::brep::sample::Sample;
use crate::cancel::Cancelled;
use crate::geometry::principal::symmetric_eigen;
use crate::geometry::{Matrix, Plane, Vector, any_perpendicular};
use crate::stages::isometry::Source;
use crate::stages::validate::support::Round;

/// Eigenvalues closer than this (as a share of the larger) leave their vectors open: those depend on the pose.
const DISTINCT: f64 = 1e-3;
/// Eigenvalues closer than this may be equal: what triangles miss of round bodies.
const OPEN: f64 = 0.03;
/// A plane this near (radians, share of D) to one already known is not polished: exact planes only get worse.
const KNOWN: (f64, f64) = (0.035, 0.01);
/// Radii of the rounds of polishing, as shares of D: wide first and with every eighth sample of the first round only,
/// to be caught, ..
const CATCH: [(f64, usize); 7] = [(0.04, 8), (0.04, 8), (0.03, 8), (0.02, 1), (0.015, 1), (0.01, 1), (0.006, 1)];
/// .. then tight, with every eighth and every fourth sample of two rounds.
const TIGHTEN: [(f64, usize); 2] = [(0.006, 8), (0.004, 4)];
/// A step by less than this (radians and share of D together) ends the catching.
const STILL: f64 = 1e-4;
/// What a plane may be below the best by 500 samples, for in the end only those that tie with it are kept (`rank`); and
/// once more while it is not polished yet.
const ROUGH: f64 = 0.05;

/// Planes across the axes that no plane of the pool is near to already.
pub(super) fn planes(merger: &Merger, pool: &[SymmetryPlane]) -> Result<Vec<SymmetryPlane>, Cancelled> {
    let field = &merger.validated.field;
    let best = pool.iter().map(|p| p.coverage).fold(0.0, f64::max);
    let mut found: Vec<SymmetryPlane> = Vec::new();
    let axes = Axes::of(merger);
    let mut normals = axes.distinct.clone();
    if let Some(open) = &axes.open {
        normals.extend(open.promising(merger)?);
    }
    // Without faces that speak for it, a plane that misses much of the surface is an accident.
    let needed = merger.options.near_global.max(best) - ROUGH;
    for normal in normals {
        merger.cancel.check()?;
        let is_known = |plane: &Plane| {
            let known = |p: &SymmetryPlane| p.coverage >= best - ROUGH && near(&p.plane, plane, merger);
            pool.iter().chain(&found).any(known)
        };
        let start = Plane::through(&merger.parsed.measures.centroid, &normal);
        let polished = polish(merger, start, needed, |plane| !is_known(plane));
        if let Some((plane, residual)) = polished
            && let Some(coverage) = field.reaches(&plane.reflection(), needed)
        {
            found.push(candidate(plane, coverage, residual));
        }
    }
    Ok(found)
}

/// A plane that faces do not speak for.
pub(super) fn candidate(plane: Plane, coverage: f64, residual: f64) -> SymmetryPlane {
    let source = Source::Principal;
    let error = COARSE_ERROR;
    SymmetryPlane { plane, coverage, error, residual, pairs: Vec::new(), selfs: Vec::new(), source, correlation: None }
}

fn near(a: &Plane, b: &Plane, merger: &Merger) -> bool {
    let centroid = &merger.parsed.measures.centroid;
    let offsets = a.signed_distance(centroid).abs() - b.signed_distance(centroid).abs();
    a.angle_to(b) <= KNOWN.0 && offsets.abs() <= merger.parsed.measures.tolerance.length(KNOWN.1)
}

/// The principal axes of the surface's points, then of its normals.
struct Axes {
    /// Those that are determined.
    distinct: Vec<Vector>,
    /// Where the others lie, if any symmetry plane may have one of them as its normal.
    open: Option<Open>,
}

impl Axes {
    fn of(merger: &Merger) -> Self {
        let (points, normals) = (merger.covariance, npca::covariance(&merger.parsed.mesh));
        let mut distinct: Vec<Vector> = Vec::new();
        for axis in [points, normals].iter().flat_map(distinct_axes) {
            if distinct.iter().all(|known| known.cross(&axis).norm() > KNOWN.0) {
                distinct.push(axis);
            }
        }
        Self { distinct, open: open(&points) }
    }
}

/// The directions between principal axes that the surface does not tell apart.
fn open(points: &Matrix) -> Option<Open> {
    let (values, vectors) = symmetric_eigen(points);
    match (!apart(&values, 0, 1, OPEN), !apart(&values, 1, 2, OPEN)) {
        (true, true) => Some(Open { across: None }),
        (true, false) => Some(Open { across: Some(vectors[2]) }),
        (false, true) => Some(Open { across: Some(vectors[0]) }),
        (false, false) => None,
    }
}

/// Eigenvectors whose eigenvalues stand alone.
fn distinct_axes(matrix: &Matrix) -> Vec<Vector> {
    let (values, vectors) = symmetric_eigen(matrix);
    let alone = |i: usize| (0..3).all(|j| i == j || apart(&values, i, j, DISTINCT));
    (0..3).filter(|&i| alone(i)).map(|i| vectors[i]).collect()
}

/// Whether two of the eigenvalues differ by more than a share of the larger: of the largest of all they would seem
/// equal across every slender body. What rounding leaves of zeros is equal.
fn apart(values: &[f64; 3], i: usize, j: usize, share: f64) -> bool {
    let larger = values[i].max(values[j]).max(1e-9 * values[2]);
    (values[i] - values[j]).abs() > share * larger
}

/// Point-to-surface ICP of the mirrored samples over the plane's three degrees of freedom. Returns the plane and the
/// root mean square distance; `None` as soon as less of the surface is met than `needed`, for the radii shrink, or
/// where the plane is not `wanted` until it is caught.
pub(super) fn polish(
    merger: &Merger,
    start: Plane,
    needed: f64,
    wanted: impl Fn(&Plane) -> bool,
) -> Option<(Plane, f64)> {
    let field = &merger.validated.field;
    let (mut plane, mut residual, mut guesses) = (start, 0.0, Vec::new());
    let mut round = |plane: &Plane, (radius, stride), round, least| {
        let samples = field.samples(round);
        guesses.resize(samples.len(), u32::MAX);
        let asked = samples.iter().zip(&mut guesses).step_by(stride);
        let step = Step::of(merger, plane, asked, radius, least)?;
        residual = (step.squared / step.met as f64).sqrt();
        step.solved(plane, merger)
    };
    for (i, radius) in CATCH.into_iter().enumerate() {
        // Half of it at first: the start may be off.
        let least = if i < 2 { 0.5 * needed } else { needed - ROUGH };
        let (moved, change) = wanted(&plane).then(|| round(&plane, radius, Round::Coarse, least))??;
        plane = moved;
        if i >= 2 && change < STILL {
            break;
        }
    }
    if !wanted(&plane) || field.reaches(&plane.reflection(), needed).is_none() {
        return None;
    }
    for radius in TIGHTEN {
        plane = round(&plane, radius, Round::Middle, needed - ROUGH)?.0;
    }
    Some((plane, residual))
}

/// The normal equations of one Gauss-Newton step.
struct Step {
    basis: [Vector; 2],
    matrix: Matrix,
    right: Vector,
    squared: f64,
    met: usize,
}

impl Step {
    /// `None` as soon as a smaller share than `least` of the samples can meet the surface within `radius`, a share of D.
    /// With each sample goes the triangle that it met in the step before.
    fn of<'a>(
        merger: &Merger,
        plane: &Plane,
        samples: impl ExactSizeIterator<Item = (&'a Sample, &'a mut u32)>,
        radius: f64,
        least: f64,
    ) -> Option<Self> {
        let field = &merger.validated.field;
        let first = any_perpendicular(&plane.normal);
        let basis = [first, plane.normal.cross(&first)];
        let (centroid, size) = (merger.parsed.measures.centroid, merger.parsed.measures.tolerance.size());
        let mut step = Self { basis, matrix: Matrix::zeros(), right: Vector::zeros(), squared: 0.0, met: 0 };
        let (mut missed, most_missed) = (0, (1.0 - least) * samples.len() as f64);
        for (sample, guess) in samples {
            let image = plane.reflect(&sample.point);
            let normal = plane.reflect_vector(&sample.normal);
            let Some(hit) = field.nearest((&image, &normal), radius * size, guess) else {
                missed += 1;
                if f64::from(missed) > most_missed {
                    return None;
                }
                continue;
            };
            let error = hit.normal.dot(&(image - hit.point));
            // How the error changes as the normal tilts along the basis and the offset grows.
            let height = plane.signed_distance(&sample.point);
            let facing = hit.normal.dot(&plane.normal);
            let arm = sample.point - centroid;
            let tilt = |e: &Vector| -2.0 * (arm.dot(e) * facing + height * hit.normal.dot(e));
            let slope = Vector::new(tilt(&basis[0]) / size, tilt(&basis[1]) / size, 2.0 * facing);
            step.matrix += slope * slope.transpose();
            step.right -= slope * (error / size);
            step.squared += error * error;
            step.met += 1;
        }
        (step.met > 0).then_some(step)
    }

    /// The plane after the step, and how far that was; directions in which nothing is determined stay as they are.
    fn solved(&self, plane: &Plane, merger: &Merger) -> Option<(Plane, f64)> {
        let inverse = self.matrix.pseudo_inverse(1e-6 * self.matrix.norm()).ok()?;
        let change = inverse * self.right;
        let (centroid, size) = (merger.parsed.measures.centroid, merger.parsed.measures.tolerance.size());
        let tilt = self.basis[0] * change.x + self.basis[1] * change.y;
        let normal = (plane.normal + tilt).try_normalize(0.0)?;
        let offset = -plane.signed_distance(&centroid) + change.z * size;
        let moved = Plane { normal, offset: normal.dot(&centroid.coords) + offset };
        (moved.offset.is_finite() && tilt.norm() < 0.5).then_some((moved, change.norm()))
    }
}
