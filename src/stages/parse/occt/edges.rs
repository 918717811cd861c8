//! Edges and vertices, in their places.

use std::sync::Arc;

use super::build::{Builder, Seen, curve_weight};
use super::curves::{Made, parameter_scale};
use super::locations::Place;
use super::shapes::{Data, EdgeData, Kind, Orientation, ParameterCurve, SpaceCurve};
use crate::brep::{Curve, Edge, EdgeId, Vertex, VertexId};
use crate::geometry::{Point, Transform};
use crate::stages::parse::cut;
use crate::stages::parse::fault::{Fault, Read};
use crate::stages::parse::moved::moved_curve;
use crate::stages::parse::on_surface::{self, Chart};
use crate::stages::parse::sound::Why;

impl Builder<'_> {
    /// An edge in its place; `None` for those shrunk to a point. The direction of the use does not matter.
    pub(super) fn edge(&mut self, seen: &Seen) -> Read<Option<EdgeId>> {
        if let Some(&known) = self.edges.get(&(seen.shape, seen.place)) {
            return Ok(known);
        }
        let Data::Edge(data) = &self.file.shapes.all[seen.shape as usize].data else {
            return Err(Fault::new(seen.entity(), "an edge was expected"));
        };
        let made = if data.degenerated { None } else { self.bounded_edge(seen, data)? };
        self.edges.insert((seen.shape, seen.place), made);
        Ok(made)
    }

    fn bounded_edge(&mut self, seen: &Seen, data: &EdgeData) -> Read<Option<EdgeId>> {
        let [start, end] = self.edge_ends(seen)?;
        let curve = match (data.curve, data.on_surface) {
            (Some(curve), _) => Some(self.space_curve(seen, &curve, [start, end])?),
            (None, Some(curve)) => Some(Arc::new(self.traced(seen, &curve)?)),
            (None, None) => None,
        };
        let (start, end) = match (start, end, &curve) {
            (Some(start), Some(end), _) => (start, end),
            (_, _, None) => return Err(Fault::new(seen.entity(), "an edge without ends and curve")),
            (start, end, Some(curve)) => self.made_ends(seen, curve, [start, end])?,
        };
        if curve.is_none() && start == end {
            return Ok(None);
        }
        let id = EdgeId(self.model.edges.len() as u32);
        self.model.edges.push(Edge { entity: seen.entity(), curve, start, end, same_sense: true });
        Ok(Some(id))
    }

    /// The vertices at the first and at the last parameter of an edge.
    fn edge_ends(&mut self, seen: &Seen) -> Read<[Option<VertexId>; 2]> {
        let mut ends = [None, None];
        let forward = Seen { reversed: false, ..*seen };
        for used in self.file.shapes.uses_of(seen.shape) {
            let side = match used.orientation {
                Orientation::Forward => 0,
                Orientation::Reversed => 1,
                Orientation::Loose => continue,
            };
            if ends[side].is_none() && self.kind(used.shape) == Kind::Vertex {
                let vertex = self.seen(&forward, used).ok_or_else(|| fault(seen, "a vertex in no place"))?;
                ends[side] = Some(self.vertex(&vertex)?);
            }
        }
        Ok(ends)
    }

    /// The vertex of an edge that is shrunk to a point.
    pub(super) fn first_vertex(&mut self, seen: &Seen) -> Read<Option<VertexId>> {
        Ok(self.edge_ends(seen)?.into_iter().flatten().next())
    }

    fn vertex(&mut self, seen: &Seen) -> Read<VertexId> {
        if let Some(&known) = self.vertices.get(&(seen.shape, seen.place)) {
            return Ok(known);
        }
        let point = self.vertex_point(seen)?;
        let id = self.push_vertex(seen, point)?;
        self.vertices.insert((seen.shape, seen.place), id);
        Ok(id)
    }

    /// Where a vertex lies in its body.
    pub(super) fn vertex_point(&self, seen: &Seen) -> Read<Point> {
        let Data::Vertex(point) = self.file.shapes.all[seen.shape as usize].data else {
            return Err(fault(seen, "a vertex was expected"));
        };
        let transform = self.locations.transform(seen.place).map_err(|why| fault(seen, why))?;
        let point = transform.map_or(point, |by| by.point(&point));
        if point.iter().all(|c| c.is_finite()) { Ok(point) } else { Err(fault(seen, "a number that is not finite")) }
    }

    fn push_vertex(&mut self, seen: &Seen, point: Point) -> Read<VertexId> {
        if !point.iter().all(|c| c.is_finite()) {
            return Err(fault(seen, "a number that is not finite"));
        }
        let id = VertexId(self.model.vertices.len() as u32);
        self.model.vertices.push(Vertex { entity: seen.entity(), point });
        Ok(id)
    }

    /// Vertices at the ends of the curve where an edge has none.
    fn made_ends(&mut self, seen: &Seen, curve: &Curve, ends: [Option<VertexId>; 2]) -> Read<(VertexId, VertexId)> {
        let [a, b] = curve.domain();
        if !(a.is_finite() && b.is_finite()) {
            return Err(fault(seen, "an edge without end"));
        }
        let [start, end] = ends;
        let start = match start {
            Some(start) => start,
            None => self.push_vertex(seen, curve.point(a))?,
        };
        let end = match end {
            Some(end) => end,
            None if curve.period().is_some() => start,
            None => self.push_vertex(seen, curve.point(b))?,
        };
        Ok((start, end))
    }

    /// The curve of an edge in its place, cut to the edge's range where its ends do not tell that by themselves.
    pub(super) fn space_curve(
        &mut self,
        seen: &Seen,
        of: &SpaceCurve,
        ends: [Option<VertexId>; 2],
    ) -> Read<Arc<Curve>> {
        let own = self.locations.numbered(of.location).map_err(|why| fault(seen, why))?;
        let place = self.locations.compose(seen.place, own).map_err(|why| fault(seen, why))?;
        let whole = self.placed_curve(seen, of.curve, place)?;
        let scale = listed(&self.file.curves, of.curve).map_or(1.0, parameter_scale);
        let range = of.range.map(|t| t * scale);
        let closed = ends.iter().all(Option::is_some).then(|| ends[0] == ends[1]);
        if closed.is_some_and(|closed| cut::needs_none(&whole, range, closed)) {
            return Ok(whole);
        }
        let [a, b] = range;
        if !(a.is_finite() && b.is_finite() && a < b) {
            return Err(fault(seen, "an edge with an impossible range"));
        }
        self.spend(seen.entity(), curve_weight(&whole))?;
        Ok(Arc::new(Curve::Trimmed { basis: Box::new((*whole).clone()), range, forward: true }))
    }

    fn placed_curve(&mut self, seen: &Seen, number: u32, place: Place) -> Read<Arc<Curve>> {
        if let Some(known) = self.curves.get(&(number, place)) {
            return Ok(known.clone());
        }
        let curve = listed(&self.file.curves, number).map_err(|why| of_curve(seen, "curve", number, why))?;
        self.spend(seen.entity(), curve_weight(curve))?;
        let transform = self.locations.transform(place).map_err(|why| fault(seen, why))?;
        let placed = Arc::new(match transform {
            Some(by) => moved_curve(curve.clone(), by),
            None => curve.clone(),
        });
        self.curves.insert((number, place), placed.clone());
        Ok(placed)
    }

    /// The curve of an edge that has one in the parameter space of a surface only.
    fn traced(&mut self, seen: &Seen, of: &ParameterCurve) -> Read<Curve> {
        let flat = listed(&self.file.parameter_curves, of.curve);
        let flat = flat.map_err(|why| of_curve(seen, "curve in parameter space", of.curve, why))?;
        let sheet = self.sheet(seen.entity(), of.surface)?;
        let own = self.locations.numbered(of.location).map_err(|why| fault(seen, why))?;
        let place = self.locations.compose(seen.place, own).map_err(|why| fault(seen, why))?;
        let range = of.range.map(|t| t * parameter_scale(flat));
        let traced = on_surface::traced(&sheet.surface, &Chart { scale: sheet.scale, ..Chart::default() }, flat, range);
        let traced = traced.map_err(|why| of_curve(seen, "curve in parameter space", of.curve, why))?;
        self.spend(seen.entity(), traced.points.len())?;
        let transform = self.locations.transform(place).map_err(|why| fault(seen, why))?;
        let by = transform.copied().unwrap_or_else(Transform::identity);
        Ok(moved_curve(Curve::Nurbs(traced), &by))
    }
}

fn fault(seen: &Seen, why: &'static str) -> Fault {
    Fault::new(seen.entity(), why)
}

fn of_curve(seen: &Seen, what: &str, number: u32, why: Why) -> Fault {
    Fault::new(seen.entity(), format!("{what} {number}: {why}"))
}

fn listed(curves: &[Made], number: u32) -> Result<&Curve, Why> {
    match (number as usize).checked_sub(1).and_then(|i| curves.get(i)) {
        // The range of the edge counts, even beyond that of a trimmed curve.
        Some(Ok(Curve::Trimmed { basis, .. })) => Ok(basis),
        Some(Ok(curve)) => Ok(curve),
        Some(Err(why)) => Err(why),
        None => Err("it is not there"),
    }
}
