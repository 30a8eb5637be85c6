//! Reads noun phrases: `the first two of the workers`, `an elderly man`, `all but the last`, `ped A`.

use crate::lexicon::Lexicon;
use crate::name::{Reader, gender};
use crate::noun::{BRISK_MPS, Head, Noun, Pick, SLOW_MPS};
use crate::token::{Bent, Kind, Sort, Token};

/// How many a group is of whom no number is said.
const FEW: u32 = 3;
/// As many people as no scenario may have.
const MANY: u32 = 41;
/// Words that may stand between an article and its noun.
const MODIFIERS: usize = 5;

fn token_role(head: &Head) -> String {
    if let Head::Role(role) = head { role.clone() } else { String::new() }
}

/// The noun phrase that begins at a token.
pub(crate) fn noun(tokens: &[Token], at: usize, lexicon: &Lexicon) -> Option<Noun> {
    let mut reader = Reader { tokens, lexicon, at, deep: false };
    let mut noun = reader.noun()?;
    noun.tokens = at..reader.at;
    Some(noun)
}

impl Reader<'_> {
    pub(crate) fn noun(&mut self) -> Option<Noun> {
        let start = self.at;
        // `each other` is nobody of their own.
        let next_is = |sort| self.tokens.get(self.at + 1).is_some_and(|next| next.is(sort));
        let before = self.at.checked_sub(1).and_then(|at| self.tokens.get(at));
        let each_other = self.peek()?.is(Sort::Every) && next_is(Sort::Other);
        if each_other || self.peek()?.is(Sort::Other) && before.is_some_and(|before| before.is(Sort::Every)) {
            return None;
        }
        if let Some(noun) = self.pronoun().or_else(|| self.name()) {
            return Some(noun);
        }
        let mut noun = Noun::new(Head::Bare, start..start);
        let mut told = false;
        // `all of the`, `none of`, `each`
        for (sort, pick) in [(Sort::Every, Pick::All), (Sort::Nobody, Pick::None), (Sort::No, Pick::None)] {
            if self.take(sort) {
                (noun.pick, told) = (pick, true);
            }
        }
        if noun.pick == Pick::All && self.peek().is_some_and(|token| token.is(Sort::They)) {
            self.at += 1;
            noun.head = Head::They;
            return Some(noun);
        }
        // `all but the last`
        if noun.pick == Pick::All && self.peek().is_some_and(|token| token.is(Sort::But)) {
            let back = self.at;
            self.at += 1;
            match self.noun() {
                Some(except) => {
                    noun.except = Some(Box::new(except));
                    return Some(noun);
                }
                None => self.at = back,
            }
        }
        told |= self.determiner(&mut noun);
        told |= self.numbers(&mut noun);
        // `both the first and the second`: the first.
        if noun.pick == Pick::All && noun.ordinal.is_some() {
            noun.pick = Pick::The;
        }
        if self.head(&mut noun, told) {
            self.label(&mut noun);
            self.of(&mut noun);
            return Some(noun);
        }
        self.without_head(noun, told)
    }

    fn determiner(&mut self, noun: &mut Noun) -> bool {
        let Some(token) = self.peek() else { return false };
        let pick = match () {
            () if token.lemma == "another" => Pick::Another,
            () if token.is(Sort::Indefinite) => Pick::Some,
            () if token.is(Sort::Definite) || token.is(Sort::Possessive) => Pick::The,
            () => return false,
        };
        self.at += 1;
        if !matches!(noun.pick, Pick::All | Pick::None) {
            noun.pick = pick;
        }
        true
    }

    /// Numbers, ordinals, `other`, `former`, in any order.
    fn numbers(&mut self, noun: &mut Noun) -> bool {
        let start = self.at;
        while let Some(token) = self.peek() {
            let words = &self.lexicon.words;
            if token.is(Sort::Other) && noun.pick == Pick::None {
                // `no other people`
            } else if token.is(Sort::Other) {
                noun.pick = if noun.pick == Pick::Some { Pick::Another } else { Pick::Others };
            } else if token.is(Sort::Former) {
                noun.pick = Pick::Former;
            } else if let Some(ordinal) = words.ordinals.get(&token.lemma).filter(|_| {
                noun.pick != Pick::Plain
                    || self.at > start
                    || self
                        .tokens
                        .get(self.at + 1)
                        .is_some_and(|next| next.is(Sort::Role) || next.is(Sort::People) || next.lemma == "one")
            }) {
                noun.ordinal = Some(*ordinal);
            } else if token.is(Sort::Number)
                && let Some(number) = self.tokens.get(self.at + 1).and_then(|next| self.number_of(next))
            {
                (noun.ordinal, noun.pick) = (Some(number), Pick::The);
                self.at += 1;
            } else if let Some(count) = self.count() {
                if self.tokens.get(self.at + 1).is_some_and(|next| self.is_unit(next)) {
                    break;
                }
                noun.count = Some(count);
                if noun.pick == Pick::Plain {
                    noun.pick = Pick::Some;
                }
            } else {
                break;
            }
            self.at += 1;
        }
        self.at > start
    }

    pub(crate) fn count(&self) -> Option<u32> {
        let token = self.peek()?;
        // `10000 people`: more than there can be, and said so.
        let people = self.tokens.get(self.at + 1).is_some_and(|next| next.is(Sort::People) || next.is(Sort::Role));
        let many = token.number().filter(|number| people && number.fract().abs() < f64::EPSILON && *number > 0.0);
        self.number_of(token).or_else(|| many.map(|_| MANY))
    }

    pub(crate) fn number_of(&self, token: &Token) -> Option<u32> {
        match token.kind {
            Kind::Number(number) if number.fract().abs() < f64::EPSILON && (0.0..=40.0).contains(&number) => {
                format!("{number}").parse().ok()
            }
            Kind::Word => self.lexicon.words.numbers.get(&token.lemma).copied(),
            Kind::Number(_) | Kind::Mark(_) => None,
        }
    }

    pub(crate) fn is_unit(&self, token: &Token) -> bool {
        let words = &self.lexicon.words;
        words.meters.contains_key(&token.lemma) || words.seconds.contains_key(&token.lemma)
    }

    /// Whether a word may stand before a role: `an elderly forklift driver`.
    fn modifies(&self, token: &Token, told: bool) -> bool {
        // `at the junction an old man`: another noun phrase begins.
        let words = &self.lexicon.words;
        let begins = token.is(Sort::Indefinite)
            || token.is(Sort::Definite)
            || words.numbers.contains_key(&token.lemma) && token.lemma != "one";
        token.kind == Kind::Word
            && !begins
            && (token.is(Sort::Looks)
                || token.is(Sort::Thing)
                || token.is(Sort::Slow)
                || token.is(Sort::Brisk)
                || token.is(Sort::Role)
                || told && matches!(token.bent, Bent::Ing | Bent::Ed)
                || told && token.sorts.is_empty())
    }

    /// Whether a word from here to the role compares people: `the older nurse`.
    fn compared(&self, start: usize) -> bool {
        let words = self.tokens.get(start..self.at).unwrap_or_default();
        words.iter().any(|word| word.is(Sort::Looks) && word.spelled.ends_with("er"))
    }

    /// How many `some people` are.
    fn few(&self, noun: &Noun) -> Option<u32> {
        let some = self.tokens.get(noun.tokens.start).is_some_and(|first| first.lemma == "some");
        (some && noun.several && noun.pick == Pick::Some).then_some(FEW)
    }

    /// The role, with the words before it.
    fn head(&mut self, noun: &mut Noun, told: bool) -> bool {
        let start = self.at;
        let mut pace = None;
        while self.at - start <= MODIFIERS {
            let Some(token) = self.peek() else { break };
            let next = self.tokens.get(self.at + 1);
            let compound = |next: &Token| next.is(Sort::Role) || next.is(Sort::People) || next.is(Sort::Robot);
            if token.is(Sort::Robot) {
                noun.head = Head::Robot;
                noun.several = false;
                self.at += 1;
                return true;
            }
            // `the older one`
            if token.lemma == "one" && told && self.at > start {
                noun.compared = self.compared(start);
                noun.count = Some(1);
                self.at += 1;
                return true;
            }
            if (token.is(Sort::Role) || token.is(Sort::People))
                && !matches!(token.bent, Bent::Ing | Bent::Ed)
                && !next.is_some_and(compound)
            {
                noun.head = Head::Role(token.lemma.clone());
                noun.several =
                    token.bent == Bent::S || token.lemma == "people" || noun.count.is_some_and(|count| count > 1);
                noun.count = noun.count.or_else(|| self.few(noun));
                noun.pace_mps = pace;
                noun.modifiers = self
                    .tokens
                    .get(start..self.at)
                    .unwrap_or_default()
                    .iter()
                    .map(|token| token.lemma.clone())
                    .collect();
                noun.compared = self.compared(start);
                noun.generic = token.is(Sort::People);
                noun.mate = token.is(Sort::Mate);
                noun.by_looks = token.is(Sort::Seen);
                noun.female = gender(token);
                self.at += 1;
                // `nurse Agnes`
                if self.peek().is_some_and(|next| next.is(Sort::Called))
                    && self.tokens.get(self.at + 1).is_some_and(|next| next.capital)
                {
                    self.at += 1;
                }
                let long = self.peek().is_some_and(|next| {
                    next.spelled.len() > 1 && !next.spelled.ends_with(|c: char| c.is_ascii_digit())
                });
                if noun.generic && !noun.several {
                    self.apposition(noun);
                }
                if !noun.several
                    && long
                    && let Some(name) = self.name()
                    && let Head::Name(own) = name.head
                {
                    noun.beside = name.beside.or_else(|| Some(token_role(&noun.head)));
                    noun.head = Head::Name(own);
                }
                return true;
            }
            let acts = |next: &Token| {
                next.is(Sort::Verb) && next.bent == Bent::S
                    || next.is(Sort::Be)
                    || next.is(Sort::Who)
                    || next.is(Sort::Modal)
            };
            let sounds = token.sorts.is_empty()
                && token.bent == Bent::Base
                && self.lexicon.words.sounds_like_a_person(&token.spelled);
            if told && sounds && matches!(noun.pick, Pick::Some | Pick::The) && next.is_some_and(acts) {
                noun.head = Head::Role(token.lemma.clone());
                self.at += 1;
                return true;
            }
            if token.is(Sort::Group) && (told || next.is_some_and(|next| next.is(Sort::Of))) {
                return self.group(noun);
            }
            // `a limping man`, `two order pickers`
            let several = noun.count.is_some_and(|count| count > 1);
            let plural = |next: &Token| several && token.bent == Bent::Base && next.bent == Bent::S;
            let before_role = token.is_said()
                && next.is_some_and(|next| {
                    (next.is(Sort::Role) || next.is(Sort::People)) && (token.spelled.ends_with("ing") || plural(next))
                });
            if !self.modifies(token, told) && !before_role {
                break;
            }
            if token.is(Sort::Slow) {
                pace = Some(SLOW_MPS);
            } else if token.is(Sort::Brisk) {
                pace = Some(BRISK_MPS);
            }
            self.at += 1;
        }
        self.at = start;
        false
    }

    /// `a group of three visitors`, `a pair of nurses`, `a couple`.
    fn group(&mut self, noun: &mut Noun) -> bool {
        // `in two groups of three` tells how they stand.
        let start = noun.tokens.start;
        let stand =
            start.checked_sub(1).and_then(|at| self.tokens.get(at)).is_some_and(|before| before.is(Sort::Forms));
        if stand {
            return false;
        }
        let own = self.peek().and_then(|token| match token.lemma.as_str() {
            "pair" | "couple" | "dyad" | "duo" => Some(2),
            "trio" => Some(3),
            _ => None,
        });
        self.at += 1;
        let back = self.at;
        if self.take(Sort::Of)
            && let Some(members) = self.noun()
        {
            let pick = noun.pick;
            // `a group of children`: more than two; `a family of four`.
            let count = members.count.or(own).or_else(|| (pick == Pick::Some).then_some(FEW));
            let head = if members.head == Head::Bare { Head::Role("person".to_owned()) } else { members.head.clone() };
            *noun = Noun { head, pick, count, several: true, group: true, ..members };
            return true;
        }
        self.at = back;
        // `as a group` tells how, and not who.
        if own.is_none() && noun.pick != Pick::The {
            self.at = back - 1;
            return false;
        }
        if let Some(count) = own.or(noun.count) {
            *noun = Noun {
                head: Head::Role("person".to_owned()),
                count: Some(count),
                several: true,
                group: true,
                ..noun.clone()
            };
            return true;
        }
        (noun.head, noun.several) = (Head::They, true);
        true
    }

    /// `two of the workers`.
    fn of(&mut self, noun: &mut Noun) {
        let back = self.at;
        if noun.head == Head::Bare && self.take(Sort::Of) {
            if self.peek().is_some_and(|token| token.is(Sort::Who)) {
                let who = Noun::new(Head::Who, self.at..self.at + 1);
                self.at += 1;
                noun.of = Some(Box::new(who));
                return;
            }
            match self.noun() {
                Some(of) if of.head != Head::Robot => noun.of = Some(Box::new(of)),
                Some(_) | None => self.at = back,
            }
        }
    }

    /// A number or ordinal that stands for people: `the first`, `one of them`, `both`, `none`.
    fn without_head(&mut self, mut noun: Noun, told: bool) -> Option<Noun> {
        let picks = matches!(noun.pick, Pick::All | Pick::None | Pick::Others | Pick::Another | Pick::Former)
            || noun.ordinal.is_some()
            || noun.count.is_some();
        if !told || !picks {
            return None;
        }
        self.of(&mut noun);
        // `at 4`, `around ten`: a number alone is nobody, unless they do something.
        let alone = noun.pick == Pick::Some && noun.ordinal.is_none();
        // `at ten`, `a quarter to eight`: a time, or an amount.
        let before = noun.tokens.start.checked_sub(1).and_then(|at| self.tokens.get(at));
        let told_when = |token: &Token| {
            [Sort::At, Sort::To, Sort::For, Sort::Until, Sort::From].iter().any(|sort| token.is(*sort))
                || token.lemma == "half"
        };
        if alone && noun.of.is_none() && noun.pick == Pick::Some && before.is_some_and(told_when) {
            return None;
        }
        let figure =
            self.at.checked_sub(1).and_then(|at| self.tokens.get(at)).is_some_and(|last| last.number().is_some());
        let acts = |token: &Token| {
            token.is(Sort::Of)
                || token.is(Sort::Verb)
                || token.is(Sort::Be)
                || token.is(Sort::Do)
                || token.is(Sort::Modal)
        };
        let several = noun.count.is_some_and(|count| count > 1);
        if alone
            && figure
            && noun.of.is_none()
            && self.peek().is_some_and(|token| token.is(Sort::Be) || token.is(Sort::Of) || token.is(Sort::Have))
        {
            return None;
        }
        // `a few steps behind`: of several people it would be `step`.
        let bent = self.peek().is_some_and(|next| next.bent == Bent::S && !next.is(Sort::Be) && !next.is(Sort::Have));
        let of_group =
            noun.tokens.start.checked_sub(1).and_then(|at| self.tokens.get(at)).is_some_and(|of| of.is(Sort::Of));
        if several && alone && bent && noun.of.is_none() && !of_group {
            return None;
        }
        // `two oncoming`
        let told = several && !figure && self.peek().is_some_and(|next| next.is(Sort::Looks) || next.sorts.is_empty());
        let counts = alone && (figure || several);
        // `four of them: 2 from the front, 1 from behind`
        let listed = figure
            && before.is_none_or(|before| !before.is_said())
            && self.peek().is_some_and(|next| next.is(Sort::From));
        if counts && !told && !listed && !self.peek().is_some_and(acts) {
            return None;
        }
        let ends = |token: &Token| {
            let joins = [
                Sort::And,
                Sort::But,
                Sort::Be,
                Sort::Do,
                Sort::Have,
                Sort::Modal,
                Sort::Not,
                Sort::Of,
                Sort::Who,
                Sort::When,
                Sort::While,
                Sort::Until,
                Sort::Before,
                Sort::After,
                Sort::Then,
                Sort::At,
                Sort::By,
                Sort::To,
                Sort::Verb,
                Sort::Cause,
            ];
            let number = self.lexicon.words.numbers.contains_key(&token.lemma);
            // `the last turn their heads`
            let owned = self.tokens.get(self.at + 1).is_some_and(|next| next.is(Sort::Possessive) || next.is(Sort::To));
            !token.is_said()
                || token.is(Sort::Verb) && (token.is(Sort::Empty) && owned || token.bent == Bent::S)
                || !token.is(Sort::Empty) && joins.iter().any(|sort| token.is(*sort))
                || token.spelled.ends_with("ly")
                || token.is(Sort::Fill) && !token.is(Sort::Empty)
                || number
        };
        let alone = noun.of.is_some() || self.peek().is_none_or(ends);
        (alone && noun.pick != Pick::None || noun.of.is_some() || noun.pick == Pick::None && alone).then(|| {
            noun.several = noun.count.map_or(noun.pick == Pick::All, |count| count > 1);
            noun
        })
    }
}
