//! `scenarios`: the catalog of canonical scenarios, and how often each of them really happens.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::{Value, json};
use socrates_model::report::Standing;
use socrates_model::{Clause, ClauseRole, Location, Report, Request, Verdict};
use socrates_offline::{Card, catalog};

use crate::exit::Complaint;
use crate::in_process::{Played, play};
use crate::output::Printer;
use crate::progress::Progress;

/// `a`, `+3`, or a dash: the place of a card in the lists.
fn mark(card: &Card) -> String {
    match (card.letter, card.further) {
        (Some(letter), _) => letter.to_string(),
        (None, Some(number)) => format!("+{number}"),
        (None, None) => "–".to_owned(),
    }
}

/// Lists every scenario.
pub fn list(talk: &Printer) {
    for card in catalog() {
        talk.line(&format!("{:>3}  {:<26} {}", mark(card), card.id, card.about));
    }
    let canonical = catalog().iter().filter(|card| card.letter.is_some()).count();
    talk.line("");
    talk.line(&format!("{} scenarios, {canonical} of them canonical (a to y)", catalog().len()));
    talk.line("next       socrates scenarios show ID");
    let rows: Vec<Value> = catalog()
        .iter()
        .map(|card| {
            json!({ "id": card.id, "letter": card.letter, "further": card.further, "title": card.title, "about": card.about,
                "places": card.places, "principles": card.principles, "locations": fitting(card) })
        })
        .collect();
    talk.result(&json!({ "scenarios": rows }));
}

/// Shipped locations that can hold the card.
fn fitting(card: &Card) -> Vec<&'static str> {
    let fits = |name: &&str| socrates_maps::shipped::load(name).is_ok_and(|location| card.fits(&location));
    socrates_maps::shipped::names().iter().copied().filter(fits).collect()
}

fn find(id: &str) -> Result<&'static Card, Complaint> {
    catalog()
        .iter()
        .find(|card| card.id == id || card.letter.is_some_and(|letter| letter.to_string() == id))
        .ok_or_else(|| {
            let known: Vec<&str> = catalog().iter().map(|card| card.id.as_str()).collect();
            let first = id.chars().next().unwrap_or(' ');
            let near: Vec<&str> = known.iter().copied().filter(|other| other.starts_with(first)).collect();
            let hint = if near.is_empty() {
                "`socrates scenarios list` lists them".to_owned()
            } else {
                format!("`socrates scenarios list` lists them; with `{first}` begin: {}", near.join(", "))
            };
            Complaint::input(format!("there is no scenario `{id}`"), hint)
        })
}

/// Every clause of the card played with seed 1 where it fits first: what is asked of the people by their parts, too.
async fn played(card: &'static Card) -> Option<(String, Vec<Clause>)> {
    let place = places(card, None).ok()?.into_iter().next()?;
    let asked = request(card, &place.name).ok()?;
    let clauses = crate::in_process::propose(&asked, &place, 1).await.ok()?.expected_events;
    Some((place.name, clauses))
}

/// `must`, `should` and `robot` before a clause.
const fn weight(role: ClauseRole, must: bool) -> &'static str {
    match (role, must) {
        (ClauseRole::Setup, true) => "must",
        (ClauseRole::Setup, false) => "should",
        (ClauseRole::Outcome, true) => "robot must",
        (ClauseRole::Outcome, false) => "robot",
    }
}

/// Shows the card of a scenario.
pub async fn show(talk: &Printer, id: &str) -> Result<(), Complaint> {
    let card = find(id)?;
    let sample = played(card).await;
    let words = |classes: &[socrates_model::PlaceClass]| {
        classes.iter().map(|class| class.name().replace('_', " ")).collect::<Vec<_>>().join(", ")
    };
    talk.line(&format!("{} · {} ({})", card.title, card.id, mark(card)));
    talk.line(&card.about);
    talk.line("");
    talk.line(&format!("places     {}", words(&card.places)));
    if !card.needs.is_empty() {
        talk.line(&format!("needs      {}", words(&card.needs)));
    }
    if let Some([least, most]) = card.width_m {
        let to = if most < 50.0 { format!("to {most} m") } else { "or more".to_owned() };
        talk.line(&format!("free width {least} m {to}"));
    }
    if let Some(arms) = card.arms {
        talk.line(&format!("ways       {arms} or more meet there"));
    }
    for (what, class) in [("from", card.start), ("to", card.goal)] {
        if let Some(class) = class {
            talk.line(&format!("robot {what:<4} {}", class.name().replace('_', " ")));
        }
    }
    for role in &card.roles {
        let [least, most] = role.count;
        let count = if least == most { format!("{least}") } else { format!("{least} to {most}") };
        let speed = role.speed.map_or_else(String::new, |[low, high]| format!(", {low} to {high} m/s"));
        let group = match (role.group, role.line) {
            (true, true) => ", in line",
            (true, false) => ", a group",
            (false, _) => "",
        };
        talk.line(&format!("who        {count} {} ({}){group}{speed}", role.name, plain(&json!(role.relation))));
        for rule in &role.rules {
            let when: Vec<String> = rule.when.iter().map(socrates_model::Trigger::phrase).collect();
            let within = rule.within_m.map_or_else(String::new, |[low, high]| format!(" ({low} to {high} m)"));
            let says = rule.gesture.map_or_else(String::new, |gesture| format!(", gestures {gesture}"));
            let lasts = rule.for_s.map_or_else(String::new, |[low, high]| format!(", for {low} to {high} s"));
            talk.line(&format!("             {}{within}: {}{says}{lasts}", when.join(" and "), rule.act.phrase()));
        }
    }
    for line in &card.script {
        talk.line(&format!("script     {}: {}", plain(&json!(line.when)), plain(&json!(line.act))));
    }
    talk.line(&format!("expected   {}", card.expected));
    talk.line(&format!("timing     robot and people at most {} s apart where their ways cross", card.gap_s));
    match &sample {
        Some((place, clauses)) => {
            talk.line(&format!("clauses    as played in {place} with seed 1"));
            for clause in clauses {
                let limits = plain(&json!(clause.predicate));
                talk.line(&format!("  {:<10} {} [{limits}]", weight(clause.role, clause.must), clause.text));
            }
        }
        None => {
            for clause in &card.clauses {
                let text = clause.text.replace("{human}", "each").replace("{group}", "the group");
                talk.line(&format!("  {:<10} {text}", weight(clause.role, clause.must)));
            }
        }
    }
    talk.line(&format!("probes     {}", card.principles.join(", ")));
    talk.line(&format!("fits       {}", fitting(card).join(", ")));
    talk.line(&format!("next       socrates scenarios rate {}", card.id));
    talk.result(&json!({
        "id": card.id, "letter": card.letter, "further": card.further, "title": card.title, "about": card.about,
        "principles": card.principles, "places": card.places, "needs": card.needs, "width_m": card.width_m, "arms": card.arms,
        "start": card.start, "goal": card.goal, "gap_s": card.gap_s, "expected": card.expected, "script": card.script,
        "roles": card.roles.iter().map(role_object).collect::<Vec<_>>(),
        "clauses": card.clauses.iter().map(|clause| json!({ "each": clause.each, "role": clause.role, "must": clause.must,
            "text": clause.text, "predicate": clause.predicate })).collect::<Vec<_>>(),
        "played": sample.map(|(place, clauses)| json!({ "location": place, "seed": 1, "clauses": clauses })),
        "locations": fitting(card),
    }));
    Ok(())
}

fn role_object(role: &socrates_offline::card::Role) -> Value {
    let rules: Vec<Value> = role
        .rules
        .iter()
        .map(|rule| {
            json!({ "when": rule.when, "within_m": rule.within_m, "act": rule.act, "gesture": rule.gesture,
                "for_s": rule.for_s, "latched": rule.latched })
        })
        .collect();
    json!({ "name": role.name, "relation": role.relation, "count": role.count, "who": role.who, "speed": role.speed,
        "group": role.group, "line": role.line, "start": role.start, "goal": role.goal, "rules": rules })
}

/// The tag of a tagged value.
fn first_word(value: &Value) -> String {
    match value {
        Value::Object(members) => members.keys().next().cloned().unwrap_or_default(),
        Value::String(_) | Value::Null | Value::Bool(_) | Value::Number(_) | Value::Array(_) => plain(value),
    }
}

/// A tagged value in words: `blocked 3`, `start`.
fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.replace('_', " "),
        Value::Object(members) => members
            .iter()
            .filter(|(_, value)| value.as_str() != Some(""))
            .map(|(key, value)| format!("{} {}", key.replace('_', " "), plain(value)))
            .collect::<Vec<_>>()
            .join(", "),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::Array(_) => value.to_string(),
    }
}

/// How often a card was realised, and what failed where.
#[derive(Debug, Default)]
pub(crate) struct Rate {
    pub(crate) runs: usize,
    pub(crate) realised: usize,
    /// Of those that were realised: how many with something late, and in how many the robot got to its goal without touching anybody.
    pub(crate) late: usize,
    pub(crate) success: usize,
    /// What went wrong, with the seeds.
    pub(crate) failures: BTreeMap<String, Vec<u64>>,
    /// What the judge says of each seed that was not realised.
    pub(crate) verdicts: BTreeMap<u64, String>,
    /// Locations that were used.
    pub(crate) locations: Vec<String>,
}

impl Rate {
    /// Lower end of the 95 % Wilson interval of the share.
    pub(crate) fn low(&self) -> f64 {
        socrates_stats::wilson(self.realised, self.runs, socrates_stats::Z_95).map_or(0.0, |interval| interval.low)
    }
}

/// A request for this card, in a place where it fits.
pub(crate) fn request(card: &Card, location: &str) -> Result<Request, Complaint> {
    serde_json::from_value(json!({
        "location": location, "social_context": "", "task": "Deliver mail", "expect": { "pattern": card.id },
    }))
    .map_err(|why| Complaint::input(format!("the card `{}` makes no request: {why}", card.id), ""))
}

/// Whether the scenario happened, in time or late.
const fn is_realised(report: &Report) -> bool {
    matches!(report.verdict, Verdict::Realised | Verdict::RealisedLate)
}

/// What is wrong with a scenario that was not realised; nothing where it was.
fn failing(played: &Played) -> Option<String> {
    let report = &played.report;
    if is_realised(report) {
        return None;
    }
    let kind = |id: &str| {
        let clause = played.proposal.expected_events.iter().find(|clause| clause.id == id);
        clause.map_or_else(|| id.to_owned(), |clause| first_word(&json!(clause.predicate)))
    };
    let mut kinds: Vec<String> = report
        .clauses
        .iter()
        .filter(|found| found.role == ClauseRole::Setup && found.must)
        .filter(|found| !matches!(found.standing, Standing::Holds | Standing::Late | Standing::NotApplicable))
        .map(|found| kind(&found.id))
        .collect();
    kinds.dedup();
    Some(format!(
        "{}: {}",
        report.verdict,
        if kinds.is_empty() { report.verdict_text.clone() } else { kinds.join(", ") }
    ))
}

/// Plays one card with seeds `1..=seeds` over the locations in turn.
pub(crate) async fn rated(
    card: &'static Card,
    places: &[Location],
    seeds: u64,
    played: &mut dyn FnMut(),
) -> Result<Rate, Complaint> {
    let mut rate = Rate { locations: places.iter().map(|place| place.name.clone()).collect(), ..Rate::default() };
    let mut waiting = tokio::task::JoinSet::new();
    for seed in 1..=seeds {
        let turn = usize::try_from(seed).unwrap_or(0) % places.len().max(1);
        let Some(place) = places.get(turn).cloned() else { continue };
        let asked = request(card, &place.name)?;
        waiting.spawn(async move { (seed, play(&asked, &place, seed).await) });
    }
    while let Some(done) = waiting.join_next().await {
        let (seed, outcome) = done.map_err(|why| Complaint::input(format!("a run ended: {why}"), ""))?;
        played();
        rate.runs += 1;
        if let Ok(Played { report, .. }) = &outcome {
            if is_realised(report) {
                rate.late += usize::from(report.verdict == Verdict::RealisedLate);
                rate.success += usize::from(report.success);
            } else {
                rate.verdicts.insert(seed, format!("{} · {}", report.verdict, report.verdict_text));
            }
        }
        let wrong = match &outcome {
            Ok(played) => failing(played),
            Err(faults) => {
                let mut codes: Vec<&str> =
                    faults.iter().filter(|f| !f.is_soft()).map(|fault| fault.code.code()).collect();
                codes.dedup();
                Some(format!("not written: {}", codes.join(", ")))
            }
        };
        match wrong {
            None => rate.realised += 1,
            Some(why) => rate.failures.entry(why).or_default().push(seed),
        }
    }
    rate.failures.values_mut().for_each(|seeds| seeds.sort_unstable());
    Ok(rate)
}

/// Locations where a card is played: those that fit, or the one that is asked for.
pub(crate) fn places(card: &Card, wanted: Option<&str>) -> Result<Vec<Location>, Complaint> {
    let names = wanted.map_or_else(|| fitting(card), |name| vec![name]);
    let load = |name: &str| crate::prepare::load_location(name, Path::new(".")).map(|(location, _)| location);
    let found: Vec<Location> = names.into_iter().map(load).collect::<Result<_, _>>()?;
    let found: Vec<Location> = found.into_iter().filter(|location| card.fits(location)).collect();
    if found.is_empty() {
        return Err(Complaint::input(
            format!("`{}` fits no location that was named", card.id),
            format!("it fits: {}", fitting(card).join(", ")),
        ));
    }
    Ok(found)
}

/// Plays scenarios with the reference robot and counts how often each is realised.
pub async fn rate(
    talk: &Printer,
    ids: &[String],
    seeds: u64,
    location: Option<&str>,
    out: Option<&Path>,
) -> Result<(), Complaint> {
    let cards: Vec<&'static Card> = if ids.is_empty() {
        catalog().iter().collect()
    } else {
        ids.iter().map(|id| find(id)).collect::<Result<_, _>>()?
    };
    let mut table = String::from(
        "| | scenario | locations | realised | late | Wilson ≥ | robot succeeds | what failed (seeds) |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    let (mut runs, mut realised, mut rows) = (0, 0, Vec::new());
    let mut progress = Progress::new(*talk, "playing", cards.len() * usize::try_from(seeds).unwrap_or(1));
    for card in cards {
        let before = runs;
        let mut played = 0;
        let mut at = || {
            played += 1;
            progress.at(before + played, &card.id);
        };
        let rate = rated(card, &places(card, location)?, seeds, &mut at).await?;
        (runs, realised) = (runs + rate.runs, realised + rate.realised);
        let failures: Vec<String> = rate
            .failures
            .iter()
            .map(|(why, seeds)| {
                let some: Vec<String> = seeds.iter().take(6).map(u64::to_string).collect();
                let more = if seeds.len() > 6 { " …" } else { "" };
                format!("{why} ×{} ({}{more})", seeds.len(), some.join(" "))
            })
            .collect();
        talk.line(&format!(
            "{:>3}  {:<26} {:>3}/{:<3}  {:.3}  {:>3} late  robot {:>3}  {}",
            mark(card),
            card.id,
            rate.realised,
            rate.runs,
            rate.low(),
            rate.late,
            rate.success,
            failures.join(" · ")
        ));
        table.push_str(&format!(
            "| {} | {} | {} | {}/{} | {} | {:.3} | {} | {} |\n",
            mark(card),
            card.id,
            rate.locations.join(", "),
            rate.realised,
            rate.runs,
            rate.late,
            rate.low(),
            rate.success,
            failures.join("; ")
        ));
        rows.push(json!({ "id": card.id, "letter": card.letter, "runs": rate.runs, "realised": rate.realised,
            "late": rate.late, "success": rate.success, "wilson_low": rate.low(), "failures": rate.failures,
            "verdicts": rate.verdicts, "locations": rate.locations }));
    }
    drop(progress);
    #[expect(clippy::cast_precision_loss, reason = "a few thousand runs")]
    let pooled = realised as f64 / runs.max(1) as f64;
    talk.line(&format!("pooled     {realised}/{runs} = {:.1} %", pooled * 100.0));
    table.push_str(&format!(
        "\nPooled: {realised} of {runs}, {:.1} %. Command: `socrates scenarios rate --seeds {seeds}`.\n",
        pooled * 100.0
    ));
    if let Some(path) = out {
        crate::files::write(path, table.as_bytes())?;
        talk.line(&format!("wrote      {}", path.display()));
    }
    talk.result(&json!({ "scenarios": rows, "runs": runs, "realised": realised }));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seeds per scenario: as many as a test may take.
    const SEEDS: u64 = 5;

    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    #[expect(clippy::print_stdout, reason = "figures are for whoever runs the test")]
    async fn every_scenario_of_the_catalog_really_happens() {
        let (mut runs, mut realised, mut lines) = (0, 0, Vec::new());
        for card in catalog() {
            let rate = rated(card, &places(card, None).unwrap(), SEEDS, &mut || ()).await.unwrap();
            (runs, realised) = (runs + rate.runs, realised + rate.realised);
            if rate.realised < rate.runs {
                lines.push(format!("{}: {} of {} {:?}", card.id, rate.realised, rate.runs, rate.failures));
            }
            // One of five may fail; two of five are another scenario than the card says.
            assert!(rate.realised + 1 >= rate.runs, "{}", lines.join("\n"));
        }
        println!("{realised} of {runs}\n{}", lines.join("\n"));
        assert!(realised * 100 >= runs * 97, "{}", lines.join("\n"));
    }

    #[tokio::test]
    async fn nobody_makes_room_in_a_doorway_by_squeezing_past_the_robot() {
        let (card, place) = (find("narrow_doorway").unwrap(), socrates_maps::shipped::load("office").unwrap());
        let played = play(&request(card, "office").unwrap(), &place, 61).await.unwrap();
        assert!(is_realised(&played.report), "{}", played.report.verdict_text);
    }

    #[tokio::test]
    async fn a_robot_that_asks_is_answered() {
        for (location, rough) in [
            ("hospital", "A nurse blocks the robot. When the robot says excuse me, she steps aside."),
            ("office", "A visitor blocks the robot until it says excuse me, then he steps aside."),
            (
                "warehouse",
                "A worker blocks the robot. When it says excuse me, he waits 5 seconds and then steps aside.",
            ),
            ("hospital", "A nurse stands still. When the robot says follow me, she follows it."),
            ("office", "A nurse looks at the robot when it says excuse me, for 4 seconds, and then steps aside."),
        ] {
            let place = socrates_maps::shipped::load(location).unwrap();
            let asked =
                json!({ "location": location, "social_context": "", "task": "Deliver mail", "rough_scenario": rough });
            let played = play(&serde_json::from_value(asked).unwrap(), &place, 1).await.unwrap();
            assert_eq!(played.report.verdict, Verdict::Realised, "{rough}: {}", played.report.verdict_text);
        }
    }

    #[test]
    fn a_scenario_is_found_by_id_or_letter_and_others_are_named() {
        assert_eq!(find("a").unwrap().id, "frontal_approach");
        assert_eq!(find("queue").unwrap().id, "queue");
        let complaint = find("quark").unwrap_err();
        assert!(complaint.what.contains("`quark`") && complaint.hint.contains("queue"), "{complaint}");
        assert!(places(find("exiting_elevator").unwrap(), Some("office")).unwrap_err().hint.contains("hospital"));
    }
}
