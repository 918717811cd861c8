//! The measures beside those of pytrec_eval, ir_measures and ranx, where a Python that has them is found.
//!
//! `SYMALIGN_PYTHON` names the interpreter, else it is `python3`; without pytrec_eval the test says so and passes.

mod synthetic;

use std::path::Path;
use std::process::Command;
use symalign::evaluate::{self, Input, Labels, Options};
use symalign::store::Store;

/// What `benches/oracles.py` ends with where there is no oracle.
const NO_ORACLE: i32 = 77;

#[test]
fn measures_agree_with_the_oracles() {
    let folder = tempfile::tempdir().unwrap();
    synthetic::store(folder.path());
    let store = Store::open(folder.path()).unwrap();
    let labels = Labels::load(&folder.path().join("labels.csv")).unwrap();
    let options = Options { draws: 100, resamples: 100, ..Options::default() };
    let out = folder.path().join("out");
    evaluate::report(&Input::of_store(&store, labels), &options, &out).unwrap();
    let python = std::env::var("SYMALIGN_PYTHON").unwrap_or_else(|_| "python3".into());
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/oracles.py");
    let Ok(output) = Command::new(&python).arg(script).arg(&out).output() else {
        return eprintln!("skipped: there is no {python} (SYMALIGN_PYTHON may name one)");
    };
    let told = String::from_utf8_lossy(&output.stdout);
    if output.status.code() == Some(NO_ORACLE) {
        return eprintln!("{told}(SYMALIGN_PYTHON may name one that has)");
    }
    println!("{told}");
    assert!(output.status.success(), "{told}{}", String::from_utf8_lossy(&output.stderr));
    assert!(told.contains("largest difference over 8 methods"), "{told}");
}
