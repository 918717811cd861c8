//! The eight stages on three models of data-samples, one group a stage.
//!
//! Times on a noisy machine mean little by themselves: compare stages, or two commits in one run.

use std::hint::black_box;
use std::path::Path;

use criterion::{Criterion, criterion_group, criterion_main};
use symalign::cancel::Cancel;
use symalign::stages::corner_filter::corner_filter;
use symalign::stages::descriptor::descriptor;
use symalign::stages::isometry::isometry;
use symalign::stages::merge::merge;
use symalign::stages::pair_match::pair_match;
use symalign::stages::parse::parse;
use symalign::stages::projection_sweep::{self as sweep, projection_sweep};
use symalign::stages::validate::validate;

const MODELS: [&str; 3] = ["airplane/biplane.step", "household/mug.step", "vehicle/sedan.step"];

fn stages(criterion: &mut Criterion) {
    for name in MODELS {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data-samples").join(name);
        let bytes = std::fs::read(&path).expect("data-samples is part of the project");
        model(criterion, name, &bytes);
    }
}

/// Runs the stages one after the other, each measured on what the one before gave.
fn model(criterion: &mut Criterion, name: &str, bytes: &[u8]) {
    macro_rules! measured {
        ($stage:ident, $($input:expr),*) => {{
            let cancel = Cancel::new();
            let run = || {
                $stage($($input,)* &Default::default(), &cancel).expect("the models of data-samples pass all stages")
            };
            criterion.bench_function(&format!("{}/{name}", stringify!($stage)), |bencher| {
                bencher.iter(|| black_box(run()))
            });
            run()
        }};
    }
    let read = |bytes: &[u8], options: &_, cancel: &_| parse(bytes, options, None, cancel);
    let parsed = measured!(read, bytes);
    let outlines = measured!(corner_filter, &parsed);
    let matches = measured!(pair_match, &parsed, &outlines);
    let candidates = measured!(isometry, &parsed, &outlines, &matches);
    let validated = measured!(validate, &parsed, &outlines, &matches, &candidates);
    let symmetries = measured!(merge, &parsed, &outlines, &matches, &validated);
    let canonical = measured!(projection_sweep, &parsed, &symmetries);
    // The same 180 planes by counting pixels, without refinement.
    let pixels = sweep::Options { area_by: sweep::AreaBy::Pixels, refine: false, ..Default::default() };
    let by_pixels = || projection_sweep(&parsed, &symmetries, &pixels, &Cancel::new()).expect("as by spans");
    criterion.bench_function(&format!("projection_sweep by pixels/{name}"), |b| b.iter(|| black_box(by_pixels())));
    measured!(descriptor, &parsed.wireframe, &parsed.measures, &canonical.frame);
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10);
    targets = stages
}
criterion_main!(benches);
