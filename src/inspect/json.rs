//! An inspection as one JSON object: the fields of the interface's contract.

use serde_json::{Map, Value, json};

use super::Inspection;
use crate::alignment::Method;
use crate::brep::{Mesh, Model, PlacedFaceId};
use crate::geometry::Frame;
use crate::pipeline::{Counts, Described, Framed, Posed, Ranked, bbox, by_stage, point, vector};
use crate::stages::descriptor::{Descriptor, HARMONICS};
use crate::stages::merge::{Symmetries, SymmetryPlane};
use crate::stages::projection_sweep::CanonicalFrame;

/// The object: `{"model", "error"}` for a model that was lost.
pub fn object(inspection: &Inspection) -> Value {
    match &inspection.result {
        Ok(described) => {
            let mut object = described_object(described);
            object["model"] = inspection.model.as_str().into();
            object["seconds"] = by_stage(&inspection.seconds);
            object
        }
        Err(error) => json!({
            "model": inspection.model,
            "error": {"stage": error.stage.name(), "why": error.why, "entity": error.entity},
        }),
    }
}

fn described_object(described: &Described) -> Value {
    let Framed { ranked: Ranked { posed: Posed { parsed, .. }, symmetries }, canonical, frames } = &described.framed;
    let (model, measures) = (&parsed.model, &parsed.measures);
    let counts = Counts::of(model);
    json!({
        "schema": model.schema,
        "unit_mm": model.unit_mm,
        "solids": counts.solids,
        "faces": counts.faces,
        "edges": counts.edges,
        "triangles": parsed.mesh.triangles.len(),
        "area_mm2": measures.area,
        "volume_mm3": measures.volume,
        "centroid_mm": point(&measures.centroid),
        "bbox_mm": bbox(&measures.bounds),
        "skipped": parsed.skipped,
        "warnings": parsed.warnings,
        "symmetry": symmetry(symmetries, model, &parsed.mesh),
        "frames": all_frames(frames, canonical),
        "descriptors": descriptors(frames, &described.descriptors),
    })
}

fn symmetry(symmetries: &Symmetries, model: &Model, mesh: &Mesh) -> Value {
    let planes: Vec<_> = symmetries.planes.iter().map(|found| plane(found, model, mesh)).collect();
    let axes = symmetries.axes.iter();
    let axes: Vec<_> =
        axes.map(|axis| json!({"point_mm": point(&axis.point), "direction": vector(&axis.direction)})).collect();
    let repeats = &symmetries.repeats;
    let repeats = json!({
        "faces": repeats.faces, "ratio": repeats.ratio, "shifted": repeats.shifted, "turned": repeats.turned,
    });
    json!({"label": symmetries.label, "planes": planes, "axes": axes, "repeats": repeats})
}

fn plane(found: &SymmetryPlane, model: &Model, mesh: &Mesh) -> Value {
    let face = |id: PlacedFaceId| face_name(&mesh.face_name(model, id));
    json!({
        "normal": vector(&found.plane.normal),
        "offset_mm": found.plane.offset,
        "coverage": found.coverage,
        "residual_mm": found.residual,
        "pairs": found.pairs.iter().map(|(a, b)| [face(*a), face(*b)]).collect::<Vec<_>>(),
        "self": found.selfs.iter().map(|a| face(*a)).collect::<Vec<_>>(),
    })
}

/// The name of a face as JSON: an entity number is a number, `occurrence/entity` is text.
pub fn face_name(name: &str) -> Value {
    name.parse::<u64>().map_or_else(|_| name.into(), Value::from)
}

fn all_frames(frames: &[(Method, Frame)], canonical: &CanonicalFrame) -> Value {
    let named = frames.iter().map(|(method, frame)| {
        let mut value = json!({"axes": frame.axes.map(|axis| vector(&axis)), "origin_mm": point(&frame.origin)});
        if *method == Method::Symmetry {
            let angles: Vec<_> = canonical.sweep.angles.iter().map(|angle| angle.to_degrees()).collect();
            value["source"] = json!(canonical.source);
            value["areas_mm2"] = json!(canonical.areas);
            value["axisymmetric"] = json!(canonical.axisymmetric);
            value["sweep"] = json!({"angles_deg": angles, "areas_mm2": canonical.sweep.areas});
        }
        (method.name().to_owned(), value)
    });
    Value::Object(named.collect::<Map<_, _>>())
}

fn descriptors(frames: &[(Method, Frame)], descriptors: &[Descriptor]) -> Value {
    let by_method = |part: &dyn Fn(&Descriptor) -> Value| {
        let named = frames.iter().zip(descriptors).map(|((method, _), d)| (method.name().to_owned(), part(d)));
        Value::Object(named.collect::<Map<_, _>>())
    };
    json!({
        "magnitude": by_method(&|d| json!(d.magnitude.map(|view| view.to_vec()))),
        "phase": by_method(&|d| json!(starts(d, 0))),
        "phase_opposite": by_method(&|d| json!(starts(d, 1))),
        "hull": by_method(&|d| json!(d.hull)),
    })
}

/// The complex coefficients by view, of one starting point.
fn starts(descriptor: &Descriptor, start: usize) -> [Vec<[f32; 2]>; 3] {
    let of_view = |view: &[[[f32; 2]; HARMONICS]; 2]| view[start].to_vec();
    [of_view(&descriptor.phase[0]), of_view(&descriptor.phase[1]), of_view(&descriptor.phase[2])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::{ModelError, Stage};

    #[test]
    fn a_lost_model_tells_stage_reason_and_entity() {
        let result = Err(ModelError::at(Stage::Parse, 17, "no such surface"));
        let inspection = Inspection { model: "a.step".into(), result, seconds: Default::default() };
        let expected = json!({"model": "a.step", "error": {"stage": "parse", "why": "no such surface", "entity": 17}});
        assert_eq!(object(&inspection), expected);
    }

    #[test]
    fn faces_are_numbers_unless_they_have_an_occurrence() {
        assert_eq!(face_name("17"), json!(17));
        assert_eq!(face_name("4.9/17"), json!("4.9/17"));
    }
}
