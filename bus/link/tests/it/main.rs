//! What the link promises to processes, and who may do what on a router.
#![expect(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "helpers of tests may fail the test")]

#[cfg(feature = "zenoh")]
mod access;
#[cfg(feature = "zenoh")]
mod both_ways;
#[cfg(feature = "zenoh")]
mod deployment;
mod endpoints;
mod messages;
mod promises;
#[cfg(feature = "zenoh")]
mod strangers;
