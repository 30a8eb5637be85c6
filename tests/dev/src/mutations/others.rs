//! Scenarios played otherwise than asked: a reaction muted or done from afar, an obstruction cut short, an encounter elsewhere.

use std::collections::BTreeMap;

use socrates_app::in_process::Made;
use socrates_app::prepare::Prepared;
use socrates_maps::openings::Enclosures;
use socrates_model::{
    Action, AgentId, Clause, ClauseRole, Encounter, GroupId, HumanBehavior, HumanId, NodeId, Predicate, Proposal,
    Recording, Relation, Trigger,
};

/// A moved encounter is at least this far from where it was asked for, m.
const MOVED_M: f64 = 6.0;
/// The change that leaves a second encounter out: the human goes on from the first.
const ONCE: &str = "N: second encounter left out";
/// The change that puts an encounter elsewhere.
pub(super) const MOVED: &str = "encounter moved";
/// The change that makes somebody react long before the robot is as near as was asked.
pub(super) const FAR: &str = "N: reaction at 8 m";
/// Where it reacts then, m; it was asked to at most at half of that.
const FAR_M: f64 = 8.0;
const NEAR_M: f64 = 4.0;
/// A reaction from so little farther than asked is none from afar, m.
const FARTHER_M: f64 = 1.0;
/// Two meetings nearer to each other than this are one, m.
const SAME_M: f64 = 3.0;
/// The same for their times, s.
const SAME_SECS: f64 = 2.0;

/// The person about whom another scenario was made, and what was changed.
pub(super) struct About {
    human: HumanId,
    /// What is said behind the human: ` at 8 m, asked for 2 m`.
    words: String,
    /// Distance at which something was asked for, m.
    asked_m: f64,
}

impl About {
    const fn of(human: HumanId) -> Self {
        Self { human, words: String::new(), asked_m: NEAR_M }
    }

    /// The human, where the recording has them.
    fn agent(&self, recording: &Recording) -> Option<AgentId> {
        let human = AgentId::Human(self.human);
        recording.header.agents.iter().map(|info| info.agent).find(|agent| *agent == human)
    }
}

impl std::fmt::Display for About {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}{}", self.human, self.words)
    }
}

/// Whether the two runs differ for a human with the robot still farther off than was asked.
pub(super) fn parts_from_afar(first: &Recording, second: &Recording, about: &About) -> bool {
    let asked = about.asked_m;
    let Some(human) = about.agent(first) else { return false };
    let both = first.track(human).zip(second.track(human)).zip(second.track(AgentId::Robot));
    let mut parted = both.filter(|((a, b), _)| (a.point() - b.point()).norm() > 0.05 || a.leaf() != b.leaf());
    parted.next().is_some_and(|((_, b), robot)| (b.point() - robot.point()).norm() > asked + FARTHER_M)
}

/// A rule that is to be done near the robot, done from afar; `None` where it is not.
fn from_afar(rule: &socrates_model::Rule) -> Option<(f64, socrates_model::Rule)> {
    let nears = |trigger: &Trigger| matches!(trigger, Trigger::RobotVisible(_) | Trigger::RobotNear(_));
    let near =
        rule.when.iter().filter(|trigger| nears(trigger)).filter_map(Trigger::distance_m).find(|m| *m <= NEAR_M)?;
    let afar = |trigger: &Trigger| if nears(trigger) { trigger.clone().at_distance(FAR_M) } else { trigger.clone() };
    let when = rule.when.iter().map(afar);
    Some((near, socrates_model::Rule { when: when.collect(), ..rule.clone() }))
}

/// Whether a human and the robot are once both where they were when they were nearest in the first run, at about that
/// time.
pub(super) fn same_meeting(first: &Recording, second: &Recording, about: &About) -> bool {
    let Some(human) = about.agent(first) else { return false };
    let nearest =
        first.track(human).zip(first.track(AgentId::Robot)).enumerate().min_by(|(_, (a, b)), (_, (c, d))| {
            (a.point() - b.point()).norm().total_cmp(&(c.point() - d.point()).norm())
        });
    let Some((tick, (person, robot))) = nearest else { return false };
    let step = second.header.step_s.max(1e-3);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number of ticks")]
    let slack = (SAME_SECS / step).round() as usize;
    let (from, count) = (tick.saturating_sub(slack), 2 * slack + 1);
    let near = |agent: AgentId, at: socrates_model::Point| -> Vec<bool> {
        second.track(agent).skip(from).take(count).map(|state| (state.point() - at).norm() <= SAME_M).collect()
    };
    near(human, person.point()).into_iter().zip(near(AgentId::Robot, robot.point())).any(|(a, b)| a && b)
}

fn musts(proposal: &Proposal) -> impl Iterator<Item = &Clause> {
    proposal.expected_events.iter().filter(|clause| clause.must && clause.role == ClauseRole::Setup)
}

/// The scenario played otherwise than asked: a reaction muted, an obstruction cut short, an encounter elsewhere,
/// somebody leaving who should stay.
pub(super) fn other_scenarios(prepared: &Prepared, made: &Made) -> Vec<(&'static str, About, Made)> {
    let mut found = Vec::new();
    for human in made.proposal.humans.iter().filter(|human| !human.rules.is_empty()) {
        let id = human.id;
        let reacts = |clause: &Clause| {
            matches!(&clause.predicate, Predicate::Reacts { human, .. } | Predicate::RunsAway { human, .. }
                | Predicate::Blocks { human, .. } | Predicate::Looks { human, .. } if *human == id)
        };
        // Somebody who walks on without a word does so without their rule too: that is no other scenario.
        let shows = human.rules.iter().any(|rule| rule.act != Action::Navigate || rule.gesture.is_some());
        if shows && musts(&made.proposal).any(reacts) {
            found.extend(with_rules(made, id, |_| None).map(|other| ("reaction muted", About::of(id), other)));
        }
        let blocks = |clause: &Clause| matches!(clause.predicate, Predicate::Blocks { human, .. } if human == id);
        if musts(&made.proposal).any(blocks) {
            let short = |mut rule: socrates_model::Rule| {
                if rule.act == Action::Block {
                    rule.for_s = Some(0.5);
                }
                Some(rule)
            };
            found.extend(with_rules(made, id, short).map(|other| ("N: obstruction of 0.5 s", About::of(id), other)));
        }
    }
    found.extend(reactions_from_afar(made));
    let mut groups: Vec<(Option<GroupId>, u32)> = Vec::new();
    let mut met: BTreeMap<HumanId, u32> = BTreeMap::new();
    for encounter in &made.paths.encounters {
        let nth = *met.entry(encounter.human).and_modify(|nth| *nth += 1).or_insert(1);
        let Some(human) = made.proposal.human(encounter.human) else { continue };
        // Somebody who goes with the robot meets it everywhere.
        if matches!(human.relation, Relation::Behind | Relation::Ahead | Relation::Abreast) {
            continue;
        }
        // A group goes as a whole.
        if human.group.is_some() && groups.contains(&(human.group, nth)) {
            continue;
        }
        groups.push((human.group, nth));
        if nth > 1 {
            let left_out = once(made, encounter.human, human.group);
            found.extend(left_out.map(|other| (ONCE, About::of(encounter.human), other)));
            continue;
        }
        if let Some((node, other)) = moved(prepared, made, encounter, human.group) {
            found.push((MOVED, About { words: format!(" to {node}"), ..About::of(encounter.human) }, other));
        }
    }
    let leaver = made.proposal.humans.iter().find(|human| human.relation == Relation::Leaving).map(|human| human.id);
    for human in made.proposal.humans.iter().filter(|human| human.relation == Relation::Staying) {
        found.extend(
            leaver
                .and_then(|leaver| leaving(made, human.id, leaver))
                .map(|other| ("N: who should stay leaves", About::of(human.id), other)),
        );
    }
    found
}

/// Every reaction that was asked for near the robot, done from afar.
fn reactions_from_afar(made: &Made) -> Vec<(&'static str, About, Made)> {
    let mut found = Vec::new();
    for clause in musts(&made.proposal) {
        let Predicate::Reacts { human, when, act, .. } = &clause.predicate else { continue };
        let rules = made.proposal.human(*human).map(|human| human.rules.clone()).unwrap_or_default();
        let asked = rules.iter().find(|rule| rule.when == *when && rule.act == *act && *act != Action::Navigate);
        let Some((near, far)) = asked.and_then(from_afar) else { continue };
        // What is done first is done from afar; a rule that comes later waits for those before it.
        if rules.first().is_none_or(|first| first.when != *when || first.act != *act) {
            continue;
        }
        let change =
            |rule: socrates_model::Rule| Some(if rule.when == *when && rule.act == *act { far.clone() } else { rule });
        let words = format!(" at {FAR_M} m, asked for {near} m");
        let about = About { human: *human, words, asked_m: near };
        found.extend(with_rules(made, *human, change).map(|other| (FAR, about, other)));
    }
    found
}

/// The scenario with a human's rules changed, in the proposal and in the tree.
fn with_rules(
    made: &Made,
    id: HumanId,
    change: impl Fn(socrates_model::Rule) -> Option<socrates_model::Rule>,
) -> Option<Made> {
    let mut other = made.clone();
    let human = other.proposal.humans.iter_mut().find(|human| human.id == id)?;
    human.rules = std::mem::take(&mut human.rules).into_iter().filter_map(change).collect();
    let tree = socrates_bt::compile(id, &human.rules).ok()?;
    other.behaviors.humans.insert(id, HumanBehavior { tree, description: String::new() });
    Some(other)
}

/// The human meets the robot at another node of the robot's path, far from the one asked for.
fn moved(prepared: &Prepared, made: &Made, encounter: &Encounter, group: Option<GroupId>) -> Option<(NodeId, Made)> {
    let graph = &prepared.location.graph;
    let asked = graph.node(&encounter.node)?.at;
    let way = made.paths.humans.get(&encounter.human)?;
    let inner = made.paths.robot.get(1..made.paths.robot.len().saturating_sub(1))?;
    let all = Enclosures::of(&prepared.location);
    let node = inner
        .iter()
        .filter_map(|id| Some(((graph.node(id)?.at - asked).norm(), id)))
        .filter(|(distance, id)| *distance >= MOVED_M && !all.is_inside(id))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, id)| id.clone())?;
    let mut other = made.clone();
    let path = if way.len() == 1 {
        vec![node.clone()]
    } else {
        let mut path = graph.shortest(way.first()?, &node)?;
        path.extend(graph.shortest(&node, way.last()?)?.into_iter().skip(1));
        path
    };
    let with_it = |id: HumanId| {
        id == encounter.human || group.is_some() && made.proposal.human(id).is_some_and(|human| human.group == group)
    };
    for (_, way) in other.paths.humans.iter_mut().filter(|(id, _)| with_it(**id)) {
        way.clone_from(&path);
    }
    let mut first: Vec<HumanId> = Vec::new();
    for other in other.paths.encounters.iter_mut().filter(|other| with_it(other.human)) {
        // Of several the first is moved; the way to the others is gone with it.
        if !first.contains(&other.human) {
            first.push(other.human);
            other.node.clone_from(&node);
        }
    }
    Some((node, other))
}

/// The human ends a node after its first encounter instead of coming to its second.
fn once(made: &Made, id: HumanId, group: Option<GroupId>) -> Option<Made> {
    let mut other = made.clone();
    let with_it = |who: HumanId| {
        who == id || group.is_some() && made.proposal.human(who).is_some_and(|human| human.group == group)
    };
    for (who, way) in other.paths.humans.iter_mut().filter(|(who, _)| with_it(**who)) {
        way.truncate(made.paths.visits(*who).first()?.human_step? + 2);
    }
    // Played without a second meeting; the one that was asked for judges it.
    let mut first: Vec<HumanId> = Vec::new();
    other.paths.encounters.retain(|encounter| {
        let again = first.contains(&encounter.human);
        first.push(encounter.human);
        !(again && with_it(encounter.human))
    });
    other
        .proposal
        .expected_events
        .retain(|clause| !matches!(clause.predicate, Predicate::MeetsAgain { human, .. } if with_it(human)));
    Some(other)
}

/// The one who stays goes out like the one who leaves.
fn leaving(made: &Made, who: HumanId, leaver: HumanId) -> Option<Made> {
    let mut other = with_rules(made, who, |_| None)?;
    let human = other.proposal.humans.iter_mut().find(|human| human.id == who)?;
    human.relation = Relation::Leaving;
    let start = other.paths.humans.get(&who)?.first()?.clone();
    let mut way = other.paths.humans.get(&leaver)?.clone();
    if way.first() != Some(&start) && way.get(1) != Some(&start) {
        way.insert(0, start);
    }
    other.paths.humans.insert(who, way);
    let meets = other.paths.encounters.iter().find(|found| found.human == leaver)?.node.clone();
    for encounter in other.paths.encounters.iter_mut().filter(|found| found.human == who) {
        encounter.node.clone_from(&meets);
    }
    Some(other)
}
