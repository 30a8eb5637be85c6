//! Inputs that a worker fetched over the bus and may need again: all scenarios of a request have the same three.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Mutex, PoisonError};

use socrates_model::Digest;

/// Bytes that are kept at most.
const MOST: usize = 64 << 20;
/// The largest content that is kept, bytes.
const LARGEST: usize = 4 << 20;

/// Contents by their addresses; the oldest leave first.
#[derive(Debug, Default)]
pub(crate) struct Cache(Mutex<Kept>);

#[derive(Debug, Default)]
struct Kept {
    contents: BTreeMap<Digest, Vec<u8>>,
    order: VecDeque<Digest>,
    bytes: usize,
}

impl Cache {
    pub(crate) fn get(&self, digest: &Digest) -> Option<Vec<u8>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).contents.get(digest).cloned()
    }

    /// Keeps a content, whose address was checked.
    pub(crate) fn keep(&self, digest: Digest, bytes: &[u8]) {
        if bytes.len() > LARGEST {
            return;
        }
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if kept.contents.insert(digest, bytes.to_vec()).is_some() {
            return;
        }
        kept.order.push_back(digest);
        kept.bytes += bytes.len();
        while kept.bytes > MOST
            && let Some(oldest) = kept.order.pop_front()
        {
            let gone = kept.contents.remove(&oldest).map_or(0, |bytes| bytes.len());
            kept.bytes = kept.bytes.saturating_sub(gone);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_contents_leave_and_large_ones_do_not_come() {
        let cache = Cache::default();
        let content = |n: usize| vec![u8::try_from(n % 251).unwrap(); 3 << 20];
        let digests: Vec<Digest> = (0..30).map(|n: usize| Digest::of(&n.to_le_bytes())).collect();
        for (n, digest) in digests.iter().enumerate() {
            cache.keep(*digest, &content(n));
            cache.keep(*digest, &content(n));
        }
        let kept: Vec<bool> = digests.iter().map(|digest| cache.get(digest).is_some()).collect();
        // Twenty-one times three MiB are below the limit of 64.
        assert_eq!(kept.iter().filter(|kept| **kept).count(), 21, "{kept:?}");
        assert!(kept[9..].iter().all(|kept| *kept), "{kept:?}");
        assert_eq!(cache.get(&digests[29]), Some(content(29)));
        let large = Digest::of(b"large");
        cache.keep(large, &vec![0; LARGEST + 1]);
        assert_eq!(cache.get(&large), None);
    }
}
