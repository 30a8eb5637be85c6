//! socrates-behaviors.
