//! socrates-crowd.
