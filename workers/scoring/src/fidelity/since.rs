//! From when on a clause counts that tells of a reaction: from the first time its reason holds. Whatever somebody does
//! before, such as waiting behind a closed door until it is time to set off, is no reaction.

use socrates_model::{Action, AgentId, HumanId, Rule, Trigger};

use crate::fidelity::acts::spans;
use crate::fidelity::finding::Finding;
use crate::fidelity::reactions::{EARLY_SECS, first_reason, has_onset, never_came};
use crate::fidelity::signals::{Moment, Signals};
use crate::fidelity::windows::Mark;

/// When a reason first holds, with what it is in words.
#[derive(Debug, Clone, PartialEq)]
pub struct Since {
    t: f64,
    phrase: Option<String>,
}

impl Since {
    /// Counts from the beginning: what nothing has to come before.
    const START: Self = Self { t: f64::NEG_INFINITY, phrase: None };

    /// When the reason first holds, s; negative infinity where there is none.
    #[must_use]
    pub const fn secs(&self) -> f64 {
        self.t
    }

    /// Whether something has to come before it.
    #[must_use]
    pub(super) const fn is_reaction(&self) -> bool {
        self.phrase.is_some()
    }

    /// Whether a time counts: a tree reads the tick before, so that an act may begin a moment sooner.
    #[must_use]
    pub(super) fn counts(&self, t: f64) -> bool {
        t >= self.t - EARLY_SECS
    }

    /// The marks that count.
    pub(super) fn marks(&self, marks: Vec<Mark>) -> Vec<Mark> {
        marks.into_iter().filter(|mark| self.counts(mark.t)).collect()
    }

    /// The moments that count.
    pub(super) fn moments<'a>(&self, moments: &'a [Moment]) -> &'a [Moment] {
        let from = moments.partition_point(|moment| !self.counts(moment.t));
        moments.get(from..).unwrap_or_default()
    }

    /// The finding with its reason in the evidence.
    pub(super) fn told(&self, mut found: Finding) -> Finding {
        if let Some(phrase) = &self.phrase {
            found.evidence.push_str(&format!(", counted from {:.1} s ({phrase})", self.t.max(0.0)));
        }
        found
    }

    /// The finding that nothing was done: with when there was reason for it, and what the human's tree played then.
    pub(super) fn undone(&self, signals: &Signals<'_>, human: HumanId, mut found: Finding) -> Finding {
        let Some(phrase) = &self.phrase else { return found };
        let (from, to) = (self.t - EARLY_SECS, self.t + EARLY_SECS);
        let played = signals.leaves_of(human).iter().rfind(|span| span.from_s <= to && span.to_s > from);
        let played = played.map_or_else(String::new, |span| format!("; their tree plays `{}` then", span.name));
        found.evidence.push_str(&format!(": the reason for it ({phrase}) came at {:.1} s{played}", self.t.max(0.0)));
        found
    }
}

/// From when on a deed of a human counts: from the first reason of a rule that has it. A human without such a rule, one
/// whose place it is to stand there, and a rule that always holds are counted from the beginning.
///
/// # Errors
/// The finding that the reason never came.
pub fn since(signals: &Signals<'_>, human: HumanId, of: impl Fn(&Rule) -> bool) -> Result<Since, Finding> {
    let Some(person) = signals.evidence.proposal.and_then(|proposal| proposal.human(human)) else {
        return Ok(Since::START);
    };
    let stands = person.relation.stands();
    let rules: Vec<&Rule> = person.rules.iter().filter(|rule| of(rule)).collect();
    if rules.is_empty() || stands && rules.iter().all(|rule| rule.act == Action::StandStill && rule.gesture.is_none()) {
        return Ok(Since::START);
    }
    if signals.of(human).is_empty() || rules.iter().any(|rule| rule.when.iter().all(|when| *when == Trigger::Always)) {
        return Ok(Since::START);
    }
    let reasons = rules.iter().map(|rule| (first_reason(signals, human, &rule.when), *rule));
    let came = reasons.clone().filter_map(|(reason, rule)| Some((reason.ok()?, rule)));
    if let Some((t, rule)) = came.min_by(|a, b| a.0.total_cmp(&b.0)) {
        return Ok(Since { t, phrase: Some(Trigger::phrases(&rule.when)) });
    }
    let nearest = reasons.filter_map(|(reason, rule)| Some((reason.err()?, rule)));
    let Some((near, rule)) = nearest.max_by(|a, b| a.0.margin.total_cmp(&b.0.margin)) else { return Ok(Since::START) };
    Err(never_came(signals, human, &rule.when, near))
}

/// [`since`] for an act. What is done although its reason never came was done too early.
pub(super) fn since_act(signals: &Signals<'_>, human: HumanId, act: &Action) -> Result<Since, Finding> {
    since(signals, human, |rule| rule.act == *act).map_err(|never| {
        match spans(signals, human, act).first().filter(|_| has_onset(act)) {
            Some((from, _)) => {
                let text = format!("{human} {} at {from:.1} s; {}", act.phrase(), never.evidence);
                Finding::fails(never.margin, vec![*from], text).too_early()
            }
            None => never,
        }
    })
}

/// [`since`] for following.
pub(super) fn since_follows(signals: &Signals<'_>, follower: AgentId, leader: AgentId) -> Result<Since, Finding> {
    let AgentId::Human(human) = follower else { return Ok(Since::START) };
    let act = match leader {
        AgentId::Robot => Action::FollowRobot,
        AgentId::Human(led) => Action::FollowHuman(led),
    };
    since_act(signals, human, &act)
}
