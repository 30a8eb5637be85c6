//! Every clause to its monitor, the proposal's own and those that paths and people demand anyway.

use std::collections::BTreeMap;
use std::convert::identity;

use socrates_model::report::Standing;
use socrates_model::{
    Action, AgentId, Clause, ClauseResult, ClauseRole, FactKind, HumanId, Paths, Predicate, Proposal, Relation, Rule,
    Trigger, ordinal, rule::RobotDo,
};

use crate::evidence::Evidence;
use crate::fidelity::finding::Finding;
use crate::fidelity::meeting::MEET_NODE_M;
use crate::fidelity::plausible::{Flaw, flaws, plausible};
use crate::fidelity::signals::Signals;
use crate::fidelity::{
    acts, addressed, aside, company, coverage, crowd, doorway, faces, going, groups, meeting, named_way, reactions,
    ring, robot, robot_steps, setting, sides, steps, turns,
};
use crate::temporal::{Signal, Within};
use crate::tracks::{TrackFault, Tracks};

/// Somebody starts at the first node of its path when this near to it, m: what a free place beside it may take.
const START_M: f64 = 3.0;
/// Largest difference of arrival times at an encounter where no clause says another, s: people who come from a room
/// and the robot count as having met at a junction when all arrive within this.
const GAP_SECS: f64 = 4.0;
/// Largest distance from the middle of a group that stands and of one that walks, m, where no clause says another.
const STAND_M: f64 = 1.8;
const WALK_M: f64 = 3.0;

/// Clauses with what was found of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// Clause and finding, setup first.
    pub clauses: Vec<(Clause, Finding)>,
    /// What is not plausible.
    pub flaws: Vec<Flaw>,
    /// Humans and facts without a clause that decides anything.
    pub uncovered: Vec<String>,
}

impl Judged {
    /// The clauses that decide the verdict: setup, must, and judged at all.
    pub fn deciding(&self) -> impl Iterator<Item = &(Clause, Finding)> {
        self.clauses.iter().filter(|(clause, finding)| {
            clause.role == ClauseRole::Setup && clause.must && finding.standing != Standing::NotApplicable
        })
    }

    /// Clauses that should decide and could not be judged.
    pub fn unjudged(&self) -> impl Iterator<Item = &(Clause, Finding)> {
        self.clauses.iter().filter(|(clause, finding)| {
            clause.role == ClauseRole::Setup && clause.must && finding.standing == Standing::NotApplicable
        })
    }

    /// The clauses as the report has them.
    #[must_use]
    pub fn results(&self) -> Vec<ClauseResult> {
        self.clauses.iter().map(|(clause, finding)| result(clause, finding)).collect()
    }
}

/// Judges every clause.
#[must_use]
pub fn judge(signals: &Signals<'_>) -> Judged {
    let mut clauses: Vec<Clause> =
        signals.evidence.proposal.map_or_else(Vec::new, |proposal| proposal.expected_events.clone());
    for clause in &mut clauses {
        clause.must |= asked(signals, clause);
    }
    clauses.extend(demanded(signals, &clauses));
    clauses.sort_by_key(|clause| clause.role == ClauseRole::Outcome);
    let flaws = flaws(signals);
    let mut found: BTreeMap<String, Finding> = BTreeMap::new();
    for clause in clauses.iter().filter(|clause| !matches!(clause.predicate, Predicate::Order { .. })) {
        found.insert(clause.id.clone(), monitor(signals, &clause.predicate, &flaws, &found));
    }
    for clause in clauses.iter().filter(|clause| matches!(clause.predicate, Predicate::Order { .. })) {
        found.insert(clause.id.clone(), monitor(signals, &clause.predicate, &flaws, &found));
    }
    let clauses: Vec<(Clause, Finding)> = clauses
        .into_iter()
        .map(|clause| {
            let finding = found.get(&clause.id).cloned();
            (clause, finding.unwrap_or_else(|| Finding::not_applicable("the clause was not judged")))
        })
        .collect();
    let uncovered = coverage::uncovered(signals.evidence, &clauses);
    Judged { clauses, flaws, uncovered }
}

/// What is found of one clause alone; of an order, with the two that it puts in order.
///
/// # Errors
/// What makes the recording unreadable.
pub fn standing_of(evidence: &Evidence<'_>, clause: &Clause) -> Result<ClauseResult, TrackFault> {
    let tracks = Tracks::read(evidence.recording)?;
    let signals = Signals::new(evidence, &tracks);
    let flaws = if clause.predicate == Predicate::Plausible { flaws(&signals) } else { Vec::new() };
    let mut found = BTreeMap::new();
    if let Predicate::Order { first, then } = &clause.predicate {
        let all = evidence.proposal.map_or(&[][..], |proposal| &proposal.expected_events);
        for other in all.iter().filter(|other| [first, then].contains(&&other.id)) {
            found.insert(other.id.clone(), monitor(&signals, &other.predicate, &flaws, &found));
        }
    }
    let finding = monitor(&signals, &clause.predicate, &flaws, &found);
    Ok(result(clause, &finding))
}

/// Every clause of a run with what is found of it, those besides the proposal's own too.
///
/// # Errors
/// What makes the recording unreadable.
pub fn clauses_of(evidence: &Evidence<'_>) -> Result<Vec<(Clause, ClauseResult)>, TrackFault> {
    let tracks = Tracks::read(evidence.recording)?;
    let judged = judge(&Signals::new(evidence, &tracks));
    Ok(judged.clauses.into_iter().map(|(clause, finding)| (clause.clone(), result(&clause, &finding))).collect())
}

/// A clause as the report has it.
fn result(clause: &Clause, finding: &Finding) -> ClauseResult {
    let short = |value: f64| (value * 1e4).round() / 1e4;
    ClauseResult {
        id: clause.id.clone(),
        text: clause.text.clone(),
        role: clause.role,
        must: clause.must,
        source: clause.source.clone(),
        standing: finding.standing,
        margin: short(finding.margin),
        times_s: finding.times_s.iter().copied().map(short).collect(),
        evidence: finding.evidence.clone(),
        shift_s: finding.shift_s.map(short),
    }
}

/// Whether the request asks for the very reaction of a clause: then it decides, whatever the proposal says of it. A run
/// in which its reason came and it did not is never realised.
fn asked(signals: &Signals<'_>, clause: &Clause) -> bool {
    let Predicate::Reacts { human, act, .. } = &clause.predicate else { return false };
    let facts = signals.evidence.reading.map_or(&[][..], |reading| &reading.facts);
    clause.role == ClauseRole::Setup
        && facts.iter().any(|fact| {
            fact.id == clause.source
                && matches!(&fact.kind, FactKind::Reacts { human: who, rule } if who == human && rule.act == *act)
        })
}

/// Whether the robot has to meet this human: of people who have to queue it meets the one whom it comes nearest, as the
/// others may stand farther down the line than anybody is met.
fn stands_for_queue(signals: &Signals<'_>, given: &[Clause], human: HumanId) -> bool {
    let humans = signals.evidence.proposal.map_or(&[][..], |proposal| &proposal.humans);
    let group = humans.iter().find(|one| one.id == human).and_then(|one| one.group);
    let queues = |clause: &Clause| {
        let of = if let Predicate::Queues { group, .. } = clause.predicate { Some(group) } else { None };
        clause.role == ClauseRole::Setup && clause.must && of.is_some() && of == group
    };
    if !given.iter().any(queues) {
        return true;
    }
    let members = humans.iter().filter(|one| one.group == group).map(|one| one.id);
    members.min_by(|a, b| signals.nearest_m(*a).total_cmp(&signals.nearest_m(*b))).is_none_or(|first| first == human)
}

/// Whether a human who follows somebody has to meet the robot by itself as well. A human who follows another comes as
/// near to the robot as that one, and who follows the robot has met it wherever it comes near. Somebody has to be met
/// in every scenario: where nobody else is, these are.
fn only_follows(signals: &Signals<'_>, given: &[Clause], human: HumanId) -> bool {
    let led = |one: HumanId, leader: &dyn Fn(AgentId) -> bool| {
        given.iter().any(|clause| {
            clause.role == ClauseRole::Setup
                && clause.must
                && matches!(clause.predicate, Predicate::Follows { follower, leader: who, .. } if follower == one.into() && leader(who))
        })
    };
    let by_rule = |one: HumanId| {
        let rules =
            signals.evidence.proposal.and_then(|proposal| proposal.human(one)).map_or(&[][..], |one| &one.rules);
        !rules.is_empty() && rules.iter().all(|rule| matches!(rule.act, Action::FollowHuman(_)))
    };
    let after_human = |one: HumanId| by_rule(one) || led(one, &|who| matches!(who, AgentId::Human(_)));
    if led(human, &|who| who == AgentId::Robot) {
        return signals.of(human).iter().any(|moment| moment.distance_m <= MEET_NODE_M);
    }
    let others = signals.evidence.paths.map_or(&[][..], |paths| &paths.encounters);
    after_human(human) && others.iter().any(|other| other.human != human && !after_human(other.human))
}

/// Whether a human whose place was at its encounter has gone from there to let the robot through, and met it all the same.
fn made_way(signals: &Signals<'_>, human: HumanId) -> bool {
    let Some(person) = signals.evidence.proposal.and_then(|proposal| proposal.human(human)) else { return false };
    let Some((_, node)) = signals.encounter(human) else { return false };
    let moments = signals.of(human);
    person.relation == Relation::Static
        && person.rules.iter().any(|rule| rule.act == Action::GiveWay)
        && moments.first().is_some_and(|moment| (moment.human.at - node).norm() <= MEET_NODE_M)
        && moments.iter().any(|moment| (moment.robot.at - node).norm() <= MEET_NODE_M)
        && moments.iter().any(|moment| moment.distance_m <= MEET_NODE_M)
}

/// Room between where somebody is to stop and where they have stopped, m.
const STOPS_M: f64 = 0.5;

/// How near somebody and the robot have to come at least, m: whoever is to stand as soon as the robot is at some distance cannot be
/// asked to come nearer than that.
fn nearest_asked_m(plan: &Proposal, human: HumanId) -> f64 {
    let rules = plan.human(human).map_or(&[][..], |one| &one.rules);
    let stands = rules.iter().filter(|rule| matches!(rule.act, Action::StandStill | Action::LookAtRobot));
    let blocks = |when: &&Trigger| matches!(when, Trigger::RobotBlocking(_));
    let reach_m = stands.flat_map(|rule| &rule.when).filter(|when| !blocks(when)).filter_map(Trigger::distance_m);
    let at_m = reach_m.map(|reach_m| reach_m + STOPS_M);
    at_m.fold(MEET_NODE_M, f64::max)
}

/// A clause that decides and that no proposal lists.
const fn setup(id: String, text: String, predicate: Predicate) -> Clause {
    Clause { id, text, role: ClauseRole::Setup, must: true, source: String::new(), predicate }
}

/// Whether a clause that decides is given already.
fn has(given: &[Clause], test: &dyn Fn(&Predicate) -> bool) -> bool {
    given.iter().any(|clause| clause.role == ClauseRole::Setup && clause.must && test(&clause.predicate))
}

/// Every encounter of the paths that no given clause tells of.
fn meetings(signals: &Signals<'_>, given: &[Clause], paths: &Paths) -> Vec<Clause> {
    let mut more = Vec::new();
    let mut met: BTreeMap<HumanId, u32> = BTreeMap::new();
    for encounter in &paths.encounters {
        let human = encounter.human;
        let shown = only_follows(signals, given, human) || made_way(signals, human);
        let aside = |plan: &Proposal| plan.human(human).is_some_and(|one| one.relation == Relation::Aside);
        let apart = |plan: &Proposal| plan.is_let_through(human) || plan.is_leaving_path(human) || aside(plan);
        if shown || signals.evidence.proposal.is_some_and(apart) || !stands_for_queue(signals, given, human) {
            continue;
        }
        let nth = met.entry(human).and_modify(|nth| *nth += 1).or_insert(1);
        if *nth > 1 {
            let nth = *nth;
            let again = |predicate: &Predicate| matches!(predicate, Predicate::MeetsAgain { human: who, nth: which, within_m } if *who == human && *which == nth && *within_m <= MEET_NODE_M);
            if !has(given, &again) {
                let text = format!("{human} meets the robot for the {} time near {}", ordinal(nth), encounter.node);
                let predicate = Predicate::MeetsAgain { human, nth, within_m: MEET_NODE_M };
                more.push(setup(format!("auto-meet-{human}-{nth}"), text, predicate));
            }
            continue;
        }
        let within_m = signals.evidence.proposal.map_or(MEET_NODE_M, |plan| nearest_asked_m(plan, human));
        let meets = |predicate: &Predicate| matches!(predicate, Predicate::Meets { human: who, within_m: asked } if *who == human && *asked <= within_m);
        if !has(given, &meets) {
            let text = format!("{human} meets the robot near {}", encounter.node);
            more.push(setup(format!("auto-meet-{human}"), text, Predicate::Meets { human, within_m }));
        }
    }
    more
}

/// What must be seen whatever the proposal lists: everybody is there, nobody breaks physics, and
/// every encounter of the paths happens. A scenario cannot be realised by promising nothing.
fn demanded(signals: &Signals<'_>, given: &[Clause]) -> Vec<Clause> {
    let has = |test: &dyn Fn(&Predicate) -> bool| has(given, test);
    let mut more = Vec::new();
    if let Some(proposal) = signals.evidence.proposal {
        let count = u32::try_from(proposal.humans.len()).unwrap_or(u32::MAX);
        if !has(&|predicate| *predicate == Predicate::Humans { count }) {
            more.push(setup("auto-humans".into(), format!("there are {count} humans"), Predicate::Humans { count }));
        }
    }
    more.extend(signals.evidence.paths.into_iter().flat_map(|paths| meetings(signals, given, paths)));
    if let (Some(proposal), Some(paths)) = (signals.evidence.proposal, signals.evidence.paths) {
        let crowd = has(&|predicate| {
            matches!(predicate, Predicate::Flow { .. } | Predicate::Density { .. } | Predicate::Converges { .. })
        });
        // A robot that stands by its script comes later than those who walk; the clause of the line tells of it.
        let stands = proposal.robot_stands();
        let waits = proposal.robot.script.iter().any(|rule| rule.act == RobotDo::WaitForLeavers);
        for human in &proposal.humans {
            let id = human.id;
            let Some(node) = paths.humans.get(&id).and_then(|way| way.first()) else { continue };
            // A human who walks with the robot, or in a group, starts where that puts it.
            let own = !matches!(human.relation, Relation::Behind | Relation::Ahead | Relation::Abreast);
            if own && human.group.is_none() && signals.node(node).is_some() {
                let starts = Predicate::StartsAt { agent: id.into(), node: node.clone(), within_m: START_M };
                more.push(setup(format!("auto-start-{id}"), format!("{id} starts at {node}"), starts));
            }
            let timed = match human.relation {
                Relation::Frontal | Relation::Crossing => true,
                // Where the robot waits for those who leave, they need not hurry.
                Relation::Leaving => !waits,
                Relation::Behind
                | Relation::Ahead
                | Relation::Static
                | Relation::Staying
                | Relation::Abreast
                | Relation::Aside => false,
            };
            // A crowd is timed by the clause that tells of it; a reaction may keep somebody from the node: then its own clauses tell.
            if timed && !crowd && !stands && human.rules.iter().all(keeps_walk) && signals.encounter(id).is_some() {
                let given = has(
                    &|predicate| matches!(predicate, Predicate::OnTime { human: who, .. } | Predicate::Crosses { human: who, .. } if *who == id),
                );
                if !given {
                    let text = format!("{id} and the robot get to their encounter together");
                    let predicate = Predicate::OnTime { human: id, gap_s: GAP_SECS };
                    more.push(setup(format!("auto-time-{id}"), text, predicate));
                }
            }
        }
        for group in &proposal.groups {
            if has(&|predicate| predicate.group() == Some(group.id)) {
                continue;
            }
            let (text, predicate) = if group.standing {
                (format!("{} stands together", group.id), Predicate::Formation { group: group.id, spread_m: STAND_M })
            } else {
                (format!("{} walks together", group.id), Predicate::WalksTogether { group: group.id, spread_m: WALK_M })
            };
            more.push(setup(format!("auto-{}", group.id), text, predicate));
        }
    }
    let judged = signals.evidence.proposal.is_some() || signals.evidence.paths.is_some();
    if judged && !has(&|predicate| *predicate == Predicate::Plausible) {
        let text = "nobody overlaps or is faster than 2 m/s".to_owned();
        more.push(setup("auto-plausible".into(), text, Predicate::Plausible));
    }
    more
}

/// Nearer than this to the robot somebody is at its encounter, where the time of arrival has been taken, m.
const THERE_M: f64 = 1.5;

/// Whether a rule leaves the way to the first encounter as it is: its human walks on all the while, or it is done only once the
/// two have met.
fn keeps_walk(rule: &Rule) -> bool {
    let met = |trigger: &Trigger| {
        matches!(trigger, Trigger::RobotPassed | Trigger::GoalReached | Trigger::AtEncounter)
            || trigger.distance_m().is_some_and(|m| m <= THERE_M)
    };
    rule.act == Action::Navigate || rule.when.iter().any(met)
}

/// The monitor of a predicate.
fn monitor(signals: &Signals<'_>, predicate: &Predicate, flaws: &[Flaw], found: &BTreeMap<String, Finding>) -> Finding {
    let either = |result: Result<Finding, Finding>| result.unwrap_or_else(identity);
    match predicate {
        Predicate::Humans { count } => setting::humans(signals, *count),
        Predicate::Meets { human, within_m } => meeting::meets(signals, *human, 1, *within_m),
        Predicate::MeetsAgain { human, nth, within_m } => meeting::meets(signals, *human, *nth, *within_m),
        Predicate::HeadOn { human } => meeting::head_on(signals, *human),
        Predicate::Crosses { human, gap_s } => meeting::crosses(signals, *human, *gap_s),
        Predicate::OnSide { human, side } => sides::on_side(signals, *human, *side),
        Predicate::Faces { human, facing } => faces::faces(signals, *human, facing),
        Predicate::RobotWay { part, nodes } => named_way::robot_way(signals, *part, nodes),
        Predicate::Ahead { human, within_m, for_s } => meeting::ahead(signals, *human, *within_m, *for_s),
        Predicate::Overtakes { human } => meeting::passes(signals, *human, true),
        Predicate::RobotPasses { human } => meeting::passes(signals, *human, false),
        Predicate::Follows { follower, leader, gap_m, for_s } => {
            company::follows(signals, *follower, *leader, *gap_m, *for_s)
        }
        Predicate::Abreast { human, for_s } => company::abreast(signals, *human, *for_s),
        Predicate::Parallel { human, for_s } => company::parallel(signals, *human, *for_s),
        Predicate::Flow { count, within_m, angle_deg } => crowd::flow(signals, *count, *within_m, *angle_deg),
        Predicate::Density { per_m2, radius_m, for_s } => crowd::density(signals, *per_m2, *radius_m, *for_s),
        Predicate::Surrounds { count, within_m, for_s } => crowd::surrounds(signals, *count, *within_m, *for_s),
        Predicate::Converges { within_m, within_s } => crowd::converges(signals, *within_m, *within_s),
        Predicate::Blocks { human, for_s } => acts::blocks(signals, *human, *for_s),
        Predicate::Looks { human, for_s } => acts::looks(signals, *human, *for_s),
        Predicate::StandsStill { human, for_s } => acts::stands_still(signals, *human, *for_s),
        Predicate::RunsAway { human, by_m } => acts::runs_away(signals, *human, *by_m),
        Predicate::GivesWay { human } => aside::gives_way(signals, *human),
        Predicate::Reacts { human, when, act, within_s } => reactions::reacts(signals, *human, when, act, *within_s),
        Predicate::GesturesTo { human, gesture, to } => addressed::gestures_to(signals, *human, *gesture, *to),
        Predicate::ComesBack { human } => turns::comes_back(signals, *human),
        Predicate::TurnsBack { human } => turns::turns_back(signals, *human),
        Predicate::GoesTo { human, nodes } => turns::goes_to(signals, *human, nodes),
        Predicate::StaysAside { human } => aside::stays_aside(signals, *human),
        Predicate::MakesRoom { human } => aside::makes_room(signals, *human),
        Predicate::Walks { human, mps } => going::walks(signals, *human, *mps),
        Predicate::GetsTo { human, nodes } => going::gets_to(signals, *human, nodes),
        Predicate::ChangesPace { human, mps } => turns::changes_pace(signals, *human, *mps),
        Predicate::RobotStep { rule, within_s } => robot_steps::robot_step(signals, rule, *within_s),
        Predicate::Step { human, rule, within_s } => steps::step(signals, *human, rule, *within_s),
        Predicate::Gestures { agent, gesture } => acts::gestures(signals, *agent, *gesture),
        Predicate::Leaves { human, door } => either(doorway::leaves(signals, *human, door)),
        Predicate::StaysInside { human, door } => either(doorway::stays_inside(signals, *human, door)),
        Predicate::Enters { human, door } => either(doorway::enters(signals, *human, door)),
        Predicate::DoorOpens { door, robot_m } => either(doorway::door_opens(signals, door, *robot_m)),
        Predicate::HiddenUntil { human, within_m } => either(doorway::hidden_until(signals, *human, *within_m)),
        Predicate::Formation { group, spread_m } => either(groups::formation(signals, *group, *spread_m)),
        Predicate::WalksTogether { group, spread_m } => either(groups::walks_together(signals, *group, *spread_m)),
        Predicate::Queues { group, gap_m } => either(groups::queues(signals, *group, *gap_m)),
        Predicate::Order { first, then } => order(found, first, then),
        Predicate::Before { first, then, at_door: false } => setting::before(signals, *first, *then),
        Predicate::Before { first, then, at_door: true } => either(doorway::before(signals, *first, *then)),
        Predicate::EncounterAt { place, nodes, human } => setting::encounter_at(signals, *place, nodes, *human),
        Predicate::Reaches { agent, node, within_m } => setting::reaches(signals, *agent, node, *within_m),
        Predicate::StartsAt { agent, node, within_m } => setting::starts_at(signals, *agent, node, *within_m),
        Predicate::OnTime { human, gap_s } => setting::on_time(signals, *human, *gap_s),
        Predicate::Plausible => plausible(flaws),
        Predicate::RobotArrives => robot::arrives(signals),
        Predicate::RobotKeeps { min_m } => robot::keeps(signals, *min_m),
        Predicate::RobotEntersLast => either(doorway::robot_enters_last(signals)),
        Predicate::RobotLeavesFirst => either(doorway::robot_leaves_first(signals)),
        Predicate::RobotJoins { group } => either(ring::robot_joins(signals, *group)),
        Predicate::RobotLeavesGroup { group } => either(ring::robot_leaves(signals, *group)),
        Predicate::RobotObeys { gesture, within_s } => robot::obeys(signals, *gesture, *within_s),
    }
}

/// One clause is first seen before another.
fn order(found: &BTreeMap<String, Finding>, first: &str, then: &str) -> Finding {
    let seen = |id: &str| -> Result<f64, Finding> {
        match found.get(id) {
            None => Err(Finding::not_applicable(format!("there is no clause `{id}` to put in order"))),
            Some(finding) => match finding.standing {
                Standing::Holds | Standing::Late => {
                    finding.first_s().ok_or_else(|| Finding::not_applicable(format!("clause `{id}` has no time")))
                }
                Standing::NotApplicable => Err(Finding::not_applicable(format!("clause `{id}` could not be judged"))),
                Standing::NotTriggered | Standing::Fails => {
                    Err(Finding::never(-1.0, vec![], format!("clause `{id}` was never seen")))
                }
            },
        }
    };
    match (seen(first), seen(then)) {
        (Ok(before), Ok(after)) => {
            // (not then) U first, at the two times. Whether `then` has come has no size of its own, so that the
            // margin is in seconds: how long `first` has been seen by then.
            let times = [before.min(after), before.max(after)];
            let come: Signal =
                times.map(|t| (t, if t >= after { f64::INFINITY } else { f64::NEG_INFINITY })).into_iter().collect();
            let seen: Signal = times.map(|t| (t, t - before - setting::BEFORE_S)).into_iter().collect();
            let margin = come.not().until(&seen, Within::EVER).now().unwrap_or(f64::NEG_INFINITY);
            let text = format!("`{first}` at {before:.1} s, `{then}` at {after:.1} s");
            Finding::by_margin(margin, vec![after, before], text).shifted(margin)
        }
        (Err(finding), _) | (_, Err(finding)) => finding,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_done_before_the_meeting_keeps_somebody_from_being_on_time() {
        let rule = |when, act| Rule {
            when: vec![when],
            act,
            gesture: None,
            for_s: Some(3.0),
            latched: true,
            ..Rule::default()
        };
        for (when, act, keeps) in [
            (Trigger::RobotNear(4.0), Action::StandStill, false),
            (Trigger::RobotVisible(3.0), Action::LookAtRobot, false),
            (Trigger::RobotSays(socrates_model::Gesture::Wait), Action::StandStill, false),
            (Trigger::RobotNear(4.0), Action::Navigate, true),
            (Trigger::RobotNear(1.2), Action::StandStill, true),
            (Trigger::RobotPassed, Action::LookAtRobot, true),
            (Trigger::AtEncounter, Action::StandStill, true),
        ] {
            assert_eq!(keeps_walk(&rule(when.clone(), act.clone())), keeps, "{when:?} {act:?}");
        }
    }

    #[test]
    fn the_margin_of_an_order_is_the_time_between_the_two_beyond_that_of_the_same_time() {
        for (before, after) in [(2.5, 7.25), (7.25, 2.5), (3.0, 3.0), (3.0, 3.03), (3.0, 3.4)] {
            let found = BTreeMap::from([
                ("a".to_owned(), Finding::holds(1.0, vec![before], "")),
                ("b".to_owned(), Finding::late(0.0, vec![after], "")),
                ("c".to_owned(), Finding::fails(-1.0, vec![], "")),
            ]);
            let finding = order(&found, "a", "b");
            let wanted = after - before - setting::BEFORE_S;
            assert!((finding.margin - wanted).abs() < 1e-12, "{finding:?}");
            assert_eq!(finding.standing, if wanted >= 0.0 { Standing::Holds } else { Standing::Fails });
            assert_eq!(finding.shift_s, Some(finding.margin));
            assert_eq!(order(&found, "a", "c").standing, Standing::NotTriggered);
        }
    }
}
