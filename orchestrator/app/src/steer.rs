//! `cluster pause`, `resume`, `cancel`, `requeue`: what a client has done about jobs, and what came of it in words.

use serde_json::json;
use socrates_link::Bus;
use socrates_model::ScenarioId;
use socrates_model::job::Stage;
use socrates_model::wire::{Chosen, Left, Part, Steer, Steered};

use crate::config::Config;
use crate::exit::{Code, Diagnostic};
use crate::output::Printer;
use crate::standing::part_words;
use crate::words::plural;
use crate::{calls, process};

/// Scenarios in one message, at most; keeps it under 64 KiB.
const AT_ONCE: usize = 300;

/// Where the orchestrator is.
#[derive(Debug, Clone)]
pub struct SteerOptions {
    /// Endpoint of the orchestrator.
    pub connect: String,
    /// Namespace.
    pub namespace: String,
}

/// What is to be done about jobs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Act {
    /// Hand out no more of them.
    Pause,
    /// Hand them out again.
    Resume,
    /// Give them up.
    Cancel,
    /// Try dead and failed ones once more.
    Requeue,
}

/// About which jobs, as it was said.
#[derive(Debug, Clone, Default)]
pub struct Whom {
    /// A stage; for pause and resume.
    pub stage: Option<String>,
    /// A batch.
    pub batch: Option<String>,
    /// Scenarios; for cancel and requeue.
    pub scenarios: Vec<String>,
    /// Whether every dead or failed one is meant; for requeue.
    pub dead: bool,
}

/// Does it and says what came of it.
///
/// # Errors
/// Names that cannot be, no orchestrator, one that refuses, or a batch or scenario that is not there.
pub async fn steer(
    talk: &Printer,
    config: &Config,
    options: &SteerOptions,
    act: Act,
    whom: &Whom,
) -> Result<Code, Diagnostic> {
    let wishes = wishes(act, whom)?;
    let bus = process::looker(config, &options.connect, &options.namespace, "steer").await?;
    let mut all = Steered::default();
    for wish in &wishes {
        add(&mut all, calls::steer(bus.as_ref(), wish.clone()).await?);
    }
    bus.close().await;
    for line in lines(act, wishes.first(), &all) {
        talk.line(&line);
    }
    talk.result(&json!({ "scenarios": all.scenarios, "jobs": all.jobs, "held": all.held, "left": all.left }));
    Ok(if all.left.iter().any(|left| left.unknown) { Code::Input } else { Code::Ok })
}

/// Does one thing over a bus that is connected already, and says what came of it.
pub(crate) async fn over(bus: &dyn Bus, act: Act, whom: &Whom) -> Result<Vec<String>, Diagnostic> {
    let mut all = Steered::default();
    let wishes = wishes(act, whom)?;
    for wish in &wishes {
        add(&mut all, calls::steer(bus, wish.clone()).await?);
    }
    Ok(lines(act, wishes.first(), &all))
}

/// The messages of a wish.
fn wishes(act: Act, whom: &Whom) -> Result<Vec<Steer>, Diagnostic> {
    let part = || -> Result<Part, Diagnostic> {
        match (&whom.stage, &whom.batch) {
            (Some(_), Some(_)) => Err(Diagnostic::input(
                "both a stage and a batch are named",
                "name one of them; a second call names the other",
            )),
            (Some(name), None) => {
                let stages = Stage::WORKERS.map(Stage::name).join(", ");
                let bad = |_bad| {
                    Diagnostic::input(format!("there is no stage `{name}`"), format!("stages: {stages}, review"))
                };
                name.parse().map(Part::Stage).map_err(bad)
            }
            (None, Some(batch)) => Ok(Part::Batch(named(batch)?)),
            (None, None) => Ok(Part::All),
        }
    };
    Ok(match act {
        Act::Pause => vec![Steer::Pause(part()?)],
        Act::Resume => vec![Steer::Resume(part()?)],
        Act::Cancel => chosen(whom)?.into_iter().map(Steer::Cancel).collect(),
        Act::Requeue => chosen(whom)?.into_iter().map(Steer::Requeue).collect(),
    })
}

/// A batch by its name: an empty one would stand for everything.
fn named(batch: &str) -> Result<String, Diagnostic> {
    if batch.is_empty() {
        return Err(Diagnostic::input(
            "the name of the batch is empty",
            "`socrates status ENDPOINT` lists the batches",
        ));
    }
    Ok(batch.to_owned())
}

fn chosen(whom: &Whom) -> Result<Vec<Chosen>, Diagnostic> {
    match (&whom.batch, whom.dead, &whom.scenarios[..]) {
        (Some(batch), false, []) => Ok(vec![Chosen::Batch(named(batch)?)]),
        (None, true, []) => Ok(vec![Chosen::All]),
        (None, false, [_, ..]) => {
            let id = |name: &String| {
                let hint = "`socrates status --all ENDPOINT` lists the scenarios";
                ScenarioId::new(name).map_err(|bad| Diagnostic::input(bad.to_string(), hint))
            };
            let ids = whom.scenarios.iter().map(id).collect::<Result<Vec<_>, _>>()?;
            Ok(ids.chunks(AT_ONCE).map(|some| Chosen::Scenarios(some.to_vec())).collect())
        }
        (None, false, []) => Err(Diagnostic::input(
            "it is not said which scenarios are meant",
            "name scenarios, or a batch with --batch",
        )),
        (Some(_), true, _) | (Some(_), _, [_, ..]) | (None, true, [_, ..]) => {
            Err(Diagnostic::input("scenarios are named in more than one way", "name scenarios, or --batch, or --dead"))
        }
    }
}

/// Puts the answers of several messages together.
fn add(all: &mut Steered, more: Steered) {
    all.scenarios = all.scenarios.saturating_add(more.scenarios);
    all.jobs = all.jobs.saturating_add(more.jobs);
    all.held = all.held.saturating_add(more.held);
    for left in more.left {
        match all.left.iter_mut().find(|known| known.why == left.why) {
            Some(known) => {
                known.count = known.count.saturating_add(left.count);
                known.some.extend(left.some);
            }
            None => all.left.push(left),
        }
    }
}

/// What came of it. Something is always said.
fn lines(act: Act, first: Option<&Steer>, done: &Steered) -> Vec<String> {
    let count = |n: u32| usize::try_from(n).unwrap_or(usize::MAX);
    let scenarios = plural(count(done.scenarios), "scenario");
    let jobs = plural(count(done.jobs), "job");
    let what = match first {
        Some(Steer::Pause(part) | Steer::Resume(part)) => part_words(part),
        Some(Steer::Cancel(_) | Steer::Requeue(_)) | None => String::new(),
    };
    let held = |words: &str| if done.held > 0 { format!(" · {} {words}", done.held) } else { String::new() };
    let mut lines = Vec::new();
    let unchanged = !done.left.is_empty() && (done.scenarios == 0 || matches!(act, Act::Pause | Act::Resume));
    lines.push(match act {
        _ if unchanged && !what.is_empty() => format!("unchanged  {what}"),
        _ if unchanged => "unchanged  no scenario was touched".to_owned(),
        Act::Pause => {
            let held = held("that workers hold are finished");
            format!("paused     {what}: {jobs} of {scenarios} wait{held}; what is submitted later waits too")
        }
        Act::Resume => format!("resumed    {what}: {jobs} of {scenarios} may go on{}", held("are held by workers")),
        Act::Cancel => format!("canceled   {scenarios}: {jobs} given up{}", held("that workers hold are told to stop")),
        Act::Requeue => format!("requeued   {scenarios}: {jobs} once more, with new budgets"),
    });
    lines.extend(done.left.iter().map(left_words));
    lines
}

fn left_words(left: &Left) -> String {
    let named = left.some.len();
    let more = count_more(left.count, named);
    format!("left       {}{more}: {}", left.some.join(", "), left.why)
}

/// ` and 3 more`, or nothing.
fn count_more(count: u32, named: usize) -> String {
    match usize::try_from(count).unwrap_or(usize::MAX).saturating_sub(named) {
        0 => String::new(),
        more => format!(" and {more} more"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn whom(stage: Option<&str>, batch: Option<&str>, scenarios: &[&str], dead: bool) -> Whom {
        Whom {
            stage: stage.map(str::to_owned),
            batch: batch.map(str::to_owned),
            scenarios: scenarios.iter().map(|name| (*name).to_owned()).collect(),
            dead,
        }
    }

    #[test]
    fn what_is_meant_is_said_in_one_way() {
        let all = wishes(Act::Pause, &whom(None, None, &[], false)).unwrap();
        assert_eq!(all, [Steer::Pause(Part::All)]);
        let stage = wishes(Act::Resume, &whom(Some("paths"), None, &[], false)).unwrap();
        assert_eq!(stage, [Steer::Resume(Part::Stage(Stage::Paths))]);
        let dead = wishes(Act::Requeue, &whom(None, None, &[], true)).unwrap();
        assert_eq!(dead, [Steer::Requeue(Chosen::All)]);
        for (act, meant, word) in [
            (Act::Pause, whom(Some("pths"), None, &[], false), "pths"),
            (Act::Pause, whom(Some("paths"), Some("b"), &[], false), "both"),
            (Act::Pause, whom(None, Some(""), &[], false), "empty"),
            (Act::Cancel, whom(None, None, &[], false), "not said"),
            (Act::Cancel, whom(None, Some("b"), &["a"], false), "more than one way"),
            (Act::Requeue, whom(None, Some("b"), &[], true), "more than one way"),
            (Act::Cancel, whom(None, None, &["a b"], false), "a b"),
        ] {
            let why = wishes(act, &meant).unwrap_err();
            assert!(why.what.contains(word) && !why.hint.is_empty(), "{why}");
        }
        let many: Vec<String> = (0..700).map(|n| format!("s{n}")).collect();
        let meant = Whom { scenarios: many, ..Whom::default() };
        assert_eq!(wishes(Act::Cancel, &meant).unwrap().len(), 3, "each message fits the bus");
    }

    #[test]
    fn it_is_said_what_came_of_it_and_what_did_not() {
        let left = |why: &str, some: &[&str], count: u32| Left {
            why: why.to_owned(),
            count,
            some: some.iter().map(|name| (*name).to_owned()).collect(),
            unknown: false,
        };
        let mut done = Steered { scenarios: 1, jobs: 4, held: 1, left: vec![left("ended before: failed", &["a"], 1)] };
        add(&mut done, Steered { scenarios: 1, jobs: 5, held: 0, left: vec![left("ended before: failed", &["b"], 9)] });
        let wish = Steer::Cancel(Chosen::All);
        assert_eq!(
            lines(Act::Cancel, Some(&wish), &done),
            [
                "canceled   2 scenarios: 9 jobs given up · 1 that workers hold are told to stop",
                "left       a, b and 8 more: ended before: failed"
            ]
        );
        let none = Steered { left: vec![left("is not known here", &["x"], 1)], ..Steered::default() };
        assert_eq!(
            lines(Act::Requeue, Some(&Steer::Requeue(Chosen::All)), &none),
            ["unchanged  no scenario was touched", "left       x: is not known here"]
        );
        let pause = Steer::Pause(Part::Stage(Stage::Paths));
        assert_eq!(
            lines(Act::Pause, Some(&pause), &Steered::default()),
            ["paused     stage paths: 0 jobs of 0 scenarios wait; what is submitted later waits too"]
        );
    }
}
