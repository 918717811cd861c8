//! Edges and vertices that are parts of no face.

use std::sync::Arc;

use super::assembly::Placed;
use super::build::{Builder, Seen};
use super::shapes::{Data, Kind};
use crate::brep::{Curve, FreeCurve};
use crate::cancel::{Cancel, Cancelled};
use crate::stages::parse::fault::Read;

impl Builder<'_> {
    /// Adds the curves of placed wires, edges and vertices to the model.
    ///
    /// # Errors
    /// Only when cancelled: what cannot be read is noted as skipped.
    pub fn add_free_curves(&mut self, free: &[Placed], cancel: &Cancel) -> Result<(), Cancelled> {
        for Placed { shape, placement, .. } in free {
            cancel.check()?;
            let whole = Seen { shape: *shape, reversed: false, place: 0 };
            for seen in self.edges_of(whole) {
                match self.free_curve(&seen) {
                    Ok(Some(curve)) => {
                        let entity = seen.entity();
                        self.model.free_curves.push(FreeCurve { entity, curve, placement: *placement });
                    }
                    Ok(None) => {}
                    Err(fault) => self.notes.skip(seen.entity(), fault),
                }
            }
        }
        Ok(())
    }

    /// The edges of a wire, else the shape itself.
    fn edges_of(&mut self, whole: Seen) -> Vec<Seen> {
        if self.kind(whole.shape) != Kind::Wire {
            return vec![whole];
        }
        let parts = self.file.shapes.uses_of(whole.shape);
        parts.iter().filter_map(|used| self.seen(&whole, used)).collect()
    }

    fn free_curve(&mut self, seen: &Seen) -> Read<Option<Arc<Curve>>> {
        self.spend(seen.entity(), 1)?;
        match &self.file.shapes.all[seen.shape as usize].data {
            Data::Vertex(_) => self.vertex_point(seen).map(|point| Some(Arc::new(Curve::Polyline(vec![point])))),
            Data::Edge(edge) => match edge.curve {
                Some(curve) => self.space_curve(seen, &curve, [None, None]).map(Some),
                None => Ok(None),
            },
            _ => Ok(None),
        }
    }
}
