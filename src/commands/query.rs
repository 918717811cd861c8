//! `query`.

use std::path::Path;

use serde_json::{Value, json};
use symalign::error::{Result, RunError};
use symalign::inspect::{self, Inspection, json::face_name};
use symalign::pipeline::record;
use symalign::search::{self, Asked, Hit, Kind, Name, Rows};
use symalign::settings::Settings;
use symalign::store::{ModelRecord, PlaneEvidence, Store, Summary};

use crate::cli::{Exit, Query};

/// Finds the models of a store most like each of some models, which are computed with the store's settings.
///
/// [`Exit::ModelFailed`] where one could not be read.
pub fn query(args: &Query) -> Result<Exit> {
    let store = Store::open(&args.store)?;
    let first = store.methods().first().copied();
    let default = || first.map(|frame| Name { frame, kind: Kind::Magnitude });
    let name = args.method.or_else(default).ok_or_else(|| RunError::Usage("the store has no frames".into()))?;
    let rows = Rows::of(&store, name)?;
    // The model is not moved: no descriptor depends on its pose.
    let settings = Settings { methods: vec![name.frame], random_pose: None, ..Settings::of_store(store.settings())? };
    if args.out.is_some() && args.model.len() > 1 {
        return Err(RunError::Usage(format!("a page shows the hits of one model, there are {}", args.model.len())));
    }
    let (asked, failed) = described(args, &settings)?;
    let descriptors: Vec<_> = asked.iter().map(|(_, record)| descriptor(record, name)).collect();
    let found = rows.nearest_to_each(&descriptors, args.k)?;
    if let Some(out) = &args.out {
        write_page(out, &store, name, &asked, &found)?;
    }
    for ((model, record), hits) in asked.iter().zip(&found) {
        if args.json {
            let hits = hits.iter().map(|hit| hit_json(&store, hit)).collect::<Result<Vec<_>>>()?;
            let symmetry = symmetry_json(&record.summary);
            let answer = json!({"model": model, "method": name.to_string(), "symmetry": symmetry, "hits": hits});
            super::print(&format!("{answer}\n"))?;
        } else {
            let heading = if asked.len() > 1 { format!("{model}\n") } else { String::new() };
            let lines = hits.iter().map(|hit| format!("{:10.5}  {}\n", hit.distance, store.id(hit.row)));
            super::print(&(heading + &lines.collect::<String>()))?;
        }
    }
    Ok(if failed { Exit::ModelFailed } else { Exit::Done })
}

/// The models at the paths by name, and whether one failed.
fn described(args: &Query, settings: &Settings) -> Result<(Vec<(String, ModelRecord)>, bool)> {
    let (mut asked, mut failed) = (Vec::new(), false);
    let mut each = |Inspection { model, result, .. }: Inspection| {
        match result {
            Ok(described) => asked.push((model, record(&described))),
            Err(error) => {
                eprintln!("symalign: {model}: {error}");
                failed = true;
            }
        }
        Ok(())
    };
    args.model.iter().try_for_each(|path| inspect::inspect(path, settings, &mut each))?;
    if asked.is_empty() && !failed {
        return Err(RunError::Usage(format!("{}: no model in it", args.model[0].display())));
    }
    Ok((asked, failed))
}

fn descriptor(record: &ModelRecord, name: Name) -> &[f32] {
    let pose = record.poses.iter().find(|pose| pose.method == name.frame);
    match name.kind {
        Kind::Magnitude | Kind::Swapped => pose.map_or(&[], |pose| &pose.magnitude),
        Kind::Phase => pose.map_or(&[], |pose| &pose.phase),
    }
}

fn write_page(
    out: &Path,
    store: &Store,
    name: Name,
    asked: &[(String, ModelRecord)],
    found: &[Vec<Hit>],
) -> Result<()> {
    let ([(model, record)], [hits]) = (asked, found) else {
        return Err(RunError::Usage(format!("a page shows the hits of one model, there are {}", asked.len())));
    };
    let asked = Asked { model, thumbnail: Some(&record.thumbnail), method: &name.to_string() };
    search::write_page(out, store, &asked, hits)
}

fn hit_json(store: &Store, hit: &Hit) -> Result<Value> {
    let symmetry = symmetry_json(&store.summary(hit.row)?);
    Ok(json!({"model": store.id(hit.row), "distance": hit.distance, "views": hit.views, "symmetry": symmetry}))
}

/// What a frame rests on: the dominant plane and the faces that speak for it.
fn symmetry_json(summary: &Summary) -> Value {
    let axes = summary.axes.iter().map(|axis| json!({"point_mm": axis.point_mm, "direction": axis.direction}));
    json!({
        "label": summary.label,
        "source": summary.source,
        "plane": summary.planes.first().map(plane_json),
        "axes": axes.collect::<Vec<_>>(),
    })
}

fn plane_json(plane: &PlaneEvidence) -> Value {
    json!({
        "normal": plane.normal,
        "offset_mm": plane.offset_mm,
        "coverage": plane.coverage,
        "residual_mm": plane.residual_mm,
        "pairs": plane.pairs.iter().map(|(a, b)| [face_name(a), face_name(b)]).collect::<Vec<_>>(),
        "pair_count": plane.pair_count,
        "self": plane.selfs.iter().map(|face| face_name(face)).collect::<Vec<_>>(),
        "self_count": plane.self_count,
    })
}
