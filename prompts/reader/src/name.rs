//! Reads pronouns, names, and what stands beside them: `she`, `Mrs. Whitcombe`, `Maria, a young nurse`, `worker 2`.

use crate::lexicon::Lexicon;
use crate::noun::{Head, Noun, Pick};
use crate::token::{Bent, Kind, Mark, Sort, Token};

/// Where a noun phrase is being read.
pub(crate) struct Reader<'a> {
    pub(crate) tokens: &'a [Token],
    pub(crate) lexicon: &'a Lexicon,
    pub(crate) at: usize,
    /// Whether what stands beside a name is being read.
    pub(crate) deep: bool,
}

/// Whether a word means a woman, or a man.
pub(crate) fn gender(token: &Token) -> Option<bool> {
    (token.is(Sort::Female) || token.is(Sort::Male)).then(|| token.is(Sort::Female))
}
impl Reader<'_> {
    pub(crate) fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.at)
    }

    pub(crate) fn take(&mut self, sort: Sort) -> bool {
        let found = self.peek().is_some_and(|token| token.is(sort));
        self.at += usize::from(found);
        found
    }

    /// `he`, `it`, `someone`, `her` where no noun follows.
    pub(crate) fn pronoun(&mut self) -> Option<Noun> {
        let token = self.peek()?;
        let next = self.tokens.get(self.at + 1);
        // `lets her go first`
        let before = self.at.checked_sub(1).and_then(|at| self.tokens.get(at));
        let begins = before.is_none_or(|before| before.is_mark(Mark::Stop));
        let lets = begins || before.is_some_and(|before| before.is(Sort::Lets));
        let does = lets
            && next.is_some_and(|next| {
                next.is(Sort::Verb) && next.bent == Bent::Base && !next.is(Sort::Empty) && !next.is(Sort::Role)
            });
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
        noun.reflexive = token.is(Sort::Fill) && noun.head != Head::It;
        noun.female = gender(token);
        if matches!(noun.head, Head::Role(_)) {
            noun.pick = Pick::Some;
        }
        self.at += 1;
        // `someone else`
        if noun.pick == Pick::Some && self.peek().is_some_and(|next| next.lemma == "else") {
            noun.pick = Pick::Another;
            self.at += 1;
        }
        Some(noun)
    }

    /// `Tom`, `Mrs. Whitcombe`: a word with a capital that nobody knows.
    pub(crate) fn name(&mut self) -> Option<Noun> {
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
        let article = at
            .checked_sub(1)
            .and_then(|at| self.tokens.get(at))
            .is_some_and(|before| before.is(Sort::Indefinite) || before.is(Sort::Definite));
        let letter = !of_label
            && !article
            && (token.capital && matches!(token.spelled.as_bytes(), [b'b'..=b'h'])
                || token.capital && token.spelled == "a" && next_acts);
        let digit = token.spelled.len() <= 4
            && token.kind == Kind::Word
            && token.spelled.ends_with(|c: char| c.is_ascii_digit())
            && !token.spelled.contains('.')
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
                || next.is(Sort::From)
                || next.sorts == only
                || next.is_mark(Mark::Comma)
                || next.is_mark(Mark::Open)
                || next.spelled == crate::token::OWNS
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
    pub(crate) fn apposition(&mut self, noun: &mut Noun) {
        let back = self.at;
        let opens = self.peek().is_some_and(|token| token.is_mark(Mark::Comma) || token.is_mark(Mark::Open));
        let article = |token: &Token| {
            token.is(Sort::Indefinite) || token.is(Sort::Definite) && !token.is(Sort::Who) || token.is(Sort::Possessive)
        };
        // `Dieter the planner`
        let the = self.peek().is_some_and(|token| token.is(Sort::Definite) && !token.is(Sort::Who));
        if let Some(role) =
            self.tokens.get(self.at + 1).filter(|role| the && role.is(Sort::Role) && role.bent == Bent::Base)
        {
            noun.beside = Some(role.lemma.clone());
            self.at += 2;
            return;
        }
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
    pub(crate) fn can_be_owned(token: &Token) -> bool {
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

    /// `worker 2`, `visitor B`.
    pub(crate) fn label(&mut self, noun: &mut Noun) {
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
}
