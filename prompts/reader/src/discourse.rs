//! Pass 6: who is meant. Statements of noun phrases become statements of people, in the order of the text; what they react to, and
//! what was asked for.

use std::ops::Range;

use socrates_model::Gesture;

use crate::cast::{ANYBODY, Cast, People};
use crate::noun::Head;
use crate::rows::{Act, Cue};
use crate::statement::{Deed, Named, Reason, Says, Statement};

/// Statements of people, and the role of everybody.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Told {
    /// How many of them were known before the text.
    pub(crate) known: usize,
    pub(crate) roles: Vec<String>,
    /// Those of whom is spoken in general, without a number: `people step in front of it`.
    pub(crate) vague: People,
    /// Those who are named without an article or a number: `blind corner, startled pedestrian`.
    pub(crate) plain: People,
    pub(crate) statements: Vec<Statement<People>>,
    /// Tokens of which it is not sure whom or what they mean, whatever was made of them.
    pub(crate) doubts: Vec<Range<usize>>,
}

/// Finds out who is meant, of those who are known and those whom the text names.
pub(crate) fn told(statements: &[Statement<Named>], mut cast: Cast) -> Told {
    let known = cast.roles.len();
    let mut told = Vec::new();
    for statement in statements {
        cast.begin(statement);
        let says = cast.says(&statement.says);
        if matches!(says, Some(Says::Then(_, true))) {
            let before = cast.waiting.replace(statement.tokens.clone());
            cast.doubts.extend(before);
        }
        if let Some(says) = says {
            let Statement { tokens, first, tells, partly, asks, .. } = statement;
            let (partly, first, tells, asks) = (*partly, *first, *tells, *asks);
            told.push(Statement { partly, tokens: tokens.clone(), first, tells, asks, says });
        }
    }
    cast.doubts.extend(cast.waiting.take());
    let Cast { roles, vague, plain, doubts, .. } = cast;
    let told = Told { known, roles, vague, plain, statements: told, doubts };
    Told { statements: doubted(&told), ..told }
}

/// The statements of a text, and that those are not read that name somebody of whom nothing else is told, where of others
/// something is: mostly they are somebody else who was not made out.
fn doubted(told: &Told) -> Vec<Statement<People>> {
    let known = |person: usize| {
        told.statements.iter().map(|statement| &statement.says).any(|says| {
            let of = !matches!(says, Says::Introduce(_)) && people_of(says).contains(&person);
            of || with_whom(says).is_some_and(|whom| whom.contains(&person))
        })
    };
    // Somebody of no role among others who have one was mostly not made out.
    let anybody = |person: &usize| told.roles.get(*person).is_some_and(|role| ANYBODY.contains(&role.as_str()));
    let all_anybody = (0..told.roles.len()).all(|person| anybody(&person));
    let unknown: People =
        (told.known..told.roles.len()).filter(|person| !known(*person) || anybody(person) && !all_anybody).collect();
    let mut all = told.statements.clone();
    all.extend(opposites(told));
    if unknown.len() < told.roles.len() {
        for person in unknown {
            // Where they are named; somebody who is nowhere named, where they are first told of.
            let of = |statement: &&Statement<People>| people_of(&statement.says).contains(&person);
            let named = |statement: &&Statement<People>| matches!(&statement.says, Says::Introduce(_));
            let first = told.statements.iter().filter(of).find(named).or_else(|| told.statements.iter().find(of));
            all.extend(first.map(|statement| Statement { says: Says::NotRead, ..statement.clone() }));
        }
    }
    all
}
/// Of whom something is said.
fn people_of(says: &Says<People>) -> &[usize] {
    match says {
        Says::Introduce(who)
        | Says::Noted(who)
        | Says::Walks(who)
        | Says::Relate(who, ..)
        | Says::Group(who)
        | Says::After(_, who)
        | Says::Queue(who)
        | Says::Twice(who, _)
        | Says::Pace(who, _) => who,
        Says::Do(deed) => &deed.who,
        Says::RobotSays(..)
        | Says::Then(..)
        | Says::RobotFirst(_)
        | Says::From(..)
        | Says::Happens(..)
        | Says::There
        | Says::GoalThere
        | Says::RobotVia(_)
        | Says::RobotStart(_)
        | Says::RobotGoal(_)
        | Says::Background(_)
        | Says::Goes
        | Says::NotPlayed(_)
        | Says::NotRead => &[],
    }
}

/// With whom or to whom something is done.
fn with_whom(says: &Says<People>) -> Option<&People> {
    if let Says::Do(deed) = says {
        deed.whom.as_ref()
    } else if let Says::RobotSays(_, whom) = says {
        whom.as_ref()
    } else {
        None
    }
}

/// Statements that somebody does what they never do, or do not do and do whatever happens: the later one of two is not played.
fn opposites(told: &Told) -> Vec<Statement<People>> {
    let deed =
        |statement: &Statement<People>| if let Says::Do(deed) = &statement.says { Some(deed.clone()) } else { None };
    let deeds: Vec<(&Statement<People>, Deed<People>)> =
        told.statements.iter().filter_map(|statement| Some((statement, deed(statement)?))).collect();
    let mut found = Vec::new();
    for (at, (statement, later)) in deeds.iter().enumerate() {
        let opposite = deeds.iter().take(at).any(|(_, before)| {
            let (denied, done) = if before.not { (before, later) } else { (later, before) };
            let always = denied.when.is_empty() && done.when.is_empty() && done.until.is_empty();
            before.act == later.act
                && before.not != later.not
                && before.act != Act::Sign
                && later.who.iter().any(|person| before.who.contains(person))
                && (denied.never || always)
        });
        if opposite {
            let why = "the text says the opposite as well".to_owned();
            found.push(Statement { says: Says::NotPlayed(why), ..(*statement).clone() });
        }
    }
    found
}

impl Cast {
    pub(crate) fn begin(&mut self, statement: &Statement<Named>) {
        if !self.fresh.is_empty() {
            self.unnamed = std::mem::take(&mut self.fresh);
        }
        if statement.first {
            self.unnamed.clear();
            self.doubts.extend(self.waiting.take());
            // A sign is answered in the next sentence as well.
            self.pending.retain(|reason| reason.cue == Cue::Says);
        }
        self.tells = statement.tells;
        self.exact = false;
        self.asks = statement.asks;
    }

    pub(crate) fn says(&mut self, says: &Says<Named>) -> Option<Says<People>> {
        Some(match says {
            Says::Introduce(who) => {
                // `three people get out, a cleaner, a doctor and a visitor`
                let count: u32 = who.iter().map(|noun| noun.count.unwrap_or(1)).sum();
                let all = who.len() > 1 && u32::try_from(self.unnamed.len()) == Ok(count);
                self.exact = all && self.tells;
                self.tells |= all && self.anybody(&self.unnamed);
                Says::Introduce(self.people(who))
            }
            Says::Relate(who, relation, side) => {
                if relation.is_some() {
                    self.related = *relation;
                }
                let who = self.people(who);
                if let Some(relation) = relation {
                    self.relations.extend(who.iter().map(|person| (*person, *relation)));
                }
                if relation.is_some_and(|relation| !relation.stands()) && self.met.1 != who {
                    self.met = (std::mem::take(&mut self.met.1), who.clone());
                }
                Says::Relate(who, *relation, *side)
            }
            Says::Noted(who) => Says::Noted(self.people(who)),
            // `it signals him to go ahead, and he walks`: as he was told.
            Says::Walks(who) if self.asked == Some(Gesture::Proceed) && self.pending.iter().any(is_word) => {
                let deed = self.deed(&Deed::of(who.clone(), Act::Navigate));
                Says::Do(deed)
            }
            Says::Walks(who) => Says::Walks(self.people(who)),
            Says::Group(who) => Says::Group(self.people(who)),
            Says::Queue(who) => Says::Queue(self.people(who)),
            Says::Twice(who, place) => Says::Twice(self.people(who), *place),
            Says::Pace(who, mps) => Says::Pace(self.active(who), *mps),
            // `a second one does so`: stands to the robot's way as the first does.
            Says::Do(deed)
                if deed.obeys
                    && !deed.not
                    && deed.when.is_empty()
                    && self.asked.is_none()
                    && self.related.is_some() =>
            {
                Says::Relate(self.people(&deed.who), self.related, None)
            }
            // Of nothing that was asked for, and nothing that was done, nobody does the same.
            Says::Do(deed) if deed.obeys && self.asked.is_none() && self.done.is_none() && deed.when.is_empty() => {
                Says::NotRead
            }
            Says::Do(deed) => {
                self.related = None;
                let deed = self.deed(deed);
                // Of nobody nothing can be played.
                match (deed.who.is_empty(), deed.not) {
                    (false, _) => Says::Do(deed),
                    (true, true) => Says::Noted(People::new()),
                    (true, false) => Says::NotRead,
                }
            }
            Says::RobotSays(sign, to) => {
                let to = to.as_ref().map(|to| self.people(to));
                self.asked = sign.or(self.asked);
                self.signed = None;
                self.pending = vec![Reason { who: None, cue: Cue::Says, sign: *sign, amount: None }];
                Says::RobotSays(*sign, to)
            }
            Says::Then(reason, waits) => {
                let reason = self.reason(reason);
                self.pending = vec![reason.clone()];
                self.signed = None;
                Says::Then(reason, *waits)
            }
            Says::From(who, class) => Says::From(self.people(who), *class),
            Says::RobotFirst(_) => Says::RobotFirst(Some(self.last.clone())),
            Says::After(_, who) => {
                let who = self.people(who);
                let first = Some(self.met.0.clone()).filter(|first| !first.iter().any(|one| who.contains(one)));
                Says::After(first, who)
            }
            Says::Happens(class, rank) => Says::Happens(*class, *rank),
            Says::There => Says::There,
            Says::GoalThere => Says::GoalThere,
            Says::RobotVia(class) => Says::RobotVia(*class),
            Says::RobotStart(class) => Says::RobotStart(*class),
            Says::RobotGoal(class) => Says::RobotGoal(*class),
            Says::Background(reason) => Says::Background(*reason),
            Says::NotPlayed(why) => Says::NotPlayed(why.clone()),
            Says::Goes => Says::Goes,
            Says::NotRead => Says::NotRead,
        })
    }

    /// People of whom something is told.
    fn active(&mut self, who: &Named) -> People {
        let who = self.people(who);
        self.active.extend(&who);
        who
    }

    pub(crate) fn reason(&mut self, reason: &Reason<Named>) -> Reason<People> {
        // `as soon as she has said so`: whoever made the sign.
        let pronoun = |who: &Named| who.iter().all(|noun| matches!(noun.head, Head::He | Head::They));
        let signer = self.signed.as_ref().map(|(signer, _)| signer.clone());
        let same = reason.cue == Cue::Says && reason.sign.is_none() && reason.who.as_ref().is_some_and(pronoun);
        let mut who = match signer.filter(|_| same) {
            Some(signer) => Some(signer),
            None => reason.who.as_ref().map(|who| self.people(who)),
        };
        let mut sign = reason.sign;
        if reason.cue == Cue::Says && sign.is_some() {
            self.asked = sign;
        } else if reason.cue == Cue::Says {
            // `when it has asked`, `on hearing that`: the sign that was made last.
            sign = self.asked;
            who = who.or_else(|| self.signed.as_ref().map(|(signer, _)| signer.clone()));
        }
        Reason { who, cue: reason.cue, sign, amount: reason.amount }
    }

    pub(crate) fn deed(&mut self, deed: &Deed<Named>) -> Deed<People> {
        let who = self.active(&deed.who);
        let whom = deed.whom.as_ref().map(|whom| {
            let (last, before) = (self.last.clone(), self.before.clone());
            self.excluded.clone_from(&who);
            let mut whom = self.people(whom);
            self.excluded.clear();
            (self.last, self.before) = (last, before);
            // Nobody follows themselves: `his colleague follows him`.
            if whom.iter().any(|whom| who.contains(whom)) {
                let others = self.before.iter().chain(self.set.iter()).copied();
                let others: People = others.chain(self.everybody()).filter(|other| !who.contains(other)).collect();
                whom = others.into_iter().take(1).collect();
            }
            whom
        });
        let mut when: Vec<Reason<People>> = deed.when.iter().map(|reason| self.reason(reason)).collect();
        let until: Vec<Reason<People>> = deed.until.iter().map(|reason| self.reason(reason)).collect();
        if when.is_empty() && !deed.not && !deed.ongoing {
            when = match &self.signed {
                Some((signer, reason)) if signer.iter().all(|signer| !who.contains(signer)) => vec![reason.clone()],
                _ => {
                    self.waiting = None;
                    self.pending.clone()
                }
            };
        }
        // Nobody answers their own word: a pronoun in it means somebody else.
        let own = |reason: &Reason<People>| {
            reason.cue == Cue::Says && reason.who.as_ref().is_some_and(|speaker| *speaker == who)
        };
        if when.iter().any(own) {
            self.doubts.extend(deed.who.iter().map(|noun| noun.tokens.clone()));
        }
        let (mut act, mut says, mut whom) = (deed.act, deed.says, whom);
        let as_robot = when.iter().find_map(|reason| match reason.cue {
            Cue::Stopped => Some(Act::StandStill),
            Cue::Moving => Some(Act::Navigate),
            Cue::Visible
            | Cue::Near
            | Cue::Blocking
            | Cue::Passed
            | Cue::Says
            | Cue::Encounter
            | Cue::Goal
            | Cue::After => None,
        });
        if let Some(same) = as_robot.filter(|_| deed.obeys && !deed.when.is_empty()) {
            // `if it stops, so does she`
            act = same;
        } else if deed.obeys {
            match (self.asked_for(), &self.done) {
                (Some(asked), _) => act = asked,
                (None, Some(done)) => {
                    (act, says, whom) = (done.act, done.says, done.whom.clone());
                    if deed.when.is_empty() && !deed.not {
                        when.clone_from(&done.when);
                    }
                }
                (None, None) => {}
            }
        }
        // `steps aside when it asks him to`
        for reason in when.iter_mut().filter(|reason| reason.cue == Cue::Says && reason.sign.is_none()) {
            reason.sign = act.asked_by();
        }
        self.last.clone_from(&who);
        if let Some(whom) = whom.as_ref().filter(|whom| act == Act::Sign && !whom.is_empty()) {
            // Whoever is asked is spoken of next.
            self.before = std::mem::replace(&mut self.last, whom.clone());
        }
        if act == Act::Sign && !deed.not && says != Some(Gesture::Acknowledged) {
            // Whoever makes a sign is reacted to by others.
            let reason = Reason { who: Some(who.clone()), cue: Cue::Says, sign: says, amount: None };
            self.signed = Some((who.clone(), reason));
            self.asked = says.or(self.asked);
        }
        if !until.is_empty() {
            // What comes then comes after what was waited for.
            self.pending.clone_from(&until);
        }
        let ongoing = deed.ongoing;
        let never = deed.never;
        let deed = Deed {
            ongoing,
            never,
            who,
            act,
            whom,
            not: deed.not,
            when,
            until,
            for_s: deed.for_s,
            says,
            obeys: deed.obeys,
            then: deed.then,
        };
        self.done = Some(deed.clone());
        deed
    }

    pub(crate) fn asked_for(&self) -> Option<Act> {
        self.asked.map(|sign| match sign {
            Gesture::Wait => Act::StandStill,
            Gesture::Proceed | Gesture::Acknowledged => Act::Navigate,
            Gesture::ExcuseMe => Act::GiveWay,
            Gesture::FollowMe => Act::Follow,
        })
    }
}

/// Whether somebody waits for a word of the robot.
fn is_word(reason: &Reason<People>) -> bool {
    reason.cue == Cue::Says && reason.who.is_none()
}
