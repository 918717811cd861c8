//! `symmetries`.

use serde_json::Value;
use symalign::cancel::Cancel;
use symalign::error::{Result, RunError};
use symalign::inspect::{self, Inspection};
use symalign::pipeline::Described;
use symalign::rotations::{self, bop};
use symalign::settings::Settings;

use crate::cli::{Exit, Symmetries};

/// Writes the rotations and mirrors of each model; [`Exit::ModelFailed`] where one could not be read.
pub fn symmetries(args: &Symmetries) -> Result<Exit> {
    let mut settings = super::settings(args.config.as_deref(), None)?;
    settings.methods.clear();
    settings.random_pose = None;
    let (mut objects, mut failed) = (Vec::new(), false);
    let mut each = |inspection: Inspection| {
        let model = &inspection.model;
        match inspection.result {
            Ok(described) => objects.push((model.clone(), Some(object(model, &described, &settings)?))),
            Err(error) => {
                eprintln!("symalign: {model}: {error}");
                objects.push((model.clone(), None));
                failed = true;
            }
        }
        Ok(())
    };
    args.model.iter().try_for_each(|path| inspect::inspect(path, &settings, &mut each))?;
    let text = lines(&objects);
    match &args.out {
        Some(path) => std::fs::write(path, text).map_err(|e| RunError::file(path, e))?,
        None => super::print(&text)?,
    }
    Ok(if failed { Exit::ModelFailed } else { Exit::Done })
}

fn object(model: &str, described: &Described, settings: &Settings) -> Result<Value> {
    let ranked = &described.framed.ranked;
    let options = rotations::Options {
        exact: settings.merge.exact,
        samples: settings.validate.samples,
        on_surface: settings.validate.on_surface,
        normal_angle_deg: settings.validate.normal_angle_deg,
    };
    let (parsed, symmetries) = (&ranked.posed.parsed, &ranked.symmetries);
    let found = rotations::rotations(parsed, symmetries, &options, &Cancel::new());
    let found = found.map_err(|_| RunError::Usage(format!("{model}: cancelled")))?;
    Ok(bop::object(model, parsed, symmetries, &found, options.exact))
}

/// One JSON object with an object a line. Models that were lost keep their numbers and have no line.
fn lines(objects: &[(String, Option<Value>)]) -> String {
    let line = |(number, (_, object)): (u64, &(String, Option<Value>))| {
        object.as_ref().map(|object| format!("\"{number}\": {object}"))
    };
    let lines: Vec<_> = numbers(objects).into_iter().zip(objects).filter_map(line).collect();
    if lines.is_empty() { "{}\n".to_owned() } else { format!("{{\n{}\n}}\n", lines.join(",\n")) }
}

/// The benchmark names objects by numbers: those of the files where all are called `obj_000001.step` and so on and
/// differ, else 1, 2, and so on.
fn numbers<T>(objects: &[(String, T)]) -> Vec<u64> {
    let number = |model: &str| {
        let stem = std::path::Path::new(model).file_stem()?.to_str()?;
        stem.strip_prefix("obj_")?.parse::<u64>().ok()
    };
    let named: Option<Vec<_>> = objects.iter().map(|(model, _)| number(model)).collect();
    let mut distinct = named.clone().unwrap_or_default();
    distinct.sort_unstable();
    distinct.dedup();
    named.filter(|_| distinct.len() == objects.len()).unwrap_or_else(|| (1..=objects.len() as u64).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_object_has_its_line() {
        let object = |name: &str, value: Option<Value>| (name.to_owned(), value);
        let objects = [
            object("a", Some(serde_json::json!({"x": 1}))),
            object("lost", None),
            object("b", Some(serde_json::json!({}))),
        ];
        assert_eq!(lines(&objects), "{\n\"1\": {\"x\":1},\n\"3\": {}\n}\n");
        assert_eq!(lines(&[]), "{}\n");
    }

    #[test]
    fn objects_keep_the_numbers_of_their_files() {
        let named = |names: &[&str]| names.iter().map(|n| ((*n).to_owned(), ())).collect::<Vec<_>>();
        assert_eq!(numbers(&named(&["a/obj_000005.step", "obj_000002.stp"])), [5, 2]);
        assert_eq!(numbers(&named(&["obj_000005.step", "mug.step"])), [1, 2]);
        assert_eq!(numbers(&named(&["a/obj_1.step", "b/obj_1.step"])), [1, 2]);
    }
}
