//! `labels observed`: what observers said, who of them is kept, how far they agree, and what films and planners got.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use serde_json::{Value, json};
use socrates_draw::LookKind;
use socrates_stream::csv::joined;
use socrates_study::observe::{
    Agreement, BELIEF_HZ, Believed, Choice, Coefficient, FilmMean, Kept, Prefers, Rater, Slide, Trace, agreement,
    believed, means, raters, strengths,
};
use socrates_study::stats::Level;

use super::door::Door;
use super::shown;
use super::task::{self, Task, Truth};
use crate::exit::Diagnostic;
use crate::files;
use crate::output::Printer;

/// A table larger than this is not read, bytes: a thousand beliefs of a minute have ten.
const MAX_BYTES: u64 = 64 * 1024 * 1024;
const COLUMNS: [&str; 4] = ["task", "rater", "t", "value"];

/// What `labels observed` is given.
#[derive(Debug, Clone)]
pub struct ObservedOptions {
    /// Tables that the page saved.
    pub answers: Vec<PathBuf>,
    /// The key beside the page.
    pub key: PathBuf,
    /// Folder for the tables.
    pub out: PathBuf,
}

/// What was said, by kind.
#[derive(Debug, Clone, Default, PartialEq)]
struct Said {
    slides: Vec<Slide>,
    traces: Vec<Trace>,
    choices: Vec<(String, Choice)>,
}

/// Does `labels observed`.
///
/// # Errors
/// A table or a key that cannot be taken, with every line that is wrong; a file that cannot be written.
pub fn observed(talk: &Printer, options: &ObservedOptions) -> Result<(), Diagnostic> {
    let text = files::text(&options.key, MAX_BYTES, "the observe-key.csv that `labels observe` wrote")?;
    let tasks = task::read(&text, &options.key.display().to_string())?;
    let mut tables = Vec::new();
    for path in &options.answers {
        let text = files::text(path, MAX_BYTES, "a table that the page saved: task,rater,t,value")?;
        tables.push((path.display().to_string(), text));
    }
    let said = read(&tables, &tasks)?;
    let all = raters(&said.slides);
    let dropped: BTreeSet<&str> =
        all.iter().filter(|rater| rater.kept == Kept::No).map(|rater| rater.name.as_str()).collect();
    let slides: Vec<Slide> = said.slides.iter().filter(|one| !dropped.contains(one.rater.as_str())).cloned().collect();
    let traces: Vec<Trace> = said.traces.iter().filter(|one| !dropped.contains(one.rater.as_str())).cloned().collect();
    let choices: Vec<Choice> = said
        .choices
        .iter()
        .filter(|(rater, _)| !dropped.contains(rater.as_str()))
        .map(|(_, one)| one.clone())
        .collect();
    let (agree, films, beliefs) = (agreement(&slides), means(&slides), believed(&traces));
    let without_rule = agreement(&said.slides);
    tell_raters(talk, &all);
    tell_agreement(talk, &agree, &without_rule, dropped.len());
    tell_beliefs(talk, &beliefs);
    let pairs = tell_pairs(talk, &choices);
    let runs: BTreeMap<&str, &Task> = tasks.iter().map(|task| (task.film.as_str(), task)).collect();
    for (file, text) in [
        ("raters.csv", raters_csv(&all)),
        ("films.csv", films_csv(&films, &runs)),
        ("beliefs.csv", beliefs_csv(&beliefs, &runs)),
    ] {
        files::write(&options.out.join(file), text.as_bytes())?;
    }
    talk.line(&format!("tables     {}", options.out.display()));
    talk.result(&json!({
        "out": options.out.display().to_string(), "raters": all.len(), "dropped": dropped, "films": films.len(),
        "alpha": alphas(&agree), "alpha_of_all": alphas(&without_rule), "beliefs": beliefs.len(), "pairs": pairs,
    }));
    Ok(())
}

/// Answers to one question by one rater: a value, or ten a second.
type Answers = BTreeMap<(String, String), Vec<(Option<f64>, String)>>;

fn read(tables: &[(String, String)], tasks: &[Task]) -> Result<Said, Diagnostic> {
    let mut door = Door::default();
    let known: BTreeMap<&str, &Task> = tasks.iter().map(|task| (task.id.as_str(), task)).collect();
    let mut answers: Answers = BTreeMap::new();
    for (file, text) in tables {
        for row in door.rows(text, file, &COLUMNS) {
            let [Some(id), Some(rater), Some(value)] =
                ["task", "rater", "value"].map(|column| door.filled(&row, column))
            else {
                continue;
            };
            let Some(task) = known.get(id.as_str()) else {
                door.wrong(&row, &format!("the question `{id}` is not in the key"));
                continue;
            };
            let belief = task.kind == LookKind::Belief;
            let t = match row.cell("t") {
                "" => None,
                text => match text.parse::<f64>().ok().filter(|t| t.is_finite() && *t >= 0.0) {
                    Some(t) => Some(t),
                    None => {
                        door.wrong(&row, &format!("`t` is `{text}`; allowed: seconds from 0"));
                        continue;
                    }
                },
            };
            if belief != t.is_some() {
                let what = if belief { "a belief has a time in `t`" } else { "only a belief has a time in `t`" };
                door.wrong(&row, what);
                continue;
            }
            let number = value.parse::<f64>().ok().filter(|value| (0.0..=1.0).contains(value));
            let fits = if task.kind == LookKind::Pair { prefers(&value).is_some() } else { number.is_some() };
            if !fits {
                let allowed = if task.kind == LookKind::Pair { "left, equal, right" } else { "0 to 1" };
                door.wrong(&row, &format!("`value` is `{value}`; allowed: {allowed}"));
                continue;
            }
            let told = answers.entry((id.clone(), rater.clone())).or_default();
            if told.iter().any(|(before, _)| before.map(f64::to_bits) == t.map(f64::to_bits)) {
                door.wrong(&row, &format!("`{rater}` has answered `{id}` twice"));
                continue;
            }
            told.push((t, value));
        }
    }
    let mut said = Said::default();
    for ((id, rater), told) in answers {
        let Some(task) = known.get(id.as_str()) else { continue };
        if let Some(gap) = add(&mut said, task, &rater, told) {
            door.say(format!(
                "`{rater}` has no belief at {gap:.1} s of `{id}`; a trace has one for every 0.1 s from 0 on"
            ));
        }
    }
    door.shut("the answers", "take the tables that the page saved, as they are", said)
}

/// Adds the answers to one question; the time of the first gap in a belief where there is one.
fn add(said: &mut Said, task: &Task, rater: &str, mut told: Vec<(Option<f64>, String)>) -> Option<f64> {
    let number = |text: &str| text.parse::<f64>().ok();
    match task.kind {
        LookKind::Belief => {
            told.sort_by(|a, b| a.0.unwrap_or(0.0).total_cmp(&b.0.unwrap_or(0.0)));
            let mut values = Vec::with_capacity(told.len());
            for (place, (t, text)) in told.iter().enumerate() {
                #[expect(clippy::cast_precision_loss, reason = "a film has few samples")]
                let wanted = place as f64 / BELIEF_HZ;
                if (t.unwrap_or(0.0) - wanted).abs() > 0.05 {
                    return Some(wanted);
                }
                // The slider goes from A to B; a belief is that in the true goal.
                values.extend(number(text).map(|to_b| if task.truth == Some(Truth::B) { to_b } else { 1.0 - to_b }));
            }
            said.traces.push(Trace { rater: rater.to_owned(), film: task.film.clone(), values });
        }
        LookKind::Pair => {
            let choice = told.first().and_then(|(_, text)| prefers(text)).map(|prefers| Choice {
                left: task.planner.clone(),
                right: task.other_planner.clone(),
                prefers,
            });
            said.choices.extend(choice.map(|choice| (rater.to_owned(), choice)));
        }
        LookKind::Rate | LookKind::Again => {
            let occasion = if task.kind == LookKind::Again { 2 } else { 1 };
            let slide = told.first().and_then(|(_, text)| number(text)).map(|value| Slide {
                rater: rater.to_owned(),
                film: task.film.clone(),
                occasion,
                value,
            });
            said.slides.extend(slide);
        }
    }
    None
}

fn prefers(word: &str) -> Option<Prefers> {
    match word {
        "left" => Some(Prefers::Left),
        "right" => Some(Prefers::Right),
        "equal" => Some(Prefers::Equal),
        _ => None,
    }
}

const fn kept(kept: Kept) -> &'static str {
    match kept {
        Kept::Yes => "kept",
        Kept::No => "dropped",
        Kept::Untold => "not told",
    }
}

fn tell_raters(talk: &Printer, all: &[Rater]) {
    for Rater { name, films, repeats, own, others, kept: is } in all {
        talk.line(&format!(
            "rater      {name}: {films} films, {repeats} twice, kappa with themself {}, with the others {} · {}",
            shown(*own),
            shown(*others),
            kept(*is)
        ));
    }
    if all.iter().any(|rater| rater.kept == Kept::Untold) {
        talk.warn("hint: who has no repeats, or nobody to be compared with, is neither kept nor dropped by the rule; their answers are used");
    }
}

const fn level(level: Level) -> &'static str {
    match level {
        Level::Nominal => "nominal",
        Level::Ordinal => "ordinal",
        Level::Interval => "interval",
    }
}

fn tell_agreement(talk: &Printer, kept: &Agreement, all: &Agreement, dropped: usize) {
    if all.films == 0 {
        return;
    }
    let words = |of: &Coefficient| {
        let interval = of.interval.map_or_else(String::new, |(low, high)| format!(" [{low:.3}, {high:.3}]"));
        format!("{} {}{interval}", level(of.level), shown(of.value))
    };
    let line = |of: &Agreement| of.alpha.iter().map(&words).collect::<Vec<_>>().join(", ");
    talk.line(&format!("alpha      {} over {} films, 95 % intervals over films", line(kept), kept.films));
    if dropped > 0 {
        talk.line(&format!("           {} with the {dropped} who are dropped", line(all)));
    }
}

fn alphas(of: &Agreement) -> Value {
    let one = |of: &Coefficient| (level(of.level).to_owned(), json!({ "value": of.value, "interval": of.interval }));
    Value::Object(of.alpha.iter().map(one).collect())
}

fn tell_beliefs(talk: &Printer, beliefs: &[Believed]) {
    for one in beliefs {
        talk.line(&format!(
            "belief     {}: ready {:.1} s before the end, clarity {:.2}, {:.1} confusions ({} viewers, agreement {}, without delays {})",
            one.film,
            one.readiness_s,
            one.clarity,
            one.confusions,
            one.raters,
            shown(one.agreement),
            shown(one.agreement_undelayed)
        ));
    }
}

/// Prints strengths of planners, and gives them for programs.
fn tell_pairs(talk: &Printer, choices: &[Choice]) -> Value {
    if choices.is_empty() {
        return Value::Null;
    }
    match strengths(choices) {
        Ok(found) => {
            talk.line(&format!(
                "pairs      {} answers, {} alike, left preferred {} of the others ({})",
                found.answers,
                found.ties,
                shown(found.left),
                found.model
            ));
            for (name, strength, error) in &found.strengths {
                talk.line(&format!("strength   {name} {strength:+.3} (standard error {error:.3})"));
            }
            let rows: Vec<Value> = found
                .strengths
                .iter()
                .map(|(name, strength, error)| json!({ "planner": name, "strength": strength, "error": error }))
                .collect();
            json!({ "model": found.model, "answers": found.answers, "ties": found.ties, "left": found.left, "strengths": rows })
        }
        Err(why) => {
            talk.line(&format!("pairs      {} answers: {why}", choices.len()));
            json!({ "answers": choices.len(), "why": why.to_string() })
        }
    }
}

fn cell(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| format!("{value:.4}"))
}

fn raters_csv(all: &[Rater]) -> String {
    let mut out = String::from("rater,films,repeats,kappa_own,kappa_others,kept\n");
    for one in all {
        let (films, repeats) = (one.films.to_string(), one.repeats.to_string());
        out.push_str(&joined([one.name.as_str(), &films, &repeats, &cell(one.own), &cell(one.others), kept(one.kept)]));
        out.push('\n');
    }
    out
}

fn films_csv(films: &[FilmMean], runs: &BTreeMap<&str, &Task>) -> String {
    let mut out = String::from("film,run,planner,raters,mean,sd\n");
    for one in films {
        let (run, planner) = runs.get(one.film.as_str()).map_or(("", ""), |task| (&task.run, &task.planner));
        let raters = one.raters.to_string();
        out.push_str(&joined([one.film.as_str(), run, planner, &raters, &cell(Some(one.mean)), &cell(one.sd)]));
        out.push('\n');
    }
    out
}

fn beliefs_csv(beliefs: &[Believed], runs: &BTreeMap<&str, &Task>) -> String {
    let mut out = String::from(
        "film,run,planner,viewers,readiness_s,clarity,confusions,agreement,agreement_undelayed,delay_s,reliability\n",
    );
    for one in beliefs {
        let (run, planner) = runs.get(one.film.as_str()).map_or(("", ""), |task| (&task.run, &task.planner));
        let viewers = one.raters.to_string();
        let told = [
            Some(one.readiness_s),
            Some(one.clarity),
            Some(one.confusions),
            one.agreement,
            one.agreement_undelayed,
            one.delay_s,
            one.reliability,
        ]
        .map(cell);
        out.push_str(&joined(
            [one.film.as_str(), run, planner, &viewers].into_iter().chain(told.iter().map(String::as_str)),
        ));
        out.push('\n');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tasks() -> Vec<Task> {
        let text = "task,kind,film,run,planner,other,other_run,other_planner,truth\n\
                    t1,rate,r01,x-1.orca-1,orca,,,,\nt2,again,r01,x-1.orca-1,orca,,,,\nt3,belief,r01,x-1.orca-1,orca,,,,b\n\
                    t4,belief,r02,x-1.mppi-1,mppi,,,,a\nt5,pair,r02,x-1.mppi-1,mppi,r01,x-1.orca-1,orca,\n";
        task::read(text, "key").unwrap()
    }

    #[test]
    fn answers_become_slides_beliefs_in_the_true_goal_and_choices() {
        let text = "task,rater,t,value\nt1,ann,,0.70\nt2,ann,,0.60\nt3,ann,0.0,0.50\nt3,ann,0.1,0.75\nt4,ann,0.0,0.50\n\
                    t4,ann,0.1,0.75\nt5,ann,,right\n";
        let said = read(&[("ann.csv".into(), text.into())], &tasks()).unwrap();
        let occasions: Vec<(u32, f64)> = said.slides.iter().map(|slide| (slide.occasion, slide.value)).collect();
        assert_eq!(occasions, [(1, 0.7), (2, 0.6)]);
        // B is the goal of the first film, A that of the second.
        assert_eq!(
            (said.traces[0].values.as_slice(), said.traces[1].values.as_slice()),
            (&[0.5, 0.75][..], &[0.5, 0.25][..])
        );
        let choice = Choice { left: "mppi".into(), right: "orca".into(), prefers: Prefers::Right };
        assert_eq!(said.choices, [("ann".to_owned(), choice)]);
    }

    #[test]
    fn everything_wrong_is_told_with_file_line_and_value() {
        let text = "task,rater,t,value\nt9,ann,,0.5\nt1,ann,,1.5\nt1,ann,2.0,0.5\nt3,ann,,0.5\nt5,ann,,both\nt1,bob,,0.5\nt1,bob,,0.5\n\
                    t3,bob,0.0,0.5\nt3,bob,0.3,0.5\nt1,,,0.5\nt3,cy,-1,0.5\n";
        let told = read(&[("a.csv".into(), text.into())], &tasks()).unwrap_err().to_string();
        for words in [
            "a.csv:2: the question `t9` is not in the key",
            "a.csv:3: `value` is `1.5`; allowed: 0 to 1",
            "a.csv:4: only a belief has a time",
            "a.csv:5: a belief has a time",
            "a.csv:6: `value` is `both`; allowed: left, equal, right",
            "a.csv:8: `bob` has answered `t1` twice",
            "`bob` has no belief at 0.1 s of `t3`",
            "a.csv:11: `rater` is empty",
            "a.csv:12: `t` is `-1`",
        ] {
            assert!(told.contains(words), "{words}: {told}");
        }
        assert!(
            read(&[("a.csv".into(), "task,rater\n".into())], &tasks())
                .unwrap_err()
                .to_string()
                .contains("`value` is missing")
        );
    }
}
