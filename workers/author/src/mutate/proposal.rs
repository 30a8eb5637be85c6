//! Wrong proposals.

use serde_json::{Value, json};
use socrates_model::{
    Action, Clause, ClauseRole, FactKind, HumanId, PlaceClass, Predicate, Proposal, Relation, Trigger,
};
use socrates_prompts::Question;

use super::{list, pick, rename};
use crate::fault_model::FaultKind;

#[expect(clippy::wildcard_enum_match_arm, reason = "a kind of another stage has no place in this answer")]
pub(super) fn put(kind: FaultKind, answer: &mut Value, question: &Question, draw: u64) -> Option<()> {
    match kind {
        FaultKind::Pcount => {
            list(answer, "humans")?.pop()?;
        }
        FaultKind::Pname => *list(answer, "humans")?.last_mut()?.get_mut("id")? = json!("human_99"),
        FaultKind::Pverify => unverified(answer, question, draw)?,
        FaultKind::Pcap => say(answer, draw, "Then it picks up a box.")?,
        FaultKind::Pother => {
            let proposal: Proposal = serde_json::from_value(answer.clone()).ok()?;
            let strangers = strangers(&proposal);
            let (human, other) = strangers.get(pick(draw, strangers.len())?)?;
            let behavior = list(answer, "humans")?.get_mut(*human)?.get_mut("behavior")?;
            *behavior = json!(format!("{} It copies what {other} does.", behavior.as_str().unwrap_or_default()));
        }
        FaultKind::Pplace => {
            let graph = &question.location.graph;
            let absent: Vec<PlaceClass> = PlaceClass::ALL
                .into_iter()
                .filter(|class| *class != PlaceClass::Plain)
                .filter(|class| !graph.nodes().iter().any(|node| graph.node_is(&node.id, *class)))
                .collect();
            *answer.get_mut("place")? = json!(absent.get(pick(draw, absent.len())?)?);
        }
        FaultKind::Prough => dropped(answer, question, draw)?,
        FaultKind::Probot => *answer.get_mut("robot")?.get_mut("expected_behavior")? = json!(""),
        FaultKind::Schema => rename(answer, "place", "location")?,
        _ => return None,
    }
    Some(())
}

/// Adds a sentence to the behavior of a drawn human.
fn say(answer: &mut Value, draw: u64, sentence: &str) -> Option<()> {
    let humans = list(answer, "humans")?;
    let index = pick(draw, humans.len())?;
    let behavior = humans.get_mut(index)?.get_mut("behavior")?;
    *behavior = json!(format!("{} {sentence}", behavior.as_str().unwrap_or_default()));
    Some(())
}

/// Takes away every clause that carries a wish which needs one; where there is no such wish, every clause of a human.
fn unverified(answer: &mut Value, question: &Question, draw: u64) -> Option<()> {
    let mut proposal: Proposal = serde_json::from_value(answer.clone()).ok()?;
    let wishes: Vec<&str> = question
        .reading
        .facts
        .iter()
        .filter(|fact| {
            // A number of people is counted and a task is read; the others have to be seen in the run.
            matches!(
                fact.kind,
                FactKind::Group { .. }
                    | FactKind::Reacts { .. }
                    | FactKind::Gestures { .. }
                    | FactKind::GesturesTo { .. }
                    | FactKind::Place(_)
                    | FactKind::RobotSays(_)
            )
        })
        .map(|fact| fact.id.as_str())
        .filter(|id| proposal.expected_events.iter().any(|clause| clause.source == *id))
        .collect();
    match pick(draw, wishes.len()).and_then(|place| wishes.get(place)) {
        Some(wish) => proposal.expected_events.retain(|clause| clause.source != *wish),
        None => {
            let human = proposal.humans.get(pick(draw, proposal.humans.len())?)?.id;
            let all = u32::try_from(proposal.humans.len()).ok()?;
            let groups = proposal.groups.clone();
            let of_human = |clause: &Clause| {
                let predicate = &clause.predicate;
                let led = matches!(predicate, Predicate::Follows { leader, .. } if *leader == human.into());
                let of_group = |id| groups.iter().any(|group| group.id == id && group.members.contains(&human));
                let speaks = led
                    || predicate.human() == Some(human)
                    || predicate.group().is_some_and(of_group)
                    || predicate.takes_in_all(all);
                clause.must && clause.role == ClauseRole::Setup && speaks
            };
            proposal.expected_events.retain(|clause| !of_human(clause));
        }
    }
    *answer = serde_json::to_value(proposal).ok()?;
    Some(())
}

/// Humans (by place) with another one whom nothing ties to them.
fn strangers(proposal: &Proposal) -> Vec<(usize, HumanId)> {
    let mut found = Vec::new();
    for (place, human) in proposal.humans.iter().enumerate().filter(|(_, human)| human.relation != Relation::Staying) {
        for other in proposal.humans.iter().filter(|other| other.id != human.id) {
            let grouped = human.group.is_some() && human.group == other.group;
            let heard = |trigger: &Trigger| matches!(trigger, Trigger::HumanSays(id, _) if *id == other.id);
            let tied =
                human.rules.iter().any(|rule| rule.act == Action::FollowHuman(other.id) || rule.when.iter().any(heard));
            if !grouped && !tied {
                found.push((place, other.id));
            }
        }
    }
    found
}

/// Forgets a wish: the rules of a human who was to react or to gesture, the relation or the pattern that was asked for.
fn dropped(answer: &mut Value, question: &Question, draw: u64) -> Option<()> {
    let mut proposal: Proposal = serde_json::from_value(answer.clone()).ok()?;
    let wishes: Vec<&FactKind> = question
        .reading
        .facts
        .iter()
        .map(|fact| &fact.kind)
        .filter(|kind| {
            matches!(
                kind,
                FactKind::Reacts { .. }
                    | FactKind::Gestures { .. }
                    | FactKind::GesturesTo { .. }
                    | FactKind::Relates { .. }
                    | FactKind::Group { .. }
            )
        })
        .collect();
    let of = |proposal: &Proposal, id: HumanId| proposal.humans.iter().position(|human| human.id == id);
    #[expect(clippy::wildcard_enum_match_arm, reason = "only these were chosen above")]
    match wishes.get(pick(draw, wishes.len())?)? {
        FactKind::Reacts { human, .. } | FactKind::Gestures { human, .. } | FactKind::GesturesTo { human, .. } => {
            let place = of(&proposal, *human)?;
            proposal.humans.get_mut(place)?.rules.clear();
        }
        FactKind::Relates { human, relation } => {
            let place = of(&proposal, *human)?;
            let other = if *relation == Relation::Frontal { Relation::Crossing } else { Relation::Frontal };
            proposal.humans.get_mut(place)?.relation = other;
        }
        FactKind::Group { .. } => {
            proposal.groups.clear();
            proposal.humans.iter_mut().for_each(|human| human.group = None);
        }
        _ => return None,
    }
    *answer = serde_json::to_value(proposal).ok()?;
    Some(())
}
