//! socrates-bt.
