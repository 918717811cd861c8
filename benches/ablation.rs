//! What each decision of the method is worth: one line a decision, all other settings as they are by default.
//!
//! ```text
//! cargo run --release --example ablation -- data-samples
//! cargo run --release --example ablation -- FOLDER [EVERY]
//! ```
//!
//! The folder holds models, `labels.csv` (`path,category`) and, where the planes are known, `truth.csv` as in
//! data-samples. Every model is described in its own pose and, one in EVERY (default: each), in a random one. Prints a
//! Markdown table:
//!
//! - found: exact planes and axes of the truth that are reported, of how many (0.5 degrees, 0.5 % of the size);
//! - false: reported planes that pass as exact and are none of the truth's, of how many;
//! - first: models whose first plane is one of the truth's, exact or partial, of those that have one; without a truth,
//!   models that have an exact or near-global plane;
//! - turned: degrees between the frames of the two poses, median and 90th percentile;
//! - mAP with magnitudes and with phases.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use symalign::alignment::Method;
use symalign::distance;
use symalign::evaluate::{Entrant, Gallery, Labels, Options, score};
use symalign::geometry::{Axis, Frame, Plane, Point, Vector};
use symalign::pipeline::{Described, describe};
use symalign::settings::Settings;
use symalign::stages::descriptor::Descriptor;
use symalign::stages::merge::{Label, Symmetries};

type Result<T> = std::result::Result<T, Box<dyn Error + Send + Sync>>;

/// A decision turned around: its name, and the settings that do it.
const LINES: [(&str, &str); 26] = [
    ("default", ""),
    ("paper: all of the literal reading", "profile = \"paper\""),
    ("faces as the exporter split them", "[corner_filter]\nmaximal_faces = false"),
    ("no axes of faces of revolution", "[corner_filter]\naxes = false"),
    ("eq. (3) without absolute values", "[pair_match]\nabsolute = false"),
    ("mirror images in any order of corners", "[pair_match]\norientation = false"),
    ("all pairs of faces, no buckets", "[pair_match]\nbuckets = false\nsubset = 256\npairs_per_face = 256"),
    ("Umeyama instead of the mirror fit", "[isometry]\numeyama = true"),
    ("no candidates from corners", "[isometry]\nresidual = 0.0"),
    ("no candidates from faces without corners", "[isometry]\ncornerless = false\naxes = 0"),
    ("no candidates from single faces", "[isometry]\nsingle_faces = false"),
    ("no candidates from principal axes", "[merge]\nprincipal = false"),
    ("candidates judged by eq. (6) alone", "[validate]\ncorrelation = 0.9"),
    ("partial planes need no whole faces", "[merge]\nconfirmed = 0.0"),
    ("eq. (7) and the largest bounding box", "[merge]\npaper = true"),
    ("no ties: the larger support, however little", "[merge]\ntie = 0.0"),
    ("ties up to 0.02 of support", "[merge]\ntie = 0.02"),
    ("90 planes", "[projection_sweep]\nplanes = 90"),
    ("pixels instead of spans", "[projection_sweep]\narea_by = \"pixels\""),
    ("no refinement between the steps", "[projection_sweep]\nrefine = false"),
    ("sweep from an arbitrary start", "[projection_sweep]\nstart_on_model = false"),
    ("second axis by in-plane PCA", "[projection_sweep]\nsecond_axis = \"pca\""),
    ("second axis: of the sweep's two what more surface faces", "[projection_sweep]\nsecond_axis = \"normals\""),
    ("128 pixels a silhouette", "[descriptor]\nside = 128"),
    ("broken silhouettes: largest part only", "[descriptor]\nenclosed = 0.0"),
    ("gaps are not closed", "[descriptor]\ngap = 0.0"),
];
/// Degrees and share of the size within which a plane is a known one.
const NEAR: (f64, f64) = (0.5, 0.005);
/// Coverage from which a reported plane passes as exact.
const EXACT: f64 = 0.995;

fn main() -> Result<()> {
    let mut arguments = std::env::args_os().skip(1);
    let folder = PathBuf::from(arguments.next().ok_or("FOLDER [EVERY]")?);
    let every = arguments.next().map_or(Ok(1), |a| a.to_string_lossy().parse::<usize>())?.max(1);
    let archive = Archive::load(&folder)?;
    println!(
        "| decision | found | false | first | turned, degrees | mAP | mAP, phases |\n|---|---|---|---|---|---|---|"
    );
    for (number, (name, keys)) in LINES.iter().enumerate() {
        let outcome = archive.run(keys, every)?;
        println!("| {name} | {} |", outcome.row(&archive, distance::magnitude)?);
        if number == 0 {
            println!(
                "| second and third plane may be swapped | {} |",
                outcome.row(&archive, distance::magnitude_swapped)?
            );
        }
    }
    Ok(())
}

/// The models with what is known of them.
struct Archive {
    folder: PathBuf,
    ids: Vec<String>,
    labels: Labels,
    truth: BTreeMap<String, Vec<Truth>>,
}

/// A row of truth.csv.
struct Truth {
    exact: bool,
    plane: Option<Plane>,
    axis: Option<Axis>,
    size: f64,
}

impl Archive {
    fn load(folder: &Path) -> Result<Self> {
        let mut labels = csv::Reader::from_path(folder.join("labels.csv"))?;
        let ids = labels.records().map(|row| Ok(row?[0].to_owned())).collect::<Result<_>>()?;
        let known = folder.join("truth.csv");
        let truth = if known.exists() { truths(&known)? } else { BTreeMap::new() };
        Ok(Self { folder: folder.to_owned(), ids, labels: Labels::load(&folder.join("labels.csv"))?, truth })
    }

    /// Describes every model under the given settings.
    fn run(&self, keys: &str, every: usize) -> Result<Outcome> {
        let own = Settings { methods: vec![Method::Symmetry], ..Settings::parse(keys, None)? };
        let moved = Settings { random_pose: Some(1), ..own.clone() };
        let described = self.ids.par_iter().enumerate().map(|(number, id)| {
            let bytes = std::fs::read(self.folder.join(id))?;
            let again = (number % every == 0).then(|| describe(id, bytes.clone(), &moved).0.ok()).flatten();
            let Ok(found) = describe(id, bytes, &own).0 else { return Ok(None) };
            Ok(Some(Found::new(id, self.truth.get(id), found, again)))
        });
        let found: Vec<Option<Found>> = described.collect::<Result<_>>()?;
        Ok(Outcome { found: found.into_iter().flatten().collect() })
    }
}

fn truths(path: &Path) -> Result<BTreeMap<String, Vec<Truth>>> {
    let mut reader = csv::Reader::from_path(path)?;
    let head = reader.headers()?.clone();
    let mut all: BTreeMap<String, Vec<Truth>> = BTreeMap::new();
    for row in reader.records() {
        let row = row?;
        let number = |name: &str| row[head.iter().position(|h| h == name)?].parse::<f64>().ok();
        let vector = |[x, y, z]: [&str; 3]| Some(Vector::new(number(x)?, number(y)?, number(z)?));
        let plane = vector(["nx", "ny", "nz"]).zip(number("offset_mm"));
        let axis = vector(["axis_px", "axis_py", "axis_pz"]).zip(vector(["axis_dx", "axis_dy", "axis_dz"]));
        all.entry(row[0].to_owned()).or_default().push(Truth {
            exact: &row[1] != "partial",
            plane: plane.map(|(normal, offset)| Plane { normal, offset }),
            axis: axis.map(|(point, direction)| Axis { point: Point::from(point), direction }),
            size: number("size_mm").unwrap_or(1.0),
        });
    }
    Ok(all)
}

/// What came out for one model.
struct Found {
    id: String,
    descriptor: Descriptor,
    /// Known exact planes and axes: reported, in all.
    exact: [usize; 2],
    /// Planes that pass as exact: not known, in all.
    wrong: [usize; 2],
    /// Whether the first plane is right, where there is one to find.
    first: Option<bool>,
    /// Degrees between the frames in two poses.
    turned: Option<f64>,
}

impl Found {
    fn new(id: &str, truth: Option<&Vec<Truth>>, own: Described, moved: Option<Described>) -> Self {
        let turned = moved.as_ref().map(|moved| {
            let frame = own.framed.canonical.frame;
            let rotation = moved.framed.ranked.posed.pose.rotation;
            let turned = Frame { axes: frame.axes.map(|axis| rotation * axis), ..frame };
            turned.angle_to(&moved.framed.canonical.frame).to_degrees()
        });
        let symmetries = &own.framed.ranked.symmetries;
        let (mut exact, mut wrong) = ([0, 0], [0, 0]);
        let first = match truth {
            None => Some(matches!(symmetries.label, Label::Exact | Label::NearGlobal)),
            Some(truth) => {
                let centre = own.framed.ranked.posed.parsed.measures.centroid;
                let wanted: Vec<_> =
                    truth.iter().filter(|t| t.exact && (t.plane.is_some() || t.axis.is_some())).collect();
                exact = [wanted.iter().filter(|t| t.reported(symmetries, &centre)).count(), wanted.len()];
                let pass: Vec<_> = symmetries.planes.iter().filter(|p| p.coverage >= EXACT).collect();
                let known = |plane: &Plane| truth.iter().any(|t| t.allows(plane, &centre));
                wrong = [pass.iter().filter(|p| !known(&p.plane)).count(), pass.len()];
                let to_find = truth.iter().any(|t| t.plane.is_some() || t.axis.is_some());
                to_find.then(|| symmetries.planes.first().is_some_and(|p| known(&p.plane)))
            }
        };
        let descriptor = own.descriptors[0].clone();
        Self { id: id.to_owned(), descriptor, exact, wrong, first, turned }
    }
}

impl Truth {
    /// Whether the plane is this one, or contains this axis.
    fn allows(&self, plane: &Plane, centre: &Point) -> bool {
        let is_plane = self.plane.is_some_and(|own| {
            let sign = own.normal.dot(&plane.normal).signum();
            let apart = (own.signed_distance(centre) - sign * plane.signed_distance(centre)).abs();
            own.angle_to(plane).to_degrees() <= NEAR.0 && apart <= NEAR.1 * self.size
        });
        let holds_axis = self.axis.is_some_and(|axis| {
            let sine = axis.direction.normalize().dot(&plane.normal).abs();
            sine.asin().to_degrees() <= NEAR.0 && plane.signed_distance(&axis.point).abs() <= NEAR.1 * self.size
        });
        is_plane || holds_axis
    }

    /// Whether this plane or axis is among what was found.
    fn reported(&self, found: &Symmetries, centre: &Point) -> bool {
        match self.axis {
            Some(axis) => found.axes.iter().any(|other| {
                let (sine, distance) = axis.difference(other);
                sine.asin().to_degrees() <= NEAR.0 && distance <= NEAR.1 * self.size
            }),
            None => found.planes.iter().any(|p| self.allows(&p.plane, centre)),
        }
    }
}

/// What came out for all models.
struct Outcome {
    found: Vec<Found>,
}

impl Outcome {
    /// The cells of a line after its name.
    fn row(&self, archive: &Archive, magnitude: fn(&[f32], &[f32]) -> f64) -> Result<String> {
        let sum = |of: fn(&Found) -> [usize; 2]| {
            self.found.iter().map(of).fold([0, 0], |sum, x| [sum[0] + x[0], sum[1] + x[1]])
        };
        let of = |[part, all]: [usize; 2]| if all > 0 { format!("{part} / {all}") } else { "-".to_owned() };
        let right = sum(|f| [usize::from(f.first == Some(true)), usize::from(f.first.is_some())]);
        let mut turned: Vec<_> = self.found.iter().filter_map(|f| f.turned).collect();
        turned.sort_by(f64::total_cmp);
        let at = |share: f64| turned.get((share * turned.len() as f64) as usize).copied().unwrap_or(f64::NAN);
        let [by_magnitude, by_phase] = self.average_precisions(archive, magnitude)?;
        let (exact, wrong) = (of(sum(|f| f.exact)), of(sum(|f| f.wrong)));
        let turned = format!("{:.4}, {:.4}", at(0.5), at(0.9));
        Ok(format!("{exact} | {wrong} | {} | {turned} | {by_magnitude:.3} | {by_phase:.3}", of(right)))
    }

    fn average_precisions(&self, archive: &Archive, magnitude: fn(&[f32], &[f32]) -> f64) -> Result<[f64; 2]> {
        let ids: Vec<_> = self.found.iter().map(|f| f.id.as_str()).collect();
        let gallery = Gallery::new(&ids, &archive.labels.assign(&ids, &[]), false);
        let rows = gallery.rows.clone();
        let of = |i: usize| &self.found[rows[i]].descriptor;
        let by_magnitude = |i: usize, j: usize| magnitude(of(i).magnitudes(), of(j).magnitudes());
        let by_phase = |i: usize, j: usize| distance::phase(of(i).phases(), of(j).phases());
        let entrants = [
            Entrant::of_pairs("magnitude", rows.len(), by_magnitude),
            Entrant::of_pairs("phase", rows.len(), by_phase),
        ];
        let options = Options { draws: 1, resamples: 1, ..Options::default() };
        let methods = score(gallery, &entrants, &options, None)?.methods;
        Ok([methods[0].summary.micro.ap, methods[1].summary.micro.ap])
    }
}
