//! The edges that bound what is seen of a mesh from one side.
//!
//! With all triangles turned to the viewer, most edges have one of them to their left and one to their right. What is left
//! are outlines: edges between a triangle that faces the viewer and one that does not, and edges of a single triangle.
//! How many layers lie over a place, the outlines that are passed on the way there from outside tell, whether the mesh is
//! closed or not: along any straight way they add up to nothing.

use crate::brep::Wireframe;
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::Vector;

/// An edge of a wireframe as an outline of a view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outline {
    /// The vertices it goes from and to.
    pub ends: [u32; 2],
    /// So many layers more lie to its left than to its right; not zero.
    pub layers: i32,
}

impl Outline {
    /// Its lower and its upper end where vertices lie `at` some place of the view (right, up), and how many layers more
    /// lie to its right than to its left on the way up.
    #[inline]
    pub fn upwards(&self, at: impl Fn(usize) -> [f64; 2]) -> ([[f64; 2]; 2], i32) {
        let [from, to] = self.ends.map(|i| at(i as usize));
        if to[1] < from[1] { ([to, from], self.layers) } else { ([from, to], -self.layers) }
    }
}

/// Triangles that are turned from the viewer by less (radians) are seen edge-on and count as facing him, so that of the
/// walls of a step that is seen from above none has outlines.
const EDGE_ON: f32 = 1e-5;
/// Triangles between two looks whether the work was cancelled.
const CHUNK: usize = 1 << 16;

/// The outlines of a wireframe seen against the direction `view`, a unit vector.
///
/// # Errors
/// When cancelled.
pub fn outlines(
    wireframe: &Wireframe,
    view: &Vector,
    cancel: &Cancel,
) -> Result<impl Iterator<Item = Outline>, Cancelled> {
    let mut layers = vec![0; wireframe.edges.len()];
    let [x, y, z] = view.map(|c| c as f32).into();
    for (triangles, normals) in wireframe.triangles.chunks(CHUNK).zip(wireframe.normals.chunks(CHUNK)) {
        cancel.check()?;
        for (sides, normal) in triangles.iter().zip(normals) {
            let faces_viewer = x * normal[0] + y * normal[1] + z * normal[2] > -EDGE_ON;
            for side in sides {
                layers[side.edge()] += if faces_viewer == side.is_reversed() { -1 } else { 1 };
            }
        }
    }
    let outlines = wireframe.edges.iter().zip(layers).filter(|(_, layers)| *layers != 0);
    Ok(outlines.map(|(&ends, layers)| Outline { ends, layers }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::shapes;
    use crate::geometry::Point;

    fn seen(mesh: &crate::brep::Mesh, view: Vector) -> Vec<([Point; 2], i32)> {
        let wireframe = Wireframe::of(mesh);
        let ends = |o: Outline| (o.ends.map(|i| wireframe.vertices[i as usize]), o.layers);
        outlines(&wireframe, &view, &Cancel::new()).unwrap().map(ends).collect()
    }

    /// A cube seen from above and seen along a diagonal: a square, a hexagon, with two layers within.
    #[test]
    fn a_cube_has_four_outlines_or_six() {
        let cube = shapes::cuboid(1.0, 1.0, 1.0);
        let square = seen(&cube, Vector::z());
        assert_eq!(square.len(), 4);
        assert!(square.iter().all(|(ends, _)| ends[0].z == ends[1].z));
        let hexagon = seen(&cube, Vector::repeat(1.0).normalize());
        assert_eq!(hexagon.len(), 6);
        assert!(square.iter().chain(&hexagon).all(|(_, layers)| layers.abs() == 2));
    }

    /// Counter-clockwise around the square the layers lie to the left, whichever side of it is seen.
    #[test]
    fn an_open_sheet_has_its_border() {
        for view in [Vector::z(), -Vector::z()] {
            let border = seen(&shapes::rectangle(4.0, 2.0), view);
            assert_eq!(border.len(), 4);
            for ([from, to], layers) in border {
                let is_left = view.dot(&(to - from).cross(&(Point::new(2.0, 1.0, 0.0) - from))) > 0.0;
                assert_eq!(layers, if is_left { 1 } else { -1 });
            }
        }
    }
}
