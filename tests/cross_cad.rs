//! The same part from different CAD systems has the same planes.
//!
//! Needs the folder `cross-cad` in `SYMALIGN_DATA`: one folder for each part, with what many systems wrote of it. Files
//! of some of the parts were made anew in each system, with other dimensions: only files of equal shape (area, volume,
//! spread and size in proportion) can agree.

mod known_planes;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use known_planes::symmetries;
use rayon::prelude::*;
use symalign::stages::merge::Label;

/// Relative difference of measures up to which two files have one shape.
const ONE_SHAPE: f64 = 0.01;

/// What does not change with position, scale and exporter.
#[derive(Debug)]
struct Signature {
    part: String,
    name: String,
    /// Area, volume and mean squared distance from the centroid in proportion to the size.
    shape: [f64; 3],
    label: Label,
    /// Coverages, distances from the centroid in proportion to the size, and cosines between all pairs of normals.
    planes: [Vec<f64>; 3],
    axes: usize,
}

fn signature(path: &Path) -> Signature {
    let (parsed, found) = symmetries(&std::fs::read(path).unwrap(), None);
    let (measures, size) = (&parsed.measures, parsed.measures.tolerance.size());
    let name = |p: &Path| p.file_name().unwrap().to_string_lossy().into_owned();
    let mesh = &parsed.mesh;
    let spread: f64 = (0..mesh.triangles.len())
        .map(|t| {
            let [a, b, c] = mesh.corners(t);
            let middle = (a.coords + b.coords + c.coords) / 3.0;
            0.5 * mesh.doubled_normal(t).norm() * (middle - measures.centroid.coords).norm_squared()
        })
        .sum();
    let planes = &found.planes;
    let cosines = planes
        .iter()
        .enumerate()
        .flat_map(|(i, p)| planes[..i].iter().map(move |q| p.plane.normal.dot(&q.plane.normal).abs()));
    let mut all = [
        planes.iter().map(|p| p.coverage).collect::<Vec<_>>(),
        planes.iter().map(|p| p.plane.signed_distance(&measures.centroid).abs() / size).collect(),
        cosines.collect(),
    ];
    all.iter_mut().for_each(|values| values.sort_by(f64::total_cmp));
    Signature {
        part: name(path.parent().unwrap()),
        name: name(path),
        shape: [
            measures.area / size.powi(2),
            measures.volume.abs() / size.powi(3),
            spread / (measures.area * size.powi(2)),
        ],
        label: found.label,
        planes: all,
        axes: found.axes.len(),
    }
}

impl Signature {
    fn same_shape(&self, other: &Self) -> bool {
        self.shape.iter().zip(other.shape).all(|(a, b)| (a - b).abs() <= ONE_SHAPE * a.max(b))
    }

    fn agrees(&self, other: &Self) -> bool {
        let near = |a: &[f64], b: &[f64], slack: f64| {
            a.len() == b.len() && a.iter().zip(b).all(|(x, y)| (x - y).abs() <= slack)
        };
        let [a, b] = [&self.planes, &other.planes];
        let equal = near(&a[0], &b[0], 0.01) && near(&a[1], &b[1], 1e-3) && near(&a[2], &b[2], 1e-3);
        (self.label, self.axes) == (other.label, other.axes) && equal
    }
}

#[test]
fn the_same_part_has_the_same_planes_whoever_wrote_it() {
    let Some(data) = std::env::var_os("SYMALIGN_DATA").map(PathBuf::from).filter(|f| f.join("cross-cad").is_dir())
    else {
        println!("skipped: set SYMALIGN_DATA to the folder with cross-cad");
        return;
    };
    let all = walkdir::WalkDir::new(data.join("cross-cad")).sort_by_file_name().into_iter().filter_map(Result::ok);
    let paths: Vec<_> =
        all.map(walkdir::DirEntry::into_path).filter(|p| p.extension().is_some_and(|e| e == "stp")).collect();
    let files: Vec<_> = paths.par_iter().map(|p| signature(p)).collect();
    let mut parts: BTreeMap<&str, [usize; 4]> = BTreeMap::new();
    for (i, a) in files.iter().enumerate() {
        for b in files[..i].iter().filter(|b| b.part == a.part) {
            let counts = parts.entry(&a.part).or_default();
            let (one, agree) = (a.same_shape(b), a.agrees(b));
            counts[0] += 1;
            counts[1] += usize::from(one);
            counts[2] += usize::from(one && agree);
            counts[3] += usize::from(agree);
            if one && !agree {
                println!("{} and {} differ: {:?} {:?}", b.name, a.name, b.planes[0], a.planes[0]);
            }
        }
    }
    println!("pairs of files, of one shape, of those with the same planes, of all with the same planes: {parts:?}");
    let [_, one, agree, _] = parts.values().fold([0; 4], |s, p| std::array::from_fn(|i| s[i] + p[i]));
    assert!(one >= 600, "{one} pairs of one shape");
    assert!(agree * 100 >= one * 95, "{agree} of {one}");
}
