//! Agent states on their way: live to whoever watches, and as files.
//!
//! ```text
//! simulation ── FrameSink ─┬─► ShmSink   shared memory, one host      ─► ShmWatch
//!   (blocking thread)      ├─► LiveSink  bus, between hosts           ─► Watch (ticks in order, exact gaps, fetch)
//!                          ├─► mcap::Writer  a file or a tape in memory, chunk by chunk, as the run grows
//!                          └─► Recorder  memory ─► mcap::write, csv::write_agents
//! ```
//!
//! The same 64-byte records travel everywhere. A sink never holds the simulation up: what a viewer misses
//! is known exactly and can be fetched. The recording is made by the simulation, never from a stream.
//!
//! *Never here:* the wall clock, a decision about a run, MessagePack of a frame.

mod bounds;
mod error;
pub use error::StreamError;

mod sink;
pub use sink::{Fanout, FrameSink, NoSink, Recorder};

mod order;
pub use order::{Order, Seen, TickRange};

mod shm;
pub use shm::{ShmConfig, ShmHost, ShmSink, ShmState, ShmWatch};

mod live;
mod part;
mod shelf;
mod watch;
pub use live::{Linger, LiveSink};
pub use watch::{Sight, Watch};

pub mod csv;
pub mod mcap;
