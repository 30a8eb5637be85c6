//! Crowds from outside: models, properties, scenes, and the reference trajectories.
#![cfg(test)]

mod models;
mod properties;
mod reference;
mod scene;
mod strict;
