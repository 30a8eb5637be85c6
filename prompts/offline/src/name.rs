//! The name of this author.

/// As artifacts spell it.
pub const NAME: &str = "offline/1";
