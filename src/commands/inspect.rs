//! `inspect`.

use std::collections::HashSet;
use std::path::Path;

use symalign::archive::unique;
use symalign::cancel::Cancel;
use symalign::error::{Result, RunError};
use symalign::inspect::{Inspection, inspect as inspect_all, json, text};
use symalign::pipeline::Described;
use symalign::render;
use symalign::settings::Settings;
use symalign::stages::descriptor::silhouettes;

use crate::cli::{Exit, Inspect};

/// Prints what is known of each model; ends with [`Exit::ModelFailed`] where one could not be read.
pub fn inspect(args: &Inspect) -> Result<Exit> {
    let mut settings = super::settings(args.config.as_deref(), None)?;
    if let Some(methods) = &args.method {
        settings.methods.clone_from(methods);
    }
    // Everything is told in the file's own coordinates.
    settings.random_pose = None;
    let (mut failed, mut names) = (false, HashSet::new());
    let mut each = |inspection: Inspection| {
        failed |= inspection.result.is_err();
        if args.json {
            super::print(&format!("{}\n", json::object(&inspection)))?;
        } else {
            super::print(&text::summary(&inspection))?;
        }
        match (&args.render, &inspection.result) {
            (Some(dir), Ok(described)) => {
                let name = unique(file_name(&inspection.model), &mut names);
                draw(dir, &name, described, &settings)
            }
            _ => Ok(()),
        }
    };
    args.model.iter().try_for_each(|path| inspect_all(path, &settings, &mut each))?;
    Ok(if failed { Exit::ModelFailed } else { Exit::Done })
}

/// Writes the pictures of a model into `dir`; the names of their files start with `name`.
fn draw(dir: &Path, name: &str, described: &Described, settings: &Settings) -> Result<()> {
    std::fs::create_dir_all(dir).map_err(|e| RunError::file(dir, e))?;
    let ranked = &described.framed.ranked;
    let (parsed, canonical) = (&ranked.posed.parsed, &described.framed.canonical);
    let options = &settings.descriptor;
    let views = silhouettes(&parsed.wireframe, &parsed.measures, &canonical.frame, options, &Cancel::new());
    let views = views.map_err(|e| RunError::Usage(format!("{name}: {e}")))?;
    let drawn = render::figures::render_all(dir, name, parsed, &ranked.symmetries, canonical, &views);
    for file in drawn.map_err(|e| RunError::file(dir, e))? {
        eprintln!("{}", file.display());
    }
    Ok(())
}

/// The model's name as the start of file names.
fn file_name(model: &str) -> String {
    let model = Path::new(model).file_name().map_or(model.into(), |name| name.to_string_lossy());
    model.replace(['!', '\\', ':'], "_")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_named_after_the_file() {
        assert_eq!(file_name("a/b.step"), "b.step");
        assert_eq!(file_name("a.zip!b.step"), "a.zip_b.step");
    }
}
