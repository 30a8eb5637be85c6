//! The reading in one line.

use socrates_model::{FactKind, PlaceClass, Reading};

/// The reading in one line, for people to correct before anything runs:
/// `3 humans · 2 leave the elevator · 1 startled, stays · place: elevator · robot: enter elevator`.
#[must_use]
pub fn summary(reading: &Reading) -> String {
    let mut parts: Vec<String> = Vec::new();
    let total = reading.humans.len();
    match total {
        0 if reading.by.is_author() => parts.push("by the author".to_owned()),
        0 => parts.push(if reading.pattern.is_some() { "no humans" } else { "unguided" }.to_owned()),
        1 => parts.push("1 human".to_owned()),
        n => parts.push(format!("{n} humans")),
    }
    let mut alike: Vec<(String, String, usize)> = Vec::new();
    for human in reading.humans.iter().filter(|human| !human.summary.is_empty()) {
        match alike.iter_mut().find(|(text, role, _)| *text == human.summary && *role == human.role) {
            Some((_, _, count)) => *count += 1,
            None => alike.push((human.summary.clone(), human.role.clone(), 1)),
        }
    }
    let roles = reading.humans.iter().any(|human| reading.humans.first().is_some_and(|first| first.role != human.role));
    for (text, role, count) in alike {
        let who = if roles && role != "person" {
            format!(" {role}{}", if count > 1 { "s" } else { "" })
        } else {
            String::new()
        };
        parts.push(format!("{count}{who} {}", if count > 1 { plural(&text) } else { text }));
    }
    for fact in &reading.facts {
        if let FactKind::Group { members, .. } = &fact.kind {
            parts.push(format!("group of {}", members.len()));
        }
    }
    parts.extend(reading.place.map(|class| format!("place: {}", words(class))));
    let goal = reading
        .facts
        .iter()
        .find_map(|fact| if let FactKind::RobotGoal(class) = fact.kind { Some(class) } else { None });
    match goal {
        Some(PlaceClass::Elevator) => parts.push("robot: enter elevator".to_owned()),
        Some(_) | None if !reading.task.is_empty() => {
            let mut letters = reading.task.chars();
            let first: String = letters.next().into_iter().flat_map(char::to_lowercase).collect();
            parts.push(format!("robot: {first}{}", letters.as_str()));
        }
        Some(_) | None => {}
    }
    parts.join(" · ")
}

fn words(class: PlaceClass) -> String {
    crate::place::words(class)
}

/// `leaves the elevator, stays` of several: `leave the elevator, stay`.
pub(crate) fn plural(text: &str) -> String {
    let part = |part: &str| {
        let (verb, rest) = part.split_once(' ').unwrap_or((part, ""));
        let verb = match verb {
            "is" => "are".to_owned(),
            "goes" => "go".to_owned(),
            "crosses" => "cross".to_owned(),
            other => other.strip_suffix('s').map_or_else(|| other.to_owned(), str::to_owned),
        };
        if rest.is_empty() { verb } else { format!("{verb} {rest}") }
    };
    text.split(", ").map(part).collect::<Vec<_>>().join(", ")
}

/// The words of the reading's texts that were not understood, each once, as they stand there.
pub(crate) fn unread(reading: &Reading) -> Vec<&str> {
    let mut words: Vec<&str> = Vec::new();
    for statement in reading.statements.iter().filter(|statement| statement.is_unread()) {
        if !words.contains(&statement.quote.as_str()) {
            words.push(&statement.quote);
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{map, request};

    #[test]
    fn who_comes_out_where_an_elevator_opens_leaves_the_elevator() {
        let rough = "The robot waits for an elevator. When the doors open, a few people exit, and one person gets \
                     startled by the robot and stays inside the elevator.";
        let reading = crate::read(&request("Deliver medical supplies to a ward", Some(rough)), &map("hospital"));
        let line = summary(&reading);
        assert!(line.contains(" leave the elevator · ") && !line.contains("room"), "{line}");
    }
}
