//! socrates-llm.
