//! The sections of polygons and triangulations: only triangulations are kept, for faces without a surface.

use super::text::{Found, Words};
use crate::brep::Facets;
use crate::geometry::Point;
use crate::stages::parse::sound::Why;

/// A triangulation as read, or why it cannot be used.
pub(super) type Made = Result<Facets, Why>;

/// Passes a polygon in space.
pub(super) fn polygon(words: &mut Words) -> Found<()> {
    let (count, has_parameters) = (words.count()?, words.flag()?);
    words.skip(1)?;
    words.skip(count.saturating_mul(if has_parameters { 4 } else { 3 }))
}

/// Passes a polygon on a triangulation.
pub(super) fn polygon_on_triangulation(words: &mut Words) -> Found<()> {
    let count = words.count()?;
    words.skip(count)?;
    words.expect("p")?;
    words.skip(1)?;
    if words.flag()? { words.skip(count) } else { Ok(()) }
}

/// Reads a triangulation in a format of version `version`.
pub(super) fn triangulation(words: &mut Words, version: u32) -> Found<Made> {
    let (points, triangles, has_parameters) = (words.count()?, words.count()?, words.flag()?);
    let has_normals = version >= 3 && words.flag()?;
    words.skip(1)?;
    let mut facets = Facets::default();
    for _ in 0..points {
        facets.points.push(Point::from(words.reals::<3>()?));
    }
    words.skip(if has_parameters { points.saturating_mul(2) } else { 0 })?;
    for _ in 0..triangles {
        let corners = [words.integer()?, words.integer()?, words.integer()?];
        let corners = corners.map(|c| c.checked_sub(1).and_then(|c| u32::try_from(c).ok()).unwrap_or(u32::MAX));
        facets.triangles.push(corners);
    }
    words.skip(if has_normals { points.saturating_mul(3) } else { 0 })?;
    Ok(checked(facets))
}

fn checked(mut facets: Facets) -> Made {
    if !facets.points.iter().flat_map(|p| p.iter()).all(|c| c.is_finite()) {
        return Err("a number that is not finite");
    }
    if facets.triangles.iter().flatten().any(|&c| c as usize >= facets.points.len()) {
        return Err("a triangle with a point that is not there");
    }
    facets.triangles.retain(|[a, b, c]| a != b && b != c && c != a);
    if facets.triangles.is_empty() { Err("no triangles") } else { Ok(facets) }
}
