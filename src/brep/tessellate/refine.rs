//! Edges that are too coarse for a narrow face between them are cut finer, and the faces on both sides made again.

use rustc_hash::FxHashSet;

use super::edges::Fineness;
use super::face::{Context, FaceMesh, Meshes, Scratch};
use crate::brep::{Curve, EdgeId, Face};
use crate::cancel::{Cancel, Cancelled};

/// Faces whose triangles have an area that is off by more than this share have edges too coarse.
const AREA_OFF: f64 = 0.025;
/// Errors smaller than this share of the area of all faces are not seen.
const UNSEEN: f64 = 5e-5;
/// How often edges are made again at most, each time with a quarter of the deflection.
const ROUNDS: i32 = 2;

/// Makes coarse edges and their faces again; `spans`: where each edge begins and ends on its curve.
pub(super) fn refine(
    context: &mut Context,
    spans: &[Option<[f64; 2]>],
    meshes: &mut Meshes,
    scratch: &mut Scratch,
    cancel: &Cancel,
) -> Result<(), Cancelled> {
    for round in 1..=ROUNDS {
        let edges = coarse_edges(context, &meshes.faces);
        if edges.is_empty() {
            break;
        }
        let Fineness { deflection, angle } = context.fineness;
        let finer = Fineness { deflection: deflection * 0.25_f64.powi(round), angle: angle * 0.5_f64.powi(round) };
        for &edge in &edges {
            cancel.check()?;
            context.lines.replace(context.model, edge, spans[edge.index()], &finer);
        }
        let touched = |face: &Face| edges_of(face).any(|e| edges.contains(&e));
        let all = context.model.faces.iter().zip(&context.reference).enumerate().take(meshes.faces.len());
        for (i, (face, reference)) in all.filter(|(_, (face, _))| touched(face)) {
            meshes.faces[i] = meshes.make(context, face, reference, scratch);
            cancel.check()?;
        }
    }
    Ok(())
}

/// The bent edges of faces whose triangles are too coarse.
fn coarse_edges(context: &Context, faces: &[Result<FaceMesh, String>]) -> FxHashSet<EdgeId> {
    let whole: f64 = faces.iter().flatten().map(|f| f.integrals.area).sum();
    let off = |mesh: &FaceMesh| {
        let (plain, exact) = (mesh.plain.area, mesh.integrals.area);
        (plain - exact).abs() > (AREA_OFF * exact).max(UNSEEN * whole)
    };
    let coarse = context.model.faces.iter().zip(faces).filter(|(_, m)| m.as_ref().is_ok_and(off));
    let curve = |edge: &EdgeId| context.model.edges[edge.index()].curve.as_deref();
    let bent = |edge: &EdgeId| !matches!(curve(edge), None | Some(Curve::Line { .. }));
    coarse.flat_map(|(face, _)| edges_of(face)).filter(bent).collect()
}

fn edges_of(face: &Face) -> impl Iterator<Item = EdgeId> + '_ {
    face.loops.iter().flat_map(|l| &l.uses).map(|u| u.edge)
}
