//! symalign finds the dominant mirror symmetry of CAD models, aligns them, describes them and scores retrieval.

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
