//! Series: scenarios that are made when they are soon begun. A million of them are one row, and as many scenarios as were begun.

use std::collections::BTreeMap;

use socrates_model::ScenarioId;
use socrates_model::standing::ScenarioEnd;
use socrates_model::wire::{Priority, ScenarioSpec, Series};

use crate::batches::Queue;
use crate::turn::Turn;

/// Scenarios of a series that are made and wait to be begun: no fewer than a reply hands out.
pub(crate) const AHEAD: u32 = 16;
/// Scenarios that one step makes at most, where each of them ends at once; the next step goes on.
const AT_ONCE: usize = 256;

/// What becomes of a series that is submitted.
pub(crate) enum Comes {
    /// It is known already.
    Known,
    /// It is new.
    New,
}

impl Turn<'_> {
    /// Whether a series can be taken beside what is there and what comes with it.
    pub(crate) fn comes(
        &self,
        batch: &str,
        series: &Series,
        fresh: &BTreeMap<ScenarioId, ScenarioSpec>,
    ) -> Result<Comes, String> {
        let first = &series.first.id;
        if self.state.queues.values().any(|queue| queue.batch == batch && queue.series == *series) {
            return Ok(Comes::Known);
        }
        let count = series.count();
        let last = count.checked_sub(1).and_then(|last| series.scenario(last));
        if series.scenario(0).as_ref() != Some(&series.first) || last.is_none() {
            let why = "its name ends with no number, its seeds begin with another one, or it has no scenario";
            return Err(format!("the series from `{first}` on, of `{count}` scenarios, cannot be numbered: {why}"));
        }
        let taken = self.state.scenarios.keys().chain(fresh.keys()).find(|id| series.index_of(id).is_some());
        let named = |queue: &&Queue| meet(&queue.series, series);
        let taken = taken.or_else(|| self.state.queues.values().find(named).map(|queue| &queue.series.first.id));
        match taken {
            Some(taken) => Err(format!(
                "the series from `{first}` on has names that are known already, as `{taken}`; choose another name"
            )),
            None => Ok(Comes::New),
        }
    }

    /// Takes a series that can be taken.
    pub(crate) fn join(&mut self, batch: &str, priority: Priority, series: Series) {
        let place = self.state.next_order;
        let count = u64::from(series.count());
        self.state.next_order = place.saturating_add(count);
        let queue = Queue {
            batch: batch.to_owned(),
            priority,
            place,
            series,
            left_out: 0,
            left_as: ScenarioEnd::Canceled,
            made: 0,
            waiting: 0,
        };
        self.state.queues.insert(place, queue);
        self.queues.insert(place);
        self.state.drawing.insert(place);
        self.opened(batch, count);
    }

    /// A scenario was begun, or ended without: where it stands in a series, the next ones may be made.
    pub(crate) fn waits_no_more(&mut self, order: u64) {
        if let Some(queue) = self.state.queue_at(order) {
            queue.waiting = queue.waiting.saturating_sub(1);
            let place = queue.place;
            self.state.drawing.insert(place);
        }
    }

    /// A scenario that had ended without being begun waits again.
    pub(crate) fn waits_again(&mut self, order: u64) {
        if let Some(queue) = self.state.queue_at(order) {
            queue.waiting += 1;
        }
    }

    /// Makes the next scenarios of the series that have too few ahead; whether any was made.
    pub(crate) fn draw(&mut self) -> bool {
        let mut made = false;
        // A step makes so many at most; then the clock calls again at once.
        while self.drawn < AT_ONCE
            && let Some(place) = self.state.drawing.first().copied()
        {
            let wants = self.state.queues.get(&place).filter(|queue| queue.waiting < AHEAD);
            if let Some((spec, order)) = wants.and_then(Queue::next) {
                self.make_of(place, order, spec);
                made = true;
            } else {
                self.state.drawing.remove(&place);
            }
        }
        made
    }

    /// Makes a scenario of the series that begins at a place.
    fn make_of(&mut self, place: u64, order: u64, spec: ScenarioSpec) {
        let Some(queue) = self.state.queues.get_mut(&place) else { return };
        queue.made += 1;
        queue.waiting += 1;
        self.drawn += 1;
        let (batch, priority) = (queue.batch.clone(), queue.priority);
        self.begin_at(order, &batch, priority, spec);
    }

    /// Makes no more scenarios of the series of a batch; how many those are.
    pub(crate) fn leave_out(&mut self, batch: &str, end: ScenarioEnd) -> u32 {
        let mut left = 0_u32;
        let own = self.state.queues.values_mut().filter(|queue| queue.batch == batch && queue.unmade() > 0);
        for queue in own {
            let unmade = queue.unmade();
            queue.left_out += unmade;
            queue.left_as = end;
            left = left.saturating_add(unmade);
            self.queues.insert(queue.place);
        }
        if left > 0 {
            self.shut(batch, left.into());
        }
        left
    }
}

/// Whether two series have a name in common.
pub(crate) fn meet(one: &Series, other: &Series) -> bool {
    let ends = |series: &Series| [Some(series.first.clone()), series.scenario(series.count().saturating_sub(1))];
    // Names of one stem are numbered in order: series that meet hold an end of each other.
    let holds =
        |one: &Series, other: &Series| ends(other).into_iter().flatten().any(|spec| one.index_of(&spec.id).is_some());
    holds(one, other) || holds(other, one)
}
