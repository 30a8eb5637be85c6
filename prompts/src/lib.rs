//! Questions to an author and how its answers are read.

pub mod question;

pub use question::Question;
