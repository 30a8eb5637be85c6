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

use crate::chunk::{Chunk, Is};
use crate::clause::{Clause, Condition, Join, Measure, Predicate, Tie};
use crate::find::longest;
use crate::lexicon::Lexicon;
use crate::noun::{Head, Noun, Pick};
use crate::parser::{Parser, names_somebody};
use crate::token::{Bent, Mark, Sort};

/// Where a sentence stands.
#[derive(Default)]
struct Sentence {
    /// Its first clause among those found.
    first: usize,
    /// Conditions that belong to the clause that comes next.
    pending: Vec<Condition>,
    /// What was said when before the clauses for which it holds.
    ahead: Vec<Condition>,
    /// `Ten seconds later …`: of the acts that follow.
    later: Option<Measure>,
    /// How the next clause follows.
    join: Join,
    /// Whether a mark or a join stands before it.
    apart: bool,
}

/// The clauses of a text.
pub(crate) fn clauses(chunks: &[Chunk], lexicon: &Lexicon) -> Vec<Clause> {
    let mut parser = Parser::new(chunks, lexicon);
    while parser.at < chunks.len() {
        parser.sentence();
    }
    parser.found
}

impl Parser<'_> {
    pub(crate) fn sentence(&mut self) {
        // What follows a semicolon goes on with the sentence.
        let goes_on = self.before().is_some_and(|before| before.spelled == ";");
        let join = if goes_on { Join::And } else { Join::Start };
        let mut own = Sentence { first: self.found.len(), apart: true, join, ..Sentence::default() };
        while let Some(chunk) = self.peek() {
            if chunk.is_mark(Mark::Stop) {
                let asks = chunk.spelled == "?";
                for clause in self.found.iter_mut().skip(own.first) {
                    clause.asks = asks;
                }
                self.at += 1;
                break;
            }
            if let Some(next) = self.joins(own.join) {
                (own.join, own.apart) = (next, true);
                self.at += 1;
            } else if let Some(tie) = self.tie() {
                self.tied(tie, &mut own);
            } else {
                self.next_clause(&mut own);
            }
        }
        if let Some(condition) = own.pending.pop() {
            let mut clause = Clause::new(own.join, condition.clause.tokens.start);
            clause.tokens = condition.clause.tokens.clone();
            clause.subject = condition.clause.subject.clone();
            clause.conditions.push(condition);
            clause.conditions.append(&mut own.pending);
            self.found.push(clause);
        }
    }

    /// A condition: of the clause before it, or of those that follow.
    fn tied(&mut self, tie: Tie, own: &mut Sentence) {
        let condition = self.condition(tie);
        let first = own.first;
        let more = self.peek().is_some_and(|next| !next.is_mark(Mark::Stop));
        // `he does, when it is near, and waves`: of what stands before it.
        let closed = self.peek().is_some_and(|next| next.is_mark(Mark::Comma))
            && self.ahead(1).is_some_and(|next| next.word(Sort::And) || next.word(Sort::But));
        let before = self.found.len() > first && (!own.apart || !more || closed || tie == Tie::Unless);
        let said = self.found.get(first..).unwrap_or_default();
        let acts = said.iter().rposition(|clause| !clause.acts.is_empty() || clause.does.is_some());
        let clause = acts.filter(|_| !more).map(|at| first + at).or_else(|| self.found.len().checked_sub(1));
        match clause.and_then(|at| self.found.get_mut(at)).filter(|_| before) {
            Some(clause) => clause.conditions.push(condition),
            None => {
                if own.pending.is_empty() {
                    own.ahead.clear();
                }
                if matches!(condition.tie, Tie::When | Tie::After) {
                    own.ahead.push(condition.clone());
                }
                own.pending.push(condition);
            }
        }
    }

    /// A clause, with what was said before it and holds of it.
    fn next_clause(&mut self, own: &mut Sentence) {
        let first = own.first;
        // `two people come out, first a nurse and then a porter`: who they are.
        let first_of = self.peek().is_some_and(|chunk| chunk.lemma == "first") && self.found.len() > first;
        if first_of && self.ahead(1).and_then(Chunk::noun).is_some_and(|noun| noun.pick == Pick::Some) {
            own.join = Join::Colon;
        }
        let start = self.at;
        let before = self.subject.clone();
        let mut clause = self.clause(own.join, false);
        // What may not begin a clause is left over.
        if self.at == start {
            clause.left.extend(self.peek().into_iter().flat_map(|chunk| chunk.tokens.clone()));
            self.at += 1;
        }
        clause.tokens.end = self.token().max(clause.tokens.end);
        if self.is_condition(&clause, start, first) {
            let condition = Condition { tie: Tie::When, clause };
            let opened = start.checked_sub(1).and_then(|at| self.chunks.get(at));
            match self.found.last_mut().filter(|_| opened.is_some_and(|before| before.is_mark(Mark::Open))) {
                Some(last) => last.conditions.push(condition),
                None => own.pending.push(condition),
            }
            return;
        }
        // `when it is close (1 m)`
        let bare = clause.acts.is_empty() && !clause.own && clause.places.is_empty() && clause.left.is_empty();
        if let Some(condition) = own.pending.last_mut().filter(|_| bare && clause.within_m.is_some()) {
            condition.clause.within_m = condition.clause.within_m.or(clause.within_m);
            if let Some(ahead) = own.ahead.last_mut() {
                ahead.clause.within_m = ahead.clause.within_m.or(clause.within_m);
            }
            return;
        }
        let more = self.peek().is_some_and(|next| !next.is_mark(Mark::Stop));
        if clause.acts.is_empty() && clause.after_s.is_some() && more {
            own.later = clause.after_s.take();
        } else if !clause.acts.is_empty() && clause.conditions.is_empty() && clause.after_s.is_none() {
            clause.after_s = own.later.take();
        }
        let plain = |act: &Predicate| self.lexicon.frames.get(act.row).is_some_and(|frame| frame.plain);
        let same = clause.acts.iter().all(plain) && clause.subject == before && self.found.len() > first;
        if same && self.adds(&clause) {
            return;
        }
        if clause.conditions.is_empty() || !own.pending.is_empty() {
            clause.conditions.append(&mut own.pending);
        }
        if clause.conditions.is_empty() && clause.after_s.is_none() && clause.join != Join::Then {
            clause.conditions.clone_from(&own.ahead);
        }
        self.gap(&mut clause, first);
        self.share(&mut clause, first);
        self.front(&clause, first);
        self.found.push(clause);
        (own.join, own.apart) = (Join::And, false);
    }

    /// `at 2 m he stops`, `he stops (robot within 2 m)`: a clause that tells no more than when another holds.
    fn is_condition(&self, clause: &Clause, start: usize, first: usize) -> bool {
        let frame = |act: &Predicate| self.lexicon.frames.get(act.row);
        let when = |act: &Predicate| frame(act).is_some_and(|frame| frame.plain && frame.robot_cue.is_some());
        if clause.within_m.is_none() || clause.acts.is_empty() || !clause.acts.iter().all(when) {
            return false;
        }
        let noun = self.peek().and_then(Chunk::noun).is_some_and(Noun::may_be_person);
        let opened =
            start.checked_sub(1).and_then(|at| self.chunks.get(at)).is_some_and(|chunk| chunk.is_mark(Mark::Open));
        let of_robot = clause.subject.iter().all(|noun| noun.head == Head::Robot);
        !clause.own && noun || opened && of_robot && self.found.len() > first
    }

    /// `Coming towards the robot: a nurse`: what is said before its subject.
    pub(crate) fn front(&mut self, clause: &Clause, first: usize) {
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
    pub(crate) fn adds(&mut self, clause: &Clause) -> bool {
        // `…, but only after it has stopped`
        let when = clause.acts.is_empty() && !clause.own && !clause.conditions.is_empty();
        let way = clause.acts.is_empty() && !clause.own && clause.places.iter().any(|at| at.to);
        let amounts = when || way || clause.lasts_s.is_some() || clause.within_m.is_some() || clause.after_s.is_some();
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
        last.described.extend(&clause.described);
        last.looks.extend(&clause.looks);
        if last.conditions.is_empty() || when {
            last.conditions.clone_from(&clause.conditions);
        }
        true
    }

    /// `the first stops when it is near, the second when it is 1 m away`: does the same.
    fn gap(&self, clause: &mut Clause, first: usize) {
        let before = self.found.get(first..).and_then(<[Clause]>::last);
        let tells = !clause.conditions.is_empty() || clause.within_m.is_some() || clause.lasts_s.is_some();
        let other = clause.own && clause.subject.iter().all(|noun| noun.head == Head::Bare);
        // `first a nurse comes out, then a guest`
        let bare = clause.places.is_empty() && clause.left.is_empty() && clause.looks.is_empty();
        let who = self.peek().is_some_and(|chunk| chunk.word(Sort::Who));
        let next = clause.join == Join::Then && clause.own && !who && bare && clause.subject.iter().all(names_somebody);
        // `robot goal: the exit`
        let part = |act: &Predicate| self.lexicon.frames.get(act.row).is_some_and(|frame| frame.part.is_some());
        let part = !clause.own
            && !clause.places.is_empty()
            && before.is_some_and(|before| before.acts.iter().any(part) && before.places.is_empty());
        let same = tells && other || next || part;
        if let Some(before) = before.filter(|_| same && clause.acts.is_empty() && clause.does.is_none()) {
            clause.acts.clone_from(&before.acts);
        }
    }

    /// What is said when for the first of several acts holds for those joined to it: `when it is near, he stops and looks`.
    pub(crate) fn share(&self, clause: &mut Clause, first: usize) {
        let Some(before) = self.found.get(first..).and_then(<[Clause]>::last) else { return };
        let joined = clause.join == Join::And && clause.conditions.is_empty() && clause.after_s.is_none();
        // `spots it, freezes`: freezes as he spots it.
        let notices = before.acts.last().and_then(|act| self.lexicon.frames.get(act.row));
        let notices = notices.is_some_and(|frame| frame.cue.is_some() && frame.act.is_none() && !frame.plain);
        if joined && before.subject == clause.subject && !before.acts.is_empty() && !notices {
            clause.conditions.clone_from(&before.conditions);
            clause.conditions.retain(|condition| condition.tie != Tie::Until && condition.tie != Tie::While);
            let acts = |act: &Predicate| self.lexicon.frames.get(act.row).is_some_and(|frame| frame.act.is_some());
            if !before.acts.iter().any(acts) {
                clause.after_s = before.after_s;
            }
        }
    }

    /// A word or mark that joins clauses, and how.
    pub(crate) fn joins(&self, join: Join) -> Option<Join> {
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
            Is::Word if chunk.word(Sort::And) || chunk.word(Sort::Or) => match join {
                Join::Then | Join::Colon => join,
                Join::Start | Join::And | Join::But => Join::And,
            },
            Is::Word | Is::Noun(_) | Is::Whose(_) | Is::Place(_) | Is::Amount(_) | Is::Mark(Mark::Stop) => return None,
        })
    }

    /// Whether the chunk begins a condition.
    pub(crate) fn tie(&self) -> Option<Tie> {
        let chunk = self.peek().filter(|chunk| chunk.is == Is::Word)?;
        let next = self.ahead(1);
        let follows = |next: &Chunk| {
            matches!(next.is, Is::Noun(_) | Is::Whose(_))
                || next.bent == Bent::Ing && next.is == Is::Word
                || next.word(Sort::Verb) && next.bent == Bent::Ed
        };
        let person = next.is_some_and(follows);
        // `the same direction as the robot` compares.
        let compares = self.before().is_some_and(|before| before.word(Sort::Empty));
        let tie = match () {
            () if chunk.word(Sort::Until) => Tie::Until,
            () if chunk.word(Sort::Unless) => Tie::Unless,
            () if chunk.word(Sort::When) => Tie::When,
            () if chunk.word(Sort::Before) && person => Tie::Before,
            () if chunk.word(Sort::After) && person => Tie::After,
            () if chunk.word(Sort::While) && person && !compares => Tie::While,
            () => return None,
        };
        (tie == Tie::Until || next.is_some_and(|next| !matches!(next.is, Is::Amount(_)))).then_some(tie)
    }

    pub(crate) fn condition(&mut self, tie: Tie) -> Condition {
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

    pub(crate) fn clause(&mut self, join: Join, inner: bool) -> Clause {
        let (start, mut clause) = (self.at, Clause::new(join, self.token()));
        clause.not = self.denied && join == Join::And && self.before().is_some_and(|before| before.word(Sort::Or));
        clause.own = self.relative(&mut clause);
        while let Some(chunk) = self.peek() {
            let aside = inner && chunk.is_mark(Mark::Comma) && clause.is_bare() && !clause.subject.is_empty();
            if aside && self.ahead(1).is_some_and(|next| next.word(Sort::Who)) {
                self.aside();
                continue;
            }
            if self.ends(&clause, inner) {
                break;
            }
            match &chunk.is {
                Is::Noun(noun) => {
                    let noun = noun.clone();
                    self.noun(noun, inner, &mut clause);
                }
                Is::Whose(_) | Is::Mark(_) => {
                    clause.goes.push(chunk.tokens.clone());
                    self.at += 1;
                }
                Is::Amount(amount) => {
                    let amount = *amount;
                    if !self.framed(&mut clause) {
                        self.amount(amount, &mut clause);
                    }
                }
                Is::Place(class) => {
                    let class = *class;
                    // `exit` alone is a place, and nothing that somebody does.
                    let more = longest(self.chunks, self.at, &self.lexicon.frame_patterns)
                        .is_some_and(|found| found.end > self.at + 1);
                    if !more || !self.framed(&mut clause) {
                        self.place(class, &mut clause);
                    }
                }
                Is::Word => match self.tie().filter(|_| !inner) {
                    Some(tie) => {
                        let condition = self.condition(tie);
                        clause.conditions.push(condition);
                        let comma = self.peek().is_some_and(|next| next.is_mark(Mark::Comma));
                        self.at += usize::from(comma && clause.acts.is_empty() && clause.own);
                    }
                    None => self.word(&mut clause),
                },
            }
        }
        self.denied = clause.not || clause.acts.iter().any(|act| act.not);
        self.keep_subject(&mut clause, inner);
        // `the other won't`
        let denied = !clause.denials.is_empty() && clause.own && clause.acts.is_empty();
        if denied && clause.left.is_empty() && clause.places.is_empty() {
            clause.does = Some(false);
        }
        self.describe(start, inner, &mut clause);
        clause.tokens.end = self.token();
        clause
    }

    /// Whose clause it is: its own subject, or by ellipsis that of the clause before.
    fn keep_subject(&mut self, clause: &mut Clause, inner: bool) {
        if clause.own {
            self.subject.clone_from(&clause.subject);
        } else {
            // `robot 3 m away: stops`: not the robot, of which the reason tells.
            let robot = !self.subject.is_empty() && self.subject.iter().all(|noun| noun.head == Head::Robot);
            // But what is said after its name it says: `robot: "excuse me"`.
            let says = clause.acts.first().is_some_and(|act| {
                act.sign.is_some() && act.tokens.start <= clause.tokens.start + 1 && clause.join == Join::Colon
            });
            let answers = robot && !says && matches!(clause.join, Join::Colon | Join::Then) && !self.person.is_empty();
            clause.subject.clone_from(if answers { &self.person } else { &self.subject });
        }
        if clause.subject.iter().any(|noun| !noun.may_be_robot()) && !inner {
            self.person.clone_from(&clause.subject);
        }
    }

    /// A relative clause between commas, within a condition: a clause of its own.
    pub(crate) fn aside(&mut self) {
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
    pub(crate) fn relative(&mut self, clause: &mut Clause) -> bool {
        let who = self.peek().filter(|chunk| chunk.word(Sort::Who)).map(|chunk| chunk.tokens.clone());
        let Some(tokens) = who.filter(|_| self.at > 0) else { return false };
        // `both of whom the robot asks to wait`: the robot asks.
        let verb = |chunk: &Chunk| chunk.word(Sort::Verb) && chunk.bent == Bent::S || chunk.word(Sort::Modal);
        if self.ahead(1).and_then(Chunk::noun).is_some_and(Noun::may_be_robot) && self.ahead(2).is_some_and(verb) {
            clause.goes.push(tokens);
            self.at += 1;
            return false;
        }
        // `the robot, which asks them to wait`
        let before = self.chunks.get(..self.at).unwrap_or_default();
        let noun = before.iter().rev().find(|chunk| !chunk.is_mark(Mark::Comma)).and_then(Chunk::noun);
        let which = self.peek().is_some_and(|chunk| chunk.word(Sort::Which));
        // `follows a nurse, who …`: the nurse; of the subject all of it is meant.
        let of_subject = noun.is_some_and(|noun| self.subject.iter().any(|own| own.tokens == noun.tokens));
        let robot =
            noun.filter(|noun| noun.head == Head::Robot && which).map(|_| Noun::new(Head::Robot, tokens.clone()));
        let object = noun.filter(|noun| names_somebody(noun) && !of_subject).cloned();
        clause.subject.push(robot.or(object).unwrap_or_else(|| Noun::new(Head::Who, tokens)));
        self.at += 1;
        true
    }

    /// Whether the clause ends before the chunk.
    pub(crate) fn ends(&self, clause: &Clause, inner: bool) -> bool {
        let Some(chunk) = self.peek() else { return true };
        match &chunk.is {
            Is::Mark(Mark::Quote) => false,
            Is::Mark(Mark::Comma) => {
                let doing = |next: &Chunk| next.word(Sort::Verb) && next.bent == Bent::Ing;
                let fill = self.ahead(1).is_some_and(|next| next.word(Sort::Fill) && !next.word(Sort::And));
                let next = self.ahead(1 + usize::from(fill));
                !(clause.is_bare() && !clause.subject.is_empty() && next.is_some_and(doing))
            }
            Is::Mark(_) => true,
            Is::Noun(noun) => {
                let by = self.at > 0
                    && self.chunks.get(self.at - 1).is_some_and(|before| {
                        before.word(Sort::By)
                            || before.word(Sort::At)
                            || before.word(Sort::To)
                            || before.word(Sort::Of)
                            || before.word(Sort::With)
                    });
                let complete = !clause.acts.is_empty() || inner && !clause.is_bare();
                let turned = !inner
                    && clause.is_turned()
                    && names_somebody(noun)
                    && !self.before().is_some_and(|before| before.is_mark(Mark::Comma));
                complete && !by && !turned && noun.tokens.start > 0
            }
            Is::Word if chunk.word(Sort::And) || chunk.word(Sort::But) || chunk.word(Sort::Or) => true,
            // `the robot drives on with a manager walking beside it`: the manager walks.
            Is::Word if chunk.word(Sort::With) => {
                let noun = self.ahead(1).and_then(Chunk::noun).is_some_and(names_somebody);
                let doing = |next: &Chunk| next.word(Sort::Verb) && next.bent == Bent::Ing;
                noun && self.ahead(2).is_some_and(doing) && !clause.is_bare()
            }
            // `the robot then asks` is one clause.
            Is::Word if chunk.word(Sort::Then) => !(clause.own && clause.is_bare()),
            Is::Word if chunk.word(Sort::While) && self.ahead(1).and_then(Chunk::noun).is_some_and(names_somebody) => {
                !clause.is_bare() || !clause.subject.is_empty()
            }
            // `when a nurse who comes towards it sees it` is one condition.
            Is::Word if chunk.word(Sort::Who) && !chunk.word(Sort::Definite) => {
                let begins = clause.subject.is_empty() && clause.acts.is_empty();
                !(inner && clause.is_bare() || begins)
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
}
