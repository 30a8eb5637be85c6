//! Foxglove and Lichtblick: their WebSocket protocol and the messages of a run in it. Pure: bytes in, bytes out.
