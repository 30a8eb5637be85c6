//! The proposal: the reading, or a card, in detail.

use socrates_model::job::Stage;
use socrates_model::reading::ReadHuman;
use socrates_model::request::RobotGesture;
use socrates_model::rule::{RobotDo, RobotRule, RobotWhen};
use socrates_model::{
    Action, AgentId, Breadth, FORMAT, FactKind, Gesture, GroupId, GroupProposal, HumanId, HumanProposal, Location,
    PlaceClass, Predicate, Proposal, Reading, Relation, Request, RobotProposal, Rule, Trigger,
};
use socrates_prompts::Question;
use socrates_reader::Reader;

use crate::card::{Card, card};
use crate::draw::Draw;
use crate::manner::{AHEAD_MPS, OVERTAKES_MPS, overtakes};
use crate::name::NAME;
use crate::settle::CIRCLE_M;
use crate::story::Extra;
use crate::summary::unread;
use crate::understand::understand;
use crate::{chance, default_cast, events, facing, named_way, noticing, place, prose, sides, solve};

/// The pattern of a story that fits no card.
const FREE: &str = "free";
/// What a story is about that no card tells.
const ABOUT: &str = "People and the robot meet.";

/// Answers a proposal question.
#[must_use]
pub fn propose(question: &Question) -> Proposal {
    let (request, reading, location) = (&question.request, &question.reading, &question.location);
    let mut draw =
        Draw::new(question.seed.wrapping_add(u64::try_from(question.feedback.len()).unwrap_or(0)), "proposal");
    let mut found = reading.pattern.as_deref().and_then(card);
    let (read, extras, by_card) = if reading.humans.is_empty() {
        found = found
            .filter(|card| card.fits(location))
            .or_else(|| default_cast::unguided(&request.task, location, &mut draw));
        let (people, extras) = found.map(|card| default_cast::people(card, &mut draw, request)).unwrap_or_default();
        (people, extras, true)
    } else {
        let understood = understand(request, location);
        let extras = understood.extras;
        let extras =
            if extras.len() == reading.humans.len() { extras } else { vec![Extra::default(); reading.humans.len()] };
        (reading.humans.clone(), extras, understood.by_card)
    };
    let place = where_at(reading, found, &read, location, &mut draw);
    let humans: Vec<HumanProposal> = read
        .iter()
        .zip(&extras)
        .map(|(human, extra)| proposed(human, extra, place, request, location, &mut draw))
        .map(|mut human| {
            chance::until_then(&mut human);
            human
        })
        .collect();
    let humans = facing::stated(sides::stated(humans, reading), reading);
    let groups = groups(&humans);
    let part = events::Part { card: found, by_card, read: &read };
    let robot = robot(reading, request, found, &humans, location);
    let (title, about, id) = found.map_or_else(
        || ("A free scenario".to_owned(), ABOUT.to_owned(), FREE.to_owned()),
        |card| (card.title.clone(), about(card, by_card, &humans), card.id.clone()),
    );
    let mut humans = humans;
    for fact in &reading.facts {
        if let FactKind::MeetsTimes { human, .. } = fact.kind
            && let Some(human) = humans.iter_mut().find(|other| other.id == human)
        {
            human.behavior.push_str(" Later on they meet the robot a second time.");
        }
    }
    let description = prose::description(&about, &location.name, place, &humans);
    let mut notes = reading.notes.clone();
    notes.extend(reading.problems.iter().map(|fault| format!("{}: {}", fault.code, fault.message)));
    let mut proposal = Proposal {
        format: FORMAT,
        title,
        description,
        pattern: id,
        place,
        humans,
        groups,
        robot,
        expected_events: Vec::new(),
        not_understood: unread(reading).into_iter().map(str::to_owned).collect(),
        notes,
        author: NAME.into(),
    };
    proposal.expected_events = events::events(&proposal, question, &part, &extras);
    named_way::playable(&mut proposal, question);
    reachable(&mut proposal, question);
    proposal
}

/// A place by name where nobody can be met on the way of the robot is given up, and said so: any of its class will do then.
fn reachable(proposal: &mut Proposal, question: &Question) {
    let meant = socrates_solver::of_proposal(proposal);
    if meant.is_empty() {
        return;
    }
    let ask = Question { stage: Stage::Paths, feedback: Vec::new(), refused: None, ..question.clone() };
    if solve::solve(&ask, proposal).is_ok_and(|paths| socrates_solver::met_at(&meant, &paths, proposal)) {
        return;
    }
    for clause in &mut proposal.expected_events {
        if let Predicate::EncounterAt { place, nodes, human: None } = &mut clause.predicate
            && *place == proposal.place
        {
            nodes.clear();
        }
    }
    let names: Vec<String> = meant.iter().map(|node| format!("`{node}`")).collect();
    proposal.notes.push(format!(
        "nobody can be met at {} on a way that does all the rest; another {} was taken",
        names.join(", "),
        place::words(proposal.place)
    ));
}

fn where_at(
    reading: &Reading,
    found: Option<&Card>,
    humans: &[ReadHuman],
    location: &Location,
    draw: &mut Draw,
) -> PlaceClass {
    let there = |class: &PlaceClass| *class != PlaceClass::Plain && place::has(location, *class);
    if let Some(class) = reading.place.filter(there) {
        return class;
    }
    let crossing = humans.iter().any(|human| human.relation == Some(Relation::Crossing));
    if crossing && there(&PlaceClass::Intersection) {
        return PlaceClass::Intersection;
    }
    let fits = |card: &Card, class: &PlaceClass| there(class) && card.is_at(location, *class);
    let wanted: Vec<PlaceClass> =
        found.map(|card| card.places.iter().copied().filter(|class| fits(card, class)).collect()).unwrap_or_default();
    // Mostly the place where the card is at home, now and then another that the card allows.
    let other = if reading.humans.is_empty() && draw.below(3) == 0 { draw.pick(&wanted).copied() } else { None };
    let usual = [PlaceClass::Corridor, PlaceClass::Intersection, PlaceClass::OpenArea];
    // Where no place of the card's is as wide as it tells, anywhere that is.
    let anywhere = found.is_some_and(|card| card.width_m.is_some() && card.places.contains(&PlaceClass::Plain));
    let plain = Some(PlaceClass::Plain).filter(|_| anywhere);
    other
        .or_else(|| wanted.first().copied())
        .or(plain)
        .or_else(|| usual.into_iter().find(there))
        .unwrap_or(PlaceClass::Plain)
}

fn proposed(
    human: &ReadHuman,
    extra: &Extra,
    place: PlaceClass,
    request: &Request,
    location: &Location,
    draw: &mut Draw,
) -> HumanProposal {
    let relation = human.relation.unwrap_or(if place == PlaceClass::Intersection {
        Relation::Crossing
    } else {
        Relation::Frontal
    });
    let start = extra.start.filter(|class| place::has(location, *class));
    let start = match relation {
        Relation::Leaving | Relation::Staying => {
            let usual = if place == PlaceClass::Elevator { PlaceClass::Elevator } else { PlaceClass::Room };
            start.or_else(|| Some(usual).filter(|class| place::has(location, *class)))
        }
        Relation::Frontal
        | Relation::Behind
        | Relation::Ahead
        | Relation::Crossing
        | Relation::Static
        | Relation::Abreast
        | Relation::Aside => None,
    };
    let moves = !relation.stands();
    let usual = match relation {
        Relation::Ahead => Some(extra.speed_mps.map_or(0.5, |speed| speed.min(AHEAD_MPS))),
        Relation::Behind if overtakes(relation, &human.rules) => {
            Some(extra.speed_mps.map_or(1.5, |speed| speed.max(OVERTAKES_MPS)))
        }
        Relation::Frontal
        | Relation::Behind
        | Relation::Crossing
        | Relation::Static
        | Relation::Leaving
        | Relation::Staying
        | Relation::Abreast
        | Relation::Aside => extra.speed_mps.or_else(|| {
            Reader::shipped()
                .scene(&request.social_context)
                .pace_mps
                .map(|pace| if pace > 1.0 { draw.tenths([1.3, 1.5]) } else { draw.tenths([0.7, 0.9]) })
        }),
    };
    let mut rules = match request.run.breadth {
        Breadth::Usual => human.rules.clone(),
        Breadth::Wide => noticing::rules(&human.rules, &extra.open, relation, (place, human.group.is_some(), draw)),
    };
    Rule::take_turns(&mut rules);
    let mut behavior = prose::behavior(&human.role, relation, place, start, &rules, human.group.is_some());
    let goal = extra.goal.filter(|class| place::has(location, *class));
    if relation == Relation::Static && goal.is_some() {
        behavior.push_str(" Once the door is open and everybody is out they go in.");
    }
    HumanProposal {
        id: human.id,
        role: human.role.clone(),
        behavior,
        relation,
        side: None,
        facing: None,
        rules,
        group: human.group,
        speed_mps: usual.filter(|_| moves),
        start,
        goal,
    }
}

fn groups(humans: &[HumanProposal]) -> Vec<GroupProposal> {
    let mut ids: Vec<GroupId> = humans.iter().filter_map(|human| human.group).collect();
    ids.sort_unstable();
    ids.dedup();
    ids.into_iter()
        .map(|id| {
            let members: Vec<&HumanProposal> = humans.iter().filter(|human| human.group == Some(id)).collect();
            let standing = members.iter().all(|human| human.relation == Relation::Static);
            GroupProposal { id, members: members.iter().map(|human| human.id).collect(), standing }
        })
        .collect()
}

fn robot(
    reading: &Reading,
    request: &Request,
    found: Option<&Card>,
    humans: &[HumanProposal],
    location: &Location,
) -> RobotProposal {
    let class = |wanted: fn(&FactKind) -> Option<PlaceClass>| reading.facts.iter().find_map(|fact| wanted(&fact.kind));
    let start = class(|kind| if let FactKind::RobotStart(class) = kind { Some(*class) } else { None });
    let goal = class(|kind| if let FactKind::RobotGoal(class) = kind { Some(*class) } else { None });
    let start = start.or_else(|| found.and_then(|card| card.start)).filter(|class| place::has(location, *class));
    let goal = goal.or_else(|| found.and_then(|card| card.goal)).filter(|class| place::has(location, *class));
    // The robot's part of a form is what the form states.
    let of_card = found.filter(|_| request.form.is_empty());
    let mut script: Vec<RobotRule> = of_card.map(|card| card.script.clone()).unwrap_or_default();
    let lead = humans.iter().find(|human| human.relation == Relation::Ahead).map(|human| human.id);
    for line in &mut script {
        if let (RobotDo::Follow(who) | RobotDo::Overtake(who), Some(id)) = (&mut line.act, lead) {
            *who = id;
        }
    }
    // A line of the form names whom it means.
    let stated = request.form.script(&request.robot.does);
    let is_stated = |gesture| stated.iter().any(|line| line.act == RobotDo::Say(gesture));
    script.extend(stated.iter().cloned());
    let beside: Vec<HumanId> =
        humans.iter().filter(|human| human.relation == Relation::Abreast).map(|human| human.id).collect();
    script.extend(beside.first().map(|id| RobotRule { when: RobotWhen::Start, act: RobotDo::Abreast(*id) }));
    for fact in &reading.facts {
        if let FactKind::RobotSays(gesture) = fact.kind
            && !is_stated(gesture)
        {
            // It asks whoever stands in its way once it cannot go on; a card may have it ask already.
            let answers = |human: &HumanProposal| {
                let said = Trigger::RobotSays(gesture);
                let hears = human.rules.iter().any(|rule| rule.when.contains(&said));
                hears && human.rules.iter().any(|rule| rule.act == Action::Block && !rule.when.contains(&said))
            };
            let quoted = fact.quote.contains("block") || fact.quote.contains("obstruct");
            let blocked = quoted || humans.iter().any(answers);
            let when = if blocked { RobotWhen::Blocked(2.0) } else { heard_at(gesture, humans) };
            let asks =
                |line: &RobotRule| line.act == RobotDo::Say(gesture) && matches!(line.when, RobotWhen::Blocked(_));
            if !(blocked && script.iter().any(asks)) {
                script.push(RobotRule { when, act: RobotDo::Say(gesture) });
            }
        }
    }
    script.extend(request.robot.gestures.iter().map(RobotGesture::line));
    // A sign to somebody else is none for the robot.
    let told = |rule: &&Rule| !matches!(rule.to, Some(AgentId::Human(_)));
    let signs = || humans.iter().flat_map(|human| &human.rules).filter(told);
    let stops = signs().any(|rule| rule.gesture == Some(Gesture::Wait));
    if stops && !script.iter().any(|line| line.when == RobotWhen::HumanSays(Gesture::Wait)) {
        // Somebody who tells it to wait, and by a later step to go on, has it wait until then.
        let goes = signs().any(|rule| rule.gesture == Some(Gesture::Proceed) && rule.step.is_some_and(|step| step > 1));
        let until = RobotDo::HoldUntil(RobotWhen::HumanSays(Gesture::Proceed));
        let act = if goes { until } else { RobotDo::Hold(4.0) };
        script.push(RobotRule { when: RobotWhen::HumanSays(Gesture::Wait), act });
    }
    let leaves = humans.iter().any(|human| human.relation == Relation::Leaving)
        && goal.is_some_and(|class| matches!(class, PlaceClass::Elevator | PlaceClass::Room));
    if leaves && !script.iter().any(|line| line.act == RobotDo::WaitForLeavers) {
        script.push(RobotRule { when: RobotWhen::Start, act: RobotDo::WaitForLeavers });
    }
    hear(&mut script, humans);
    chance::stops(&mut script, humans);
    // The numbers of a form's lines keep them apart.
    let mut seen: Vec<RobotRule> = Vec::new();
    script.retain(|line| {
        if seen.len() >= stated.len() && seen.contains(line) {
            false
        } else {
            seen.push(line.clone());
            true
        }
    });
    let task = if reading.task.is_empty() { request.task.clone() } else { reading.task.clone() };
    let expected = found.map_or_else(
        || "The robot keeps its distance, yields where people are in its way, and reaches its goal.".to_owned(),
        |card| card.expected.clone(),
    );
    RobotProposal { task, start, goal, script, expected_behavior: expected }
}

/// What a card says it is about, where its parts are played: people who overtake do not come towards the robot.
fn about(card: &Card, by_card: bool, humans: &[HumanProposal]) -> String {
    let played = card.roles.iter().filter(|role| role.count[0] > 0).all(|role| {
        humans.iter().any(|human| human.relation == role.relation && (!role.group || human.group.is_some()))
    });
    if by_card || played { card.about.clone() } else { ABOUT.to_owned() }
}

/// Somebody who waits for a word of the robot must hear it.
pub(crate) fn hear(script: &mut Vec<RobotRule>, humans: &[HumanProposal]) {
    for heard in humans.iter().flat_map(|human| &human.rules).flat_map(|rule| &rule.when) {
        if let Trigger::RobotSays(gesture) = heard
            && !script.iter().any(|line| line.act == RobotDo::Say(*gesture))
        {
            script.push(RobotRule { when: heard_at(*gesture, humans), act: RobotDo::Say(*gesture) });
        }
    }
}

/// When the robot says something to people near it; to a standing group only once it is there, which stands as one until then.
fn heard_at(gesture: Gesture, humans: &[HumanProposal]) -> RobotWhen {
    let circled = humans.iter().any(|human| {
        human.group.is_some()
            && human.relation == Relation::Static
            && human.rules.iter().any(|rule| rule.when.contains(&Trigger::RobotSays(gesture)))
    });
    RobotWhen::HumanNear(if circled { CIRCLE_M } else { 4.0 })
}

#[cfg(test)]
mod tests {
    use crate::tests::{map, proposed, request};

    #[test]
    fn the_story_tells_of_a_card_only_what_the_people_do() {
        let about = |rough: &str| proposed(&request("Bring a blood sample", Some(rough)), &map("hospital")).description;
        let over = about("Two paramedics walking together overtake the robot while a patient comes the other way.");
        assert!(!over.contains("towards the robot. It happens"), "{over}");
        let towards = about("Three nurses walk together towards the robot in the corridor.");
        assert!(towards.starts_with("People walk together towards the robot."), "{towards}");
    }
}
