//! What planes imply together: the image of a symmetry plane in another one is a symmetry plane, too.

use super::{Merger, SymmetryPlane};
use crate::cancel::Cancelled;
use crate::geometry::{Plane, PlaneIndex};
use crate::stages::isometry::Source;

/// Least coarse support of planes that imply others, and of those they imply: nearly all of it, for the images of
/// images of a plane that maps a little less would wander off.
const EXACT: f64 = 0.995;

/// Adds the images of exact planes in each other, and their images, until there are no new ones.
pub(super) fn close(merger: &Merger, pool: &mut Vec<SymmetryPlane>, index: &mut PlaneIndex) -> Result<(), Cancelled> {
    let mut exact: Vec<Exact> = pool.iter().filter(|p| p.coverage >= EXACT).map(|p| (p.plane, p.residual)).collect();
    let mut next = 0;
    while next < exact.len() && exact.len() <= merger.options.finalists {
        merger.cancel.check()?;
        for other in 0..exact.len() {
            let (a, b) = (exact[next], exact[other]);
            for (plane, mirror) in [(a, b), (b, a)] {
                exact.extend(implied(merger, &plane, &mirror, pool, index));
            }
        }
        next += 1;
    }
    Ok(())
}

/// A plane and its residual, mm.
type Exact = (Plane, f64);

/// The image of a plane in another one, if it is new and maps the surface; it joins the pool.
fn implied(
    merger: &Merger,
    (plane, residual): &Exact,
    (mirror, mirror_residual): &Exact,
    pool: &mut Vec<SymmetryPlane>,
    index: &mut PlaneIndex,
) -> Option<Exact> {
    let foot = mirror.reflect(&plane.project(&merger.parsed.measures.centroid));
    let image = Plane::through(&foot, &mirror.reflect_vector(&plane.normal));
    if index.find(&image).is_some() {
        return None;
    }
    let coverage = merger.validated.field.reaches(&image.reflection(), EXACT)?;
    index.add(image);
    // An image is off by what both planes are.
    let residual = residual + mirror_residual;
    pool.push(SymmetryPlane { source: Source::Principal, ..super::principal::candidate(image, coverage, residual) });
    Some((image, residual))
}
