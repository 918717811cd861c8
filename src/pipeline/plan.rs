//! The eight stages in their order, as workers in a row or one after the other.

use std::io;
use std::sync::Arc;

use crossbeam_channel::{RecvTimeoutError, bounded};

use super::budget::allowed;
use super::line::Line;
use super::parcel::{Job, Seconds};
use super::record::record;
use super::steps::{Described, Steps};
use super::worker::Bench;
use crate::settings::Settings;
use crate::stages::{ModelError, Stage};
use crate::store::ModelRecord;

/// Sets up workers for all stages.
///
/// Errors: the system has no more threads.
pub fn stages<'s, 'e>(line: Line<'s, 'e, Vec<u8>>) -> io::Result<Line<'s, 'e, ModelRecord>> {
    let steps = Steps { settings: line.settings(), files: &line.bench().files };
    line.then(Stage::Parse, move |job, bytes, scratch| steps.parse(job, bytes, scratch))?
        .then(Stage::CornerFilter, move |job, posed, scratch| steps.corner_filter(job, posed, scratch))?
        .then(Stage::PairMatch, move |job, outlined, _| steps.pair_match(job, outlined))?
        .then(Stage::Isometry, move |job, matched, _| steps.isometry(job, matched))?
        .then(Stage::Validate, move |job, proposed, _| steps.validate(job, proposed))?
        .then(Stage::Merge, move |job, checked, _| steps.merge(job, checked))?
        .then(Stage::ProjectionSweep, move |job, ranked, _| steps.projection_sweep(job, ranked))?
        .then(Stage::Descriptor, move |job, framed, _| {
            steps.descriptor(job, framed).map(|described| record(&described))
        })
}

/// Runs all stages on one model, within its limits; also the seconds of each stage.
pub fn describe(id: &str, bytes: Vec<u8>, settings: &Settings) -> (Result<Described, ModelError>, Seconds) {
    let bench = Bench::new(1, allowed(settings));
    let hash = *blake3::hash(&bytes).as_bytes();
    let job = Arc::new(Job::new(0, id.to_owned(), hash, bytes.len() as u64));
    job.take_over(&bytes);
    bench.enter(&job);
    let result = std::thread::scope(|scope| {
        let (finished, over) = bounded::<()>(0);
        let bench = &bench;
        scope.spawn(move || {
            while over.recv_timeout(super::TICK) == Err(RecvTimeoutError::Timeout) {
                bench.check_limits();
            }
        });
        let result = in_turn(&job, bytes, Steps { settings, files: &bench.files }, bench);
        drop(finished);
        result
    });
    (result, job.seconds())
}

fn in_turn(job: &Job, bytes: Vec<u8>, steps: Steps, bench: &Bench) -> Result<Described, ModelError> {
    let posed = bench.work_on(Stage::Parse, job, |scratch| steps.parse(job, bytes, scratch))?;
    let outlined = bench.work_on(Stage::CornerFilter, job, |scratch| steps.corner_filter(job, posed, scratch))?;
    let matched = bench.work_on(Stage::PairMatch, job, |_| steps.pair_match(job, outlined))?;
    let proposed = bench.work_on(Stage::Isometry, job, |_| steps.isometry(job, matched))?;
    let checked = bench.work_on(Stage::Validate, job, |_| steps.validate(job, proposed))?;
    let ranked = bench.work_on(Stage::Merge, job, |_| steps.merge(job, checked))?;
    let framed = bench.work_on(Stage::ProjectionSweep, job, |_| steps.projection_sweep(job, ranked))?;
    bench.work_on(Stage::Descriptor, job, |_| steps.descriptor(job, framed))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(name: &str) -> Vec<u8> {
        std::fs::read(format!("{}/data-samples/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
    }

    /// What the store would keep of a model that is worked on at this bench.
    fn kept(bench: &Bench, settings: &Settings, bytes: &[u8]) -> String {
        let job = Job::new(0, String::new(), [0; 32], bytes.len() as u64);
        let (mut file, steps) = (bench.files.take(), Steps { settings, files: &bench.files });
        file.clear();
        file.extend_from_slice(bytes);
        // Numbers are written out to the last bit.
        format!("{:?}", in_turn(&job, file, steps, bench).map(|described| record(&described)))
    }

    /// A bug in the midst of a model.
    fn panic_at(bench: &Bench, settings: &Settings, bytes: &[u8]) {
        let (job, steps) = (Job::new(0, String::new(), [0; 32], 0), Steps { settings, files: &bench.files });
        let failed = bench.work_on(Stage::CornerFilter, &job, |scratch| {
            let posed = steps.parse(&job, bytes.to_vec(), scratch)?;
            steps.corner_filter(&job, posed, scratch)?;
            panic!("a bug") as Result<(), ModelError>
        });
        assert!(failed.is_err() && bench.scratch.bytes() == 0, "what it leaves is kept");
    }

    #[test]
    fn a_model_does_not_depend_on_those_before_it() {
        let settings = Settings::default();
        let bench = || Bench::new(1, allowed(&settings));
        let mut files: Vec<_> =
            ["household/bottle.step", "machinery/bracket.step", "boat/canoe.step"].map(sample).to_vec();
        // A file that ends early, and one whose entities are all there but none is what it should be.
        files.push(files[0][..files[0].len() / 2].to_vec());
        files.push(String::from_utf8_lossy(&files[1]).replace("EDGE_CURVE", "EDGE_CURSE").into_bytes());
        let alone: Vec<_> = files.iter().map(|bytes| kept(&bench(), &settings, bytes)).collect();
        assert!(alone[..3].iter().all(|text| text.starts_with("Ok")) && alone[4].starts_with("Err"), "{}", alone[4]);
        let shared = bench();
        let order: Vec<_> = (0..files.len()).chain((0..files.len()).rev()).collect();
        for i in order {
            assert!(kept(&shared, &settings, &files[i]) == alone[i], "file {i} depends on what was before it");
            if i == 2 {
                assert!(shared.scratch.bytes() > 0 && shared.files.bytes() > 0, "nothing is kept");
                panic_at(&shared, &settings, &files[1]);
            }
        }
    }
}
