//! A circuit for each stage: when many attempts of a stage fail in passing, it rests, and then tries with a single job, so that trying
//! again cannot make an outage worse (Nygard, Release It!, 2007).
//!
//! ```text
//! closed ── share of failures over the limit ─► open ── rest is over ─► one attempt ── succeeds ─► closed
//!                                                ▲                         │ fails
//!                                                └─────────────────────────┘
//! ```

use std::collections::VecDeque;

use crate::policy::Policy;
use crate::state::Millis;

/// Time that counts, ms, in parts of so many ms.
const WINDOW_MS: Millis = 60_000;
const PART_MS: Millis = 5_000;
/// Attempts in it below which a share means nothing.
const LEAST: u32 = 20;

/// What came of the attempts of a stage lately, and whether more are handed out.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Circuit {
    /// Parts of the window, the oldest first: number of the part, attempts, and those that failed in passing.
    parts: VecDeque<(Millis, u32, u32)>,
    stands: Stands,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Stands {
    /// Jobs are handed out.
    #[default]
    Closed,
    /// None are until then; then one.
    Open(Millis),
    /// The one is under way; where nothing is heard of it until then, another is tried.
    Trying(Millis),
}

/// How many jobs of a stage may be handed out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Allows {
    /// As many as are asked for.
    All,
    /// A single one, which shows whether it works again.
    One,
    /// None until then.
    NoneUntil(Millis),
}

impl Circuit {
    /// How many jobs may be handed out now.
    pub(crate) fn allows(&self, now: Millis) -> Allows {
        match self.stands {
            Stands::Closed => Allows::All,
            Stands::Open(until) | Stands::Trying(until) if now < until => Allows::NoneUntil(until),
            Stands::Open(_) | Stands::Trying(_) => Allows::One,
        }
    }

    /// An attempt was handed out.
    pub(crate) fn granted(&mut self, policy: &Policy, now: Millis) {
        self.part(now).1 += 1;
        if !matches!(self.stands, Stands::Closed) {
            self.stands = Stands::Trying(now.saturating_add(policy.circuit_ms));
        }
    }

    /// An attempt failed in passing.
    pub(crate) fn failed(&mut self, policy: &Policy, now: Millis) {
        self.part(now).2 += 1;
        let (attempts, failures) = self.parts.iter().fold((0, 0), |sum, part| (sum.0 + part.1, sum.1 + part.2));
        let many = attempts >= LEAST && failures * 100 > attempts * policy.circuit_percent;
        if matches!(self.stands, Stands::Trying(_)) || many && policy.circuit_percent > 0 {
            self.stands = Stands::Open(now.saturating_add(policy.circuit_ms));
        }
    }

    /// An attempt ended otherwise: the stage works.
    pub(crate) fn worked(&mut self) {
        if matches!(self.stands, Stands::Trying(_)) {
            *self = Self::default();
        }
    }

    /// The part of the window that is now; older ones are forgotten.
    fn part(&mut self, now: Millis) -> &mut (Millis, u32, u32) {
        let number = now / PART_MS;
        let first = number.saturating_sub(WINDOW_MS / PART_MS - 1);
        while self.parts.front().is_some_and(|part| part.0 < first) {
            self.parts.pop_front();
        }
        // Time never runs backwards: the newest part is this one, or it begins now.
        let part = match self.parts.pop_back() {
            Some(newest) if newest.0 == number => newest,
            earlier => {
                self.parts.extend(earlier);
                (number, 0, 0)
            }
        };
        self.parts.push_back_mut(part)
    }
}

#[cfg(test)]
mod tests {
    use socrates_model::FailureClass;
    use socrates_model::job::Stage;
    use socrates_model::wire::{Acquired, NoWork};

    use super::*;
    use crate::world::{World, spec};

    fn policy() -> Policy {
        Policy {
            circuit_percent: 20,
            circuit_ms: 30_000,
            transient_tries: 1_000,
            backoff_cap_ms: 0,
            ..Policy::default()
        }
    }

    #[test]
    fn a_share_over_the_limit_opens_it_and_one_success_closes_it() {
        let (policy, mut circuit) = (policy(), Circuit::default());
        for at in 0..30 {
            circuit.granted(&policy, at);
            if at % 5 == 4 {
                circuit.failed(&policy, at);
            }
        }
        assert_eq!(circuit.allows(30), Allows::All, "six of thirty are not more than a fifth");
        circuit.granted(&policy, 31);
        circuit.failed(&policy, 31);
        circuit.failed(&policy, 31);
        assert_eq!(circuit.allows(32), Allows::NoneUntil(30_031));
        assert_eq!(circuit.allows(30_031), Allows::One);
        circuit.granted(&policy, 30_031);
        assert_eq!(circuit.allows(30_032), Allows::NoneUntil(60_031), "one at a time");
        circuit.failed(&policy, 30_040);
        assert_eq!(circuit.allows(60_039), Allows::NoneUntil(60_040));
        circuit.granted(&policy, 60_040);
        circuit.worked();
        assert_eq!(circuit.allows(60_041), Allows::All);
    }

    #[test]
    fn what_is_long_past_and_what_is_seldom_does_not_count() {
        let (policy, mut circuit) = (policy(), Circuit::default());
        for at in 0..19 {
            circuit.granted(&policy, at);
            circuit.failed(&policy, at);
        }
        assert_eq!(circuit.allows(20), Allows::All, "nineteen are too few");
        circuit.granted(&policy, 100_000);
        circuit.failed(&policy, 100_000);
        assert_eq!(circuit.allows(100_001), Allows::All, "those were a minute ago");
        let never = Policy { circuit_percent: 0, ..policy };
        for _ in 0..100 {
            circuit.granted(&never, 100_000);
            circuit.failed(&never, 100_000);
        }
        assert_eq!(circuit.allows(100_001), Allows::All, "switched off");
    }

    #[test]
    fn an_outage_costs_few_attempts_and_ends_by_itself() {
        let attempts_in_an_outage = |policy: Policy| {
            let mut world = World::with(policy);
            let one = |number: u64| {
                let mut one = spec(&format!("s{number}"));
                one.seed = number;
                one
            };
            world.submit((0..40).map(one).collect());
            // Ten minutes of nothing but failures in passing, asked for every 100 ms.
            let mut attempts = 0;
            for _ in 0..6_000 {
                if let Acquired::Grants(grants) = world.ask("w", &[Stage::Proposal], 1) {
                    attempts += grants.len();
                    for grant in grants {
                        world.fail(&grant, FailureClass::Transient, Vec::new());
                    }
                }
                world.wait(100);
            }
            (attempts, world)
        };
        let (without, _) = attempts_in_an_outage(Policy { circuit_percent: 0, ..policy() });
        let (with, mut world) = attempts_in_an_outage(policy());
        assert!(without > 2_000 && with < 60, "{without} without, {with} with");
        // It is over: the one attempt succeeds, and everybody gets work again.
        let grant = loop {
            match world.ask("w", &[Stage::Proposal], 1) {
                Acquired::Grants(mut grants) => break grants.remove(0),
                Acquired::None { reason, .. } => assert_eq!(reason, NoWork::Throttled),
            }
            world.wait(100);
        };
        assert!(matches!(world.ask("v", &[Stage::Proposal], 1), Acquired::None { reason: NoWork::Throttled, .. }));
        world.succeed(&grant);
        assert!(matches!(world.ask("v", &[Stage::Proposal], 4), Acquired::Grants(grants) if grants.len() > 1));
    }
}
