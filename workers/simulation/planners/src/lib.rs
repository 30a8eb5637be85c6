//! socrates-planners.
