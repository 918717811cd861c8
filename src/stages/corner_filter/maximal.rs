//! Maximal faces: adjacent faces that lie on one underlying surface, joined.

use crate::brep::{EdgeId, FaceId, Model, Placement, Surface};
use crate::cancel::{Cancel, Cancelled};
use crate::memory::{empty, held};

/// Groups of faces that form one maximal face each, found in one body after the other.
#[derive(Default)]
pub(super) struct Groups {
    /// For each edge of the model the faces of the body that use it.
    users: Vec<Users>,
    joined: Joined,
    /// The faces of one group after the other, and where each group ends.
    faces: Vec<FaceId>,
    ends: Vec<usize>,
}

/// How often an edge is used, and the positions of the faces that use it first and second.
#[derive(Clone, Copy, Default)]
struct Users {
    count: u32,
    faces: [u32; 2],
}

impl Groups {
    /// No groups of a model yet.
    pub fn clear(&mut self, model: &Model) {
        empty(&mut self.users, model.edges.len());
        self.users.resize(model.edges.len(), Users::default());
    }

    /// Bytes of memory that they hold.
    pub fn bytes(&self) -> usize {
        let joined = held(&self.joined.towards_root) + held(&self.joined.places);
        held(&self.users) + joined + held(&self.faces) + held(&self.ends)
    }

    /// Finds the groups of these faces. Without a tolerance (mm) every face is its own group.
    pub fn find(
        &mut self,
        model: &Model,
        faces: &[FaceId],
        tolerance: Option<f64>,
        cancel: &Cancel,
    ) -> Result<(), Cancelled> {
        self.joined.clear(faces.len());
        if let Some(tolerance) = tolerance {
            self.note_users(model, faces);
            for (i, edge) in edges_of(model, faces) {
                let Users { count, faces: [a, b] } = self.users[edge.index()];
                // What more than two faces use, or one twice, joins none.
                if count != 2 || a != i || b == i {
                    continue;
                }
                cancel.check()?;
                let both = [a, b].map(|i| faces[i as usize]);
                if self.joined.root(a) != self.joined.root(b) && continues(model, both, tolerance) {
                    self.joined.join(a, b);
                }
            }
        }
        self.joined.groups(faces, &mut self.faces, &mut self.ends);
        Ok(())
    }

    /// The groups in the order of their first faces.
    pub fn iter(&self) -> impl Iterator<Item = &[FaceId]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(from, to)| &self.faces[from..*to])
    }

    fn note_users(&mut self, model: &Model, faces: &[FaceId]) {
        edges_of(model, faces).for_each(|(_, edge)| self.users[edge.index()].count = 0);
        for (i, edge) in edges_of(model, faces) {
            let users = &mut self.users[edge.index()];
            if let Some(place) = users.faces.get_mut(users.count as usize) {
                *place = i;
            }
            users.count += 1;
        }
    }
}

/// The edges of faces, each with the position of its face.
fn edges_of<'a>(model: &'a Model, faces: &'a [FaceId]) -> impl Iterator<Item = (u32, EdgeId)> + 'a {
    let loops = (0..).zip(faces).flat_map(|(i, face)| model.faces[face.index()].loops.iter().map(move |l| (i, l)));
    loops.flat_map(|(i, l)| l.uses.iter().map(move |u| (i, u.edge)))
}

/// Whether both faces lie on one surface with the same side out.
fn continues(model: &Model, faces: [FaceId; 2], tolerance: f64) -> bool {
    let [a, b] = faces.map(|face| model.surface_of(&model.faces[face.index()]));
    let (Some((s, s_sense)), Some((t, t_sense))) = (a, b) else { return false };
    match same_surface(s, t, tolerance) {
        Some(Side::Same) => s_sense == t_sense,
        Some(Side::Opposite) => s_sense != t_sense,
        None => false,
    }
}

/// Whether the surface normals of two equal surfaces agree.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Side {
    Same,
    Opposite,
}

/// Whether two surfaces are the same set of points within the tolerance, mm.
fn same_surface(s: &Surface, t: &Surface, tolerance: f64) -> Option<Side> {
    let near = |x: f64, y: f64| (x - y).abs() <= tolerance;
    let same = |yes: bool| yes.then_some(Side::Same);
    match (s, t) {
        (Surface::Rectangular { basis, .. }, other) | (other, Surface::Rectangular { basis, .. }) => {
            same_surface(basis, other, tolerance)
        }
        (Surface::Plane(p), Surface::Plane(q)) => {
            let flat = p.z.cross(&q.z).norm() <= PARALLEL && near((q.origin - p.origin).dot(&p.z), 0.0);
            flat.then(|| if p.z.dot(&q.z) > 0.0 { Side::Same } else { Side::Opposite })
        }
        (Surface::Cylinder { placement: p, radius: r }, Surface::Cylinder { placement: q, radius: s }) => {
            same(same_axis(p, q, tolerance) && near(*r, *s))
        }
        (Surface::Sphere { placement: p, radius: r }, Surface::Sphere { placement: q, radius: s }) => {
            same(near((p.origin - q.origin).norm(), 0.0) && near(*r, *s))
        }
        (Surface::Torus { placement: p, major: a, minor: b }, Surface::Torus { placement: q, major: c, minor: d }) => {
            let centre = near((p.origin - q.origin).norm(), 0.0);
            same(centre && same_axis(p, q, tolerance) && near(*a, *c) && near(*b, *d))
        }
        (
            Surface::Cone { placement: p, radius: a, half_angle: b },
            Surface::Cone { placement: q, radius: c, half_angle: d },
        ) => {
            let along = p.z.dot(&q.z).signum();
            let radius = a + (q.origin - p.origin).dot(&p.z) * b.tan();
            same(same_axis(p, q, tolerance) && near(radius, *c) && (b - along * d).abs() <= PARALLEL)
        }
        (Surface::Nurbs(a), Surface::Nurbs(b)) => {
            let equal = a.points.len() == b.points.len()
                && a.columns == b.columns
                && a.weights == b.weights
                && a.points.iter().zip(&b.points).all(|(p, q)| (p - q).norm() <= tolerance);
            same(equal && a.degree_u == b.degree_u && a.degree_v == b.degree_v)
        }
        _ => None,
    }
}

/// Sine of the angle between directions that count as parallel: 0.006 degrees, the precision of directions in files
/// that write few digits.
const PARALLEL: f64 = 1e-4;

fn same_axis(p: &Placement, q: &Placement, tolerance: f64) -> bool {
    let between = q.origin - p.origin;
    p.z.cross(&q.z).norm() <= PARALLEL && p.z.cross(&between).norm() <= tolerance
}

/// Disjoint sets of positions; the root of a set is its smallest member.
#[derive(Default)]
struct Joined {
    towards_root: Vec<u32>,
    /// Of each root, where its next face goes.
    places: Vec<usize>,
}

impl Joined {
    /// Each of `count` positions by itself.
    fn clear(&mut self, count: usize) {
        self.towards_root.clear();
        self.towards_root.extend(0..count as u32);
    }

    fn root(&mut self, mut i: u32) -> u32 {
        let next = &mut self.towards_root;
        while next[i as usize] != i {
            next[i as usize] = next[next[i as usize] as usize];
            i = next[i as usize];
        }
        i
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.towards_root[a.max(b) as usize] = a.min(b);
    }

    /// The sets, one after the other in the order of their roots, of what stands at these positions in `faces`.
    fn groups(&mut self, faces: &[FaceId], out: &mut Vec<FaceId>, ends: &mut Vec<usize>) {
        let count = self.towards_root.len() as u32;
        self.places.clear();
        self.places.resize(faces.len(), 0);
        for i in 0..count {
            let root = self.root(i);
            self.places[root as usize] += 1;
        }
        ends.clear();
        let mut end = 0;
        for i in (0..count as usize).filter(|&i| self.towards_root[i] == i as u32) {
            let size = std::mem::replace(&mut self.places[i], end);
            end += size;
            ends.push(end);
        }
        out.clear();
        out.resize(faces.len(), FaceId(0));
        for (i, face) in (0..count).zip(faces) {
            let place = &mut self.places[self.towards_root[i as usize] as usize];
            out[*place] = *face;
            *place += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, Vector};

    fn placement(origin: [f64; 3], z: Vector) -> Placement {
        let x = crate::geometry::any_perpendicular(&z);
        Placement { origin: Point::from(origin), x, y: z.cross(&x), z }
    }

    #[test]
    fn a_cylinder_is_the_same_wherever_its_placement_lies_on_the_axis() {
        let cylinder =
            |h: f64, z: Vector, radius: f64| Surface::Cylinder { placement: placement([0.0, 0.0, h], z), radius };
        let a = cylinder(0.0, Vector::z(), 2.0);
        assert_eq!(same_surface(&a, &cylinder(5.0, -Vector::z(), 2.0), 1e-6), Some(Side::Same));
        assert_eq!(same_surface(&a, &cylinder(5.0, Vector::z(), 2.1), 1e-6), None);
    }

    #[test]
    fn opposite_cones_are_the_same_only_with_opposite_angles() {
        // Radius 1 at height 0, 3 at height 2: half angle 45 degrees.
        let quarter = std::f64::consts::FRAC_PI_4;
        let up = Surface::Cone { placement: placement([0.0; 3], Vector::z()), radius: 1.0, half_angle: quarter };
        let down =
            |half_angle| Surface::Cone { placement: placement([0.0, 0.0, 2.0], -Vector::z()), radius: 3.0, half_angle };
        assert_eq!(same_surface(&up, &down(-quarter), 1e-6), Some(Side::Same));
        assert_eq!(same_surface(&up, &down(quarter), 1e-6), None);
    }

    #[test]
    fn joined_positions_stand_side_by_side() {
        let mut joined = Joined::default();
        joined.clear(6);
        [(5, 1), (4, 2), (1, 3)].iter().for_each(|&(a, b)| joined.join(a, b));
        let faces = [10, 11, 12, 13, 14, 15].map(FaceId);
        let (mut out, mut ends) = (Vec::new(), Vec::new());
        joined.groups(&faces, &mut out, &mut ends);
        assert_eq!((out, ends), ([10, 11, 13, 15, 12, 14].map(FaceId).to_vec(), vec![1, 4, 6]));
    }

    #[test]
    fn planes_know_their_sides() {
        let plane = |z: Vector| Surface::Plane(placement([1.0, 1.0, 0.0], z));
        assert_eq!(same_surface(&plane(Vector::z()), &plane(-Vector::z()), 1e-6), Some(Side::Opposite));
    }
}
