//! socrates-simulation.
