//! The eight stages as workers on bounded channels: the only threads and channels.

mod budget;
mod feed;
mod guard;
mod line;
mod log;
mod machine;
mod parcel;
mod plan;
mod progress;
mod random_pose;
mod record;
mod report;
mod resume;
mod run;
mod shelf;
mod steps;
mod worker;

pub use feed::Shard;
pub use guard::helpers;
pub use log::interrupted;
pub use parcel::{Seconds, by_stage};
pub use plan::describe;
pub use progress::Progress;
pub use random_pose::random_pose;
pub use record::{Counts, bbox, point, record, vector};
pub use report::Report;
use run::Counters;
use run::TICK;
pub use run::{Request, run};
pub use steps::{Described, Framed, Posed, Ranked};

#[cfg(test)]
mod tests;
