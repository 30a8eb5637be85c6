//! The gateway as its viewers find it: over sockets of this machine, with a run on a bus in memory.
#![expect(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests may fail the test")]
#![expect(clippy::large_futures, reason = "a test holds its sockets and runs")]
#![expect(clippy::indexing_slicing, reason = "a test that looks at a place that is not there fails")]

mod doors;
mod foxglove;
mod page;
mod reading;
mod stage;
