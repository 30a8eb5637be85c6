//! socrates-stream.
