//! Stage: isometry.
