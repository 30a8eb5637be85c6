//! What viewers see of a run while it happens: a page of its own, Foxglove and Lichtblick, and files.

pub mod fox;
