//! `align`.

use std::io::{self, Write};
use std::path::Path;

use symalign::aligned;
use symalign::cancel::Cancel;
use symalign::error::{Result, RunError};
use symalign::geometry::Isometry;
use symalign::inspect;
use symalign::pipeline::{self, Described};
use symalign::stages::parse::relocated;

use crate::cli::{Align, Exit};

/// What can be written, by the ending of the file's name.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Format {
    Step,
    Glb,
    Stl,
    Obj,
}

/// Writes the aligned model; [`Exit::ModelFailed`] where it could not be read or moved.
pub fn align(args: &Align) -> Result<Exit> {
    let format = format_of(&args.out)?;
    let mut settings = super::settings(args.config.as_deref(), None)?;
    settings.methods = vec![args.method];
    settings.random_pose = None;
    let (model, bytes) = inspect::only(&args.model, &settings)?;
    let aligned = bytes.and_then(|bytes| {
        let described = pipeline::describe(&model, bytes.clone(), &settings).0?;
        let pose = pose(&described);
        let step = match format {
            Format::Step => Some(relocated(&bytes, &pose, &settings.parse, &Cancel::new())?),
            _ => None,
        };
        Ok((described, pose, step))
    });
    match aligned {
        Ok((described, pose, step)) => {
            let parsed = &described.framed.ranked.posed.parsed;
            publish(&args.out, &mut |out| match (format, &step) {
                (Format::Step, step) => out.write_all(step.as_deref().unwrap_or_default()),
                (Format::Glb, _) => aligned::glb(parsed, &pose, out),
                (Format::Stl, _) => aligned::stl(parsed, &pose, out),
                (Format::Obj, _) => aligned::obj(parsed, &pose, out),
            })?;
            Ok(Exit::Done)
        }
        Err(error) => {
            eprintln!("symalign: {model}: {error}");
            Ok(Exit::ModelFailed)
        }
    }
}

/// The motion to the frame of the one method.
fn pose(described: &Described) -> Isometry {
    let framed = &described.framed;
    let parsed = &framed.ranked.posed.parsed;
    let frame = framed.frames.first().map_or(framed.canonical.frame, |(_, frame)| *frame);
    aligned::pose(&frame, &parsed.mesh, &parsed.measures)
}

fn format_of(path: &Path) -> Result<Format> {
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    match ending.as_str() {
        "step" | "stp" | "p21" => Ok(Format::Step),
        "glb" => Ok(Format::Glb),
        "stl" => Ok(Format::Stl),
        "obj" => Ok(Format::Obj),
        _ => Err(RunError::Usage(format!("{}: the file must end in .step, .glb, .stl or .obj", path.display()))),
    }
}

/// Writes a file beside its place and renames it, so that no half of it is ever there.
fn publish(path: &Path, write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut written = || {
        let mut out = io::BufWriter::new(draft_in(folder)?);
        write(&mut out)?;
        let draft = out.into_inner().map_err(|e| e.into_error())?;
        draft.as_file().sync_all()?;
        draft.persist(path).map_err(|e| e.error)
    };
    written().map(drop).map_err(|e| RunError::file(path, e))
}

/// A draft that others may read as they may read any new file; a temporary file is for its owner alone.
fn draft_in(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_says_the_format() {
        assert_eq!(format_of(Path::new("a/B.STP")).unwrap(), Format::Step);
        assert_eq!(format_of(Path::new("b.glb")).unwrap(), Format::Glb);
        assert!(format_of(Path::new("b.iges")).is_err() && format_of(Path::new("step")).is_err());
    }
}
