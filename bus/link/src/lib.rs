//! socrates-link.
