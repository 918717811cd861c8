//! The exact spans of stage 7 against the count of pixels, on real models.

use std::path::Path;

use symalign::cancel::Cancel;
use symalign::stages::projection_sweep::{AreaBy, CanonicalFrame, Options, projection_sweep};
use symalign::stages::{corner_filter, isometry, merge, pair_match, parse, validate};

const MODELS: [&str; 6] = [
    "airplane/biplane",
    "animal/elephant",
    "boat/catamaran",
    "household/chair",
    "machinery/spur-gear",
    "vehicle/digger",
];
/// Pixels on a side of the reference.
const SIDE: u32 = 1024;
/// Largest difference of two areas, as a share of the largest area: a pixel along every outline of a slender model.
const AREA: f64 = 0.004;

/// The frame by spans, and by counting pixels at the same angles.
fn both(name: &str) -> [CanonicalFrame; 2] {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data-samples").join(name).with_extension("step");
    let bytes = std::fs::read(path).unwrap();
    let cancel = Cancel::new();
    let parsed = parse::parse(&bytes, &Default::default(), None, &cancel).unwrap();
    let outlines = corner_filter::corner_filter(&parsed, &Default::default(), &cancel).unwrap();
    let matches = pair_match::pair_match(&parsed, &outlines, &Default::default(), &cancel).unwrap();
    let candidates = isometry::isometry(&parsed, &outlines, &matches, &Default::default(), &cancel).unwrap();
    let validated =
        validate::validate(&parsed, &outlines, &matches, &candidates, &Default::default(), &cancel).unwrap();
    let found = merge::merge(&parsed, &outlines, &matches, &validated, &Default::default(), &cancel).unwrap();
    let pixels = Options { area_by: AreaBy::Pixels, pixels: SIDE, refine: false, ..Options::default() };
    [Options::default(), pixels].map(|options| projection_sweep(&parsed, &found, &options, &cancel).unwrap())
}

#[test]
fn spans_and_pixels_agree_on_areas_and_on_the_smallest() {
    for name in MODELS {
        let [spans, pixels] = both(name).map(|frame| frame.sweep);
        assert_eq!(spans.angles, pixels.angles);
        let most = pixels.areas.iter().copied().fold(0.0, f64::max);
        let differences = spans.areas.iter().zip(&pixels.areas).map(|(a, b)| (a - b).abs() / most);
        let worst = differences.fold(0.0, f64::max);
        let turned = (spans.chosen - pixels.chosen).to_degrees().rem_euclid(180.0);
        let turned = turned.min(180.0 - turned);
        // Where another angle is chosen, the areas there are the same to within the pixels.
        let nearest = (pixels.chosen.to_degrees().round() as usize) % spans.areas.len();
        let least = spans.areas.iter().copied().fold(f64::INFINITY, f64::min);
        println!("{name}: areas within {worst:.5}, angles {turned:.2} degrees apart");
        assert!(worst <= AREA, "{name}: {worst}");
        assert!(turned <= 1.0 || spans.areas[nearest] <= least + AREA * most, "{name}: {turned} degrees");
    }
}
