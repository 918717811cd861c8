//! An inspection for people.

use super::Inspection;
use crate::pipeline::{Counts, Described, Framed, Posed, Ranked};
use crate::stages::merge::{Symmetries, SymmetryPlane};
use crate::stages::parse::Parsed;

/// Planes listed; the rest are counted.
const PLANES: usize = 5;
/// Skipped entities and warnings listed.
const REMARKS: usize = 5;

/// The inspection in a few lines.
pub fn summary(inspection: &Inspection) -> String {
    let body = match &inspection.result {
        Ok(described) => described_lines(described),
        Err(error) => vec![format!("lost in {error}")],
    };
    let total: f64 = inspection.seconds.iter().sum();
    let lines: String = body.iter().map(|line| format!("  {line}\n")).collect();
    format!("{} ({total:.2} s)\n{lines}", inspection.model)
}

fn described_lines(described: &Described) -> Vec<String> {
    let Framed { ranked: Ranked { posed: Posed { parsed, .. }, symmetries }, canonical, .. } = &described.framed;
    let mut lines = model_lines(parsed);
    lines.extend(symmetry_lines(symmetries));
    let [a, b, c] = canonical.areas;
    let source = canonical.source.name();
    let doubt = if canonical.axisymmetric { "; axisymmetric, so the second axis is a convention" } else { "" };
    lines.push(format!("frame by {source}; projected areas {a:.2}, {b:.2}, {c:.2} mm2{doubt}"));
    lines
        .extend(canonical.frame.axes.iter().enumerate().map(|(i, n)| format!("  axis {i}: {}", numbers(n.as_slice()))));
    lines
}

fn model_lines(parsed: &Parsed) -> Vec<String> {
    let (model, measures) = (&parsed.model, &parsed.measures);
    let counts = Counts::of(model);
    let size = measures.bounds.max - measures.bounds.min;
    let mut lines = vec![
        format!("{}, unit {} mm", if model.schema.is_empty() { "no schema" } else { &model.schema }, model.unit_mm),
        format!(
            "{} solids, {} faces, {} edges, {} triangles",
            counts.solids,
            counts.faces,
            counts.edges,
            parsed.mesh.triangles.len()
        ),
        format!(
            "area {:.3} mm2, volume {:.3} mm3, box {} mm",
            measures.area,
            measures.volume,
            numbers(size.as_slice())
        ),
    ];
    let skipped = parsed.skipped.iter().map(|s| format!("skipped #{}: {}", s.entity, s.why));
    lines.extend(shortened(skipped.collect()));
    lines.extend(shortened(parsed.warnings.iter().map(|warning| format!("warning: {warning}")).collect()));
    lines
}

/// The first few, and how many more.
fn shortened(mut lines: Vec<String>) -> Vec<String> {
    let more = lines.len().saturating_sub(REMARKS);
    lines.truncate(REMARKS);
    if more > 0 {
        lines.push(format!(".. and {more} more"));
    }
    lines
}

fn symmetry_lines(symmetries: &Symmetries) -> Vec<String> {
    let mut lines = vec![format!("symmetry: {}", symmetries.label.name())];
    lines.extend(symmetries.planes.iter().take(PLANES).map(plane_line));
    let more = symmetries.planes.len().saturating_sub(PLANES);
    if more > 0 {
        lines.push(format!("  .. and {more} more planes"));
    }
    for axis in &symmetries.axes {
        let (point, direction) = (numbers(axis.point.coords.as_slice()), numbers(axis.direction.as_slice()));
        lines.push(format!("  axis of revolution through {point} along {direction}"));
    }
    let repeats = &symmetries.repeats;
    lines.push(format!(
        "repeated faces: {} ({:.0} %), {} by a shift, {} by a turn",
        repeats.faces,
        100.0 * repeats.ratio,
        repeats.shifted,
        repeats.turned
    ));
    lines
}

fn plane_line(found: &SymmetryPlane) -> String {
    format!(
        "  plane {} at {:.4} mm: coverage {:.4}, residual {:.2e} mm, {} pairs of faces, {} faces onto themselves",
        numbers(found.plane.normal.as_slice()),
        found.plane.offset,
        found.coverage,
        found.residual,
        found.pairs.len(),
        found.selfs.len()
    )
}

fn numbers(values: &[f64]) -> String {
    let shown: Vec<_> = values.iter().map(|x| format!("{x:.4}")).collect();
    format!("({})", shown.join(", "))
}
