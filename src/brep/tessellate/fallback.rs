//! Faces whose edges do not fit their surface: the border is filled with a plane, so that silhouettes stay closed.

use super::border::Border;
use super::boundary::map_border;
use super::chart::Chart;
use super::domain::triangulate;
use super::face::{Context, Work};
use crate::brep::{Placement, Surface};
use crate::geometry::{Point, Vector, any_perpendicular, isometry::mean};

/// Fills the border; `None` where it has no extent.
pub(super) fn planar_fill(context: &Context, border: &Border, work: &mut Work) -> Option<()> {
    let size = context.size;
    let loops = || border.loops().map(|[points, _]| points);
    let normal = loops().map(area_vector).max_by(|a, b| a.norm().total_cmp(&b.norm()))?;
    let z = normal.try_normalize(1e-12 * size * size)?;
    let x = any_perpendicular(&z);
    let largest = loops().max_by_key(|points| points.len())?;
    let surface = Surface::Plane(Placement { origin: mean(largest), x, y: z.cross(&x), z });
    let mut chart = Chart::new(&surface, true, &[], size);
    chart.cancel = Some(context.cancel);
    let Work { mapped, paths, patch, room, .. } = work;
    map_border(&chart, border, size, f64::INFINITY, mapped, paths).ok()?;
    triangulate(&chart, paths, &context.fineness, true, patch, room)
}

/// Half the sum of the cross products along a closed polyline: its area vector.
fn area_vector(points: &[Point]) -> Vector {
    let Some(first) = points.first() else { return Vector::zeros() };
    points.windows(2).map(|w| (w[0] - first).cross(&(w[1] - first))).sum::<Vector>() * 0.5
}
