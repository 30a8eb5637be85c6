//! Humans by a card, where the request names none.

use socrates_model::reading::ReadHuman;
use socrates_model::{GroupId, HumanId, Location, Reading, Request};
use socrates_reader::Reader;

use crate::card::{Card, card, catalog};
use crate::draw::Draw;
use crate::story::{Extra, Story};

/// Fills the reading with the people of its pattern, as few as the card allows.
pub(crate) fn fill(reading: &mut Reading, story: &Story, request: &Request, location: &Location) -> Vec<Extra> {
    let found = reading.pattern.as_deref().and_then(card);
    let Some(card) = found.or_else(|| catalog().iter().find(|card| card.fits(location))) else { return Vec::new() };
    reading.pattern = Some(card.id.clone());
    reading.notes.push(format!("the text names no people; the pattern `{}` says who is there", card.id));
    let (humans, extras) = people(card, &mut Draw::new(0, "reading"), request);
    reading.humans = humans;
    if story.groups.is_empty() && card.roles.iter().any(|role| role.group) && reading.humans.len() > 1 {
        reading.notes.push("they form a group".to_owned());
    }
    extras
}

/// The people of a card: as many as are expected, else a number drawn from the card's ranges.
pub(crate) fn people(card: &Card, draw: &mut Draw, request: &Request) -> (Vec<ReadHuman>, Vec<Extra>) {
    let total = request.expect.headcount();
    let context = Reader::shipped().scene(&request.social_context).role;
    let mut counts: Vec<u32> = card
        .roles
        .iter()
        .map(|role| {
            let [least, most] = role.count;
            let wide = usize::try_from(most.saturating_sub(least)).unwrap_or(0);
            if total.is_some() { least } else { least + u32::try_from(draw.below(wide + 1)).unwrap_or(0) }
        })
        .collect();
    if let Some(total) = total {
        let others: u32 = counts.iter().skip(1).sum();
        if let Some(first) = counts.first_mut() {
            *first = total.saturating_sub(others).max(1);
        }
    }
    let (mut humans, mut extras) = (Vec::new(), Vec::new());
    for (role, count) in card.roles.iter().zip(counts) {
        let group = role.group && count > 1;
        for _ in 0..count {
            if total.is_some_and(|total| humans.len() >= usize::try_from(total).unwrap_or(usize::MAX)) {
                break;
            }
            let number = u32::try_from(humans.len() + 1).unwrap_or(u32::MAX);
            let who = context.clone().or_else(|| draw.pick(&role.who).cloned()).unwrap_or_else(|| "person".to_owned());
            let rules: Vec<_> = role.rules.iter().map(|rule| rule.drawn(draw)).collect();
            extras.push(Extra {
                speed_mps: role.speed.map(|range| draw.tenths(range)),
                start: role.start,
                goal: role.goal,
                stated: vec![false; rules.len()],
                open: Vec::new(),
            });
            humans.push(ReadHuman {
                id: HumanId::new(number),
                role: who,
                summary: role.name.clone(),
                relation: Some(role.relation),
                rules,
                group: if group { Some(GroupId(1)) } else { None },
            });
        }
    }
    expected_groups(&request.expect.groups, &mut humans, &mut extras);
    (humans, extras)
}

/// The groups that the request expects instead of the card's: who is in one stands to the robot as its first member does.
fn expected_groups(groups: &[Vec<u32>], humans: &mut [ReadHuman], extras: &mut [Extra]) {
    if groups.is_empty() {
        return;
    }
    for human in humans.iter_mut() {
        human.group = None;
    }
    for (id, members) in (1..).map(GroupId).zip(groups) {
        let members: Vec<usize> = members.iter().filter_map(|n| usize::try_from(*n).ok()?.checked_sub(1)).collect();
        let first = members.first().and_then(|first| Some((humans.get(*first)?.clone(), extras.get(*first)?.clone())));
        let Some((first, with)) = first else { continue };
        for member in members {
            if let (Some(human), Some(extra)) = (humans.get_mut(member), extras.get_mut(member)) {
                if human.relation != first.relation {
                    (human.relation, human.summary) = (first.relation, first.summary.clone());
                    human.rules.clone_from(&first.rules);
                    extra.stated.clone_from(&with.stated);
                }
                human.group = Some(id);
                (extra.start, extra.goal, extra.speed_mps) = (with.start, with.goal, with.speed_mps);
            }
        }
    }
}

/// A pattern for a request without a rough scenario: one that the map can hold, drawn by the seed. A task that says what the
/// robot does with people ("guide", "follow") is one of the patterns about that.
pub(crate) fn unguided(task: &str, location: &Location, draw: &mut Draw) -> Option<&'static Card> {
    let fitting: Vec<&'static Card> = catalog().iter().filter(|card| card.fits(location)).collect();
    let verbs: Vec<String> = task
        .split(|letter: char| !letter.is_alphabetic())
        .filter(|word| !word.is_empty())
        .map(|word| Reader::shipped().base(&word.to_lowercase()))
        .collect();
    let meant: Vec<&'static Card> =
        fitting.iter().copied().filter(|card| card.tasks.iter().any(|task| verbs.contains(task))).collect();
    draw.pick(if meant.is_empty() { &fitting } else { &meant }).copied()
}
