//! A listener that hears how far an answer is while it comes.

use std::fmt;
use std::sync::Arc;

/// Hears how many characters of an answer came so far, thoughts included. Clones tell the same one; the default hears nothing.
///
/// It is called for every part of an answer, so that it has to be quick; a call that starts anew begins at 0.
#[derive(Clone, Default)]
pub struct Listener(Option<Arc<dyn Fn(u64) + Send + Sync>>);

impl Listener {
    /// One that calls this.
    #[must_use]
    pub fn new(hear: impl Fn(u64) + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(hear)))
    }

    /// Says how many characters there are.
    pub(crate) fn tell(&self, characters: u64) {
        if let Some(hear) = &self.0 {
            hear(characters);
        }
    }
}

impl fmt::Debug for Listener {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "Listener" } else { "Listener(nobody)" })
    }
}
