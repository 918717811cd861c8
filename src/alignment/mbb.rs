//! The bounding box of least volume.
//!
//! In: a mesh and its size D. Out: the directions of the box's sides, longest side first.
//! Method: the least box has two neighbouring sides flush with edges of the convex hull (O'Rourke 1985), most often a
//! side flush with a facet. For each facet of the hull the least rectangle across its normal is found (one side flush
//! with an edge: Freeman and Shapira 1975); the best boxes are then improved by finding that rectangle across each of
//! their own sides in turn until nothing is gained.
//! Cost: facets times squared corners of their shadows, some milliseconds: the hull has at most 256 corners.
//! It does not promise the least box of all (the cube around a regular tetrahedron touches no facet), nor a length closer than the hull's tolerance, 1e-4 D.

use crate::brep::Mesh;
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::{Point, Vector, any_perpendicular, polygon};

use super::hull::{Hull, hull};
use super::{cpca, ordered};

/// Corners of the hull at most, and how far (share of D) a point may lie outside.
const CORNERS: usize = 256;
const TOLERANCE: f64 = 1e-4;
/// Facets that are turned by less (sine) give one box.
const SAME: f64 = 1e-4;
/// Boxes that are improved, and rounds of it at most.
const IMPROVED: usize = 4;
const ROUNDS: usize = 30;
/// Sides that differ by less than this share are equally long.
const EQUAL_SIDES: f64 = 1e-3;

/// A box around the points by its directions.
#[derive(Clone, Copy)]
struct Fitted {
    axes: [Vector; 3],
    extents: [f64; 3],
    /// With every side a little longer, so that the least of flat boxes is the one of least area.
    volume: f64,
}

/// Directions of the sides of the least bounding box of a model of the given size (mm), longest first.
pub fn axes(mesh: &Mesh, size: f64, cancel: &Cancel) -> Result<[Vector; 3], Cancelled> {
    let principal = cpca::axes(mesh);
    let Hull { corners, normals } = match hull(&mesh.points, TOLERANCE * size, CORNERS, cancel)? {
        Some(found) => found,
        None => Hull { corners: mesh.points.clone(), normals: principal.to_vec() },
    };
    let mut boxes = Vec::new();
    for normal in distinct(normals) {
        cancel.check()?;
        boxes.extend(flush(&corners, &normal, size));
    }
    boxes.sort_by(|a, b| a.volume.total_cmp(&b.volume));
    let improved = boxes.into_iter().take(IMPROVED).map(|start| improve(&corners, start, size));
    let best = improved.min_by(|a, b| a.volume.total_cmp(&b.volume));
    Ok(best.map_or(principal, |b| ordered(mesh, b.axes, b.extents, EQUAL_SIDES)))
}

/// One of all normals that are parallel.
fn distinct(normals: Vec<Vector>) -> Vec<Vector> {
    let mut kept: Vec<Vector> = Vec::new();
    for normal in normals {
        if kept.iter().all(|k| k.cross(&normal).norm() > SAME) {
            kept.push(normal);
        }
    }
    kept
}

/// The least box with a side across `normal`: its other sides bound the least rectangle around the shadow.
fn flush(corners: &[Point], normal: &Vector, size: f64) -> Option<Fitted> {
    let u = any_perpendicular(normal);
    let v = normal.cross(&u);
    let flat = polygon::convex_hull(corners.iter().map(|p| [u.dot(&p.coords), v.dot(&p.coords)]).collect());
    let next = flat.iter().cycle().skip(1);
    let sides = flat.iter().zip(next).filter_map(|(a, b)| {
        let along = (u * (b[0] - a[0]) + v * (b[1] - a[1])).try_normalize(0.0)?;
        Some(Fitted::around(corners, [*normal, along, normal.cross(&along)], size))
    });
    sides.min_by(|a, b| a.volume.total_cmp(&b.volume))
}

impl Fitted {
    fn around(corners: &[Point], axes: [Vector; 3], size: f64) -> Self {
        let extents = axes.map(|axis| {
            let along = corners.iter().map(|p| axis.dot(&p.coords));
            let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
            high - low
        });
        Self { axes, extents, volume: extents.iter().map(|e| e + TOLERANCE * size).product() }
    }
}

/// Turns the box about its own sides while that makes it smaller.
fn improve(corners: &[Point], start: Fitted, size: f64) -> Fitted {
    let mut best = start;
    for _ in 0..ROUNDS {
        let turned = best.axes.iter().filter_map(|side| flush(corners, side, size));
        match turned.min_by(|a, b| a.volume.total_cmp(&b.volume)) {
            Some(next) if next.volume < best.volume * (1.0 - 1e-9) => best = next,
            _ => break,
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::shapes;

    fn found(mesh: &Mesh) -> [Vector; 3] {
        axes(mesh, 2.0 * mesh.points.iter().map(|p| p.coords.norm()).fold(0.0, f64::max), &Cancel::new()).unwrap()
    }

    #[test]
    fn the_box_of_a_turned_letter_lies_along_its_sides() {
        let turn = shapes::rotation(0.5, 0.9, -1.3);
        let sides = found(&shapes::turned(&shapes::letter_f(0.7), &turn));
        // 5 high, 3 wide, 0.7 thick.
        for (side, expected) in sides.iter().zip([1, 0, 2]) {
            assert!(side.dot(&turn.column(expected)).abs() > 1.0 - 1e-12, "{sides:?}");
        }
    }

    #[test]
    fn the_box_of_a_regular_tetrahedron_is_nearly_the_cube_around_it() {
        // Its facets are flush with no side of the cube: only the rounds of improvement lead there, slower and slower.
        let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]].map(Point::from);
        let mesh = shapes::mesh(corners.to_vec(), vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]);
        let sides = found(&mesh);
        assert!(sides.iter().all(|s| s.amax() > 0.998), "{sides:?}");
    }

    #[test]
    fn a_flat_mesh_has_a_flat_box() {
        let turn = shapes::rotation(0.3, 0.1, 0.2);
        let sides = found(&shapes::turned(&shapes::rectangle(2.0, 6.0), &turn));
        for (side, expected) in sides.iter().zip([1, 0, 2]) {
            assert!(side.dot(&turn.column(expected)).abs() > 1.0 - 1e-9, "{sides:?}");
        }
    }
}
