//! Models made by hand for the tests of the stages: solids of flat faces.

use rustc_hash::FxHashMap;
use smallvec::smallvec;

use super::parse::Parsed;
use crate::brep::measure::Measures;
use crate::brep::{
    Body, BodyId, Edge, EdgeId, EdgeUse, Face, FaceGeometry, FaceId, FaceLoop, Mesh, MeshFace, Model, Occurrence,
    Placement, Shell, Surface, Vertex, VertexId, Wireframe,
};
use crate::geometry::{Aabb, Point, Tolerance, Transform, Vector};

/// A solid whose faces are star-shaped polygons, counter-clockwise seen from outside, moved by `placement`.
pub fn solid(polygons: &[Vec<Point>], placement: &Transform) -> Parsed {
    let mut builder =
        Builder { model: Model::empty(), mesh: Mesh::default(), placement: *placement, seen: FxHashMap::default() };
    polygons.iter().for_each(|p| builder.face(p));
    builder.finish()
}

/// Puts the body of a solid made where it is, unmoved, at one more place.
pub fn add_copy(parsed: &mut Parsed, placement: &Transform) {
    let occurrence = parsed.model.occurrences.len() as u32;
    let path = format!("{}", occurrence + 1);
    parsed.model.occurrences.push(Occurrence { path, body: BodyId(0), placement: *placement });
    let Mesh { points, triangles, faces } = &mut parsed.mesh;
    let (first_point, first_triangle) = (points.len() as u32, triangles.len() as u32);
    let of_one: Vec<_> = faces.iter().filter(|f| f.occurrence == 0).cloned().collect();
    let Some(last) = of_one.last() else { return };
    let (points_end, triangles_end) = (last.points.end as usize, last.triangles.end as usize);
    let copies: Vec<_> = points[..points_end].iter().map(|p| placement.point(p)).collect();
    points.extend(copies);
    triangles.extend_from_within(..triangles_end);
    for triangle in &mut triangles[first_triangle as usize..] {
        *triangle = triangle.map(|i| i + first_point);
        if placement.mirrors() {
            triangle.swap(1, 2);
        }
    }
    faces.extend(of_one.into_iter().map(|f| MeshFace {
        occurrence,
        points: f.points.start + first_point..f.points.end + first_point,
        triangles: f.triangles.start + first_triangle..f.triangles.end + first_triangle,
        area: f.area * placement.scale().powi(2),
        centroid: placement.point(&f.centroid),
        flux: f.flux * placement.scale().powi(3),
        ..f
    }));
}

/// The faces of a prism over a polygon in the plane z = 0 (counter-clockwise) of height `h`.
pub fn prism(base: &[[f64; 2]], h: f64) -> Vec<Vec<Point>> {
    let at = |z: f64| base.iter().map(move |&[x, y]| Point::new(x, y, z));
    let mut faces = vec![at(0.0).rev().collect(), at(h).collect::<Vec<_>>()];
    let n = base.len();
    for i in 0..n {
        let ([a, b], [c, d]) = (base[i], base[(i + 1) % n]);
        faces.push(vec![Point::new(a, b, 0.0), Point::new(c, d, 0.0), Point::new(c, d, h), Point::new(a, b, h)]);
    }
    faces
}

/// The faces of a box from the origin to (x, y, z).
pub fn cuboid(x: f64, y: f64, z: f64) -> Vec<Vec<Point>> {
    prism(&[[0.0, 0.0], [x, 0.0], [x, y], [0.0, y]], z)
}

/// A regular polygon of `n` corners and radius `r` about the origin.
pub fn regular(n: usize, r: f64) -> Vec<[f64; 2]> {
    let angle = |i: usize| i as f64 * std::f64::consts::TAU / n as f64;
    (0..n).map(|i| [r * angle(i).cos(), r * angle(i).sin()]).collect()
}

struct Builder {
    model: Model,
    mesh: Mesh,
    placement: Transform,
    seen: FxHashMap<[u64; 3], VertexId>,
}

impl Builder {
    fn vertex(&mut self, p: &Point) -> VertexId {
        let id = VertexId(self.model.vertices.len() as u32);
        let found = *self.seen.entry([p.x, p.y, p.z].map(|c| (c + 0.0).to_bits())).or_insert(id);
        if found == id {
            self.model.vertices.push(Vertex { entity: 1000 + u64::from(id.0), point: *p });
        }
        found
    }

    fn edge(&mut self, start: VertexId, end: VertexId) -> EdgeUse {
        let joins = |e: &Edge| (e.start, e.end) == (start, end) || (e.end, e.start) == (start, end);
        let at = self.model.edges.iter().position(joins).unwrap_or_else(|| {
            let entity = 5000 + self.model.edges.len() as u64;
            self.model.edges.push(Edge { entity, curve: None, start, end, same_sense: true });
            self.model.edges.len() - 1
        });
        EdgeUse { edge: EdgeId(at as u32), forward: self.model.edges[at].start == start }
    }

    fn face(&mut self, polygon: &[Point]) {
        let ids: Vec<_> = polygon.iter().map(|p| self.vertex(p)).collect();
        let next = |i: usize| ids[(i + 1) % ids.len()];
        let uses = (0..ids.len()).map(|i| self.edge(ids[i], next(i))).collect();
        let index = self.model.faces.len() as u32;
        let entity = 10 + u64::from(index);
        let face_loop = FaceLoop { entity, uses, pole: None, outer: true };
        let normal = doubled_area(polygon).normalize();
        let x = crate::geometry::any_perpendicular(&normal);
        let plane = Surface::Plane(Placement { origin: polygon[0], x, y: normal.cross(&x), z: normal });
        let geometry = FaceGeometry::Trimmed { surface: self.model.add_surface(plane), same_sense: true };
        self.model.faces.push(Face { entity, geometry, loops: smallvec![face_loop], shell: 0 });
        self.mesh_face(FaceId(index), polygon);
    }

    /// A fan about the middle.
    fn mesh_face(&mut self, face: FaceId, polygon: &[Point]) {
        let (first, start) = (self.mesh.points.len() as u32, self.mesh.triangles.len() as u32);
        let n = polygon.len() as u32;
        self.mesh.points.extend(polygon.iter().map(|p| self.placement.point(p)));
        self.mesh.points.push(self.placement.point(&crate::geometry::isometry::mean(polygon)));
        let turned = self.placement.mirrors();
        let triangle = |i: u32| {
            if turned {
                [first + (i + 1) % n, first + i, first + n]
            } else {
                [first + i, first + (i + 1) % n, first + n]
            }
        };
        self.mesh.triangles.extend((0..n).map(triangle));
        let (mut area, mut moment) = (0.0, Vector::zeros());
        for t in start as usize..self.mesh.triangles.len() {
            let (a, [p, q, r]) = (0.5 * self.mesh.doubled_normal(t).norm(), self.mesh.corners(t));
            area += a;
            moment += (p.coords + q.coords + r.coords) * (a / 3.0);
        }
        self.mesh.faces.push(MeshFace {
            face,
            occurrence: 0,
            points: first..first + n + 1,
            triangles: start..start + n,
            area,
            centroid: Point::from(moment / area),
            flux: (start as usize..self.mesh.triangles.len())
                .map(|t| {
                    let [p, q, r] = self.mesh.corners(t);
                    p.coords.cross(&q.coords).dot(&r.coords) / 6.0
                })
                .sum(),
        });
    }

    fn finish(mut self) -> Parsed {
        let faces = (0..self.model.faces.len()).map(|i| FaceId(i as u32)).collect();
        self.model.shells.push(Shell { entity: 2, closed: true, faces });
        self.model.bodies.push(Body { entity: 1, solid: true, shells: vec![0] });
        self.model.occurrences.push(Occurrence { path: String::new(), body: BodyId(0), placement: self.placement });
        let area: f64 = self.mesh.faces.iter().map(|f| f.area).sum();
        let moment: Vector = self.mesh.faces.iter().map(|f| f.centroid.coords * f.area).sum();
        let centroid = Point::from(moment / area);
        let reach = self.mesh.points.iter().map(|p| (p - centroid).norm()).fold(0.0, f64::max);
        let volume = self.mesh.faces.iter().map(|f| f.flux).sum();
        let bounds = Aabb::of(&self.mesh.points);
        let measures = Measures { area, volume, centroid, bounds, tolerance: Tolerance::of(2.0 * reach) };
        let wireframe = Wireframe::of(&self.mesh);
        let (skipped, warnings) = Default::default();
        Parsed { model: self.model, mesh: self.mesh, wireframe, measures, skipped, warnings }
    }
}

fn doubled_area(polygon: &[Point]) -> Vector {
    (1..polygon.len() - 1).map(|i| (polygon[i] - polygon[0]).cross(&(polygon[i + 1] - polygon[0]))).sum()
}
