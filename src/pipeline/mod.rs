//! The eight stages as workers on bounded channels: the only threads and channels.

mod budget;
mod feed;
mod guard;
mod line;
mod log;
mod parcel;
mod plan;
mod progress;
mod random_pose;
mod resume;
mod run;
mod worker;

pub use feed::Shard;
pub use progress::Progress;
pub use random_pose::random_pose;
use run::Counters;
pub use run::{Report, Request, run};
