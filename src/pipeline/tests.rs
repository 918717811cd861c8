//! Whole runs with small steps in the place of the stages.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use super::line::Line;
use super::run::run_with;
use super::{Progress, Report, Request, Shard};
use crate::settings::Settings;
use crate::stages::descriptor::{MAGNITUDES, PHASES};
use crate::stages::merge::Label;
use crate::stages::projection_sweep::Source;
use crate::stages::{ModelError, Stage};
use crate::store::{ModelRecord, Pose, Store, Summary, THUMBNAIL, merge, published_path};

/// A record whose area is the number in the model's text.
fn record(number: f64) -> ModelRecord {
    let summary = Summary {
        schema: String::new(),
        unit_mm: 1.0,
        solids: 1,
        faces: 6,
        edges: 12,
        triangles: 12,
        area_mm2: number,
        volume_mm3: 1.0,
        centroid_mm: [0.0; 3],
        bbox_mm: [0.0; 6],
        skipped: Vec::new(),
        skipped_count: 0,
        warnings: Vec::new(),
        warning_count: 0,
        label: Label::None,
        planes: Vec::new(),
        plane_count: 0,
        axes: Vec::new(),
        source: Source::Cpca,
        areas_mm2: [0.0; 3],
        axisymmetric: false,
        hull: Default::default(),
    };
    let pose = |method| Pose {
        method,
        frame: [number; 12],
        magnitude: vec![number as f32; MAGNITUDES],
        phase: vec![0.5; PHASES],
    };
    ModelRecord {
        summary,
        thumbnail: vec![7; THUMBNAIL * THUMBNAIL],
        poses: Settings::default().methods.iter().map(|&method| pose(method)).collect(),
    }
}

/// What the steps did, and when they ask for a stop.
#[derive(Default)]
struct Fake {
    computed: AtomicUsize,
    stop: AtomicBool,
    /// Ask for a stop after so many models.
    stop_after: Option<usize>,
}

impl Fake {
    /// Text that is no number fails in parse, a negative number panics in merge, 1000 and more never ends.
    fn line<'s, 'e>(self: &Arc<Self>, line: Line<'s, 'e, Vec<u8>>) -> io::Result<Line<'s, 'e, ModelRecord>> {
        let fake = Arc::clone(self);
        line.then(Stage::Parse, |_, bytes, _| {
            let text = String::from_utf8_lossy(&bytes).trim().to_owned();
            text.parse::<f64>().map_err(|e| ModelError::at(Stage::Parse, 3, e.to_string()))
        })?
        .then(Stage::Merge, |_, number, _| {
            assert!(number >= 0.0, "below zero");
            Ok(number)
        })?
        .then(Stage::Descriptor, move |job, number, _| {
            if number >= 1000.0 {
                loop {
                    job.cancel.check().map_err(|c| ModelError::cancelled(Stage::Descriptor, c))?;
                    std::thread::sleep(Duration::from_millis(1));
                }
            }
            let done = fake.computed.fetch_add(1, Ordering::SeqCst) + 1;
            if Some(done) == fake.stop_after {
                fake.stop.store(true, Ordering::SeqCst);
            }
            Ok(record(number))
        })
    }
}

/// Runs the fake steps; also the number of models that reached the last one.
fn run(settings: &Settings, stop_after: Option<usize>, change: impl FnOnce(&mut Request)) -> (Report, usize) {
    let fake = Arc::new(Fake { stop_after, ..Fake::default() });
    let mut request = Request { settings, shard: None, fresh: false, retry_failed: false, stop: &fake.stop };
    change(&mut request);
    let report = run_with(&request, &mut Progress::Silent, &|line| fake.line(line)).unwrap();
    (report, fake.computed.load(Ordering::SeqCst))
}

/// A folder with the models `m00.stp`.. holding the texts.
fn models(dir: &Path, texts: &[&str]) -> PathBuf {
    let folder = dir.join("in");
    std::fs::create_dir_all(&folder).unwrap();
    for (i, text) in texts.iter().enumerate() {
        std::fs::write(folder.join(format!("m{i:02}.stp")), text).unwrap();
    }
    folder
}

fn settings(input: &Path, store: &Path, jobs: usize) -> Settings {
    Settings { input: vec![input.to_owned()], store: store.to_owned(), jobs, ..Settings::default() }
}

fn bytes(store: &Path) -> Vec<u8> {
    std::fs::read(published_path(store)).unwrap()
}

const MIXED: [&str; 9] = ["1", "2", "x", "3", "-1", "4", "5", "2", "6"];

#[test]
fn failures_and_panics_are_kept_with_their_reasons_and_the_run_goes_on() {
    let dir = tempfile::tempdir().unwrap();
    let input = models(dir.path(), &MIXED);
    let (report, computed) = run(&settings(&input, &dir.path().join("s"), 2), None, |_| {});
    assert_eq!((report.done, report.failures.len(), report.interrupted), (7, 2, false));
    assert_eq!(computed, 6, "the model that is there twice is computed once");
    let store = Store::open(&dir.path().join("s")).unwrap();
    assert_eq!((store.len(), store.id(0), store.failures()), (7, "m00.stp", &report.failures[..]));
    let row = store.find("m07.stp").unwrap();
    assert_eq!((store.summary(row).unwrap().area_mm2, store.summary(1).unwrap().area_mm2), (2.0, 2.0));
    let [torn, bug] = store.failures() else { panic!("{:?}", store.failures()) };
    assert_eq!((torn.id.as_str(), torn.error.stage, torn.error.entity), ("m02.stp", Stage::Parse, Some(3)));
    assert!(bug.id == "m04.stp" && bug.error.stage == Stage::Merge && bug.error.why.contains("below zero"));
    assert!(report.summary().contains("7 models done, 2 failed; 8 computed"), "{}", report.summary());
}

#[test]
fn bytes_do_not_depend_on_workers_shards_or_interruptions() {
    let dir = tempfile::tempdir().unwrap();
    let input = models(dir.path(), &MIXED);
    let at = |name: &str| dir.path().join(name);
    run(&settings(&input, &at("one"), 1), None, |_| {});
    run(&settings(&input, &at("many"), 4), None, |_| {});
    assert!(bytes(&at("one")) == bytes(&at("many")));

    let mut computed = 0;
    for stop_after in [Some(1), Some(2), None] {
        let (report, now) = run(&settings(&input, &at("cut"), 1), stop_after, |_| {});
        assert_eq!(report.interrupted, stop_after.is_some(), "few models are in flight when the stop is asked for");
        assert_eq!(report.interrupted, !published_path(&at("cut")).exists());
        computed += now;
    }
    assert!(bytes(&at("one")) == bytes(&at("cut")));
    assert_eq!(computed, 6, "no model is computed twice");

    let shards = ["1/3", "2/3", "3/3"].map(|text| text.parse::<Shard>().unwrap());
    let parts = shards.map(|shard| at(&shard.index.to_string()));
    for (shard, part) in shards.iter().zip(&parts) {
        run(&settings(&input, part, 2), None, |request| request.shard = Some(*shard));
    }
    merge::merge(&parts, &at("merged")).unwrap();
    assert!(bytes(&at("one")) == bytes(&at("merged")));
    let (report, computed) = run(&settings(&input, &at("merged"), 1), None, |_| {});
    assert_eq!((report.done, computed), (7, 0), "a merged store is taken over");
    assert!(bytes(&at("one")) == bytes(&at("merged")));
}

#[test]
fn a_renamed_model_is_not_computed_again_and_removed_ones_are_not_published() {
    let dir = tempfile::tempdir().unwrap();
    let input = models(dir.path(), &["1", "2", "x"]);
    let settings = settings(&input, &dir.path().join("s"), 1);
    run(&settings, None, |_| {});
    std::fs::rename(input.join("m00.stp"), input.join("new.stp")).unwrap();
    std::fs::remove_file(input.join("m01.stp")).unwrap();
    let (report, computed) = run(&settings, None, |_| {});
    assert_eq!((report.done, report.failures.len(), computed), (1, 1, 0));
    let store = Store::open(&settings.store).unwrap();
    assert_eq!((store.len(), store.id(0)), (1, "new.stp"));
}

#[test]
fn failures_are_remembered_and_retried_on_request() {
    let dir = tempfile::tempdir().unwrap();
    let input = models(dir.path(), &["x"]);
    let settings = settings(&input, &dir.path().join("s"), 1);
    assert_eq!(run(&settings, None, |_| {}).0.computed, 1);
    let (again, _) = run(&settings, None, |_| {});
    assert_eq!((again.computed, again.failures.len()), (0, 1));
    assert_eq!(run(&settings, None, |request| request.retry_failed = true).0.computed, 1);
}

#[test]
fn a_model_that_never_ends_fails_with_its_limit() {
    let dir = tempfile::tempdir().unwrap();
    let input = models(dir.path(), &["1", "1000", "2"]);
    let mut settings = settings(&input, &dir.path().join("s"), 2);
    settings.limits.seconds = 0.3;
    let (report, _) = run(&settings, None, |_| {});
    assert_eq!((report.done, report.failures.len()), (2, 1));
    let error = &report.failures[0].error;
    assert_eq!(
        (error.stage, error.why.as_str()),
        (Stage::Descriptor, "time limit of 0.3 s passed in stage descriptor")
    );
}

#[test]
fn a_model_without_bytes_is_a_failure_without_hash() {
    let dir = tempfile::tempdir().unwrap();
    let input = models(dir.path(), &["1"]);
    std::fs::write(input.join("m01.zip"), "no archive").unwrap();
    let mut settings = settings(&input, &dir.path().join("s"), 1);
    settings.limits.bytes = 10;
    std::fs::write(input.join("m02.stp"), "12345678901").unwrap();
    let (report, _) = run(&settings, None, |_| {});
    let lost: Vec<_> = report.failures.iter().map(|failure| (failure.id.as_str(), failure.hash)).collect();
    assert_eq!((report.done, lost), (1, vec![("m01.zip", None), ("m02.stp", None)]));
}
