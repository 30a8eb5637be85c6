//! Pass 5: clauses to statements. A statement says one thing, and of whom: first as the text names them, then as people
//! ([`crate::discourse`]).
//!
//! ```text
//! "the nurse steps aside when it is near" ─► The nurse: give_way when Near
//! ```

use std::ops::Range;

use socrates_model::statement::Background;
use socrates_model::{Gesture, PlaceClass, Relation, Side};

use crate::clause::{At, Clause, Condition, Join, Predicate, Tie};
use crate::lexicon::Lexicon;
use crate::noun::{Head, Noun, Pick};
use crate::parser::names_somebody;
use crate::rows::{Act, Cue, Frame, Part};

/// Why somebody begins or ends something.
#[derive(Debug, Clone, PartialEq)]
pub struct Reason<W> {
    /// Whose: nobody where it is the robot's, or their own.
    pub who: Option<W>,
    /// What.
    pub cue: Cue,
    /// Which sign.
    pub sign: Option<Gesture>,
    /// How far, m; how long, s.
    pub amount: Option<f64>,
}

/// What a statement says; `W` names people.
#[derive(Debug, Clone, PartialEq)]
pub enum Says<W> {
    /// Somebody is there.
    Introduce(W),
    /// Somebody does what leaves no trace in a form: walks, or pays no attention.
    Noted(W),
    /// How somebody stands to the robot's way.
    Relate(W, Option<Relation>, Option<Side>),
    /// They are a group.
    Group(W),
    /// How fast somebody walks, m/s.
    Pace(W, f64),
    /// Somebody does something, or does not.
    Do(Deed<W>),
    /// The robot makes a sign, to somebody.
    RobotSays(Option<Gesture>, Option<W>),
    /// Something happens to which people may react from then on.
    Then(Reason<W>),
    /// Where it happens; the number ranks it: people are there (3), it stands alone (2), the robot is there (1).
    Happens(PlaceClass, u8),
    /// It happens where the robot's way ends, unless another place is told.
    There,
    /// The robot's way ends in the room or car of which is spoken.
    GoalThere,
    /// What the robot's way leads past.
    RobotVia(PlaceClass),
    /// Where the robot's way begins.
    RobotStart(PlaceClass),
    /// Where it ends.
    RobotGoal(PlaceClass),
    /// It asks for nothing.
    Background(Background),
    /// It goes with what the rest of its clause says.
    Goes,
    /// It is understood, and not played.
    NotPlayed(String),
    /// It is not understood.
    NotRead,
}

/// What somebody does.
#[derive(Debug, Clone, PartialEq)]
pub struct Deed<W> {
    /// Who.
    pub who: W,
    /// What.
    pub act: Act,
    /// To whom, where it is not the robot.
    pub whom: Option<W>,
    /// Whether they do not.
    pub not: bool,
    /// All of these have to hold.
    pub when: Vec<Reason<W>>,
    /// It ends when this holds.
    pub until: Vec<Reason<W>>,
    /// For how long, s.
    pub for_s: Option<f64>,
    /// A sign made with it.
    pub says: Option<Gesture>,
    /// Whether it goes on from the start, whatever else happens: `is standing`.
    pub ongoing: bool,
    /// Whether it is what was asked for just before: `does so`.
    pub obeys: bool,
}

impl<W> Deed<W> {
    /// Somebody does something, at once and to nobody.
    pub(crate) fn of(who: W, act: Act) -> Self {
        Self {
            who,
            act,
            whom: None,
            not: false,
            ongoing: false,
            when: Vec::new(),
            until: Vec::new(),
            for_s: None,
            says: None,
            obeys: false,
        }
    }
}

/// A statement with where it stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Statement<W> {
    /// Whether words of its clause were left over.
    pub(crate) partly: bool,
    /// Its tokens.
    pub(crate) tokens: Range<usize>,
    /// Whether a sentence begins with it.
    pub(crate) first: bool,
    /// Whether it tells of those named before a colon.
    pub(crate) tells: bool,
    /// Whether it is asked.
    pub(crate) asks: bool,
    /// What it says.
    pub says: Says<W>,
}

/// People as a text names them.
pub(crate) type Named = Vec<Noun>;

/// The statements of a text.
pub(crate) fn statements(clauses: &[Clause], lexicon: &Lexicon) -> Vec<Statement<Named>> {
    let mut maker = Maker { lexicon, found: Vec::new(), first: false, tells: false, partly: false, asks: false };
    for (at, clause) in clauses.iter().enumerate() {
        // `the one who crosses`: whoever was said to cross.
        let relative = clauses.get(at + 1).filter(|next| next.subject.iter().all(|noun| noun.head == Head::Who));
        let known_by = relative.and_then(|next| lexicon.frames.get(next.acts.first()?.row)?.relate);
        let known = known_by.filter(|_| clause.acts.is_empty()).map(|_| {
            let subject = clause.subject.iter().map(|noun| Noun { known_by, ..noun.clone() }).collect();
            Clause { subject, ..clause.clone() }
        });
        let clause = known.as_ref().unwrap_or(clause);
        maker.first = clause.join == Join::Start;
        maker.tells = clause.join == Join::Colon || maker.tells && !maker.first;
        maker.asks = clause.asks;
        // `Regression for bug 371: …`
        let heads = at == 0 || clauses.get(at + 1).is_some_and(|next| next.join == Join::Colon);
        if heads && clause.is_heading() {
            maker.say(clause.tokens.clone(), Says::Background(Background::Comment));
            continue;
        }
        maker.clause(clause);
    }
    maker.found
}

struct Maker<'a> {
    lexicon: &'a Lexicon,
    found: Vec<Statement<Named>>,
    first: bool,
    tells: bool,
    partly: bool,
    asks: bool,
}

impl Maker<'_> {
    fn say(&mut self, tokens: Range<usize>, says: Says<Named>) {
        let (partly, first, tells, asks) = (self.partly, self.first, self.tells, self.asks);
        self.found.push(Statement { partly, tokens, first, tells, asks, says });
        self.first = false;
    }

    /// Words that go with what is said of their clause.
    fn goes(&mut self, tokens: Range<usize>) {
        self.say(tokens, Says::Goes);
    }

    /// Noun phrases that go with what is said of their clause.
    fn nouns_go(&mut self, nouns: &[Noun]) {
        for noun in nouns {
            self.goes(noun.tokens.clone());
        }
    }

    /// `an oncoming nurse`: a word before the role that says how they move.
    fn modified(&mut self, nouns: &[Noun]) {
        for noun in nouns {
            let rows = noun.modifiers.iter().filter_map(|word| {
                let pattern = self.lexicon.frame_patterns.beginning(word).find(|pattern| pattern.slots.len() == 1)?;
                self.lexicon.frames.get(pattern.row)?.relate
            });
            if let Some(relation) = rows.last() {
                self.say(noun.tokens.clone(), Says::Relate(vec![noun.clone()], Some(relation), None));
            }
        }
    }

    /// Some people are there.
    fn are_there(&mut self, nouns: Named) {
        self.nouns_go(nouns.get(1..).unwrap_or_default());
        if let Some(tokens) = nouns.first().map(|noun| noun.tokens.clone()) {
            self.say(tokens, Says::Introduce(nouns.clone()));
        }
        self.modified(&nouns);
    }

    fn clause(&mut self, clause: &Clause) {
        // `a visitor and the robot come towards each other`: said of the visitor.
        let people: Vec<Noun> =
            clause.subject.iter().filter(|noun| noun.may_be_person() && noun.head != Head::It).cloned().collect();
        let mixed = !people.is_empty() && people.len() < clause.subject.len();
        let of_people = mixed.then(|| Clause { subject: people, ..clause.clone() });
        let clause = of_people.as_ref().unwrap_or(clause);
        self.partly = !clause.left.is_empty() || clause.acts.is_empty() && !clause.looks.is_empty();
        let start = self.found.len();
        let Times { when, until, turned, used } = self.times(clause);
        let robot = clause.subject.iter().any(|noun| self.is_robot(noun, clause));
        self.places(clause, robot);
        for noun in clause.subject.iter().filter(|noun| noun.group && noun.several) {
            self.say(noun.tokens.clone(), Says::Group(vec![noun.clone()]));
        }
        let whole = Whole { clause, when: &when, until: &until, turned };
        if let Some(does) = clause.does.filter(|_| clause.acts.is_empty() && !robot && !clause.subject.is_empty()) {
            let deed = whole.answer(clause.subject.clone(), does);
            self.say(clause.subject.first().map_or(0..0, |noun| noun.tokens.clone()), Says::Do(deed));
        } else if clause.acts.is_empty() && !robot && !clause.subject.is_empty() {
            self.are_there(clause.subject.clone());
            // Whoever shall not do what was not read: `neither of the two …`
            for none in clause.subject.iter().filter(|noun| noun.pick == Pick::None) {
                self.say(none.tokens.clone(), Says::NotRead);
            }
        }
        if clause.group {
            self.say(
                clause.subject.first().map_or(0..0, |noun| noun.tokens.clone()),
                Says::Group(clause.subject.clone()),
            );
        }
        if clause.there {
            self.say(clause.tokens.start..clause.tokens.start, Says::There);
        }
        for act in &clause.acts {
            let Some(frame) = self.lexicon.frames.get(act.row) else { continue };
            self.act(act, frame, &whole, robot);
        }
        self.are_there(clause.also.clone());
        if let Some(pace) = clause.pace_mps {
            let tokens = pace.from..pace.to;
            if robot {
                self.say(tokens, Says::Background(Background::Errand));
            } else if !clause.subject.is_empty() {
                self.say(tokens, Says::Pace(clause.subject.clone(), pace.value));
            }
        }
        self.rest(clause);
        // A reason for which nobody does anything yet is one for what comes.
        let done = self.found.get(start..).unwrap_or_default().iter().any(|own| matches!(own.says, Says::Do(_)));
        if let Some(reason) = when.first().or(until.first()).filter(|_| !done) {
            self.say(used.first().cloned().unwrap_or(0..0), Says::Then(reason.clone()));
        }
        self.with_the_rest(clause, start, &when, used);
    }

    /// Says what goes with what was said of a clause since a statement: whose it is, when, how long. What nothing was made of
    /// stays without a statement, and is not read.
    fn with_the_rest(&mut self, clause: &Clause, start: usize, when: &[Reason<Named>], used: Vec<Range<usize>>) {
        let own = self.found.get(start..).unwrap_or_default();
        let any = own.iter().any(|own| !matches!(own.says, Says::NotRead));
        let done = own.iter().any(|own| matches!(own.says, Says::Do(_)));
        let then = own.iter().any(|own| matches!(own.says, Says::Then(_)));
        // Whoever is met is met as the robot comes by: such a reason holds of where somebody comes from as well.
        let met = when.iter().all(|reason| !matches!(reason.cue, Cue::After | Cue::Says | Cue::Passed));
        let plain = |act: &Predicate| self.lexicon.frames.get(act.row).is_some_and(|frame| frame.plain);
        if done || clause.acts.iter().any(|act| act.not && plain(act)) {
            for tokens in &clause.denials {
                self.goes(tokens.clone());
            }
        }
        if any {
            self.nouns_go(&clause.subject);
            self.nouns_go(clause.agent.as_slice());
            for tokens in &clause.goes {
                self.goes(tokens.clone());
            }
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

    /// When a clause begins and ends, by its conditions.
    fn times(&mut self, clause: &Clause) -> Times {
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
                let robot = condition.clause.subject.iter().any(|noun| self.is_robot(noun, &condition.clause));
                self.places(&condition.clause, robot);
                self.rest(&condition.clause);
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
                (Some(_), Tie::Before) | (None, _) => {
                    self.beside(condition);
                    continue;
                }
            }
            times.used.extend(tokens);
        }
        times
    }

    /// Whoever is named in a condition is there.
    fn introduce(&mut self, clause: &Clause) {
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

    /// A condition that is no reason: `while the other walks on` is a clause of its own.
    fn beside(&mut self, condition: &Condition) {
        let own = !condition.clause.subject.is_empty() && !condition.clause.acts.is_empty();
        if matches!(condition.tie, Tie::While | Tie::When) && own {
            self.clause(&condition.clause);
        } else {
            self.say(condition.clause.tokens.clone(), Says::NotRead);
        }
    }

    /// Whether a noun phrase means the robot where it is a subject: `it sees the robot` does not.
    fn is_robot(&self, noun: &Noun, clause: &Clause) -> bool {
        let object = clause.acts.iter().any(|act| act.object.as_ref().is_some_and(|object| object.head == Head::Robot));
        match noun.head {
            Head::Robot => true,
            Head::It => !object,
            Head::He | Head::They | Head::Who | Head::Role(_) | Head::Name(_) | Head::Bare => false,
        }
    }

    fn act(&mut self, act: &Predicate, frame: &Frame, whole: &Whole<'_>, robot: bool) {
        let clause = whole.clause;
        let tokens = act.tokens.clone();
        // What the robot carries is no wish.
        if robot && frame.unplayed.is_some() {
            self.say(tokens, Says::Background(Background::Errand));
            return;
        }
        if let Some(why) = &frame.unplayed {
            // Nobody has to leave undone what nobody can do.
            let says = if act.not { Says::Background(Background::Looks) } else { Says::NotPlayed(why.clone()) };
            self.say(tokens, says);
            return;
        }
        let by_robot = if act.passive { clause.agent.as_ref().map_or(frame.asks, Noun::may_be_robot) } else { robot };
        if by_robot {
            let person = if act.passive {
                Some(clause.subject.clone()).filter(|who| !who.is_empty() && !robot)
            } else {
                act.object.clone().filter(Noun::may_be_person).map(|noun| vec![noun])
            };
            self.robot(act, frame, whole, person);
            return;
        }
        let (who, object) = if act.passive {
            (clause.agent.iter().cloned().collect(), clause.subject.first().cloned())
        } else {
            (clause.subject.clone(), act.object.clone())
        };
        if who.is_empty() {
            let says = if frame.plain { Says::Goes } else { Says::NotRead };
            self.say(tokens, says);
            return;
        }
        let about_robot = object.as_ref().is_none_or(|object| {
            // `towards the two of them`: the robot is one of them.
            let of_them = object.head == Head::Bare && object.of.as_ref().is_some_and(|of| of.head == Head::They);
            of_them && frame.relate.is_some()
                || !matches!(object.head, Head::Role(_) | Head::Name(_) | Head::Bare | Head::He | Head::Who)
        });
        if !about_robot && act.sign.is_none() {
            let other = object.clone().map(|noun| vec![noun]);
            self.with_somebody(act, frame, whole, who, other);
            return;
        }
        self.person(act, frame, whole, who);
    }

    /// Somebody does something, to the robot or to nobody.
    fn person(&mut self, act: &Predicate, frame: &Frame, whole: &Whole<'_>, who: Named) {
        let tokens = act.tokens.clone();
        let waits = !whole.when.is_empty() && frame.act.is_some();
        let relation = frame.relate.filter(|_| !act.not && !waits);
        if relation.is_some() || frame.side.is_some() {
            self.say(tokens.clone(), Says::Relate(who.clone(), relation, frame.side));
        }
        if frame.group {
            self.say(tokens.clone(), Says::Group(who.clone()));
        }
        // Whoever crosses after some time, or once they may, sets off then.
        let sets_off =
            |reason: &Reason<Named>| matches!(reason.cue, Cue::After | Cue::Says | Cue::Passed | Cue::Stopped);
        let walks = relation.is_some_and(|relation| !relation.stands()) || frame.plain && frame.goes && !act.not;
        let sets_off = walks && whole.when.iter().any(sets_off);
        let does = frame
            .denied
            .filter(|_| act.not)
            .or(frame.act)
            .or_else(|| act.sign.map(|_| Act::Sign))
            .or_else(|| (frame.obeys || sets_off).then_some(Act::Navigate));
        if let Some(does) = does {
            let somebody =
                |noun: &&Noun| matches!(noun.head, Head::Role(_) | Head::Name(_) | Head::Bare | Head::He | Head::They);
            let whom =
                act.object.as_ref().filter(|_| act.sign.is_some()).filter(somebody).map(|noun| vec![noun.clone()]);
            let deed = Deed { whom, ..whole.deed(who, does, act, frame) };
            self.say(tokens, Says::Do(deed));
        } else if let Some(cue) = frame.cue.filter(|_| !act.not) {
            let reason = Reason { who: None, cue, sign: None, amount: whole.clause.within_m.map(|m| m.value) };
            self.say(tokens.clone(), Says::Introduce(who));
            self.say(tokens, Says::Then(reason));
        } else if frame.asks {
            self.say(tokens, Says::NotRead);
        } else if relation.is_none() && !frame.group {
            // What is denied, or says no more than that somebody is there.
            self.say(tokens, Says::Noted(who));
        }
    }

    /// Somebody does something with somebody else: only following is played.
    fn with_somebody(&mut self, act: &Predicate, frame: &Frame, whole: &Whole<'_>, who: Named, other: Option<Named>) {
        let tokens = act.tokens.clone();
        if frame.act == Some(Act::Follow) {
            let deed = Deed { whom: other, ..whole.deed(who, Act::Follow, act, frame) };
            self.say(tokens, Says::Do(deed));
            return;
        }
        self.say(tokens.clone(), Says::Introduce(who.clone()));
        if let Some(other) = other {
            self.say(tokens.clone(), Says::Introduce(other));
        }
        if frame.plain {
            self.say(tokens, Says::Noted(who));
        } else {
            self.say(tokens, Says::NotRead);
        }
    }

    /// The robot does something.
    fn robot(&mut self, act: &Predicate, frame: &Frame, whole: &Whole<'_>, person: Option<Named>) {
        let tokens = act.tokens.clone();
        if frame.asks || act.sign.is_some() {
            let says = if act.not { Says::NotRead } else { Says::RobotSays(act.sign, person) };
            self.say(tokens, says);
            return;
        }
        let cue = frame.robot_cue.filter(|_| !act.not);
        // `the robot meets a nurse head-on`
        let others = || whole.clause.acts.iter().filter_map(|act| act.object.clone()).filter(Noun::may_be_person);
        if let (Some(relation), None, false) = (frame.relate, &person, act.not)
            && !frame.goes
            && let Some(other) = others().find(|noun| noun.head != Head::It)
        {
            self.say(tokens, Says::Relate(vec![other], Some(relation), frame.side));
            return;
        }
        let drives = frame.goes && !act.not && (frame.part.is_none() || !whole.clause.places.is_empty());
        let silent = cue.is_none() && person.is_none() && !drives;
        if silent && !frame.plain {
            self.say(tokens, Says::NotRead);
            return;
        }
        if cue.is_none() && person.is_none() {
            self.say(tokens.clone(), Says::Background(Background::Errand));
        }
        match (frame.robot_relate, person) {
            (Some(relation), Some(person)) if !act.not => {
                self.say(tokens.clone(), Says::Relate(person, Some(relation), None))
            }
            (_, Some(person)) => {
                self.say(tokens.clone(), Says::Introduce(person.clone()));
                self.modified(&person);
            }
            (_, None) => {}
        }
        if let Some(cue) = cue {
            let amount = whole.clause.within_m.filter(|_| cue == Cue::Near).map(|m| m.value);
            self.say(tokens, Says::Then(Reason { who: None, cue, sign: None, amount }));
        }
    }

    /// What a condition waits for, and the tokens that say it.
    fn reason(&self, condition: &Condition, subject: &[Noun]) -> Option<(Reason<Named>, Vec<Range<usize>>)> {
        let clause = &condition.clause;
        let none = Reason { who: None, cue: Cue::Near, sign: None, amount: clause.within_m.map(|m| m.value) };
        let robot = clause.subject.iter().any(|noun| self.is_robot(noun, clause));
        let own = clause.subject.is_empty() || clause.subject == subject;
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
            let cue = if by_robot { frame.robot_cue } else { frame.cue.filter(|_| about) };
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

    fn places(&mut self, clause: &Clause, robot: bool) {
        let frame = |act: &Predicate| self.lexicon.frames.get(act.row);
        // `from the ward to the exit`
        let route = clause.subject.is_empty()
            && clause.acts.is_empty()
            && clause.places.iter().any(|at| at.from)
            && clause.places.iter().any(|at| at.to);
        // Whoever follows the robot to a place tells where it drives.
        let along = |act: &Predicate| {
            frame(act).is_some_and(|frame| frame.act == Some(Act::Follow) || frame.relate == Some(Relation::Abreast))
        };
        let along = clause.acts.iter().any(along);
        let goes = route
            || along
            || robot
                && (clause.acts.is_empty()
                    || clause
                        .acts
                        .iter()
                        .any(|act| frame(act).is_some_and(|frame| frame.goes || frame.part.is_some())));
        let there = |act: &&Predicate| !act.not && frame(act).is_some_and(|frame| frame.part == Some(Part::There));
        if let Some(act) = clause.acts.iter().find(there).filter(|_| robot && clause.places.is_empty()) {
            self.say(act.tokens.clone(), Says::GoalThere);
        }
        let robot = robot || clause.subject.is_empty();
        let part = clause.acts.iter().filter(|act| robot && !act.not).find_map(|act| frame(act)?.part);
        let rank = match () {
            () if clause.subject.is_empty() => 2,
            () if robot => 1,
            () if clause.acts.is_empty() => 2,
            // Whoever comes out of a room and crosses a corridor is met in the corridor.
            () if clause
                .acts
                .iter()
                .any(|act| frame(act).is_some_and(|frame| frame.relate == Some(Relation::Crossing))) =>
            {
                4
            }
            () => 3,
        };
        for (number, At { class, to, from, via, tokens }) in clause.places.iter().enumerate() {
            let part = part.filter(|_| number == 0);
            let says = match class {
                None => Says::NotPlayed("no map has such a place".to_owned()),
                Some(class) if (goes || part == Some(Part::Start)) && *to => Says::RobotGoal(*class),
                Some(class) if (goes || part == Some(Part::Goal)) && *from => Says::RobotStart(*class),
                Some(class) if *via && (goes || part.is_some()) => {
                    self.say(tokens.0..tokens.1, Says::Happens(*class, 1));
                    Says::RobotVia(*class)
                }
                Some(class) if part == Some(Part::Start) => Says::RobotStart(*class),
                Some(class) if part == Some(Part::Goal) => Says::RobotGoal(*class),
                Some(class) => Says::Happens(*class, if *to { 1 } else { rank }),
            };
            self.say(tokens.0..tokens.1, says);
        }
    }

    fn rest(&mut self, clause: &Clause) {
        let robot = clause.subject.iter().any(|noun| noun.head == Head::Robot);
        let reason = if robot { Background::Errand } else { Background::Looks };
        for run in runs(&clause.looks) {
            self.say(run, Says::Background(reason));
        }
        for run in runs(&clause.left) {
            self.say(run, Says::NotRead);
        }
    }
}

/// When something begins and ends, and the tokens that say so.
#[derive(Default)]
struct Times {
    when: Vec<Reason<Named>>,
    until: Vec<Reason<Named>>,
    turned: bool,
    used: Vec<Range<usize>>,
}

/// A clause with what its conditions came to.
struct Whole<'a> {
    clause: &'a Clause,
    when: &'a [Reason<Named>],
    until: &'a [Reason<Named>],
    /// Whether a denial and an `until` make an act that comes then.
    turned: bool,
}

impl Whole<'_> {
    /// `the second does`: what was asked for, or done, before.
    fn answer(&self, who: Named, does: bool) -> Deed<Named> {
        let (when, until) = (self.when.to_vec(), self.until.to_vec());
        Deed { not: !does, when, until, obeys: true, ..Deed::of(who, Act::Navigate) }
    }

    fn deed(&self, who: Named, act: Act, said: &Predicate, frame: &Frame) -> Deed<Named> {
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
            who,
            act,
            whom,
            not,
            when,
            until,
            for_s: clause.lasts_s.map(|secs| secs.value),
            says: said.sign,
            obeys: frame.obeys,
        }
    }
}

/// Numbers that follow each other, together.
fn runs(places: &[usize]) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for place in places {
        match runs.last_mut() {
            Some(last) if last.end == *place => last.end += 1,
            Some(_) | None => runs.push(*place..place + 1),
        }
    }
    runs
}
