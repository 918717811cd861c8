//! What a run tells its log: `tracing` events, which cost nothing where nobody listens. `run --log FILE` writes each as
//! a JSON line; the field `event` says what it is.

use tracing::{info, warn};

use super::parcel::{Job, Seconds};
use super::report::Report;
use super::run::Request;
use crate::stages::{ModelError, Stage};
use crate::store::{Failure, Hash, ModelRecord};

/// An event with the seconds of each stage among its fields.
macro_rules! timed {
    ($level:ident, $seconds:expr, $($field:ident = $value:expr),+) => {{
        let of = |stage: Stage| -> f64 { $seconds[stage as usize] };
        $level!(
            $($field = $value,)+
            seconds.parse = of(Stage::Parse),
            seconds.corner_filter = of(Stage::CornerFilter),
            seconds.pair_match = of(Stage::PairMatch),
            seconds.isometry = of(Stage::Isometry),
            seconds.validate = of(Stage::Validate),
            seconds.merge = of(Stage::Merge),
            seconds.projection_sweep = of(Stage::ProjectionSweep),
            seconds.descriptor = of(Stage::Descriptor),
        )
    }};
}

/// A run starts; `effective` are the settings that results depend on.
pub fn started(request: &Request, effective: &str) {
    let settings = request.settings;
    info!(
        event = "run_start",
        version = env!("CARGO_PKG_VERSION"),
        pid = std::process::id(),
        input = ?settings.input,
        store = %settings.store.display(),
        jobs = settings.busy_limit(),
        shard = request.shard.map(|shard| format!("{}/{}", shard.index, shard.count)),
        fresh = request.fresh,
        retry_failed = request.retry_failed,
        limits = ?settings.limits,
        settings = effective,
    );
}

/// A model arrived at the end.
pub fn model(job: &Job, outcome: &Result<ModelRecord, ModelError>) {
    match outcome {
        Ok(record) => done(job, record),
        Err(error) => lost(&job.id, Some(&job.hash), job.bytes, error, &job.seconds()),
    }
}

fn done(job: &Job, record: &ModelRecord) {
    let (seconds, of) = (job.seconds(), &record.summary);
    timed!(
        info,
        seconds,
        event = "model",
        model = job.id,
        outcome = "done",
        hash = hex(&job.hash),
        bytes = job.bytes,
        faces = of.faces,
        triangles = of.triangles,
        warnings = of.warning_count,
        skipped = of.skipped_count
    );
    of.warnings.iter().for_each(|text| warn!(event = "warning", model = job.id, text));
}

fn lost(id: &str, hash: Option<&Hash>, bytes: u64, error: &ModelError, seconds: &Seconds) {
    timed!(
        warn,
        seconds,
        event = "model",
        model = id,
        outcome = "failed",
        hash = hash.map(hex),
        bytes = bytes,
        stage = error.stage.name(),
        reason = error.why,
        entity = error.entity
    );
}

/// A model whose bytes could not be had.
pub fn unreadable(failure: &Failure) {
    lost(&failure.id, failure.hash.as_ref(), 0, &failure.error, &Seconds::default());
}

/// So many outcomes are on the disk from now on.
pub fn committed(outcomes: usize) {
    info!(event = "commit", outcomes);
}

/// Somebody asked for a stop.
pub fn interrupted() {
    warn!(event = "interrupted");
}

/// A run ends.
pub fn ended(report: &Report) {
    timed!(
        info,
        report.seconds,
        event = "run_end",
        interrupted = report.interrupted,
        done = report.done,
        failed = report.failures.len(),
        computed = report.computed,
        bytes = report.bytes,
        elapsed = report.elapsed.as_secs_f64(),
        peak_memory = report.peak_memory,
        summary = report.summary()
    );
}

fn hex(hash: &Hash) -> String {
    blake3::Hash::from_bytes(*hash).to_string()
}
