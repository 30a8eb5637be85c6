//! Every reason for which a scenario is sent back goes to a stage that can mend it: a part of a good scenario is spoiled, and the stage that the
//! verdict names gets its good answer back.
//!
//! ```text
//! realised ─► one part spoiled ─► played, judged ─► repair names a stage ─► that stage's good answer, and those after it ─► realised again
//! ```

use std::collections::BTreeMap;
use std::path::Path;

use socrates_app::config::Config;
use socrates_app::in_process::{Made, evidence, simulate};
use socrates_app::prepare::{Prepared, prepare_text};
use socrates_model::job::Stage;
use socrates_model::rule::RobotDo;
use socrates_model::{Action, HumanId, Location, NodeId, Relation, Report, Rule, Run, RunId, Trigger, Verdict};

use crate::mutations::{realised, shipped};

/// Spoils a scenario; `None` where it has nothing of the kind.
type Spoil = fn(&mut Made, &Location) -> Option<()>;

const PAGE: &str = include_str!("../../../prompts/README.md");

/// Two requests more, in which people wait for signs.
const SIGNS: [(&str, &str); 2] = [
    (
        "excuse-me",
        r#"
location = "office"
social_context = "An office"
task = "Deliver a parcel to the other end of the corridor"
[[human]]
relation = "static"
place = "corridor"
reacts = [{ when = { robot_says = "EXCUSE_ME" }, act = "give_way", for_s = 8 }]
[robot]
does = [{ when = { human_near = 3.0 }, say = "EXCUSE_ME" }]
"#,
    ),
    (
        "called",
        r#"
location = "office"
social_context = "An office"
task = "Deliver a parcel to the other end of the corridor"
rough_scenario = "A nurse comes towards the robot in the corridor and signals wait when she sees the robot. A visitor stands in the corridor and looks at the robot when the nurse signals wait."
"#,
    ),
];

const HASTY: &str = "a reaction comes without its reason";

/// What is spoiled, and by which stage's answer it is mended.
const SPOILS: [(&str, Stage, Spoil); 9] = [
    ("the robot says nothing", Stage::Proposal, silent),
    ("nobody signs to anybody", Stage::Proposal, no_signs),
    ("a reaction comes only within 0.3 m", Stage::Behaviors, short_sighted),
    (HASTY, Stage::Behaviors, hasty),
    ("somebody walks the other way", Stage::Paths, turned),
    ("one of a group stands elsewhere", Stage::Paths, apart),
    ("one of a group runs away from afar", Stage::Behaviors, leaves_group),
    ("somebody stands where the robot wants to end", Stage::Paths, in_the_way),
    ("somebody starts in the robot's place", Stage::Paths, on_top),
];

fn waits_for_robot(rule: &Rule) -> bool {
    rule.when.iter().any(|trigger| matches!(trigger, Trigger::RobotSays(_)))
}

fn silent(made: &mut Made, _: &Location) -> Option<()> {
    let waits = made.proposal.humans.iter().any(|human| human.rules.iter().any(waits_for_robot));
    let script = &mut made.proposal.robot.script;
    let before = script.len();
    script.retain(|line| !matches!(line.act, RobotDo::Say(_)));
    (waits && script.len() < before).then_some(())
}

fn no_signs(made: &mut Made, _: &Location) -> Option<()> {
    let heard = |rule: &Rule| rule.when.iter().any(|trigger| matches!(trigger, Trigger::HumanSays(..)));
    if !made.proposal.humans.iter().any(|human| human.rules.iter().any(heard)) {
        return None;
    }
    for human in &mut made.proposal.humans {
        human.rules.retain(|rule| rule.gesture.is_none());
    }
    compiled(made, |_| ())
}

/// Trees compiled anew from rules that were changed on the way, those of the proposal aside.
fn compiled(made: &mut Made, change: impl Fn(&mut Rule)) -> Option<()> {
    for human in &made.proposal.humans {
        let mut rules = human.rules.clone();
        rules.iter_mut().for_each(&change);
        made.behaviors.humans.get_mut(&human.id)?.tree = socrates_bt::compile(human.id, &rules).ok()?;
    }
    Some(())
}

fn sees(rule: &Rule) -> bool {
    let near = |trigger: &Trigger| matches!(trigger, Trigger::RobotVisible(_) | Trigger::RobotNear(_));
    rule.when.len() == 1 && rule.when.iter().all(near) && rule.gesture.is_none()
}

fn short_sighted(made: &mut Made, _: &Location) -> Option<()> {
    if !made.proposal.humans.iter().any(|human| human.rules.iter().any(sees)) {
        return None;
    }
    compiled(made, |rule| {
        if sees(rule) {
            rule.when = vec![Trigger::RobotNear(0.3)];
        }
    })
}

fn hasty(made: &mut Made, _: &Location) -> Option<()> {
    if !made.proposal.humans.iter().any(|human| human.rules.iter().any(sees)) {
        return None;
    }
    compiled(made, |rule| {
        if sees(rule) {
            rule.when = vec![Trigger::Always];
        }
    })
}

fn turned(made: &mut Made, _: &Location) -> Option<()> {
    let frontal = made.proposal.humans.iter().find(|human| human.relation == Relation::Frontal)?;
    made.paths.humans.get_mut(&frontal.id)?.reverse();
    Some(())
}

fn apart(made: &mut Made, location: &Location) -> Option<()> {
    let group = made.proposal.groups.iter().find(|group| group.members.len() > 2)?;
    let last: HumanId = *group.members.last()?;
    let way = made.paths.humans.get_mut(&last)?;
    let [here] = &way[..] else { return None };
    let next: NodeId = location.graph.neighbors(here).iter().find(|node| *node != here)?.clone();
    *way = vec![next.clone()];
    for encounter in made.paths.encounters.iter_mut().filter(|encounter| encounter.human == last) {
        encounter.node = next.clone();
    }
    Some(())
}

fn leaves_group(made: &mut Made, _: &Location) -> Option<()> {
    let member = *made.proposal.groups.iter().find(|group| group.standing)?.members.first()?;
    let mut rules = made.proposal.human(member)?.rules.clone();
    let when = vec![Trigger::RobotNear(15.0)];
    rules.insert(0, Rule { when, act: Action::RunAway, for_s: Some(6.0), latched: true, ..Rule::default() });
    // The rules say so as well: a tree that does not what they say never comes to a run.
    made.proposal.humans.iter_mut().find(|human| human.id == member)?.rules = rules.clone();
    made.behaviors.humans.get_mut(&member)?.tree = socrates_bt::compile(member, &rules).ok()?;
    Some(())
}

fn in_the_way(made: &mut Made, _: &Location) -> Option<()> {
    let goal = made.paths.robot.last()?.clone();
    let walks = made.proposal.humans.iter().find(|human| !human.relation.stands())?.id;
    *made.paths.humans.get_mut(&walks)? = vec![goal];
    Some(())
}

fn on_top(made: &mut Made, _: &Location) -> Option<()> {
    let start = made.paths.robot.first()?.clone();
    let way = made.paths.humans.values_mut().find(|way| way.len() > 1)?;
    way.insert(0, start);
    Some(())
}

fn played(prepared: &Prepared, made: &Made, seed: u64) -> Report {
    let run = Run::reference(seed);
    let id = RunId::new(run.to_string()).unwrap();
    let recording = simulate(&prepared.request, &prepared.location, made.clone(), id, &run).unwrap();
    socrates_scoring::score(&evidence(&prepared.request, &prepared.reading, &prepared.location, made, &recording))
}

/// The spoiled scenario with the good answers of a stage and of those after it.
fn mended(spoiled: &Made, good: &Made, stage: Stage) -> Made {
    let after = |other: Stage| other == stage || stage == Stage::Proposal;
    Made {
        proposal: if stage == Stage::Proposal { &good.proposal } else { &spoiled.proposal }.clone(),
        paths: if after(Stage::Paths) { &good.paths } else { &spoiled.paths }.clone(),
        behaviors: if after(Stage::Behaviors) { &good.behaviors } else { &spoiled.behaviors }.clone(),
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn every_dynamic_fault_goes_to_a_stage_whose_answer_mends_it() {
    let mut table: BTreeMap<(&str, &str, Stage), (u32, u32)> = BTreeMap::new();
    let mut seen = BTreeMap::<&str, u32>::new();
    let config = Config::load(None, std::iter::empty(), &[]).unwrap();
    let more = SIGNS.map(|(name, text)| prepare_text(name, text, name, Path::new("."), None, &config).unwrap());
    for prepared in shipped(&config).unwrap().into_iter().chain(more) {
        let name = prepared.name.clone();
        let Ok(scenario) = realised(prepared.clone(), 1).await else { continue };
        if scenario.report.verdict != Verdict::Realised {
            continue;
        }
        let good = Made {
            proposal: scenario.made.proposal.clone(),
            paths: scenario.made.paths.clone(),
            behaviors: scenario.made.behaviors.clone(),
        };
        for (what, _, spoil) in SPOILS {
            let mut spoiled = good.clone();
            if spoil(&mut spoiled, &prepared.location).is_none() {
                continue;
            }
            let report = played(&prepared, &spoiled, scenario.seed);
            // Not every spoiled part shows: a wish that is met all the same needs no repair.
            let Some(repair) = report.repair else { continue };
            let again = played(&prepared, &mended(&spoiled, &good, repair.stage), scenario.seed);
            let code = repair.faults[0].code.code();
            let (count, ok) = table.entry((what, code, repair.stage)).or_default();
            *count += 1;
            *ok += u32::from(again.verdict == Verdict::Realised);
            *seen.entry(what).or_default() += 1;
            // Trees that do not what the rules say never come to a run: B-MATCH refuses them. Of one that acts without a reason other clauses
            // tell more than its own; the same reasons again then go one stage up.
            let told = format!("{name}: {what}: {:?} sent to {}", repair.faults, repair.stage);
            assert!(again.verdict == Verdict::Realised || what == HASTY, "{told}");
        }
    }
    let rows: Vec<String> = table
        .iter()
        .map(|((what, code, stage), (count, ok))| format!("| {what} | {code} | {stage} | {ok} of {count} |"))
        .collect();
    // The page says what was found.
    let told: Vec<&str> =
        PAGE.lines().filter(|line| SPOILS.iter().any(|(what, ..)| line.starts_with(&format!("| {what} |")))).collect();
    assert_eq!(told, rows, "prompts/README.md:\n{}", rows.join("\n"));
    for (what, stage, _) in SPOILS {
        assert!(
            seen.get(what).is_some_and(|count| *count > 0),
            "{what} ({stage}) was never seen:\n{}",
            rows.join("\n")
        );
    }
}
