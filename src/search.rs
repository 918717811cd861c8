//! Nearest neighbours in a store.
