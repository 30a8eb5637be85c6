//! Reads noun phrases: `the first two of the workers`, `an elderly man`, `all but the last`, `ped A`.

use crate::lexicon::Lexicon;
use crate::noun::{BRISK_MPS, Head, Noun, Pick, SLOW_MPS};
use crate::token::{Bent, Kind, Mark, Sort, Token};

/// How many a group is of whom no number is said.
const FEW: u32 = 3;
/// So many words may stand between an article and its noun.
const MODIFIERS: usize = 5;

/// Whether a word means a woman, or a man.
fn gender(token: &Token) -> Option<bool> {
    (token.is(Sort::Female) || token.is(Sort::Male)).then(|| token.is(Sort::Female))
}

fn token_role(head: &Head) -> String {
    if let Head::Role(role) = head { role.clone() } else { String::new() }
}

struct Reader<'a> {
    tokens: &'a [Token],
    lexicon: &'a Lexicon,
    at: usize,
    /// Whether what stands beside a name is being read.
    deep: bool,
}

/// The noun phrase that begins at a token.
pub(crate) fn noun(tokens: &[Token], at: usize, lexicon: &Lexicon) -> Option<Noun> {
    let mut reader = Reader { tokens, lexicon, at, deep: false };
    let mut noun = reader.noun()?;
    noun.tokens = at..reader.at;
    Some(noun)
}

impl Reader<'_> {
    fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.at)
    }

    fn take(&mut self, sort: Sort) -> bool {
        let found = self.peek().is_some_and(|token| token.is(sort));
        self.at += usize::from(found);
        found
    }

    fn noun(&mut self) -> Option<Noun> {
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

    /// `he`, `it`, `someone`, `her` where no noun follows.
    fn pronoun(&mut self) -> Option<Noun> {
        let token = self.peek()?;
        let next = self.tokens.get(self.at + 1);
        // `lets her go first`
        let lets =
            self.at.checked_sub(1).and_then(|at| self.tokens.get(at)).is_some_and(|before| before.is(Sort::Lets));
        let does =
            lets && next.is_some_and(|next| next.is(Sort::Verb) && next.bent == Bent::Base && !next.is(Sort::Empty));
        let owns = token.is(Sort::Possessive) && next.is_some_and(Self::can_be_owned) && !does;
        let head = match () {
            () if token.is(Sort::He) && !owns => Head::He,
            () if token.is(Sort::They) => Head::They,
            () if token.is(Sort::It) && !owns => Head::It,
            () if token.is(Sort::Somebody) => Head::Role("person".to_owned()),
            () => return None,
        };
        let mut noun = Noun::new(head, self.at..self.at + 1);
        noun.several = noun.head == Head::They;
        noun.nominative = token.is(Sort::Nominative);
        noun.female = gender(token);
        if matches!(noun.head, Head::Role(_)) {
            noun.pick = Pick::Some;
        }
        self.at += 1;
        Some(noun)
    }

    /// `Tom`, `Mrs. Whitcombe`: a word with a capital that nobody knows.
    fn name(&mut self) -> Option<Noun> {
        let title = self.peek().filter(|token| token.is(Sort::Title));
        let role = title.and_then(|title| (title.lemma == "doctor").then(|| title.lemma.clone()));
        let at = self.at + usize::from(title.is_some());
        let token = self.tokens.get(at)?;
        let next_acts = self.tokens.get(at + 1).is_some_and(|next| {
            next.is(Sort::Be)
                || next.is(Sort::Do)
                || next.is(Sort::Modal)
                || !next.is_said()
                || next.is(Sort::And)
                || next.is(Sort::Verb) && next.bent == Bent::S
        });
        // `A walks ahead, B crosses`, `W1`, `ped2`.
        let of_label =
            at.checked_sub(1).and_then(|at| self.tokens.get(at)).is_some_and(|before| before.is(Sort::Label));
        let letter = !of_label
            && (token.capital && matches!(token.spelled.as_bytes(), [b'b'..=b'h'])
                || token.capital && token.spelled == "a" && next_acts);
        let digit = token.spelled.len() <= 4
            && token.kind == Kind::Word
            && token.spelled.ends_with(|c: char| c.is_ascii_digit())
            && token.sorts.is_empty();
        let words = &self.lexicon.words;
        let counts = words.numbers.contains_key(&token.lemma) || words.ordinals.contains_key(&token.lemma);
        let known = |token: &Token| {
            counts
                || !token.capital
                || !token.sorts.is_empty()
                || token.lemma != token.spelled
                || token.spelled.len() < 2
        };
        if known(token) && !letter && !digit {
            return None;
        }
        // Where a sentence begins, every word has a capital: a name is followed by a verb, or by a mark.
        let begins = at == 0 || self.tokens.get(at - 1).is_some_and(|before| !before.is_said());
        let only = crate::token::Sorts::default().with(Sort::Fill);
        let goes_on = |next: &Token| {
            let sorts = [Sort::Be, Sort::Do, Sort::Have, Sort::Modal, Sort::And, Sort::Who];
            letter
                || digit
                || sorts.iter().any(|sort| next.is(*sort))
                || next.is(Sort::Verb) && next.bent == Bent::S
                || next.sorts == only
                || next.is_mark(Mark::Comma)
                || next.is_mark(Mark::Open)
                || next.spelled == crate::lex::OWNS
        };
        if begins && title.is_none() && !self.tokens.get(at + 1).is_some_and(goes_on) {
            return None;
        }
        let letter_name = letter;
        let mut noun = Noun::new(Head::Name(token.spelled.clone()), self.at..at + 1);
        noun.pick = Pick::The;
        let last = token.spelled.chars().next_back();
        noun.ordinal = match token.spelled.as_bytes() {
            [letter] if letter_name => Some(u32::from(letter.saturating_sub(b'a')) + 1),
            _ => last.and_then(|last| last.to_digit(10)),
        };
        noun.beside = role;
        self.at = at + 1;
        self.apposition(&mut noun);
        Some(noun)
    }

    /// `Maria, a young nurse, …`: what somebody is, behind their name.
    fn apposition(&mut self, noun: &mut Noun) {
        let back = self.at;
        let opens = self.peek().is_some_and(|token| token.is_mark(Mark::Comma) || token.is_mark(Mark::Open));
        let article = |token: &Token| {
            token.is(Sort::Indefinite) || token.is(Sort::Definite) && !token.is(Sort::Who) || token.is(Sort::Possessive)
        };
        if !opens || !self.tokens.get(self.at + 1).is_some_and(article) || self.deep {
            return;
        }
        self.at += 1;
        self.deep = true;
        let role = self.noun();
        self.deep = false;
        // Not of a list: `Maria, a nurse and a guest`, `Maria, a nurse, a guest and the robot`.
        // `a nurse on ward 7, …`
        let closing = |token: &Token| token.is_mark(Mark::Comma) || token.is_mark(Mark::Close);
        let of = self.peek().is_some_and(|token| token.is(Sort::At) || token.is(Sort::Of) || token.is(Sort::From));
        let end = (self.at..self.at + 6).find(|at| self.tokens.get(*at).is_some_and(closing));
        if let Some(end) = end.filter(|_| of) {
            let said = self.tokens.get(self.at..end).unwrap_or_default();
            if !said.iter().any(|token| token.bent != Bent::Base || !token.is_said()) {
                self.at = end;
            }
        }
        let closes = self
            .peek()
            .is_none_or(|token| token.is_mark(Mark::Close) || token.is_mark(Mark::Comma) || token.is_mark(Mark::Dash));
        let next = self.tokens.get(self.at + 1);
        let list = next.is_some_and(article)
            || next.is_some_and(|next| next.is(Sort::And)) && {
                !self.tokens.get(self.at + 2).is_some_and(|name| name.capital)
            };
        match role {
            Some(Noun { head: Head::Role(role), several: false, count: None | Some(1), generic: false, .. })
                if closes && !list =>
            {
                noun.beside = Some(role);
                self.at += usize::from(self.peek().is_some());
            }
            Some(_) | None => self.at = back,
        }
    }

    /// Whether something can be somebody's: a thing, a part of the body, a way.
    fn can_be_owned(token: &Token) -> bool {
        let joins = [
            Sort::At,
            Sort::To,
            Sort::Of,
            Sort::By,
            Sort::And,
            Sort::But,
            Sort::When,
            Sort::While,
            Sort::Until,
            Sort::Before,
            Sort::After,
            Sort::Be,
            Sort::Modal,
            Sort::Not,
            Sort::Then,
            Sort::Who,
            Sort::Do,
            Sort::Cause,
            Sort::Definite,
            Sort::Indefinite,
        ];
        let acts = token.is(Sort::Verb) && token.bent == Bent::S
            || token.is(Sort::Fill) && token.lemma != "own" && !token.is(Sort::Empty) && !token.is(Sort::Verb);
        token.kind == Kind::Word
            && !acts
            && !joins.iter().any(|sort| token.is(*sort))
            && !matches!(token.bent, Bent::Ing | Bent::Ed)
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

    fn count(&self) -> Option<u32> {
        self.peek().and_then(|token| self.number_of(token))
    }

    fn number_of(&self, token: &Token) -> Option<u32> {
        match token.kind {
            Kind::Number(number) if number.fract().abs() < f64::EPSILON && (0.0..=40.0).contains(&number) => {
                format!("{number}").parse().ok()
            }
            Kind::Word => self.lexicon.words.numbers.get(&token.lemma).copied(),
            Kind::Number(_) | Kind::Mark(_) => None,
        }
    }

    fn is_unit(&self, token: &Token) -> bool {
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
                noun.pace_mps = pace;
                noun.modifiers = self
                    .tokens
                    .get(start..self.at)
                    .unwrap_or_default()
                    .iter()
                    .map(|token| token.lemma.clone())
                    .collect();
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
            let count = members.count.or(own).or((pick == Pick::Some).then_some(FEW));
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

    /// `worker 2`, `visitor B`.
    fn label(&mut self, noun: &mut Noun) {
        if matches!(noun.head, Head::Robot) || noun.several {
            return;
        }
        let Some(token) = self.peek() else { return };
        if self.tokens.get(self.at + 1).is_some_and(|next| self.is_unit(next)) {
            return;
        }
        let number = match (&token.kind, token.spelled.as_bytes()) {
            (Kind::Number(_), _) => self.count(),
            (Kind::Word, [letter @ b'a'..=b'h']) if token.capital => Some(u32::from(letter - b'a') + 1),
            _ => None,
        };
        if let (Some(number), Head::Role(role)) = (number, noun.head.clone()) {
            noun.ordinal = Some(number);
            noun.head = Head::Name(format!("{role} {}", token.spelled));
            (noun.beside, noun.pick) = (Some(role), Pick::The);
            self.at += 1;
        }
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
        if counts && !told && !self.peek().is_some_and(acts) {
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
                || token.is(Sort::Verb) && token.is(Sort::Empty) && owned
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
