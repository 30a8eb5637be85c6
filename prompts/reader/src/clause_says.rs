//! Pass 5: clauses to statements: active and passive, the robot or a person, places.
//!
//! ```text
//! "the nurse steps aside when it is near" ─► The nurse: give_way when Near
//! ```

use socrates_model::statement::Background;
use socrates_model::{PlaceClass, Relation};

use crate::clause::{At, Clause, Condition, Join, Predicate, Tie};
use crate::lexicon::Lexicon;
use crate::maker::Maker;
use crate::noun::{Head, Noun, Pick};
use crate::rows::{Act, Cue, Frame, Part};
use crate::statement::{Deed, Named, Reason, Says, Statement};
use crate::times::{Times, Whole};

/// The statements of a text.
pub(crate) fn statements(clauses: &[Clause], lexicon: &Lexicon) -> Vec<Statement<Named>> {
    let mut maker = Maker::new(lexicon);
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
        // `Regression for bug 371: …`; a sentence in which nobody is named, and nothing that is known is done.
        let colon = clauses.get(at + 1).is_some_and(|next| next.join == Join::Colon);
        let sentence = clauses.get(..at).unwrap_or_default().iter().rposition(|own| own.join == Join::Start);
        let from = if maker.first { at } else { sentence.unwrap_or(0) };
        let own = clauses.get(from..).unwrap_or_default().iter();
        let own = own.enumerate().take_while(|(number, own)| *number == 0 || own.join != Join::Start);
        let alone = at == 0 && !clause.verbal && own.map(|(_, own)| own).all(Clause::is_silent);
        if colon && clause.is_heading() || alone {
            maker.say(clause.tokens.clone(), Says::Background(Background::Comment));
            continue;
        }
        maker.clause(clause);
    }
    // What is said once and holds of several clauses is waited for where one of them does something.
    let answered = std::mem::take(&mut maker.answered);
    for statement in &mut maker.found {
        if let Says::Then(_, waits) = &mut statement.says {
            *waits &= !answered.contains(&(statement.tokens.start, statement.tokens.end));
        }
    }
    maker.found
}

impl Maker<'_> {
    pub(crate) fn clause(&mut self, clause: &Clause) {
        // `a visitor and the robot come towards each other`: said of the visitor.
        let people: Vec<Noun> =
            clause.subject.iter().filter(|noun| noun.may_be_person() && noun.head != Head::It).cloned().collect();
        let mixed = !people.is_empty() && people.len() < clause.subject.len();
        let others = clause.subject.iter().filter(|noun| !people.contains(noun)).map(|noun| noun.tokens.clone());
        let goes = clause.goes.iter().cloned().chain(others).collect();
        let of_people = mixed.then(|| Clause { subject: people.clone(), goes, ..clause.clone() });
        let clause = of_people.as_ref().unwrap_or(clause);
        self.partly = !clause.left.is_empty() || clause.acts.is_empty() && !clause.looks.is_empty();
        let start = self.found.len();
        // Whoever is named before a condition is there before those whom it names.
        let named = clause.subject.first().filter(|noun| matches!(noun.head, Head::Role(_) | Head::Name(_)));
        if named.is_some_and(|noun| clause.conditions.iter().any(|when| when.clause.tokens.start > noun.tokens.start)) {
            self.are_there(clause.subject.clone());
        }
        let Times { when, until, turned, used, then } = self.times(clause);
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
                // `no other people`: nobody is there, and nothing is asked of them.
                let there = none.of.is_none() && none.head != Head::Bare && clause.left.is_empty();
                let says = if there { Says::Background(Background::Setting) } else { Says::NotRead };
                self.say(none.tokens.clone(), says);
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
                // `suddenly stops` tells of no pace.
                let walks = |act: &Predicate| {
                    let frame = self.lexicon.frames.get(act.row);
                    frame.is_some_and(|frame| frame.goes || frame.relate.is_some_and(|relation| !relation.stands()))
                };
                let walks = clause.acts.is_empty() || clause.acts.iter().any(walks);
                self.say(tokens, if walks { Says::Pace(clause.subject.clone(), pace.value) } else { Says::Goes });
            }
        }
        // What describes somebody of whom the clause says nothing more may be what they do.
        let idle = !robot && !clause.subject.is_empty() && !self.tells_since(start);
        self.rest(clause, idle);
        // A reason for which nobody does anything yet is one for what comes.
        let own = self.found.get(start..).unwrap_or_default();
        let does = own.iter().any(|own| matches!(own.says, Says::Do(_)));
        let done = does || own.iter().any(|own| matches!(own.says, Says::Then(..)));
        if does {
            let conditions = clause.conditions.iter().map(|condition| &condition.clause.tokens);
            self.answered.extend(conditions.map(|tokens| (tokens.start, tokens.end)));
        }
        if let Some(reason) = when.iter().chain(&until).next().filter(|_| !done) {
            let own = clause.conditions.first().map(|condition| condition.clause.tokens.clone());
            // Whoever comes out as the robot drives by is met then; and for what is denied nobody waits.
            let met = matches!(reason.cue, Cue::Visible | Cue::Near | Cue::Encounter | Cue::Blocking | Cue::Moving)
                && reason.amount.is_none();
            let met = met || !clause.acts.is_empty() && clause.acts.iter().all(|act| act.not);
            self.say(own.unwrap_or_else(|| used.first().cloned().unwrap_or(0..0)), Says::Then(reason.clone(), !met));
        }
        self.with_the_rest(clause, start, &when, used);
        for next in then {
            self.clause(&next);
        }
    }

    /// A condition that is no reason: `while the other walks on` is a clause of its own.
    pub(crate) fn beside(&mut self, condition: &Condition) {
        if matches!(condition.tie, Tie::While | Tie::When | Tie::After) && condition.tells_of_people() {
            self.clause(&condition.clause);
        } else {
            self.say(condition.clause.tokens.clone(), Says::NotRead);
        }
    }

    pub(crate) fn act(&mut self, act: &Predicate, frame: &Frame, whole: &Whole<'_>, robot: bool) {
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
    pub(crate) fn person(&mut self, act: &Predicate, frame: &Frame, whole: &Whole<'_>, who: Named) {
        let (tokens, clause) = (act.tokens.clone(), whole.clause);
        let waits = !whole.when.is_empty() && frame.act.is_some();
        // A side that is ruled out is none.
        if act.not && frame.side.is_some() {
            return self.say(tokens, Says::NotRead);
        }
        let relation = frame.relate.filter(|_| !act.not && !waits);
        if relation.is_some() || frame.side.is_some() {
            self.say(tokens.clone(), Says::Relate(who.clone(), relation, frame.side));
        }
        // `First a nurse crosses, then a doctor crosses.`
        let comes = |relation: Relation| !relation.stands() && relation != Relation::Staying;
        let after = |condition: &Condition| condition.tie == Tie::After && condition.tells_of_people();
        let then = whole.clause.join == Join::Then && whole.clause.own || whole.clause.conditions.iter().any(after);
        if then && relation.is_some_and(comes) {
            self.say(tokens.clone(), Says::After(None, who.clone()));
        }
        if frame.group {
            self.say(tokens.clone(), Says::Group(who.clone()));
        }
        if frame.twice && !act.not {
            let place = clause.places.first().filter(|_| frame.relate.is_none()).and_then(|at| at.class);
            self.say(tokens.clone(), Says::Twice(who.clone(), place));
        }
        if frame.robot_first && relation.is_some() {
            self.say(tokens.clone(), Says::RobotFirst(None));
        }
        if frame.queue {
            self.say(tokens.clone(), Says::Queue(who.clone()));
        }
        // Whoever crosses after some time, or once they may, sets off then.
        let sets_off =
            |reason: &Reason<Named>| matches!(reason.cue, Cue::After | Cue::Says | Cue::Passed | Cue::Stopped);
        let walks = relation.is_some_and(|relation| !relation.stands()) || frame.plain && frame.goes && !act.not;
        let sets_off = walks && (whole.when.iter().any(sets_off) || whole.clause.after_s.is_some());
        let none = who.iter().any(|noun| noun.pick == Pick::None);
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
        } else if let Some(cue) = frame.cue.filter(|_| !act.not && relation.is_none()) {
            let reason = Reason { who: None, cue, sign: None, amount: whole.clause.within_m.map(|m| m.value) };
            self.say(tokens.clone(), Says::Introduce(who));
            self.say(tokens, Says::Then(reason, false));
        } else if frame.asks || frame.relate == Some(Relation::Leaving) && none {
            // `nobody gets out`: then all stay, of whom nothing was read.
            self.say(tokens, Says::NotRead);
        } else if relation.is_none() && !frame.group && !frame.twice {
            // What is denied, or says no more than that somebody is there.
            let walks = frame.plain && frame.goes && !act.not && act.object.is_none();
            self.say(tokens, if walks { Says::Walks(who) } else { Says::Noted(who) });
        }
    }

    /// Somebody does something with somebody else: only following is played.
    pub(crate) fn with_somebody(
        &mut self,
        act: &Predicate,
        frame: &Frame,
        whole: &Whole<'_>,
        who: Named,
        other: Option<Named>,
    ) {
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
    pub(crate) fn robot(&mut self, act: &Predicate, frame: &Frame, whole: &Whole<'_>, person: Option<Named>) {
        let tokens = act.tokens.clone();
        if frame.asks || act.sign.is_some() {
            let says = if act.not { Says::NotRead } else { Says::RobotSays(act.sign, person) };
            self.say(tokens, says);
            return;
        }
        if frame.robot_first && !act.not && person.is_none() {
            self.say(tokens, Says::RobotFirst(None));
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
        let drives = (frame.goes || frame.part.is_some())
            && !act.not
            && (frame.part.is_none() || !whole.clause.places.is_empty());
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
                // `The robot follows a nurse`: what it does to somebody is in no form.
                if cue.is_none() && !frame.plain {
                    self.say(tokens.clone(), Says::NotRead);
                }
            }
            (_, None) => {}
        }
        if let Some(cue) = cue {
            let amount = whole.clause.within_m.filter(|_| cue == Cue::Near).map(|m| m.value);
            // `Robot within 1 m.`: somebody waits for that.
            let waits = cue == Cue::Near && amount.is_some();
            self.say(tokens, Says::Then(Reason { who: None, cue, sign: None, amount }, waits));
        }
    }

    pub(crate) fn places(&mut self, clause: &Clause, robot: bool) {
        let frame = |act: &Predicate| self.lexicon.frames.get(act.row);
        // `from the ward to the exit`
        let route = clause.subject.is_empty()
            && clause.acts.iter().all(|act| frame(act).is_some_and(|frame| frame.plain))
            && clause.places.len() > 1
            && clause.places.iter().any(|at| at.from || at.via)
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
        let stands = |act: &Predicate| frame(act).is_some_and(|frame| frame.relate == Some(Relation::Static));
        let waits = !robot && clause.acts.iter().any(stands);
        for (number, At { class, to, from, via, tokens }) in clause.places.iter().enumerate() {
            let part = part.filter(|_| number == 0);
            // Whoever comes out of a room is met where it is told beside.
            let leaves =
                |act: &Predicate| !act.not && frame(act).is_some_and(|frame| frame.relate == Some(Relation::Leaving));
            let leaves = !robot && number == 0 && clause.acts.iter().any(leaves);
            let rank = if leaves && matches!(class, Some(PlaceClass::Room | PlaceClass::Elevator)) { 1 } else { rank };
            // The place of the second meeting is told with it.
            let again = |act: &Predicate| frame(act).is_some_and(|frame| frame.twice && frame.relate.is_none());
            let says = match class {
                Some(_) if clause.acts.iter().any(again) => Says::Goes,
                // Out of which room somebody comes is not where they are met.
                Some(PlaceClass::Room) if leaves => Says::Goes,
                None => Says::NotPlayed("no map has such a place".to_owned()),
                Some(class) if (goes || part == Some(Part::Start)) && *to => Says::RobotGoal(*class),
                Some(class) if (goes || part == Some(Part::Goal)) && *from => Says::RobotStart(*class),
                // `reception to ward 5`
                Some(class) if route && number == 0 => Says::RobotStart(*class),
                Some(class) if *via && (goes || part.is_some()) => {
                    self.say(tokens.0..tokens.1, Says::Happens(*class, 1));
                    Says::RobotVia(*class)
                }
                Some(class) if part == Some(Part::Start) => Says::RobotStart(*class),
                Some(class) if part == Some(Part::Goal) => Says::RobotGoal(*class),
                // `waits for the elevator`: there is nobody in it.
                Some(_) if *to && waits => Says::Background(Background::Setting),
                Some(class) => Says::Happens(*class, if *to { 1 } else { rank }),
            };
            self.say(tokens.0..tokens.1, says);
            if let Some(class @ (PlaceClass::Room | PlaceClass::Elevator)) = class
                && leaves
            {
                self.say(tokens.0..tokens.1, Says::From(clause.subject.clone(), *class));
            }
        }
    }
}
