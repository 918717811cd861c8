//! The paper's own choice (section IV.E): eq. (7), and the largest bounding box of the symmetric faces.

use super::{Merger, SymmetryPlane};
use crate::cancel::Cancelled;
use crate::geometry::{Aabb, Plane, Point};
use crate::stages::pair_match::Corners;
use crate::stages::validate;
use crate::stages::validate::ValidatedPlane;
use crate::stages::validate::faces::FaceSamples;

/// Groups whose support is measured: the reported coverage does not take part in the choice.
const MEASURED: usize = 16;

/// Pairs that share a symmetry.
struct Group<'a> {
    leader: &'a ValidatedPlane,
    /// Mean of the corners of the leader's two faces.
    barycentre: Point,
    /// Outlines, sorted.
    faces: Vec<u32>,
    volume: f64,
}

/// The planes within the reported share of the largest bounding box, largest first.
pub(super) fn planes(merger: &Merger) -> Result<Vec<SymmetryPlane>, Cancelled> {
    let mut groups = groups(merger)?;
    groups.iter_mut().for_each(|g| g.volume = volume(merger, &g.faces));
    groups.sort_by(|a, b| b.volume.total_cmp(&a.volume));
    groups.truncate(MEASURED);
    let options = validate::Options::paper();
    let mut samples = FaceSamples::new(merger.parsed, merger.outlines, &options);
    for group in &mut groups {
        merger.cancel.check()?;
        extend(merger, group, &mut samples, options.correlation);
    }
    groups.sort_by(|a, b| b.volume.total_cmp(&a.volume));
    let largest = groups.first().map_or(0.0, |g| g.volume);
    groups.retain(|g| g.volume >= largest * (1.0 - merger.options.reported));
    let measured = |g: &Group| {
        let reflection = g.leader.plane.reflection();
        let support = merger.validated.field.support(&merger.parsed.mesh, &reflection, merger.cancel)?;
        Ok(SymmetryPlane { coverage: support.share, error: support.error, ..merger.refitted(g.leader) })
    };
    groups.iter().map(measured).collect()
}

/// Leaders by eq. (7), the largest area first.
fn groups<'a>(merger: &Merger<'a>) -> Result<Vec<Group<'a>>, Cancelled> {
    let mut order: Vec<_> = merger.validated.planes.iter().collect();
    order.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    let diagonal = merger.parsed.measures.bounds.diagonal();
    let mut groups: Vec<Group> = Vec::new();
    for validated in order {
        merger.cancel.check()?;
        let barycentre = barycentre(merger, validated);
        let same = |g: &&mut Group| {
            let (p, q) = (&g.leader.plane, &validated.plane);
            let apart = q.signed_distance(&g.barycentre).abs() + p.signed_distance(&barycentre).abs();
            1.0 - p.normal.dot(&q.normal) + apart / diagonal <= merger.options.paper_distance
        };
        let faces = validated.pairs.iter().flat_map(|&p| merger.matches.pairs[p as usize].faces);
        if let Some(group) = groups.iter_mut().find(same) {
            group.faces.extend(faces);
        } else {
            groups.push(Group { leader: validated, barycentre, faces: faces.collect(), volume: 0.0 });
        }
    }
    for group in &mut groups {
        group.faces.sort_unstable();
        group.faces.dedup();
    }
    Ok(groups)
}

fn barycentre(merger: &Merger, validated: &ValidatedPlane) -> Point {
    let pairs = validated.pairs.iter().map(|&p| merger.matches.pairs[p as usize].corners(merger.outlines));
    let corners: Vec<_> = pairs.flat_map(|Corners { from, to }| from.into_iter().chain(to)).collect();
    crate::geometry::isometry::mean(&corners)
}

fn bounds(merger: &Merger, outline: u32) -> Aabb {
    let faces = merger.outlines[outline as usize].faces.iter();
    Aabb::of(faces.flat_map(|&f| merger.parsed.mesh.points_of(f)))
}

/// Volume of the box around the faces, mm^3.
fn volume(merger: &Merger, faces: &[u32]) -> f64 {
    let mut all = Aabb::default();
    faces.iter().for_each(|&f| all.join(&bounds(merger, f)));
    if all.is_empty() { 0.0 } else { (all.max - all.min).product() }
}

/// Adds single faces that cross the plane and whose two sides have like histograms.
fn extend(merger: &Merger, group: &mut Group, samples: &mut FaceSamples, needed: f64) {
    let plane = group.leader.plane;
    let single = (0..merger.outlines.len() as u32).filter(|f| group.faces.binary_search(f).is_err());
    let like = |&f: &u32| {
        crosses(&bounds(merger, f), &plane) && samples.correlation(f, f, &plane).is_some_and(|r| r >= needed)
    };
    let added: Vec<_> = single.filter(like).collect();
    group.faces.extend(added);
    group.volume = volume(merger, &group.faces);
}

fn crosses(bounds: &Aabb, plane: &Plane) -> bool {
    if bounds.is_empty() {
        return false;
    }
    let reach = (bounds.max - bounds.min).component_mul(&plane.normal).abs().sum() * 0.5;
    plane.signed_distance(&bounds.centre()).abs() <= reach
}
