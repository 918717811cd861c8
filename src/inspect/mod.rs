//! Everything that is known of one model, for people and for programs.

pub mod json;
pub mod text;

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use crate::archive::{self, Limits};
use crate::error::{Result, RunError};
use crate::pipeline::{Described, Seconds, describe};
use crate::settings::Settings;
use crate::stages::{ModelError, Stage};

/// A model that went through all stages, or why it did not.
pub struct Inspection {
    /// The model as the user named it; for the members of an archive its id in it.
    pub model: String,
    /// The model after all stages, or where and why it was lost.
    pub result: std::result::Result<Described, ModelError>,
    /// By stage.
    pub seconds: Seconds,
}

/// Runs all stages on the model at `path`, or on each model of the archive or folder there, and hands them to `each`.
///
/// `archive.zip!folder/part.step` names a single member.
///
/// A path without a model, or that cannot be read, counts as a model that was lost.
///
/// Errors: those of `each`.
pub fn inspect(path: &Path, settings: &Settings, each: &mut dyn FnMut(Inspection) -> Result<()>) -> Result<()> {
    let (mut state, mut count) = (Ok(()), 0);
    let visited = visit(path, settings, &mut |model, bytes| {
        count += 1;
        let (result, seconds) = match bytes {
            Ok(bytes) => describe(&model, bytes, settings),
            Err(error) => (Err(error), Seconds::default()),
        };
        state = each(Inspection { model, result, seconds });
        if state.is_ok() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    });
    state?;
    let why = match visited {
        Err(error) => error.to_string(),
        Ok(()) if count == 0 => format!("{}: no model in it", path.display()),
        Ok(()) => return Ok(()),
    };
    let model = path.display().to_string();
    each(Inspection { model, result: Err(ModelError::new(Stage::Parse, why)), seconds: Seconds::default() })
}

/// The name and the bytes of the one model at `path`.
///
/// Errors: there is no such file, no model in it, or more than one.
pub fn only(path: &Path, settings: &Settings) -> Result<(String, std::result::Result<Vec<u8>, ModelError>)> {
    let mut found = Vec::new();
    visit(path, settings, &mut |model, bytes| {
        found.push((model, bytes));
        if found.len() > 1 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    match found.len() {
        1 => Ok(found.swap_remove(0)),
        0 => Err(RunError::Usage(format!("{}: no model in it", path.display()))),
        _ => Err(RunError::Usage(format!("{}: more than one model in it; name one of them", path.display()))),
    }
}

/// What is done with a model's name and bytes.
type Visitor<'a> = &'a mut dyn FnMut(String, std::result::Result<Vec<u8>, ModelError>) -> ControlFlow<()>;

/// Hands the models at `path` to `each`.
fn visit(path: &Path, settings: &Settings, each: Visitor) -> Result<()> {
    let (file, member) = split(path);
    let limits = Limits { bytes: settings.limits.bytes, expansion: settings.limits.expansion };
    archive::visit(std::slice::from_ref(&file), &limits, &archive::no_wait, &mut |found| {
        if member.as_ref().is_some_and(|member| !found.id.ends_with(member)) {
            return ControlFlow::Continue(Vec::new());
        }
        let model = name(path, &file, &found.id, member.is_some());
        let flow = each(model, found.bytes.map_err(|why| ModelError::new(Stage::Parse, why)));
        flow.map_continue(|()| Vec::new())
    })
}

/// A single file keeps the name that the user gave it.
fn name(path: &Path, file: &Path, id: &str, single: bool) -> String {
    let plain = file.file_name().is_some_and(|name| name.to_string_lossy() == id);
    if plain || single { path.display().to_string() } else { id.to_owned() }
}

/// The archive and the member's `!name`, unless there is a file of the whole name.
fn split(path: &Path) -> (PathBuf, Option<String>) {
    let text = path.to_string_lossy();
    match text.split_once('!') {
        Some((file, member)) if !path.exists() => (file.into(), Some(format!("!{member}"))),
        _ => (path.to_owned(), None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_member_of_an_archive_is_named_after_an_exclamation_mark() {
        assert_eq!(split(Path::new("a.zip!b/c.step")), ("a.zip".into(), Some("!b/c.step".into())));
        assert_eq!(split(Path::new("c.step")), ("c.step".into(), None));
    }
}
