//! A file of a bag: MCAP as rosbag2 writes it, messages in CDR.

use std::collections::BTreeMap;
use std::io::Cursor;

use mcap::records::MessageHeader;
use mcap::{Compression, McapError, WriteOptions, Writer};

/// Writes a bag's file into memory; the same messages give the same bytes.
pub struct BagPen {
    writer: Writer<Cursor<Vec<u8>>>,
    /// Messages of each channel so far.
    sent: BTreeMap<u16, u32>,
}

impl BagPen {
    /// An empty file.
    ///
    /// # Errors
    /// [`McapError`] of the writer, never in practice.
    pub fn new() -> Result<Self, McapError> {
        let options = WriteOptions::new().compression(Some(Compression::Zstd)).profile("ros2");
        Ok(Self { writer: options.create(Cursor::new(Vec::new()))?, sent: BTreeMap::new() })
    }

    /// A topic with its type (`nav_msgs/msg/Odometry`), the type's definition (`ros2msg`) and its quality of service as YAML.
    ///
    /// # Errors
    /// [`McapError`] where there are more topics than the format has numbers for.
    pub fn channel(&mut self, topic: &str, kind: &str, definition: &str, qos: &str) -> Result<u16, McapError> {
        let schema = self.writer.add_schema(kind, "ros2msg", definition.as_bytes())?;
        let notes = BTreeMap::from([("offered_qos_profiles".to_owned(), qos.to_owned())]);
        self.writer.add_channel(schema, topic, "cdr", &notes)
    }

    /// Adds a message in CDR at a time, ns.
    ///
    /// # Errors
    /// [`McapError`] for a channel that is not there.
    pub fn send(&mut self, channel: u16, nanos: u64, data: &[u8]) -> Result<(), McapError> {
        let sent = self.sent.entry(channel).or_insert(0);
        let header = MessageHeader { channel_id: channel, sequence: *sent, log_time: nanos, publish_time: nanos };
        *sent = sent.saturating_add(1);
        self.writer.write_to_known_channel(&header, data)
    }

    /// The bytes of the file.
    ///
    /// # Errors
    /// [`McapError`] of the writer, never in practice.
    pub fn finish(mut self) -> Result<Vec<u8>, McapError> {
        self.writer.finish()?;
        Ok(self.writer.into_inner().into_inner())
    }
}

impl std::fmt::Debug for BagPen {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("BagPen").field("sent", &self.sent).finish_non_exhaustive()
    }
}
