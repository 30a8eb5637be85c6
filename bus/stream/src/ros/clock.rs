//! When a message was: by its own time stamp, and where it has none by the recorder's clock, brought to that of the stamps.

use super::bag::{Bag, Logged, Topic};

/// Clocks nearer to each other than this are one, ns: what is between them is the way of a message.
const SAME_NANOS: u64 = 5_000_000_000;

/// What the recorder's clock and that of the time stamps were together, ns, in order. In a simulator they run at different speeds.
#[derive(Debug, Clone, Default)]
pub(super) struct Clock {
    pairs: Vec<(i64, i64)>,
}

impl Clock {
    /// The clock of a bag: of `/clock`, else of the messages of these topics.
    pub(super) fn of(bag: &Bag, topics: &[&Topic]) -> Self {
        let mut pairs = bag.clock.clone();
        if pairs.is_empty() {
            let stamped = |logged: &Logged| Some((logged.log, logged.sighting.stamp?));
            let first = topics.iter().find(|topic| topic.sightings.iter().any(|logged| stamped(logged).is_some()));
            pairs = first.map_or_else(Vec::new, |topic| topic.sightings.iter().filter_map(stamped).collect());
        }
        pairs.sort_unstable();
        Self { pairs }
    }

    /// The time of a message, ns.
    pub(super) fn time(&self, logged: &Logged) -> i64 {
        logged.sighting.stamp.unwrap_or_else(|| self.at(logged.log))
    }

    /// The time of the stamps when the recorder's clock was at `log`.
    fn at(&self, log: i64) -> i64 {
        let after = self.pairs.partition_point(|(of_log, _)| *of_log <= log);
        let pair = after.checked_sub(1).and_then(|at| self.pairs.get(at)).or_else(|| self.pairs.first());
        match pair {
            Some((of_log, stamp)) if of_log.abs_diff(*stamp) > SAME_NANOS => {
                stamp.saturating_add(log.saturating_sub(*of_log))
            }
            Some(_) | None => log,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_recorders_time_becomes_that_of_a_simulator_and_stays_where_both_are_one() {
        let second = 1_000_000_000;
        // Half as fast as the recorder's.
        let clock = Clock { pairs: (0..10).map(|k| ((1000 + 2 * k) * second, k * second)).collect() };
        assert_eq!(clock.at(1004 * second), 2 * second);
        assert_eq!(clock.at(1004 * second + 5), 2 * second + 5);
        assert_eq!(clock.at(999 * second), -second);
        let late = Clock { pairs: vec![(1000 * second, 999 * second)] };
        assert_eq!(late.at(1010 * second), 1010 * second);
        assert_eq!(Clock::default().at(7), 7);
    }
}
