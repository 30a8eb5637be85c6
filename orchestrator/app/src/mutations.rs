//! `dev mutations`: does the judge refuse what is wrong and let pass what is right? Measured on real runs.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::json;
use socrates_author::Written;
use socrates_author::offline::Offline;
use socrates_maps::openings::Enclosures;
use socrates_model::job::Stage;
use socrates_model::{
    Action, AgentId, Behaviors, Clause, ClauseRole, Encounter, Fault, GroupId, HumanBehavior, HumanId, NodeId, Paths,
    Predicate, Proposal, Recording, Relation, Report, Run, ScenarioId, Trigger, Verdict,
};
use socrates_scoring::Evidence;
use socrates_scoring::mutants::{harmless, spoiled, time_margin};

use crate::config::Config;
use crate::exit::Complaint;
use crate::in_process::{self, Made};
use crate::output::Printer;
use crate::prepare::{Prepared, prepare, prepare_text, request_files};

/// Rounds of authoring: what the orchestrator would also ask again.
const ROUNDS: u64 = 4;
/// A moved encounter is at least this far from where it was asked for, m.
const MOVED_M: f64 = 6.0;

/// The change that leaves a second encounter out: the human goes on from the first.
const ONCE: &str = "N: second encounter left out";
/// The change that puts an encounter elsewhere.
const MOVED: &str = "encounter moved";
/// The change that makes somebody react long before the robot is as near as was asked.
const FAR: &str = "N: reaction at 8 m";
/// Where it reacts then, m; it was asked to at most at half of that.
const FAR_M: f64 = 8.0;
const NEAR_M: f64 = 4.0;
/// A reaction from so little farther than asked is none from afar, m.
const FARTHER_M: f64 = 1.0;
/// Two meetings nearer to each other than this are one, m.
const SAME_M: f64 = 3.0;
/// The same for their times, s.
const SAME_SECS: f64 = 2.0;

/// A request with its artifacts, its run with the reference robot, and what the judge says of it.
pub(crate) struct Scenario {
    pub(crate) prepared: Prepared,
    pub(crate) made: Made,
    pub(crate) run: Recording,
    pub(crate) report: Report,
    seed: u64,
}

/// How one kind of change fared.
#[derive(Default)]
struct Row {
    tried: usize,
    right: usize,
}

/// Everything that was tried.
#[derive(Default)]
pub(crate) struct Tally {
    spoiled: BTreeMap<String, Row>,
    harmless: BTreeMap<String, Row>,
    /// By how much each human could have been sooner and later, s.
    margins: Vec<(String, f64, f64)>,
    /// Changed artifacts that gave the same meeting all the same: nothing is wrong with those runs.
    equal: usize,
    wrong: Vec<String>,
    lines: Vec<String>,
}

impl Tally {
    /// How often a kind of change was tried and how often it was refused.
    #[cfg(test)]
    pub(crate) fn spoiled_of(&self, kind: &str) -> (usize, usize) {
        self.spoiled.get(kind).map_or((0, 0), |row| (row.tried, row.right))
    }

    /// What went wrong, a line each.
    #[cfg(test)]
    pub(crate) fn wrong(&self) -> &[String] {
        &self.wrong
    }

    fn enter(&mut self, wanted: bool, kind: &str, about: &str, base: &str, verdict: &str, why: &str) {
        let kept = verdict == Verdict::Realised.name();
        let row = if wanted { &mut self.harmless } else { &mut self.spoiled }.entry(kind.to_owned()).or_default();
        row.tried += 1;
        row.right += usize::from(kept == wanted);
        let line = format!("{base}: {kind} ({about}): {verdict} · {why}");
        if kept != wanted {
            self.wrong.push(line.clone());
        }
        self.lines.push(line);
    }
}

/// Does `dev mutations`.
pub async fn mutations(
    talk: &Printer,
    config: &Config,
    requests: &[PathBuf],
    seeds: u64,
    all: bool,
) -> Result<(), Complaint> {
    let scenarios = if requests.is_empty() { shipped(config)? } else { named(config, requests)? };
    let mut tally = Tally::default();
    let mut unrealised = Vec::new();
    let mut bases = 0;
    for prepared in &scenarios {
        for seed in 1..=seeds {
            talk.passing(&format!("{} seed {seed}", prepared.name));
            let name = format!("{}-{seed}", prepared.name);
            match realised(prepared.clone(), seed).await {
                Ok(scenario) if scenario.report.verdict == Verdict::Realised => {
                    bases += 1;
                    try_all(&scenario, &name, &mut tally);
                }
                Ok(Scenario { report, .. }) => {
                    unrealised.push(format!("{name}: {} · {}", report.verdict, report.verdict_text));
                }
                Err(why) => unrealised.push(format!("{name}: {why}")),
            }
        }
    }
    talk.clear();
    print(talk, &tally, bases, &unrealised, all);
    Ok(())
}

pub(crate) fn shipped(config: &Config) -> Result<Vec<Prepared>, Complaint> {
    let mut found = Vec::new();
    for location in socrates_maps::shipped::names() {
        for (name, text) in socrates_maps::shipped::requests(location) {
            let name = format!("{location}-{}", name.trim_end_matches(".toml"));
            found.push(prepare_text(&name, text, &name, Path::new("."), None, config)?);
        }
    }
    Ok(found)
}

fn named(config: &Config, requests: &[PathBuf]) -> Result<Vec<Prepared>, Complaint> {
    request_files(requests)?.iter().map(|file| prepare(file, None, config)).collect()
}

/// The scenario of a request with its reference run, asked again where the verdict says so.
pub(crate) async fn realised(prepared: Prepared, seed: u64) -> Result<Scenario, String> {
    let mut feedback: BTreeMap<Stage, Vec<Fault>> = BTreeMap::new();
    let mut last = Err("was never asked for".to_owned());
    for round in 0..ROUNDS {
        let made = author(&prepared, seed * 1000 + round, &mut feedback).await;
        let made = match made {
            Ok(made) => made,
            Err(why) => {
                last = Err(why);
                continue;
            }
        };
        let run = simulate(&prepared, &made, seed)?;
        let report = judge(&prepared, &made, &run);
        if let Some(repair) = &report.repair {
            feedback.entry(repair.stage).or_default().clone_from(&repair.faults);
        }
        let done = report.verdict == Verdict::Realised;
        last = Ok((made, run, report));
        if done {
            break;
        }
    }
    last.map(|(made, run, report)| Scenario { prepared, made, run, report, seed })
}

/// Asks the offline author for everything, as the authoring stages do.
async fn author(prepared: &Prepared, seed: u64, feedback: &mut BTreeMap<Stage, Vec<Fault>>) -> Result<Made, String> {
    let mut proposal: Option<Proposal> = None;
    let mut paths: Option<Paths> = None;
    let mut behaviors: Option<Behaviors> = None;
    for stage in [Stage::Proposal, Stage::Paths, Stage::Behaviors] {
        let question = socrates_prompts::Question {
            stage,
            proposal: proposal.clone(),
            feedback: feedback.get(&stage).cloned().unwrap_or_default(),
            ..socrates_prompts::Question::first(
                prepared.request.clone(),
                prepared.reading.clone(),
                prepared.location.clone(),
                seed,
            )
        };
        match socrates_author::attempt(&Offline, &question).await {
            Ok(answer) => match answer.written {
                Written::Proposal(found) => proposal = Some(found),
                Written::Paths(found) => paths = Some(found),
                Written::Behaviors(found) => behaviors = Some(found),
            },
            Err(refused) => {
                let why = format!("{stage} refused: {}", texts(&refused.faults));
                feedback.insert(stage, refused.faults);
                return Err(why);
            }
        }
    }
    match (proposal, paths, behaviors) {
        (Some(proposal), Some(paths), Some(behaviors)) => Ok(Made { proposal, paths, behaviors }),
        _ => Err("a stage has no answer".to_owned()),
    }
}

fn texts(faults: &[Fault]) -> String {
    faults.iter().map(|fault| format!("{} {}", fault.code, fault.message)).collect::<Vec<_>>().join("; ")
}

fn simulate(prepared: &Prepared, made: &Made, seed: u64) -> Result<Recording, String> {
    let scenario = ScenarioId::new("mutations").map_err(|why| why.to_string())?;
    let run = Run::reference(seed);
    in_process::simulate(&prepared.request, &prepared.location, made.clone(), run.id(&scenario), &run)
        .map_err(|faults| texts(&faults))
}

fn judge(prepared: &Prepared, made: &Made, recording: &Recording) -> Report {
    socrates_scoring::score(&evidence(prepared, made, recording))
}

pub(crate) fn evidence<'a>(prepared: &'a Prepared, made: &'a Made, recording: &'a Recording) -> Evidence<'a> {
    in_process::evidence(&prepared.request, &prepared.reading, &prepared.location, made, recording)
}

/// Every harmless and every spoiling change of a realised scenario.
pub(crate) fn try_all(scenario: &Scenario, name: &str, tally: &mut Tally) {
    let Scenario { prepared, made, run, seed, .. } = scenario;
    for human in &made.proposal.humans {
        let (sooner, later) = time_margin(&evidence(prepared, made, run), human.id);
        tally.margins.push((format!("{name} {}", human.id), sooner, later));
    }
    for mutant in harmless(run) {
        let report = judge(prepared, made, &mutant.recording);
        tally.enter(true, mutant.kind, &mutant.about, name, report.verdict.name(), &report.verdict_text);
    }
    for mutant in spoiled(&evidence(prepared, made, run)) {
        let report = judge(prepared, made, &mutant.recording);
        tally.enter(false, mutant.kind, &mutant.about, name, report.verdict.name(), &report.verdict_text);
    }
    for (kind, about, other) in other_scenarios(prepared, made) {
        let told = about.to_string();
        // Played from other artifacts, judged by those that were asked for.
        match simulate(prepared, &other, *seed) {
            Ok(recording) if kind == MOVED && same_meeting(run, &recording, &about) => tally.equal += 1,
            Ok(recording) if kind == FAR && !parts_from_afar(run, &recording, &about) => tally.equal += 1,
            Ok(recording) => {
                let report = judge(prepared, made, &recording);
                tally.enter(false, kind, &told, name, report.verdict.name(), &report.verdict_text);
            }
            Err(why) => tally.enter(false, kind, &told, name, "refused before the run", &why),
        }
    }
}

/// Whom another scenario was made about, and what was changed.
struct About {
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
fn parts_from_afar(first: &Recording, second: &Recording, about: &About) -> bool {
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
fn same_meeting(first: &Recording, second: &Recording, about: &About) -> bool {
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
fn other_scenarios(prepared: &Prepared, made: &Made) -> Vec<(&'static str, About, Made)> {
    let mut found = Vec::new();
    for human in made.proposal.humans.iter().filter(|human| !human.rules.is_empty()) {
        let id = human.id;
        let reacts = |clause: &Clause| {
            matches!(&clause.predicate, Predicate::Reacts { human, .. } | Predicate::RunsAway { human, .. }
                | Predicate::Blocks { human, .. } | Predicate::Looks { human, .. } if *human == id)
        };
        // Who walks on without a word does so without its rule too: that is no other scenario.
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
        // Who goes with the robot meets it everywhere.
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

/// Who stays goes out like the one who leaves.
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

fn share(right: usize, tried: usize) -> String {
    let interval = socrates_stats::wilson(right, tried, socrates_stats::Z_95).ok();
    #[expect(clippy::cast_precision_loss, reason = "counts of a table")]
    let percent = if tried == 0 { 0.0 } else { 100.0 * right as f64 / tried as f64 };
    interval.map_or_else(
        || "none tried".to_owned(),
        |interval| format!("{percent:.1} % ({:.1} to {:.1})", interval.low * 100.0, interval.high * 100.0),
    )
}

fn print(talk: &Printer, tally: &Tally, bases: usize, unrealised: &[String], all: bool) {
    let sum = |rows: &BTreeMap<String, Row>| {
        rows.values().fold((0, 0), |(right, tried), row| (right + row.right, tried + row.tried))
    };
    let table = |title: &str, word: &str, rows: &BTreeMap<String, Row>| {
        talk.line(&format!("{title:<38} tried  {word}"));
        for (kind, row) in rows {
            talk.line(&format!("  {kind:<36} {:>5}  {}", row.tried, share(row.right, row.tried)));
        }
        let (right, tried) = sum(rows);
        talk.line(&format!("  {:<36} {tried:>5}  {}", "all", share(right, tried)));
    };
    talk.line(&format!("{bases} realised runs, {} not", unrealised.len()));
    for line in unrealised {
        talk.line(&format!("  not realised  {line}"));
    }
    table("spoiled", "refused", &tally.spoiled);
    talk.line(&format!(
        "  ({} more with an encounter moved in the paths gave the same meeting and are not counted)",
        tally.equal
    ));
    table("harmless", "let pass", &tally.harmless);
    let middle = |of: &dyn Fn(&(String, f64, f64)) -> f64| {
        let mut all: Vec<f64> = tally.margins.iter().map(of).collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied().unwrap_or(0.0)
    };
    talk.line(&format!(
        "time margin: half of {} people could be {:.2} s sooner, {:.2} s later and more (0.25 to 6 s tried)",
        tally.margins.len(),
        middle(&|margin| margin.1),
        middle(&|margin| margin.2)
    ));
    for (who, sooner, later) in tally.margins.iter().filter(|_| all) {
        talk.line(&format!("  {who:<36} {sooner:.2} s sooner, {later:.2} s later"));
    }
    for line in if all { &tally.lines } else { &tally.wrong } {
        talk.line(&format!("  {}{line}", if all { "" } else { "WRONG  " }));
    }
    let (caught, spoiled) = sum(&tally.spoiled);
    let (kept, harmless) = sum(&tally.harmless);
    talk.result(&json!({
        "runs": bases,
        "unrealised": unrealised,
        "spoiled": { "tried": spoiled, "refused": caught },
        "harmless": { "tried": harmless, "let_pass": kept },
        "time_margins": tally.margins,
        "wrong": tally.wrong,
    }));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn of_real_runs_spoiled_ones_are_refused_and_harmless_changes_pass() {
        let config = Config::load(None, std::iter::empty(), &[]).unwrap();
        let mut tally = Tally::default();
        let mut bases = 0;
        for prepared in shipped(&config)
            .unwrap()
            .iter()
            .filter(|prepared| ["frontal", "group", "crossing"].iter().any(|kind| prepared.name.contains(kind)))
        {
            let scenario = realised(prepared.clone(), 1).await.unwrap();
            let report = &scenario.report;
            assert_eq!(report.verdict, Verdict::Realised, "{}: {}", prepared.name, report.verdict_text);
            bases += 1;
            try_all(&scenario, &prepared.name, &mut tally);
        }
        assert!(bases >= 2);
        let sum = |rows: &BTreeMap<String, Row>| {
            rows.values().fold((0, 0), |(right, tried), row| (right + row.right, tried + row.tried))
        };
        let ((caught, spoiled), (kept, harmless)) = (sum(&tally.spoiled), sum(&tally.harmless));
        assert!(spoiled >= 10 && caught * 100 >= spoiled * 95, "{caught} of {spoiled}: {:#?}", tally.wrong);
        assert!(harmless >= 6 && kept * 100 >= harmless * 95, "{kept} of {harmless}: {:#?}", tally.wrong);
    }
}
