//! The robot's task: from where, to where, and what is only said.

use socrates_model::PlaceClass;

use crate::clause;
use crate::cut::sentences;
use crate::lexicon::lexicon;

/// What was read of the task.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Task {
    pub(crate) start: Option<(PlaceClass, String)>,
    pub(crate) goal: Option<(PlaceClass, String)>,
    pub(crate) via: Option<(PlaceClass, String)>,
    /// Words that ask for the way back.
    pub(crate) back: Option<String>,
    pub(crate) ignored: Vec<String>,
}

/// Reads a task such as `Take the elevator to deliver supplies` or `Bring mail from the lobby to the kitchen`.
pub(crate) fn read(text: &str) -> Task {
    let mut task = Task::default();
    for mut stretch in sentences(text).into_iter().flatten() {
        let quote = stretch.quote(text).to_owned();
        let found = clause::read(&mut stretch);
        // `deliver mail and return (to the desk)`: the second errand; `return the cup to the kitchen` is the first.
        let comes_back = |i: usize| {
            let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
            let last = matches!(text(i + 1), "" | "to" | "back" | "home" | "again");
            matches!(text(i), "return" | "returns" | "returning") && last
                || matches!(text(i), "come" | "comes" | "go" | "goes" | "coming") && text(i + 1) == "back"
        };
        if let Some(at) = (0..stretch.words.len()).find(|i| comes_back(*i)) {
            task.back.get_or_insert_with(|| quote.clone());
            for word in stretch.words.iter_mut().skip(at).take(2) {
                word.used = true;
            }
            continue;
        }
        for (class, at) in found.places {
            let before: Vec<&str> = (1..=3)
                .filter_map(|back| at.checked_sub(back))
                .filter_map(|i| stretch.words.get(i))
                .map(|word| word.text.as_str())
                .collect();
            let near = |names: &[&str]| before.iter().position(|word| names.contains(word));
            let (from, to, via) = (
                near(&["from"]),
                near(&["to", "into", "at", "reach", "towards", "toward"]),
                near(&["via", "through", "along", "past"]),
            );
            let rides = class == PlaceClass::Elevator && near(&["take", "use", "ride", "enter", "the", "an"]).is_some();
            let slot = match (from, to, via) {
                (Some(from), Some(to), _) if from < to => &mut task.start,
                (Some(_), None, _) => &mut task.start,
                (None, None, Some(_)) => &mut task.via,
                (_, Some(_), _) => &mut task.goal,
                (None, None, None) if rides => &mut task.goal,
                (None, None, None) => &mut task.via,
            };
            if slot.is_none() {
                *slot = Some((class, quote.clone()));
            }
        }
        for word in stretch.words {
            let lex = lexicon();
            let known =
                [&lex.stop, &lex.task].iter().any(|table| table.contains(&word.text) || table.contains(&word.stem));
            if !word.used && !known && word.stem != "robot" && !task.ignored.contains(&word.text) {
                task.ignored.push(word.text);
            }
        }
    }
    task
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn start_goal_and_leftovers_are_told_apart() {
        let task = read("Take the elevator to deliver supplies");
        assert_eq!(task.goal.unwrap().0, PlaceClass::Elevator);
        assert_eq!(task.ignored, ["supplies"]);
        let task = read("Bring mail from the exit to the meeting room via the corridor");
        assert_eq!(task.start.unwrap().0, PlaceClass::Exit);
        assert_eq!(task.goal.unwrap().0, PlaceClass::Room);
        assert_eq!(task.via.unwrap().0, PlaceClass::Corridor);
        let task = read("Deliver mail to the kitchen and come back to the exit");
        assert_eq!((task.goal.unwrap().0, task.back.as_deref()), (PlaceClass::Room, Some("come back to the exit")));
        assert_eq!(read("Return the cup to the kitchen").back, None);
        let task = read("Deliver coffee from one corner of the warehouse to another.");
        assert_eq!(task.start, None);
    }
}
