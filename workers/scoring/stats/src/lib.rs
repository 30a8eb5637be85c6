//! socrates-stats.
