//! symalign finds the dominant mirror symmetry of CAD models, gives them a canonical pose, describes them by three
//! silhouettes and scores how well the descriptions retrieve models of the same class.
//!
//! It starts from Dang, Mouysset and Morin, *Symmetry-Based Alignment for 3D Model Retrieval*, CBMI 2014 ("the
//! paper"). The method is told in [`stages`], stage by stage; where the files and threads are, in `ARCHITECTURE.md`.
//!
//! ```text
//! CAD bytes -> B-rep, mesh -> corners -> pairs -> isometries -> validated -> dominant symmetry -> frame -> descriptor
//! ```
//!
//! # Glossary
//!
//! *B-rep*: a model as *solids*, *shells*, *faces*, *loops*, *edges* and *vertices*. *Underlying surface*: what a face
//! is trimmed from. *Seam*: an edge that one face uses twice. *Corner*: a vertex at which the outer loop of a face turns.
//! *Occurrence*: a body as an assembly places it; *placement*: where. *Isometry*: a map that keeps distances;
//! *reflection*: one that swaps left and right about a plane. *Residual*: what is left of the distance after a fit.
//! *Coverage* (surface support): the share of the surface whose mirror image lies on the surface. *Silhouette*: the
//! shadow of a model along an axis; *contour*: its outline; *centroid distance signature*: the distance of the
//! contour's points from the silhouette's centroid; *Fourier descriptor*: its *harmonics*, normalised. *Query*,
//! *gallery*, *relevant*, *first tier*, *second tier*, *precision-recall*, *mAP*: see [`evaluate`].
//!
//! # Example
//!
//! Read two models, write one of them aligned, compare the two:
//!
//! ```
//! use symalign::settings::{Profile, Settings};
//! use symalign::{aligned, distance, pipeline};
//!
//! let settings = Settings::profile(Profile::Default);
//! let read = |path: &str| -> Result<_, Box<dyn std::error::Error>> {
//!     Ok(pipeline::describe(path, std::fs::read(path)?, &settings).0?)
//! };
//! let (stool, table) = (read("data-samples/household/stool.step")?, read("data-samples/household/table.step")?);
//! let parsed = &stool.framed.ranked.posed.parsed;
//! let pose = aligned::pose(&stool.framed.canonical.frame, &parsed.mesh, &parsed.measures);
//! aligned::glb(parsed, &pose, &mut std::io::sink())?;
//! let [a, b] = [&stool, &table].map(|model| model.descriptors[0].magnitude.as_flattened());
//! assert!(distance::magnitude(a, b) > distance::magnitude(a, a));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Each stage can be called by itself as well, see [`stages`]; [`search::Rows`] compares a descriptor, or many, with a
//! whole store.

#![warn(missing_docs)]

pub mod aligned;
pub mod alignment;
pub mod archive;
pub mod brep;
pub mod cancel;
pub mod distance;
pub mod error;
pub mod evaluate;
pub mod geometry;
pub mod inspect;
pub mod memory;
pub mod pipeline;
pub mod render;
pub mod rotations;
pub mod search;
pub mod settings;
pub mod silhouette;
pub mod stages;
pub mod store;
