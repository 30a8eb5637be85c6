//! Crowds from outside: models, properties, scenes, and the reference trajectories.
#![cfg(test)]

mod models;
mod properties;
mod reference;
mod scene;
mod strict;
// Scenes in, trajectories out: a tool for developers, which `socrates-dev` has as well.
#[path = "../../../../../tests/dev/src/crowd_trace/mod.rs"]
mod trace;
