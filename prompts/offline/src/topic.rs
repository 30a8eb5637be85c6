//! Who is only spoken of: `they discuss a patient`, `two nurses talk about a visitor`.

use crate::clause::mark;
use crate::cut::Stretch;
use crate::mention::Mention;

/// Drops the mentions of those of whom others only talk.
pub(crate) fn drop_topics(stretch: &mut Stretch, mentions: &mut Vec<Mention>) {
    let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
    let stem = |k: usize| stretch.words.get(k).map_or("", |word| word.stem.as_str());
    let talks = |k: usize| {
        matches!(
            stem(k),
            "talk" | "chat" | "speak" | "gossip" | "argue" | "joke" | "laugh" | "discuss" | "conversation"
        )
    };
    let topic = |mention: &Mention| {
        let Some(before) = mention.from.checked_sub(1) else { return false };
        stem(before) == "discuss" || text(before) == "about" && (0..before).rev().take(3).any(talks)
    };
    let spoken_of: Vec<(usize, usize)> =
        mentions.iter().filter(|mention| topic(mention)).map(|mention| (mention.from, mention.to)).collect();
    mentions.retain(|mention| !topic(mention));
    for (from, to) in spoken_of {
        mark(stretch, from, to);
    }
}
