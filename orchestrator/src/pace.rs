//! How fast scenarios end. Only the time counts in which a worker holds a job: what was submitted in the evening and goes on in the
//! morning is no slower for the night.

use std::collections::VecDeque;

use socrates_model::wire::Pace;

use crate::state::Millis;

/// Time of work over which the pace is told, ms.
const WINDOW_MS: u64 = 600_000;
/// Ends that are kept, at most; beyond it the pace is that of the last ones.
const ENDS: usize = 512;

/// The clock of work of one batch, or of everything.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Pacer {
    /// Jobs that workers hold.
    pub(crate) held: u32,
    /// Time of work until `since`, ms.
    work_ms: u64,
    /// When work began or ended last.
    since: Millis,
    /// When the last scenarios ended, on the clock of work.
    ends: VecDeque<u64>,
}

impl Pacer {
    /// One that begins now.
    pub(crate) fn new(now: Millis) -> Self {
        Self { since: now, ..Self::default() }
    }

    /// Time of work, ms.
    const fn clock(&self, now: Millis) -> u64 {
        if self.held == 0 { self.work_ms } else { self.work_ms.saturating_add(now.saturating_sub(self.since)) }
    }

    pub(crate) const fn takes(&mut self, now: Millis) {
        if self.held == 0 {
            self.since = now;
        }
        self.held += 1;
    }

    pub(crate) const fn gives_back(&mut self, now: Millis) {
        if self.held == 1 {
            (self.work_ms, self.since) = (self.clock(now), now);
        }
        self.held = self.held.saturating_sub(1);
    }

    pub(crate) fn ended(&mut self, now: Millis) {
        self.ends.push_back(self.clock(now));
        if self.ends.len() > ENDS {
            self.ends.pop_front();
        }
    }

    /// As it is told.
    #[must_use]
    pub fn told(&self, now: Millis) -> Pace {
        let clock = self.clock(now);
        let from = clock.saturating_sub(WINDOW_MS);
        // Where more ended than are kept, the oldest that is kept says from when on.
        let from = if self.ends.len() < ENDS { from } else { self.ends.front().map_or(from, |first| from.max(*first)) };
        let ended = self.ends.iter().filter(|at| **at > from || from == 0).count();
        Pace {
            ended: u32::try_from(ended).unwrap_or(u32::MAX),
            work_ms: clock - from,
            idle_ms: (self.held == 0).then(|| now.saturating_sub(self.since)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_night_in_which_nobody_works_makes_nothing_slower() {
        let mut pacer = Pacer::new(0);
        assert_eq!(pacer.told(5_000), Pace { ended: 0, work_ms: 0, idle_ms: Some(5_000) });
        pacer.takes(10_000);
        pacer.takes(12_000);
        pacer.gives_back(15_000);
        pacer.ended(20_000);
        assert_eq!(pacer.told(20_000), Pace { ended: 1, work_ms: 10_000, idle_ms: None });
        pacer.gives_back(20_000);
        let night = 20_000 + 8 * 3_600_000;
        assert_eq!(pacer.told(night), Pace { ended: 1, work_ms: 10_000, idle_ms: Some(night - 20_000) });
        pacer.takes(night);
        pacer.ended(night + 10_000);
        assert_eq!(pacer.told(night + 10_000), Pace { ended: 2, work_ms: 20_000, idle_ms: None });
    }

    #[test]
    fn only_the_last_minutes_of_work_are_told() {
        let mut pacer = Pacer::new(0);
        pacer.takes(0);
        for second in 1..=1_200 {
            if second <= 600 || second % 60 == 0 {
                pacer.ended(second * 1_000);
            }
        }
        // Fast at first, slow in the last ten minutes.
        let pace = pacer.told(1_200_000);
        assert_eq!((pace.ended, pace.work_ms), (10, WINDOW_MS));
        let mut fast = Pacer::new(0);
        fast.takes(0);
        (1..=5_000).for_each(|at| fast.ended(at));
        let pace = fast.told(5_000);
        assert_eq!((pace.ended, pace.work_ms), (511, 511));
    }
}
