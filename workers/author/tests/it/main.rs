//! Authors from outside: bad answers, examples, injected faults and the ladder of rates.
#![cfg(test)]

mod bad_answers;
mod examples;
mod faults;
mod offline;
