//! When something begins and ends: what the conditions of a clause wait for, and what of the clause goes with what is said of it.

use std::ops::Range;

use socrates_model::statement::Background;

use crate::clause::{Clause, Condition, Join, Predicate, Tie};
use crate::maker::Maker;
use crate::noun::{Head, Noun, Pick};
use crate::parser::names_somebody;
use crate::rows::{Act, Cue, Frame, Part};
use crate::statement::{Deed, Named, Reason, Says};

/// Why an amount of what the robot does is not played.
const UP_TO_PLANNER: &str = "how far and how long the robot does something is up to its planner";

/// When something begins and ends, and the tokens that say so.
#[derive(Default)]
pub(crate) struct Times {
    pub(crate) when: Vec<Reason<Named>>,
    pub(crate) until: Vec<Reason<Named>>,
    pub(crate) turned: bool,
    /// What the same people do then: `stops before walking on`.
    pub(crate) then: Vec<Clause>,
    pub(crate) used: Vec<Range<usize>>,
}

/// A clause with what its conditions came to.
pub(crate) struct Whole<'a> {
    pub(crate) clause: &'a Clause,
    pub(crate) when: &'a [Reason<Named>],
    pub(crate) until: &'a [Reason<Named>],
    /// Whether a denial and an `until` make an act that comes then.
    pub(crate) turned: bool,
}

impl Whole<'_> {
    /// `the second does`: what was asked for, or done, before.
    pub(crate) fn answer(&self, who: Named, does: bool) -> Deed<Named> {
        let (when, until) = (self.when.to_vec(), self.until.to_vec());
        Deed { not: !does, when, until, obeys: true, ..Deed::of(who, Act::Navigate) }
    }

    pub(crate) fn deed(&self, who: Named, act: Act, said: &Predicate, frame: &Frame) -> Deed<Named> {
        let clause = self.clause;
        let mut when = self.when.to_vec();
        if let Some(m) = clause.within_m.map(|m| m.value) {
            match when.iter_mut().find(|reason| matches!(reason.cue, Cue::Near | Cue::Visible | Cue::Blocking)) {
                Some(reason) => reason.amount = reason.amount.or(Some(m)),
                None => when.push(Reason { who: None, cue: Cue::Near, sign: None, amount: Some(m) }),
            }
        }
        if let Some(secs) = clause.after_s.map(|secs| secs.value) {
            when.push(Reason { who: None, cue: Cue::After, sign: None, amount: Some(secs) });
        }
        let none = clause.subject.iter().all(|noun| noun.pick == Pick::None) && !clause.subject.is_empty();
        let not = (said.not || none) && !self.turned && (frame.denied.is_none() || none);
        let whom = None;
        let until = self.until.to_vec();
        let ongoing = said.ongoing;
        Deed {
            ongoing,
            never: not && clause.never,
            who,
            act,
            whom,
            not,
            when,
            until,
            for_s: clause.lasts_s.map(|secs| secs.value),
            says: said.sign,
            obeys: frame.obeys,
            then: clause.join == Join::Then,
        }
    }
}

impl Maker<'_> {
    /// When a clause begins and ends, by its conditions.
    pub(crate) fn times(&mut self, clause: &Clause) -> Times {
        let mut times = Times::default();
        let stays = |act: &Predicate| self.lexicon.frames.get(act.row).is_some_and(|frame| frame.denied.is_some());
        let denied = clause.acts.first().is_some_and(|act| act.not && !stays(act));
        // `stops on sight of the robot`
        let frame = |act: &Predicate| self.lexicon.frames.get(act.row);
        let done = clause.acts.iter().position(|act| frame(act).is_some_and(|frame| frame.act.is_some()));
        for act in clause.acts.iter().skip(done.map_or(clause.acts.len(), |done| done + 1)).filter(|act| !act.not) {
            let cue = frame(act).filter(|frame| !frame.plain && frame.act.is_none() && frame.relate.is_none());
            if let Some(cue) = cue.and_then(|frame| frame.cue).filter(|_| act.sign.is_none()) {
                times.when.push(Reason { who: None, cue, sign: None, amount: clause.within_m.map(|m| m.value) });
            }
        }
        for condition in &clause.conditions {
            let found = self.reason(condition, &clause.subject);
            self.introduce(&condition.clause);
            if found.is_some() {
                // `as the robot comes to the intersection` tells where it is then; `as it wants to get in`, where it goes.
                let part = |act: &Predicate| {
                    self.lexicon.frames.get(act.row).is_some_and(|frame| frame.part == Some(Part::There))
                };
                let robot = condition.clause.subject.iter().any(|noun| self.is_robot(noun, &condition.clause));
                // `while it drives from the ward to the exit`
                let drives = condition.tie == Tie::While && condition.clause.places.iter().any(|at| at.from);
                self.places(&condition.clause, robot && (drives || condition.clause.acts.iter().any(part)));
                self.rest(&condition.clause, false);
            }
            let (reason, tokens) = found.map_or((None, Vec::new()), |(reason, tokens)| (Some(reason), tokens));
            // Whoever is waited for makes the sign.
            if let Some(Reason { who: Some(who), cue: Cue::Says, sign: Some(sign), .. }) = &reason {
                let deed = Deed { says: Some(*sign), ..Deed::of(who.clone(), Act::Sign) };
                self.say(condition.clause.tokens.clone(), Says::Do(deed));
            }
            match (reason, condition.tie) {
                (Some(reason), Tie::When | Tie::While | Tie::After) => times.when.push(reason),
                // `does not move until`: moves then.
                (Some(reason), Tie::Until | Tie::Before | Tie::Unless) if denied => {
                    times.when.push(reason);
                    times.turned = true;
                }
                // `blocks it unless it asks` is done until then.
                (Some(reason), Tie::Until | Tie::Unless) => times.until.push(reason),
                (_, Tie::Before)
                    if condition.clause.subject.is_empty() || condition.clause.subject == clause.subject =>
                {
                    let subject = clause.subject.clone();
                    times.then.push(Clause { subject, join: Join::Then, ..condition.clause.clone() });
                    continue;
                }
                (Some(_), Tie::Before) | (None, _) => {
                    self.beside(condition);
                    continue;
                }
            }
            times.used.extend(tokens);
        }
        times
    }

    /// What a condition waits for, and the tokens that say it.
    pub(crate) fn reason(&self, condition: &Condition, subject: &[Noun]) -> Option<(Reason<Named>, Vec<Range<usize>>)> {
        let clause = &condition.clause;
        let none = Reason { who: None, cue: Cue::Near, sign: None, amount: clause.within_m.map(|m| m.value) };
        let robot = clause.subject.iter().any(|noun| self.is_robot(noun, clause));
        let own = clause.subject.is_empty() || clause.subject == subject || !clause.own;
        let mut tokens: Vec<Range<usize>> =
            clause.subject.iter().chain(&clause.agent).map(|noun| noun.tokens.clone()).collect();
        tokens.extend(clause.within_m.map(|m| m.from..m.to));
        tokens.push(clause.tokens.start..clause.tokens.start + 1);
        // `when the visitor hears the nurse say that`: when she says it.
        let hears = |act: &&Predicate| {
            self.lexicon.frames.get(act.row).is_some_and(|frame| frame.cue == Some(Cue::Says) && !frame.asks)
        };
        if let Some(hears) = clause.acts.iter().find(hears).filter(|_| !robot) {
            let who = hears.object.clone().filter(names_somebody).map(|noun| vec![noun]);
            let sign = clause.acts.iter().find_map(|act| act.sign);
            tokens.extend(clause.acts.iter().map(|act| act.tokens.clone()));
            return Some((Reason { who, cue: Cue::Says, sign, ..none }, tokens));
        }
        // Of several acts the last is waited for: those before it tell who.
        for act in clause.acts.iter().rev() {
            let frame = self.lexicon.frames.get(act.row)?;
            let by_robot = if act.passive { clause.agent.as_ref().is_none_or(Noun::may_be_robot) } else { robot };
            tokens.push(act.tokens.clone());
            if frame.asks || act.sign.is_some() {
                let who = if by_robot || own { None } else { Some(clause.subject.clone()) };
                return Some((Reason { who, cue: Cue::Says, sign: act.sign, ..none }, tokens));
            }
            let about = act.object.as_ref().is_none_or(|object| !matches!(object.head, Head::Role(_) | Head::Name(_)));
            // `while the robot drives along`: as long as it moves.
            let drives = frame.plain && frame.goes && condition.tie == Tie::While;
            let cue = if by_robot {
                frame.robot_cue.or_else(|| drives.then_some(Cue::Moving))
            } else {
                frame.cue.filter(|_| about)
            };
            if let Some(cue) = cue {
                return Some((Reason { cue, ..none }, tokens));
            }
            if !frame.plain {
                tokens.pop();
            }
        }
        let alone = clause.acts.is_empty();
        // `when it does`: what was asked for, or said, just before.
        if clause.does == Some(true) && alone && robot {
            return Some((Reason { cue: Cue::Says, ..none }, tokens));
        }
        if let Some(secs) = clause.lasts_s.or(clause.after_s).filter(|_| alone) {
            tokens.push(secs.from..secs.to);
            return Some((Reason { cue: Cue::After, amount: Some(secs.value), ..none }, tokens));
        }
        (clause.within_m.is_some() && alone).then_some((none, tokens))
    }

    /// Whoever is named in a condition is there.
    pub(crate) fn introduce(&mut self, clause: &Clause) {
        let objects = clause.acts.iter().flat_map(|act| act.object.iter().chain(&act.owner));
        let named = objects.chain(&clause.subject).filter(|noun| matches!(noun.head, Head::Role(_) | Head::Name(_)));
        self.are_there(named.cloned().collect());
        // Of somebody who is new, what is waited for tells as well how they come.
        let new = clause.subject.iter().all(|noun| matches!(noun.pick, Pick::Some | Pick::Another));
        let before = clause.acts.split_last().map_or(&[][..], |(_, before)| before);
        let tells = if new { &clause.acts[..] } else { before };
        let robot = clause.subject.iter().any(Noun::may_be_robot);
        for act in tells.iter().filter(|act| !robot && !act.not) {
            if let Some(relation) = self.lexicon.frames.get(act.row).and_then(|frame| frame.relate) {
                self.say(act.tokens.clone(), Says::Relate(clause.subject.clone(), Some(relation), None));
            }
        }
    }

    /// Says what goes with what was said of a clause since a statement: whose it is, when, how long. What nothing was made of
    /// stays without a statement, and is not read.
    pub(crate) fn with_the_rest(
        &mut self,
        clause: &Clause,
        start: usize,
        when: &[Reason<Named>],
        used: Vec<Range<usize>>,
    ) {
        let own = self.found.get(start..).unwrap_or_default();
        let any = own.iter().any(|own| !matches!(own.says, Says::NotRead));
        let done = own.iter().any(|own| matches!(own.says, Says::Do(_)));
        let then = own.iter().any(|own| matches!(own.says, Says::Then(..)));
        // Whoever is met is met as the robot comes by: such a reason holds of where somebody comes from as well.
        let met = when.iter().all(|reason| !matches!(reason.cue, Cue::After | Cue::Says | Cue::Passed));
        if done || clause.acts.iter().any(|act| act.not) {
            for tokens in &clause.denials {
                self.goes(tokens.clone());
            }
        }
        // `the robot can't get through`: nobody has to do anything about it.
        let robot = !clause.subject.is_empty() && clause.subject.iter().all(|noun| self.is_robot(noun, clause));
        if robot && !any {
            for tokens in clause.subject.iter().map(|noun| &noun.tokens).chain(&clause.denials) {
                self.say(tokens.clone(), Says::Background(Background::Errand));
            }
        }
        if any {
            self.nouns_go(&clause.subject);
            self.nouns_go(clause.agent.as_slice());
            for tokens in &clause.goes {
                self.goes(tokens.clone());
            }
        }
        let amounts_of_robot = [clause.lasts_s, clause.after_s, clause.within_m].into_iter().flatten();
        for amount in amounts_of_robot.filter(|_| robot && !done && !then) {
            self.say(amount.from..amount.to, Says::NotPlayed(UP_TO_PLANNER.to_owned()));
        }
        if done || then || met {
            for tokens in used {
                self.goes(tokens);
            }
        }
        let amounts = [
            clause.lasts_s.filter(|_| done),
            clause.after_s.filter(|_| done),
            clause.within_m.filter(|_| done || then),
        ];
        for amount in amounts.into_iter().flatten() {
            self.goes(amount.from..amount.to);
        }
    }
}
