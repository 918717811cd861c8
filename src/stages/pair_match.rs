//! Stage: pair_match.
