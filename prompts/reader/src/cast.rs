//! People: whom a noun phrase means.
//!
//! They are numbered from 0 as they are named. Whoever was named last is `he`; the last several are `they`, and those of whom
//! `one`, `the second` and `the others` are spoken.

use std::collections::BTreeMap;
use std::ops::Range;

use socrates_model::{Gesture, Relation};

use crate::lexicon::Lexicon;
use crate::name::gender;
use crate::noun::{Head, Noun, Pick};
use crate::statement::{Deed, Named, Reason};
use crate::token::{Sort, Token};

/// People, by their numbers from 0.
pub type People = Vec<usize>;

/// Words that mean anybody.
pub(crate) const ANYBODY: &[&str] =
    &["person", "people", "human", "pedestrian", "individual", "participant", "actor", "agent", "somebody"];
/// How many several people are of whom no number is said.
const SEVERAL: usize = 2;
/// No phrase means more people than this, which is one more than a scenario may have.
const MOST: usize = 41;

/// Everybody of whom was spoken so far.
#[derive(Debug, Clone, Default)]
pub(crate) struct Cast {
    pub(crate) roles: Vec<String>,
    pub(crate) vague: People,
    pub(crate) plain: People,
    /// Those of whom is told what they do, or how fast.
    pub(crate) active: People,
    /// People who were named last.
    pub(crate) last: People,
    /// People who were named before them.
    pub(crate) before: People,
    /// The last several who were named together.
    pub(crate) set: People,
    /// Those of them who were picked since.
    pub(crate) picked: People,
    /// Whether somebody is a woman, or a man, as far as that was said.
    pub(crate) female: BTreeMap<usize, bool>,
    /// Those of whom a pronoun said so first, although others might have been meant.
    pub(crate) guessed: People,
    /// People by their names.
    pub(crate) names: BTreeMap<String, usize>,
    /// People whom a noun phrase meant, by its first token: said again by an ellipsis, it means the same.
    pub(crate) meant: BTreeMap<usize, People>,
    /// Those of whom a colon tells, who have no role yet.
    pub(crate) unnamed: People,
    /// Whether it tells of exactly as many: `visitors: a father and his son`.
    pub(crate) exact: bool,
    /// The same, of the statement that is being told.
    pub(crate) fresh: People,
    pub(crate) tells: bool,
    /// Whether a question is being told.
    pub(crate) asks: bool,
    /// What people react to from now on.
    pub(crate) pending: Vec<Reason<People>>,
    /// The sign that somebody made last, to which others react.
    pub(crate) signed: Option<(People, Reason<People>)>,
    /// What was asked for last.
    pub(crate) asked: Option<Gesture>,
    /// What was done last, or not done, for `the second does`.
    pub(crate) done: Option<Deed<People>>,
    /// How somebody was said last to stand to the robot's way, where nobody has done anything since.
    pub(crate) related: Option<Relation>,
    /// How everybody stands to it.
    pub(crate) relations: BTreeMap<usize, Relation>,
    /// Those who were told last to come somehow, and those before them.
    pub(crate) met: (People, People),
    /// Of whom a pronoun is not said: those who do it.
    pub(crate) excluded: People,
    /// What was said as a condition, and for which nobody has waited yet, by tokens.
    pub(crate) waiting: Option<Range<usize>>,
    /// Noun phrases of which it is not sure whom they mean, by tokens.
    pub(crate) doubts: Vec<Range<usize>>,
    /// People who were called the others last.
    pub(crate) others: People,
}

impl Cast {
    /// People of whom was spoken before, by their roles; `last` are those of whom it was last. They are called by their numbers as well.
    pub(crate) fn of(known: &[String], last: &[usize], lexicon: &Lexicon) -> Self {
        let roles: Vec<(String, Option<bool>)> = known.iter().map(|role| head_of(role, lexicon)).collect();
        let female = roles.iter().enumerate().filter_map(|(person, (_, female))| Some((person, (*female)?))).collect();
        let names = (0..roles.len()).flat_map(|person| {
            let called = |word: &&str| (format!("{word} {}", person + 1), person);
            ["human", "person"].iter().map(called).collect::<Vec<_>>()
        });
        Self {
            names: names.collect(),
            roles: roles.into_iter().map(|(role, _)| role).collect(),
            female,
            last: if known.len() == 1 { vec![0] } else { last.to_vec() },
            ..Self::default()
        }
    }

    pub(crate) fn people(&mut self, nouns: &Named) -> People {
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
    pub(crate) fn tell(&mut self, noun: &Noun, people: &[usize]) {
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
    pub(crate) fn anybody(&self, people: &[usize]) -> bool {
        people.iter().all(|person| self.roles.get(*person).is_some_and(|role| ANYBODY.contains(&role.as_str())))
    }

    pub(crate) fn is_part_of_set(&self, people: &[usize]) -> bool {
        people.len() < self.set.len() && people.iter().all(|person| self.set.contains(person))
    }

    pub(crate) fn everybody(&self) -> People {
        (0..self.roles.len()).collect()
    }

    /// People whom a noun phrase means; new people where nobody was named so.
    pub(crate) fn meant(&mut self, noun: &Noun) -> People {
        match &noun.head {
            Head::Robot => People::new(),
            Head::He | Head::It => self.one_named_last(noun),
            Head::They => match () {
                () if self.last.len() > 1 => self.last.clone(),
                () if !self.set.is_empty() => {
                    // Whoever was named since may be one of them.
                    if self.last.iter().any(|last| !self.set.contains(last)) {
                        self.doubts.push(noun.tokens.clone());
                    }
                    self.set.clone()
                }
                () => self.everybody(),
            },
            Head::Who => self.last.clone(),
            Head::Bare => self.bare(noun),
            Head::Name(name) => self.named(noun, name),
            Head::Role(role) => self.role(noun, role),
        }
    }

    /// Whoever was named last and may be a woman, or a man, as the pronoun says.
    pub(crate) fn one_named_last(&mut self, noun: &Noun) -> People {
        let female = noun.female;
        let others = self.before.iter().copied().chain(self.everybody().into_iter().rev());
        // `a man with two children; he …` is no child.
        let one = self.before.iter().copied().filter(|_| self.before.len() == 1 && self.last.len() > 1);
        let all: People = one.chain(self.last.iter().copied()).chain(others).collect();
        let all = || all.iter().copied().filter(|person| !self.excluded.contains(person));
        let may = |person: &usize| female.is_none() || self.female.get(person).is_none_or(|own| Some(*own) == female);
        let found = all().find(may).or_else(|| self.last.first().copied());
        // Somebody else is known to be a woman, or a man, as the pronoun says: either may be meant.
        let known = |person: &usize| female.is_some() && self.female.get(person).copied() == female;
        if let Some(found) = found.filter(|found| !known(found)) {
            let other = self.everybody().into_iter().any(|person| person != found && known(&person));
            // Of several who were named together nobody is singled out.
            let several = self.last.contains(&found) && self.last.iter().filter(|person| may(person)).count() > 1;
            let far = !self.last.is_empty() && !self.last.contains(&found) && !self.before.contains(&found);
            if far || other || several && noun.head == Head::He {
                self.doubts.push(noun.tokens.clone());
            }
        }
        // `A nurse crosses, and a doctor comes. She …, he …`: whichever of them is meant.
        if let Some(found) = found.filter(|found| female.is_some() && !self.female.contains_key(found)) {
            let mut others = self.everybody().into_iter().filter(|person| *person != found);
            if self.guessed.iter().any(|other| *other != found && self.female.get(other).copied() != female) {
                self.doubts.push(noun.tokens.clone());
            } else if others.any(|person| !self.female.contains_key(&person)) {
                self.guessed.push(found);
            }
        }
        if let (Some(person), Some(female)) = (found, female) {
            self.female.entry(person).or_insert(female);
        }
        found.into_iter().collect()
    }

    /// Whoever was named last and is known to be a woman, or a man, as a word says; else the last of whom that is not known.
    pub(crate) fn one_like(&self, female: Option<bool>) -> People {
        let all = || self.last.iter().copied().chain(self.everybody().into_iter().rev());
        let known = all().find(|person| female.is_some() && self.female.get(person).copied() == female);
        known.or_else(|| all().find(|person| !self.female.contains_key(person))).into_iter().collect()
    }

    /// `the first`, `two of them`, `the others`, `both`.
    pub(crate) fn bare(&mut self, noun: &Noun) -> People {
        let base = match &noun.of {
            Some(of) => {
                // `all four of the people`: there are four.
                let count = of.count.or_else(|| noun.count.filter(|_| noun.pick == Pick::All && of.generic));
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
            None if !self.set.is_empty() => {
                // Of two sets either may be meant.
                let others = self.everybody().into_iter().filter(|person| !self.set.contains(person)).count();
                if others > 1 && !matches!(noun.pick, Pick::Plain | Pick::Some | Pick::Another) {
                    self.doubts.push(noun.tokens.clone());
                }
                self.set.clone()
            }
            None => self.everybody(),
        };
        if let Some(except) = &noun.except {
            // `all but one`: but for the last.
            let bare = except.head == Head::Bare && except.ordinal.is_none() && except.pick == Pick::Some;
            let except = Noun { ordinal: except.ordinal.or_else(|| bare.then_some(0)), ..(**except).clone() };
            // `everyone except the wife`
            let except = match except.head {
                Head::Role(_) | Head::Name(_) => self.meant(&except),
                Head::Robot | Head::It | Head::He | Head::They | Head::Who | Head::Bare => {
                    self.picks(&except, &base).unwrap_or_default()
                }
            };
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
                // `a nurse comes towards the robot, and the two meet`: the robot is one of them.
                let with_robot = base.len() == 1 && noun.count == Some(2);
                if !with_robot && noun.count.is_some_and(|count| usize::try_from(count) != Ok(base.len())) {
                    self.doubts.push(noun.tokens.clone());
                }
                base
            }
            None if noun.of.is_some() => base,
            None => {
                let role = base.first().and_then(|person| self.roles.get(*person)).cloned();
                // `2 leave, 1 stays`: a number of nobody in particular.
                if role.is_none() {
                    self.doubts.push(noun.tokens.clone());
                }
                let another =
                    role.filter(|_| matches!(noun.pick, Pick::Another | Pick::Others) || noun.ordinal.is_some());
                self.new_people(noun, &another.unwrap_or_else(|| "person".to_owned()))
            }
        }
    }

    /// Those of some people whom a phrase picks; none where there are too few.
    pub(crate) fn picks(&mut self, noun: &Noun, base: &[usize]) -> Option<People> {
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
            // `the older one`, then `the younger one`
            (Pick::The, None) if noun.compared && !free.is_empty() => {
                free.into_iter().take(count.unwrap_or(1)).collect()
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

    pub(crate) fn role(&mut self, noun: &Noun, role: &str) -> People {
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
        // `A few people are in the elevator. Two people leave it.`: two of them.
        if anybody && noun.count.is_some() && self.is_idle_set() && count < self.set.len() {
            return self.picks(noun, &self.set.clone()).unwrap_or_default();
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
        let known_count = known.clone();
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
            Pick::The if noun.compared && known.len() > 1 && !noun.several => self.picks(noun, &known),
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
        // `all three nurses`, of two: somebody is meant who was not made out.
        let few = found.is_none() && !known_count.is_empty() && noun.count.is_some();
        if few && matches!(noun.pick, Pick::The | Pick::All | Pick::Others) {
            self.doubts.push(noun.tokens.clone());
        }
        match (found, noun.pick) {
            (Some(people), _) => people,
            (None, Pick::None) => People::new(),
            (None, _) => self.new_people(noun, role),
        }
    }

    /// Whether those who were named together are anybody, and nothing is told of them yet but that they are there.
    fn is_idle_set(&self) -> bool {
        let idle = |person: &usize| !self.active.contains(person) && !self.relations.contains_key(person);
        !self.set.is_empty() && self.picked.is_empty() && self.anybody(&self.set) && self.set.iter().all(idle)
    }

    /// Somebody by name, who may have a role beside it.
    pub(crate) fn named(&mut self, noun: &Noun, name: &str) -> People {
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
    pub(crate) fn nameless(&self, noun: &Noun) -> Option<usize> {
        let named = |person: &usize| self.names.values().any(|own| own == person);
        self.set.iter().copied().find(|person| noun.beside.is_none() && noun.ordinal.is_none() && !named(person))
    }

    /// `worker 2` of several workers; `B` of several people.
    pub(crate) fn numbered(&self, noun: &Noun) -> Option<usize> {
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

    pub(crate) fn new_people(&mut self, noun: &Noun, role: &str) -> People {
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
        // `Our porters like that. Two porters …`: how many there are is not said.
        if noun.pick == Pick::The && noun.several && noun.count.is_none() {
            self.vague.extend(&people);
        }
        if any && (self.asks || noun.several && noun.count.is_none() && noun.pick == Pick::Plain) {
            self.vague.extend(&people);
        }
        if noun.pick == Pick::Plain
            && noun.count.is_none()
            && noun.beside.is_none()
            && !matches!(noun.head, Head::Name(_))
        {
            self.plain.extend(&people);
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

/// The word by which somebody of a role is called, and whether it is a woman's or a man's: of several words the last that is a role.
fn head_of(role: &str, lexicon: &Lexicon) -> (String, Option<bool>) {
    let tokens = crate::lex::lex(role, &lexicon.words);
    let is_role = |token: &&Token| token.is(Sort::Role) || token.is(Sort::People);
    match tokens.iter().rfind(is_role) {
        Some(word) => (word.lemma.clone(), gender(word)),
        None => (role.to_lowercase(), None),
    }
}

/// Whether a name is a number or letter, perhaps behind a role: `w2`, `loader b`.
fn is_label(name: &str) -> bool {
    let last = name.rsplit(' ').next().unwrap_or(name);
    last.len() == 1 || last.ends_with(char::is_numeric)
}
