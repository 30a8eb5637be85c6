//! socrates-store.
