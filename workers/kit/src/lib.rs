//! socrates-kit.
