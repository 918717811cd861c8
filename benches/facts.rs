//! What symalign says of files, in the columns of `benches/reading.py`, which holds them against OpenCASCADE.
//!
//! `cargo run --release --example facts -- FILE...` prints one line of CSV a file: lengths in mm, seconds of one
//! thread for reading and tessellating at 0.2 % of the diagonal and 0.35 rad. `-` in the place of the files reads
//! their names from standard input.

use std::error::Error;
use std::time::Instant;

use symalign::alignment::{cpca, npca, pca};
use symalign::brep::measure::{Measures, measure};
use symalign::brep::{Mesh, Model, tessellate};
use symalign::cancel::Cancel;
use symalign::geometry::Aabb;
use symalign::stages::parse::{Options, read};

const COLUMNS: &str = "path bytes ok solids faces edges area_mm2 volume_mm3 xmin ymin zmin xmax ymax zmax cx cy cz \
                       scan_s read_s mesh_s frames_s why";

fn main() -> Result<(), Box<dyn Error>> {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    let mut names: Vec<String> = std::env::args().skip(1).collect();
    if names == ["-"] {
        names = std::io::stdin().lines().collect::<Result<_, _>>()?;
    }
    let mut table = csv::Writer::from_writer(std::io::stdout());
    table.write_record(COLUMNS.split_whitespace())?;
    for name in names {
        let bytes = std::fs::read(&name)?;
        let start = vec![name, bytes.len().to_string()];
        let rest = facts(&bytes).unwrap_or_else(|why| {
            let mut none = vec![String::new(); COLUMNS.split_whitespace().count() - 4];
            none.insert(0, "0".into());
            none.push(why);
            none
        });
        table.write_record(start.into_iter().chain(rest))?;
        table.flush()?;
    }
    Ok(())
}

fn facts(bytes: &[u8]) -> Result<Vec<String>, String> {
    let scan_s = scan_seconds(bytes);
    let (cancel, started) = (Cancel::new(), Instant::now());
    let reading = read(bytes, &Options::default(), &cancel).map_err(|e| e.to_string())?;
    let read_s = started.elapsed().as_secs_f64();
    let started = Instant::now();
    let fineness = tessellate::Options { deflection: 0.002, angle: 0.35, ..Default::default() };
    let (mesh, skipped, _) =
        tessellate::tessellate(&reading.model, &fineness, &cancel).map_err(|_| "cancelled".to_owned())?;
    let mesh_s = started.elapsed().as_secs_f64();
    let measures = measure(&reading.model, &mesh);
    let frames = || {
        let started = Instant::now();
        std::hint::black_box((pca::axes(&mesh), cpca::axes(&mesh), npca::axes(&mesh), Aabb::of(&mesh.points)));
        started.elapsed().as_secs_f64()
    };
    // The least of five: they are so short that anything else on the machine would drown them.
    let frames_s = (0..5).map(|_| frames()).fold(f64::INFINITY, f64::min);
    let why = reading.skipped.iter().chain(&skipped).map(|s| format!("#{}: {}", s.entity, s.why));
    let mut row = counts(&reading.model, &mesh);
    row.extend(numbers(&measures, [scan_s, read_s, mesh_s, frames_s]));
    row.push(why.take(3).collect::<Vec<_>>().join("; "));
    Ok(row)
}

/// ok, solids, faces, edges as placed; an edge counts once for each use by a face.
fn counts(model: &Model, mesh: &Mesh) -> Vec<String> {
    let solids = model.occurrences.iter().filter(|o| model.bodies[o.body.index()].solid).count();
    let uses = |f: &symalign::brep::MeshFace| model.faces[f.face.index()].loops.iter().map(|l| l.uses.len());
    let edges: usize = mesh.faces.iter().flat_map(uses).sum();
    vec!["1".into(), solids.to_string(), mesh.faces.len().to_string(), edges.to_string()]
}

fn numbers(measures: &Measures, seconds: [f64; 4]) -> Vec<String> {
    let (low, high, centre) = (measures.bounds.min, measures.bounds.max, measures.centroid);
    let size = [measures.area, measures.volume];
    let all = size.iter().chain(low.iter()).chain(high.iter()).chain(centre.iter()).chain(&seconds);
    all.map(f64::to_string).collect()
}

/// How long the pass over the text takes: reading of a copy in which no representation, solid or shell bears its name
/// any more, so that nothing is decoded.
fn scan_seconds(bytes: &[u8]) -> f64 {
    let mut nameless = bytes.to_vec();
    for name in ["SHAPE_REPRESENTATION", "BREP", "SHELL", "SURFACE_MODEL", "GEOMETRIC_SET"] {
        memchr::memmem::find_iter(bytes, name).for_each(|at| nameless[at + name.len() - 1] = b'_');
    }
    let started = Instant::now();
    let nothing = read(&nameless, &Options::default(), &Cancel::new());
    let seconds = started.elapsed().as_secs_f64();
    std::hint::black_box(nothing).map_or(seconds, |_| f64::NAN)
}
