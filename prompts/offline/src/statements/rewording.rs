//! For words that were not read: the clause in other words that would be, found by trying.

use std::ops::Range;

use crate::lexicon::lexicon;

use super::Account;
use super::text::{exchanged, masked};
use super::words::{Kind, is_person};

/// Slips of the pen that are tried, in letters.
const SLIPS: usize = 2;
/// What somebody can be said to do instead, the first that is read counts.
const INSTEAD: [&str; 2] = ["stands still for 3 s", "stops when the robot is within 3 m"];

/// A clause in which the words of a run are others, or left out, so that all of it is read.
pub(super) fn of(account: &Account<'_>, run: &[usize], clause: &[usize]) -> Option<String> {
    misspelled(account, run, clause).or_else(|| without(account, run, clause)).or_else(|| instead(account, clause))
}

/// A word of the tables that the unread word may have meant, where it makes a difference.
fn misspelled(account: &Account<'_>, run: &[usize], clause: &[usize]) -> Option<String> {
    let [place] = run
        .iter()
        .copied()
        .filter(|place| account.tokens.get(*place).is_some_and(|token| token.lower.len() > 3))
        .collect::<Vec<_>>()[..]
    else {
        return None;
    };
    // A word of a closed table is no slip of the pen.
    account.kinds.get(place).filter(|kind| matches!(kind, Kind::Act | Kind::Manner | Kind::Place | Kind::Other))?;
    let token = account.tokens.get(place)?;
    let mut near: Vec<(usize, &String)> = lexicon()
        .telling
        .iter()
        .filter(|word| word.len() > 3 && word.as_bytes().first() == token.lower.as_bytes().first())
        .map(|word| (strsim::damerau_levenshtein(word, &token.lower), word))
        .filter(|(slips, word)| (1..=SLIPS).contains(slips) && slips * 3 < word.len())
        .collect();
    near.sort_unstable();
    let hidden = account.reads(&masked(account.text, &account.tokens, &|n| n == place));
    let word = near
        .iter()
        .take(3)
        .map(|(_, word)| *word)
        .find(|word| account.reads(&exchanged(account.text, token, word)) != hidden)?;
    let Range { start: from, end: to } = account.bounds(clause)?;
    Some(format!("{}{word}{}", account.text.get(from..token.at.start)?, account.text.get(token.at.end..to)?))
}

/// The clause without the words, where something of it was read.
fn without(account: &Account<'_>, run: &[usize], clause: &[usize]) -> Option<String> {
    let rest = |place: &&usize| !run.contains(*place);
    clause.iter().filter(rest).find(|place| account.influence.is_read(**place))?;
    let words = clause.iter().filter(rest).filter_map(|place| account.text.get(account.tokens.get(*place)?.at.clone()));
    Some(words.collect::<Vec<_>>().join(" "))
}

/// Something else for the one of whom the clause speaks, where that would be read.
fn instead(account: &Account<'_>, clause: &[usize]) -> Option<String> {
    let who = clause.iter().filter_map(|place| account.tokens.get(*place)).find(|token| is_person(token))?;
    let subject = account.text.get(who.at.clone())?;
    let Range { start: from, end: to } = account.bounds(clause)?;
    let tried = |deed: &&str| {
        let (before, after) = (account.text.get(..from)?, account.text.get(to..)?);
        let text = format!("{before}{subject} {deed}{after}");
        (account.reads(&text) != account.whole.lines).then(|| format!("{subject} {deed}"))
    };
    INSTEAD.iter().find_map(tried)
}
