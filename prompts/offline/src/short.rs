//! What a clause asks for beyond what is played of it: said, so that no run passes for more than it is.

use socrates_model::{Fault, FaultCode};

use crate::clause::{Deed, Found, mark_each};
use crate::cut::Stretch;
use crate::lexicon::{Act, lexicon};
use crate::negation::negated;
use crate::story::Story;
use crate::words::find;

/// How far behind its leader a follower walks, m: another distance is not played.
const GAP_M: (f64, f64) = (1.0, 2.0);

/// Who walks, as far as is played.
const fn walks(act: Act) -> bool {
    matches!(act, Act::Walk | Act::GoOn | Act::Pass | Act::Enter)
}

/// Notes what is not played of what people do in a clause; `timed` where the clause says when.
pub(crate) fn note(
    story: &mut Story,
    stretch: &mut Stretch,
    found: &Found,
    meant: &[(usize, usize, Vec<usize>)],
    (quote, timed): (&str, bool),
) {
    for deed in found.deeds.iter().filter(|deed| !deed.negated) {
        if let Some(words) = to_somebody(stretch, *deed, meant) {
            unplayed(
                &mut story.problems,
                quote,
                &format!("`{words}`: people come up to the robot alone; to whom else somebody goes"),
            );
        }
        if matches!(deed.act, Act::Follow | Act::Abreast)
            && !timed
            && let Some(m) = found.distance_m.filter(|m| !(GAP_M.0..=GAP_M.1).contains(m))
        {
            unplayed(&mut story.problems, quote, &format!("`{m} m`: how far from each other they keep"));
        }
    }
    for phrase in &lexicon().unplayed {
        let Some(at) = find(&stretch.words, phrase, 0, false, &|_| true) else { continue };
        let last = at.last().copied().unwrap_or(0);
        let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
        // A longer phrase took the word: `steps back` makes way. `goes back to reading` goes on.
        let taken = stretch.words.get(last).is_none_or(|word| word.used);
        let errand = text(last + 1) == "to" && !found.places.iter().any(|(_, place)| *place > last);
        if taken || errand || negated(stretch, at.first().copied().unwrap_or(0)) {
            continue;
        }
        let words: Vec<&str> = at.iter().map(|k| text(*k)).collect();
        let words = words.join(" ");
        unplayed(
            &mut story.problems,
            quote,
            &format!("`{words}`: people walk their way once, from its start to its end; that"),
        );
        mark_each(stretch, &at);
    }
}

/// `walks up to a patient`, `runs to him`: the words from the verb to whom it goes to.
fn to_somebody(stretch: &Stretch, deed: Deed, meant: &[(usize, usize, Vec<usize>)]) -> Option<String> {
    if !walks(deed.act) {
        return None;
    }
    let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
    let to = (deed.at + 1..deed.at + 4).find(|k| text(*k) == "to")?;
    let between = (deed.at + 1..to).all(|k| matches!(text(k), "up" | "over" | "back" | "right" | "straight" | "on"));
    let (_, last, _) = meant.iter().find(|(from, _, some)| *from == to + 1 && !some.is_empty())?;
    // `to her room`, `to the patient's bed`
    let ends = stretch.words.get(last + 1).is_none_or(|word| lexicon().stop.contains(&word.text));
    (between && ends).then(|| (deed.at..=*last).map(text).collect::<Vec<_>>().join(" "))
}

/// Says that something is not played.
pub(crate) fn unplayed(problems: &mut Vec<Fault>, quote: &str, what: &str) {
    once(problems, quote, format!("`{quote}` is not played in full: {what} is not played"));
}

/// Says what is not played of these words, unless that was said of them already.
pub(crate) fn once(problems: &mut Vec<Fault>, quote: &str, message: String) {
    let said =
        |fault: &Fault| fault.code == FaultCode::PRead && fault.quotes.first().is_some_and(|words| words == quote);
    if !problems.iter().any(said) {
        problems.push(Fault::new(FaultCode::PRead, "rough_scenario", message).about([quote]));
    }
}

/// `keeps at least three metres away`, where nobody does anything else.
pub(crate) fn keeps(story: &mut Story, stretch: &Stretch, found: &Found, quote: &str) {
    let has = |words: &[&str]| stretch.words.iter().any(|word| words.contains(&word.stem.as_str()));
    let keeps =
        has(&["keep", "stay", "remain", "maintain"]) && has(&["away", "distance", "apart", "behind", "off", "clear"]);
    if let Some(m) = found.distance_m.filter(|_| keeps && !found.acts()) {
        unplayed(&mut story.problems, quote, &format!("`{m} m`: how far from each other they keep"));
    }
}
