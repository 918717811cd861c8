//! The stages with their settings: what each adds to a model on its way.

use super::parcel::Job;
use super::random_pose;
use super::shelf::Shelf;
use crate::alignment::mpa::Sweep;
use crate::alignment::{self, Given, Method};
use crate::cancel::Cancelled;
use crate::geometry::{Chirality, Frame, Isometry, Matrix, Vector};
use crate::render;
use crate::settings::Settings;
use crate::stages::corner_filter::{Outline, corner_filter_in};
use crate::stages::descriptor::{Descriptor, descriptor};
use crate::stages::isometry::{Candidates, isometry};
use crate::stages::merge::{Symmetries, merge};
use crate::stages::pair_match::{Matches, pair_match};
use crate::stages::parse::{Parsed, parse_in};
use crate::stages::projection_sweep::{CanonicalFrame, Shadows, Slices, projection_sweep};
use crate::stages::validate::{Validated, validate};
use crate::stages::{ModelError, Scratch, Stage};

/// After parse.
pub struct Posed {
    /// B-rep, mesh and measures.
    pub parsed: Parsed,
    /// How the model was moved after reading.
    pub pose: Isometry,
}

/// After corner_filter.
pub struct Outlined {
    pub posed: Posed,
    pub outlines: Vec<Outline>,
}

/// After pair_match.
pub struct Matched {
    pub outlined: Outlined,
    pub matches: Matches,
}

/// After isometry.
pub struct Proposed {
    pub matched: Matched,
    pub candidates: Candidates,
}

/// After validate.
pub struct Checked {
    pub matched: Matched,
    pub validated: Validated,
}

/// After merge: the outlines have done their work.
pub struct Ranked {
    /// The model as read and moved.
    pub posed: Posed,
    /// Its planes and axes, best first.
    pub symmetries: Symmetries,
}

/// After projection_sweep.
pub struct Framed {
    /// The model with its symmetries.
    pub ranked: Ranked,
    /// The frame by symmetry, with the areas it was chosen by.
    pub canonical: CanonicalFrame,
    /// One for each method of the run, in its order.
    pub frames: Vec<(Method, Frame)>,
}

/// After descriptor.
pub struct Described {
    /// The model with its frames.
    pub framed: Framed,
    /// One for each of the frames.
    pub descriptors: Vec<Descriptor>,
    /// Grey levels, row by row.
    pub thumbnail: Vec<u8>,
}

// The store keeps what the renderer draws.
const _: () = assert!(render::THUMBNAIL == crate::store::THUMBNAIL);

type Step<T> = Result<T, ModelError>;

/// The eight stages.
#[derive(Clone, Copy)]
pub struct Steps<'a> {
    pub settings: &'a Settings,
    /// Where the bytes of files go that have been read.
    pub files: &'a Shelf<Vec<u8>>,
}

impl Steps<'_> {
    pub fn parse(self, job: &Job, bytes: Vec<u8>, scratch: &mut Scratch) -> Step<Posed> {
        let pose = self.settings.random_pose.map(|seed| random_pose(seed, &job.hash));
        let parsed = parse_in(&mut scratch.parse, &bytes, &self.settings.parse, pose.as_ref(), &job.cancel)?;
        self.files.put_back(bytes, job.cancel.account());
        self.check_size(&parsed)?;
        Ok(Posed { parsed, pose: pose.unwrap_or_else(identity) })
    }

    fn check_size(self, parsed: &Parsed) -> Step<()> {
        let limits = &self.settings.limits;
        let (faces, triangles) = (parsed.mesh.faces.len(), parsed.mesh.triangles.len());
        let too_many = |count, what, limit| {
            ModelError::new(Stage::Parse, format!("{count} {what}, more than {limit} (setting limits.{what})"))
        };
        if faces > limits.faces {
            Err(too_many(faces, "faces", limits.faces))
        } else if triangles > limits.triangles {
            Err(too_many(triangles, "triangles", limits.triangles))
        } else {
            Ok(())
        }
    }

    pub fn corner_filter(self, job: &Job, posed: Posed, scratch: &mut Scratch) -> Step<Outlined> {
        let scratch = &mut scratch.corner_filter;
        let outlines = corner_filter_in(scratch, &posed.parsed, &self.settings.corner_filter, &job.cancel)?;
        Ok(Outlined { posed, outlines })
    }

    pub fn pair_match(self, job: &Job, outlined: Outlined) -> Step<Matched> {
        let Outlined { posed, outlines } = &outlined;
        let matches = pair_match(&posed.parsed, outlines, &self.settings.pair_match, &job.cancel)?;
        Ok(Matched { outlined, matches })
    }

    pub fn isometry(self, job: &Job, matched: Matched) -> Step<Proposed> {
        let Outlined { posed, outlines } = &matched.outlined;
        let candidates = isometry(&posed.parsed, outlines, &matched.matches, &self.settings.isometry, &job.cancel)?;
        Ok(Proposed { matched, candidates })
    }

    pub fn validate(self, job: &Job, proposed: Proposed) -> Step<Checked> {
        let Proposed { matched, candidates } = proposed;
        let Outlined { posed, outlines } = &matched.outlined;
        let options = &self.settings.validate;
        let validated = validate(&posed.parsed, outlines, &matched.matches, &candidates, options, &job.cancel)?;
        Ok(Checked { matched, validated })
    }

    pub fn merge(self, job: &Job, checked: Checked) -> Step<Ranked> {
        let Matched { outlined: Outlined { posed, outlines }, matches } = checked.matched;
        let symmetries =
            merge(&posed.parsed, &outlines, &matches, &checked.validated, &self.settings.merge, &job.cancel)?;
        Ok(Ranked { posed, symmetries })
    }

    pub fn projection_sweep(self, job: &Job, ranked: Ranked) -> Step<Framed> {
        let Ranked { posed: Posed { parsed, pose }, symmetries } = &ranked;
        let (options, cancel) = (&self.settings.projection_sweep, &job.cancel);
        let canonical = projection_sweep(parsed, symmetries, options, cancel)?;
        let shadows = |axis: &Vector, start: &Vector, slices| {
            let mut slices = Slices::about(parsed, axis, start, slices, cancel)?;
            Ok::<Sweep, _>(Box::new(move |angles: &[f64]| slices.areas(angles, cancel)))
        };
        let given = Given { measures: &parsed.measures, symmetry: &canonical.frame, pose, shadows: &shadows };
        let frame = |&method| Ok((method, alignment::frame(method, &parsed.mesh, &given, cancel)?));
        let frames: Result<_, Cancelled> = self.settings.methods.iter().map(frame).collect();
        let frames = frames.map_err(|c| ModelError::cancelled(Stage::ProjectionSweep, c))?;
        Ok(Framed { ranked, canonical, frames })
    }

    pub fn descriptor(self, job: &Job, framed: Framed) -> Step<Described> {
        let Parsed { mesh, wireframe, measures, .. } = &framed.ranked.posed.parsed;
        let of = |(_, frame): &(Method, Frame)| {
            descriptor(wireframe, measures, frame, &self.settings.descriptor, &job.cancel)
        };
        let descriptors = framed.frames.iter().map(of).collect::<Step<_>>()?;
        let thumbnail = render::thumbnail(mesh, measures, &framed.canonical.frame, &job.cancel)
            .map_err(|c| ModelError::cancelled(Stage::Descriptor, c))?;
        Ok(Described { framed, descriptors, thumbnail })
    }
}

/// Nothing moves.
fn identity() -> Isometry {
    Isometry { rotation: Matrix::identity(), translation: Vector::zeros(), chirality: Chirality::Proper }
}
