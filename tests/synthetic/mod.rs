//! A published store of made-up models: classes are clouds of descriptors, pictures are discs and squares.
#![allow(dead_code)] // each test program uses its part

use std::collections::BTreeMap;
use std::path::Path;
use symalign::alignment::Method;
use symalign::stages::descriptor::{MAGNITUDES, PHASES};
use symalign::stages::merge::Label;
use symalign::stages::projection_sweep::Source;
use symalign::stages::{ModelError, Stage};
use symalign::store::{Contents, Failure, ModelRecord, PlaneEvidence, Pose, Summary, THUMBNAIL, publish};

/// The paper's classes.
pub const CLASSES: [(&str, usize); 9] = [
    ("airplane", 22),
    ("animal", 9),
    ("boat", 9),
    ("gun", 5),
    ("household", 15),
    ("instrument", 9),
    ("machinery", 12),
    ("sunglasses", 4),
    ("vehicle", 12),
];
/// The frames of the store, each noisier than the one before.
pub const METHODS: [Method; 4] = [Method::Symmetry, Method::Cpca, Method::Pca, Method::Npca];

/// Writes the store with 97 models and two failures into `dir`, and the labels of 98 into `labels.csv` beside it.
pub fn store(dir: &Path) {
    of(dir, &CLASSES.map(|(class, n)| (class.to_owned(), n)));
}

/// The same with models of `classes`.
pub fn of(dir: &Path, classes: &[(String, usize)]) {
    std::fs::create_dir_all(dir).unwrap();
    let mut numbers = BTreeMap::new();
    for (kind, (class, n)) in classes.iter().enumerate() {
        numbers.extend((0..*n).map(|i| (format!("{class}/{i:02}.step"), (kind, i))));
    }
    let contents = Contents {
        settings: "profile = \"default\"\n",
        methods: &METHODS,
        models: numbers.keys().map(|id| (id.clone(), [0; 32])).collect(),
        failures: vec![failure("boat/broken.step", "no <shell>"), failure("notes.step", "not STEP")],
    };
    publish(dir, contents, &mut |id, _| Ok(record(numbers[id]))).unwrap();
    let label = |id: &str| format!("{id},{},made up\n", id.split('/').next().unwrap());
    let labels: String = numbers.keys().map(String::as_str).chain(["boat/broken.step"]).map(label).collect();
    std::fs::write(dir.join("labels.csv"), format!("path,category,source\n{labels}")).unwrap();
}

/// A model that was lost.
pub fn failure(id: &str, why: &str) -> Failure {
    Failure { id: id.into(), hash: None, error: ModelError::at(Stage::Parse, 42, why) }
}

/// A number from 0 to 1 that looks random.
fn noise(seed: usize) -> f32 {
    let mixed = (seed as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let mixed = (mixed ^ mixed >> 29).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    (mixed >> 40) as f32 / (1u64 << 24) as f32
}

/// The record of model `number` of class `kind`.
pub fn record((kind, number): (usize, usize)) -> ModelRecord {
    let row = |length: usize, method: usize, spread: f32| {
        let value = |k: usize| {
            noise(1000 * kind + k)
                + spread
                    * (1.0 + method as f32 / 2.0)
                    * (noise(7_000_000 + 10_000 * (100 * kind + number) + 500 * method + k) - 0.5)
        };
        (0..length).map(value).collect()
    };
    let pose = |(m, &method): (usize, &Method)| Pose {
        method,
        frame: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
        magnitude: row(MAGNITUDES, m, 2.4),
        phase: row(PHASES, m, 2.0),
    };
    ModelRecord {
        summary: summary(kind, number),
        thumbnail: thumbnail(kind % 9, number),
        poses: METHODS.iter().enumerate().map(pose).collect(),
    }
}

fn summary(kind: usize, number: usize) -> Summary {
    let coverage = [1.0, 0.97, 0.55, 0.0][number % 4];
    Summary {
        schema: "AUTOMOTIVE_DESIGN".into(),
        unit_mm: 1.0,
        solids: 1,
        faces: 6 + kind,
        edges: 12,
        triangles: 12,
        area_mm2: 6.0,
        volume_mm3: 1.0,
        centroid_mm: [0.0; 3],
        bbox_mm: [0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
        skipped: Vec::new(),
        skipped_count: 0,
        warnings: Vec::new(),
        warning_count: 0,
        label: [Label::Exact, Label::NearGlobal, Label::Partial, Label::None][number % 4],
        planes: vec![PlaneEvidence { normal: [1.0, 0.0, 0.0], coverage, ..PlaneEvidence::default() }],
        plane_count: 1,
        axes: Vec::new(),
        source: if number % 4 == 3 { Source::Cpca } else { Source::Symmetry },
        areas_mm2: [1.0; 3],
        axisymmetric: false,
        hull: BTreeMap::new(),
    }
}

fn thumbnail(kind: usize, number: usize) -> Vec<u8> {
    let level = |at: usize| {
        let (x, y) = ((at % THUMBNAIL) as f64 - 47.5, (at / THUMBNAIL) as f64 - 47.5);
        let size = 20.0 + number as f64;
        let power = 1.0 + kind as f64 / 2.0;
        let inside = x.abs().powf(power) + y.abs().powf(power) < size.powf(power);
        if inside { 90 + (y + 48.0) as u8 } else { 12 }
    };
    (0..THUMBNAIL * THUMBNAIL).map(level).collect()
}
