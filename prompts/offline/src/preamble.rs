//! What is told before the story: `This one is about gestures between humans: …`, `Tenants have complained that it frightens people.`

use crate::mention::{Mention, Who, mentions};
use crate::words::{Piece, Word};

/// Words of whoever asks, and of studies.
const ASKING: &[&str] = &[
    "i", "we", "us", "my", "our", "you", "your", "study", "literature", "experiment", "research", "about",
    "interested", "wonder", "question", "hypothesis", "claim", "claims", "complained", "complain", "report", "reported",
];
/// Words by which such a part speaks of somebody who is there after all.
const THERE: &[&str] = &["there", "have", "want", "need", "like", "simulate", "show", "put", "add", "imagine", "let", "make", "with"];

/// Makes nobody's a part of the text that speaks of people in general before the story names those who are in it.
///
/// The words stay unused, so that what they wish for is reported as not understood.
pub(crate) fn preamble(pieces: &mut [Piece]) {
    let mut parts: Vec<(usize, usize)> = Vec::new();
    let mut from = 0;
    for at in 0..=pieces.len() {
        if matches!(pieces.get(at), Some(Piece::Stop | Piece::Colon) | None) {
            if at > from {
                parts.push((from, at));
            }
            from = at + 1;
        }
    }
    let words = |(from, to): (usize, usize)| -> Vec<Word> {
        let words = pieces.get(from..to).unwrap_or_default().iter();
        words.filter_map(|piece| if let Piece::Word(word) = piece { Some(word.clone()) } else { None }).collect()
    };
    let spoken: Vec<(Vec<Word>, Vec<Mention>)> = parts
        .iter()
        .map(|part| {
            let words = words(*part);
            let found = mentions(&words);
            (words, found)
        })
        .collect();
    let Some(first) = spoken.iter().position(|(_, found)| found.iter().any(introduces)) else { return };
    let silent: Vec<(usize, usize)> =
        parts.iter().zip(&spoken).take(first).filter(|(_, (words, found))| general(words, found)).map(|(part, _)| *part).collect();
    for (from, to) in silent {
        for piece in pieces.iter_mut().take(to).skip(from) {
            if let Piece::Word(word) = piece {
                word.label = true;
            }
        }
    }
}

/// Whether a mention says that somebody is there.
fn introduces(mention: &Mention) -> bool {
    match &mention.who {
        // `how a dyad affects the robot`
        Who::New { .. } if mention.group && mention.role.is_none() => false,
        Who::New { count, .. } => count.is_some(),
        Who::Definite { .. } => mention.role.is_some(),
        Who::More(_) | Who::PartOfNew(..) | Who::AllOf(_) | Who::OrdinalOf { .. } | Who::Number(_) => {
            true
        }
        Who::Bare(n) => *n > 1,
        Who::PartOf(_)
        | Who::ToldApart
        | Who::Other(_)
        | Who::Ordinal(_)
        | Who::Some { .. }
        | Who::All
        | Who::AllBut(_)
        | Who::Same
        | Who::Object
        | Who::Further(_)
        | Who::Nobody => false,
    }
}

/// Whether a part speaks of people in general.
fn general(words: &[Word], found: &[Mention]) -> bool {
    let text = |k: usize| words.get(k).map_or("", |word| word.text.as_str());
    let asks = words.iter().any(|word| ASKING.contains(&word.text.as_str()) || ASKING.contains(&word.stem.as_str()));
    let kind = |mention: &Mention| match mention.who {
        // `people in our ward`; but `I want people who …`, `with visitors`
        Who::New { count: None, .. } => {
            !(0..mention.from).any(|k| THERE.contains(&text(k)) && mention.from - k <= 3)
                || mention.from > 1 && text(mention.from - 1) == "with"
        }
        Who::New { .. } if mention.group && mention.role.is_none() => true,
        // `this one is about …`
        Who::Definite { plural: false, count: Some(1) } if mention.role.is_none() => true,
        Who::All | Who::Ordinal(_) | Who::ToldApart | Who::Bare(1) => true,
        Who::New { .. }
        | Who::More(_)
        | Who::PartOf(_)
        | Who::PartOfNew(..)
        | Who::AllOf(_)
        | Who::Bare(_)
        | Who::Other(_)
        | Who::Some { .. }
        | Who::Definite { .. }
        | Who::AllBut(_)
        | Who::OrdinalOf { .. }
        | Who::Same
        | Who::Object
        | Who::Further(_)
        | Who::Number(_)
        | Who::Nobody => false,
    };
    asks && !found.is_empty() && found.iter().all(kind)
}
