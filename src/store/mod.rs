//! The descriptors of an archive in memory-mapped files: the only bytes on disk that are ours.
