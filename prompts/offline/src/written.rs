//! The reading as a form: TOML that stands under the text of a request, to be corrected there and played as it stands.
//!
//! Only what was read is written, and of how somebody stands to the robot's way what the author would choose, as a form has to say
//! that. Whether a form says the same as the text that it comes of is not taken for granted: tests read it again.

use socrates_model::rule::RobotDo;
use socrates_model::{FactKind, Location, Reading, Relation, Request, RobotRule, Rule, Trigger};
use socrates_prompts::Question;

use crate::lines::inline;
use crate::proposal;
use crate::spot;
use crate::story::Extra;
use crate::understand::understand;

/// Of which seed the choices are that a form has to make.
const SEED: u64 = 1;

/// The tables of the form: `[[human]]`, `[[order]]`, and what the robot does.
pub(crate) fn form(request: &Request, reading: &Reading, location: &Location) -> String {
    let extras = understand(request, location).extras;
    let question = Question::first(request.clone(), reading.clone(), location.clone(), SEED);
    let proposed = proposal::propose(&question);
    let place = place(reading, location);
    let mut tables: Vec<(String, u32)> = Vec::new();
    for (at, human) in reading.humans.iter().enumerate() {
        let extra = extras.get(at).cloned().unwrap_or_default();
        let relation = human.relation.or_else(|| proposed.humans.get(at).map(|human| human.relation));
        let mut table = String::new();
        if human.role != "person" {
            table.push_str(&format!("role = {}\n", quoted(&human.role)));
        }
        table.push_str(&stands(reading, human.id, relation.unwrap_or(Relation::Frontal), &extra, place.as_deref()));
        if let Some(group) = human.group {
            table.push_str(&format!("group = \"{group}\"\n"));
        }
        table.push_str(&steps(&human.rules));
        match tables.last_mut() {
            Some((last, count)) if *last == table => *count += 1,
            Some(_) | None => tables.push((table, 1)),
        }
    }
    let mut text = missing(reading);
    for (table, count) in tables {
        text.push_str("\n[[human]]\n");
        if count > 1 {
            text.push_str(&format!("count = {count}\n"));
        }
        text.push_str(&table);
    }
    orders(reading, &mut text);
    robot(reading, &proposed.robot.script, request, &mut text);
    text
}

/// What of the text is not in the form, as comments: it is still missing in the run until it is stated, deleted or waived.
fn missing(reading: &Reading) -> String {
    let mut text = String::new();
    for statement in reading.statements.iter().filter(|statement| statement.is_missing()) {
        let quote = statement.quote.split_whitespace().collect::<Vec<_>>().join(" ");
        text.push_str(&format!("\n# {}, so not in this form: \"{quote}\"\n", statement.fate()));
    }
    text
}

/// Where people meet the robot: by its name, or its class.
fn place(reading: &Reading, location: &Location) -> Option<String> {
    reading.facts.iter().find_map(|fact| {
        let FactKind::Place(class) = fact.kind else { return None };
        let named = spot::named_in(location, &fact.quote, class).filter(|meant| !meant.nodes.is_empty());
        Some(named.map_or_else(|| class.name().to_owned(), |meant| meant.name))
    })
}

/// How somebody stands to the robot's way.
fn stands(
    reading: &Reading,
    id: socrates_model::HumanId,
    relation: Relation,
    extra: &Extra,
    place: Option<&str>,
) -> String {
    let mut text = format!("relation = \"{}\"\n", relation.name());
    for fact in &reading.facts {
        if let FactKind::Side { human, side } = &fact.kind
            && *human == id
        {
            text.push_str(&format!("side = {}\n", inline(side)));
        }
        if let FactKind::Facing { human, facing } = &fact.kind
            && *human == id
        {
            text.push_str(&format!("facing = {}\n", inline(facing)));
        }
    }
    let indoors = matches!(relation, Relation::Leaving | Relation::Staying);
    if let Some(place) = place {
        text.push_str(&format!("place = {}\n", quoted(place)));
    }
    if let Some(start) = extra.start.filter(|start| indoors && place != Some(start.name())) {
        text.push_str(&format!("start = \"{}\"\n", start.name()));
    }
    if let Some(goal) = extra.goal {
        text.push_str(&format!("goal = \"{}\"\n", goal.name()));
    }
    if let Some(mps) = extra.speed_mps {
        text.push_str(&format!("pace = {mps:?}\n"));
    }
    text
}

/// Rules as steps: what goes on once begun is a step of `does`, as long as the step before it ends; all else stands in `reacts`.
fn steps(rules: &[Rule]) -> String {
    let (mut does, mut reacts): (Vec<String>, Vec<String>) = (Vec::new(), Vec::new());
    let mut endless = false;
    for rule in rules {
        let step = step(rule, !rule.latched || endless);
        if rule.latched && !endless {
            endless = rule.for_s.is_none() && rule.until.is_empty();
            does.push(step);
        } else {
            reacts.push(step);
        }
    }
    let list = |key: &str, steps: &[String]| match steps {
        [] => String::new(),
        [one] => format!("{key} = [{one}]\n"),
        all => format!("{key} = [\n  {},\n]\n", all.join(",\n  ")),
    };
    format!("{}{}", list("does", &does), list("reacts", &reacts))
}

fn step(rule: &Rule, standing: bool) -> String {
    let mut parts: Vec<String> = Vec::new();
    let when: Vec<String> = rule.when.iter().filter(|when| standing || **when != Trigger::Always).map(inline).collect();
    match when.as_slice() {
        [] => {}
        [one] => parts.push(format!("when = {one}")),
        all => parts.push(format!("when = [{}]", all.join(", "))),
    }
    parts.push(format!("act = {}", inline(&rule.act)));
    parts.extend(rule.for_s.map(|secs| format!("for_s = {secs:?}")));
    match rule.until.as_slice() {
        [] => {}
        [one] => parts.push(format!("until = {}", inline(one))),
        all => parts.push(format!("until = [{}]", all.iter().map(inline).collect::<Vec<_>>().join(", "))),
    }
    parts.extend(rule.gesture.map(|gesture| format!("say = \"{gesture}\"")));
    parts.extend(rule.to.map(|to| format!("to = \"{to}\"")));
    format!("{{ {} }}", parts.join(", "))
}

fn orders(reading: &Reading, text: &mut String) {
    for fact in &reading.facts {
        let FactKind::Before { first, then, at_door } = &fact.kind else { continue };
        text.push_str(&format!("\n[[order]]\nfirst = \"{first}\"\nthen = \"{then}\"\n"));
        if *at_door {
            let class = reading.place.map_or("room", |class| class.name());
            text.push_str(&format!("at = \"{class}\"\n"));
        }
    }
}

/// What the robot does, and where its way leads; as a comment where the request has a table of the robot already.
fn robot(reading: &Reading, script: &[RobotRule], request: &Request, text: &mut String) {
    let mut lines: Vec<String> = Vec::new();
    for fact in &reading.facts {
        if let FactKind::RobotAt { part, name, .. } = &fact.kind {
            lines.push(format!("{} = {}", part.name(), quoted(name)));
        }
    }
    let does: Vec<String> = script.iter().filter_map(deed).collect();
    if !does.is_empty() {
        lines.push(format!("does = [{}]", does.join(", ")));
    }
    if lines.is_empty() {
        return;
    }
    let own = request.robot != socrates_model::request::RobotRequest::default();
    let mark = if own { "# " } else { "" };
    text.push_str(&format!("\n{mark}[robot]\n"));
    for line in lines {
        text.push_str(&format!("{mark}{line}\n"));
    }
}

/// A line of the robot's script, where a form has a word for it.
fn deed(rule: &RobotRule) -> Option<String> {
    let what = match &rule.act {
        RobotDo::Say(gesture) => format!("say = \"{gesture}\""),
        RobotDo::Hold(secs) => format!("hold_s = {secs:?}"),
        RobotDo::HoldUntil(until) => format!("hold_until = {}", inline(until)),
        RobotDo::WaitForLeavers => "wait_for_leavers = true".to_owned(),
        RobotDo::Follow(human) => format!("follow = \"{human}\""),
        RobotDo::Abreast(human) => format!("beside = \"{human}\""),
        RobotDo::Overtake(human) => format!("overtake = \"{human}\""),
        RobotDo::Lead(m) => format!("lead_m = {m:?}"),
    };
    Some(format!("{{ when = {}, {what} }}", inline(&rule.when)))
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
