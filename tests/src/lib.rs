//! socrates-tests.
