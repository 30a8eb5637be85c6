//! The clauses of a proposal: every human and every fact gets one that must hold.

use socrates_model::reading::ReadHuman;
use socrates_model::{
    Action, AgentId, Clause, ClauseRole, Fact, FactKind, Gesture, HumanId, HumanProposal, Location, NodeId, PlaceClass,
    Predicate, Proposal, Reading, Relation, Rule, Trigger, ordinal,
};

use socrates_prompts::Question;

use crate::card::Card;
use crate::form;
use crate::noticing;
use crate::place;
use crate::prose::done;
use crate::spot;
use crate::story::Extra;

/// A robot that does its part has met somebody once they were this near, m: the usual distance of passing in a corridor.
const MEETS_M: f64 = 2.5;
/// Somebody has met the robot again once they were this near, m.
const AGAIN_M: f64 = 3.0;
/// People at a blind corner see each other from no farther, m.
const CORNER_M: f64 = 7.5;
/// Largest difference of arrival where ways cross and no card says, s.
const GAP_S: f64 = 4.0;

/// Followers of the robot within the usual distance, and how much farther behind it each one more is, m.
const FEW_FOLLOW: usize = 3;
const QUEUE_M: f64 = 0.5;

/// What the pattern has to do with a proposal.
pub(crate) struct Part<'a> {
    pub(crate) card: Option<&'a Card>,
    /// Whether the people are the card's own: then all of its clauses count as it says, else none decides.
    pub(crate) by_card: bool,
    pub(crate) read: &'a [ReadHuman],
}

#[derive(Default)]
struct List(Vec<Clause>);

impl List {
    fn add(&mut self, role: ClauseRole, must: bool, source: &str, text: String, predicate: Predicate) {
        let same = |other: &Clause| {
            std::mem::discriminant(&other.predicate) == std::mem::discriminant(&predicate)
                && other.predicate.human() == predicate.human()
                && (predicate.human().is_some()
                    && !matches!(
                        predicate,
                        Predicate::Gestures { .. }
                            | Predicate::GesturesTo { .. }
                            | Predicate::Reacts { .. }
                            | Predicate::Step { .. }
                            | Predicate::GoesTo { .. }
                            | Predicate::ChangesPace { .. }
                    )
                    || other.predicate == predicate)
        };
        if let Some(known) = self.0.iter_mut().find(|other| other.role == role && same(other)) {
            if known.source.is_empty() || known.source == source {
                known.must |= must;
                if known.source.is_empty() {
                    source.clone_into(&mut known.source);
                }
                return;
            }
            // Two facts about the same thing each need a clause of their own.
            if source.is_empty() {
                known.must |= must;
                return;
            }
        }
        if role == ClauseRole::Outcome
            && self.0.iter().any(|other| {
                other.role == role && std::mem::discriminant(&other.predicate) == std::mem::discriminant(&predicate)
            })
        {
            return;
        }
        let id = format!("c{}", self.0.len() + 1);
        self.0.push(Clause { id, text, role, must, source: source.to_owned(), predicate });
    }

    fn setup(&mut self, must: bool, source: &str, text: impl Into<String>, predicate: Predicate) {
        self.add(ClauseRole::Setup, must, source, text.into(), predicate);
    }
}

/// Every clause of the proposal.
pub(crate) fn events(proposal: &Proposal, question: &Question, part: &Part<'_>, extras: &[Extra]) -> Vec<Clause> {
    let (request, reading, location) = (&question.request, &question.reading, &question.location);
    let mut list = List::default();
    let count = u32::try_from(proposal.humans.len()).unwrap_or(u32::MAX);
    let source = |wanted: fn(&FactKind) -> bool| {
        reading.facts.iter().find(|fact| wanted(&fact.kind)).map_or("", |fact| fact.id.as_str())
    };
    list.setup(true, source(|kind| matches!(kind, FactKind::Humans(_))), headcount(count), Predicate::Humans { count });
    list.setup(true, "", "everybody moves like people do", Predicate::Plausible);
    for fact in &reading.facts {
        let at = |class: PlaceClass| match form::met_at(request, location, class) {
            Some(stated) => spot::counted(location, stated, class, &proposal.humans),
            None => spot::nodes(location, &fact.quote, class, &proposal.humans),
        };
        of_fact(&mut list, fact, proposal, extras, &at);
    }
    let line = part.card.is_some_and(|card| card.roles.iter().any(|role| role.line));
    for group in proposal.groups.iter().filter(|_| !line) {
        of_group(&mut list, "", group.id, proposal);
    }
    let gap_s = part.card.map_or(GAP_S, |card| card.gap_s);
    for human in &proposal.humans {
        for rule in &human.rules {
            of_rule(&mut list, "", human, rule, false);
        }
        of_relation(&mut list, "", human, proposal, gap_s);
    }
    let said = |clause: &Clause| matches!(clause.predicate, Predicate::EncounterAt { place, human: None, .. } if place == proposal.place);
    if place::has(location, proposal.place) && !list.0.iter().any(said) {
        let text = format!("it happens at {}", place::an(proposal.place));
        list.setup(false, "", text, Predicate::EncounterAt { place: proposal.place, nodes: Vec::new(), human: None });
    }
    of_card(&mut list, part, proposal, location);
    one_behind_the_other(&mut list.0);
    list.add(ClauseRole::Outcome, true, "", "the robot gets to its goal".to_owned(), Predicate::RobotArrives);
    list.add(
        ClauseRole::Outcome,
        true,
        "",
        "the robot keeps 0.3 m from everybody".to_owned(),
        Predicate::RobotKeeps { min_m: 0.3 },
    );
    list.0
}

/// The clauses of one human, as a proposal would have them that was written so.
pub(crate) fn of_human(human: &HumanProposal, proposal: &Proposal, reading: &Reading) -> Vec<Clause> {
    let mut list = List::default();
    let own = |fact: &&Fact| {
        if let FactKind::Reacts { human: who, .. }
        | FactKind::Gestures { human: who, .. }
        | FactKind::GesturesTo { human: who, .. }
        | FactKind::MeetsTimes { human: who, .. }
        | FactKind::Side { human: who, .. }
        | FactKind::Facing { human: who, .. }
        | FactKind::Pace { human: who, .. }
        | FactKind::Goal { human: who, .. }
        | FactKind::MeetsAt { human: who, .. }
        | FactKind::Relates { human: who, .. } = &fact.kind
        {
            *who == human.id
        } else {
            false
        }
    };
    for fact in reading.facts.iter().filter(own) {
        of_fact(&mut list, fact, proposal, &[], &|_| Vec::new());
    }
    for rule in &human.rules {
        of_rule(&mut list, "", human, rule, false);
    }
    let gap_s = crate::card::card(&proposal.pattern).map_or(GAP_S, |card| card.gap_s);
    of_relation(&mut list, "", human, proposal, gap_s);
    list.0
}

/// How many humans there are, as a clause says it.
pub(crate) fn headcount(count: u32) -> String {
    if count == 1 {
        "one human is there all the time".to_owned()
    } else {
        format!("{count} humans are there all the time")
    }
}

fn of_fact(
    list: &mut List,
    fact: &Fact,
    proposal: &Proposal,
    extras: &[Extra],
    at: &dyn Fn(PlaceClass) -> Vec<NodeId>,
) {
    match &fact.kind {
        FactKind::Group { group, .. } => of_group(list, &fact.id, *group, proposal),
        FactKind::Reacts { human, rule } => {
            let Some(who) = proposal.human(*human) else { return };
            // Where the distance was open the proposal says it.
            let same = || who.rules.iter().position(|own| noticing::is_same(own, rule));
            let index = who.rules.iter().position(|own| own == rule).or_else(same);
            let rule = index.and_then(|at| who.rules.get(at)).unwrap_or(rule);
            let extra = usize::try_from(human.number()).ok().and_then(|n| extras.get(n.checked_sub(1)?));
            let stated = index.zip(extra).and_then(|(i, extra)| extra.stated.get(i)).copied().unwrap_or(false);
            of_rule(list, &fact.id, who, rule, stated);
        }
        FactKind::Relates { human, relation } => {
            let who = proposal.human(*human);
            if *relation == Relation::Crossing && who.is_some_and(|who| who.relation == Relation::Leaving) {
                let text = format!("{human} crosses the robot's way");
                list.setup(true, &fact.id, text, Predicate::Crosses { human: *human, gap_s: GAP_S });
            } else if let Some(who) = who {
                of_relation(list, &fact.id, who, proposal, GAP_S);
            }
        }
        FactKind::MeetsTimes { human, times, place } => {
            let text = format!("{human} meets the robot for the {} time", ordinal(*times));
            list.setup(true, &fact.id, text, Predicate::MeetsAgain { human: *human, nth: *times, within_m: AGAIN_M });
            if let Some(class) = place {
                let text = format!("they meet at {}", place::an(*class));
                let at = Predicate::EncounterAt { place: *class, nodes: Vec::new(), human: None };
                list.setup(true, &fact.id, text, at);
            }
        }
        FactKind::Gestures { human, gesture } => {
            let to = proposal.human(*human).and_then(|who| {
                let mut made = who.rules.iter().filter(|rule| rule.gesture == Some(*gesture));
                made.clone().all(|rule| rule.to.is_some()).then(|| made.next().and_then(|rule| rule.to)).flatten()
            });
            match to {
                Some(to) => says_to(list, &fact.id, *human, (*gesture, to)),
                None => says(list, &fact.id, (*human).into(), *gesture),
            }
        }
        FactKind::GesturesTo { human, gesture, to } => says_to(list, &fact.id, *human, (*gesture, *to)),
        FactKind::RobotSays(gesture) => says(list, &fact.id, AgentId::Robot, *gesture),
        FactKind::Place(class) => {
            let text = format!("it happens at {}", place::an(*class));
            let nodes = at(*class);
            list.setup(true, &fact.id, text, Predicate::EncounterAt { place: *class, nodes, human: None });
        }
        FactKind::Before { first, then, at_door } => {
            let place = if *at_door { "through the door" } else { "there" };
            let text = format!("{first} is {place} before {then}");
            list.setup(true, &fact.id, text, Predicate::Before { first: *first, then: *then, at_door: *at_door });
        }
        FactKind::Side { human, side } => {
            let text = format!("{human} is on the {} of the robot's way", side.name());
            list.setup(true, &fact.id, text, Predicate::OnSide { human: *human, side: *side });
        }
        FactKind::Facing { human, facing } => {
            let text = format!("{human} faces {} before they react", facing.phrase());
            list.setup(true, &fact.id, text, Predicate::Faces { human: *human, facing: facing.clone() });
        }
        FactKind::RobotAt { part, name, nodes } => {
            let text = format!("the robot's way {} {name}", part.does());
            list.setup(true, &fact.id, text, Predicate::RobotWay { part: *part, nodes: nodes.clone() });
        }
        FactKind::Pace { human, mps } => {
            let text = format!("{human} walks at {mps} m/s");
            list.setup(true, &fact.id, text, Predicate::Walks { human: *human, mps: *mps });
        }
        FactKind::Goal { human, name, nodes } => {
            let text = format!("{human} goes to {name}");
            list.setup(true, &fact.id, text, Predicate::GetsTo { human: *human, nodes: nodes.clone() });
        }
        FactKind::MeetsAt { human, name, class, nodes } => {
            let text = format!("{human} meets the robot at {name}");
            let at = Predicate::EncounterAt { place: *class, nodes: nodes.clone(), human: Some(*human) };
            list.setup(true, &fact.id, text, at);
        }
        FactKind::RobotDoes(line) => {
            let text = format!("robot: {}", line.phrase());
            list.setup(true, &fact.id, text, Predicate::RobotStep { rule: line.clone(), within_s: STEP_S });
        }
        FactKind::Humans(_)
        | FactKind::RobotTask(_)
        | FactKind::RobotStart(_)
        | FactKind::RobotGoal(_)
        | FactKind::Asked { .. }
        | FactKind::Pattern(_) => {}
    }
}

fn says(list: &mut List, source: &str, agent: AgentId, gesture: Gesture) {
    list.setup(true, source, format!("{agent} gestures {gesture}"), Predicate::Gestures { agent, gesture });
}

fn says_to(list: &mut List, source: &str, human: HumanId, (gesture, to): (Gesture, AgentId)) {
    let text = format!("{human} gestures {gesture} to {to}");
    list.setup(true, source, text, Predicate::GesturesTo { human, gesture, to });
}

fn of_group(list: &mut List, source: &str, group: socrates_model::GroupId, proposal: &Proposal) {
    let Some(found) = proposal.groups.iter().find(|other| other.id == group) else { return };
    let line = crate::card::card(&proposal.pattern).is_some_and(|card| card.roles.iter().any(|role| role.line));
    if found.standing && line {
        list.setup(true, source, format!("{group} stands in line"), Predicate::Queues { group, gap_m: [0.5, 1.6] });
    } else if found.standing {
        list.setup(true, source, format!("{group} stands in a circle"), Predicate::Formation { group, spread_m: 1.8 });
    } else {
        list.setup(true, source, format!("{group} walks together"), Predicate::WalksTogether { group, spread_m: 2.5 });
    }
}

/// Largest difference of arrival where the robot waits for whoever crosses, s.
const THROUGH_GAP_S: f64 = 40.0;
/// Somebody comes to a stand and turns in so much time, s.
const TURNS_S: f64 = 0.5;
/// A step begins so long after its reason at most, s.
const STEP_S: f64 = 3.0;

/// What must be seen of a step of a sequence: its own beginning and end, and what it does.
fn of_step(list: &mut List, source: &str, human: &HumanProposal, (rule, number): (&Rule, u32)) {
    let id = human.id;
    // Somebody who walks on goes their way, as everybody does.
    if rule.act == Action::Navigate
        && rule.gesture.is_none()
        && rule.when.iter().all(|when| matches!(when, Trigger::Always | Trigger::Did(..)))
    {
        return;
    }
    let text = format!("{id}, step {number}: {}", rule.phrase());
    list.setup(true, source, text, Predicate::Step { human: id, rule: rule.clone(), within_s: STEP_S });
}

/// What must be seen where a rule has played its part.
fn of_rule(list: &mut List, source: &str, human: &HumanProposal, rule: &Rule, stated: bool) {
    let id = human.id;
    if let Some(number) = rule.step {
        of_step(list, source, human, (rule, number));
    }
    let text = format!("{id} {}", done(&rule.act));
    // To stop and turn for a step takes a part of its time.
    let takes_s = if rule.step.is_some() { TURNS_S } else { 0.0 };
    let lasts = |most: f64| rule.for_s.map_or(most, |secs| ((secs - takes_s).max(0.2) * 0.6).min(most));
    let seen = match &rule.act {
        Action::FollowRobot => Some(follows(id, AgentId::Robot)),
        Action::FollowHuman(leader) => Some(follows(id, (*leader).into())),
        Action::RunAway => Some(Predicate::RunsAway { human: id, by_m: 1.0 }),
        Action::GiveWay => Some(Predicate::GivesWay { human: id }),
        Action::MakeRoom => Some(Predicate::MakesRoom { human: id }),
        Action::ApproachTo(near_m) => Some(Predicate::Meets { human: id, within_m: near_m + Action::CLOSE_M }),
        Action::Block => Some(Predicate::Blocks { human: id, for_s: lasts(2.5) }),
        Action::LookAtRobot => Some(Predicate::Looks { human: id, for_s: lasts(2.0) }),
        Action::Approach => Some(Predicate::Meets { human: id, within_m: 2.0 }),
        Action::StandStill => Some(Predicate::StandsStill { human: id, for_s: lasts(2.0) }),
        Action::TurnBack => Some(Predicate::TurnsBack { human: id }),
        Action::ComeBack => Some(Predicate::ComesBack { human: id }),
        Action::GoTo(target) => Some(Predicate::GoesTo { human: id, nodes: target.nodes.clone() }),
        Action::ChangePace(mps) => Some(Predicate::ChangesPace { human: id, mps: *mps }),
        // That they look at somebody or turn away, the clause of the step says.
        Action::Navigate | Action::LookAt(_) | Action::TurnAway => None,
    };
    match (rule.gesture, rule.to) {
        (Some(gesture), Some(to)) => says_to(list, "", id, (gesture, to)),
        (Some(gesture), None) => says(list, "", id.into(), gesture),
        (None, _) => {}
    }
    // A human who walks on after what they did does what everybody does: nothing more is to be seen.
    let before = human.rules.iter().position(|own| own == rule).and_then(|at| at.checked_sub(1));
    let last = before.and_then(|at| human.rules.get(at)).filter(|last| last.when == rule.when);
    let walks = |rule: &Rule| rule.act == Action::Navigate && rule.gesture.is_none();
    if walks(rule) && (last.is_some() || rule.for_s.is_some()) {
        // Asked for in words of its own, it is seen in what comes before it.
        if let Some(last) = last.filter(|_| stated) {
            of_rule(list, source, human, last, stated);
        }
        return;
    }
    // What it does only a while after what it waits for: whatever it does before that for the same reason.
    let upto = human.rules.iter().position(|own| own == rule).unwrap_or(0);
    let before = human.rules.iter().take(upto).rev().take_while(|own| own.when == rule.when);
    let late_s = before.filter_map(|own| own.for_s).sum::<f64>();
    // What is done again comes when all before it is over.
    let earlier = human.rules.iter().take_while(|own| *own != rule);
    let again = earlier.clone().any(|own| own.act == rule.act);
    let late_s = if again { earlier.filter_map(|own| own.for_s).sum::<f64>() } else { late_s };
    let plain = seen.is_none();
    if let Some(predicate) = seen {
        list.setup(true, source, text, predicate);
    }
    if stated || plain && rule.gesture.is_none() {
        let predicate =
            Predicate::Reacts { human: id, when: rule.when.clone(), act: rule.act.clone(), within_s: 3.0 + late_s };
        // Asked for with its reason, it is a must with its reason: the deed alone may come of itself.
        list.setup(true, source, format!("{} {id} {}", Trigger::phrases(&rule.when), done(&rule.act)), predicate);
    }
}

/// Many who follow the robot do so one behind the other: the last of them is farther behind it.
fn one_behind_the_other(clauses: &mut [Clause]) {
    let robots = |clause: &Clause| matches!(clause.predicate, Predicate::Follows { leader: AgentId::Robot, .. });
    let more = clauses.iter().filter(|clause| robots(clause)).count().saturating_sub(FEW_FOLLOW);
    for clause in clauses.iter_mut().filter(|clause| robots(clause)) {
        if let Predicate::Follows { gap_m: [_, most], .. } = &mut clause.predicate {
            *most += QUEUE_M * more as f64;
        }
    }
}

fn follows(follower: HumanId, leader: AgentId) -> Predicate {
    Predicate::Follows { follower: follower.into(), leader, gap_m: [0.5, 3.5], for_s: 5.0 }
}

/// What must be seen of how a human stands to the robot's way.
fn of_relation(list: &mut List, source: &str, human: &HumanProposal, proposal: &Proposal, usual_gap_s: f64) {
    let (id, place) = (human.id, proposal.place);
    let said = !source.is_empty();
    let does = |act: &Action| human.rules.iter().any(|rule| rule.act == *act);
    let stands = does(&Action::StandStill) || does(&Action::LookAtRobot) || does(&Action::Block);
    // A human who is told to wait leaves a long gap, but whoever tells it and walks on crosses all the same.
    let halts = stands || human.rules.iter().any(|rule| rule.gesture == Some(Gesture::Wait));
    // Somebody else has the robot wait until they are through, or they go elsewhere before it comes.
    let through = proposal.is_let_through(id);
    let elsewhere = through || proposal.is_leaving_path(id);
    let meets = |list: &mut List, must: bool, within_m: f64| {
        let must = must && !elsewhere;
        // A person who reacts at a distance need not come nearer than that.
        let early = human
            .rules
            .iter()
            .filter(|rule| !matches!(rule.act, Action::FollowRobot | Action::Approach | Action::ApproachTo(_)))
            .flat_map(|rule| &rule.when);
        // Where only one gets through, making room is going back.
        let back = place == PlaceClass::NarrowPassage && does(&Action::GiveWay);
        let apart = halts || back || does(&Action::RunAway);
        let reach = early.filter_map(Trigger::distance_m).filter(|_| apart).fold(within_m, |most, m| most.max(m + 0.5));
        list.setup(
            must,
            "",
            format!("{id} and the robot come within {reach} m of each other"),
            Predicate::Meets { human: id, within_m: reach },
        );
    };
    match human.relation {
        // Two ways meet at a corner at a right angle: who stops on seeing the robot never comes straight towards it.
        Relation::Frontal if place == PlaceClass::BlindCorner && halts => {
            meets(list, true, MEETS_M);
            let text = format!("{id} comes round the corner, unseen until then");
            list.setup(said, source, text, Predicate::HiddenUntil { human: id, within_m: CORNER_M });
        }
        Relation::Frontal => {
            // Of a group abreast, the outermost keeps a little more distance.
            meets(list, true, if human.group.is_some() { 3.0 } else { MEETS_M });
            list.setup(said, source, format!("{id} comes towards the robot"), Predicate::HeadOn { human: id });
        }
        Relation::Crossing => {
            meets(list, true, 3.0);
            let gap_s = if through {
                THROUGH_GAP_S
            } else if halts {
                10.0
            } else {
                usual_gap_s
            };
            list.setup(
                said && !stands,
                source,
                format!("{id} crosses the robot's way"),
                Predicate::Crosses { human: id, gap_s },
            );
        }
        Relation::Behind => {
            let follows = does(&Action::FollowRobot);
            meets(list, !follows, 3.5);
            // A person who stops meanwhile, or flees, comes up from behind, no more.
            let stops = |rule: &Rule| rule.act == Action::RunAway || rule.step.is_some() && rule.act.stands();
            if !follows && !human.rules.iter().any(stops) {
                list.setup(said, source, format!("{id} overtakes the robot"), Predicate::Overtakes { human: id });
            }
        }
        Relation::Ahead => list.setup(
            true,
            source,
            format!("{id} walks ahead of the robot"),
            Predicate::Ahead { human: id, within_m: 6.0, for_s: 2.0 },
        ),
        Relation::Static => {
            list.setup(true, source, format!("{id} stands"), Predicate::StandsStill { human: id, for_s: 3.0 });
            meets(list, human.group.is_none(), 3.5);
            if human.goal.is_some() {
                list.setup(true, "", format!("{id} goes in"), Predicate::Enters { human: id, door: String::new() });
            }
        }
        Relation::Leaving => {
            list.setup(true, source, format!("{id} comes out"), Predicate::Leaves { human: id, door: String::new() });
            meets(list, false, 3.5);
        }
        Relation::Staying => list.setup(
            true,
            source,
            format!("{id} stays inside"),
            Predicate::StaysInside { human: id, door: String::new() },
        ),
        Relation::Aside => {
            list.setup(true, source, format!("{id} stands beside the robot's way"), Predicate::StaysAside { human: id })
        }
        Relation::Abreast => list.setup(
            true,
            source,
            format!("{id} walks beside the robot"),
            Predicate::Abreast { human: id, for_s: 3.0 },
        ),
    }
}

fn of_card(list: &mut List, part: &Part<'_>, proposal: &Proposal, location: &Location) {
    let Some(card) = part.card else { return };
    let group = proposal.groups.first().map(|group| group.id);
    for clause in &card.clauses {
        let role = clause.each.as_ref().and_then(|name| card.roles.iter().find(|role| role.name == *name));
        let plays = |human: &HumanProposal| match role {
            None => false,
            Some(role) if part.by_card => part.read.iter().any(|read| read.id == human.id && read.summary == role.name),
            Some(role) => human.relation == role.relation,
        };
        let who: Vec<Option<HumanId>> = if role.is_some() {
            proposal.humans.iter().filter(|human| plays(human)).map(|human| Some(human.id)).collect()
        } else {
            vec![None]
        };
        for human in who {
            let Some((text, predicate)) = clause.filled(human, group) else { continue };
            // Without doors in the map nothing opens.
            if matches!(predicate, Predicate::DoorOpens { .. }) && location.doors.is_empty() {
                continue;
            }
            let must = clause.must && (part.by_card || clause.role == ClauseRole::Outcome);
            list.add(clause.role, must, "", text, predicate);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{map, proposed, request};

    #[test]
    fn many_followers_are_a_longer_queue() {
        let gap = |rough: &str| {
            let events = proposed(&request("Guide the visitors", Some(rough)), &map("office")).expected_events;
            events.iter().find_map(|clause| {
                if let Predicate::Follows { gap_m, .. } = clause.predicate { Some(gap_m[1]) } else { None }
            })
        };
        assert_eq!(gap("Two visitors follow the robot."), Some(3.5));
        assert_eq!(gap("Six visitors follow the robot."), Some(5.0));
    }

    #[test]
    fn a_reaction_asked_for_with_its_reason_is_a_must_with_its_reason() {
        let rough = "A picker stands in the narrow aisle. When the robot asks to pass, the picker steps aside.";
        let proposal = proposed(&request("Bring an empty tote to the packing area", Some(rough)), &map("warehouse"));
        let reacts: Vec<&Clause> = proposal
            .expected_events
            .iter()
            .filter(|clause| matches!(clause.predicate, Predicate::Reacts { act: Action::GiveWay, .. }))
            .collect();
        assert!(!reacts.is_empty() && reacts.iter().all(|clause| clause.must), "{:#?}", proposal.expected_events);
    }
}
