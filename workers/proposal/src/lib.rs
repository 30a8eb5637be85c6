//! socrates-proposal.
