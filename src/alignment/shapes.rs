//! Small meshes for tests.

use crate::brep::measure::Measures;
use crate::brep::{FaceId, Mesh, MeshFace};
use crate::geometry::{Aabb, Matrix, Point, Tolerance, Vector};

/// A mesh of one face from points and triangles.
pub fn mesh(points: Vec<Point>, triangles: Vec<[u32; 3]>) -> Mesh {
    let mut mesh = Mesh { points, triangles, faces: Vec::new() };
    let face = MeshFace {
        face: FaceId(0),
        occurrence: 0,
        points: 0..mesh.points.len() as u32,
        triangles: 0..mesh.triangles.len() as u32,
        area: area(&mesh),
        flux: 0.0,
        centroid: centroid(&mesh),
    };
    mesh.faces.push(face);
    mesh
}

fn area(mesh: &Mesh) -> f64 {
    (0..mesh.triangles.len()).map(|t| 0.5 * mesh.doubled_normal(t).norm()).sum()
}

fn centroid(mesh: &Mesh) -> Point {
    let mut moment = Vector::zeros();
    for t in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(t).map(|p| p.coords);
        moment += (a + b + c) * (mesh.doubled_normal(t).norm() / 6.0);
    }
    Point::from(moment / area(mesh))
}

/// What a test mesh measures.
pub fn measures(mesh: &Mesh) -> Measures {
    let centroid = centroid(mesh);
    let radius = mesh.points.iter().map(|p| (p - centroid).norm()).fold(0.0, f64::max);
    Measures {
        area: area(mesh),
        volume: 0.0,
        centroid,
        bounds: Aabb::of(&mesh.points),
        tolerance: Tolerance::of(2.0 * radius),
    }
}

/// A box from the origin to (x, y, z).
pub fn cuboid(x: f64, y: f64, z: f64) -> Mesh {
    prism(&[[0.0, 0.0], [x, 0.0], [x, y], [0.0, y]], &[[0, 1, 2], [0, 2, 3]], z)
}

/// A counter-clockwise polygon with its triangulation, raised from z = 0 to `height`.
pub fn prism(polygon: &[[f64; 2]], caps: &[[u32; 3]], height: f64) -> Mesh {
    let n = polygon.len() as u32;
    let at = |z: f64| polygon.iter().map(move |p| Point::new(p[0], p[1], z));
    let mut triangles = Vec::new();
    for &[a, b, c] in caps {
        triangles.push([a, c, b]);
        triangles.push([a + n, b + n, c + n]);
    }
    for i in 0..n {
        let j = (i + 1) % n;
        triangles.push([i, j, j + n]);
        triangles.push([i, j + n, i + n]);
    }
    mesh(at(0.0).chain(at(height)).collect(), triangles)
}

/// A letter F of height 5, width 3 and thickness `height`: no symmetry but that of its thickness.
pub fn letter_f(height: f64) -> Mesh {
    let polygon = [
        [0.0, 0.0],
        [1.0, 0.0],
        [1.0, 2.0],
        [2.0, 2.0],
        [2.0, 3.0],
        [1.0, 3.0],
        [1.0, 4.0],
        [3.0, 4.0],
        [3.0, 5.0],
        [0.0, 5.0],
    ];
    let caps = [[0, 1, 2], [0, 2, 5], [2, 3, 4], [2, 4, 5], [0, 5, 6], [0, 6, 9], [6, 7, 8], [6, 8, 9]];
    prism(&polygon, &caps, height)
}

/// A flat rectangle x by y in the plane z = 0.
pub fn rectangle(x: f64, y: f64) -> Mesh {
    let points = [[0.0, 0.0], [x, 0.0], [x, y], [0.0, y]].map(|[x, y]| Point::new(x, y, 0.0));
    mesh(points.to_vec(), vec![[0, 1, 2], [0, 2, 3]])
}

/// An ellipsoid with the given half axes, of 2 x rings x rings quadrilaterals.
pub fn ellipsoid(half: [f64; 3], rings: u32) -> Mesh {
    let around = 2 * rings;
    let mut points = Vec::new();
    for i in 0..=rings {
        let polar = std::f64::consts::PI * f64::from(i) / f64::from(rings);
        for j in 0..around {
            let turn = std::f64::consts::TAU * f64::from(j) / f64::from(around);
            let ring = polar.sin();
            points.push(Point::new(half[0] * ring * turn.cos(), half[1] * ring * turn.sin(), half[2] * polar.cos()));
        }
    }
    let mut triangles = Vec::new();
    for i in 0..rings {
        for j in 0..around {
            let (a, b) = (i * around + j, i * around + (j + 1) % around);
            triangles.push([a, a + around, b + around]);
            triangles.push([a, b + around, b]);
        }
    }
    mesh(points, triangles)
}

/// Both meshes in one.
pub fn joined(a: &Mesh, b: &Mesh) -> Mesh {
    let shift = a.points.len() as u32;
    let points = a.points.iter().chain(&b.points).copied().collect();
    let moved = b.triangles.iter().map(|t| t.map(|i| i + shift));
    mesh(points, a.triangles.iter().copied().chain(moved).collect())
}

/// The mesh with every point p replaced by f(p).
pub fn mapped(source: &Mesh, f: impl Fn(&Point) -> Point) -> Mesh {
    mesh(source.points.iter().map(f).collect(), source.triangles.clone())
}

/// The mesh turned about the origin.
pub fn turned(source: &Mesh, rotation: &Matrix) -> Mesh {
    mapped(source, |p| rotation * p)
}

/// A rotation by three angles.
pub fn rotation(roll: f64, pitch: f64, yaw: f64) -> Matrix {
    nalgebra::Rotation3::from_euler_angles(roll, pitch, yaw).into_inner()
}
