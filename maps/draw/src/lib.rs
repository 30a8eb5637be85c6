//! socrates-draw.
