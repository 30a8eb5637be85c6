//! Subjects: several nouns, the names and roles that stand beside them, and words before a role that say how somebody moves.

use crate::chunk::{Chunk, Is};
use crate::clause::{Clause, Predicate};
use crate::noun::{Head, Noun, Pick};
use crate::parser::{Parser, names_somebody};
use crate::token::{Bent, Mark, OWNS, Sort};

impl Parser<'_> {
    /// A noun phrase: the subject, more of it, an agent, or somebody named beside.
    pub(crate) fn noun(&mut self, noun: Noun, inner: bool, clause: &mut Clause) {
        let before = |sort| self.before().is_some_and(|before| before.word(sort));
        let (is, by, with) = (
            before(Sort::Be) || self.before().is_some_and(|before| before.spelled == OWNS),
            before(Sort::By),
            before(Sort::With),
        );
        self.at += 1;
        let turned = !inner && clause.is_turned() && names_somebody(&noun);
        if clause.subject.is_empty() && (turned || (clause.is_bare() || !inner) && clause.acts.is_empty()) {
            clause.not |= noun.pick == Pick::None;
            self.modifiers(&noun, clause);
            clause.subject.push(noun);
            self.subject_list(clause);
            Self::names(clause);
            clause.own = true;
        } else if let (true, Some(role)) = (clause.acts.is_empty() && is, role_of(&noun)) {
            // `he is one of our pickers`
            clause.goes.push(noun.tokens.clone());
            for own in &mut clause.subject {
                own.beside = Some(role.clone());
            }
        } else if noun.head == Head::Bare && matches!(noun.pick, Pick::All | Pick::None) && noun.of.is_none() {
            // `they all`, `does neither`
            if noun.pick == Pick::None {
                clause.not = true;
                clause.denials.push(noun.tokens.clone());
                clause.does = clause.does.map(|_| false);
            }
        } else if by && clause.acts.iter().any(|act| act.passive) {
            clause.agent = Some(noun);
        } else {
            if noun.reflexive {
                clause.goes.push(noun.tokens.clone());
            } else if !with {
                clause.left.extend(noun.tokens.clone());
            }
            if names_somebody(&noun) {
                clause.also.push(noun);
            }
        }
    }

    /// `an oncoming nurse`: a word before the role that says how they move.
    pub(crate) fn modifiers(&self, noun: &Noun, clause: &mut Clause) {
        for word in &noun.modifiers {
            let patterns = &self.lexicon.frame_patterns;
            let row = patterns.beginning(word).find(|pattern| pattern.slots.len() == 1).map(|pattern| pattern.row);
            let relates = |row: &usize| self.lexicon.frames.get(*row).is_some_and(|frame| frame.relate.is_some());
            if let Some(row) = row.filter(relates) {
                clause.acts.push(Predicate::bare(row, noun.tokens.clone()));
            }
        }
    }

    /// More subjects: `a doctor, a nurse and two visitors`.
    pub(crate) fn subject_list(&mut self, clause: &mut Clause) {
        loop {
            // `a nurse from ward 4 and a doctor`
            let from = self.peek().is_some_and(|chunk| chunk.word(Sort::From) || chunk.word(Sort::At));
            let place = matches!(self.ahead(1).map(|chunk| &chunk.is), Some(Is::Place(_)));
            let list = self.ahead(2).is_some_and(|chunk| chunk.word(Sort::And))
                && self.ahead(3).and_then(Chunk::noun).is_some_and(names_somebody);
            if from && place && list {
                clause.looks.extend(self.ahead(1).into_iter().flat_map(|chunk| chunk.tokens.clone()));
                self.at += 2;
            }
            let comma = self.peek().is_some_and(|chunk| chunk.is_mark(Mark::Comma));
            let and = self.peek().is_some_and(|chunk| chunk.word(Sort::And));
            let both = comma && self.ahead(1).is_some_and(|chunk| chunk.word(Sort::And));
            let skip = if both { 2 } else { 1 };
            if self.beside(clause) || self.bracketed(clause) {
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

    /// `two pedestrians (one employee, one visitor)`, `(all interns)`: who several people are.
    fn bracketed(&mut self, clause: &mut Clause) -> bool {
        let opens = self.peek().is_some_and(|chunk| chunk.is_mark(Mark::Open));
        let [all] = &clause.subject[..] else { return false };
        if !opens || !all.several {
            return false;
        }
        let mut told: Vec<Noun> = Vec::new();
        let mut at = self.at + 1;
        while let Some(chunk) = self.chunks.get(at).filter(|chunk| !chunk.is_mark(Mark::Close)) {
            match chunk.noun() {
                Some(noun) if matches!(noun.head, Head::Role(_)) && !noun.generic => told.push(noun.clone()),
                Some(_) => return false,
                None if chunk.is_mark(Mark::Comma) || chunk.word(Sort::And) => {}
                None => return false,
            }
            at += 1;
        }
        let people: u32 = told.iter().map(|noun| noun.count.unwrap_or(1)).sum();
        match (&told[..], all.count) {
            ([one], _) if one.pick == Pick::All => {
                let beside = role_of(one);
                clause.subject = vec![Noun { beside, ..all.clone() }];
            }
            (_, Some(count)) if all.generic && count == people => clause.subject = told,
            _ => return false,
        }
        let tokens = |at: usize| self.chunks.get(at).map_or(0, |chunk| chunk.tokens.start);
        clause.goes.push(tokens(self.at)..tokens(at));
        self.at = at + 1;
        true
    }

    /// `two colleagues, Ben and Carla`: the names of those before them.
    pub(crate) fn names(clause: &mut Clause) {
        let Some((first, rest)) = clause.subject.split_first() else { return };
        let all =
            rest.iter().filter_map(|noun| if let Head::Name(name) = &noun.head { Some(name.clone()) } else { None });
        let all: Vec<String> = all.collect();
        let count = usize::try_from(first.count.unwrap_or(1)).unwrap_or(1);
        if !all.is_empty() && all.len() == rest.len() && all.len() == count && matches!(first.head, Head::Role(_)) {
            let first = Noun { names: all, ..first.clone() };
            clause.goes.extend(rest.iter().map(|noun| noun.tokens.clone()));
            clause.subject = vec![first];
            return;
        }
        // `a couple, a woman and her husband`: who they are.
        let people: u32 = rest.iter().map(|noun| noun.count.unwrap_or(1)).sum();
        let roles = rest.iter().all(|noun| matches!(noun.head, Head::Role(_)) && !noun.generic);
        let anybody = first.generic || first.group && matches!(&first.head, Head::Role(role) if role == "person");
        if anybody && roles && rest.len() > 1 && first.count == Some(people) {
            clause.group = first.group;
            clause.goes.push(first.tokens.clone());
            clause.subject = rest.to_vec();
        }
    }

    /// `Tom, a student, …`, `Anna and Ben (two interns)`: what somebody is, beside their name.
    pub(crate) fn beside(&mut self, clause: &mut Clause) -> bool {
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
            clause.goes.push(noun.tokens.clone());
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
            clause.goes.push(noun.tokens.clone());
            self.at += 3;
            return true;
        }
        let (noun_count, count) = (noun.count, usize::try_from(noun.count.unwrap_or(1)).unwrap_or(1));
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
        let people = clause.subject.len();
        let agree = people == count || people == 1 && clause.subject.iter().all(|noun| noun.count == noun_count);
        // Of all of them, where the numbers agree; else of the last: `Rosa, the porter, and Henk, the nurse, …`.
        let from = if agree && clause.subject.iter().all(named) {
            0
        } else if count == 1 && clause.subject.last().is_some_and(|last| named(last) && !last.several) {
            people.saturating_sub(1)
        } else {
            return false;
        };
        let colon = labeled && self.peek().is_some_and(|chunk| chunk.is_mark(Mark::Colon));
        if !(marks(self.peek()) || colon) || self.ahead(2).is_some_and(acts) {
            return false;
        }
        clause.goes.push(noun.tokens.clone());
        for noun in clause.subject.iter_mut().skip(from) {
            noun.beside = Some(role.clone());
        }
        self.at += 2;
        if self.peek().is_some_and(|next| next.is_mark(Mark::Comma) || next.is_mark(Mark::Close)) {
            self.at += 1;
        }
        true
    }
}

/// The role of which a noun phrase tells: `one of our pickers`.
pub(crate) fn role_of(noun: &Noun) -> Option<String> {
    match (&noun.head, &noun.of) {
        (Head::Role(role), _) if !noun.generic => Some(role.clone()),
        (Head::Bare, Some(of)) => role_of(of),
        _ => None,
    }
}
