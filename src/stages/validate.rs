//! Stage: validate.
