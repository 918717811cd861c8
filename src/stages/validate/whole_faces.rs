//! Whole faces that an isometry maps onto whole faces: none of their samples needs to be asked.

use crate::brep::{Mesh, PlacedFaceId};
use crate::geometry::{Isometry, Point, PointGrid, Vector};

/// Looks at other points that finding the image of a point may take on average, before the face is asked by its samples.
const LOOKS: usize = 64;
/// Areas of images differ by this share at most ..
const AREA: f64 = 1e-3;
/// .. and the integrals of their normals by this share of the area.
const NORMALS: f64 = 1e-2;

/// What is needed to tell that one face is the image of another one: centroid, area, normals, and where the points of
/// its mesh are.
#[derive(Clone, Debug)]
pub struct WholeFaces {
    centroids: PointGrid,
    faces: Vec<Face>,
    points: Vec<Point>,
    /// How far images may be off, mm.
    radius: f64,
    /// Whether an image may be turned inside out.
    both: bool,
}

#[derive(Clone, Debug)]
struct Face {
    area: f64,
    /// Integral of the normals, mm^2.
    normals: Vector,
    /// Integral of the distance from the centroid along the normals, mm^3: no isometry changes it, and what bends the
    /// other way has the opposite.
    bulge: f64,
    /// In [`WholeFaces::points`].
    points: std::ops::Range<u32>,
}

impl Face {
    fn of(mesh: &Mesh, id: PlacedFaceId) -> Self {
        let face = &mesh.faces[id.index()];
        let (mut normals, mut bulge) = (Vector::zeros(), 0.0);
        for t in mesh.triangles_of(id) {
            let normal = mesh.doubled_normal(t) * 0.5;
            normals += normal;
            // The same at all points of the triangle.
            bulge += (mesh.corners(t)[0] - face.centroid).dot(&normal);
        }
        Self { area: face.area, normals, bulge, points: face.points.clone() }
    }
}

impl WholeFaces {
    /// The faces of a mesh; images may be off by `radius`, mm, and turned inside out if `both` sides are alike.
    pub fn of(mesh: &Mesh, radius: f64, both: bool) -> Self {
        let faces = (0..mesh.faces.len() as u32).map(|i| Face::of(mesh, PlacedFaceId(i))).collect();
        let centroids = PointGrid::new(mesh.faces.iter().map(|f| f.centroid), 8.0 * radius);
        Self { centroids, faces, points: mesh.points.clone(), radius, both }
    }

    /// The faces under an isometry.
    pub fn under<'a>(&'a self, isometry: &'a Isometry) -> Mapped<'a> {
        Mapped {
            faces: self,
            isometry,
            goes_back: isometry.is_involution(self.radius),
            known: vec![None; self.faces.len()],
        }
    }

    /// The face that the isometry maps a face onto (itself, maybe), if it is one.
    fn image(&self, isometry: &Isometry, id: PlacedFaceId) -> Option<PlacedFaceId> {
        let centroid = isometry.apply(self.centroids.point(id.0));
        let mut near = self.centroids.near(&centroid, self.radius).map(PlacedFaceId);
        near.find(|&other| self.is_image(isometry, id, other))
    }

    /// Whether the isometry maps face `a` onto face `b`.
    pub fn maps_onto(&self, isometry: &Isometry, a: PlacedFaceId, b: PlacedFaceId) -> bool {
        let centroid = isometry.apply(self.centroids.point(a.0));
        (self.centroids.point(b.0) - centroid).norm() <= self.radius && self.is_image(isometry, a, b)
    }

    /// The same of faces with matching centroids.
    fn is_image(&self, isometry: &Isometry, a: PlacedFaceId, b: PlacedFaceId) -> bool {
        let (face, other) = (&self.faces[a.index()], &self.faces[b.index()]);
        let (points, others) = (self.points_of(face), self.points_of(other));
        let normals = isometry.rotation * face.normals;
        let agree = |sign: f64| {
            (normals - other.normals * sign).norm() <= NORMALS * face.area
                && (face.bulge - other.bulge * sign).abs() <= self.radius * face.area + NORMALS * face.bulge.abs()
        };
        (face.area - other.area).abs() <= AREA * face.area
            && points.len() == others.len()
            && (agree(1.0) || (self.both && agree(-1.0)))
            && self.meet(isometry, points, others)
    }

    fn points_of(&self, face: &Face) -> &[Point] {
        &self.points[face.points.start as usize..face.points.end as usize]
    }

    /// Whether each point's image is near one of the others. Images mostly follow each other as the points do, or the
    /// other way around.
    fn meet(&self, isometry: &Isometry, points: &[Point], others: &[Point]) -> bool {
        let (limit, count) = (self.radius * self.radius, others.len());
        let (mut last, mut looks) = (0, LOOKS * count);
        points.iter().all(|p| {
            let image = isometry.apply(p);
            let near = |&i: &usize| (others[i] - image).norm_squared() <= limit;
            let neighbours = [(last + 1) % count, (last + count - 1) % count];
            let found = neighbours.into_iter().find(near).or_else(|| {
                looks = looks.saturating_sub(count);
                (0..if looks > 0 { count } else { 0 }).find(near)
            });
            last = found.unwrap_or(last);
            found.is_some()
        })
    }
}

/// Which faces an isometry maps onto others; each is looked up once at most.
#[derive(Clone, Debug)]
pub struct Mapped<'a> {
    faces: &'a WholeFaces,
    isometry: &'a Isometry,
    /// Whether the isometry maps images back.
    goes_back: bool,
    known: Vec<Option<bool>>,
}

impl Mapped<'_> {
    /// Faces of the mesh.
    pub fn count(&self) -> usize {
        self.known.len()
    }

    /// Whether a face is mapped onto one other (or itself).
    pub fn has(&mut self, id: PlacedFaceId) -> bool {
        if let Some(known) = self.known[id.index()] {
            return known;
        }
        let image = self.faces.image(self.isometry, id);
        if let Some(image) = image
            && self.goes_back
        {
            self.known[image.index()] = Some(true);
        }
        self.known[id.index()] = Some(image.is_some());
        image.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::{FaceId, MeshFace};
    use crate::geometry::Plane;
    use crate::geometry::revolution::turn;
    use std::f64::consts::FRAC_PI_2;

    /// Faces of one triangle each.
    fn mesh(triangles: &[[[f64; 3]; 3]]) -> Mesh {
        let mut mesh = Mesh::default();
        for (i, corners) in (0..).zip(triangles) {
            let corners = corners.map(Point::from);
            let doubled = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
            mesh.points.extend(corners);
            mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
            mesh.faces.push(MeshFace {
                face: FaceId(i),
                occurrence: 0,
                points: 3 * i..3 * i + 3,
                triangles: i..i + 1,
                area: 0.5 * doubled.norm(),
                centroid: Point::from((corners[0].coords + corners[1].coords + corners[2].coords) / 3.0),
                flux: 0.0,
            });
        }
        mesh
    }

    #[test]
    fn a_pin_is_no_image_of_a_hole() {
        // Octahedra: the integrals of their normals are zero, whichever way they face.
        let octahedron = |x: f64| {
            let ring = [[x - 1.0, 0.0, 0.0], [x, -1.0, 0.0], [x + 1.0, 0.0, 0.0], [x, 1.0, 0.0]];
            (0..8).map(move |i| {
                let (p, q) = (ring[i % 4], ring[(i + 1) % 4]);
                if i < 4 { [p, q, [x, 0.0, 1.0]] } else { [q, p, [x, 0.0, -1.0]] }
            })
        };
        let one_face = |right: Vec<[[f64; 3]; 3]>, left: Vec<[[f64; 3]; 3]>| {
            let mut mesh = mesh(&[right, left].concat());
            for i in [0, 1] {
                let first = &mesh.faces[8 * i];
                let whole = MeshFace {
                    points: first.points.start..first.points.start + 24,
                    triangles: first.triangles.start..first.triangles.start + 8,
                    area: 8.0 * first.area,
                    centroid: Point::new([5.0, -5.0][i], 0.0, 0.0),
                    ..first.clone()
                };
                mesh.faces[i] = whole;
            }
            mesh.faces.truncate(2);
            mesh
        };
        let turned = |t: [[f64; 3]; 3]| [t[1], t[0], t[2]];
        let mirror = Plane { normal: Vector::x(), offset: 0.0 }.reflection();
        let pin = || octahedron(5.0).collect();
        let maps = |left, both| {
            let faces = WholeFaces::of(&one_face(pin(), left), 1e-3, both);
            faces.under(&mirror).has(PlacedFaceId(0))
        };
        assert!(maps(octahedron(-5.0).collect(), false));
        assert!(!maps(octahedron(-5.0).map(turned).collect(), false));
        assert!(maps(octahedron(-5.0).map(turned).collect(), true));
    }

    #[test]
    fn only_an_isometry_that_goes_back_tells_of_the_image_too() {
        // Of four places about the z axis only two hold a face: a quarter turn maps the first onto the second, and the
        // second onto none.
        let turned = |[x, y, z]: [f64; 3]| [-y, x, z];
        let first = [[1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
        let faces = WholeFaces::of(&mesh(&[first, first.map(turned)]), 1e-3, false);
        let quarter = Isometry::about(&Point::origin(), &turn(&Vector::z(), FRAC_PI_2));
        let mut mapped = faces.under(&quarter);
        assert_eq!([0, 1].map(|i| mapped.has(PlacedFaceId(i))), [true, false]);
    }

    #[test]
    fn a_face_is_mapped_onto_its_image_alone() {
        let right = [[1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
        // Mirrored in x = 0, the corners turned around and in another order.
        let left = [[-1.0, 1.0, 0.0], [-3.0, 0.0, 0.0], [-1.0, 0.0, 0.0]];
        let inside_out = [left[2], left[1], left[0]];
        // The same area and nearly the same centroid, other corners.
        let other = [[-1.0, 0.0, 0.0], [-3.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
        let mirror = Plane { normal: Vector::x(), offset: 0.0 }.reflection();
        for (image, both, maps) in
            [(left, false, true), (inside_out, false, false), (inside_out, true, true), (other, true, false)]
        {
            let faces = WholeFaces::of(&mesh(&[right, image]), 1e-3, both);
            let mut mapped = faces.under(&mirror);
            assert_eq!([0, 1, 0].map(|i| mapped.has(PlacedFaceId(i))), [maps; 3]);
            assert_eq!(faces.maps_onto(&mirror, PlacedFaceId(0), PlacedFaceId(1)), maps);
            assert!(!faces.maps_onto(&mirror, PlacedFaceId(0), PlacedFaceId(0)));
        }
    }
}
