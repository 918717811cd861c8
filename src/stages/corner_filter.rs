//! Stage: corner_filter.
