//! Published files and journals: bytes that depend on contents only, and damage that is found.

use std::path::Path;

use symalign::alignment::Method;
use symalign::geometry::{Frame, Point, Vector};
use symalign::stages::descriptor::{MAGNITUDES, PHASES};
use symalign::stages::merge::Label;
use symalign::stages::projection_sweep::Source;
use symalign::stages::{ModelError, Stage};
use symalign::store::{
    Contents, Failure, Hash, ModelRecord, PlaneEvidence, Pose, Store, Summary, THUMBNAIL, merge, publish,
    published_path,
};

const METHODS: [Method; 2] = [Method::Symmetry, Method::Cpca];

fn summary(faces: usize) -> Summary {
    Summary {
        schema: "AP214".into(),
        unit_mm: 25.4,
        solids: 1,
        faces,
        edges: 12,
        triangles: 12,
        area_mm2: 6.0,
        volume_mm3: 1.0,
        centroid_mm: [0.5; 3],
        bbox_mm: [0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
        skipped: vec![(17, "no such surface".into())],
        skipped_count: 1,
        warnings: Vec::new(),
        warning_count: 0,
        label: Label::NearGlobal,
        planes: vec![PlaneEvidence { pairs: vec![("1".into(), "2".into())], ..PlaneEvidence::default() }],
        plane_count: 1,
        axes: Vec::new(),
        source: Source::Symmetry,
        areas_mm2: [1.0, 2.0, 3.0],
        axisymmetric: false,
        hull: [(Method::Symmetry, [true, false, false])].into(),
    }
}

/// A record whose numbers tell its seed.
fn record(seed: u8) -> ModelRecord {
    let pose = |method: Method| Pose {
        method,
        frame: std::array::from_fn(|k| f64::from(seed) + k as f64),
        magnitude: (0..MAGNITUDES).map(|k| f32::from(seed) * 1000.0 + k as f32).collect(),
        phase: (0..PHASES).map(|k| f32::from(seed) * 1000.0 - k as f32).collect(),
    };
    ModelRecord {
        summary: summary(seed.into()),
        thumbnail: vec![seed; THUMBNAIL * THUMBNAIL],
        poses: METHODS.map(pose).to_vec(),
    }
}

fn failure(id: &str) -> Failure {
    Failure { id: id.into(), hash: Some([9; 32]), error: ModelError::at(Stage::Validate, 5, "no reason") }
}

/// Publishes models (id, seed) and failures in `dir`.
fn published(dir: &Path, models: &[(&str, u8)], failures: &[&str]) {
    std::fs::create_dir_all(dir).unwrap();
    let contents = Contents {
        settings: "a = 1\n",
        methods: &METHODS,
        models: models.iter().map(|(id, seed)| ((*id).to_owned(), [*seed; 32])).collect(),
        failures: failures.iter().map(|id| failure(id)).collect(),
    };
    publish(dir, contents, &mut |_, hash: &Hash| Ok(record(hash[0]))).unwrap();
}

fn bytes(dir: &Path) -> Vec<u8> {
    std::fs::read(published_path(dir)).unwrap()
}

#[test]
fn what_was_published_is_read_back() {
    let dir = tempfile::tempdir().unwrap();
    published(dir.path(), &[("b", 2), ("a", 1), ("ä/c", 3)], &["z", "y"]);
    let store = Store::open(dir.path()).unwrap();
    assert_eq!((0..store.len()).map(|i| store.id(i)).collect::<Vec<_>>(), ["a", "b", "ä/c"]);
    assert_eq!(store.methods(), METHODS);
    assert_eq!((store.find("b"), store.find("c")), (Some(1), None));
    assert_eq!(store.failures(), [failure("y"), failure("z")]);
    assert_eq!((store.settings(), store.hash(2)), ("a = 1\n", [3; 32]));
    for (i, seed) in [1u8, 2, 3].into_iter().enumerate() {
        assert_eq!(store.record(i).unwrap(), record(seed));
        assert_eq!(store.magnitudes(Method::Cpca).unwrap()[i * MAGNITUDES + 7], f32::from(seed) * 1000.0 + 7.0);
        assert_eq!(store.phases(Method::Symmetry).unwrap()[i * PHASES + 7], f32::from(seed) * 1000.0 - 7.0);
        assert_eq!(store.thumbnail(i).unwrap(), vec![seed; THUMBNAIL * THUMBNAIL]);
    }
    let axes = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]].map(Vector::from);
    assert_eq!(store.frame(Method::Symmetry, 0).unwrap(), (Frame { axes, origin: Point::new(10.0, 11.0, 12.0) }));
    let error = store.magnitudes(Method::Pca).unwrap_err().to_string();
    assert_eq!(error, "the store has no frame `pca`, only symmetry, cpca");
    assert!(store.frame(Method::Symmetry, 3).is_err());
    assert!(store.verify().is_empty());
}

#[test]
fn an_empty_store_can_be_published() {
    let dir = tempfile::tempdir().unwrap();
    published(dir.path(), &[], &[]);
    let store = Store::open(dir.path()).unwrap();
    assert_eq!((store.len(), store.magnitudes(Method::Cpca).unwrap()), (0, &[][..]));
    assert!(store.verify().is_empty());
}

#[test]
fn sections_lie_where_the_format_page_says() {
    let dir = tempfile::tempdir().unwrap();
    published(dir.path(), &[("a", 1), ("b", 2)], &[]);
    let file = bytes(dir.path());
    let u32_at = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap());
    let u64_at = |at: usize| u64::from_le_bytes(file[at..at + 8].try_into().unwrap()) as usize;
    assert_eq!(&file[..8], b"SYMALIGN");
    let sections = u32_at(12) as usize;
    assert_eq!((u32_at(8), sections, u64_at(16), u64_at(24)), (2, 18, 2, file.len()));
    assert_eq!(u32_at(32), crc32fast::hash(&file[64..64 + 40 * sections]));
    assert_eq!(u32_at(60), crc32fast::hash(&file[..60]));
    let entries: Vec<_> = (0..sections).map(|i| 64 + 40 * i).collect();
    let kinds: Vec<_> = entries.iter().map(|e| (u32_at(*e), u32_at(e + 4))).collect();
    let none = u32::MAX;
    let per_method = [(6, 0), (6, 2), (7, 0), (7, 2), (8, 0), (8, 2)];
    let first = [(1, none), (2, none), (3, none), (4, none), (5, none)];
    let again = [(1, none), (2, none), (3, none), (4, none), (9, none)];
    assert_eq!(kinds, [&first[..], &per_method, &[(9, none), (10, none)], &again].concat());
    let tail = file.len() - 64 - 40 * sections;
    assert!(file[tail..] == [&file[64..64 + 40 * sections], &file[..64]].concat());
    for entry in entries {
        let (offset, length) = (u64_at(entry + 8), u64_at(entry + 16));
        assert_eq!((offset % 64, u32_at(entry + 24)), (0, crc32fast::hash(&file[offset..offset + length])));
    }
    // The magnitudes of cpca are the seventh section: row 1, column 3.
    let cell = u64_at(64 + 40 * 6 + 8) + 4 * (MAGNITUDES + 3);
    assert_eq!(f32::from_le_bytes(file[cell..cell + 4].try_into().unwrap()), 2003.0);
}

#[test]
fn the_order_of_the_models_does_not_change_the_bytes() {
    let dir = tempfile::tempdir().unwrap();
    let (one, two) = (dir.path().join("1"), dir.path().join("2"));
    published(&one, &[("a", 1), ("b", 2), ("c", 3)], &["x", "y"]);
    published(&two, &[("c", 3), ("a", 1), ("b", 2)], &["y", "x"]);
    assert!(bytes(&one) == bytes(&two));
}

#[test]
fn merged_shards_are_the_store_of_one_machine() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    published(&at("all"), &[("a", 1), ("b", 2), ("c", 3)], &["x", "y"]);
    published(&at("1"), &[("b", 2)], &["y"]);
    published(&at("2"), &[("c", 3), ("a", 1)], &["x"]);
    for (into, order) in [("12", ["1", "2"]), ("21", ["2", "1"])] {
        merge::merge(&order.map(at), &at(into)).unwrap();
        assert!(bytes(&at(into)) == bytes(&at("all")));
    }
    assert!(merge::merge(&[at("1")], &at("12")).is_err(), "a store that is there is not overwritten");
    published(&at("other"), &[("b", 5)], &[]);
    let error = merge::merge(&[at("1"), at("other")], &at("no")).unwrap_err().to_string();
    assert!(error.contains("b has other bytes"), "{error}");
}
