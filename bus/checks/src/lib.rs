//! socrates-checks.
