//! The book of a survey: who came, which order of films they got, and what they answered, as lines that are only ever added.
//!
//! ```text
//! lines so far ─► replay ─► Journal ◄─ apply ◄─ a line that is on the disk
//!                              └─ enter, film, end ─► the line to be written, or why not
//! ```
//!
//! What is asked of it changes nothing: a line counts once it is [applied](Journal::apply), and it is applied when the disk has it. So
//! whatever was acknowledged is in the file, and a file that is replayed gives the same book.

use std::collections::{BTreeMap, BTreeSet};

use serde::Deserialize;

use super::orders::{Order, orders};
use crate::design::Design;
use crate::problem::Problem;
use crate::read::Line;

/// What a person says about a film.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Said {
    /// The film.
    pub film: String,
    /// How much of it was played, s.
    pub watched_s: f64,
    /// Time for the questions, s.
    pub rt_s: f64,
    /// Points by item; none where nothing was said.
    pub answers: BTreeMap<String, Option<f64>>,
    /// Points by attention check.
    #[serde(default)]
    pub checks: BTreeMap<String, Option<f64>>,
}

/// Why something is not taken.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// Nobody has this token.
    #[error("nobody began with this token")]
    Unknown,
    /// There are no films to show.
    #[error("the study has no order of films")]
    Empty,
    /// Answers about a film that is not the next one.
    #[error("answers about `{film}` are not due; the next film is `{next}`")]
    NotDue {
        /// The film.
        film: String,
        /// The one that is.
        next: String,
    },
    /// Other answers about a film that was answered.
    #[error("`{film}` was answered already, and otherwise")]
    Twice {
        /// The film.
        film: String,
    },
    /// An answer that is none.
    #[error("`{value}` is no answer to `{item}`")]
    Answer {
        /// The item or check.
        item: String,
        /// What was said.
        value: String,
    },
    /// A time that is none.
    #[error("`{value}` is no time in seconds")]
    Time {
        /// What was said.
        value: f64,
    },
    /// The end before all films were answered.
    #[error("{left} of the films are not answered yet")]
    Open {
        /// How many.
        left: usize,
    },
}

/// Where a person stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Standing {
    /// The participant.
    pub participant: String,
    /// By this they come back.
    pub token: String,
    /// Name of their order.
    pub order: String,
    /// Its films.
    pub films: Vec<String>,
    /// How many of them are answered.
    pub done: usize,
    /// Whether they came to the end.
    pub ended: bool,
}

#[derive(Debug, Clone)]
struct Person {
    token: String,
    order: usize,
    said: BTreeMap<String, Line>,
    ended: bool,
}

/// The book.
#[derive(Debug, Clone)]
pub struct Journal {
    design: Design,
    orders: Vec<Order>,
    people: BTreeMap<String, Person>,
    tokens: BTreeMap<String, String>,
}

impl Journal {
    /// An empty book.
    #[must_use]
    pub fn new(design: Design) -> Self {
        let orders = orders(&design);
        Self { design, orders, people: BTreeMap::new(), tokens: BTreeMap::new() }
    }

    /// The book after the lines of a file.
    ///
    /// # Errors
    /// A line that is none, an order or a film that the study lacks.
    pub fn replay(design: Design, text: &str, file: &str) -> Result<Self, Problem> {
        let mut journal = Self::new(design);
        for (number, line) in (1_u64..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty()) {
            let bad = |what: String| {
                let hint = "answers of another kit? each kit has a folder of its own: --answers names it";
                Problem::new(file, what, hint).line(number)
            };
            let line: Line = serde_json::from_str(line).map_err(|why| bad(why.to_string()))?;
            journal.apply(&line).map_err(|why| bad(why.to_string()))?;
        }
        Ok(journal)
    }

    /// Takes a line in that the disk has.
    ///
    /// # Errors
    /// It does not fit what is known: somebody nobody knows, an order or a film that is not theirs.
    pub fn apply(&mut self, line: &Line) -> Result<(), Refusal> {
        match line {
            Line::Begin { participant, token, order } => {
                let order = self.orders.iter().position(|known| known.name == *order).ok_or(Refusal::Empty)?;
                let person = Person { token: token.clone(), order, said: BTreeMap::new(), ended: false };
                self.tokens.insert(token.clone(), participant.clone());
                self.people.insert(participant.clone(), person);
            }
            Line::Film { participant, film, .. } => {
                let person = self.people.get_mut(participant).ok_or(Refusal::Unknown)?;
                person.said.insert(film.clone(), line.clone());
            }
            Line::Person { participant, .. } => {
                self.people.get_mut(participant).ok_or(Refusal::Unknown)?.ended = true;
            }
        }
        Ok(())
    }

    /// How many people have each order, those left out who are `gone`: they began, and nobody expects them any more.
    #[must_use]
    pub fn counts(&self, gone: &BTreeSet<String>) -> Vec<usize> {
        let mut counts = vec![0; self.orders.len()];
        for (participant, person) in &self.people {
            let counted = person.ended || !gone.contains(participant);
            if let Some(count) = counts.get_mut(person.order).filter(|_| counted) {
                *count += 1;
            }
        }
        counts
    }

    /// The line with which somebody who was never here begins: they get the order that the fewest people have. None for somebody who is
    /// known: they go on.
    ///
    /// # Errors
    /// [`Refusal::Empty`].
    pub fn enter(&self, participant: &str, token: &str, gone: &BTreeSet<String>) -> Result<Option<Line>, Refusal> {
        if self.people.contains_key(participant) {
            return Ok(None);
        }
        let counts = self.counts(gone);
        let emptiest = counts.iter().enumerate().min_by_key(|(_, count)| **count).map(|(order, _)| order);
        let order = emptiest.and_then(|order| self.orders.get(order)).ok_or(Refusal::Empty)?;
        let (participant, token, order) = (participant.to_owned(), token.to_owned(), order.name.clone());
        Ok(Some(Line::Begin { participant, token, order }))
    }

    /// Where somebody stands.
    #[must_use]
    pub fn standing(&self, participant: &str) -> Option<Standing> {
        let person = self.people.get(participant)?;
        let order = self.orders.get(person.order)?;
        Some(Standing {
            participant: participant.to_owned(),
            token: person.token.clone(),
            order: order.name.clone(),
            films: order.films.clone(),
            done: order.films.iter().filter(|film| person.said.contains_key(*film)).count(),
            ended: person.ended,
        })
    }

    /// The participant of a token.
    ///
    /// # Errors
    /// [`Refusal::Unknown`].
    pub fn of_token(&self, token: &str) -> Result<Standing, Refusal> {
        self.tokens.get(token).and_then(|participant| self.standing(participant)).ok_or(Refusal::Unknown)
    }

    /// The line of what somebody says about their next film; none where the very same was said before: an answer may be sent again.
    ///
    /// # Errors
    /// [`Refusal`]: a film that is not due, other answers than before, an item or an answer that the study lacks.
    pub fn film(&self, token: &str, said: &Said) -> Result<Option<Line>, Refusal> {
        let at = self.of_token(token)?;
        let film = said.film.clone();
        let place = at.films.iter().position(|known| *known == film);
        let position = place.and_then(|place| u32::try_from(place + 1).ok());
        for time in [said.watched_s, said.rt_s] {
            if !(0.0..=1e6).contains(&time) {
                return Err(Refusal::Time { value: time });
            }
        }
        self.check(said)?;
        let whole = |value: &Option<f64>| value.map_or(serde_json::Value::Null, serde_json::Value::from);
        // Every item has a member: what is missing was asked and not answered.
        let answer = |code: &str| (code.to_owned(), said.answers.get(code).map_or(serde_json::Value::Null, whole));
        let answers = self.design.codes().map(answer).collect();
        let checks = said.checks.iter().map(|(name, value)| (name.clone(), whole(value))).collect();
        let line = Line::Film {
            participant: at.participant.clone(),
            film: film.clone(),
            position,
            watched_s: Some(said.watched_s),
            rt_s: Some(said.rt_s),
            answers,
            checks,
            simulated: false,
        };
        if let Some(before) = self.people.get(&at.participant).and_then(|person| person.said.get(&film)) {
            return if *before == line { Ok(None) } else { Err(Refusal::Twice { film }) };
        }
        if place != Some(at.done) {
            let next = at.films.get(at.done).cloned().unwrap_or_else(|| "none".to_owned());
            return Err(Refusal::NotDue { film, next });
        }
        Ok(Some(line))
    }

    fn check(&self, said: &Said) -> Result<(), Refusal> {
        let shown = |value: &Option<f64>| value.map_or_else(|| "nothing".to_owned(), |value| value.to_string());
        for (item, value) in &said.answers {
            let known = self.design.item(item);
            let fits = known.is_some_and(|(of, _)| value.is_none_or(|points| of.instrument.takes(points)));
            if !fits {
                return Err(Refusal::Answer { item: item.clone(), value: shown(value) });
            }
        }
        for (name, value) in &said.checks {
            if !self.design.checks.contains_key(name) {
                return Err(Refusal::Answer { item: name.clone(), value: shown(value) });
            }
        }
        Ok(())
    }

    /// The line with which somebody ends, once every film is answered; none for somebody who has ended.
    ///
    /// # Errors
    /// [`Refusal::Open`], [`Refusal::Unknown`], [`Refusal::Time`].
    pub fn end(&self, token: &str, duration_s: f64) -> Result<Option<Line>, Refusal> {
        let at = self.of_token(token)?;
        let left = at.films.len() - at.done;
        if left > 0 {
            return Err(Refusal::Open { left });
        }
        if !(0.0..=1e7).contains(&duration_s) {
            return Err(Refusal::Time { value: duration_s });
        }
        let (participant, order) = (at.participant, Some(at.order));
        let (duration_s, checks) = (Some(duration_s), BTreeMap::new());
        let line = Line::Person { participant, order, duration_s, checks, simulated: false };
        Ok((!at.ended).then_some(line))
    }

    /// People who began, and those of them who came to the end.
    #[must_use]
    pub fn people(&self) -> (usize, usize) {
        (self.people.len(), self.people.values().filter(|person| person.ended).count())
    }

    /// Those who began and have not come to the end.
    #[must_use]
    pub fn unfinished(&self) -> Vec<String> {
        self.people.iter().filter(|(_, person)| !person.ended).map(|(name, _)| name.clone()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kit::tests::design;
    use crate::read::{Pseudonyms, own};

    fn said(journal: &Journal, film: &str, points: f64) -> Said {
        let answers = journal.design.codes().map(|code| (code.to_owned(), Some(points))).collect();
        Said { film: film.to_owned(), watched_s: 20.0, rt_s: 12.5, answers, checks: BTreeMap::new() }
    }

    /// Fifty people answer; every few lines the book is lost and replayed from its file.
    #[test]
    fn nothing_is_lost_where_the_book_is_replayed_and_orders_stay_even() {
        let (mut journal, mut file, mut written) = (Journal::new(design()), String::new(), 0);
        let nobody = BTreeSet::new();
        let mut write = |journal: &mut Journal, line: Line| {
            file.push_str(&serde_json::to_string(&line).unwrap());
            file.push('\n');
            written += 1;
            // Lost before it was taken in: the file has it.
            if written % 7 == 0 {
                *journal = Journal::replay(design(), &file, "answers.jsonl").unwrap();
            } else {
                journal.apply(&line).unwrap();
            }
        };
        for number in 0..50 {
            let (who, token) = (format!("~{number:012x}"), format!("t{number}"));
            let line = journal.enter(&who, &token, &nobody).unwrap().unwrap();
            write(&mut journal, line);
            assert_eq!(journal.enter(&who, "other", &nobody).unwrap(), None, "who is known goes on");
            for film in journal.of_token(&token).unwrap().films {
                let line = journal.film(&token, &said(&journal, &film, 3.0)).unwrap().unwrap();
                write(&mut journal, line);
                assert_eq!(journal.film(&token, &said(&journal, &film, 3.0)).unwrap(), None, "the same once more");
            }
            let line = journal.end(&token, 100.0).unwrap().unwrap();
            write(&mut journal, line);
            assert_eq!(journal.end(&token, 100.0).unwrap(), None);
        }
        assert_eq!(journal.people(), (50, 50));
        let counts = journal.counts(&nobody);
        assert!(counts.iter().max().unwrap() - counts.iter().min().unwrap() <= 1, "{counts:?}");
        let ratings = own(&file, "answers.jsonl", &design(), Pseudonyms { key: [0; 32] }).unwrap();
        assert_eq!(ratings.participants.len(), 50);
        assert_eq!(ratings.rows.len(), 50 * 3 * journal.design.codes().count());
        assert_eq!(ratings.participants[3].id, "000000000003", "hashed names are not hashed again");
        assert!(ratings.participants.iter().all(|person| person.order.is_some()));
    }

    #[test]
    fn an_order_whose_people_left_is_given_again() {
        let mut journal = Journal::new(design());
        let nobody = BTreeSet::new();
        let count = journal.orders.len();
        for number in 0..count {
            let line = journal.enter(&format!("p{number}"), &format!("t{number}"), &nobody).unwrap().unwrap();
            journal.apply(&line).unwrap();
        }
        let gone = BTreeSet::from(["p2".to_owned()]);
        let next = |gone: &BTreeSet<String>| match journal.enter("new", "t", gone).unwrap().unwrap() {
            Line::Begin { order, .. } => order,
            Line::Film { .. } | Line::Person { .. } => String::new(),
        };
        assert_eq!((next(&nobody).as_str(), next(&gone).as_str()), ("1", "3"));
        assert_eq!(journal.unfinished().len(), count);
    }

    #[test]
    fn what_is_not_due_or_no_answer_is_refused() {
        let mut journal = Journal::new(design());
        let line = journal.enter("p", "t", &BTreeSet::new()).unwrap().unwrap();
        journal.apply(&line).unwrap();
        let films = journal.of_token("t").unwrap().films;
        assert_eq!(journal.film("other", &said(&journal, &films[0], 3.0)), Err(Refusal::Unknown));
        let late = journal.film("t", &said(&journal, &films[1], 3.0)).unwrap_err().to_string();
        assert!(late.contains(&films[1]) && late.contains(&format!("the next film is `{}`", films[0])), "{late}");
        assert!(journal.film("t", &said(&journal, "zzz", 3.0)).unwrap_err().to_string().contains("`zzz` are not due"));
        let out = journal.film("t", &said(&journal, &films[0], 6.0)).unwrap_err().to_string();
        assert!(out.contains("`6` is no answer to"), "{out}");
        assert_eq!(journal.end("t", 10.0), Err(Refusal::Open { left: 3 }));
        let line = journal.film("t", &said(&journal, &films[0], 3.0)).unwrap().unwrap();
        journal.apply(&line).unwrap();
        assert_eq!(journal.film("t", &said(&journal, &films[0], 4.0)), Err(Refusal::Twice { film: films[0].clone() }));
        let odd = Said { watched_s: f64::NAN, ..said(&journal, &films[1], 3.0) };
        assert!(matches!(journal.film("t", &odd), Err(Refusal::Time { .. })));
        let torn = Journal::replay(design(), "{\"kind\":\"begin\"", "answers.jsonl").unwrap_err().to_string();
        assert!(torn.contains("`answers.jsonl` line 1"), "{torn}");
    }
}
