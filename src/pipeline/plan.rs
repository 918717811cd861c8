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
    let steps = Steps(line.settings());
    line.then(Stage::Parse, move |job, bytes| steps.parse(job, bytes))?
        .then(Stage::CornerFilter, move |job, posed| steps.corner_filter(job, posed))?
        .then(Stage::PairMatch, move |job, outlined| steps.pair_match(job, outlined))?
        .then(Stage::Isometry, move |job, matched| steps.isometry(job, matched))?
        .then(Stage::Validate, move |job, proposed| steps.validate(job, proposed))?
        .then(Stage::Merge, move |job, checked| steps.merge(job, checked))?
        .then(Stage::ProjectionSweep, move |job, ranked| steps.projection_sweep(job, ranked))?
        .then(Stage::Descriptor, move |job, framed| steps.descriptor(job, framed).map(|described| record(&described)))
}

/// Runs all stages on one model, within its limits; also the seconds of each stage.
pub fn describe(id: &str, bytes: Vec<u8>, settings: &Settings) -> (Result<Described, ModelError>, Seconds) {
    let bench = Bench::new(1, allowed(settings));
    let hash = *blake3::hash(&bytes).as_bytes();
    let job = Arc::new(Job::new(0, id.to_owned(), hash, bytes.len() as u64));
    bench.enter(&job);
    let result = std::thread::scope(|scope| {
        let (finished, over) = bounded::<()>(0);
        let bench = &bench;
        scope.spawn(move || {
            while over.recv_timeout(super::TICK) == Err(RecvTimeoutError::Timeout) {
                bench.check_limits();
            }
        });
        let result = in_turn(&job, bytes, Steps(settings), bench);
        drop(finished);
        result
    });
    (result, job.seconds())
}

fn in_turn(job: &Job, bytes: Vec<u8>, steps: Steps, bench: &Bench) -> Result<Described, ModelError> {
    let posed = bench.work_on(Stage::Parse, job, || steps.parse(job, bytes))?;
    let outlined = bench.work_on(Stage::CornerFilter, job, || steps.corner_filter(job, posed))?;
    let matched = bench.work_on(Stage::PairMatch, job, || steps.pair_match(job, outlined))?;
    let proposed = bench.work_on(Stage::Isometry, job, || steps.isometry(job, matched))?;
    let checked = bench.work_on(Stage::Validate, job, || steps.validate(job, proposed))?;
    let ranked = bench.work_on(Stage::Merge, job, || steps.merge(job, checked))?;
    let framed = bench.work_on(Stage::ProjectionSweep, job, || steps.projection_sweep(job, ranked))?;
    bench.work_on(Stage::Descriptor, job, || steps.descriptor(job, framed))
}
