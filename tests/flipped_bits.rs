//! Every single bit of a small published file, flipped: `verify` finds it, what is read is what was written or an
//! error, and all sections but the one that was hit can be read.

mod synthetic;

use std::ops::Range;
use std::path::Path;

use symalign::alignment::Method;
use symalign::geometry::Frame;
use symalign::store::{Contents, Failure, Kind, Store, Summary, publish, published_path};

/// All that can be read of a store of one model; an item that gave an error is `None`.
#[derive(Clone, Debug, PartialEq)]
struct Readings {
    id: String,
    hash: [u8; 32],
    settings: String,
    failures: Vec<Failure>,
    magnitudes: Option<Vec<f32>>,
    phases: Option<Vec<f32>>,
    frame: Option<Frame>,
    thumbnail: Option<Vec<u8>>,
    summary: Option<Summary>,
}

impl Readings {
    fn of(store: &Store) -> Self {
        Self {
            id: store.id(0).to_owned(),
            hash: store.hash(0),
            settings: store.settings().to_owned(),
            failures: store.failures().to_vec(),
            magnitudes: store.magnitudes(Method::Symmetry).ok().map(<[_]>::to_vec),
            phases: store.phases(Method::Symmetry).ok().map(<[_]>::to_vec),
            frame: store.frame(Method::Symmetry, 0).ok(),
            thumbnail: store.thumbnail(0).ok().map(<[_]>::to_vec),
            summary: store.summary(0).ok(),
        }
    }

    /// What must be read where a bit of a section of this kind, of which there is one copy, is flipped.
    fn without(&self, kind: Kind) -> Self {
        let mut left = self.clone();
        match kind {
            Kind::Magnitudes => left.magnitudes = None,
            Kind::Phases => left.phases = None,
            Kind::Frames => left.frame = None,
            Kind::Thumbnails => left.thumbnail = None,
            Kind::Summaries => left.summary = None,
            other => panic!("{other:?} is there twice"),
        }
        left
    }
}

/// Puts `bytes` in the place of the published file as publishing does: an open store keeps its map.
fn replace(path: &Path, bytes: &[u8]) {
    std::fs::write(path.with_extension("draft"), bytes).unwrap();
    std::fs::rename(path.with_extension("draft"), path).unwrap();
}

fn publish_one(dir: &Path) {
    let contents = Contents {
        settings: "profile = \"default\"\n",
        methods: &[Method::Symmetry],
        models: vec![("boat/01.step".to_owned(), [5; 32])],
        failures: vec![synthetic::failure("notes.step", "not STEP")],
    };
    let mut record = synthetic::record((2, 1));
    record.poses.retain(|pose| pose.method == Method::Symmetry);
    publish(dir, contents, &mut |_, _| Ok(record.clone())).unwrap();
}

#[test]
fn no_flipped_bit_gives_a_wrong_number_or_costs_more_than_its_section() {
    // A hundred thousand files replaced: in memory, where there is such a folder.
    let dir = tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).unwrap();
    publish_one(dir.path());
    let path = published_path(dir.path());
    let whole = std::fs::read(&path).unwrap();
    let store = Store::open(dir.path()).unwrap();
    let readings = Readings::of(&store);
    let range = |s: &symalign::store::Section| s.offset as usize..(s.offset + s.length) as usize;
    let places: Vec<(Range<usize>, Kind)> = store.sections().iter().map(|s| (range(s), s.kind)).collect();
    let single = |kind| places.iter().filter(|(_, k)| *k == kind).count() == 1;
    for bit in 0..whole.len() * 8 {
        let mut bytes = whole.clone();
        bytes[bit / 8] ^= 1 << (bit % 8);
        replace(&path, &bytes);
        let damaged = Store::open(dir.path()).unwrap_or_else(|e| panic!("bit {bit}: {e}"));
        let found = damaged.verify();
        let located = found.iter().any(|d| (d.offset..d.offset + d.length).contains(&(bit as u64 / 8)));
        assert!(found.len() == 1 && located, "bit {bit}: {found:?}");
        let hit = places.iter().find(|(range, _)| range.contains(&(bit / 8))).map(|(_, kind)| *kind);
        let expected = hit.filter(|kind| single(*kind)).map_or_else(|| readings.clone(), |kind| readings.without(kind));
        assert_eq!(Readings::of(&damaged), expected, "bit {bit} of {hit:?}");
    }
}
