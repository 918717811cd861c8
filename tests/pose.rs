//! Every frame and descriptor goes with the model: moved and scaled copies of real models get the moved frames, up to
//! the models' own symmetries, and find their originals first.

use std::path::Path;

use symalign::alignment::Method;
use symalign::distance;
use symalign::geometry::Frame;
use symalign::pipeline::{Described, describe};
use symalign::settings::Settings;

/// One solid and assemblies, B-splines, partial symmetry and none, several planes, a body of revolution.
const MODELS: [&str; 10] = [
    "airplane/glider",
    "animal/snake",
    "boat/canoe",
    "household/mug-with-mark",
    "household/stool",
    "household/wine-glass",
    "instrument/grand-piano",
    "machinery/bracket",
    "machinery/hexagon-bolt",
    "machinery/ship-propeller",
];
/// Degrees a frame may be off.
const ANGLE: f64 = 0.05;
/// The same for prst, whose planes are maxima of a smooth measure that are approached in steps.
const SMOOTH_ANGLE: f64 = 0.25;
/// Two planes of this model are so nearly as symmetric that prst takes the one or the other.
const UNDECIDED: (Method, &str) = (Method::Prst, "airplane/glider");
/// Share of the distance to the nearest other model that a copy may be away.
const AWAY: f64 = 0.01;
/// Models of which some methods leave the frame open: turned about an axis they look alike to a covariance.
const OPEN: [&str; 5] = [
    "household/mug-with-mark",
    "household/stool",
    "household/wine-glass",
    "machinery/hexagon-bolt",
    "machinery/ship-propeller",
];

fn settings(random_pose: Option<u64>) -> Settings {
    Settings { methods: Method::ALL.to_vec(), random_pose, ..Settings::default() }
}

/// The model in its own pose, then moved with another unit of length (a thousandfold in mm), then moved again.
fn poses(name: &str) -> [Described; 3] {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data-samples").join(name).with_extension("step");
    let bytes = std::fs::read(path).unwrap();
    let text = String::from_utf8(bytes.clone()).unwrap();
    let large = text.replace("(.MILLI.,.METRE.)", "($,.METRE.)").into_bytes();
    let of = |bytes, pose| describe(name, bytes, &settings(pose)).0.unwrap();
    [of(bytes.clone(), None), of(large, Some(1)), of(bytes, Some(2))]
}

fn frame(described: &Described, method: usize) -> Frame {
    described.framed.frames[method].1
}

/// Degrees between the frame of the moved copy and the moved frame.
fn turned_by(original: &Described, copy: &Described, method: usize) -> f64 {
    let rotation = copy.framed.ranked.posed.pose.rotation;
    let own = frame(original, method);
    let moved = Frame { axes: own.axes.map(|axis| rotation * axis), ..own };
    moved.angle_to(&frame(copy, method)).to_degrees()
}

fn apart(a: &Described, b: &Described, method: usize) -> [f64; 2] {
    let (a, b) = (&a.descriptors[method], &b.descriptors[method]);
    [distance::magnitude(a.magnitudes(), b.magnitudes()), distance::phase(a.phases(), b.phases())]
}

#[test]
fn frames_and_descriptors_go_with_the_model() {
    let mut wrong = Vec::new();
    let all: Vec<_> = MODELS.iter().map(|name| (name, poses(name))).collect();
    for (number, method) in Method::ALL.into_iter().enumerate() {
        for (name, [original, copies @ ..]) in &all {
            let others = all.iter().filter(|(other, _)| other != name).map(|(_, [other, ..])| other);
            let nearest = others
                .map(|other| apart(original, other, number))
                .fold([f64::INFINITY; 2], |least, d| [least[0].min(d[0]), least[1].min(d[1])]);
            for copy in copies {
                let (angle, away) = (turned_by(original, copy, number), apart(original, copy, number));
                let told = format!("{} of {name}: {angle:.4} degrees, {away:.5?} of {nearest:.5?}", method.name());
                println!("{told}");
                let found = away[0] < nearest[0] && away[1] < nearest[1];
                // Where a symmetry of the model makes several frames equal, they describe it equally.
                let within = if method == Method::Prst { SMOOTH_ANGLE } else { ANGLE };
                let same = angle <= within || (away[0] <= AWAY * nearest[0] && away[1] <= AWAY * nearest[1]);
                let open = method != Method::Symmetry && OPEN.contains(name) || (method, **name) == UNDECIDED;
                if !(open || found && same) {
                    wrong.push(told);
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
