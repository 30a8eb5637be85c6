//! What several tests and benches share. Not every test needs everything.
#![expect(dead_code, unreachable_pub, reason = "each test uses its part")]

pub mod hall;
pub mod scenario;
pub mod scene;
