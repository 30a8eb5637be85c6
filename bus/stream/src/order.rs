//! Ticks in order, and exactly which are missing. Pure.

/// Ticks `from` to `to`, both included.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct TickRange {
    /// First tick.
    pub from: u64,
    /// Last tick.
    pub to: u64,
}

impl TickRange {
    /// How many ticks.
    #[must_use]
    pub const fn len(self) -> u64 {
        (self.to + 1).saturating_sub(self.from)
    }

    /// Whether there are none.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.to < self.from
    }
}

/// What a tick that came is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Seen {
    /// The next one.
    Next,
    /// A later one; these before it did not come.
    After(TickRange),
    /// One that was seen or given up before.
    Old,
}

/// Follows a run's ticks.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Order {
    next: u64,
    missing: Vec<TickRange>,
}

impl Order {
    /// Nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { next: 0, missing: Vec::new() }
    }

    /// The tick that is expected.
    #[must_use]
    pub const fn next(&self) -> u64 {
        self.next
    }

    /// A tick came.
    pub fn saw(&mut self, tick: u64) -> Seen {
        if tick < self.next {
            return Seen::Old;
        }
        let gap = self.up_to(tick);
        self.next = tick.saturating_add(1);
        gap.map_or(Seen::Next, Seen::After)
    }

    /// Ticks before this one will not come any more; gives those that did not.
    pub fn up_to(&mut self, tick: u64) -> Option<TickRange> {
        if tick <= self.next {
            return None;
        }
        let gap = TickRange { from: self.next, to: tick - 1 };
        self.missing.push(gap);
        self.next = tick;
        Some(gap)
    }

    /// Every tick that is missing, in order.
    #[must_use]
    pub fn missing(&self) -> &[TickRange] {
        &self.missing
    }

    /// A tick was fetched: it is missing no longer. `false` when it was not missing.
    pub fn filled(&mut self, tick: u64) -> bool {
        let Some(at) = self.missing.iter().position(|range| (range.from..=range.to).contains(&tick)) else {
            return false;
        };
        let range = self.missing.remove(at);
        if tick < range.to {
            self.missing.insert(at, TickRange { from: tick + 1, to: range.to });
        }
        if range.from < tick {
            self.missing.insert(at, TickRange { from: range.from, to: tick - 1 });
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tick_is_either_seen_or_listed_as_missing() {
        let mut order = Order::new();
        let came = [0_u64, 1, 4, 5, 3, 9];
        let kinds: Vec<Seen> = came.iter().map(|tick| order.saw(*tick)).collect();
        assert_eq!(kinds[2], Seen::After(TickRange { from: 2, to: 3 }));
        assert_eq!(kinds[4], Seen::Old);
        order.up_to(12);
        let missing: Vec<u64> = order.missing().iter().flat_map(|range| range.from..=range.to).collect();
        assert_eq!(missing, [2, 3, 6, 7, 8, 10, 11]);
    }

    #[test]
    fn a_filled_tick_splits_its_gap() {
        let mut order = Order::new();
        order.saw(10);
        assert!(order.filled(4) && !order.filled(4) && order.filled(0) && order.filled(9));
        assert_eq!(order.missing(), [TickRange { from: 1, to: 3 }, TickRange { from: 5, to: 8 }]);
    }
}
