//! The account of a request's texts: what became of every clause, and of every word in it that says something.
//!
//! ```text
//! rough scenario ─► what the reader says of every piece (rough)
//! task, context  ─► words and clauses (text), those that their readers took something of (words)
//!                ─► clauses hidden in turn, the text read again (influence): which lines of the reading (lines) need them
//!                ─► a fate per word: read · not played · background · not read
//! ```

mod influence;
mod plain;
mod rough;
mod text;
mod words;

use std::ops::Range;

use socrates_model::fault::Message;
use socrates_model::fault::Span;
use socrates_model::form::Form;
use socrates_model::request::Expect;
use socrates_model::statement::{Background, Became, Statement, TextKey, covers};
use socrates_model::{Fault, Location, Reading, Request};
use socrates_reader::Reader;

use crate::lines::Line;
use crate::understand::{Understood, understood};
use influence::Influence;
use text::Token;
use words::Kind;

/// What became of a word.
#[derive(Debug, Clone, PartialEq)]
enum Fate {
    /// Says nothing of its own.
    Joins,
    Read,
    Background(Background),
    NotPlayed(Message),
    NotRead,
}

/// Accounts for every text of a request that was understood so.
pub(crate) fn statements(request: &Request, location: &Location, read: &Understood) -> Vec<Statement> {
    // What `[expect]` and a form say wins over the text: only without them a text shows what was read of it.
    let without_expect = Request { expect: Expect::default(), ..request.clone() };
    let text_alone = Request { form: Form::default(), ..without_expect.clone() };
    let again = |other: &Request| (other != request).then(|| understood(other, location, true));
    let (alone, beside) = (again(&text_alone), again(&without_expect));
    let (alone, beside) = (alone.as_ref().unwrap_or(read), beside.as_ref().unwrap_or(read));
    let mut found = Vec::new();
    for key in TextKey::ALL {
        let text = key.text_of(request);
        if key == TextKey::RoughScenario {
            // A form takes the place of the rough scenario; the task and the context say the same beside it.
            found.extend(rough::statements(request, alone, &read.reading));
        } else if !text.trim().is_empty() {
            found.extend(Account::new(&without_expect, location, (beside, &read.reading), key).statements());
        }
    }
    // What a form states takes the place of what was read of the text; what was not read, or is not played, is still missing.
    let stated = !request.form.is_empty();
    for statement in found.iter_mut().filter(|statement| stated && statement.at == TextKey::RoughScenario) {
        if let Became::Read { lines, facts } = &mut statement.became {
            (*lines, *facts) = (vec!["as the form states".to_owned()], Vec::new());
        }
    }
    found
}

struct Account<'a> {
    request: &'a Request,
    location: &'a Location,
    whole: &'a Understood,
    /// The reading, of which the facts are told.
    reading: &'a Reading,
    key: TextKey,
    text: &'a str,
    tokens: Vec<Token>,
    kinds: Vec<Kind>,
    influence: Influence,
}

impl<'a> Account<'a> {
    fn new(
        request: &'a Request,
        location: &'a Location,
        (whole, reading): (&'a Understood, &'a Reading),
        key: TextKey,
    ) -> Self {
        let text = key.text_of(request);
        let tokens = text::tokens(text);
        let read = |text: &str| read_again(request, location, key, text);
        let used = if key == TextKey::Task { whole.task.used.clone() } else { Reader::shipped().scene(text).used };
        let kinds = words::kinds(&tokens, &whole.task.open, key);
        let used = tokens.iter().map(|token| touched(token, &used)).collect();
        let again = influence::Text { text, tokens: &tokens, kinds: &kinds, used, whole: &whole.lines, read: &read };
        let influence = again.by_clause(key == TextKey::Task);
        Self { request, location, whole, reading, key, text, tokens, kinds, influence }
    }

    fn statements(&self) -> Vec<Statement> {
        let fates = self.fates();
        let mut found = Vec::new();
        let clauses = self.tokens.last().map_or(0, |last| last.clause + 1);
        for clause in 0..clauses {
            let places: Vec<usize> = (0..self.tokens.len())
                .filter(|k| self.tokens.get(*k).is_some_and(|token| token.clause == clause))
                .collect();
            self.of_clause(clause, &places, &fates, &mut found);
        }
        found
    }

    /// What became of each word.
    fn fates(&self) -> Vec<Fate> {
        (0..self.tokens.len()).map(|place| self.fate(place)).collect()
    }

    fn fate(&self, place: usize) -> Fate {
        if let Some((problem, instructs)) = self.problem(place) {
            return if instructs {
                Fate::Background(Background::Instruction)
            } else {
                Fate::NotPlayed(problem.message.clone())
            };
        }
        if self.kinds.get(place).is_none_or(|kind| *kind == Kind::Connective) {
            return Fate::Joins;
        }
        match self.key {
            _ if self.influence.is_read(place) => Fate::Read,
            TextKey::Task if self.binds(place) => Fate::NotRead,
            TextKey::Task => Fate::Background(Background::Errand),
            TextKey::SocialContext | TextKey::RoughScenario => Fate::Background(Background::Setting),
        }
    }

    /// Whether a word of the task asks for something all the same: a place that this map has, or that something is not to be.
    fn binds(&self, place: usize) -> bool {
        let Some(token) = self.tokens.get(place) else { return false };
        let read = |place: Option<usize>| place.is_some_and(|place| self.influence.is_read(place));
        // `small office`, where `small` tells which.
        let told = read(place.checked_sub(1)) || read(place.checked_add(1));
        // `the elevator`, into which the robot goes anyway.
        let known = || self.whole.lines.iter().any(|line| line.text.to_lowercase().contains(&token.lower));
        self.kinds.get(place) == Some(&Kind::Denial)
            || words::tells_place(&token.lower, self.location) && !told && !known()
    }

    /// The problem of the reading that quotes a word, and whether the word speaks to the program.
    fn problem(&self, place: usize) -> Option<(&Fault, bool)> {
        let own = |fault: &&Fault| fault.at.is_key(self.key.name());
        let quotes = |fault: &&Fault| fault.quotes.iter().any(|quote| self.quoted(quote, place));
        let problem = self.whole.reading.problems.iter().filter(own).find(quotes)?;
        Some((problem, self.whole.instructions.iter().any(|sentence| problem.quotes.contains(sentence))))
    }

    /// Whether a word stands in a quote of the text.
    fn quoted(&self, quote: &str, place: usize) -> bool {
        self.tokens.get(place).is_some_and(|token| covers(self.text, quote, &token.at))
    }

    /// The statements of one clause: what was read of it, and every run of words that became something else.
    fn of_clause(&self, clause: usize, places: &[usize], fates: &[Fate], found: &mut Vec<Statement>) {
        let fate = |place: &usize| fates.get(*place).cloned().unwrap_or(Fate::Joins);
        if places.iter().any(|place| fate(place) == Fate::Read) {
            let (lines, facts) = self.became(clause);
            found.extend(self.statement(places, Became::Read { lines, facts }));
        }
        let mut runs: Vec<(Fate, Vec<usize>)> = Vec::new();
        let mut joins: Vec<usize> = Vec::new();
        for place in places {
            let own = fate(place);
            match runs.last_mut() {
                _ if own == Fate::Joins => joins.push(*place),
                Some((last, run)) if *last == own => {
                    run.append(&mut joins);
                    run.push(*place);
                }
                Some(_) | None => {
                    // Of a task the name alone is not played: what joins it to the robot's way is its errand.
                    let leads = matches!(own, Fate::Background(_));
                    let mut run = if runs.is_empty() && leads { std::mem::take(&mut joins) } else { Vec::new() };
                    joins.clear();
                    run.push(*place);
                    runs.push((own, run));
                }
            }
        }
        for (fate, run) in runs {
            let became = match fate {
                Fate::Joins | Fate::Read => continue,
                Fate::Background(reason) => Became::Background(reason),
                Fate::NotPlayed(why) => Became::NotPlayed { why },
                Fate::NotRead => Became::NotRead { rewording: None },
            };
            found.extend(self.statement(&run, became));
        }
    }

    /// The lines and facts that a clause became: each line stands with the clauses on which the least else hangs.
    fn became(&self, clause: usize) -> (Vec<String>, Vec<String>) {
        let of = |clause: usize| self.influence.lines.get(clause).map_or(&[][..], Vec::as_slice);
        let least = |line: usize| self.influence.lines.iter().filter(|lines| lines.contains(&line)).map(Vec::len).min();
        let numbers = of(clause).iter().filter(|line| least(**line) == Some(of(clause).len()));
        let own: Vec<&Line> = numbers.filter_map(|line| self.whole.lines.get(*line)).collect();
        let fact = |line: &&Line| {
            let kind = line.fact.as_ref()?;
            self.reading.facts.iter().find(|fact| fact.kind == *kind).map(|fact| fact.id.clone())
        };
        let facts = own.iter().filter_map(fact).collect();
        (own.iter().filter(|line| line.shown).map(|line| line.text.clone()).collect(), facts)
    }

    fn statement(&self, places: &[usize], became: Became) -> Option<Statement> {
        let at = self.bounds(places)?;
        let quote = self.text.get(at.clone())?.to_owned();
        let statement = Statement { at: self.key, span: Span::of(self.text, &at)?, quote, became, waived: false };
        Some(statement.waived_by(self.request))
    }

    /// The bytes from the first of some words to the last.
    fn bounds(&self, places: &[usize]) -> Option<Range<usize>> {
        let all = || places.iter().filter_map(|place| self.tokens.get(*place));
        Some(all().map(|token| token.at.start).min()?..all().map(|token| token.at.end).max()?)
    }
}

/// Whether a rule took any part of a word.
fn touched(token: &Token, used: &[Range<usize>]) -> bool {
    used.iter().any(|at| at.start < token.at.end && token.at.start < at.end)
}

/// The lines of the request with another text in place of one of its own.
fn read_again(request: &Request, location: &Location, key: TextKey, text: &str) -> Vec<Line> {
    let mut other = request.clone();
    match key {
        TextKey::RoughScenario => other.rough_scenario = Some(text.to_owned()),
        TextKey::Task => text.clone_into(&mut other.task),
        TextKey::SocialContext => text.clone_into(&mut other.social_context),
    }
    understood(&other, location, false).lines
}
