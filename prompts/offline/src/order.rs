//! Who is there before whom: `first …, then …`, `after the nurse has crossed, …`, `crosses behind the robot`.

use socrates_model::reading::ReadHuman;
use socrates_model::{AgentId, FactKind, HumanId, Trigger};

use crate::clause::{Found, mark};
use crate::cut::{Joint, Stretch};
use crate::lexicon::Act;
use crate::short;
use crate::story::{Story, Thread};

/// What the text says of who meets the robot before whom.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Order {
    /// Who met the robot in the last clause that told of it.
    met: Vec<usize>,
    /// First and later one, whether at a door, with the words.
    pairs: Vec<(AgentId, AgentId, bool, String)>,
}

/// The word before a clause, where it tells which of two comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Joiner {
    /// `after`, `once`.
    After,
    /// `before`.
    Before,
    /// `unless`.
    Unless,
}

/// Whether somebody who does this has a time at which he is there.
const fn meets(act: Act) -> bool {
    matches!(act, Act::Cross | Act::Toward | Act::Overtake | Act::Pass)
}

/// The word that joins a clause to another, if it tells which comes first.
pub(crate) fn joiner(text: &str, stretch: &Stretch) -> Option<Joiner> {
    let before = text.get(..stretch.words.first()?.from)?.trim_end();
    let word = before.rsplit(|c: char| !c.is_alphanumeric()).next()?.to_lowercase();
    match word.as_str() {
        "after" | "once" => Some(Joiner::After),
        "before" => Some(Joiner::Before),
        "unless" => Some(Joiner::Unless),
        _ => None,
    }
}

/// `crosses behind the robot`, `passes behind it`.
fn behind_robot(stretch: &Stretch) -> bool {
    let stem = |k: usize| stretch.words.get(k).map_or("", |word| word.stem.as_str());
    (0..stretch.words.len()).any(|k| stem(k) == "behind" && (stem(k + 1) == "robot" || stem(k + 2) == "robot"))
}

/// A clause that says when, by what the robot does: `before the robot reaches the crossing`.
pub(crate) fn condition(thread: &mut Thread, found: &Found) {
    let robot = (found.cue.is_some() || !found.robots.is_empty()) && found.mentions.is_empty();
    thread.before_robot = robot && thread.joiner == Some(Joiner::Before);
}

/// `one after the other`, `one by one`.
pub(crate) fn in_turn(stretch: &Stretch) -> bool {
    let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
    (0..stretch.words.len()).any(|k| {
        text(k) == "one"
            && (text(k + 1) == "by" && text(k + 2) == "one"
                || text(k + 1) == "after" && (text(k + 2) == "another" || text(k + 3) == "other"))
    })
}

/// `…, one after the other`, `One after another, …`: of those of the clause before, or after.
pub(crate) fn alone_in_turn(story: &mut Story, thread: &mut Thread, stretch: &mut Stretch, quote: &str) {
    mark(stretch, 0, stretch.words.len());
    match (thread.doer.clone(), thread.acts.clone()) {
        (Some(people), acts) if !acts.is_empty() => {
            for (act, _) in acts {
                each(story, act, &people, quote);
            }
        }
        (_, _) => thread.in_turn = true,
    }
}

/// Each of several meets the robot before the next; what else they do one after the other is not played so.
fn each(story: &mut Story, act: Act, people: &[usize], quote: &str) {
    let walks = meets(act) || matches!(act, Act::Walk | Act::GoOn);
    if walks && !people.iter().any(|who| story.cast.people.get(*who).is_some_and(|person| person.group.is_some())) {
        for next in people.windows(2) {
            if let [first, then] = next {
                pair(story, agent(*first), agent(*then), quote);
            }
        }
    } else if people.len() > 1 && !matches!(act, Act::ComeOut | Act::Enter) {
        // Through a door they come one after the other anyway.
        short::unplayed(&mut story.problems, quote, "that one does it after the other");
    }
}

/// Notes a deed by which people meet the robot.
pub(crate) fn note(
    story: &mut Story,
    thread: &mut Thread,
    stretch: &Stretch,
    (act, people): (Act, &[usize]),
    trigger: Option<&Trigger>,
    quote: &str,
) {
    if std::mem::take(&mut thread.in_turn) || in_turn(stretch) {
        each(story, act, people, quote);
    }
    if !meets(act) || people.is_empty() {
        return;
    }
    if trigger == Some(&Trigger::RobotPassed) || act == Act::Cross && behind_robot(stretch) {
        later(story, people, quote);
    } else if std::mem::take(&mut thread.before_robot) {
        earlier(story, people, quote);
    }
    let then = (stretch.joint == Joint::Then).then(|| story.order.met.clone());
    let prior = thread.after.take().or(then).unwrap_or_default();
    if prior.iter().all(|one| !people.contains(one)) {
        for first in &prior {
            for who in people {
                pair(story, agent(*first), agent(*who), quote);
            }
        }
    }
    if stretch.joint == Joint::When && thread.joiner == Some(Joiner::After) {
        thread.after = Some(people.to_vec());
    }
    story.order.met = people.to_vec();
}

/// `…, after it has passed`, `… before the robot arrives`: said behind what it times. True where somebody met the robot in the
/// clause before.
pub(crate) fn passed(story: &mut Story, thread: &mut Thread, when: &Trigger, quote: &str) -> bool {
    let met = thread.made.is_empty() && thread.acts.iter().any(|(act, _)| meets(*act));
    let Some(people) = thread.doer.clone().filter(|_| met) else { return false };
    if *when == Trigger::RobotPassed {
        later(story, &people, quote);
    } else if std::mem::take(&mut thread.before_robot) {
        earlier(story, &people, quote);
    } else {
        return false;
    }
    true
}

fn later(story: &mut Story, people: &[usize], quote: &str) {
    for who in people {
        pair(story, AgentId::Robot, agent(*who), quote);
    }
}

fn earlier(story: &mut Story, people: &[usize], quote: &str) {
    for who in people {
        pair(story, agent(*who), AgentId::Robot, quote);
    }
}

fn pair(story: &mut Story, first: AgentId, then: AgentId, quote: &str) {
    let known = |(a, b, ..): &(AgentId, AgentId, bool, String)| [(first, then), (then, first)].contains(&(*a, *b));
    if !story.order.pairs.iter().any(known) {
        story.order.pairs.push((first, then, false, quote.to_owned()));
    }
}

/// An order that is stated exactly.
pub(crate) fn state(order: &mut Order, (first, then): (AgentId, AgentId), at_door: bool, quote: &str) {
    order.pairs.push((first, then, at_door, quote.to_owned()));
}

/// The human at this place of the cast, from 0.
pub(crate) fn agent(who: usize) -> AgentId {
    AgentId::Human(HumanId::new(u32::try_from(who + 1).unwrap_or(u32::MAX)))
}

/// Tells in the line of the later of two whom it comes after.
pub(crate) fn tell(kind: &FactKind, humans: &mut [ReadHuman]) {
    let FactKind::Before { first, then, .. } = kind else { return };
    let who = |agent: &AgentId| if *agent == AgentId::Robot { "the robot".to_owned() } else { agent.to_string() };
    let (told, words) = match (first, then) {
        (_, AgentId::Human(then)) => (then, format!("after {}", who(first))),
        (AgentId::Human(first), AgentId::Robot) => (first, "before the robot".to_owned()),
        (AgentId::Robot, AgentId::Robot) => return,
    };
    if let Some(human) = humans.iter_mut().find(|human| human.id == *told) {
        let joint = if human.summary.is_empty() { "" } else { ", " };
        human.summary.push_str(&format!("{joint}{words}"));
    }
}

/// The facts, with their words.
pub(crate) fn facts(story: &Story) -> impl Iterator<Item = (String, FactKind)> + '_ {
    let fact = |(first, then, at_door, quote): &(AgentId, AgentId, bool, String)| {
        (quote.clone(), FactKind::Before { first: *first, then: *then, at_door: *at_door })
    };
    story.order.pairs.iter().map(fact)
}
