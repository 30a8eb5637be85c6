//! Words that the lines of several verbs share.

/// `1 problem`, `2 problems`.
#[must_use]
pub fn plural(count: usize, word: &str) -> String {
    if count == 1 { format!("1 {word}") } else { format!("{count} {word}s") }
}
