//! How well frames retrieve that somebody else has made: one table of frames, one method.
//!
//! ```text
//! cargo run --release --example frames -- data-samples data-samples/labels.csv data-samples/frame.csv
//! ```
//!
//! takes the folder of the models, the labels, and tables with the columns `path,e1x,e1y,e1z,e2x,..,e3z` (axes in the
//! file's coordinates; more columns are passed over). `data-samples/frame.csv` holds the natural frames of the models,
//! known from their making: what a perfect alignment would retrieve. Figures go to standard output, one line a table
//! and descriptor: mAP, NN, then the precision at the 11 recall levels, then the mAP of each class. A model that a
//! table does not name is left out.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use symalign::cancel::Cancel;
use symalign::distance;
use symalign::evaluate::{Entrant, Gallery, Labels, Options, score};
use symalign::geometry::{Frame, Vector};
use symalign::stages::descriptor::{Descriptor, descriptor};
use symalign::stages::parse::{Parsed, parse};

type Result<T> = std::result::Result<T, Box<dyn Error + Send + Sync>>;

fn main() -> Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [folder, labels, tables @ ..] = arguments.as_slice() else { return Err("FOLDER LABELS TABLE...".into()) };
    let labels = Labels::load(labels)?;
    let tables = tables.iter().map(|path| axes_in(path)).collect::<Result<Vec<_>>>()?;
    let ids: Vec<&String> =
        tables.iter().flat_map(BTreeMap::keys).collect::<std::collections::BTreeSet<_>>().into_iter().collect();
    let described: Vec<_> = ids.par_iter().map(|id| describe(folder, id, &tables)).collect::<Result<_>>()?;
    for (number, table) in arguments[2..].iter().enumerate() {
        report(&name(table), &labels, &ids, described.iter().map(|all| all[number].as_ref()))?;
    }
    Ok(())
}

fn name(path: &Path) -> String {
    path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// The three axes of each model that a table names.
fn axes_in(path: &Path) -> Result<BTreeMap<String, [Vector; 3]>> {
    let mut reader = csv::Reader::from_path(path)?;
    let head = reader.headers()?.clone();
    let column = |name: String| head.iter().position(|h| h == name).ok_or(format!("{}: no {name}", path.display()));
    let mut frames = BTreeMap::new();
    for row in reader.records() {
        let row = row?;
        let mut axes = [Vector::zeros(); 3];
        for (i, axis) in axes.iter_mut().enumerate() {
            for (k, letter) in ["x", "y", "z"].into_iter().enumerate() {
                axis[k] = row[column(format!("e{}{letter}", i + 1))?].parse()?;
            }
        }
        frames.insert(row[column("path".into())?].to_owned(), axes);
    }
    Ok(frames)
}

/// The descriptor of a model in its frame of each table.
fn describe(folder: &Path, id: &str, tables: &[BTreeMap<String, [Vector; 3]>]) -> Result<Vec<Option<Descriptor>>> {
    let cancel = Cancel::new();
    let bytes = std::fs::read(folder.join(id))?;
    let Parsed { wireframe, measures, .. } =
        parse(&bytes, &Default::default(), None, &cancel).map_err(|e| format!("{id}: {e}"))?;
    let in_table = |table: &BTreeMap<String, [Vector; 3]>| {
        let Some(axes) = table.get(id) else { return Ok(None) };
        let frame = Frame { axes: *axes, origin: measures.centroid };
        Ok(Some(descriptor(&wireframe, &measures, &frame, &Default::default(), &cancel)?))
    };
    tables.iter().map(in_table).collect()
}

fn report<'a>(
    name: &str,
    labels: &Labels,
    ids: &[&String],
    described: impl Iterator<Item = Option<&'a Descriptor>>,
) -> Result<()> {
    let (ids, described): (Vec<_>, Vec<_>) =
        ids.iter().zip(described).filter_map(|(id, d)| Some((id.as_str(), d?))).unzip();
    let gallery = Gallery::new(&ids, &labels.assign(&ids, &[]), false);
    let rows = gallery.rows.clone();
    let (a, b) = (&described, &rows);
    let magnitude = |i: usize, j: usize| distance::magnitude(a[b[i]].magnitudes(), a[b[j]].magnitudes());
    let phase = |i: usize, j: usize| distance::phase(a[b[i]].phases(), a[b[j]].phases());
    let entrants = [
        Entrant::of_pairs(name, rows.len(), magnitude),
        Entrant::of_pairs(&format!("{name}:phase"), rows.len(), phase),
    ];
    let options = Options { draws: 1, resamples: 1, ..Options::default() };
    for method in score(gallery, &entrants, &options, None)?.methods {
        let summary = &method.summary;
        let curve = summary.micro_curves.pr11.map(|p| p.map_or("-".into(), |p| format!("{p:.3}"))).join(" ");
        println!("{:<24} mAP {:.3} NN {:.3} | {curve}", method.name, summary.micro.ap, summary.micro.nn);
        let classes = summary.classes.iter().map(|c| format!("{} {:.3}", c.name, c.scores.ap));
        println!("{:<24} {}", "", classes.collect::<Vec<_>>().join(", "));
    }
    Ok(())
}
