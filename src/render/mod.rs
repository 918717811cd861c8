//! Pictures of models: shaded, anti-aliased, hidden surfaces hidden.
