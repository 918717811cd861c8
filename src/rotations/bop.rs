//! Symmetries in the form of the BOP benchmark's `models_info.json` (Hodan et al., bop.felk.cvut.cz): for each object
//! its box and diameter, `symmetries_discrete` as 4 by 4 matrices row by row, and `symmetries_continuous` as axis and
//! a point on it, `offset`. All lengths are mm, in the file's own coordinates.

use serde_json::{Value, json};

use super::Rotations;
use crate::brep::Mesh;
use crate::geometry::{Aabb, Isometry, Point, Vector};
use crate::stages::merge::Symmetries;
use crate::stages::parse::Parsed;

/// Up to so many points the diameter is exact; beyond, it is looked for among points that are outermost in some
/// direction, and may be short by a thousandth.
const EXACT: usize = 20_000;
/// Directions in which the outermost points are taken.
const DIRECTIONS: usize = 1_000;

/// The object of one model. Beyond the benchmark's fields: `model`, its name, and `symmetries_mirror`, the planes
/// n.x = offset that map it onto itself (at least in the share `exact` of its surface).
pub fn object(name: &str, parsed: &Parsed, symmetries: &Symmetries, rotations: &Rotations, exact: f64) -> Value {
    let bounds = Aabb::of(&parsed.mesh.points);
    let size = bounds.max - bounds.min;
    let mut object = json!({
        "model": name,
        "diameter": diameter(&parsed.mesh, &parsed.measures.centroid),
        "min_x": bounds.min.x, "min_y": bounds.min.y, "min_z": bounds.min.z,
        "size_x": size.x, "size_y": size.y, "size_z": size.z,
    });
    // As in the benchmark, what there is none of is left out.
    if !rotations.discrete.is_empty() {
        object["symmetries_discrete"] = rotations.discrete.iter().map(matrix).collect();
    }
    if !rotations.axes.is_empty() {
        let axis = |a: &crate::geometry::Axis| json!({"axis": vector(&a.direction), "offset": vector(&a.point.coords)});
        object["symmetries_continuous"] = rotations.axes.iter().map(axis).collect();
    }
    let planes = symmetries.planes.iter().filter(|p| p.coverage >= exact);
    let planes: Vec<_> = planes
        .map(|p| json!({"normal": vector(&p.plane.normal), "offset": p.plane.offset, "coverage": p.coverage}))
        .collect();
    object["symmetries_mirror"] = planes.into();
    object
}

/// 16 numbers, row by row; rounding errors beside whole numbers are left out.
fn matrix(isometry: &Isometry) -> Value {
    let row = |i: usize| {
        let rotation = (0..3).map(move |j| clean(isometry.rotation[(i, j)]));
        rotation.chain(std::iter::once(clean(isometry.translation[i])))
    };
    (0..3).flat_map(row).chain([0.0, 0.0, 0.0, 1.0]).collect::<Vec<_>>().into()
}

fn vector(v: &Vector) -> [f64; 3] {
    [v.x, v.y, v.z].map(clean)
}

fn clean(x: f64) -> f64 {
    if (x - x.round()).abs() < 1e-12 { x.round() + 0.0 } else { x }
}

/// The largest distance of two points of a mesh, mm.
fn diameter(mesh: &Mesh, centre: &Point) -> f64 {
    let outermost = outermost(mesh);
    let mut best = farthest_pair(&outermost, centre, 0.0);
    // A pair that is farther apart has no point nearer to the centre than this.
    let most = mesh.points.iter().map(|p| (p - centre).norm()).fold(0.0, f64::max);
    let far: Vec<_> = mesh.points.iter().filter(|p| (*p - centre).norm() + most > best).copied().collect();
    if far.len() <= EXACT {
        best = farthest_pair(&far, centre, best);
    }
    best
}

/// The points that are first and last in many directions (spread by the golden angle).
fn outermost(mesh: &Mesh) -> Vec<Point> {
    let direction = |i: usize| {
        let z = 1.0 - (i as f64 + 0.5) / DIRECTIONS as f64;
        let (sin, cos) = (i as f64 * 2.399_963_229_728_653).sin_cos();
        Vector::new(cos * (1.0 - z * z).sqrt(), sin * (1.0 - z * z).sqrt(), z)
    };
    let ends = |d: Vector| {
        let height = |p: &&Point| d.dot(&p.coords);
        let order = |a: &&Point, b: &&Point| height(a).total_cmp(&height(b));
        [mesh.points.iter().min_by(order), mesh.points.iter().max_by(order)]
    };
    (0..DIRECTIONS).map(direction).flat_map(ends).flatten().copied().collect()
}

/// The largest distance of two points, or `best` where none is larger: outer points first, until no pair can be.
fn farthest_pair(points: &[Point], centre: &Point, mut best: f64) -> f64 {
    let mut by_radius: Vec<_> = points.iter().map(|p| ((p - centre).norm(), p)).collect();
    by_radius.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (i, (outer, p)) in by_radius.iter().enumerate() {
        for (inner, q) in &by_radius[i + 1..] {
            if outer + inner <= best {
                break;
            }
            best = best.max((*p - *q).norm());
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::shapes;
    use crate::geometry::{Chirality, Matrix};

    #[test]
    fn the_diameter_of_a_box_is_its_diagonal() {
        let mesh = shapes::cuboid(2.0, 3.0, 6.0);
        let measures = shapes::measures(&mesh);
        assert!((diameter(&mesh, &measures.centroid) - 7.0).abs() < 1e-12);
    }

    #[test]
    fn a_matrix_has_its_translation_in_the_last_column() {
        let rotation = Matrix::new(-1.0, 1e-17, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0);
        let half_turn = Isometry { rotation, translation: Vector::new(2.5, 0.5, 0.0), chirality: Chirality::Proper };
        let expected = json!([-1.0, 0.0, 0.0, 2.5, 0.0, -1.0, 0.0, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        assert_eq!(matrix(&half_turn), expected);
    }
}
