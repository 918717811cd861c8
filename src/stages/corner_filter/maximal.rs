//! Maximal faces: adjacent faces that lie on one underlying surface, joined.

use crate::brep::{EdgeId, Face, FaceGeometry, FaceId, Model, Placement, Surface};
use crate::cancel::{Cancel, Cancelled};

/// Groups of faces that form one maximal face each, in the order of their first face. Without a tolerance (mm)
/// every face is its own group.
pub(super) fn groups(
    model: &Model,
    faces: &[FaceId],
    tolerance: Option<f64>,
    cancel: &Cancel,
) -> Result<Vec<Vec<FaceId>>, Cancelled> {
    let mut joined = Joined::new(faces.len());
    if let Some(tolerance) = tolerance {
        for (a, b) in adjacent(model, faces) {
            cancel.check()?;
            if joined.root(a) != joined.root(b) && continues(model, faces[a], faces[b], tolerance) {
                joined.join(a, b);
            }
        }
    }
    Ok(joined.groups(faces))
}

/// Positions of two faces that share an edge which no third face uses, in the order of the edges.
fn adjacent(model: &Model, faces: &[FaceId]) -> Vec<(usize, usize)> {
    let count = faces.iter().flat_map(|face| &model.faces[face.index()].loops).map(|l| l.uses.len()).sum();
    let mut users: Vec<(EdgeId, usize)> = Vec::with_capacity(count);
    for (i, face) in faces.iter().enumerate() {
        let uses = model.faces[face.index()].loops.iter().flat_map(|l| &l.uses);
        users.extend(uses.map(|u| (u.edge, i)));
    }
    users.sort_unstable();
    let of_edges = users.chunk_by(|a, b| a.0 == b.0);
    let mut pairs: Vec<_> = of_edges
        .filter_map(|users| match users {
            [(_, a), (_, b)] if a != b => Some((*a, *b)),
            _ => None,
        })
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// Whether both faces lie on one surface with the same side out.
fn continues(model: &Model, a: FaceId, b: FaceId, tolerance: f64) -> bool {
    let (a, b) = (&model.faces[a.index()], &model.faces[b.index()]);
    let (Some((s, s_sense)), Some((t, t_sense))) = (surface(a), surface(b)) else { return false };
    match same_surface(s, t, tolerance) {
        Some(Side::Same) => s_sense == t_sense,
        Some(Side::Opposite) => s_sense != t_sense,
        None => false,
    }
}

fn surface(face: &Face) -> Option<(&Surface, bool)> {
    match &face.geometry {
        FaceGeometry::Trimmed { surface, same_sense } => Some((surface, *same_sense)),
        FaceGeometry::Faceted(_) => None,
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
struct Joined(Vec<usize>);

impl Joined {
    fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    fn root(&mut self, mut i: usize) -> usize {
        while self.0[i] != i {
            self.0[i] = self.0[self.0[i]];
            i = self.0[i];
        }
        i
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b);
    }

    /// The sets, of what stands at these positions in `faces`.
    fn groups(mut self, faces: &[FaceId]) -> Vec<Vec<FaceId>> {
        let mut at = vec![usize::MAX; self.0.len()];
        let mut groups: Vec<Vec<FaceId>> = Vec::with_capacity(self.0.len());
        for (i, &face) in faces.iter().enumerate() {
            let root = self.root(i);
            if root == i {
                at[i] = groups.len();
                groups.push(vec![face]);
            } else {
                groups[at[root]].push(face);
            }
        }
        groups
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
    fn planes_know_their_sides() {
        let plane = |z: Vector| Surface::Plane(placement([1.0, 1.0, 0.0], z));
        assert_eq!(same_surface(&plane(Vector::z()), &plane(-Vector::z()), 1e-6), Some(Side::Opposite));
    }
}
