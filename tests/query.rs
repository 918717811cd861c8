//! `query`: one model and many, with the evidence behind the hits.

mod common;

use common::{MODELS, archive, code, run, stderr, stdout};
use serde_json::Value;

#[test]
fn hits_name_the_plane_and_the_faces_behind_them() {
    let dir = tempfile::tempdir().unwrap();
    archive(dir.path());
    assert_eq!(code(&run(dir.path(), &["run", "models", "--store", "s", "--method", "symmetry"])), 0);
    let one = run(dir.path(), &["query", "models/airplane/glider-v-tail.step", "--store", "s", "-k", "3", "--json"]);
    assert_eq!(code(&one), 0, "{}", stderr(&one));
    let answer: Value = serde_json::from_str(&stdout(&one)).unwrap();
    let best = &answer["hits"][0];
    assert_eq!((&best["model"], &best["distance"]), (&"airplane/glider-v-tail.step".into(), &0.0.into()));
    assert_eq!(answer["hits"].as_array().unwrap().len(), 3);
    for symmetry in [&answer["symmetry"], &best["symmetry"]] {
        let plane = &symmetry["plane"];
        assert_eq!((&symmetry["label"], &symmetry["source"]), (&"exact".into(), &"symmetry".into()));
        assert!(plane["coverage"].as_f64().unwrap() > 0.99 && plane["normal"].as_array().unwrap().len() == 3);
        assert!(plane["pairs"][0][0].is_number() || plane["pairs"][0][0].is_string(), "{plane}");
        assert!(plane["pair_count"].as_u64().unwrap() > 0);
    }

    // A folder asks for each of its models; what cannot be read is said, and the rest answered as if asked alone.
    let all = run(dir.path(), &["query", "models", "--store", "s", "-k", "3", "--json"]);
    assert!(code(&all) == 1 && stderr(&all).contains("broken.step"), "{}", stderr(&all));
    let answers: Vec<Value> = stdout(&all).lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(answers.len(), MODELS.len());
    assert_eq!(answers[0]["hits"], answer["hits"]);
    assert!(answers.iter().all(|a| a["hits"][0]["distance"] == 0.0));
}
