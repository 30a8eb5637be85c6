//! socrates-engine.
