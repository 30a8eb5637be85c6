//! What was understood, as lines of a form: what a word of a text does shows in them, whichever rule read it.

use socrates_model::{FactKind, HumanId, Location, Reading, Rule, Trigger};

use crate::spot;
use crate::story::{Extra, Story};
use crate::task::{self, Task};

/// One line, with the fact that it tells, if one does.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Line {
    pub(crate) text: String,
    /// Whether it is a line of a form, which people are shown.
    pub(crate) shown: bool,
    pub(crate) fact: Option<FactKind>,
}

/// Every line of what was understood.
pub(crate) fn lines(
    (story, task): (&Story, &Task),
    reading: &Reading,
    extras: &[Extra],
    location: &Location,
) -> Vec<Line> {
    let mut found = Vec::new();
    let mut put = |text: String, shown: bool, fact: Option<FactKind>| found.push(Line { text, shown, fact });
    if let Some(id) = &reading.pattern {
        put(format!("pattern = \"{id}\""), false, None);
    }
    for (at, human) in reading.humans.iter().enumerate() {
        let id = human.id;
        if human.role != "person" {
            put(format!("{id}: role = \"{}\"", human.role), true, None);
        }
        // What they are read to do, also where that is what anybody does: `walks`.
        put(format!("{id}: {}", human.summary), false, None);
        if let Some(relation) = human.relation {
            let fact = FactKind::Relates { human: id, relation };
            put(format!("{id}: relation = \"{}\"", relation.name()), true, Some(fact));
        }
        let extra = extras.get(at).cloned().unwrap_or_default();
        let ends = [("start", extra.start), ("goal", extra.goal)];
        for (key, class) in ends.into_iter().filter_map(|(key, class)| Some((key, class?))) {
            put(format!("{id}: {key} = \"{}\"", class.name()), true, None);
        }
        if let Some(mps) = extra.speed_mps {
            put(format!("{id}: pace = {mps}"), true, None);
        }
        let person = story.people.get(at);
        for (nth, rule) in human.rules.iter().enumerate() {
            let read = person.and_then(|person| person.rules.get(nth));
            let fact = match rule.gesture {
                Some(gesture) => FactKind::Gestures { human: id, gesture },
                None => FactKind::Reacts { human: id, rule: rule.clone() },
            };
            let exact = read.is_some_and(|read| read.exact);
            put(format!("{id}: {}", rule_text(rule, exact)), true, Some(fact));
            // What the text says of its time and distance, even where it is what would be played anyway.
            if let Some(read) = read {
                let said = [("when", read.stated), ("distance", read.exact), ("for", read.lasts), ("then", read.then)];
                for (what, _) in said.into_iter().filter(|(_, said)| *said) {
                    put(format!("{id}: {nth}. {what} said"), false, None);
                }
            }
        }
        for (act, _) in person.iter().flat_map(|person| &person.never) {
            put(format!("{id}: never {}", act.name()), true, None);
        }
        if person.is_some_and(|person| person.crosses.is_some()) {
            put(format!("{id}: crosses the robot's way"), true, None);
        }
    }
    for fact in &reading.facts {
        let Some(text) = fact_text(&fact.kind, location, &fact.quote) else { continue };
        put(text, true, Some(fact.kind.clone()));
    }
    for (key, ends) in [("start", &task.starts), ("goal", &task.goals)] {
        if let Some(end) = ends.iter().find(|end| !end.nodes.is_empty()) {
            put(format!("robot: {key} = \"{}\"", end.name), true, None);
        }
        // Two places of one name are one reading only where they are the same nodes.
        put(format!("robot: {key} {:?}", task::nodes(ends)), false, None);
    }
    if let Some((class, _)) = &task.via {
        put(format!("robot: via = \"{}\"", class.name()), true, None);
    }
    found
}

/// The facts that are not told with a person.
fn fact_text(kind: &FactKind, location: &Location, quote: &str) -> Option<String> {
    Some(match kind {
        FactKind::Humans(count) => format!("humans = {count}"),
        FactKind::Group { members, .. } => format!("group = [{}]", people(members)),
        FactKind::MeetsTimes { human, times, .. } => format!("{human}: meets the robot {times} times"),
        FactKind::Before { first, then, at_door } => {
            let door = if *at_door { ", at a door" } else { "" };
            format!("order: first = \"{first}\", then = \"{then}\"{door}")
        }
        FactKind::Place(class) => {
            let named = spot::named_in(location, quote, *class).filter(|meant| !meant.nodes.is_empty());
            format!("place = \"{}\"", named.map_or_else(|| class.name().to_owned(), |meant| meant.name))
        }
        FactKind::RobotSays(gesture) => format!("robot: say = \"{gesture}\""),
        FactKind::RobotStart(class) => format!("robot: start = \"{}\"", class.name()),
        FactKind::RobotGoal(class) => format!("robot: goal = \"{}\"", class.name()),
        FactKind::Side { human, side } => format!("{human}: side = {}", inline(side)),
        FactKind::Facing { human, facing } => format!("{human}: facing = {}", inline(facing)),
        FactKind::GesturesTo { human, gesture, to } => format!("{human}: say = \"{gesture}\", to = \"{to}\""),
        FactKind::RobotAt { part, name, .. } => format!("robot: {} = \"{name}\"", inline(part).trim_matches('"')),
        FactKind::Reacts { .. }
        | FactKind::Relates { .. }
        | FactKind::Gestures { .. }
        | FactKind::Pace { .. }
        | FactKind::Goal { .. }
        | FactKind::MeetsAt { .. }
        | FactKind::RobotDoes(_)
        | FactKind::RobotTask(_)
        | FactKind::Asked { .. }
        | FactKind::Pattern(_) => return None,
    })
}

fn people(members: &[HumanId]) -> String {
    members.iter().map(|id| format!("\"{id}\"")).collect::<Vec<_>>().join(", ")
}

/// A rule as a step of a form; without its distance where the text leaves it open.
fn rule_text(rule: &Rule, exact: bool) -> String {
    let mut text = String::new();
    let timed: Vec<String> =
        rule.when.iter().filter(|when| **when != Trigger::Always).map(|when| moment(when, exact)).collect();
    match timed.as_slice() {
        [] => {}
        [one] => {
            text.push_str(&format!("when = {one}, "));
        }
        all => {
            text.push_str(&format!("when = [{}], ", all.join(", ")));
        }
    }
    text.push_str(&format!("act = {}", inline(&rule.act)));
    if let Some(secs) = rule.for_s {
        text.push_str(&format!(", for_s = {secs}"));
    }
    if let Some(gesture) = rule.gesture {
        text.push_str(&format!(", say = \"{gesture}\""));
    }
    text
}

fn moment(when: &Trigger, exact: bool) -> String {
    match when.distance_m() {
        Some(_) if !exact => inline(&when.clone().at_distance(0.0)).replace("0.0", "…"),
        Some(_) | None => inline(when),
    }
}

/// A value of the model as it stands within a line of TOML.
pub(crate) fn inline<T: serde::Serialize>(value: &T) -> String {
    toml::Value::try_from(value).map(|value| value.to_string()).unwrap_or_default()
}
