//! Lists the faces of CAD files as CSV, one line for each face in place, to hold them against another reader.
//!
//! ```console
//! $ cargo run --release --example faces -- part.step folder > ours.csv
//! ```
//!
//! `area` is that of the trimmed surface, `triangles` that of the triangles, both in mm^2; the box is that of the
//! triangles' corners, `cx`, `cy`, `cz` the area centroid. `occurrence` counts the bodies in place. A face that could not be read or tessellated has an
//! empty area and says why at the end of its line. `benches/occt_faces.py` compares the list with OpenCASCADE's.

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use symalign::brep::{Mesh, MeshFace, Model};
use symalign::cancel::Cancel;
use symalign::geometry::Aabb;
use symalign::stages::parse;

type Row = [String; 16];

const HEADER: [&str; 16] = [
    "path",
    "entity",
    "occurrence",
    "kind",
    "area",
    "triangles",
    "xmin",
    "ymin",
    "zmin",
    "xmax",
    "ymax",
    "zmax",
    "cx",
    "cy",
    "cz",
    "why",
];

fn main() -> Result<(), csv::Error> {
    let mut out = csv::Writer::from_writer(std::io::stdout().lock());
    out.write_record(HEADER)?;
    let paths: Vec<PathBuf> = std::env::args_os().skip(1).flat_map(|a| files(Path::new(&a))).collect();
    let tables: Vec<Vec<Row>> = paths.par_iter().map(|p| rows(p)).collect();
    tables.iter().flatten().try_for_each(|row| out.write_record(row))?;
    Ok(out.flush()?)
}

/// The file itself, or the STEP files of a folder in order.
fn files(path: &Path) -> Vec<PathBuf> {
    if !path.is_dir() {
        return vec![path.to_owned()];
    }
    let all = walkdir::WalkDir::new(path).sort_by_file_name().into_iter().filter_map(Result::ok);
    let is_step = |p: &Path| {
        p.extension().and_then(|e| e.to_str()).is_some_and(|e| ["step", "stp"].contains(&&*e.to_ascii_lowercase()))
    };
    all.map(walkdir::DirEntry::into_path).filter(|p| is_step(p)).collect()
}

fn rows(path: &Path) -> Vec<Row> {
    let name = path.display().to_string();
    let read = std::fs::read(path).map_err(|e| e.to_string());
    let parsed = read.and_then(|bytes| {
        parse::parse(&bytes, &parse::Options::default(), None, &Cancel::new()).map_err(|e| e.to_string())
    });
    match parsed {
        Ok(parsed) => {
            let faces = parsed.mesh.faces.iter().map(|f| face_row(&name, &parsed.model, &parsed.mesh, f));
            let left = parsed.skipped.iter().map(|s| missing(&name, &s.entity.to_string(), &s.why));
            faces.chain(left).collect()
        }
        Err(why) => vec![missing(&name, "", &why)],
    }
}

fn missing(path: &str, entity: &str, why: &str) -> Row {
    let mut row = Row::default();
    (row[0], row[1], row[15]) = (path.to_owned(), entity.to_owned(), why.to_owned());
    row
}

fn face_row(path: &str, model: &Model, mesh: &Mesh, face: &MeshFace) -> Row {
    let read = &model.faces[face.face.index()];
    let kind =
        model.surface_of(read).map_or_else(|| "Faceted".to_owned(), |(surface, _)| format!("{:?}", surface.kind()));
    let kind = kind.split(' ').next().unwrap_or_default().to_lowercase();
    let triangles = face.triangles.start as usize..face.triangles.end as usize;
    let meshed: f64 = triangles.map(|t| 0.5 * mesh.doubled_normal(t).norm()).sum();
    let aabb = Aabb::of(&mesh.points[face.points.start as usize..face.points.end as usize]);
    let [a, b, c] = [aabb.min, aabb.max, face.centroid];
    let numbers = [face.area, meshed, a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z].map(|x| x.to_string());
    let [area, meshed, x0, y0, z0, x1, y1, z1, cx, cy, cz] = numbers;
    let (entity, occurrence) = (read.entity.to_string(), face.occurrence.to_string());
    [path.to_owned(), entity, occurrence, kind, area, meshed, x0, y0, z0, x1, y1, z1, cx, cy, cz, String::new()]
}
