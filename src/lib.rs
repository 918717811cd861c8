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
//! ```
//! use symalign::cancel::Cancel;
//! use symalign::stages::parse::{Options, parse};
//!
//! let bytes = std::fs::read("data-samples/household/stool.step")?;
//! let parsed = parse(&bytes, &Options::default(), None, &Cancel::new())?;
//! assert!(parsed.skipped.is_empty());
//! assert!(parsed.measures.volume > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

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
pub mod pipeline;
pub mod render;
pub mod search;
pub mod settings;
pub mod stages;
pub mod store;
