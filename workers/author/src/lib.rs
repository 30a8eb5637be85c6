//! socrates-author.
