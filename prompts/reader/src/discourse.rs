//! Pass 6: who is meant. Statements of noun phrases become statements of people, in the order of the text.
//!
//! People are numbered from 0 as they are named. Whoever was named last is `he`; the last several are `they`, and those of
//! whom `one`, `the second` and `the others` are spoken.

use std::collections::BTreeMap;

use socrates_model::{Gesture, Relation};

use crate::noun::{Head, Noun, Pick};
use crate::rows::{Act, Cue};
use crate::statement::{Deed, Named, Reason, Says, Statement};

/// People, by their numbers from 0.
pub type People = Vec<usize>;

/// Statements of people, and the role of everybody.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Told {
    pub(crate) roles: Vec<String>,
    /// Those of whom is spoken in general, without a number: `people step in front of it`.
    pub(crate) vague: People,
    pub(crate) statements: Vec<Statement<People>>,
}

/// Words that mean anybody.
const ANYBODY: &[&str] =
    &["person", "people", "human", "pedestrian", "individual", "participant", "actor", "agent", "somebody"];
/// How many several people are of whom no number is said.
const SEVERAL: usize = 2;
/// No phrase means more people than this.
const MOST: usize = 30;

/// Finds out who is meant.
pub(crate) fn told(statements: &[Statement<Named>]) -> Told {
    let mut cast = Cast::default();
    let mut told = Vec::new();
    for statement in statements {
        cast.begin(statement);
        let says = cast.says(&statement.says);
        if let Some(says) = says {
            let Statement { tokens, first, tells, partly, asks, .. } = statement;
            let (partly, first, tells, asks) = (*partly, *first, *tells, *asks);
            told.push(Statement { partly, tokens: tokens.clone(), first, tells, asks, says });
        }
    }
    let told = Told { roles: cast.roles, vague: cast.vague, statements: told };
    Told { statements: doubted(&told), ..told }
}

/// The statements of a text, and that those are not read that name somebody of whom nothing else is told, where of others
/// something is: mostly they are somebody else who was not made out.
fn doubted(told: &Told) -> Vec<Statement<People>> {
    let known = |person: usize| {
        told.statements.iter().any(|statement| match &statement.says {
            Says::Relate(who, ..) | Says::Group(who) | Says::Pace(who, _) | Says::Noted(who) => who.contains(&person),
            Says::Do(deed) => {
                deed.who.contains(&person) || deed.whom.as_ref().is_some_and(|whom| whom.contains(&person))
            }
            Says::RobotSays(_, Some(who)) => who.contains(&person),
            _ => false,
        })
    };
    let unknown: People = (0..told.roles.len()).filter(|person| !known(*person)).collect();
    let mut all = told.statements.clone();
    if unknown.len() < told.roles.len() {
        for statement in &told.statements {
            if matches!(&statement.says, Says::Introduce(who) if who.iter().any(|person| unknown.contains(person))) {
                all.push(Statement { says: Says::NotRead, ..statement.clone() });
            }
        }
    }
    all
}

#[derive(Default)]
struct Cast {
    roles: Vec<String>,
    vague: People,
    /// Who was named last.
    last: People,
    /// Who was named before them.
    before: People,
    /// The last several who were named together.
    set: People,
    /// Who of them was picked since.
    picked: People,
    /// Whether somebody is a woman, or a man, as far as that was said.
    female: BTreeMap<usize, bool>,
    /// People by their names.
    names: BTreeMap<String, usize>,
    /// Who a noun phrase meant, by its first token: said again by an ellipsis, it means the same.
    meant: BTreeMap<usize, People>,
    /// Those of whom a colon tells, who have no role yet.
    unnamed: People,
    /// Whether it tells of exactly as many: `visitors: a father and his son`.
    exact: bool,
    /// The same, of the statement that is being told.
    fresh: People,
    tells: bool,
    /// Whether a question is being told.
    asks: bool,
    /// What people react to from now on.
    pending: Vec<Reason<People>>,
    /// The sign that somebody made last, to which others react.
    signed: Option<(People, Reason<People>)>,
    /// What was asked for last.
    asked: Option<Gesture>,
    /// What was done last, or not done, for `the second does`.
    done: Option<Deed<People>>,
    /// How somebody was said last to stand to the robot's way, where nobody has done anything since.
    related: Option<Relation>,
    /// How everybody stands to it.
    relations: BTreeMap<usize, Relation>,
    /// Of whom a pronoun is not said: those who do it.
    excluded: People,
    /// Who was called the others last.
    others: People,
}

impl Cast {
    fn begin(&mut self, statement: &Statement<Named>) {
        if !self.fresh.is_empty() {
            self.unnamed = std::mem::take(&mut self.fresh);
        }
        if statement.first {
            self.unnamed.clear();
            // A sign is answered in the next sentence as well.
            self.pending.retain(|reason| reason.cue == Cue::Says);
        }
        self.tells = statement.tells;
        self.exact = false;
        self.asks = statement.asks;
    }

    fn says(&mut self, says: &Says<Named>) -> Option<Says<People>> {
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
                Says::Relate(who, *relation, *side)
            }
            Says::Noted(who) => Says::Noted(self.people(who)),
            Says::Group(who) => Says::Group(self.people(who)),
            Says::Pace(who, mps) => Says::Pace(self.people(who), *mps),
            // `a second one does so`: stands to the robot's way as the first does.
            Says::Do(deed) if deed.obeys && !deed.not && self.asked.is_none() && self.related.is_some() => {
                Says::Relate(self.people(&deed.who), self.related, None)
            }
            Says::Do(deed) => {
                self.related = None;
                let deed = self.deed(deed);
                // Of nobody nothing can be played.
                if deed.who.is_empty() { Says::NotRead } else { Says::Do(deed) }
            }
            Says::RobotSays(sign, to) => {
                let to = to.as_ref().map(|to| self.people(to));
                self.asked = sign.or(self.asked);
                self.signed = None;
                self.pending = vec![Reason { who: None, cue: Cue::Says, sign: *sign, amount: None }];
                Says::RobotSays(*sign, to)
            }
            Says::Then(reason) => {
                let reason = self.reason(reason);
                self.pending = vec![reason.clone()];
                self.signed = None;
                Says::Then(reason)
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

    fn reason(&mut self, reason: &Reason<Named>) -> Reason<People> {
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

    fn deed(&mut self, deed: &Deed<Named>) -> Deed<People> {
        let who = self.people(&deed.who);
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
                _ => self.pending.clone(),
            };
        }
        let (mut act, mut says, mut whom) = (deed.act, deed.says, whom);
        let as_robot = when.iter().find_map(|reason| match reason.cue {
            Cue::Stopped => Some(Act::StandStill),
            Cue::Moving => Some(Act::Navigate),
            _ => None,
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
            reason.sign = sign_for(act);
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
        let deed =
            Deed { ongoing, who, act, whom, not: deed.not, when, until, for_s: deed.for_s, says, obeys: deed.obeys };
        self.done = Some(deed.clone());
        deed
    }

    fn asked_for(&self) -> Option<Act> {
        self.asked.map(|sign| match sign {
            Gesture::Wait => Act::StandStill,
            Gesture::Proceed | Gesture::Acknowledged => Act::Navigate,
            Gesture::ExcuseMe => Act::GiveWay,
            Gesture::FollowMe => Act::Follow,
        })
    }

    fn people(&mut self, nouns: &Named) -> People {
        let mut all = People::new();
        let mut fresh = false;
        for noun in nouns {
            let known = self.meant.get(&noun.tokens.start).cloned();
            fresh |= known.is_none();
            let meant = known.unwrap_or_else(|| self.meant(noun));
            self.tell(noun, &meant);
            if !meant.is_empty() {
                self.meant.insert(noun.tokens.start, meant.clone());
            }
            for person in meant {
                if !all.contains(&person) {
                    all.push(person);
                }
            }
        }
        if all.len() > 1 && fresh && !self.is_part_of_set(&all) {
            self.set.clone_from(&all);
            self.picked.clear();
        }
        if !all.is_empty() && all != self.last {
            self.before = std::mem::replace(&mut self.last, all.clone());
        }
        all
    }

    /// What people are called, and what they are, where that is told beside them.
    fn tell(&mut self, noun: &Noun, people: &[usize]) {
        if let Some(female) = noun.female.filter(|_| matches!(noun.head, Head::Role(_))) {
            self.female.extend(people.iter().map(|person| (*person, female)));
        }
        for (name, person) in noun.names.iter().zip(people) {
            self.names.insert(name.clone(), *person);
            if let Some((_, label)) = name.rsplit_once(' ') {
                self.names.insert(label.to_owned(), *person);
            }
        }
        let Some(role) = &noun.beside else { return };
        for person in people {
            if let Some(own) = self.roles.get_mut(*person).filter(|own| ANYBODY.contains(&own.as_str())) {
                own.clone_from(role);
            }
        }
    }

    /// Whether some people have no role of their own.
    fn anybody(&self, people: &[usize]) -> bool {
        people.iter().all(|person| self.roles.get(*person).is_some_and(|role| ANYBODY.contains(&role.as_str())))
    }

    fn is_part_of_set(&self, people: &[usize]) -> bool {
        people.len() < self.set.len() && people.iter().all(|person| self.set.contains(person))
    }

    fn everybody(&self) -> People {
        (0..self.roles.len()).collect()
    }

    /// Whom a noun phrase means; new people where nobody was named so.
    fn meant(&mut self, noun: &Noun) -> People {
        match &noun.head {
            Head::Robot => People::new(),
            Head::He | Head::It => self.one_named_last(noun.female),
            Head::They => match () {
                () if self.last.len() > 1 => self.last.clone(),
                () if !self.set.is_empty() => self.set.clone(),
                () => self.everybody(),
            },
            Head::Who => self.last.clone(),
            Head::Bare => self.bare(noun),
            Head::Name(name) => self.named(noun, name),
            Head::Role(role) => self.role(noun, role),
        }
    }

    /// Whoever was named last and may be a woman, or a man, as the pronoun says.
    fn one_named_last(&mut self, female: Option<bool>) -> People {
        let others = self.before.iter().copied().chain(self.everybody().into_iter().rev());
        // `a man with two children; he …` is no child.
        let one = self.before.iter().copied().filter(|_| self.before.len() == 1 && self.last.len() > 1);
        let all: People = one.chain(self.last.iter().copied()).chain(others).collect();
        let all = || all.iter().copied().filter(|person| !self.excluded.contains(person));
        let may = |person: &usize| female.is_none() || self.female.get(person).is_none_or(|own| Some(*own) == female);
        let found = all().find(may).or_else(|| self.last.first().copied());
        if let (Some(person), Some(female)) = (found, female) {
            self.female.entry(person).or_insert(female);
        }
        found.into_iter().collect()
    }

    /// Whoever was named last and is known to be a woman, or a man, as a word says; else the last of whom that is not known.
    fn one_like(&self, female: Option<bool>) -> People {
        let all = || self.last.iter().copied().chain(self.everybody().into_iter().rev());
        let known = all().find(|person| female.is_some() && self.female.get(person).copied() == female);
        known.or_else(|| all().find(|person| !self.female.contains_key(person))).into_iter().collect()
    }

    /// `the first`, `two of them`, `the others`, `both`.
    fn bare(&mut self, noun: &Noun) -> People {
        let base = match &noun.of {
            Some(of) => {
                // `all four of the people`: there are four.
                let count = of.count.or(noun.count.filter(|_| noun.pick == Pick::All && of.generic));
                let of = vec![Noun { count, ..(**of).clone() }];
                let base = self.people(&of);
                if base.len() > 1 && base != self.set {
                    (self.set, self.picked) = (base.clone(), People::new());
                }
                base
            }
            // `all three`, of two and one who were named.
            None if noun.count.is_some_and(|count| usize::try_from(count) == Ok(self.roles.len()))
                && matches!(noun.pick, Pick::All | Pick::None | Pick::The) =>
            {
                self.everybody()
            }
            None if !self.set.is_empty() => self.set.clone(),
            None => self.everybody(),
        };
        if let Some(except) = &noun.except {
            // `all but one`: but for the last.
            let bare = except.head == Head::Bare && except.ordinal.is_none() && except.pick == Pick::Some;
            let except = Noun { ordinal: except.ordinal.or(bare.then_some(0)), ..(**except).clone() };
            let except = self.picks(&except, &base).unwrap_or_default();
            let rest: People = base.into_iter().filter(|person| !except.contains(person)).collect();
            self.picked.clone_from(&rest);
            return rest;
        }
        match self.picks(noun, &base) {
            Some(people) => people,
            // `the five`, `both`, `none` of too few: as many as there are.
            None if matches!(noun.pick, Pick::The | Pick::All | Pick::None | Pick::Others | Pick::Former)
                && noun.ordinal.is_none()
                && !(noun.pick == Pick::Others && base.len() == 1) =>
            {
                base
            }
            None if noun.of.is_some() => base,
            None => {
                let role = base.first().and_then(|person| self.roles.get(*person)).cloned();
                let another =
                    role.filter(|_| matches!(noun.pick, Pick::Another | Pick::Others) || noun.ordinal.is_some());
                self.new_people(noun, &another.unwrap_or_else(|| "person".to_owned()))
            }
        }
    }

    /// Those of some people whom a phrase picks; none where there are too few.
    fn picks(&mut self, noun: &Noun, base: &[usize]) -> Option<People> {
        let count = noun.count.map(|count| usize::try_from(count).unwrap_or(MOST));
        let free: People = base.iter().copied().filter(|person| !self.picked.contains(person)).collect();
        let people: People = match (noun.pick, noun.ordinal) {
            (Pick::All | Pick::None, _) => base.to_vec(),
            (_, Some(0)) => base.iter().copied().skip(base.len().checked_sub(count.unwrap_or(1))?).collect(),
            (_, Some(number)) => {
                let skip = usize::try_from(number).ok()?.checked_sub(1)?;
                base.iter().copied().skip(skip).take(count.unwrap_or(1)).collect()
            }
            (Pick::Former, _) => base.iter().copied().take(1).collect(),
            (Pick::Others, _) => {
                let rest: People = base.iter().copied().filter(|person| !self.picked.contains(person)).collect();
                let rest = if rest.len() == base.len() {
                    base.iter().copied().filter(|person| !self.last.contains(person)).collect()
                } else {
                    rest
                };
                let rest: People = rest.into_iter().take(count.unwrap_or(MOST)).collect();
                if rest.is_empty() {
                    self.others.iter().copied().filter(|other| base.contains(other)).collect()
                } else {
                    self.others.clone_from(&rest);
                    rest
                }
            }
            (Pick::Another, _) => {
                free.into_iter().filter(|person| !self.last.contains(person)).take(count.unwrap_or(1)).collect()
            }
            (Pick::The, None) => base.iter().copied().take(count.unwrap_or(1)).collect(),
            (Pick::Plain | Pick::Some, None) => free.into_iter().take(count.unwrap_or(1)).collect(),
        };
        if people.is_empty() || count.is_some_and(|count| people.len() < count) {
            return None;
        }
        if people.len() < base.len() {
            self.picked.extend(people.iter().copied());
        }
        Some(people)
    }

    fn role(&mut self, noun: &Noun, role: &str) -> People {
        let count =
            noun.count.map_or(if noun.several { SEVERAL } else { 1 }, |count| usize::try_from(count).unwrap_or(MOST));
        let anybody = ANYBODY.contains(&role);
        if self.tells
            && !matches!(noun.pick, Pick::The | Pick::None)
            && !self.unnamed.is_empty()
            && self.unnamed.len() >= count
            && (self.exact || self.anybody(&self.unnamed))
        {
            let named: People = self.unnamed.drain(..count).collect();
            for person in &named {
                if let Some(own) = self.roles.get_mut(*person) {
                    role.clone_into(own);
                }
            }
            return named;
        }
        let known: People = match () {
            () if anybody && noun.known_by.is_some() => {
                let known = |person: &usize| self.relations.get(person).copied() == noun.known_by;
                self.everybody().into_iter().filter(known).collect()
            }
            () if anybody && !self.set.is_empty() && noun.several => self.set.clone(),
            () if anybody => self.everybody(),
            // `the first guy`
            () if noun.by_looks && noun.ordinal.is_some() && self.set.is_empty() => self.everybody(),
            () if noun.by_looks && noun.ordinal.is_some() => self.set.clone(),
            () => self
                .everybody()
                .into_iter()
                .filter(|person| self.roles.get(*person).is_some_and(|own| own == role))
                .collect(),
        };
        let found = match noun.pick {
            Pick::Some | Pick::Another => None,
            // `the boys`, of whom nobody was called so: those of whom was spoken.
            Pick::The | Pick::All if known.is_empty() && noun.several && self.set.len() >= SEVERAL => {
                Some(self.set.clone())
            }
            // `his colleague`, of two: the other one.
            Pick::The if known.is_empty() && noun.mate && !noun.several && self.set.len() == SEVERAL => {
                let other = self.set.iter().copied().find(|person| !self.last.contains(person));
                other.map(|person| vec![person])
            }
            // `the boy` is her son.
            Pick::The if known.is_empty() && noun.by_looks && !noun.several && noun.ordinal.is_none() => {
                let found = self.one_like(noun.female);
                (!found.is_empty()).then_some(found)
            }
            _ if known.is_empty() => None,
            Pick::The | Pick::Plain if noun.ordinal.is_none() && noun.count.is_none() && !noun.several => {
                let recent = self.last.iter().rev().find(|person| known.contains(person)).copied();
                recent
                    .or_else(|| known.last().copied())
                    .filter(|_| noun.pick == Pick::The || known.len() == 1)
                    .map(|person| vec![person])
            }
            Pick::The | Pick::Plain if noun.several && noun.ordinal.is_none() => {
                Some(known).filter(|known| known.len() > 1 && noun.count.is_none_or(|_| known.len() == count))
            }
            Pick::The | Pick::Plain | Pick::All | Pick::None | Pick::Others | Pick::Former => self.picks(noun, &known),
        };
        match (found, noun.pick) {
            (Some(people), _) => people,
            (None, Pick::None) => People::new(),
            (None, _) => self.new_people(noun, role),
        }
    }

    /// Somebody by name, who may have a role beside it.
    fn named(&mut self, noun: &Noun, name: &str) -> People {
        let known = self.names.get(name).copied();
        let person = match known {
            Some(person) => person,
            None => {
                let role = noun.beside.clone().unwrap_or_else(|| "person".to_owned());
                // Those of whom a colon tells: `two interns: Anna and Ben`.
                let unnamed =
                    if noun.beside.is_none() && !self.unnamed.is_empty() { Some(self.unnamed.remove(0)) } else { None };
                let person =
                    unnamed.or_else(|| self.numbered(noun)).or_else(|| self.nameless(noun)).unwrap_or(self.roles.len());
                if person == self.roles.len() {
                    self.roles.push(role);
                }
                self.names.insert(name.to_owned(), person);
                if let Some((_, label)) = name.rsplit_once(' ') {
                    self.names.insert(label.to_owned(), person);
                }
                person
            }
        };
        vec![person]
    }

    /// The first of several who has no name, where a name comes up that nobody has.
    fn nameless(&self, noun: &Noun) -> Option<usize> {
        let named = |person: &usize| self.names.values().any(|own| own == person);
        self.set.iter().copied().find(|person| noun.beside.is_none() && noun.ordinal.is_none() && !named(person))
    }

    /// `worker 2` of several workers; `B` of several people.
    fn numbered(&self, noun: &Noun) -> Option<usize> {
        let number = usize::try_from(noun.ordinal?).ok()?;
        let role = noun.beside.as_deref();
        // `w2` of two workers.
        let initial = if let Head::Name(name) = &noun.head { name.chars().next() } else { None };
        let label = |own: &String| initial.is_some() && own.chars().next() == initial && role.is_none();
        let fits =
            |own: &String| role.map_or_else(|| ANYBODY.contains(&own.as_str()) || label(own), |role| own == role);
        let all = self.everybody().into_iter().filter(|person| self.roles.get(*person).is_some_and(fits));
        let all: People =
            all.filter(|person| !self.names.iter().any(|(name, named)| named == person && !is_label(name))).collect();
        if all.len() > 1 { all.get(number.checked_sub(1)?).copied() } else { None }
    }

    fn new_people(&mut self, noun: &Noun, role: &str) -> People {
        let count = match noun.count {
            Some(count) => usize::try_from(count).unwrap_or(MOST).min(MOST),
            None if noun.several => SEVERAL,
            None => 1,
        };
        let first = self.roles.len();
        // `a second nurse` is one more.
        let count = if noun.ordinal.is_some() && noun.count.is_none() { 1 } else { count };
        self.roles.extend(std::iter::repeat_n(role.to_owned(), count));
        let people: People = (first..first + count).collect();
        let any = noun.generic || ANYBODY.contains(&role);
        if any && (self.asks || noun.several && noun.count.is_none() && noun.pick == Pick::Plain) {
            self.vague.extend(&people);
        }
        if count > 1 {
            self.fresh.clone_from(&people);
        }
        if count == 1 && !self.set.is_empty() && noun.pick == Pick::Another {
            self.set.extend(people.iter().copied());
        }
        people
    }
}

/// Whether a name is a number or letter, perhaps behind a role: `w2`, `loader b`.
fn is_label(name: &str) -> bool {
    let last = name.rsplit(' ').next().unwrap_or(name);
    last.len() == 1 || last.ends_with(char::is_numeric)
}

/// The sign by which somebody is asked for an act.
const fn sign_for(act: Act) -> Option<Gesture> {
    match act {
        Act::GiveWay | Act::RunAway => Some(Gesture::ExcuseMe),
        Act::StandStill | Act::Block => Some(Gesture::Wait),
        Act::Follow | Act::Approach => Some(Gesture::FollowMe),
        Act::Navigate => Some(Gesture::Proceed),
        Act::Look | Act::TurnBack | Act::Sign => None,
    }
}
