//! `align`: the model in its canonical pose, read again.

mod common;

use std::path::{Path, PathBuf};

use common::{code, run, stderr, stdout};
use serde_json::Value;

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data-samples").join(name)
}

fn inspected(dir: &Path, model: &str) -> Value {
    let output = run(dir, &["inspect", model, "--json", "--method", "symmetry"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    serde_json::from_str(&stdout(&output)).unwrap()
}

fn aligned(dir: &Path, model: &str, out: &str) -> Vec<u8> {
    let output = run(dir, &["align", model, "--out", out]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    std::fs::read(dir.join(out)).unwrap()
}

#[test]
fn an_aligned_step_file_is_the_same_body_with_its_plane_across_x() {
    let dir = tempfile::tempdir().unwrap();
    for name in ["airplane/glider-v-tail.step", "household/teacup-with-saucer.step", "machinery/bracket.step"] {
        let model = sample(name).display().to_string();
        aligned(dir.path(), &model, "out.step");
        let (before, after) = (inspected(dir.path(), &model), inspected(dir.path(), "out.step"));
        for field in ["area_mm2", "volume_mm3"] {
            let (a, b) = (before[field].as_f64().unwrap(), after[field].as_f64().unwrap());
            // How finely faces are cut and integrated follows the box of the whole, which turns with it.
            assert!((a - b).abs() <= 1e-5 * a, "{name} {field}: {a} {b}");
        }
        for field in ["faces", "edges", "solids"] {
            assert_eq!(before[field], after[field], "{name} {field}");
        }
        let plane = &after["symmetry"]["planes"][0];
        assert!(plane["normal"][0].as_f64().unwrap().abs() > 1.0 - 1e-6, "{name}: {plane}");
        assert!(plane["offset_mm"].as_f64().unwrap().abs() < 1e-5, "{name}: {plane}");
        let axes = &after["frames"]["symmetry"]["axes"];
        (0..3).for_each(|i| assert!(axes[i][i].as_f64().unwrap().abs() > 1.0 - 1e-6, "{name}: {axes}"));
    }
}

/// Area, in squared units of the file, and the coordinates of a binary STL file.
fn stl(bytes: &[u8]) -> (f64, Vec<[f64; 3]>) {
    let count = u32::from_le_bytes(bytes[80..84].try_into().unwrap()) as usize;
    assert_eq!(bytes.len(), 84 + 50 * count);
    let float = |at: usize| f64::from(f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()));
    let point = |at: usize| [float(at), float(at + 4), float(at + 8)];
    let corners = (0..3 * count).map(|i| point(84 + 50 * (i / 3) + 12 + 12 * (i % 3)));
    let points: Vec<_> = corners.collect();
    (points.chunks_exact(3).map(area).sum(), points)
}

fn area(corners: &[[f64; 3]]) -> f64 {
    let side = |i: usize| [0, 1, 2].map(|c| corners[i][c] - corners[0][c]);
    let (u, v) = (side(1), side(2));
    let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    0.5 * cross.iter().map(|c| c * c).sum::<f64>().sqrt()
}

/// The JSON and the binary chunk of a GLB file.
fn glb(bytes: &[u8]) -> (Value, &[u8]) {
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&bytes[..4], word(4), word(8)), (&b"glTF"[..], 2, bytes.len()));
    let length = word(12);
    assert_eq!((&bytes[16..20], &bytes[24 + length..28 + length]), (&b"JSON"[..], &b"BIN\0"[..]));
    let json = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    (json, &bytes[28 + length..])
}

#[test]
fn the_triangles_of_all_formats_are_those_of_the_model_mirrored_by_x() {
    let dir = tempfile::tempdir().unwrap();
    let model = sample("machinery/bracket.step").display().to_string();
    let expected = inspected(dir.path(), &model)["area_mm2"].as_f64().unwrap();
    let bytes = aligned(dir.path(), &model, "out.stl");
    let (area, points) = stl(&bytes);
    assert!((area - expected).abs() < 0.002 * expected, "{area} {expected}");
    let extent = |axis: usize| {
        let values = points.iter().map(|p| p[axis]);
        values.fold((0.0, 0.0), |(low, high), x| (f64::min(low, x), f64::max(high, x)))
    };
    let (low, high) = extent(0);
    assert!((low + high).abs() < 1e-4 * (high - low), "x is the mirror's normal: {low} {high}");

    let bytes = aligned(dir.path(), &model, "out.glb");
    let (json, binary) = glb(&bytes);
    assert_eq!(json["buffers"][0]["byteLength"], binary.len());
    assert_eq!(json["nodes"].as_array().unwrap().len(), 1);
    for axis in 0..3 {
        let (low, high) = extent(axis);
        let metres = |end: &str| json["accessors"][0][end][axis].as_f64().unwrap();
        assert!((1000.0 * metres("min") - low).abs() < 1e-4 * (high - low), "{json}");
        assert!((1000.0 * metres("max") - high).abs() < 1e-4 * (high - low), "{json}");
    }

    let text = String::from_utf8(aligned(dir.path(), &model, "out.obj")).unwrap();
    let starting = |start: &str| text.lines().filter(|line| line.starts_with(start)).count();
    assert_eq!(starting("f ") * 3, points.len());
    assert_eq!(starting("v "), starting("vn "));
    assert_eq!(starting("g ") as u64, inspected(dir.path(), &model)["faces"].as_u64().unwrap());
}

#[test]
fn what_cannot_be_written_is_said() {
    let dir = tempfile::tempdir().unwrap();
    let model = sample("household/stool.step").display().to_string();
    let output = run(dir.path(), &["align", &model, "--out", "out.iges"]);
    assert!(code(&output) == 2 && stderr(&output).contains(".step, .glb, .stl or .obj"), "{}", stderr(&output));
    std::fs::write(dir.path().join("broken.stp"), "no model").unwrap();
    let output = run(dir.path(), &["align", "broken.stp", "--out", "out.glb"]);
    assert!(code(&output) == 1 && stderr(&output).contains("broken.stp: parse"), "{}", stderr(&output));
    assert!(!dir.path().join("out.glb").exists());
}
