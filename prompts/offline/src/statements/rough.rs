//! What became of every piece of the rough scenario, as the reader says it.

use std::collections::BTreeMap;
use std::ops::Range;

use socrates_model::fault::{Message, Span};
use socrates_model::statement::{Background, Became, Statement, TextKey};
use socrates_model::{Fault, Reading, Request};
use socrates_reader::{Fate, Piece, Read};

use super::plain;
use crate::aside;
use crate::understand::Understood;

/// What became of every piece of the rough scenario. `reading` has the facts, `whole` what was understood of the text alone.
pub(super) fn statements(request: &Request, whole: &Understood, reading: &Reading) -> Vec<Statement> {
    let key = TextKey::RoughScenario;
    let text = key.text_of(request);
    let told = aside::split(text);
    let read = &whole.said;
    // All pieces of a clause have one rewording.
    let mut reworded: BTreeMap<Option<usize>, Option<String>> = BTreeMap::new();
    let mut found: Vec<(Range<usize>, Became)> = Vec::new();
    for piece in &read.pieces {
        let became = match &piece.fate {
            Fate::Read => became(text, &piece.at, whole, reading),
            Fate::Background(reason) => Became::Background(*reason),
            Fate::NotPlayed(why) => Became::NotPlayed { why: Message::new(why.as_str()) },
            Fate::NotRead => {
                let own = reworded.entry(piece.clause).or_insert_with(|| rewording(&told.story, read, piece.clause));
                Became::NotRead { rewording: own.clone() }
            }
        };
        found.push((piece.at.clone(), became));
    }
    let at = |quote: &str| text.find(quote).filter(|_| !quote.is_empty()).map(|from| from..from + quote.len());
    found.extend(
        told.instructions
            .iter()
            .filter_map(|sentence| Some((at(sentence)?, Became::Background(Background::Instruction)))),
    );
    // What a layer above leaves out is said of its words, also where they are read.
    let of_text = |fault: &&Fault| fault.at.is_key(key.name()) || fault.at.agent.is_some();
    let problems = whole
        .reading
        .problems
        .iter()
        .filter(of_text)
        .filter(|fault| !fault.quotes.iter().any(|quote| told.instructions.contains(quote)));
    let quoted = problems.flat_map(|fault| fault.quotes.iter().map(|quote| (quote.clone(), fault.message.clone())));
    let unplayed = whole.unplayed.iter().map(|unplayed| (unplayed.quote.clone(), Message::new(unplayed.why.as_str())));
    found.extend(quoted.chain(unplayed).filter_map(|(quote, why)| Some((at(&quote)?, Became::NotPlayed { why }))));
    found.sort_by_key(|(at, _)| (at.start, at.end));
    found.into_iter().filter_map(|(at, became)| statement(request, text, &at, became)).collect()
}

/// A clause in plain words, where those are read whole and the story stays the same.
fn rewording(text: &str, read: &Read, clause: Option<usize>) -> Option<String> {
    let own = || read.pieces.iter().filter(|other| other.clause.is_some() && other.clause == clause);
    let lost = |fate: &Fate| matches!(fate, Fate::NotRead | Fate::NotPlayed(_));
    let at = own().map(|other| other.at.start).min()?..own().map(|other| other.at.end).max()?;
    let clause = plain::clause(text, read, &at)?;
    let again = format!("{}{clause}{}", text.get(..at.start)?, text.get(at.end..)?);
    let reads = socrates_reader::read(&again);
    let within = |other: &Piece| other.at.start < at.start + clause.len() && at.start < other.at.end;
    let whole = !reads.pieces.iter().any(|other| within(other) && lost(&other.fate));
    (whole && reads.story == read.story).then_some(clause)
}

/// The lines and facts whose words a piece has.
fn became(text: &str, piece: &Range<usize>, whole: &Understood, reading: &Reading) -> Became {
    let meets = |quote: &str| {
        let mut places = text.match_indices(quote);
        !quote.is_empty() && places.any(|(from, _)| from < piece.end && piece.start < from + quote.len())
    };
    // The words are those of the text alone; where a form or `[expect]` states the same, the fact is theirs.
    let own = || whole.reading.facts.iter().filter(|fact| meets(&fact.quote));
    let stated = |fact: &socrates_model::Fact| reading.facts.iter().find(|other| other.kind == fact.kind);
    let line = |fact: &socrates_model::Fact| {
        let mut lines = whole.lines.iter().filter(|line| line.shown && line.fact.as_ref() == Some(&fact.kind));
        lines.next().map(|line| line.text.clone())
    };
    Became::Read {
        lines: own().filter_map(line).collect(),
        facts: own().filter_map(stated).map(|fact| fact.id.clone()).collect(),
    }
}

fn statement(request: &Request, text: &str, at: &Range<usize>, became: Became) -> Option<Statement> {
    let quote = text.get(at.clone())?.to_owned();
    let statement = Statement { at: TextKey::RoughScenario, span: Span::of(text, at)?, quote, became, waived: false };
    Some(statement.waived_by(request))
}
