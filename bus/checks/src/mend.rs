//! A proposal that passes, made from one that was refused: an example for whoever wrote it.
//!
//! ```text
//! refused ─► faults ─► codes ─► the mends of these codes ─► checked again ─► … until nothing hard is left, or none
//! ```
//!
//! Nothing takes it in place of an answer: it shows what the refused parts could look like. What the request means is its author's to say,
//! and a mend knows only what the checks know.

use socrates_model::fault::hard;
use socrates_model::request::MAX_HUMANS;
use socrates_model::rule::{RobotDo, RobotWhen};
use socrates_model::{
    Action, AgentId, Clause, ClauseRole, Fact, FactKind, FaultCode, Gesture, GroupProposal, HumanId, HumanProposal,
    Location, PlaceClass, Predicate, Proposal, Reading, Relation, RobotRule, Rule, Trigger,
};

use crate::lexicon::{humans_named, impossible};
use crate::people::{DISTANCE_M, SPEED_MPS, WAITS_S, others, rule_faults};
use crate::places::{classes_of, nodes_of};
use crate::proposal::{check_proposal, robot_says, script_line};
use crate::{limits, verify, wishes};

/// Rounds of checks and mends; each mend may bring what another one mends.
const ROUNDS: usize = 4;
/// Distance of two who meet, where nothing else is known, m.
const MEETS_M: f64 = 3.0;
/// Time after its reason within which a reaction is seen, s.
const REACTS_S: f64 = 3.0;
/// What a good robot does, where the answer says nothing of it.
const EXPECTED: &str = "The robot keeps its distance, and gives people room and time.";

/// What a mend may look at.
struct Given<'a> {
    reading: &'a Reading,
    location: &'a Location,
    task: &'a str,
}

type Mend = fn(&mut Proposal, &Given<'_>);

/// What makes right what a code names, in the order in which the parts depend on each other.
const MENDS: &[(FaultCode, Mend)] = &[
    // People who are missing come first: what is said of them stays.
    (FaultCode::PCount, counted),
    (FaultCode::PName, named),
    (FaultCode::PCap, able),
    (FaultCode::POther, untied),
    (FaultCode::PPlace, placed),
    (FaultCode::PRobot, robot),
    (FaultCode::PRough, wished),
    (FaultCode::PVerify, verified),
];

/// The proposal with what the checks refuse made right; none where the mends do not suffice. `task` is that of the request.
#[must_use]
pub fn passing_proposal(proposal: &Proposal, reading: &Reading, location: &Location, task: &str) -> Option<Proposal> {
    let given = Given { reading, location, task };
    let mut mended = proposal.clone();
    for _ in 0..ROUNDS {
        let faults = hard(&check_proposal(&mended, reading, location));
        if faults.is_empty() {
            return Some(mended);
        }
        for (_, mend) in MENDS.iter().filter(|(code, _)| faults.iter().any(|fault| fault.code == *code)) {
            mend(&mut mended, &given);
        }
    }
    hard(&check_proposal(&mended, reading, location)).is_empty().then_some(mended)
}

/// P-NAME: ids numbered through, groups and members of one mind, clauses about those who are there.
fn named(proposal: &mut Proposal, _given: &Given<'_>) {
    let wanted: Vec<HumanId> = (1..).take(proposal.humans.len()).map(HumanId::new).collect();
    for (human, id) in proposal.humans.iter_mut().zip(&wanted) {
        human.id = *id;
    }
    let mut groups: Vec<GroupProposal> = Vec::new();
    for mut group in std::mem::take(&mut proposal.groups) {
        let mut members: Vec<HumanId> = Vec::new();
        for member in group.members {
            let taken = groups.iter().any(|other| other.members.contains(&member));
            if wanted.contains(&member) && !members.contains(&member) && !taken {
                members.push(member);
            }
        }
        group.members = members;
        if group.members.len() > 1 && !groups.iter().any(|other| other.id == group.id) {
            groups.push(group);
        }
    }
    proposal.groups = groups;
    for human in &mut proposal.humans {
        human.group = proposal.groups.iter().find(|group| group.members.contains(&human.id)).map(|group| group.id);
    }
    proposal.expected_events.retain(|clause| clause.predicate.human().is_none_or(|id| wanted.contains(&id)));
}

/// P-COUNT: as many as were asked for, by a number or because something is asked of them, and the clause that says how many.
fn counted(proposal: &mut Proposal, given: &Given<'_>) {
    let facts = &given.reading.facts;
    let asked = facts.iter().find_map(|fact| if let FactKind::Humans(count) = fact.kind { Some(count) } else { None });
    let named = facts.iter().filter_map(verify::human_of).map(HumanId::number).max().unwrap_or(0);
    let listed = u32::try_from(proposal.humans.len()).unwrap_or(u32::MAX);
    let wanted = asked.unwrap_or_else(|| listed.max(named)).clamp(1, MAX_HUMANS);
    proposal.humans.truncate(usize::try_from(wanted).unwrap_or(usize::MAX));
    for number in listed.saturating_add(1)..=wanted {
        proposal.humans.push(somebody(HumanId::new(number)));
    }
    for clause in &mut proposal.expected_events {
        if let Predicate::Humans { count } = &mut clause.predicate {
            *count = wanted;
        }
    }
    self::named(proposal, given);
}

/// A human of whom nothing is known.
fn somebody(id: HumanId) -> HumanProposal {
    HumanProposal {
        id,
        role: "person".to_owned(),
        behavior: WALKS.to_owned(),
        relation: Relation::Frontal,
        side: None,
        facing: None,
        rules: Vec::new(),
        group: None,
        speed_mps: None,
        start: None,
        goal: None,
    }
}

/// What somebody without a rule does.
const WALKS: &str = "Walks along their path.";

/// What a human does, by its rules.
fn by_rules(human: &HumanProposal) -> String {
    if human.rules.is_empty() {
        return WALKS.to_owned();
    }
    human.rules.iter().map(Rule::phrase).collect::<Vec<_>>().join("; ")
}

/// P-CAP: words and numbers that can be simulated.
fn able(proposal: &mut Proposal, _given: &Given<'_>) {
    let whole = proposal.clone();
    for human in &mut proposal.humans {
        // The check itself says of each part, alone in a rule, whether it can be simulated.
        let takes = |part: Rule| {
            let when = if part.when.is_empty() { vec![Trigger::Always] } else { part.when };
            rule_faults(human.id, &Rule { when, ..part }, &whole).is_empty()
        };
        let can = |trigger: &Trigger| takes(Rule { when: vec![trigger.clone()], ..Rule::default() });
        let nearest = |triggers: &[Trigger]| -> Vec<Trigger> { triggers.iter().map(in_range).filter(can).collect() };
        for rule in &mut human.rules {
            (rule.when, rule.until) = (nearest(&rule.when), nearest(&rule.until));
            if rule.when.is_empty() {
                rule.when.push(Trigger::RobotNear(MEETS_M));
            }
            if !takes(Rule { act: rule.act.clone(), ..Rule::default() }) {
                rule.act = Action::LookAtRobot;
            }
            rule.to = rule.to.filter(|to| takes(Rule { to: Some(*to), ..Rule::default() }));
            if !takes(Rule { for_s: rule.for_s, ..Rule::default() }) {
                rule.for_s = Some(REACTS_S);
            }
        }
        Rule::take_turns(&mut human.rules);
        human.speed_mps = human.speed_mps.map(|speed| speed.clamp(SPEED_MPS.0, SPEED_MPS.1));
        if human.behavior.trim().is_empty() || !impossible(&human.behavior).is_empty() {
            human.behavior = by_rules(human);
        }
    }
}

/// The trigger with its number in the range that can be simulated.
fn in_range(trigger: &Trigger) -> Trigger {
    if let Trigger::AfterSecs(secs) = trigger {
        return Trigger::AfterSecs(secs.clamp(WAITS_S.0, WAITS_S.1));
    }
    if let Trigger::StoppedFor(secs) = trigger {
        return Trigger::StoppedFor(secs.clamp(WAITS_S.0, WAITS_S.1));
    }
    let distance = trigger.distance_m().map(|distance| distance.clamp(DISTANCE_M.0, DISTANCE_M.1));
    distance.map_or_else(|| trigger.clone(), |distance| trigger.clone().at_distance(distance))
}

/// P-OTHER: each speaks of themselves and the robot alone.
fn untied(proposal: &mut Proposal, _given: &Given<'_>) {
    let tied: Vec<HumanId> =
        proposal.humans.iter().filter(|human| !others(human, proposal).is_empty()).map(|human| human.id).collect();
    for human in proposal.humans.iter_mut().filter(|human| tied.contains(&human.id)) {
        human.behavior = by_rules(human);
        if humans_named(&human.behavior).iter().any(|number| HumanId::new(*number) != human.id) {
            human.behavior = WALKS.to_owned();
        }
    }
}

/// P-PLACE: classes and nodes that the map has.
fn placed(proposal: &mut Proposal, given: &Given<'_>) {
    let graph = &given.location.graph;
    let there = |class: PlaceClass| class == PlaceClass::Plain || !nodes_of(graph, class).is_empty();
    if !there(proposal.place) {
        proposal.place = classes_of(graph).first().copied().unwrap_or(PlaceClass::Plain);
    }
    for human in &mut proposal.humans {
        human.start = human.start.filter(|class| there(*class));
        human.goal = human.goal.filter(|class| there(*class));
    }
    proposal.robot.start = proposal.robot.start.filter(|class| there(*class));
    proposal.robot.goal = proposal.robot.goal.filter(|class| there(*class));
    for clause in &mut proposal.expected_events {
        if let Predicate::EncounterAt { place, nodes, .. } = &mut clause.predicate {
            nodes.retain(|node| graph.node(node).is_some());
            if !there(*place) {
                *place = proposal.place;
            }
        }
    }
    let spoken = crate::proposal::absent_in_prose(&proposal.description, graph);
    if !spoken.is_empty() {
        proposal.description =
            proposal.humans.iter().map(|human| human.behavior.as_str()).collect::<Vec<_>>().join(" ");
    }
}

/// P-ROBOT: its task, what is expected of it, a script that can be played, and every gesture that somebody waits for.
fn robot(proposal: &mut Proposal, given: &Given<'_>) {
    if proposal.robot.expected_behavior.trim().is_empty() {
        proposal.robot.expected_behavior = EXPECTED.to_owned();
    }
    if proposal.robot.task.trim().is_empty() {
        proposal.robot.task = given.task.to_owned();
    }
    let script: Vec<RobotRule> = proposal.robot.script.clone();
    proposal.robot.script = script.into_iter().filter(|line| script_line(line, proposal).is_empty()).collect();
    let mut wanted: Vec<(HumanId, Gesture)> = Vec::new();
    for human in &proposal.humans {
        for trigger in human.rules.iter().flat_map(|rule| &rule.when) {
            if let Trigger::RobotSays(gesture) = trigger {
                wanted.push((human.id, *gesture));
            }
        }
    }
    for (human, gesture) in wanted {
        if !robot_says(proposal).contains(&gesture) {
            let line = RobotRule { when: RobotWhen::AtEncounter(human), act: RobotDo::Say(gesture) };
            proposal.robot.script.push(line);
        }
    }
}

/// P-ROUGH: what the request states, word by word.
fn wished(proposal: &mut Proposal, given: &Given<'_>) {
    for fact in &given.reading.facts {
        if wishes::missing(fact, proposal).is_some() {
            wish(&fact.kind, proposal);
        }
    }
}

fn wish(kind: &FactKind, proposal: &mut Proposal) {
    let human_of = |proposal: &mut Proposal, id: HumanId, change: &dyn Fn(&mut HumanProposal)| {
        if let Some(human) = proposal.humans.iter_mut().find(|human| human.id == id) {
            change(human);
        }
    };
    match kind {
        FactKind::Group { group, members } => {
            proposal.groups.retain(|other| other.id != *group);
            for other in &mut proposal.groups {
                other.members.retain(|member| !members.contains(member));
            }
            let standing = members.iter().all(|id| proposal.human(*id).is_some_and(|human| human.relation.stands()));
            proposal.groups.insert(0, GroupProposal { id: *group, members: members.clone(), standing });
        }
        FactKind::Reacts { human, rule } => human_of(proposal, *human, &|human| human.rules.push(rule.clone())),
        FactKind::Relates { human, relation } => human_of(proposal, *human, &|human| human.relation = *relation),
        FactKind::Side { human, side } => human_of(proposal, *human, &|human| human.side = Some(*side)),
        FactKind::Facing { human, facing } => {
            human_of(proposal, *human, &|human| human.facing = Some(facing.clone()));
        }
        FactKind::Pace { human, mps } => human_of(proposal, *human, &|human| human.speed_mps = Some(*mps)),
        FactKind::Gestures { human, gesture } => sign(proposal, *human, *gesture, None),
        FactKind::GesturesTo { human, gesture, to } => sign(proposal, *human, *gesture, Some(*to)),
        FactKind::MeetsTimes { human, times, .. } => {
            let again = Predicate::MeetsAgain { human: *human, nth: *times, within_m: MEETS_M };
            add(proposal, again, "");
        }
        FactKind::Before { first, then, at_door } => {
            add(proposal, Predicate::Before { first: *first, then: *then, at_door: *at_door }, "");
        }
        FactKind::Place(class) => proposal.place = *class,
        FactKind::RobotSays(gesture) => {
            let when = proposal.humans.first().map_or(RobotWhen::Start, |human| RobotWhen::AtEncounter(human.id));
            proposal.robot.script.push(RobotRule { when, act: RobotDo::Say(*gesture) });
        }
        FactKind::RobotDoes(line) => proposal.robot.script.push(line.clone()),
        FactKind::RobotStart(class) => proposal.robot.start = Some(*class),
        FactKind::RobotGoal(class) => proposal.robot.goal = Some(*class),
        FactKind::Pattern(card) => proposal.pattern.clone_from(card),
        // A goal by name has a class only on the map; what was counted, and prose, is for others.
        FactKind::Goal { human, .. } => human_of(proposal, *human, &|human| human.goal = Some(PlaceClass::Plain)),
        FactKind::Humans(_) | FactKind::RobotTask(_) | FactKind::RobotAt { .. } | FactKind::Asked { .. } => {}
    }
}

/// A rule with a sign: added to the first rule that has none, else one of its own.
fn sign(proposal: &mut Proposal, id: HumanId, gesture: Gesture, to: Option<AgentId>) {
    let Some(human) = proposal.humans.iter_mut().find(|human| human.id == id) else { return };
    match human.rules.iter_mut().find(|rule| rule.gesture.is_none() || rule.gesture == Some(gesture)) {
        Some(rule) => {
            rule.gesture = Some(gesture);
            rule.to = to.or(rule.to);
        }
        None => {
            let rule = Rule { when: vec![Trigger::RobotNear(MEETS_M)], act: Action::LookAtRobot, ..Rule::default() };
            human.rules.push(Rule { gesture: Some(gesture), to, ..rule });
        }
    }
}

/// What shows that somebody is there, where nothing else is known of them: those beside the way are not met.
fn is_there(proposal: &Proposal, human: HumanId) -> Predicate {
    if proposal.human(human).is_some_and(|one| one.relation == Relation::Aside) {
        Predicate::StaysAside { human }
    } else {
        Predicate::Meets { human, within_m: MEETS_M }
    }
}

/// P-VERIFY: clauses that can be judged, one for each human, and one for each fact that has to be seen.
fn verified(proposal: &mut Proposal, given: &Given<'_>) {
    judgeable(proposal);
    let alone: Vec<HumanId> = verify::unseen(proposal).collect();
    for human in alone {
        let there = is_there(proposal, human);
        add(proposal, there, "");
    }
    for fact in &given.reading.facts {
        if !verify::is_unserved(fact, proposal) {
            continue;
        }
        match test_of(&fact.kind) {
            Some(predicate) => add(proposal, predicate, &fact.id),
            None => serve(proposal, fact),
        }
    }
}

/// Clauses with ids of their own, about what is there, with numbers that tell something.
fn judgeable(proposal: &mut Proposal) {
    let whole = proposal.clone();
    let mut seen: Vec<String> = Vec::new();
    proposal.expected_events.retain(|clause| {
        let grouped = |id| whole.groups.iter().any(|group| group.id == id);
        let listed = |id: &String| whole.expected_events.iter().any(|other| other.id == *id);
        let orders = !matches!(&clause.predicate, Predicate::Order { first, then } if !listed(first) || !listed(then));
        clause.predicate.group().is_none_or(grouped) && orders
    });
    let people = u32::try_from(whole.humans.len()).unwrap_or(u32::MAX);
    for clause in &mut proposal.expected_events {
        if seen.contains(&clause.id) {
            clause.id = free_id(&whole, seen.len());
        }
        seen.push(clause.id.clone());
        if clause.predicate.judges_robot() {
            clause.role = ClauseRole::Outcome;
        }
        if let Predicate::Flow { count, .. } | Predicate::Surrounds { count, .. } = &mut clause.predicate {
            *count = (*count).min(people);
        }
        if !limits::faults(&clause.predicate, &whole).is_empty() {
            clause.predicate = match clause.predicate.human() {
                Some(human) => is_there(&whole, human),
                None => Predicate::Humans { count: people },
            };
            clause.text.clear();
        }
    }
}

/// An id that no clause has.
fn free_id(proposal: &Proposal, from: usize) -> String {
    let taken = |id: &String| proposal.expected_events.iter().any(|clause| clause.id == *id);
    (from + 1..).map(|number| format!("c{number}")).find(|id| !taken(id)).unwrap_or_default()
}

/// What shows a fact, where its kind says so.
fn test_of(kind: &FactKind) -> Option<Predicate> {
    match kind {
        FactKind::Reacts { human, rule } => Some(Predicate::Reacts {
            human: *human,
            when: rule.when.clone(),
            act: rule.act.clone(),
            within_s: REACTS_S,
        }),
        FactKind::Gestures { human, gesture } => {
            Some(Predicate::Gestures { agent: (*human).into(), gesture: *gesture })
        }
        FactKind::MeetsTimes { human, times, .. } if *times > 1 => {
            Some(Predicate::MeetsAgain { human: *human, nth: *times, within_m: MEETS_M })
        }
        FactKind::Side { human, side } => Some(Predicate::OnSide { human: *human, side: *side }),
        FactKind::Facing { human, facing } => Some(Predicate::Faces { human: *human, facing: facing.clone() }),
        FactKind::Before { first, then, at_door } => {
            Some(Predicate::Before { first: *first, then: *then, at_door: *at_door })
        }
        FactKind::GesturesTo { human, gesture, to } => {
            Some(Predicate::GesturesTo { human: *human, gesture: *gesture, to: *to })
        }
        FactKind::RobotSays(gesture) => Some(Predicate::Gestures { agent: AgentId::Robot, gesture: *gesture }),
        FactKind::Place(place) => Some(Predicate::EncounterAt { place: *place, nodes: Vec::new() }),
        FactKind::RobotDoes(rule) => Some(Predicate::RobotStep { rule: rule.clone(), within_s: REACTS_S }),
        // Served by a clause that is there, or by a meeting.
        FactKind::Humans(_)
        | FactKind::Group { .. }
        | FactKind::Relates { .. }
        | FactKind::Pace { .. }
        | FactKind::Goal { .. }
        | FactKind::MeetsTimes { .. }
        | FactKind::RobotTask(_)
        | FactKind::RobotStart(_)
        | FactKind::RobotGoal(_)
        | FactKind::RobotAt { .. }
        | FactKind::Pattern(_)
        | FactKind::Asked { .. } => None,
    }
}

/// Names a fact as the source of a clause that speaks of whoever does it, or adds a meeting.
fn serve(proposal: &mut Proposal, fact: &Fact) {
    let owner = verify::human_of(fact);
    let whole = proposal.clone();
    let fits = |clause: &&mut Clause| {
        clause.must
            && clause.role == ClauseRole::Setup
            && clause.source.is_empty()
            && owner.is_none_or(|human| verify::speaks_of(clause, human, &whole))
    };
    match proposal.expected_events.iter_mut().find(fits) {
        Some(clause) => clause.source.clone_from(&fact.id),
        None => {
            let human = owner.or_else(|| whole.humans.first().map(|human| human.id));
            if let Some(human) = human {
                add(proposal, is_there(&whole, human), &fact.id);
            }
        }
    }
}

/// Adds a clause of the setup.
fn add(proposal: &mut Proposal, predicate: Predicate, source: &str) {
    let id = free_id(proposal, proposal.expected_events.len());
    proposal.expected_events.push(Clause {
        id,
        text: String::new(),
        role: ClauseRole::Setup,
        must: true,
        source: source.to_owned(),
        predicate,
    });
}
