//! The principal symmetry axes of the planar-reflective symmetry transform (Podolak, Shilane, Golovinskiy,
//! Rusinkiewicz and Funkhouser 2006).
//!
//! In: a mesh. Out: the normal of the plane of largest symmetry, that of the largest among the planes at right angles
//! to it, and their cross product.
//! Method: the symmetry of a plane is the mean of exp(-d^2 / 2 s^2) over samples of the surface, d the distance of the
//! mirrored sample from the surface. The transform is searched on a grid that holds the Gaussian of the distance,
//! turned with the principal axes; the best planes are refined by the iterations of the paper: mirror, find the nearest
//! points, fit the plane anew (here point to surface, weighted by the Gaussian).
//! Cost: a million and a half looks into the grid and some thirty thousand nearest points: around 100 ms.
//! It does not promise planes far from the centroid (those within 0.06 D of it are searched), nor the same of two planes
//! in every pose where they are nearly as symmetric.

use std::f64::consts::PI;

use crate::brep::Mesh;
use crate::brep::measure::Measures;
use crate::brep::sample::{Sample, sample_mesh};
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::bvh::Bvh;
use crate::geometry::directions::half_sphere;
use crate::geometry::{Matrix, Plane, Point, Vector};

use super::cpca;

/// Samples: all of them to fill the grid, every so many to refine and to look up.
const SAMPLES: usize = 3000;
const REFINING: usize = 6;
const LOOKING: usize = 8;
/// Cells along a side of the grid, which spans 1.1 D, and the Gaussian's width on it, in cells.
const CELLS: usize = 32;
const SPREAD: f64 = 1.0;
/// Directions tried over half the sphere, and about an axis.
const DIRECTIONS: usize = 800;
const TURNS: usize = 90;
/// Distances of the planes from the centroid, share of D.
const OFFSETS: [f64; 5] = [-0.06, -0.03, 0.0, 0.03, 0.06];
/// Planes refined, and the angle (radians) and distance (share of D) by which they differ at least.
const REFINED: usize = 3;
const APART: (f64, f64) = (0.2, 0.04);
/// Width of the Gaussian in rounds of refinement, share of D: wide first; the last one defines the symmetry.
const WIDTHS: [f64; 5] = [0.04, 0.03, 0.02, 0.015, 0.01];
/// Rounds at the last width, and the step (radians, share of D) that ends them.
const ROUNDS: usize = 8;
const STILL: f64 = 1e-7;
/// Symmetries that differ by less are equal: the plane across the direction of larger variance comes first, as the
/// literature sorts principal axes.
const EQUAL: f64 = 0.01;

/// The principal symmetry axes; those of continuous PCA for a mesh without area.
pub fn axes(mesh: &Mesh, measures: &Measures, cancel: &Cancel) -> Result<[Vector; 3], Cancelled> {
    let samples = sample_mesh(mesh, SAMPLES, 0);
    if samples.is_empty() {
        return Ok(cpca::axes(mesh));
    }
    let principal = cpca::axes(mesh).map(|axis| towards_the_far_end(&samples, measures, axis));
    let transform = Transform::new(mesh, samples, measures, principal);
    let mut normals: Vec<_> = principal.to_vec();
    normals.extend(half_sphere(&principal, DIRECTIONS));
    let Some(first) = transform.best(&normals, None, cancel)? else { return Ok(principal) };
    let first = first.normal;
    let beside = principal.iter().map(|p| p - first * first.dot(p)).find(|p| p.norm() > 0.5);
    let beside = beside.map_or(principal[0], |p| p.normalize());
    let turn = |k: usize| {
        let (sin, cos) = (PI * k as f64 / TURNS as f64).sin_cos();
        beside * cos + first.cross(&beside) * sin
    };
    let normals: Vec<_> = (0..TURNS).map(turn).collect();
    let second = transform.best(&normals, Some(&first), cancel)?.map_or(beside, |p| p.normal);
    Ok([first, second, first.cross(&second)])
}

/// The axis or its opposite, whichever way the surface reaches out farther (by its third moment): the directions tried
/// are then the same in every pose.
fn towards_the_far_end(samples: &[Sample], measures: &Measures, axis: Vector) -> Vector {
    let third: f64 = samples.iter().map(|s| axis.dot(&(s.point - measures.centroid)).powi(3)).sum();
    if third < 0.0 { -axis } else { axis }
}

/// The transform of one model, to be evaluated at planes.
struct Transform {
    samples: Vec<Sample>,
    grid: Grid,
    tree: Bvh,
    covariance: Matrix,
    centroid: Point,
    size: f64,
}

impl Transform {
    fn new(mesh: &Mesh, samples: Vec<Sample>, measures: &Measures, axes: [Vector; 3]) -> Self {
        let (centroid, size) = (measures.centroid, measures.tolerance.size());
        let grid = Grid::new(&samples, axes, centroid, 1.1 * size / CELLS as f64);
        let tree = Bvh::new(mesh.triangles.len(), (0..mesh.triangles.len()).map(|t| (mesh.corners(t), t as u32)));
        Self { samples, grid, tree, covariance: cpca::covariance(mesh), centroid, size }
    }

    /// The plane of largest symmetry near the normals tried, at right angles to `axis` if there is one.
    fn best(&self, normals: &[Vector], axis: Option<&Vector>, cancel: &Cancel) -> Result<Option<Plane>, Cancelled> {
        let mut refined = Vec::new();
        for start in self.promising(normals, cancel)? {
            cancel.check()?;
            let plane = self.refine(start, axis);
            refined.push((self.symmetry(&plane), plane));
        }
        let most = refined.iter().map(|r| r.0).fold(0.0, f64::max);
        let variance = |p: &Plane| p.normal.dot(&(self.covariance * p.normal));
        let equal = refined.into_iter().filter(|r| r.0 >= most - EQUAL).map(|r| r.1);
        Ok(equal.max_by(|p, q| variance(p).total_cmp(&variance(q))))
    }

    /// The best planes on the grid that are well apart.
    fn promising(&self, normals: &[Vector], cancel: &Cancel) -> Result<Vec<Plane>, Cancelled> {
        let mut found = Vec::new();
        for normal in normals {
            cancel.check()?;
            for offset in OFFSETS {
                let plane = Plane::through(&(self.centroid + normal * (offset * self.size)), normal);
                found.push((self.grid.mean(self.samples.iter().step_by(LOOKING), &plane), plane));
            }
        }
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut kept: Vec<Plane> = Vec::new();
        for (_, plane) in found {
            let off = |other: &Plane| (self.signed(other) - self.signed(&plane) * same_side(other, &plane)).abs();
            let apart = |other: &Plane| other.angle_to(&plane) > APART.0 || off(other) > APART.1 * self.size;
            if kept.len() < REFINED && kept.iter().all(apart) {
                kept.push(plane);
            }
        }
        Ok(kept)
    }

    fn signed(&self, plane: &Plane) -> f64 {
        plane.signed_distance(&self.centroid)
    }

    fn symmetry(&self, plane: &Plane) -> f64 {
        let used = self.samples.iter().step_by(REFINING);
        let count = used.len() as f64;
        used.filter_map(|s| self.met(s, plane, WIDTHS[WIDTHS.len() - 1])).map(|met| met.weight).sum::<f64>() / count
    }

    /// Where the mirrored sample meets the surface, within three widths (share of D).
    fn met(&self, sample: &Sample, plane: &Plane, width: f64) -> Option<Met> {
        let width = width * self.size;
        let image = plane.reflect(&sample.point);
        let hit = self.tree.nearest_within(&image, 3.0 * width, |_| true)?;
        let weight = (-0.5 * hit.squared / (width * width)).exp();
        Some(Met { error: hit.normal.dot(&(image - hit.point)), normal: hit.normal, weight })
    }

    fn refine(&self, start: Plane, axis: Option<&Vector>) -> Plane {
        let mut plane = start;
        let last = WIDTHS[WIDTHS.len() - 1];
        for width in WIDTHS.into_iter().chain(std::iter::repeat_n(last, ROUNDS)) {
            let Some((next, step)) = self.step(&plane, axis, width) else { break };
            plane = next;
            if width == last && step < STILL {
                break;
            }
        }
        plane
    }

    /// One weighted Gauss-Newton step over the plane's tilts and offset, and how far it went.
    fn step(&self, plane: &Plane, axis: Option<&Vector>, width: f64) -> Option<(Plane, f64)> {
        let first = axis.map_or_else(|| crate::geometry::any_perpendicular(&plane.normal), |a| a.cross(&plane.normal));
        // At right angles to an axis, the normal turns about it alone.
        let second = if axis.is_some() { Vector::zeros() } else { plane.normal.cross(&first) };
        let (mut matrix, mut right) = (Matrix::zeros(), Vector::zeros());
        for sample in self.samples.iter().step_by(REFINING) {
            let Some(met) = self.met(sample, plane, width) else { continue };
            let height = plane.signed_distance(&sample.point);
            let facing = met.normal.dot(&plane.normal);
            let arm = sample.point - self.centroid;
            let tilt = |e: &Vector| -2.0 * (arm.dot(e) * facing + height * met.normal.dot(e)) / self.size;
            let slope = Vector::new(tilt(&first), tilt(&second), 2.0 * facing);
            matrix += slope * slope.transpose() * met.weight;
            right -= slope * (met.error / self.size * met.weight);
        }
        let change = matrix.pseudo_inverse(1e-9 * matrix.norm()).ok()? * right;
        let normal = (plane.normal + first * change.x + second * change.y).try_normalize(0.0)?;
        let offset = normal.dot(&self.centroid.coords) - self.signed(plane) + change.z * self.size;
        (offset.is_finite() && change.norm() < 0.5).then_some((Plane { normal, offset }, change.norm()))
    }
}

/// A mirrored sample against the surface.
struct Met {
    error: f64,
    normal: Vector,
    weight: f64,
}

fn same_side(a: &Plane, b: &Plane) -> f64 {
    a.normal.dot(&b.normal).signum()
}

/// The Gaussian of the distance from the surface in cubic cells about the centroid.
struct Grid {
    axes: [Vector; 3],
    centre: Point,
    cell: f64,
    values: Vec<f32>,
}

impl Grid {
    fn new(samples: &[Sample], axes: [Vector; 3], centre: Point, cell: f64) -> Self {
        let mut grid = Self { axes, centre, cell, values: vec![0.0; CELLS.pow(3)] };
        let mut filled: Vec<_> = samples.iter().filter_map(|s| grid.cell_of(&s.point)).collect();
        filled.sort_unstable();
        filled.dedup();
        for at in filled {
            grid.spread(at);
        }
        grid
    }

    fn cell_of(&self, p: &Point) -> Option<[usize; 3]> {
        let d = (p - self.centre) / self.cell;
        let cells = self.axes.map(|axis| axis.dot(&d) + 0.5 * CELLS as f64);
        cells.iter().all(|c| (0.0..CELLS as f64).contains(c)).then(|| cells.map(|c| c as usize))
    }

    fn index([x, y, z]: [usize; 3]) -> usize {
        (z * CELLS + y) * CELLS + x
    }

    /// Raises the cells around a filled one to the Gaussian of their distance from it.
    fn spread(&mut self, at: [usize; 3]) {
        let reach = (3.0 * SPREAD) as usize;
        let near = |c: usize| c.saturating_sub(reach)..(c + reach + 1).min(CELLS);
        for z in near(at[2]) {
            for y in near(at[1]) {
                for x in near(at[0]) {
                    let squared: f64 = [x, y, z].iter().zip(at).map(|(&c, a)| (c as f64 - a as f64).powi(2)).sum();
                    let value = &mut self.values[Self::index([x, y, z])];
                    *value = value.max((-0.5 * squared / (SPREAD * SPREAD)).exp() as f32);
                }
            }
        }
    }

    /// The mean over the mirrored samples.
    fn mean<'a>(&self, samples: impl ExactSizeIterator<Item = &'a Sample>, plane: &Plane) -> f64 {
        let count = samples.len() as f64;
        let value = |s: &Sample| self.cell_of(&plane.reflect(&s.point)).map_or(0.0, |c| self.values[Self::index(c)]);
        samples.map(|s| f64::from(value(s))).sum::<f64>() / count
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::shapes;

    #[test]
    fn the_planes_of_a_box_in_order_of_variance() {
        let turn = shapes::rotation(0.5, 0.9, -1.3);
        let mesh = shapes::turned(&shapes::cuboid(1.0, 2.0, 4.0), &turn);
        let found = axes(&mesh, &shapes::measures(&mesh), &Cancel::new()).unwrap();
        for (axis, side) in found.iter().zip([2, 1, 0]) {
            assert!(axis.dot(&turn.column(side)).abs() > 1.0 - 1e-9, "{found:?}");
        }
    }

    #[test]
    fn the_only_plane_of_a_letter_comes_first() {
        let mesh = shapes::letter_f(1.5);
        let found = axes(&mesh, &shapes::measures(&mesh), &Cancel::new()).unwrap();
        assert!(found[0].z.abs() > 1.0 - 1e-9, "{found:?}");
    }
}
