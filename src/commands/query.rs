//! `query`.

use serde_json::json;
use symalign::error::{Result, RunError};
use symalign::inspect;
use symalign::pipeline::{Described, record};
use symalign::search::{self, Asked, Hit, Kind, Name};
use symalign::settings::Settings;
use symalign::stages::ModelError;
use symalign::store::{ModelRecord, Store};

use crate::cli::{Exit, Query};

/// Finds the models of a store most like a model, which is computed with the store's settings.
pub fn query(args: &Query) -> Result<Exit> {
    let store = Store::open(&args.store)?;
    let first = store.methods().first().copied();
    let default = || first.map(|frame| Name { frame, kind: Kind::Magnitude });
    let name = args.method.or_else(default).ok_or_else(|| RunError::Usage("the store has no frames".into()))?;
    // The model is not moved: no descriptor depends on its pose.
    let settings = Settings { methods: vec![name.frame], random_pose: None, ..Settings::of_store(store.settings())? };
    let record = match described(args, &settings)? {
        Ok(described) => record(&described),
        Err(error) => {
            eprintln!("symalign: {}: {error}", args.model.display());
            return Ok(Exit::ModelFailed);
        }
    };
    let hits = search::query(&store, descriptor(&record, name), args.k, name)?;
    show(args, &store, &name.to_string(), &record, &hits)?;
    Ok(Exit::Done)
}

/// The first model at the path.
fn described(args: &Query, settings: &Settings) -> Result<std::result::Result<Described, ModelError>> {
    let mut first = None;
    inspect::inspect(&args.model, settings, &mut |inspection| {
        first.get_or_insert(inspection.result);
        Ok(())
    })?;
    first.ok_or_else(|| RunError::Usage(format!("{}: no model in it", args.model.display())))
}

fn descriptor(record: &ModelRecord, name: Name) -> &[f32] {
    let pose = record.poses.iter().find(|pose| pose.method == name.frame);
    match name.kind {
        Kind::Magnitude | Kind::Swapped => pose.map_or(&[], |pose| &pose.magnitude),
        Kind::Phase => pose.map_or(&[], |pose| &pose.phase),
    }
}

fn show(args: &Query, store: &Store, method: &str, record: &ModelRecord, hits: &[Hit]) -> Result<()> {
    if let Some(out) = &args.out {
        let model = args.model.display().to_string();
        let asked = Asked { model: &model, thumbnail: Some(&record.thumbnail), method };
        search::write_page(out, store, &asked, hits)?;
    }
    if args.json {
        let hit = |hit: &Hit| json!({"model": store.id(hit.row), "distance": hit.distance, "views": hit.views});
        let hits: Vec<_> = hits.iter().map(hit).collect();
        let answer = json!({"model": args.model.display().to_string(), "method": method, "hits": hits});
        return super::print(&format!("{answer}\n"));
    }
    let lines = hits.iter().map(|hit| format!("{:10.5}  {}\n", hit.distance, store.id(hit.row)));
    super::print(&lines.collect::<String>())
}
