//! Pass 4: chunks to clauses, by recursive descent. Passive, inversion, relative clauses and ellipsis are undone here and nowhere else.
//!
//! ```text
//! text      = sentence*
//! sentence  = ( join | condition | clause )*
//! condition = tie clause                                  when, until, before, after, while, unless
//! clause    = subject? ( act | amount | place | condition | filler )*
//! subject   = noun ( ("," | "and") noun )*
//! ```
//! A clause ends at a mark, at a join, and where another subject begins.

use std::ops::Range;

use socrates_model::{Gesture, PlaceClass};

use crate::chunk::{Amount, Chunk, Is};
use crate::find::{Found, longest};
use crate::lexicon::Lexicon;
use crate::noun::{BRISK_MPS, Head, Noun, Pick, SLOW_MPS};
use crate::token::{Bent, Mark, Sort};

/// How a clause follows the one before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Join {
    /// A sentence begins.
    Start,
    /// `and`, a comma.
    And,
    /// `but`, `whereas`.
    But,
    /// `then`, an arrow.
    Then,
    /// A colon, a bracket: what follows tells of what stands before.
    Colon,
}

/// How a condition is tied to its clause.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Tie {
    When,
    Until,
    Before,
    After,
    While,
    Unless,
}

/// A subordinate clause that says when.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Condition {
    pub(crate) tie: Tie,
    pub(crate) clause: Clause,
}

/// One act of a clause, or another phrase that matches a row.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Predicate {
    /// Number of the row among the frames.
    pub(crate) row: usize,
    pub(crate) object: Option<Noun>,
    pub(crate) owner: Option<Noun>,
    pub(crate) not: bool,
    /// Whether the subject is the one to whom it is done.
    pub(crate) passive: bool,
    /// What is asked for, or said.
    pub(crate) sign: Option<Gesture>,
    pub(crate) tokens: Range<usize>,
}

/// A place with how it is spoken of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct At {
    pub(crate) class: Option<PlaceClass>,
    pub(crate) to: bool,
    pub(crate) from: bool,
    /// Its first token.
    pub(crate) token: usize,
}

/// A clause.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Clause {
    pub(crate) join: Join,
    /// Whose acts; of an ellipsis, those of the clause before. Empty where nobody was named yet.
    pub(crate) subject: Vec<Noun>,
    pub(crate) acts: Vec<Predicate>,
    /// Others who are named beside: `with her son`.
    pub(crate) also: Vec<Noun>,
    /// By whom, in the passive.
    pub(crate) agent: Option<Noun>,
    /// Whether it says `does`, or `does not`, and not what.
    pub(crate) does: Option<bool>,
    pub(crate) lasts_s: Option<f64>,
    pub(crate) after_s: Option<f64>,
    pub(crate) within_m: Option<f64>,
    pub(crate) pace_mps: Option<f64>,
    pub(crate) places: Vec<At>,
    pub(crate) conditions: Vec<Condition>,
    /// Tokens of which nothing was made.
    pub(crate) left: Vec<usize>,
    /// Tokens that tell how somebody looks, or what they have with them.
    pub(crate) looks: Vec<usize>,
    pub(crate) tokens: Range<usize>,
}

impl Clause {
    fn new(join: Join, at: usize) -> Self {
        Self {
            join,
            subject: Vec::new(),
            acts: Vec::new(),
            also: Vec::new(),
            agent: None,
            does: None,
            lasts_s: None,
            after_s: None,
            within_m: None,
            pace_mps: None,
            places: Vec::new(),
            conditions: Vec::new(),
            left: Vec::new(),
            looks: Vec::new(),
            tokens: at..at,
        }
    }

    fn is_bare(&self) -> bool {
        // What a word before the role says is no act of the clause yet.
        self.acts.iter().all(|act| self.subject.iter().any(|noun| noun.tokens == act.tokens))
            && self.places.is_empty()
            && self.within_m.is_none()
            && self.lasts_s.is_none()
            && self.after_s.is_none()
    }
}

/// The clauses of a text.
pub(crate) fn clauses(chunks: &[Chunk], lexicon: &Lexicon) -> Vec<Clause> {
    let mut parser =
        Parser { chunks, lexicon, at: 0, subject: Vec::new(), person: Vec::new(), denied: false, found: Vec::new() };
    while parser.at < chunks.len() {
        parser.sentence();
    }
    parser.found
}

struct Parser<'a> {
    chunks: &'a [Chunk],
    lexicon: &'a Lexicon,
    at: usize,
    /// The subject of the clause before, for an ellipsis.
    subject: Vec<Noun>,
    /// The last subject that was no robot.
    person: Vec<Noun>,
    /// Whether the clause before was denied: `doesn't stop or look`.
    denied: bool,
    found: Vec<Clause>,
}

impl Parser<'_> {
    fn peek(&self) -> Option<&Chunk> {
        self.chunks.get(self.at)
    }

    fn ahead(&self, chunks: usize) -> Option<&Chunk> {
        self.chunks.get(self.at + chunks)
    }

    fn token(&self) -> usize {
        self.peek().map_or_else(|| self.chunks.last().map_or(0, |last| last.tokens.end), |chunk| chunk.tokens.start)
    }

    fn sentence(&mut self) {
        let mut pending: Vec<Condition> = Vec::new();
        // What was said when before the clauses for which it holds.
        let mut ahead: Vec<Condition> = Vec::new();
        let first = self.found.len();
        let mut join = Join::Start;
        let mut apart = true;
        while let Some(chunk) = self.peek() {
            if chunk.is_mark(Mark::Stop) {
                self.at += 1;
                break;
            }
            if let Some(next) = self.joins(join) {
                (join, apart) = (next, true);
                self.at += 1;
                continue;
            }
            if let Some(tie) = self.tie() {
                let condition = self.condition(tie);
                let more = self.peek().is_some_and(|next| !next.is_mark(Mark::Stop));
                let before = self.found.len() > first && (!apart || !more);
                match self.found.last_mut().filter(|_| before) {
                    Some(clause) => clause.conditions.push(condition),
                    None => {
                        if pending.is_empty() {
                            ahead.clear();
                        }
                        if matches!(condition.tie, Tie::When | Tie::After) {
                            ahead.push(condition.clone());
                        }
                        pending.push(condition);
                    }
                }
                continue;
            }
            let start = self.at;
            let before = self.subject.clone();
            let mut clause = self.clause(join, false);
            // What may not begin a clause is left over.
            if self.at == start {
                clause.left.extend(self.peek().into_iter().flat_map(|chunk| chunk.tokens.clone()));
                self.at += 1;
            }
            clause.tokens.end = self.token().max(clause.tokens.end);
            let plain = |act: &Predicate| self.lexicon.frames.get(act.row).is_some_and(|frame| frame.plain);
            if clause.acts.iter().all(plain)
                && clause.subject == before
                && self.found.len() > first
                && self.adds(&clause)
            {
                continue;
            }
            if clause.conditions.is_empty() || !pending.is_empty() {
                clause.conditions.append(&mut pending);
            }
            if clause.conditions.is_empty() && clause.after_s.is_none() && clause.join != Join::Then {
                clause.conditions.clone_from(&ahead);
            }
            self.share(&mut clause, first);
            self.front(&clause, first);
            self.found.push(clause);
            (join, apart) = (Join::And, false);
        }
        if let Some(condition) = pending.pop() {
            let mut clause = Clause::new(join, condition.clause.tokens.start);
            clause.tokens = condition.clause.tokens.clone();
            clause.subject = condition.clause.subject.clone();
            clause.conditions.push(condition);
            clause.conditions.append(&mut pending);
            self.found.push(clause);
        }
    }

    /// `Coming towards the robot: a nurse`: what is said before its subject.
    fn front(&mut self, clause: &Clause, first: usize) {
        if clause.subject.is_empty() || clause.subject.iter().all(Noun::may_be_robot) {
            return;
        }
        for before in
            self.found.iter_mut().skip(first).filter(|before| before.subject.is_empty() && !before.acts.is_empty())
        {
            before.subject.clone_from(&clause.subject);
        }
    }

    /// `…, for five seconds`: an amount that belongs to the clause before.
    fn adds(&mut self, clause: &Clause) -> bool {
        let amounts = clause.lasts_s.is_some() || clause.within_m.is_some() || clause.after_s.is_some();
        let Some(last) = self.found.last_mut().filter(|last| amounts && !last.acts.is_empty()) else { return false };
        // A place, or where somebody goes, makes a clause of its own.
        if clause.acts.iter().any(|act| act.object.is_some() || act.sign.is_some()) {
            return false;
        }
        last.lasts_s = last.lasts_s.or(clause.lasts_s);
        last.within_m = last.within_m.or(clause.within_m);
        last.after_s = last.after_s.or(clause.after_s);
        last.places.extend(&clause.places);
        last.left.extend(&clause.left);
        last.looks.extend(&clause.looks);
        last.conditions.extend(clause.conditions.iter().cloned());
        true
    }

    /// What is said when for the first of several acts holds for those joined to it: `when it is near, he stops and looks`.
    fn share(&self, clause: &mut Clause, first: usize) {
        let Some(before) = self.found.get(first..).and_then(<[Clause]>::last) else { return };
        let joined = clause.join == Join::And && clause.conditions.is_empty() && clause.after_s.is_none();
        if joined && before.subject == clause.subject && !before.acts.is_empty() {
            clause.conditions.clone_from(&before.conditions);
            clause.conditions.retain(|condition| condition.tie != Tie::Until && condition.tie != Tie::While);
        }
    }

    /// A word or mark that joins clauses, and how.
    fn joins(&self, join: Join) -> Option<Join> {
        let chunk = self.peek()?;
        Some(match &chunk.is {
            Is::Mark(Mark::Colon | Mark::Open) => Join::Colon,
            Is::Mark(Mark::Arrow) => Join::Then,
            Is::Mark(Mark::Comma | Mark::Dash | Mark::Close) if join == Join::Start => Join::Start,
            Is::Mark(Mark::Comma | Mark::Dash | Mark::Close) => {
                if matches!(join, Join::Colon) {
                    join
                } else {
                    Join::And
                }
            }
            Is::Mark(Mark::Quote) => join,
            Is::Word if chunk.word(Sort::But) => Join::But,
            // `while the other walks on` is a clause of its own.
            Is::Word if chunk.word(Sort::While) && self.ahead(1).and_then(Chunk::noun).is_some_and(names_somebody) => {
                Join::But
            }
            Is::Word if chunk.word(Sort::Then) && !chunk.word(Sort::Not) => Join::Then,
            Is::Word if chunk.word(Sort::And) || chunk.lemma == "or" || chunk.lemma == "nor" => match join {
                Join::Then | Join::Colon => join,
                _ => Join::And,
            },
            _ => return None,
        })
    }

    /// Whether the chunk begins a condition.
    fn tie(&self) -> Option<Tie> {
        let chunk = self.peek().filter(|chunk| chunk.is == Is::Word)?;
        let next = self.ahead(1);
        let follows = |next: &Chunk| {
            matches!(next.is, Is::Noun(_) | Is::Whose(_))
                || next.bent == Bent::Ing && next.is == Is::Word
                || next.word(Sort::Verb) && next.bent == Bent::Ed
        };
        let person = next.is_some_and(follows);
        let tie = match () {
            () if chunk.word(Sort::Until) => Tie::Until,
            () if chunk.word(Sort::Unless) => Tie::Unless,
            () if chunk.word(Sort::When) => Tie::When,
            () if chunk.word(Sort::Before) && person => Tie::Before,
            () if chunk.word(Sort::After) && person => Tie::After,
            () if chunk.word(Sort::While) && person => Tie::While,
            () => return None,
        };
        (tie == Tie::Until || next.is_some_and(|next| !matches!(next.is, Is::Amount(_)))).then_some(tie)
    }

    fn condition(&mut self, tie: Tie) -> Condition {
        let start = self.token();
        self.at += 1;
        let (subject, denied) = (self.subject.clone(), self.denied);
        self.denied = false;
        let mut clause = self.clause(Join::And, true);
        clause.tokens.start = start;
        // The subject of a condition is that of its clause as well: `when she sees it, stops`; but never the robot.
        self.subject = if subject.is_empty() && !clause.subject.iter().any(Noun::may_be_robot) {
            clause.subject.clone()
        } else {
            subject
        };
        self.denied = denied;
        Condition { tie, clause }
    }

    fn clause(&mut self, join: Join, inner: bool) -> Clause {
        let mut clause = Clause::new(join, self.token());
        let mut not = self.denied
            && join == Join::And
            && self.at > 0
            && self.chunks.get(self.at - 1).is_some_and(|before| before.lemma == "or" || before.lemma == "nor");
        let mut own = self.relative(&mut clause);
        while let Some(chunk) = self.peek() {
            if inner
                && chunk.is_mark(Mark::Comma)
                && clause.is_bare()
                && !clause.subject.is_empty()
                && self.ahead(1).is_some_and(|next| next.word(Sort::Who))
            {
                self.aside();
                continue;
            }
            if self.ends(&clause, inner) {
                break;
            }
            match &chunk.is {
                Is::Noun(noun)
                    if clause.subject.is_empty() && (clause.is_bare() || !inner) && clause.acts.is_empty() =>
                {
                    let noun = noun.clone();
                    not |= noun.pick == Pick::None;
                    self.modifiers(&noun, &mut clause);
                    clause.subject.push(noun);
                    self.at += 1;
                    self.subject_list(&mut clause);
                    Self::names(&mut clause);
                    own = true;
                }
                // `he is one of our pickers`
                Is::Noun(noun)
                    if clause.acts.is_empty()
                        && self.at > 0
                        && self
                            .chunks
                            .get(self.at - 1)
                            .is_some_and(|before| before.word(Sort::Be) || before.text == crate::lex::OWNS)
                        && role_of(noun).is_some() =>
                {
                    let role = role_of(noun);
                    for noun in &mut clause.subject {
                        noun.beside.clone_from(&role);
                    }
                    self.at += 1;
                }
                // `they all`, `both of them`, `does neither`
                Is::Noun(noun)
                    if noun.head == Head::Bare && matches!(noun.pick, Pick::All | Pick::None) && noun.of.is_none() =>
                {
                    if noun.pick == Pick::None {
                        not = true;
                        clause.does = clause.does.map(|_| false);
                    }
                    self.at += 1;
                }
                Is::Noun(noun) => {
                    let noun = noun.clone();
                    if self.at > 0
                        && self.chunks.get(self.at - 1).is_some_and(|before| before.word(Sort::By))
                        && clause.acts.iter().any(|act| act.passive)
                    {
                        clause.agent = Some(noun);
                    } else {
                        if !self
                            .at
                            .checked_sub(1)
                            .and_then(|at| self.chunks.get(at))
                            .is_some_and(|before| before.word(Sort::With))
                        {
                            clause.left.extend(noun.tokens.clone());
                        }
                        if names_somebody(&noun) {
                            clause.also.push(noun);
                        }
                    }
                    self.at += 1;
                }
                Is::Amount(amount) => {
                    let amount = *amount;
                    match longest(self.chunks, self.at, &self.lexicon.frame_patterns) {
                        Some(found) => self.predicate(found, &mut not, &mut clause),
                        None => self.amount(amount, &mut clause),
                    }
                }
                Is::Place(class) => {
                    let class = *class;
                    if let Some(found) = longest(self.chunks, self.at, &self.lexicon.frame_patterns) {
                        self.predicate(found, &mut not, &mut clause);
                    } else {
                        self.place(class, &mut clause);
                    }
                }
                Is::Whose(_) | Is::Mark(_) => self.at += 1,
                Is::Word => {
                    if let Some(tie) = self.tie().filter(|_| !inner) {
                        let condition = self.condition(tie);
                        clause.conditions.push(condition);
                        if self.peek().is_some_and(|next| next.is_mark(Mark::Comma)) && clause.acts.is_empty() && own {
                            self.at += 1;
                        }
                    } else {
                        self.word(&mut not, &mut clause);
                    }
                }
            }
        }
        self.denied = not || clause.acts.iter().any(|act| act.not);
        if own {
            self.subject.clone_from(&clause.subject);
        } else {
            // `robot 3 m away: stops`: not the robot, of which the reason tells.
            let robot = !self.subject.is_empty() && self.subject.iter().all(|noun| noun.head == Head::Robot);
            let answers = robot && matches!(join, Join::Colon | Join::Then) && !self.person.is_empty();
            clause.subject.clone_from(if answers { &self.person } else { &self.subject });
        }
        if clause.subject.iter().any(|noun| !noun.may_be_robot()) && !inner {
            self.person.clone_from(&clause.subject);
        }
        clause.tokens.end = self.token();
        clause
    }

    /// `an oncoming nurse`: a word before the role that says how they move.
    fn modifiers(&self, noun: &Noun, clause: &mut Clause) {
        for word in &noun.modifiers {
            let patterns = &self.lexicon.frame_patterns;
            let row = patterns.beginning(word).find(|pattern| pattern.slots.len() == 1).map(|pattern| pattern.row);
            let relates = |row: &usize| self.lexicon.frames.get(*row).is_some_and(|frame| frame.relate.is_some());
            if let Some(row) = row.filter(relates) {
                let tokens = noun.tokens.clone();
                clause.acts.push(Predicate {
                    row,
                    object: None,
                    owner: None,
                    not: false,
                    passive: false,
                    sign: None,
                    tokens,
                });
            }
        }
    }

    /// A relative clause between commas, within a condition: a clause of its own.
    fn aside(&mut self) {
        self.at += 1;
        let own = self.subject.clone();
        let clause = self.clause(Join::And, true);
        self.subject = own;
        self.found.push(clause);
        if self.peek().is_some_and(|next| next.is_mark(Mark::Comma)) {
            self.at += 1;
        }
    }

    /// `who …`: of whoever was named last.
    fn relative(&mut self, clause: &mut Clause) -> bool {
        let who = self.peek().filter(|chunk| chunk.word(Sort::Who)).map(|chunk| chunk.tokens.clone());
        let Some(tokens) = who.filter(|_| self.at > 0) else { return false };
        clause.subject.push(Noun::new(Head::Who, tokens));
        self.at += 1;
        true
    }

    /// More subjects: `a doctor, a nurse and two visitors`.
    fn subject_list(&mut self, clause: &mut Clause) {
        loop {
            let comma = self.peek().is_some_and(|chunk| chunk.is_mark(Mark::Comma));
            let and = self.peek().is_some_and(|chunk| chunk.word(Sort::And));
            let both = comma && self.ahead(1).is_some_and(|chunk| chunk.word(Sort::And));
            let skip = if both { 2 } else { 1 };
            if self.beside(clause) {
                continue;
            }
            if !comma && !and {
                return;
            }
            let Some(Is::Noun(noun)) = self.ahead(skip).map(|chunk| &chunk.is) else { return };
            // `A nurse, both …` tells more of the same.
            let part = noun.head == Head::Bare && clause.subject.iter().any(|noun| noun.several);
            if matches!(noun.pick, Pick::All | Pick::None)
                || part
                || noun.of.is_some()
                || noun.head == Head::Robot && !and
            {
                return;
            }
            let noun = noun.clone();
            clause.subject.push(noun);
            self.at += skip + 1;
        }
    }

    /// `two colleagues, Ben and Carla`: the names of those before them.
    fn names(clause: &mut Clause) {
        let Some((first, rest)) = clause.subject.split_first() else { return };
        let all =
            rest.iter().filter_map(|noun| if let Head::Name(name) = &noun.head { Some(name.clone()) } else { None });
        let all: Vec<String> = all.collect();
        let count = usize::try_from(first.count.unwrap_or(1)).unwrap_or(1);
        if !all.is_empty() && all.len() == rest.len() && all.len() == count && matches!(first.head, Head::Role(_)) {
            let first = Noun { names: all, ..first.clone() };
            clause.subject = vec![first];
        }
    }

    /// `Tom, a student, …`, `Anna and Ben (two interns)`: what somebody is, beside their name.
    fn beside(&mut self, clause: &mut Clause) -> bool {
        let marks = |chunk: Option<&Chunk>| {
            matches!(
                chunk.map(|chunk| &chunk.is),
                Some(Is::Mark(Mark::Comma | Mark::Open | Mark::Close | Mark::Dash | Mark::Stop)) | None
            )
        };
        let Some(Is::Noun(noun)) = self.ahead(1).map(|chunk| &chunk.is) else { return false };
        let opens = self.peek().is_some_and(|chunk| chunk.is_mark(Mark::Open));
        // `the driver (actor 1)`
        if let (true, Head::Name(name), Some(last)) = (opens, &noun.head, clause.subject.last_mut()) {
            last.names.push(name.clone());
            self.at += 3;
            return true;
        }
        let labeled = clause.subject.iter().all(|noun| noun.ordinal.is_some());
        let Head::Role(role) = noun.head.clone() else { return false };
        // `the cleaner, a shy man, …` says no more.
        let closed = marks(self.ahead(2)) && self.ahead(2).is_some_and(|chunk| chunk.is_mark(Mark::Comma));
        if noun.female.is_some()
            && noun.pick == Pick::Some
            && !noun.several
            && closed
            && clause.subject.len() == 1
            && self.peek().is_some_and(|chunk| chunk.is_mark(Mark::Comma))
            && !self.ahead(3).is_some_and(|next| next.word(Sort::And) || next.noun().is_some())
        {
            self.at += 3;
            return true;
        }
        let count = usize::try_from(noun.count.unwrap_or(1)).unwrap_or(1);
        let label = |noun: &Noun| noun.ordinal.is_some() && matches!(noun.head, Head::Name(_));
        let named = |noun: &Noun| {
            matches!(noun.head, Head::Name(_)) && noun.beside.is_none()
                || label(noun)
                || noun.generic
                || noun.head == Head::Bare && noun.ordinal.is_some()
        };
        let acts = |next: &Chunk| {
            next.word(Sort::Verb) && next.bent == Bent::S
                || next.word(Sort::Be)
                || next.word(Sort::And)
                || next.word(Sort::Modal)
        };
        if !clause.subject.iter().all(named)
            || count != clause.subject.len()
                && !clause
                    .subject
                    .iter()
                    .all(|noun| noun.count == noun.count.max(Some(u32::try_from(count).unwrap_or(1))))
            || !marks(self.peek()) && !(labeled && self.peek().is_some_and(|chunk| chunk.is_mark(Mark::Colon)))
            || self.ahead(2).is_some_and(acts)
        {
            return false;
        }
        if count != clause.subject.len()
            && clause
                .subject
                .iter()
                .any(|noun| noun.several && noun.count.is_none_or(|own| usize::try_from(own) != Ok(count)))
        {
            return false;
        }
        for noun in &mut clause.subject {
            noun.beside = Some(role.clone());
        }
        self.at += 2;
        if self.peek().is_some_and(|next| next.is_mark(Mark::Comma) || next.is_mark(Mark::Close)) {
            self.at += 1;
        }
        true
    }

    /// Whether the clause ends before the chunk.
    fn ends(&self, clause: &Clause, inner: bool) -> bool {
        let Some(chunk) = self.peek() else { return true };
        match &chunk.is {
            Is::Mark(Mark::Quote) => false,
            Is::Mark(Mark::Comma) => {
                !(clause.is_bare()
                    && !clause.subject.is_empty()
                    && self.ahead(1).is_some_and(|next| next.word(Sort::Verb) && next.bent == Bent::Ing))
            }
            Is::Mark(_) => true,
            Is::Noun(noun) => {
                let by = self.at > 0
                    && self.chunks.get(self.at - 1).is_some_and(|before| {
                        before.word(Sort::By)
                            || before.word(Sort::At)
                            || before.word(Sort::To)
                            || before.word(Sort::Of)
                            || before.lemma == "than"
                            || before.lemma == "with"
                    });
                let complete = !clause.acts.is_empty() || inner && !clause.is_bare();
                complete && !by && noun.tokens.start > 0
            }
            Is::Word
                if chunk.word(Sort::And) || chunk.word(Sort::But) || chunk.lemma == "or" || chunk.lemma == "nor" =>
            {
                true
            }
            Is::Word if chunk.word(Sort::Then) => true,
            Is::Word if chunk.word(Sort::While) && self.ahead(1).and_then(Chunk::noun).is_some_and(names_somebody) => {
                !clause.is_bare() || !clause.subject.is_empty()
            }
            Is::Word if chunk.word(Sort::Who) && !chunk.word(Sort::Definite) => {
                !clause.subject.is_empty() || !clause.acts.is_empty()
            }
            // `that` after a noun begins a relative clause.
            Is::Word if chunk.word(Sort::Who) => {
                let after_noun =
                    self.at > 0 && self.chunks.get(self.at - 1).is_some_and(|before| before.noun().is_some());
                after_noun
                    && self
                        .ahead(1)
                        .is_some_and(|next| next.word(Sort::Verb) || next.word(Sort::Be) || next.word(Sort::Modal))
            }
            Is::Word if inner => {
                // `until it has passed does he go on`
                let helps = [Sort::Do, Sort::Modal, Sort::Have, Sort::Be].iter().any(|sort| chunk.word(*sort));
                let turned = helps && self.ahead(1).and_then(Chunk::noun).is_some_and(Noun::may_be_person);
                (self.tie().is_some() || turned) && !clause.is_bare()
            }
            Is::Word | Is::Whose(_) | Is::Amount(_) | Is::Place(_) => false,
        }
    }

    fn amount(&mut self, amount: Amount, clause: &mut Clause) {
        let before = self.at.checked_sub(1).and_then(|at| self.chunks.get(at));
        let after = before.is_some_and(|before| before.word(Sort::After))
            || self.ahead(1).is_some_and(|next| next.word(Sort::Later) || next.word(Sort::After));
        match amount {
            Amount::Distance(m) => clause.within_m = Some(m),
            Amount::Time(secs) if after => clause.after_s = Some(secs),
            Amount::Time(secs) => clause.lasts_s = Some(secs),
        }
        self.at += 1;
        if after && self.peek().is_some_and(|next| next.word(Sort::Later) || next.word(Sort::After)) {
            self.at += 1;
        }
    }

    fn place(&mut self, class: Option<PlaceClass>, clause: &mut Clause) {
        clause.places.push(self.place_at(class, self.at));
        self.at += 1;
    }

    /// A place with the word before it: `to the exit`, `from a room`.
    fn place_at(&self, class: Option<PlaceClass>, at: usize) -> At {
        let articles = |chunk: &&Chunk| {
            chunk.is_mark(Mark::Colon)
                || chunk.word(Sort::Definite)
                || chunk.word(Sort::Indefinite)
                || matches!(chunk.is, Is::Whose(_))
        };
        let before = self.chunks.get(..at).unwrap_or_default().iter().rev().find(|chunk| !articles(chunk));
        let to =
            before.is_some_and(|before| before.word(Sort::To) || before.word(Sort::Into) || before.word(Sort::For));
        let from = before.is_some_and(|before| before.word(Sort::From));
        At { class, to, from, token: self.chunks.get(at).map_or(0, |chunk| chunk.tokens.start) }
    }

    fn word(&mut self, not: &mut bool, clause: &mut Clause) {
        let quoted = self.at > 0
            && self
                .chunks
                .get(self.at - 1)
                .is_some_and(|before| before.is_mark(Mark::Quote) || before.is_mark(Mark::Colon));
        if quoted && !clause.subject.is_empty() && self.said(clause) {
            return;
        }
        if let Some(found) = longest(self.chunks, self.at, &self.lexicon.frame_patterns) {
            self.predicate(found, not, clause);
            return;
        }
        let Some(chunk) = self.chunks.get(self.at) else { return };
        let obeys =
            clause.acts.last().is_some_and(|act| self.lexicon.frames.get(act.row).is_some_and(|frame| frame.obeys));
        if chunk.word(Sort::Do) {
            clause.does = Some(!*not);
        }
        if chunk.word(Sort::Not) && obeys {
            // `he does not`
            if let Some(last) = clause.acts.last_mut() {
                last.not = !last.not;
            }
        } else if chunk.word(Sort::Not) || chunk.word(Sort::Nobody) || chunk.word(Sort::No) {
            *not = true;
            clause.does = clause.does.map(|_| false);
        } else if chunk.word(Sort::Slow) {
            clause.pace_mps = Some(SLOW_MPS);
        } else if chunk.word(Sort::Brisk) {
            clause.pace_mps = Some(BRISK_MPS);
        } else if chunk.word(Sort::Looks) || chunk.word(Sort::Thing) {
            clause.looks.extend(chunk.tokens.clone());
        } else if !says_nothing(chunk) {
            clause.left.extend(chunk.tokens.clone());
        }
        self.at += 1;
    }

    /// `Robot: "excuse me"`: what is said, without a word for saying it.
    fn said(&mut self, clause: &mut Clause) -> bool {
        let start = self.token();
        let Some(row) = self.lexicon.frames.iter().position(|frame| frame.asks) else { return false };
        let Some(found) = longest(self.chunks, self.at, &self.lexicon.sign_patterns) else { return false };
        let sign = self.lexicon.signs.get(found.row).map(|row| row.says);
        self.at = found.end;
        let tokens = start..self.token();
        clause.acts.push(Predicate { row, object: None, owner: None, not: false, passive: false, sign, tokens });
        true
    }

    fn predicate(&mut self, found: Found, not: &mut bool, clause: &mut Clause) {
        let start = self.token();
        for between in &found.between {
            let Some(chunk) = self.chunks.get(*between) else { continue };
            if chunk.word(Sort::Slow) {
                clause.pace_mps = Some(SLOW_MPS);
            } else if chunk.word(Sort::Brisk) {
                clause.pace_mps = Some(BRISK_MPS);
            }
        }
        let verb = self.peek().map(|chunk| (chunk.word(Sort::Slow), chunk.word(Sort::Brisk)));
        match verb {
            Some((true, _)) => clause.pace_mps = Some(SLOW_MPS),
            Some((_, true)) => clause.pace_mps = Some(BRISK_MPS),
            _ => {}
        }
        let passive = found.passive && self.at > 0;
        self.at = found.end;
        match found.amount {
            Some(Amount::Distance(m)) => clause.within_m = Some(m),
            Some(Amount::Time(secs)) => clause.lasts_s = Some(secs),
            None => {}
        }
        clause.places.extend(found.place.map(|(class, at)| self.place_at(class, at)));
        let frame = self.lexicon.frames.get(found.row);
        let mut sign = frame.and_then(|frame| frame.says);
        if frame.is_some_and(|frame| frame.asks) {
            sign = self.speech().or(sign);
        }
        if frame.is_some_and(|frame| frame.denies) {
            *not = !*not;
            return;
        }
        let tokens = start..self.token();
        let act =
            Predicate { row: found.row, object: found.object, owner: found.owner, not: *not, passive, sign, tokens };
        clause.acts.push(act);
    }

    /// What is said or asked for: `to make room`, `"excuse me"`.
    fn speech(&mut self) -> Option<Gesture> {
        let mut at = self.at;
        let mut quoted = false;
        while let Some(chunk) = self.chunks.get(at) {
            let sign = longest(self.chunks, at, &self.lexicon.sign_patterns);
            let asked = longest(self.chunks, at, &self.lexicon.frame_patterns)
                .and_then(|found| Some((found.end, self.lexicon.frames.get(found.row)?.asked?)));
            let said = sign.and_then(|found| Some((found.end, self.lexicon.signs.get(found.row)?.says)));
            let best = match (said, asked) {
                (Some(said), Some(asked)) => Some(if said.0 >= asked.0 { said } else { asked }),
                (said, asked) => said.or(asked),
            };
            if let Some((end, gesture)) = best {
                self.at = end;
                while self.peek().is_some_and(|chunk| chunk.is_mark(Mark::Quote)) {
                    self.at += 1;
                }
                return Some(gesture);
            }
            match &chunk.is {
                Is::Mark(Mark::Quote) => quoted = true,
                Is::Mark(Mark::Comma | Mark::Colon)
                    if !quoted && self.chunks.get(at + 1).is_some_and(|next| next.is_mark(Mark::Quote)) => {}
                Is::Mark(Mark::Comma) if quoted => {}
                Is::Mark(_) => return None,
                Is::Noun(_) => {}
                Is::Word
                    if chunk.word(Sort::And)
                        || chunk.word(Sort::But)
                        || chunk.word(Sort::When)
                        || chunk.word(Sort::Until) =>
                {
                    return None;
                }
                Is::Word if says_nothing(chunk) || chunk.word(Sort::Not) => {}
                Is::Word | Is::Whose(_) | Is::Place(_) | Is::Amount(_) => return None,
            }
            at += 1;
        }
        None
    }
}

/// The role of which a noun phrase tells: `one of our pickers`.
fn role_of(noun: &Noun) -> Option<String> {
    match (&noun.head, &noun.of) {
        (Head::Role(role), _) if !noun.generic => Some(role.clone()),
        (Head::Bare, Some(of)) => role_of(of),
        _ => None,
    }
}

/// Whether a noun phrase names people anew: not a pronoun, and not the robot.
fn names_somebody(noun: &Noun) -> bool {
    matches!(noun.head, Head::Role(_) | Head::Name(_) | Head::Bare)
}

/// Whether a word says nothing of its own.
pub(crate) fn says_nothing(chunk: &Chunk) -> bool {
    let silent = [
        Sort::Fill,
        Sort::Be,
        Sort::Do,
        Sort::Have,
        Sort::Modal,
        Sort::Definite,
        Sort::Indefinite,
        Sort::To,
        Sort::Of,
        Sort::By,
        Sort::At,
        Sort::From,
        Sort::Then,
        Sort::Who,
        Sort::And,
        Sort::While,
        Sort::Later,
        Sort::After,
        Sort::Before,
    ];
    chunk.is == Is::Word && silent.iter().any(|sort| chunk.sorts.has(*sort))
        || chunk.is == Is::Word && chunk.text == crate::lex::OWNS
}
