//! Holds triangles against the integrals over the true surfaces: a face that is folded, missing or on the wrong side
//! of its border has triangles with another area, and a solid with such a face another volume.
//!
//! The models of `data-samples` are always there; `SYMALIGN_DATA` names a folder with `real-parts` and `cross-cad`.

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use symalign::brep::tessellate::{Options, tessellate};
use symalign::brep::{Mesh, MeshFace, Model};
use symalign::cancel::Cancel;
use symalign::geometry::Aabb;
use symalign::stages::parse;

/// Largest error of a face's area, as a share of it.
const OFF: f64 = 0.03;
/// Faces whose error is smaller than this share of the model's area are too small to be seen.
const UNSEEN: f64 = 1e-4;
/// Largest error of a solid's volume, as a share of it: chords lie inside round walls.
const VOLUME_OFF: f64 = 0.03;
/// Mean distance between triangles and surfaces that thin solids may have, as a share of the model's size: half the
/// deflection.
const MEAN_DISTANCE: f64 = 0.0005;

fn files(folder: &Path) -> Vec<PathBuf> {
    let all = walkdir::WalkDir::new(folder).sort_by_file_name().into_iter().filter_map(Result::ok);
    let step =
        |p: &Path| p.extension().is_some_and(|e| e.eq_ignore_ascii_case("step") || e.eq_ignore_ascii_case("stp"));
    all.map(walkdir::DirEntry::into_path).filter(|p| step(p)).collect()
}

fn triangle_area(mesh: &Mesh, face: &MeshFace) -> f64 {
    (face.triangles.start..face.triangles.end).map(|t| 0.5 * mesh.doubled_normal(t as usize).norm()).sum()
}

/// Volume between the triangles of a face and the mesh's first point.
fn triangle_flux(mesh: &Mesh, face: &MeshFace) -> f64 {
    let flux = |t: u32| mesh.doubled_normal(t as usize).dot(&(mesh.corners(t as usize)[0] - mesh.points[0])) / 6.0;
    (face.triangles.start..face.triangles.end).map(flux).sum()
}

fn kind(model: &Model, face: &MeshFace) -> String {
    let surface = model.surface_of(&model.faces[face.face.index()]);
    surface.map_or_else(|| "Faceted".to_owned(), |(surface, _)| format!("{:?}", surface.kind()))
}

/// What is wrong with the triangles of a file: first bad faces, then bad solids.
fn offences(path: &Path) -> Vec<String> {
    let Ok(bytes) = std::fs::read(path) else { return vec!["cannot be opened".to_owned()] };
    let cancel = Cancel::new();
    let Ok(parse::Reading { model, .. }) = parse::read(&bytes, &parse::Options::default(), &cancel) else {
        return vec!["cannot be read".to_owned()];
    };
    let (mesh, skipped, _) = tessellate(&model, &Options::default(), &cancel).expect("nobody cancels");
    let mut wrong: Vec<String> = skipped.iter().map(|s| format!("#{} skipped: {}", s.entity, s.why)).collect();
    let whole: f64 = mesh.faces.iter().map(|f| f.area).sum();
    for face in &mesh.faces {
        let area = triangle_area(&mesh, face);
        let off = (area - face.area).abs();
        if off > OFF * face.area && off > UNSEEN * whole {
            let entity = model.faces[face.face.index()].entity;
            wrong.push(format!("#{entity} {}: triangles {area:.4}, surface {:.4}", kind(&model, face), face.area));
        }
    }
    wrong.extend(solids_off(&model, &mesh));
    wrong
}

/// Solids whose triangles hold another volume than their surfaces.
fn solids_off(model: &Model, mesh: &Mesh) -> Vec<String> {
    let size = Aabb::of(&mesh.points).diagonal();
    let solids = mesh.faces.chunk_by(|a, b| a.occurrence == b.occurrence);
    let volumes = solids.filter_map(|faces| {
        let body = &model.bodies[model.occurrences[faces[0].occurrence as usize].body.index()];
        let sum = |one: &dyn Fn(&MeshFace) -> f64| faces.iter().map(one).sum::<f64>();
        let (exact, meshed) = (sum(&|f| f.flux), sum(&|f| triangle_flux(mesh, f)));
        let off = (exact - meshed).abs();
        let off = off > VOLUME_OFF * exact.abs() && off > MEAN_DISTANCE * size * sum(&|f| f.area);
        (body.solid && off).then(|| format!("solid #{}: triangles {meshed:.4}, surfaces {exact:.4}", body.entity))
    });
    volumes.collect()
}

/// Prints what is wrong and returns the number of files, and of those with something wrong.
fn check(folder: &Path) -> (usize, usize) {
    let files = files(folder);
    let found: Vec<Vec<String>> = files.par_iter().map(|p| offences(p)).collect();
    for (path, wrong) in files.iter().zip(&found) {
        wrong.iter().for_each(|w| println!("{}: {w}", path.strip_prefix(folder).unwrap_or(path).display()));
    }
    (files.len(), found.iter().filter(|w| !w.is_empty()).count())
}

#[test]
fn triangles_of_the_samples_lie_on_their_faces() {
    let (files, wrong) = check(&Path::new(env!("CARGO_MANIFEST_DIR")).join("data-samples"));
    assert!(files >= 90, "{files} models");
    assert!(wrong == 0, "{wrong} models with bad triangles, listed above");
}

#[test]
fn triangles_of_real_parts_lie_on_their_faces() {
    let Some(data) = std::env::var_os("SYMALIGN_DATA") else {
        println!("skipped: set SYMALIGN_DATA to the folder with real-parts and cross-cad");
        return;
    };
    for folder in ["real-parts", "cross-cad"] {
        let (files, wrong) = check(&Path::new(&data).join(folder));
        println!("{folder}: {wrong} of {files} files have bad triangles");
        assert!(wrong * 100 <= files, "{wrong} of {files} files");
    }
}
