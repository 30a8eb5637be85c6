//! What faults say, and that nothing is decided by it. Messages are masked for a whole process here: beside these tests none may read a
//! message of its own process.

mod bench;
mod examples;
mod masked;

use std::sync::{PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

/// Messages of this process are masked while somebody writes here.
static MASK: RwLock<()> = RwLock::new(());

/// For tests that read messages: none are masked meanwhile.
pub(crate) fn plain() -> RwLockReadGuard<'static, ()> {
    MASK.read().unwrap_or_else(PoisonError::into_inner)
}

/// Every message says `x` until this is dropped.
pub(crate) struct Masked {
    _alone: RwLockWriteGuard<'static, ()>,
}

impl Masked {
    pub(crate) fn begin() -> Self {
        let alone = MASK.write().unwrap_or_else(PoisonError::into_inner);
        socrates_model::fault::mask_messages(true);
        Self { _alone: alone }
    }
}

impl Drop for Masked {
    fn drop(&mut self) {
        socrates_model::fault::mask_messages(false);
    }
}
