//! Agent states on their way: live to whoever watches, and as files.
//!
//! ```text
//! simulation ── Onlooker ──┬─► ShmSink   shared memory, one host      ─► ShmWatch
//!   (blocking thread)      ├─► LiveSink  bus, between hosts           ─► Watch (ticks in order, exact gaps, fetch)
//!                          ├─► mcap::Writer  a file or a tape in memory, chunk by chunk, as the run grows
//!                          └─► Keeper    memory ─► mcap::write, csv::write_agents
//! ```
//!
//! The same 64-byte records travel everywhere. A sink never holds the simulation up: what a viewer misses
//! is known exactly and can be fetched. The recording is made by the simulation, never from a stream.
//!
//! | feature | what it adds |
//! |---|---|
//! | `mcap` | recordings as files, bags of ROS 2, and the live stream, which reads older ticks from files |
//! | `shm` | frames in shared memory; without it [`ShmHost`] says so in the log and has none |
//! | `zenoh` | the bus between processes, for the example `subscriber` |
//!
//! *Never here:* the wall clock, a decision about a run, MessagePack of a frame.

#[cfg(feature = "mcap")]
mod bounds;
mod error;
pub use error::StreamError;

mod order;
pub use order::{Order, Seen, TickRange};

mod corner;
#[cfg(not(feature = "shm"))]
pub use corner::ShmHost;
pub use corner::{SharedMemory, ShmConfig};

#[cfg(feature = "shm")]
mod shm;
#[cfg(feature = "shm")]
pub use shm::{ShmHost, ShmSink, ShmState, ShmWatch};

#[cfg(feature = "mcap")]
mod live;
#[cfg(feature = "mcap")]
mod part;
#[cfg(feature = "mcap")]
mod past;
#[cfg(feature = "mcap")]
mod shelf;
#[cfg(feature = "mcap")]
mod watch;
#[cfg(feature = "mcap")]
pub use live::{Linger, LiveSink};
#[cfg(feature = "mcap")]
pub use past::Past;
#[cfg(feature = "mcap")]
pub use watch::{Sharpness, Sight, Watch};

pub mod csv;
#[cfg(feature = "mcap")]
pub mod foxglove;
#[cfg(feature = "mcap")]
pub mod mcap;
#[cfg(feature = "mcap")]
pub mod ros;
