//! socrates-orchestrator.
