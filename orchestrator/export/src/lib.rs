//! socrates-export.
