//! socrates-maps.
