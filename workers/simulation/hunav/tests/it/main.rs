//! Agents files from outside: differences of the profiles, files, native runs and shipped maps.
#![cfg(test)]

mod common;
mod differences;
mod files;
mod native;
mod shipped;
