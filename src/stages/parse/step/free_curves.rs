//! Curves and points that lie beside the faces: the elements of a GEOMETRIC_SET that bound nothing.

use std::sync::Arc;

use super::keyword::Kind;
use super::topology::Builder;
use crate::brep::Curve;
use crate::cancel::{Cancel, Cancelled};
use crate::stages::parse::fault::Read;

impl Builder<'_> {
    /// The points and bounded curves of a set.
    ///
    /// # Errors
    /// Only when cancelled: what cannot be read is noted as skipped.
    pub fn free_curves(&mut self, set: u64, cancel: &Cancel) -> Result<Vec<(u64, Arc<Curve>)>, Cancelled> {
        let elements = self.record(set).and_then(|record| {
            record.fields(&[Kind::RepresentationItem, Kind::GeometricSet]).skip_many(1).references_leniently()
        });
        let mut found = Vec::new();
        for element in elements.unwrap_or_default() {
            cancel.check()?;
            match self.free_curve(element) {
                Ok(curve) => found.extend(curve.map(|curve| (element, Arc::new(curve)))),
                Err(fault) => self.notes.skip(element, fault),
            }
        }
        Ok(found)
    }

    fn free_curve(&self, id: u64) -> Read<Option<Curve>> {
        let record = self.record(id)?;
        if record.is(Kind::CartesianPoint) {
            return Ok(Some(Curve::Polyline(vec![self.geometry.point(id)?])));
        }
        const CURVES: [Kind; 11] = [
            Kind::Circle,
            Kind::Ellipse,
            Kind::BSplineCurve,
            Kind::BSplineCurveWithKnots,
            Kind::QuasiUniformCurve,
            Kind::UniformCurve,
            Kind::BezierCurve,
            Kind::Polyline,
            Kind::TrimmedCurve,
            Kind::CompositeCurve,
            Kind::CurveReplica,
        ];
        if !CURVES.iter().any(|kind| record.is(*kind)) {
            return Ok(None);
        }
        let curve = self.geometry.curve(id)?;
        Ok(Some(curve).filter(|curve| curve.domain().iter().all(|t| t.is_finite())))
    }
}
