//! Predicates: acts by the rows of `frames.toml`, what is said, amounts and places.

use crate::chunk::{Amount, Chunk, Is};
use crate::clause::{At, Clause, Measure, Predicate};
use crate::find::{Found, longest};
use crate::noun::Noun;
use crate::noun::{BRISK_MPS, Head, Pick, SLOW_MPS};
use crate::parser::{Parser, names_somebody, says_nothing};
use crate::token::{Bent, Mark, Sort};
use socrates_model::{Gesture, PlaceClass};

impl Parser<'_> {
    /// Takes the row that matches here, where one does.
    pub(crate) fn framed(&mut self, clause: &mut Clause) -> bool {
        let patterns = &self.lexicon.frame_patterns;
        // `does not move out of the way` denies that, and is no `not move out`.
        let denies = self.peek().is_some_and(|chunk| chunk.word(Sort::Not));
        let longer =
            |found: &Found| longest(self.chunks, self.at + 1, patterns).is_some_and(|inner| inner.end > found.end);
        let found = longest(self.chunks, self.at, patterns).filter(|found| !denies || !longer(found));
        // `start` alone is a part of the robot's way where it stands before one: `start: the ward`.
        let applies = |found: &Found| {
            let part = self
                .lexicon
                .frames
                .get(found.row)
                .is_some_and(|frame| frame.part.is_some() && !frame.goes && frame.relate.is_none());
            let marked = self.chunks.get(found.end).is_some_and(|next| next.is_mark(Mark::Colon));
            // `the start of the run`
            let article = self.before().is_some_and(|before| before.word(Sort::Definite) && !before.word(Sort::Who));
            let plain = self.lexicon.frames.get(found.row).is_some_and(|frame| frame.plain);
            let noun = article && plain && found.end == self.at + 1;
            (!part || found.place.is_some() || found.end > self.at + 1 || marked) && !noun
        };
        let found = found.filter(applies);
        let matches = found.is_some();
        if let Some(found) = found {
            self.predicate(found, clause);
        }
        matches
    }

    pub(crate) fn amount(&mut self, amount: Amount, clause: &mut Clause) {
        let before = self.at.checked_sub(1).and_then(|at| self.chunks.get(at));
        // `4 s once it is near` is no `4 s after`.
        let next = self.ahead(1).filter(|next| next.word(Sort::Later) || next.lemma == "after");
        // `10 s A halts`: when, where it stands before whoever does it and no word says for how long.
        let alone = clause.is_bare() && !clause.own && !before.is_some_and(|before| before.is == Is::Word);
        let fronts = alone && self.ahead(1).and_then(Chunk::noun).is_some_and(Noun::may_be_person);
        // `after a few seconds`
        let article = before.is_some_and(|before| before.word(Sort::Indefinite));
        let first = if article { self.at.checked_sub(2).and_then(|at| self.chunks.get(at)) } else { before };
        let after = first.is_some_and(|first| first.word(Sort::After)) || next.is_some() || fronts;
        let measure = self.measure(amount, self.at);
        match amount {
            Amount::Distance(_) => clause.within_m = Some(measure),
            Amount::Time(_) if after => clause.after_s = Some(measure),
            Amount::Time(_) => clause.lasts_s = Some(measure),
            Amount::Speed(_) => clause.pace_mps = Some(measure),
        }
        self.at += 1;
        if after && self.peek().is_some_and(|next| next.word(Sort::Later) || next.word(Sort::After)) {
            self.at += 1;
        }
    }

    fn measure(&self, amount: Amount, at: usize) -> Measure {
        let tokens = self.chunks.get(at).map_or(0..0, |chunk| chunk.tokens.clone());
        let (Amount::Distance(value) | Amount::Time(value) | Amount::Speed(value)) = amount;
        Measure { value, from: tokens.start, to: tokens.end }
    }

    pub(crate) fn place(&mut self, class: Option<PlaceClass>, clause: &mut Clause) {
        clause.places.push(self.place_at(class, self.at));
        self.at += 1;
    }

    /// A place with the word before it: `to the exit`, `from a room`.
    pub(crate) fn place_at(&self, class: Option<PlaceClass>, at: usize) -> At {
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
        let tokens = self.chunks.get(at).map_or((0, 0), |chunk| (chunk.tokens.start, chunk.tokens.end));
        let via = before.is_some_and(|before| before.lemma == "via");
        At { class, to, from, via, tokens }
    }

    pub(crate) fn word(&mut self, clause: &mut Clause) {
        let quoted = self.at > 0
            && self
                .chunks
                .get(self.at - 1)
                .is_some_and(|before| before.is_mark(Mark::Quote) || before.is_mark(Mark::Colon));
        if quoted && !(clause.subject.is_empty() && self.subject.is_empty()) && self.said(clause) {
            return;
        }
        if self.lets_somebody(clause) {
            self.at += 1;
            return;
        }
        if self.framed(clause) {
            return;
        }
        let Some(chunk) = self.chunks.get(self.at) else { return };
        let obeys =
            clause.acts.last().is_some_and(|act| self.lexicon.frames.get(act.row).is_some_and(|frame| frame.obeys));
        clause.there |= chunk.word(Sort::There);
        if chunk.word(Sort::Do) {
            clause.does = Some(!clause.not);
        }
        if chunk.word(Sort::Not) && obeys {
            // `he does not`
            clause.denials.push(chunk.tokens.clone());
            if let Some(last) = clause.acts.last_mut() {
                last.not = !last.not;
            }
        } else if chunk.word(Sort::No) && self.lacks_a_thing() {
            clause.looks.extend(chunk.tokens.clone());
        } else if chunk.word(Sort::Other) && self.before().is_some_and(|before| before.word(Sort::Every)) {
            clause.goes.push(chunk.tokens.clone());
        } else if chunk.word(Sort::Not) || chunk.word(Sort::Nobody) || chunk.word(Sort::No) {
            clause.not = true;
            clause.never |= chunk.word(Sort::Never);
            clause.denials.push(chunk.tokens.clone());
            clause.does = clause.does.map(|_| false);
        } else if chunk.word(Sort::Slow) {
            clause.pace_mps = Some(pace(SLOW_MPS, chunk));
        } else if chunk.word(Sort::Brisk) {
            clause.pace_mps = Some(pace(BRISK_MPS, chunk));
        } else if !self.acts_like_a_verb()
            && (chunk.word(Sort::Looks) || chunk.word(Sort::Thing) || self.counts_things())
        {
            clause.looks.extend(chunk.tokens.clone());
        } else if !says_nothing(chunk) {
            clause.verbal |= matches!(chunk.bent, Bent::S | Bent::Ed);
            clause.left.extend(chunk.tokens.clone());
        }
        self.at += 1;
    }

    /// `let a guard stop it`: what is asked for is that the guard does it.
    fn lets_somebody(&self, clause: &Clause) -> bool {
        let lets = self.peek().is_some_and(|chunk| chunk.word(Sort::Lets) && chunk.bent == Bent::Base);
        let meant = |noun: &Noun| noun.pick == Pick::Some || matches!(noun.head, Head::He | Head::They);
        let somebody = self.ahead(1).and_then(Chunk::noun).is_some_and(meant);
        lets && somebody && clause.is_bare() && !clause.own && clause.subject.is_empty()
    }

    /// `the supervisor leads`: a word for a thing, bent as a verb behind somebody.
    fn acts_like_a_verb(&self) -> bool {
        let bent =
            self.peek().is_some_and(|chunk| matches!(chunk.bent, Bent::S | Bent::Ed) && !chunk.word(Sort::Looks));
        bent && self.before().and_then(Chunk::noun).is_some_and(names_somebody)
    }

    /// `no truck`: nobody has one.
    fn lacks_a_thing(&self) -> bool {
        let thing = |next: &Chunk| next.word(Sort::Thing) && next.is == Is::Word;
        let acts = longest(self.chunks, self.at + 1, &self.lexicon.frame_patterns).is_some();
        self.ahead(1).is_some_and(thing) && !acts
    }

    /// `two racks`: a number of things.
    fn counts_things(&self) -> bool {
        let number = self.peek().is_some_and(|chunk| self.lexicon.words.numbers.contains_key(&chunk.lemma));
        number && self.ahead(1).is_some_and(|next| next.word(Sort::Thing) && next.bent == Bent::S)
    }

    /// `Robot: "excuse me"`: what is said, without a word for saying it.
    pub(crate) fn said(&mut self, clause: &mut Clause) -> bool {
        let start = self.token();
        let Some(row) = self.lexicon.frames.iter().position(|frame| frame.asks) else { return false };
        let Some(found) = longest(self.chunks, self.at, &self.lexicon.sign_patterns) else { return false };
        let sign = self.lexicon.signs.get(found.row).map(|row| row.says);
        self.at = found.end;
        let tokens = start..self.token();
        clause.acts.push(Predicate { sign, ..Predicate::bare(row, tokens) });
        true
    }

    fn predicate(&mut self, found: Found, clause: &mut Clause) {
        let (start, at) = (self.token(), self.at);
        let be = self.before().is_some_and(|before| before.word(Sort::Be));
        let ongoing = be && self.peek().is_some_and(|chunk| chunk.bent == Bent::Ing);
        for between in &found.between {
            let Some(chunk) = self.chunks.get(*between) else { continue };
            if chunk.word(Sort::Slow) {
                clause.pace_mps = Some(pace(SLOW_MPS, chunk));
            } else if chunk.word(Sort::Brisk) {
                clause.pace_mps = Some(pace(BRISK_MPS, chunk));
            }
        }
        if let Some(verb) = self.peek() {
            let own = verb.word(Sort::Slow).then_some(SLOW_MPS).or_else(|| verb.word(Sort::Brisk).then_some(BRISK_MPS));
            clause.pace_mps = own.map(|mps| pace(mps, verb)).or(clause.pace_mps);
        }
        let passive = found.passive;
        self.at = found.end;
        if let Some((amount, at)) = found.amount {
            let measure = Some(self.measure(amount, at));
            match amount {
                Amount::Distance(_) => clause.within_m = measure,
                Amount::Time(_) => clause.lasts_s = measure,
                Amount::Speed(_) => clause.pace_mps = measure,
            }
        }
        clause.places.extend(found.place.map(|(class, at)| self.place_at(class, at)));
        let frame = self.lexicon.frames.get(found.row);
        // What somebody has with them is no act of theirs.
        if frame.is_some_and(|frame| frame.background.is_some()) {
            clause.looks.extend(start..self.token());
            return;
        }
        let mut sign = frame.and_then(|frame| frame.says);
        // `signals it to wait. Two operators cross`: what is asked for is in the row, and nobody else is asked.
        let told = sign.is_some() && self.peek().is_some_and(|next| next.noun().is_some());
        if frame.is_some_and(|frame| frame.asks) && !told {
            sign = self.speech().or(sign);
        }
        // `says "follow me" to two students`
        let mut object = found.object;
        if sign.is_some() && object.is_none() && self.peek().is_some_and(|chunk| chunk.word(Sort::To)) {
            object = self.ahead(1).and_then(Chunk::noun).cloned();
            self.at += 2 * usize::from(object.is_some());
        }
        if frame.is_some_and(|frame| frame.denies) {
            clause.not = !clause.not;
            clause.never |= frame.is_some_and(|frame| frame.never);
            clause.denials.push(start..self.token());
            return;
        }
        let tokens = start..self.token();
        // `makes no room`
        let own = self.chunks.get(at..found.end).unwrap_or_default();
        let none =
            own.iter().any(|chunk| chunk.is == Is::Word && chunk.sorts.has(Sort::No) && !chunk.sorts.has(Sort::Fill));
        let none = none && frame.is_some_and(|frame| frame.act.is_some() && !frame.plain);
        let act = Predicate {
            ongoing,
            row: found.row,
            object,
            owner: found.owner,
            not: clause.not != none,
            passive,
            sign,
            tokens,
        };
        clause.acts.push(act);
    }

    /// What is said or asked for: `to make room`, `"excuse me"`.
    pub(crate) fn speech(&mut self) -> Option<Gesture> {
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
                // `raises his hand to stop the robot`
                let robot = self.peek().and_then(Chunk::noun).is_some_and(|noun| noun.head == Head::Robot);
                self.at += usize::from(robot && !quoted);
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
                // `when she hears this she stops`
                // `asks to pass both of them make room`
                Is::Noun(noun) if (noun.nominative || noun.pick == Pick::All) && !quoted => return None,
                // Somebody who is new is not asked: `to wait because two operators …`.
                Is::Noun(noun) if names_somebody(noun) && at > self.at && !quoted => return None,
                Is::Noun(_) => {}
                Is::Word
                    if chunk.word(Sort::And)
                        || chunk.word(Sort::But)
                        || chunk.word(Sort::When)
                        || chunk.word(Sort::Until) =>
                {
                    return None;
                }
                // `tells it not to wait`
                Is::Word if chunk.word(Sort::Not) && !quoted => return None,
                Is::Word if says_nothing(chunk) || chunk.word(Sort::Not) => {}
                Is::Word | Is::Whose(_) | Is::Place(_) | Is::Amount(_) => return None,
            }
            at += 1;
        }
        None
    }
}

/// A pace with the word that says it.
fn pace(mps: f64, chunk: &Chunk) -> Measure {
    Measure { value: mps, from: chunk.tokens.start, to: chunk.tokens.end }
}
