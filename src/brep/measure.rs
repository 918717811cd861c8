//! Area, volume, centroid and bounding box of a model.

use std::f64::consts::PI;

use super::{Curve, EdgeId, FreeCurve, Mesh, Model};
use crate::geometry::{Aabb, Point, Tolerance, Transform, Vector};

/// What a model measures, in its own pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Measures {
    /// Area of all placed faces, mm^2.
    pub area: f64,
    /// Volume of all solids, mm^3; 0 without solids.
    pub volume: f64,
    /// Area centroid.
    pub centroid: Point,
    /// Box of the faces and of the free curves.
    pub bounds: Aabb,
    /// D = 2 max |p - centroid|.
    pub tolerance: Tolerance,
}

/// Measures a tessellated model. Area, centroid and volume come from the integrals over the true surfaces; D from the
/// points of the mesh, the box from them and from the circles and ellipses of edges. Without faces everything is 0 and the box is empty.
pub fn measure(model: &Model, mesh: &Mesh) -> Measures {
    let area: f64 = mesh.faces.iter().map(|f| f.area).sum();
    let moment: Vector = mesh.faces.iter().map(|f| f.centroid.coords * f.area).sum();
    let centroid = if area > 0.0 { Point::from(moment / area) } else { Point::origin() };
    let farthest = mesh.points.iter().map(|p| (p - centroid).norm_squared()).fold(0.0, f64::max).sqrt();
    let mut bounds = Aabb::of(&mesh.points);
    add_conics(&mut bounds, model, mesh);
    model.free_curves.iter().flat_map(points_of).for_each(|p| bounds.add(&p));
    Measures { area, volume: volume(model, mesh), centroid, bounds, tolerance: Tolerance::of(2.0 * farthest) }
}

/// Adds the points where circles and ellipses of edges reach beyond the box: chords fall short of them.
fn add_conics(bounds: &mut Aabb, model: &Model, mesh: &Mesh) {
    let arcs: Vec<Option<Arc>> = (0..model.edges.len()).map(|i| Arc::of(model, EdgeId(i as u32))).collect();
    for face in &mesh.faces {
        let placement = &model.occurrences[face.occurrence as usize].placement;
        let edges = model.faces[face.face.index()].loops.iter().flat_map(|l| &l.uses).map(|u| u.edge);
        for (edge, arc) in edges.filter_map(|e| Some((e, arcs[e.index()].as_ref()?))) {
            arc.placed(placement).add_to(bounds, || model.edge_span(edge));
        }
    }
}

/// An ellipse: centre + x cos t + y sin t.
struct Arc {
    centre: Point,
    x: Vector,
    y: Vector,
}

impl Arc {
    fn of(model: &Model, edge: EdgeId) -> Option<Self> {
        let (placement, [a, b]) = match model.edges[edge.index()].curve.as_deref()? {
            Curve::Circle { placement, radius } => (placement, [*radius, *radius]),
            Curve::Ellipse { placement, semi_x, semi_y } => (placement, [*semi_x, *semi_y]),
            _ => return None,
        };
        Some(Self { centre: placement.origin, x: placement.x * a, y: placement.y * b })
    }

    fn placed(&self, by: &Transform) -> Self {
        Self { centre: by.point(&self.centre), x: by.linear * self.x, y: by.linear * self.y }
    }

    /// Adds the points that are extreme along a coordinate axis and lie in the `span` of the edge, which is asked for
    /// where the whole ellipse leaves the box at all.
    fn add_to(&self, bounds: &mut Aabb, span: impl Fn() -> Option<[f64; 2]>) {
        for axis in 0..3 {
            let reach = self.x[axis].hypot(self.y[axis]);
            let middle = self.centre[axis];
            if middle - reach >= bounds.min[axis] && middle + reach <= bounds.max[axis] {
                continue;
            }
            let Some([from, to]) = span() else { return };
            let extreme = self.y[axis].atan2(self.x[axis]);
            let mut t = extreme + PI * ((from.min(to) - extreme) / PI).ceil();
            while t <= from.max(to) {
                bounds.add(&(self.centre + self.x * t.cos() + self.y * t.sin()));
                t += PI;
            }
        }
    }
}

/// Points of a free curve, near enough for its box.
fn points_of(free: &FreeCurve) -> impl Iterator<Item = Point> + '_ {
    const PIECES: usize = 64;
    let breaks = free.curve.breaks();
    let inner = |pair: [f64; 2]| (1..=PIECES).map(move |i| pair[0] + (pair[1] - pair[0]) * i as f64 / PIECES as f64);
    let first = free.curve.domain()[0];
    let pairs: Vec<[f64; 2]> = breaks.windows(2).map(|w| [w[0], w[1]]).collect();
    let parameters = std::iter::once(first).chain(pairs.into_iter().flat_map(inner));
    parameters.map(|t| free.placement.point(&free.curve.point(t)))
}

/// The outer shell of each placed solid less its voids; the direction in which a file turns its shells is not trusted.
fn volume(model: &Model, mesh: &Mesh) -> f64 {
    let mut fluxes = vec![0.0; model.shells.len()];
    let mut total = 0.0;
    for of_one in mesh.faces.chunk_by(|a, b| a.occurrence == b.occurrence) {
        let body = &model.bodies[model.occurrences[of_one[0].occurrence as usize].body.index()];
        if !body.solid {
            continue;
        }
        of_one.iter().for_each(|f| fluxes[model.faces[f.face.index()].shell as usize] += f.flux);
        let sizes = body.shells.iter().map(|&s| fluxes[s as usize].abs());
        total += sizes.enumerate().map(|(i, v)| if i == 0 { v } else { -v }).sum::<f64>();
        body.shells.iter().for_each(|&s| fluxes[s as usize] = 0.0);
    }
    total
}
