//! Trees from outside: reading, checking, ticking, drawing, and the reference traces.
#![cfg(test)]

mod analysis;
mod bad_input;
mod check;
mod common;
mod leaves;
mod readme;
mod reference;
mod robust;
mod rules;
mod shipped;
mod steps;
mod tools;
mod trace;
