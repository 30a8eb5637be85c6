//! socrates-paths.
