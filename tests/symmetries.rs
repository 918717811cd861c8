//! `symmetries`: rotations as BOP's models_info.json lists them, on models whose rotations are known.

mod common;

use std::path::Path;

use common::{code, run, stderr, stdout};
use serde_json::Value;

/// The objects of data-samples, in the order of `names`.
fn objects(names: &[&str]) -> Vec<Value> {
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("data-samples");
    let output = run(&samples, &[&["symmetries"], names].concat());
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let all: Value = serde_json::from_str(&stdout(&output)).unwrap();
    (1..=names.len()).map(|i| all[i.to_string()].clone()).collect()
}

fn rotations(object: &Value) -> Vec<[f64; 16]> {
    let listed = object["symmetries_discrete"].as_array().cloned().unwrap_or_default();
    listed.into_iter().map(|matrix| serde_json::from_value(matrix).unwrap()).collect()
}

fn continuous(object: &Value) -> usize {
    object["symmetries_continuous"].as_array().map_or(0, Vec::len)
}

#[test]
fn rotations_of_real_shapes_are_found_with_and_without_mirrors() {
    let names = ["machinery/ship-propeller.step", "machinery/flange.step", "airplane/biplane.step"];
    let found = objects(&names);
    let counts: Vec<_> = found.iter().map(|o| (rotations(o).len(), continuous(o))).collect();
    // Three twisted blades; six holes around a neck that has no other end; one mirror and no rotation.
    assert_eq!(counts, [(2, 0), (5, 0), (0, 0)], "{names:?}");
    assert_eq!(found[0]["symmetries_mirror"].as_array().unwrap().len(), 0);
    assert_eq!(found[1]["symmetries_mirror"].as_array().unwrap().len(), 6);
    assert_eq!(found[2]["symmetries_mirror"].as_array().unwrap().len(), 1);
    for matrix in found.iter().flat_map(rotations) {
        let row = |i: usize| [matrix[4 * i], matrix[4 * i + 1], matrix[4 * i + 2]];
        let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        for (i, j) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)] {
            assert!((dot(row(i), row(j)) - f64::from(u8::from(i == j))).abs() < 1e-9, "{matrix:?}");
        }
        assert_eq!(matrix[12..], [0.0, 0.0, 0.0, 1.0]);
    }
}

#[test]
fn bodies_of_revolution_have_an_axis_and_turn_over_where_their_ends_are_alike() {
    let found = objects(&["instrument/drum.step", "household/vase.step"]);
    assert_eq!(found.iter().map(continuous).collect::<Vec<_>>(), [1, 1]);
    assert_eq!(found.iter().map(|o| rotations(o).len()).collect::<Vec<_>>(), [1, 0]);
    // The axis that the shape was made with (data-samples/truth.csv).
    let axis: [f64; 3] = serde_json::from_value(found[0]["symmetries_continuous"][0]["axis"].clone()).unwrap();
    let truth = [-0.366865012178, 0.511239684645, -0.777202706946];
    let cosine: f64 = axis.iter().zip(truth).map(|(a, b)| a * b).sum();
    assert!(cosine.abs() > 1.0 - 1e-9, "{axis:?}");
    for field in ["diameter", "size_x", "size_y", "size_z"] {
        assert!(found[0][field].as_f64().unwrap() > 0.0, "{field}");
    }
    assert!(found[0]["min_x"].is_number() && found[0]["diameter"].as_f64() >= found[0]["size_x"].as_f64());
}

#[test]
fn models_that_cannot_be_read_are_left_out_and_said() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("broken.stp"), "no model").unwrap();
    let output = run(dir.path(), &["symmetries", "broken.stp", "--out", "models_info.json"]);
    assert!(code(&output) == 1 && stderr(&output).contains("broken.stp: parse"), "{}", stderr(&output));
    assert_eq!(std::fs::read_to_string(dir.path().join("models_info.json")).unwrap(), "{}\n");
}
