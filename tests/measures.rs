//! Holds the measures of real files against those of OpenCASCADE, where both are at hand.
//!
//! `SYMALIGN_DATA` names the folder with `real-parts` and `cross-cad`, `SYMALIGN_FACTS` the table of facts (default:
//! `../shared/data/facts.csv`). Without them the test says so and passes.

use std::path::{Path, PathBuf};

use symalign::brep::measure::{Measures, measure};
use symalign::brep::tessellate::{Options, tessellate};
use symalign::cancel::Cancel;
use symalign::geometry::{Aabb, Point};
use symalign::stages::parse;

/// What OpenCASCADE says about a file.
struct Facts {
    path: String,
    solids: usize,
    faces: usize,
    area: f64,
    volume: f64,
    bounds: Aabb,
}

fn data() -> Option<(PathBuf, PathBuf)> {
    let data = PathBuf::from(std::env::var_os("SYMALIGN_DATA")?);
    let facts =
        std::env::var_os("SYMALIGN_FACTS").map_or_else(|| PathBuf::from("../shared/data/facts.csv"), PathBuf::from);
    (data.is_dir() && facts.is_file()).then_some((data, facts))
}

fn read_facts(table: &Path) -> Vec<Facts> {
    let mut reader = csv::Reader::from_path(table).expect("the table of facts opens");
    let columns = reader.headers().expect("it has a header").clone();
    let rows = reader.records().map(|row| row.expect("its rows are whole"));
    rows.filter_map(|row| {
        let cell = |name: &str| row.get(columns.iter().position(|c| c == name)?);
        let number = |name: &str| cell(name)?.parse::<f64>().ok();
        let point = |x, y, z| Some(Point::new(number(x)?, number(y)?, number(z)?));
        let bounds = Aabb { min: point("xmin", "ymin", "zmin")?, max: point("xmax", "ymax", "zmax")? };
        Some(Facts {
            path: cell("path")?.to_owned(),
            solids: number("solids")? as usize,
            faces: number("faces")? as usize,
            area: number("area_mm2")?,
            volume: number("volume_mm3")?.abs(),
            bounds,
        })
    })
    .collect()
}

fn measures_of(path: &Path) -> Result<(usize, Measures), String> {
    let bytes = std::fs::read(path).map_err(|e| e.to_string())?;
    let cancel = Cancel::new();
    let parse::Reading { model, .. } =
        parse::read(&bytes, &parse::Options::default(), &cancel).map_err(|e| e.to_string())?;
    let (mesh, ..) = tessellate(&model, &Options::default(), &cancel).map_err(|e| e.to_string())?;
    Ok((mesh.faces.len(), measure(&model, &mesh)))
}

/// Largest distance between sides of the boxes, as a share of the diagonal.
fn box_error(ours: &Aabb, theirs: &Aabb) -> f64 {
    (ours.min - theirs.min).amax().max((ours.max - theirs.max).amax()) / theirs.diagonal()
}

#[derive(Default)]
struct Tally {
    files: usize,
    faces: usize,
    area: usize,
    volume: usize,
    boxes: usize,
}

impl Tally {
    fn add(&mut self, facts: &Facts, faces: usize, ours: &Measures) {
        let near = |a: f64, b: f64| (a - b).abs() <= 0.005 * b.abs();
        self.files += 1;
        self.faces += usize::from(faces == facts.faces);
        self.area += usize::from(near(ours.area, facts.area));
        self.volume += usize::from(facts.solids == 0 || near(ours.volume, facts.volume));
        self.boxes += usize::from(box_error(&ours.bounds, &facts.bounds) <= 0.002);
        if !near(ours.area, facts.area) {
            println!("{}: area {:.6} for {:.6}", facts.path, ours.area, facts.area);
        }
    }

    /// Nearly all of at least `least` files measure the same.
    fn hold(&self, least: usize) {
        let share = |n: usize| n as f64 / self.files as f64;
        let [faces, area, volume, boxes] = [self.faces, self.area, self.volume, self.boxes].map(share);
        println!("{} files: faces equal {faces:.3}, area {area:.3}, volume {volume:.3}, box {boxes:.3}", self.files);
        assert!(self.files >= least);
        assert!(faces >= 0.99 && area >= 0.99 && volume >= 0.98);
        // Boxes of files with free curves beside the faces are larger in OpenCASCADE.
        assert!(boxes >= 0.93);
    }
}

/// Compares all files of a table that have faces.
fn tally(folder: &Path, table: &Path) -> Tally {
    let mut tally = Tally::default();
    for facts in read_facts(table).into_iter().filter(|facts| facts.faces > 0) {
        match measures_of(&folder.join(&facts.path)) {
            Ok((faces, ours)) => tally.add(&facts, faces, &ours),
            Err(why) => panic!("{}: {why}", facts.path),
        }
    }
    tally
}

#[test]
fn real_files_measure_what_opencascade_measures() {
    let Some((folder, table)) = data() else {
        println!("skipped: set SYMALIGN_DATA to the folder with the real parts, and SYMALIGN_FACTS to facts.csv");
        return;
    };
    tally(&folder, &table).hold(400);
}

/// `SYMALIGN_CONVERTED` names a folder with real files written by OpenCASCADE as `.brep` (BRepTools::Write) and as IGES
/// (IGESControl_Writer in both modes), and `facts.csv` with what it says of them when it has read them again.
#[test]
fn other_formats_measure_what_opencascade_measures() {
    let Some(folder) = std::env::var_os("SYMALIGN_CONVERTED").map(PathBuf::from).filter(|folder| folder.is_dir())
    else {
        println!("skipped: set SYMALIGN_CONVERTED to the folder with .brep and IGES files and their facts.csv");
        return;
    };
    tally(&folder, &folder.join("facts.csv")).hold(400);
}
