//! Models built by hand, with areas and volumes worked by hand.

mod solids;
mod surfaces;
mod trimming;

use super::*;
use crate::brep::measure::measure;
use crate::brep::nurbs::NurbsSurface;
use crate::brep::{
    Body, BodyId, Curve, Edge, EdgeUse, FaceGeometry, FaceId, FaceLoop, Occurrence, Placement, Shell, Surface, Uses,
    Vertex, VertexId,
};
use crate::geometry::{Isometry, Plane, Transform, Vector};
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

/// The global axes at a height.
fn at_height(z: f64) -> Placement {
    Placement { origin: Point::new(0.0, 0.0, z), x: Vector::x(), y: Vector::y(), z: Vector::z() }
}

struct Builder(Model);

impl Builder {
    fn new() -> Self {
        let mut model = Model::empty();
        model.shells = vec![Shell { entity: 0, closed: true, faces: vec![] }];
        model.bodies = vec![Body { entity: 0, solid: true, shells: vec![0] }];
        let placement = Transform::identity();
        model.occurrences = vec![Occurrence { path: String::new(), body: BodyId(0), placement }];
        Self(model)
    }

    fn vertex(&mut self, x: f64, y: f64, z: f64) -> VertexId {
        self.0.vertices.push(Vertex { entity: 0, point: Point::new(x, y, z) });
        VertexId(self.0.vertices.len() as u32 - 1)
    }

    fn edge(&mut self, start: VertexId, end: VertexId, curve: Option<Curve>) -> EdgeId {
        self.0.edges.push(Edge { entity: 0, curve: curve.map(Arc::new), start, end, same_sense: true });
        EdgeId(self.0.edges.len() as u32 - 1)
    }

    /// The circle at height z, from and to (radius, 0, z).
    fn circle(&mut self, radius: f64, z: f64) -> (EdgeId, VertexId) {
        let vertex = self.vertex(radius, 0.0, z);
        (self.edge(vertex, vertex, Some(Curve::Circle { placement: at_height(z), radius })), vertex)
    }

    /// `loops`: edges with their direction.
    fn face(&mut self, surface: Surface, same_sense: bool, loops: &[&[(EdgeId, bool)]]) {
        let uses = |l: &[(EdgeId, bool)]| l.iter().map(|&(edge, forward)| EdgeUse { edge, forward }).collect();
        let one = |l: &&[(EdgeId, bool)]| FaceLoop { entity: 0, uses: uses(l), pole: None, outer: false };
        let geometry = FaceGeometry::Trimmed { surface: self.0.add_surface(surface), same_sense };
        let loops = loops.iter().map(one).collect();
        self.0.faces.push(Face { entity: self.0.faces.len() as u64 + 1, geometry, loops, shell: 0 });
        self.0.shells[0].faces.push(FaceId(self.0.faces.len() as u32 - 1));
    }

    /// Discs that close a body of revolution.
    fn discs(&mut self, bottom: Option<(EdgeId, f64)>, top: Option<(EdgeId, f64)>) {
        if let Some((edge, z)) = bottom {
            self.face(Surface::Plane(at_height(z)), false, &[&[(edge, false)]]);
        }
        if let Some((edge, z)) = top {
            self.face(Surface::Plane(at_height(z)), true, &[&[(edge, true)]]);
        }
    }

    /// A loop that is only a point.
    fn vertex_loop(&mut self, face: usize, vertex: VertexId) {
        self.0.faces[face].loops.push(FaceLoop { entity: 0, uses: Uses::new(), pole: Some(vertex), outer: false });
    }

    /// Area of the faces, and of their triangles within the given share of it.
    fn check_area(&self, area: f64, share: f64) -> Mesh {
        let (mesh, skipped, warnings) = tessellate(&self.0, &Options::default(), &Cancel::new()).unwrap();
        assert_eq!((skipped, warnings), (vec![], vec![]));
        let measured: f64 = mesh.faces.iter().map(|f| f.area).sum();
        assert!((measured / area - 1.0).abs() < 1e-4, "area {measured} for {area}");
        let plain: f64 = (0..mesh.triangles.len()).map(|t| 0.5 * mesh.doubled_normal(t).norm()).sum();
        assert!((plain / area - 1.0).abs() < share, "triangles {plain} for {area}");
        mesh
    }

    fn check(&self, area: f64, volume: f64) -> Mesh {
        let mesh = self.check_area(area, 0.02);
        let measures = measure(&self.0, &mesh);
        assert!((measures.volume / volume - 1.0).abs() < 1e-4, "volume {} for {volume}", measures.volume);
        assert_closed(&mesh);
        mesh
    }
}

/// Every side of a triangle belongs to one more triangle, which runs along it the other way.
fn assert_closed(mesh: &Mesh) {
    let mut ids = BTreeMap::new();
    let mut id = |p: &Point| {
        let key = [p.x, p.y, p.z].map(|c| (c * 1e7).round() as i64);
        let next = ids.len();
        *ids.entry(key).or_insert(next)
    };
    let mut sides: BTreeMap<(usize, usize), i32> = BTreeMap::new();
    for t in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(t).map(|p| id(&p));
        if a != b && b != c && c != a {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *sides.entry((from.min(to), from.max(to))).or_default() += if from < to { 1 } else { -1 };
            }
        }
    }
    let places: BTreeMap<usize, [i64; 3]> = ids.into_iter().map(|(key, id)| (id, key)).collect();
    let open: Vec<_> = sides.iter().filter(|(_, n)| **n != 0).map(|((a, b), n)| (places[a], places[b], n)).collect();
    assert!(open.is_empty(), "sides that are not closed, in 1e-7 mm: {open:?}");
}

/// The circle with centre (x, 0, z) in the plane of x and z.
fn upright(x: f64, z: f64, radius: f64) -> Curve {
    let placement = Placement { origin: Point::new(x, 0.0, z), x: Vector::x(), y: Vector::z(), z: -Vector::y() };
    Curve::Circle { placement, radius }
}
