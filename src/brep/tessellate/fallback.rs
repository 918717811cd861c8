//! Faces whose edges do not fit their surface: the border is filled with a plane, so that silhouettes stay closed.

use super::Few;
use super::boundary::paths;
use super::chart::Chart;
use super::domain::{Patch, triangulate};
use super::face::Context;
use crate::brep::{Placement, Surface};
use crate::geometry::{Point, Vector, any_perpendicular, isometry::mean};

/// Fills the border; `None` where it has no extent.
pub(super) fn planar_fill(borders: Few<[Vec<Point>; 2]>, context: &Context) -> Option<Patch> {
    let size = context.size;
    let normal = borders.iter().map(|b| area_vector(&b[0])).max_by(|a, b| a.norm().total_cmp(&b.norm()))?;
    let z = normal.try_normalize(1e-12 * size * size)?;
    let x = any_perpendicular(&z);
    let largest = borders.iter().max_by_key(|b| b[0].len())?;
    let surface = Surface::Plane(Placement { origin: mean(&largest[0]), x, y: z.cross(&x), z });
    let mut chart = Chart::new(&surface, true, &[], size);
    chart.cancel = Some(context.cancel);
    let mut paths = paths(&chart, borders, size, f64::INFINITY).ok()?;
    triangulate(&chart, &mut paths, &context.fineness, true)
}

/// Half the sum of the cross products along a closed polyline: its area vector.
fn area_vector(points: &[Point]) -> Vector {
    let Some(first) = points.first() else { return Vector::zeros() };
    points.windows(2).map(|w| (w[0] - first).cross(&(w[1] - first))).sum::<Vector>() * 0.5
}
