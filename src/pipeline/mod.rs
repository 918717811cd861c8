//! The stages as workers on bounded channels: the only threads and channels.
