//! socrates-scoring.
