//! socrates-offline.
