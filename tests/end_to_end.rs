//! The main job on a small archive: a folder of STEP files in, a precision-recall report out.

mod common;

use std::io::Write;
use std::process::Stdio;

use common::{MODELS, archive, code, published, run, stderr, stdout, symalign};
use serde_json::Value;

#[test]
fn a_folder_becomes_a_store_and_a_report() {
    let dir = tempfile::tempdir().unwrap();
    archive(dir.path());
    let output = run(dir.path(), &["run", "models", "--jobs", "2"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert!(stderr(&output).contains("6 models done, 1 failed"), "{}", stderr(&output));
    assert!(stdout(&output).contains("symmetry:phase"), "{}", stdout(&output));
    for file in ["report.html", "metrics.json", "pr.csv", "per_query.csv", "pr.png", "labels.cla", "qrels.trec"] {
        assert!(dir.path().join("report").join(file).metadata().unwrap().len() > 0, "{file}");
    }
    let metrics: Value =
        serde_json::from_slice(&std::fs::read(dir.path().join("report/metrics.json")).unwrap()).unwrap();
    for method in ["symmetry", "pca", "cpca", "npca", "symmetry:phase"] {
        let map = metrics["methods"][method]["micro"]["map"].as_f64().unwrap();
        assert!((0.0..=1.0).contains(&map), "{method}: {map}");
    }
    let listed = stdout(&run(dir.path(), &["store", "list"]));
    assert_eq!(listed.lines().collect::<Vec<_>>(), MODELS);

    let other = run(dir.path(), &["run", "models", "--jobs", "1", "--store", "one"]);
    assert_eq!(code(&other), 0);
    assert!(published(&dir.path().join("one")) == published(&dir.path().join("store")), "jobs changed the bytes");

    let answer = stdout(&run(dir.path(), &["query", "models/machinery/bracket.step", "--json", "-k", "3"]));
    let answer: Value = serde_json::from_str(&answer).unwrap();
    assert_eq!(answer["hits"].as_array().unwrap().len(), 3);
    assert_eq!(answer["hits"][0]["model"], "machinery/bracket.step");
    assert!(answer["hits"][0]["distance"].as_f64().unwrap() < 1e-5, "{answer}");
}

#[test]
fn the_order_of_the_inputs_does_not_change_the_store() {
    let dir = tempfile::tempdir().unwrap();
    archive(dir.path());
    let mut inputs: Vec<String> = MODELS.iter().map(|model| format!("models/{model}")).collect();
    inputs.insert(3, "models/broken.step".into());
    let mut stored = |store: &str| {
        let args = ["run", "--jobs", "1", "--method", "symmetry", "--store", store].map(String::from);
        let args: Vec<&str> = args.iter().chain(&inputs).map(String::as_str).collect();
        assert_eq!(code(&run(dir.path(), &args)), 0);
        inputs.reverse();
        published(&dir.path().join(store))
    };
    assert!(stored("forwards") == stored("backwards"), "a model depends on those before it");
}

#[test]
fn a_tar_stream_is_read_from_standard_input() {
    let dir = tempfile::tempdir().unwrap();
    let folder = archive(dir.path());
    let mut tar = tar::Builder::new(Vec::new());
    for model in &MODELS[2..4] {
        tar.append_path_with_name(folder.join(model), format!("./{model}")).unwrap();
    }
    let mut child = symalign(dir.path(), &["run", "-", "--method", "pca"]).stdin(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(&tar.into_inner().unwrap()).unwrap();
    assert!(child.wait().unwrap().success());
    assert_eq!(stdout(&run(dir.path(), &["store", "list"])).lines().collect::<Vec<_>>(), MODELS[2..4]);
}

#[test]
fn pictures_of_models_of_one_name_do_not_replace_each_other() {
    let dir = tempfile::tempdir().unwrap();
    let folder = archive(dir.path());
    for (i, part) in ["a", "b"].iter().enumerate() {
        std::fs::create_dir(dir.path().join(part)).unwrap();
        std::fs::copy(folder.join(MODELS[i]), dir.path().join(part).join("part.step")).unwrap();
    }
    let output = run(dir.path(), &["inspect", "a/part.step", "b/part.step", "--render", "pictures"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let picture = |name: &str| std::fs::read(dir.path().join("pictures").join(name)).unwrap();
    assert_ne!(picture("part.step-silhouettes.png"), picture("part.step~2-silhouettes.png"));
    assert_eq!(std::fs::read_dir(dir.path().join("pictures")).unwrap().count(), 8);
}

#[test]
fn inspect_prints_the_fields_of_the_contract() {
    let dir = tempfile::tempdir().unwrap();
    archive(dir.path());
    let output = run(dir.path(), &["inspect", "models/machinery/bracket.step", "--json", "--render", "pictures"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let object: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(object["model"], "models/machinery/bracket.step");
    for key in ["unit_mm", "solids", "faces", "edges", "triangles", "area_mm2", "volume_mm3"] {
        assert!(object[key].as_f64().unwrap() > 0.0, "{key}: {}", object[key]);
    }
    let lengths = [("centroid_mm", 3), ("bbox_mm", 6), ("skipped", 0)];
    for (key, length) in lengths {
        assert_eq!(object[key].as_array().unwrap().len(), length, "{key}");
    }
    let plane = &object["symmetry"]["planes"][0];
    assert_eq!(plane["normal"].as_array().unwrap().len(), 3);
    assert!(plane["coverage"].as_f64().unwrap() > 0.9, "{plane}");
    assert!(plane["pairs"][0][0].is_u64() || plane["pairs"][0][0].is_string() || plane["self"][0].is_u64(), "{plane}");
    let frame = &object["frames"]["symmetry"];
    assert_eq!(frame["axes"][2].as_array().unwrap().len(), 3);
    assert_eq!(
        frame["sweep"]["angles_deg"].as_array().unwrap().len(),
        frame["sweep"]["areas_mm2"].as_array().unwrap().len()
    );
    assert_eq!(object["descriptors"]["magnitude"]["cpca"][2].as_array().unwrap().len(), 32);
    assert_eq!(object["descriptors"]["phase"]["symmetry"][0][31].as_array().unwrap().len(), 2);
    assert!(object["seconds"]["parse"].as_f64().unwrap() > 0.0);
    let pictures = std::fs::read_dir(dir.path().join("pictures")).unwrap().count();
    assert_eq!(pictures, 4);
}
