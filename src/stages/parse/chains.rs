//! Edges in any order -> closed chains.

use rustc_hash::FxHashMap;

use crate::brep::{EdgeUse, Model, VertexId};

/// The uses in chains in which each starts where the one before ends. A chain is as long as it can be, turns back
/// along the same edge (a seam) only where nothing else goes on, and starts with the first use that is left.
pub(super) fn chains(model: &Model, uses: Vec<EdgeUse>) -> Vec<Vec<EdgeUse>> {
    let follows = |a: &EdgeUse, b: &EdgeUse| ends(model, a)[1] == ends(model, b)[0];
    if uses.windows(2).all(|pair| follows(&pair[0], &pair[1])) {
        return vec![uses];
    }
    let mut starting: FxHashMap<VertexId, Vec<usize>> = FxHashMap::default();
    (0..uses.len()).rev().for_each(|i| starting.entry(ends(model, &uses[i])[0]).or_default().push(i));
    let mut taken = vec![false; uses.len()];
    let mut chains = Vec::new();
    for first in 0..uses.len() {
        let (mut chain, mut next) = (Vec::new(), Some(first).filter(|&i| !taken[i]));
        while let Some(i) = next {
            taken[i] = true;
            chain.push(uses[i]);
            let candidates = starting.get_mut(&ends(model, &uses[i])[1]);
            next = candidates.and_then(|candidates| follower(candidates, &uses, &taken, i));
        }
        if !chain.is_empty() {
            chains.push(chain);
        }
    }
    chains
}

fn ends(model: &Model, used: &EdgeUse) -> [VertexId; 2] {
    let edge = &model.edges[used.edge.index()];
    if used.forward { [edge.start, edge.end] } else { [edge.end, edge.start] }
}

/// The first candidate (the last of the list) that is left, other than the way back along use `i` where there is one.
fn follower(candidates: &mut Vec<usize>, uses: &[EdgeUse], taken: &[bool], i: usize) -> Option<usize> {
    while candidates.last().is_some_and(|&j| taken[j]) {
        candidates.pop();
    }
    let other = candidates.iter().rev().copied().find(|&j| !taken[j] && uses[j].edge != uses[i].edge);
    other.or(candidates.last().copied())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::{Edge, EdgeId, Vertex};
    use crate::geometry::Point;

    fn model(edges: &[[u32; 2]]) -> Model {
        let mut model = Model::empty();
        model.vertices = (0..9).map(|i| Vertex { entity: i, point: Point::origin() }).collect();
        let edge = |&[a, b]: &[u32; 2]| Edge {
            entity: 0,
            curve: None,
            start: VertexId(a),
            end: VertexId(b),
            same_sense: true,
        };
        model.edges = edges.iter().map(edge).collect();
        model
    }

    fn used(edge: u32, forward: bool) -> EdgeUse {
        EdgeUse { edge: EdgeId(edge), forward }
    }

    #[test]
    fn a_wall_with_a_seam_goes_round_once() {
        // Two circles and the seam between their vertices, in the order in which OCCT writes a cone.
        let model = model(&[[1, 1], [0, 1], [0, 0]]);
        let found = chains(&model, vec![used(0, false), used(1, true), used(2, true), used(1, false)]);
        assert_eq!(found, [[used(0, false), used(1, false), used(2, true), used(1, true)]]);
    }

    #[test]
    fn what_is_not_connected_becomes_several_chains() {
        let model = model(&[[0, 1], [2, 3], [1, 0], [3, 2]]);
        let found = chains(&model, vec![used(0, true), used(1, true), used(2, true), used(3, true)]);
        assert_eq!(found, [[used(0, true), used(2, true)], [used(1, true), used(3, true)]]);
    }
}
