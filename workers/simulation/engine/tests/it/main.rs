//! Whole runs of the engine: crowds, lidar and scenarios.
#![cfg(test)]

mod baseline;
mod common;
mod crowds;
mod lidar;
mod runs;
