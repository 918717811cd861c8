//! Rectilinearity (Lian, Rosin and Sun 2010): the frame in which the surface's faces are most nearly along the axes.
//!
//! In: a mesh. Out: the frame and the measure, 0 to 1.
//! Method: minimise P(R) = sum S_i (|n_i.e1| + |n_i.e2| + |n_i.e3|) over frames; the measure is 3 (S / P - 2/3), which
//! is 1 only where every face is normal to an axis. P is concave between its kinks, so minima lie where faces are
//! parallel to axes: frames made of pairs of the largest normals are tried, the best are polished by a compass search.
//! Cost: about a thousand sums over at most 2,048 distinct normals, some milliseconds.
//! It does not promise the global minimum on surfaces without preferred directions; the measure is low there.

use std::f64::consts::FRAC_PI_6;

use crate::brep::Mesh;
use crate::geometry::{Vector, any_perpendicular};

use super::{cpca, npca, triangles};

/// The most rectilinear frame and how rectilinear the surface is in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectilinear {
    /// Orthonormal, in order of falling surface variance along them.
    pub axes: [Vector; 3],
    /// 0 (a ball) to 1 (all faces normal to an axis).
    pub measure: f64,
}

/// Distinct normals kept at most; a coarser grid merges more.
const MOST_NORMALS: usize = 2048;
/// Cells to the unit in which normals count as one, at first: 1e-4 is far above rounding, far below what matters.
const FINEST_GRID: f64 = 1e4;
/// Largest normals from which candidate frames are made.
const SEEDS: usize = 12;
/// Candidates that are polished.
const POLISHED: usize = 6;
/// First and last step of the compass search, radians.
const STEPS: (f64, f64) = (0.07, 1e-7);

/// Finds the most rectilinear frame of a mesh; without any area the coordinate axes with measure 0.
pub fn rectilinearity(mesh: &Mesh) -> Rectilinear {
    let normals = weighted_normals(mesh);
    let total: f64 = normals.iter().map(|n| n.norm()).sum();
    let mut candidates: Vec<_> =
        candidates(mesh, &normals).into_iter().map(|axes| (projected(&normals, &axes), axes)).collect();
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
    let polished = candidates.into_iter().take(POLISHED).map(|(_, axes)| polish(&normals, axes));
    let Some((least, axes)) = polished.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(least, _)| *least > 0.0) else {
        return Rectilinear { axes: [Vector::x(), Vector::y(), Vector::z()], measure: 0.0 };
    };
    let measure = (3.0 * (total / least - 2.0 / 3.0)).clamp(0.0, 1.0);
    Rectilinear { axes: by_variance(mesh, axes), measure }
}

/// P(R): the surface projected on the three planes of the frame.
fn projected(normals: &[Vector], axes: &[Vector; 3]) -> f64 {
    normals.iter().map(|n| n.dot(&axes[0]).abs() + n.dot(&axes[1]).abs() + n.dot(&axes[2]).abs()).sum()
}

/// One normal times its area for each distinct direction, opposite ones joined, largest first.
pub(super) fn weighted_normals(mesh: &Mesh) -> Vec<Vector> {
    let axes = cpca::axes(mesh);
    let mut grid = FINEST_GRID;
    loop {
        let merged = merge_normals(mesh, &axes, grid);
        if merged.len() <= MOST_NORMALS {
            return merged;
        }
        grid *= 0.5;
    }
}

/// Joins the normals in each cell of a grid that turns with the principal axes.
fn merge_normals(mesh: &Mesh, axes: &[Vector; 3], grid: f64) -> Vec<Vector> {
    let mut keyed: Vec<_> = triangles(mesh)
        .map(|(_, normal, area)| {
            let cell = axes.map(|axis| (axis.dot(&normal) * grid).round() as i32);
            let negative = cell.iter().find(|c| **c != 0).is_some_and(|c| *c < 0);
            if negative { (cell.map(|c| -c), -normal * area) } else { (cell, normal * area) }
        })
        .collect();
    keyed.sort_by_key(|(cell, _)| *cell);
    let same = keyed.chunk_by(|a, b| a.0 == b.0);
    let mut merged: Vec<Vector> = same.map(|chunk| chunk.iter().map(|(_, n)| n).sum()).collect();
    merged.sort_by(|a, b| b.norm_squared().total_cmp(&a.norm_squared()));
    merged
}

/// Frames worth trying: the two PCA frames, pairs of large normals, and single large normals turned freely.
fn candidates(mesh: &Mesh, normals: &[Vector]) -> Vec<[Vector; 3]> {
    let seeds: Vec<_> = normals.iter().take(SEEDS).map(|n| n.normalize()).collect();
    let mut frames = vec![cpca::axes(mesh), npca::axes(mesh)];
    for a in &seeds {
        let side = any_perpendicular(a);
        frames.extend((0..3).map(|i| turned(&[*a, side, a.cross(&side)], 0, f64::from(i) * FRAC_PI_6)));
        for b in &seeds {
            let beside = b - a * a.dot(b);
            if beside.norm() > 1e-3 {
                let beside = beside.normalize();
                frames.push([*a, beside, a.cross(&beside)]);
            }
        }
    }
    frames
}

/// The frame turned about its own axis `about`.
fn turned(axes: &[Vector; 3], about: usize, angle: f64) -> [Vector; 3] {
    let (i, j) = ((about + 1) % 3, (about + 2) % 3);
    let (sin, cos) = angle.sin_cos();
    let mut turned = *axes;
    turned[i] = axes[i] * cos + axes[j] * sin;
    turned[j] = axes[j] * cos - axes[i] * sin;
    turned
}

/// Turns the frame about its axes while that lowers P, with ever smaller steps.
fn polish(normals: &[Vector], start: [Vector; 3]) -> (f64, [Vector; 3]) {
    let mut best = (projected(normals, &start), start);
    let mut step = STEPS.0;
    while step > STEPS.1 {
        let trials = [(0, step), (0, -step), (1, step), (1, -step), (2, step), (2, -step)];
        let next = trials
            .map(|(about, angle)| turned(&best.1, about, angle))
            .map(|axes| (projected(normals, &axes), axes))
            .into_iter()
            .min_by(|a, b| a.0.total_cmp(&b.0));
        match next {
            Some(next) if next.0 < best.0 * (1.0 - 1e-12) => best = next,
            _ => step *= 0.5,
        }
    }
    best
}

fn by_variance(mesh: &Mesh, mut axes: [Vector; 3]) -> [Vector; 3] {
    let covariance = cpca::covariance(mesh);
    let variance = |axis: &Vector| axis.dot(&(covariance * axis));
    axes.sort_by(|a, b| variance(b).total_cmp(&variance(a)));
    axes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::shapes;

    #[test]
    fn a_turned_letter_is_rectilinear_along_its_own_sides() {
        let turn = shapes::rotation(0.5, 0.9, -1.3);
        let found = rectilinearity(&shapes::turned(&shapes::letter_f(1.5), &turn));
        assert!(found.measure > 1.0 - 1e-6, "{found:?}");
        assert!(found.axes[0].dot(&turn.column(1)).abs() > 1.0 - 1e-12);
        assert!(found.axes[2].dot(&turn.column(2)).abs() > 1.0 - 1e-12);
    }

    #[test]
    fn a_ball_is_hardly_rectilinear() {
        assert!(rectilinearity(&shapes::ellipsoid([1.0; 3], 24)).measure < 0.05);
    }
}
