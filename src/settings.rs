//! `pipeline.toml`: as written -> ready to use.
