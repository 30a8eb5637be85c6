//! Fair shares: whose scenario is begun next where several batches wait.
//!
//! Start-time fair queueing (Goyal, Vin and Cheng 1996): each scenario has a turn, which is drawn when it is submitted. Within a batch it
//! stands one step behind the one before it, and the step is the shorter the more urgent the batch is; the first stands one step behind
//! what was begun last. So batches of one priority are begun by turns however long they are, an urgent one takes most of the
//! turns, and none waits for ever.

use socrates_model::wire::Priority;

use crate::state::State;

/// Step of a batch of the lowest priority.
const STEP: u64 = 100;

/// Scenarios of a priority that are begun for one of the lowest.
const fn weight(priority: Priority) -> u64 {
    match priority {
        Priority::Interactive => 100,
        Priority::Normal => 10,
        Priority::Bulk => 1,
    }
}

impl State {
    /// The turn of the next scenario of a batch, which is taken by it.
    pub(crate) fn take_turn(&mut self, batch: &str, priority: Priority) -> u64 {
        let last = self.last_turns.entry(batch.to_owned()).or_default();
        *last = (*last).max(self.begun_turn) + STEP / weight(priority);
        *last
    }

    /// Remembers the turn of a scenario that a store holds.
    pub(crate) fn had_turn(&mut self, batch: &str, turn: u64, started: bool) {
        let last = self.last_turns.entry(batch.to_owned()).or_default();
        *last = (*last).max(turn);
        if started {
            self.begun_turn = self.begun_turn.max(turn);
        }
    }
}

#[cfg(test)]
mod tests {
    use socrates_model::FailureClass;
    use socrates_model::job::Stage;

    use super::*;
    use crate::Event;
    use crate::histories::replay;
    use crate::world::{World, spec};

    /// Batches of the scenarios that are begun, in their order.
    fn begun(world: &mut World, count: usize) -> String {
        let mut order = String::new();
        for _ in 0..count {
            let grant = world.grant("w", Stage::Proposal);
            order.extend(grant.spec.key.scenario.as_str().chars().next());
            // It ends at once, so that others may be begun.
            world.fail(&grant, FailureClass::Permanent, Vec::new());
        }
        order
    }

    fn specs(letter: char, count: u64) -> Vec<socrates_model::wire::ScenarioSpec> {
        let one = |number: u64| {
            let mut one = spec(&format!("{letter}{number}"));
            one.seed = number + 1_000 * u64::from(u32::from(letter));
            one
        };
        (0..count).map(one).collect()
    }

    #[test]
    fn batches_of_one_priority_are_begun_by_turns_and_each_in_its_order() {
        let mut world = World::new();
        world.submit_as("a", Priority::Normal, specs('a', 40));
        assert_eq!(begun(&mut world, 4), "aaaa");
        // A batch that comes later does not wait for all that came before, and takes no more than its share.
        world.submit_as("b", Priority::Normal, specs('b', 6));
        let order = begun(&mut world, 14);
        assert_eq!(order.matches('b').count(), 6, "{order}");
        assert!(order.starts_with("ab") || order.starts_with("ba"), "{order}");
        assert!(!order.contains("bbb") && !order.contains("aaaa"), "{order}");
        assert_eq!(begun(&mut world, 4), "aaaa");
    }

    #[test]
    fn an_urgent_batch_takes_most_turns_and_the_least_urgent_one_is_begun_too() {
        let mut world = World::new();
        world.submit_as("a", Priority::Bulk, specs('a', 30));
        world.submit_as("b", Priority::Normal, specs('b', 60));
        world.submit_as("c", Priority::Interactive, specs('c', 5));
        let order = begun(&mut world, 50);
        assert_eq!(order[..5].matches('c').count(), 5, "{order}");
        let (a, b) = (order.matches('a').count(), order.matches('b').count());
        assert!((3..=6).contains(&a) && b == 45 - a, "one in ten or eleven: {order}");
    }

    #[test]
    fn turns_outlive_a_restart() {
        let mut world = World::new();
        world.submit_as("a", Priority::Normal, specs('a', 12));
        assert_eq!(begun(&mut world, 3), "aaa");
        world.submit_as("b", Priority::Normal, specs('b', 3));
        world.state = State::restore(replay(&world.rows), world.state.policy.clone(), world.now);
        world.send(|_| Event::Recover { alone: true });
        let order = begun(&mut world, 6);
        assert_eq!(order.matches('b').count(), 3, "{order}");
    }
}
