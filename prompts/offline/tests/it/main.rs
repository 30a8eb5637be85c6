//! The offline author from outside: whole requests, edits and faults.
#![cfg(test)]

mod asked;
mod common;
mod corpus;
mod edits;
mod faults;
mod said;
mod ways;
