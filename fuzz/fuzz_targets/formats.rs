//! Bytes of IGES and `.brep` files -> B-rep, mesh and measures.
#![no_main]

use libfuzzer_sys::fuzz_target;
use symalign::brep::tessellate;
use symalign::cancel::Cancel;
use symalign::stages::parse::{Options, parse};

/// Small limits, so that a find is not only a large model.
fn options() -> Options {
    let tessellation = tessellate::Options { deflection: 0.05, angle: 0.8, max_triangles: 200_000 };
    Options { most_occurrences: 1000, most_faces: 1000, tessellation }
}

fuzz_target!(|bytes: &[u8]| {
    let Ok(parsed) = parse(bytes, &options(), None, &Cancel::new()) else { return };
    let measures = &parsed.measures;
    assert!(measures.area.is_finite() && measures.volume.is_finite(), "{measures:?}");
    let points = parsed.mesh.points.len() as u32;
    assert!(parsed.mesh.triangles.iter().flatten().all(|i| *i < points));
});
