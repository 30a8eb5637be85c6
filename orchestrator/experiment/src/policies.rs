//! Retry policies as data: each is a setting of the orchestrator's own rules, and nothing but that.

use serde::{Deserialize, Serialize};
use socrates_orchestrator::Policy;
use socrates_orchestrator::policy::AFTER_CALL_MS;

/// What an author is told of its refused answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Told {
    /// Every fault, with its place.
    Named,
    /// That the answer was wrong.
    Vague,
    /// Nothing: it is asked from the beginning, with another seed.
    None,
}

/// A retry policy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RetryPolicy {
    /// Name in tables.
    pub name: String,
    /// What it does, in a sentence.
    pub about: String,
    /// What an author is told of its refused answer.
    pub told: Told,
    /// Of the tries after a wrong answer so many at the end begin anew with another seed; all of them where nothing is told.
    pub fresh: u32,
    /// New proposals because a later stage found no answer.
    pub reproposals: u32,
    /// First pause after a passing failure, ms.
    pub pause_ms: u64,
    /// What a pause is multiplied by after every further failure: 1 keeps it, 2 doubles it.
    pub growth: u64,
    /// Longest pause, ms.
    pub cap_ms: u64,
    /// Whether a pause is drawn evenly from zero to its length.
    pub jitter: bool,
    /// Tries at a job at most, whatever `tries` of the specification says.
    pub most_tries: Option<u32>,
    /// Lease of a job, ms.
    pub lease_ms: u64,
    /// Pause between the beats of a worker, ms.
    pub beat_ms: u64,
    /// How long a worker whose token is gone may still beat, ms.
    pub grace_ms: u64,
    /// Share of a stage's attempts in a minute, percent, above which passing failures let it rest; 0 never does.
    pub circuit_percent: u32,
    /// How long it rests before one attempt is tried, ms.
    pub circuit_ms: u64,
}

/// A policy of a specification: another one, and what is different.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Tuned {
    /// The policy that it is like: one that comes with the program. Default `jitter`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub like: Option<String>,
    /// As in [`RetryPolicy`], each as in the policy that it is like.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub about: Option<String>,
    /// See [`RetryPolicy::told`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub told: Option<Told>,
    /// See [`RetryPolicy::fresh`]; 0 to 20.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fresh: Option<u32>,
    /// See [`RetryPolicy::reproposals`]; 0 to 5.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reproposals: Option<u32>,
    /// See [`RetryPolicy::pause_ms`]; at most an hour.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pause_ms: Option<u64>,
    /// See [`RetryPolicy::growth`]; 1 to 10.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub growth: Option<u64>,
    /// See [`RetryPolicy::cap_ms`]; at most an hour.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cap_ms: Option<u64>,
    /// See [`RetryPolicy::jitter`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jitter: Option<bool>,
    /// See [`RetryPolicy::most_tries`]; 1 to 20.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub most_tries: Option<u32>,
    /// See [`RetryPolicy::lease_ms`]; 1 000 to an hour.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lease_ms: Option<u64>,
    /// See [`RetryPolicy::beat_ms`]; 100 to the lease.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beat_ms: Option<u64>,
    /// See [`RetryPolicy::grace_ms`]; at most an hour.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grace_ms: Option<u64>,
    /// See [`RetryPolicy::circuit_percent`]; 0 to 100.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub circuit_percent: Option<u32>,
    /// See [`RetryPolicy::circuit_ms`]; 1 to an hour.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub circuit_ms: Option<u64>,
}

/// What a shipped policy does, and how it differs from the plainest one.
struct Shipped {
    name: &'static str,
    about: &'static str,
    told: Told,
    /// Fresh beginnings at the end, new proposals.
    ladder: (u32, u32),
    /// First pause, growth, jitter.
    pause: (u64, u64, bool),
    most_tries: Option<u32>,
}

/// Every policy that comes with the program.
const SHIPPED: &[Shipped] = &[
    Shipped {
        name: "none",
        about: "Every job is tried once.",
        told: Told::None,
        ladder: (0, 0),
        pause: (0, 1, false),
        most_tries: Some(1),
    },
    Shipped {
        name: "immediate",
        about: "Tried again at once; a wrong answer is asked for anew, and nothing is said of it.",
        told: Told::None,
        ladder: (0, 0),
        pause: (0, 1, false),
        most_tries: None,
    },
    Shipped {
        name: "fixed",
        about: "As `immediate`, with two seconds before every try after a passing failure.",
        told: Told::None,
        ladder: (0, 0),
        pause: (2_000, 1, false),
        most_tries: None,
    },
    Shipped {
        name: "exponential",
        about: "As `immediate`, with half a second that doubles with every passing failure, up to a minute.",
        told: Told::None,
        ladder: (0, 0),
        pause: (500, 2, false),
        most_tries: None,
    },
    Shipped {
        name: "jitter",
        about: "As `exponential`, each pause drawn evenly from zero to its length (full jitter).",
        told: Told::None,
        ladder: (0, 0),
        pause: (500, 2, true),
        most_tries: None,
    },
    Shipped {
        name: "vague",
        about: "As `jitter`; a wrong answer is asked about again with the words that it was wrong.",
        told: Told::Vague,
        ladder: (0, 0),
        pause: (500, 2, true),
        most_tries: None,
    },
    Shipped {
        name: "feedback",
        about: "As `jitter`; a wrong answer is asked about again with every fault and its place. The same faults twice in a row end the job.",
        told: Told::Named,
        ladder: (0, 0),
        pause: (500, 2, true),
        most_tries: None,
    },
    Shipped {
        name: "ladder",
        about: "As `feedback`; the last try begins anew with another seed, and then one new proposal is made. What `socrates run` does.",
        told: Told::Named,
        ladder: (1, 1),
        pause: (500, 2, true),
        most_tries: None,
    },
];

/// The policy that a specification's own are like unless they say otherwise.
const USUAL: &str = "jitter";
/// Longest pause or lease that can be asked for, ms.
const HOUR_MS: u64 = 3_600_000;

/// Names of the policies that come with the program, in order.
#[must_use]
pub fn names() -> Vec<&'static str> {
    SHIPPED.iter().map(|shipped| shipped.name).collect()
}

/// The policy of this name that comes with the program.
#[must_use]
pub fn shipped(name: &str) -> Option<RetryPolicy> {
    let found = SHIPPED.iter().find(|shipped| shipped.name == name)?;
    let usual = Policy::default();
    Some(RetryPolicy {
        name: found.name.to_owned(),
        about: found.about.to_owned(),
        told: found.told,
        fresh: found.ladder.0,
        reproposals: found.ladder.1,
        pause_ms: found.pause.0,
        growth: found.pause.1,
        cap_ms: usual.backoff_cap_ms,
        jitter: found.pause.2,
        most_tries: found.most_tries,
        lease_ms: usual.lease_ms,
        beat_ms: usual.beat_ms,
        grace_ms: usual.grace_ms,
        circuit_percent: usual.circuit_percent,
        circuit_ms: usual.circuit_ms,
    })
}

impl Tuned {
    /// The whole policy of this name.
    ///
    /// # Errors
    /// One line for each value that cannot be taken: key, value, what is allowed.
    pub fn whole(&self, name: &str) -> Result<RetryPolicy, Vec<String>> {
        let like = self.like.as_deref().unwrap_or(USUAL);
        let Some(base) = shipped(like) else {
            return Err(vec![format!("`policy.{name}.like` is `{like}`; there is {}", names().join(", "))]);
        };
        let whole = RetryPolicy {
            name: name.to_owned(),
            about: self.about.clone().unwrap_or(base.about),
            told: self.told.unwrap_or(base.told),
            fresh: self.fresh.unwrap_or(base.fresh),
            reproposals: self.reproposals.unwrap_or(base.reproposals),
            pause_ms: self.pause_ms.unwrap_or(base.pause_ms),
            growth: self.growth.unwrap_or(base.growth),
            cap_ms: self.cap_ms.unwrap_or(base.cap_ms),
            jitter: self.jitter.unwrap_or(base.jitter),
            most_tries: self.most_tries.or(base.most_tries),
            lease_ms: self.lease_ms.unwrap_or(base.lease_ms),
            beat_ms: self.beat_ms.unwrap_or(base.beat_ms),
            grace_ms: self.grace_ms.unwrap_or(base.grace_ms),
            circuit_percent: self.circuit_percent.unwrap_or(base.circuit_percent),
            circuit_ms: self.circuit_ms.unwrap_or(base.circuit_ms),
        };
        let limits = [
            ("fresh", u64::from(whole.fresh), 0, 20),
            ("reproposals", u64::from(whole.reproposals), 0, 5),
            ("pause_ms", whole.pause_ms, 0, HOUR_MS),
            ("growth", whole.growth, 1, 10),
            ("cap_ms", whole.cap_ms, 0, HOUR_MS),
            ("most_tries", u64::from(whole.most_tries.unwrap_or(1)), 1, 20),
            ("lease_ms", whole.lease_ms, 1_000, HOUR_MS),
            ("beat_ms", whole.beat_ms, 100, whole.lease_ms),
            ("grace_ms", whole.grace_ms, 0, HOUR_MS),
            ("circuit_percent", u64::from(whole.circuit_percent), 0, 100),
            ("circuit_ms", whole.circuit_ms, 1, HOUR_MS),
        ];
        let wrong = limits.iter().filter(|(_, value, least, most)| value < least || value > most);
        let told: Vec<String> = wrong
            .map(|(key, value, least, most)| format!("`policy.{name}.{key}` is `{value}`; allowed: {least} to {most}"))
            .collect();
        if told.is_empty() { Ok(whole) } else { Err(told) }
    }
}

impl RetryPolicy {
    /// The same as a table of a specification, with every value.
    #[must_use]
    pub fn tuned(&self) -> Tuned {
        Tuned {
            like: None,
            about: Some(self.about.clone()),
            told: Some(self.told),
            fresh: Some(self.fresh),
            reproposals: Some(self.reproposals),
            pause_ms: Some(self.pause_ms),
            growth: Some(self.growth),
            cap_ms: Some(self.cap_ms),
            jitter: Some(self.jitter),
            most_tries: self.most_tries,
            lease_ms: Some(self.lease_ms),
            beat_ms: Some(self.beat_ms),
            grace_ms: Some(self.grace_ms),
            circuit_percent: Some(self.circuit_percent),
            circuit_ms: Some(self.circuit_ms),
        }
    }

    /// Tries at a job, of those that a specification allows.
    #[must_use]
    pub fn tries(&self, allowed: u32) -> u32 {
        allowed.min(self.most_tries.unwrap_or(allowed)).max(1)
    }

    /// The orchestrator's policy, with so many tries of each job and class of failure; `call_ms` is the longest call of an
    /// author.
    #[must_use]
    pub fn of_orchestrator(&self, allowed: u32, call_ms: u64) -> Policy {
        let again = self.tries(allowed).saturating_sub(1);
        let fresh = if self.told == Told::None { again } else { self.fresh.min(again) };
        let reproposals = if again == 0 { 0 } else { self.reproposals };
        Policy {
            lease_ms: self.lease_ms,
            beat_ms: self.beat_ms,
            grace_ms: self.grace_ms,
            circuit_percent: self.circuit_percent,
            circuit_ms: self.circuit_ms,
            author_deadline_ms: call_ms.saturating_add(AFTER_CALL_MS).max(Policy::default().author_deadline_ms),
            transient_tries: again,
            late_tries: again,
            overload_tries: again,
            unparsable_tries: again,
            feedback_tries: again - fresh,
            reseeds: fresh,
            lapses: again.saturating_add(1),
            repairs: reproposals,
            reproposals,
            backoff_ms: self.pause_ms,
            backoff_growth: self.growth,
            backoff_jitter: self.jitter,
            backoff_cap_ms: self.cap_ms,
            ..Policy::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shipped_policies_are_settings_of_the_orchestrator() {
        let of = |name: &str, tries: u32| shipped(name).unwrap().of_orchestrator(tries, 90_000);
        let none = of("none", 8);
        assert_eq!((none.transient_tries, none.feedback_tries, none.reseeds, none.lapses), (0, 0, 0, 1));
        let blind = of("fixed", 4);
        assert_eq!((blind.feedback_tries, blind.reseeds, blind.lapses), (0, 3, 4));
        assert_eq!((blind.backoff_ms, blind.backoff_growth, blind.backoff_jitter), (2_000, 1, false));
        let ladder = of("ladder", 4);
        // What the program does by itself: two asks with the reasons, one with another seed, one new proposal.
        let usual = Policy::default();
        assert_eq!((ladder.feedback_tries, ladder.reseeds), (usual.feedback_tries, usual.reseeds));
        assert_eq!(ladder.reproposals, usual.reproposals);
        assert_eq!((ladder.backoff_ms, ladder.backoff_jitter), (usual.backoff_ms, usual.backoff_jitter));
        assert_eq!(of("ladder", 1).reproposals, 0, "a job that is tried once is proposed once");
    }

    #[test]
    fn a_policy_of_ones_own_is_another_with_changes_and_wrong_values_are_named() {
        let own = Tuned { like: Some("feedback".to_owned()), lease_ms: Some(60_000), ..Tuned::default() };
        let whole = own.whole("patient").unwrap();
        assert_eq!((whole.name.as_str(), whole.told, whole.lease_ms), ("patient", Told::Named, 60_000));
        assert_eq!(whole.tuned().whole("patient").unwrap(), whole, "written out it is the same");
        let wrong = Tuned { like: None, growth: Some(0), beat_ms: Some(20_000), ..Tuned::default() };
        let told = wrong.whole("odd").unwrap_err().join("\n");
        for part in ["`policy.odd.growth` is `0`; allowed: 1 to 10", "`policy.odd.beat_ms` is `20000`"] {
            assert!(told.contains(part), "{told}");
        }
        let unknown = Tuned { like: Some("hedged".to_owned()), ..Tuned::default() };
        assert!(unknown.whole("x").unwrap_err().concat().contains("there is none, immediate"));
    }
}
