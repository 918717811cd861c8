//! Known planes: rows of a table of truth, and what is found of them.
#![allow(dead_code)] // each program uses its part

use std::collections::BTreeMap;
use std::path::Path;

use symalign::cancel::Cancel;
use symalign::geometry::{Axis, Isometry, Plane, Point, Vector};
use symalign::stages::merge::Symmetries;
use symalign::stages::{corner_filter, isometry, merge, pair_match, parse, validate};

/// A plane is found, and known, within so many degrees and this share of the size.
pub const LIMITS: (f64, f64) = (0.5, 0.005);

/// A row of truth.csv.
#[derive(Debug)]
pub struct Truth {
    pub label: String,
    pub plane: Option<Plane>,
    pub axis: Option<Axis>,
    /// A point of the axis; of a sphere, whose planes all go through it, the centre.
    pub centre: Option<Point>,
    pub size: f64,
    pub coverage: f64,
}

/// The rows of a table by the path of the model.
pub fn truths(table: &Path) -> BTreeMap<String, Vec<Truth>> {
    let mut reader = csv::Reader::from_path(table).unwrap();
    let head = reader.headers().unwrap().clone();
    let mut all: BTreeMap<String, Vec<Truth>> = BTreeMap::new();
    for row in reader.records().map(Result::unwrap) {
        let number = |name: &str| {
            let at = head.iter().position(|h| h == name).unwrap();
            row[at].parse::<f64>().ok()
        };
        let vector = |names: [&str; 3]| {
            let [x, y, z] = names.map(number);
            Some(Vector::new(x?, y?, z?))
        };
        let axis_point = vector(["axis_px", "axis_py", "axis_pz"]).map(Point::from);
        let direction = vector(["axis_dx", "axis_dy", "axis_dz"]);
        let normal = vector(["nx", "ny", "nz"]);
        all.entry(row[0].to_owned()).or_default().push(Truth {
            label: row[1].to_owned(),
            plane: normal.and_then(|normal| Some(Plane { normal, offset: number("offset_mm")? })),
            axis: axis_point.zip(direction).map(|(point, direction)| Axis { point, direction }),
            centre: axis_point,
            size: number("size_mm").unwrap_or(1.0),
            coverage: number("coverage").unwrap_or(0.0),
        });
    }
    all
}

/// The settings of the stages up to the symmetries.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    pub pair_match: pair_match::Options,
    pub validate: validate::Options,
    pub merge: merge::Options,
}

/// The model, moved where a pose is given, and its symmetries.
pub fn symmetries(bytes: &[u8], pose: Option<&Isometry>) -> (parse::Parsed, Symmetries) {
    let parsed = parse::parse(bytes, &Default::default(), pose, &Cancel::new()).unwrap();
    let found = symmetries_of(&parsed, &Settings::default());
    (parsed, found)
}

/// The symmetries under other settings.
pub fn symmetries_of(parsed: &parse::Parsed, settings: &Settings) -> Symmetries {
    let cancel = Cancel::new();
    let outlines = corner_filter::corner_filter(parsed, &Default::default(), &cancel).unwrap();
    let matches = pair_match::pair_match(parsed, &outlines, &settings.pair_match, &cancel).unwrap();
    let candidates = isometry::isometry(parsed, &outlines, &matches, &Default::default(), &cancel).unwrap();
    let validated = validate::validate(parsed, &outlines, &matches, &candidates, &settings.validate, &cancel).unwrap();
    merge::merge(parsed, &outlines, &matches, &validated, &settings.merge, &cancel).unwrap()
}

/// Degrees and share of the size between two planes, measured at `centre`.
pub fn error(a: &Plane, b: &Plane, centre: &Point, size: f64) -> (f64, f64) {
    let sign = a.normal.dot(&b.normal).signum();
    let apart = (a.signed_distance(centre) - sign * b.signed_distance(centre)).abs();
    (a.angle_to(b).to_degrees(), apart / size)
}

impl Truth {
    pub fn knows(&self, plane: &Plane, centre: &Point) -> bool {
        match (&self.plane, &self.axis) {
            (Some(known), _) => {
                let (angle, offset) = error(plane, known, centre, self.size);
                angle <= LIMITS.0 && offset <= LIMITS.1
            }
            (None, Some(axis)) => {
                let contains = plane.signed_distance(&axis.point).abs() <= LIMITS.1 * self.size;
                contains && plane.normal.dot(&axis.direction).abs().asin().to_degrees() <= LIMITS.0
            }
            (None, None) => {
                let centre = self.centre.filter(|_| self.label == "sphere");
                centre.is_some_and(|c| plane.signed_distance(&c).abs() <= LIMITS.1 * self.size)
            }
        }
    }
}

pub fn is_near(a: &Axis, b: &Axis, size: f64) -> bool {
    let (sine, distance) = a.difference(b);
    sine.asin().to_degrees() <= LIMITS.0 && distance <= LIMITS.1 * size
}

pub fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
