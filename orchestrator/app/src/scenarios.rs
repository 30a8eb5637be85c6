//! `scenarios`: the catalog of canonical scenarios.

use serde_json::{Value, json};
use socrates_model::{Clause, ClauseRole};
use socrates_offline::{Card, catalog};

use crate::cards::{find, fitting, mark, places, request};
use crate::exit::Diagnostic;
use crate::output::Printer;

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

/// Every clause of the card played with seed 1 where it fits first: what is asked of the people by their parts, too.
async fn played(card: &'static Card) -> Option<(String, Vec<Clause>)> {
    let place = places(card).ok()?.into_iter().next()?;
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
pub async fn show(talk: &Printer, id: &str) -> Result<(), Diagnostic> {
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
            let when = socrates_model::Trigger::phrases(&rule.when);
            let within = rule.within_m.map_or_else(String::new, |[low, high]| format!(" ({low} to {high} m)"));
            let says = rule.gesture.map_or_else(String::new, |gesture| format!(", gestures {gesture}"));
            let lasts = rule.for_s.map_or_else(String::new, |[low, high]| format!(", for {low} to {high} s"));
            talk.line(&format!("             {when}{within}: {}{says}{lasts}", rule.act.phrase()));
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

#[cfg(test)]
mod tests {
    use socrates_model::Verdict;

    use super::*;
    use crate::in_process::play;

    #[tokio::test]
    async fn nobody_makes_room_in_a_doorway_by_squeezing_past_the_robot() {
        let (card, place) = (find("narrow_doorway").unwrap(), socrates_maps::shipped::load("office").unwrap());
        let played = play(&request(card, "office").unwrap(), &place, 61).await.unwrap();
        let verdict = played.report.verdict;
        assert!(matches!(verdict, Verdict::Realised | Verdict::RealisedLate), "{}", played.report.verdict_text);
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
        let diagnostic = find("quark").unwrap_err();
        assert!(diagnostic.what.contains("`quark`") && diagnostic.hint.contains("queue"), "{diagnostic}");
        assert_eq!(fitting(find("exiting_elevator").unwrap()), ["hospital"]);
    }
}
