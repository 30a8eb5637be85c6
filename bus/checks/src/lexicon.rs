//! Words that give away a behavior which cannot be simulated.
//!
//! Humans of the simulation walk, stop, turn and gesture. They have no hands and do not look at each
//! other. The lists are closed and short on purpose: a word is here only when nobody would use it
//! for something that can be simulated.

/// What a human can do, for messages.
pub(crate) const ABILITIES: &str = "walk their path, stand still, stop and look at the robot, follow the robot or another human, \
     run away from the robot, give way, block the robot, come up to the robot, and make the gestures WAIT, PROCEED, \
     ACKNOWLEDGED, EXCUSE_ME, FOLLOW_ME";

/// Phrases for handling things, each in the forms a description uses.
const HANDLING: &[&str] = &[
    "pick up",
    "picks up",
    "picking up",
    "put down",
    "puts down",
    "lift up",
    "lifts up",
    "lifts the",
    "lifts a",
    "grab",
    "grabs",
    "grabbing",
    "grasp",
    "grasps",
    "hand over",
    "hands over",
    "opens the",
    "opens a",
    "open the door",
    "closes the",
    "close the door",
    "push",
    "pushes",
    "pushing",
    "pull",
    "pulls",
    "pulling",
    "throw",
    "throws",
    "press the",
    "presses the",
    "presses a",
    "sit down",
    "sits",
    "sitting",
    "lie down",
    "lies down",
    "kneel",
    "kneels",
    "climb",
    "climbs",
    "jump",
    "jumps",
    "point at",
    "points at",
    "points to",
    "pointing at",
    "shake hands",
    "shakes hands",
    "touch the robot",
    "touches the robot",
    "touches it",
    "takes a photo",
    "takes a picture",
    "films the robot",
    "types on",
    "reads a",
    "drinks",
    "eats",
    "unloads",
    "loads the",
];

/// Words that turn the phrase after them round, so that it asks for nothing.
const NEGATIONS: &[&str] = &["not", "never", "without", "nor", "n't", "cannot"];

/// The phrases of a behavior that cannot be simulated, as written, in order.
pub(crate) fn impossible(text: &str) -> Vec<&'static str> {
    let words = spaced(text);
    let mut found: Vec<(usize, &'static str)> = Vec::new();
    for phrase in HANDLING {
        let Some(at) = words.find(&format!(" {phrase} ")) else { continue };
        let negated = words.get(..at).is_some_and(|before| {
            before
                .split_whitespace()
                .rev()
                .take(3)
                .any(|word| NEGATIONS.iter().any(|no| word == *no || word.ends_with("n't")))
        });
        if !negated && !found.iter().any(|(other, _)| *other == at) {
            found.push((at, phrase));
        }
    }
    found.sort_unstable();
    found.into_iter().map(|(_, phrase)| phrase).collect()
}

/// Numbers of the humans a text names as `human_2`, `human 2` or `Human2`, each once.
pub(crate) fn humans_named(text: &str) -> Vec<u32> {
    let mut numbers = Vec::new();
    let words = spaced(&text.replace('_', " "));
    let mut walk = words.split_whitespace().peekable();
    while let Some(word) = walk.next() {
        let Some(rest) = word.strip_prefix("human") else { continue };
        let digits = if rest.is_empty() { walk.peek().copied().unwrap_or("") } else { rest };
        if let Some(number) = digits.parse::<u32>().ok().filter(|number| *number > 0)
            && !numbers.contains(&number)
        {
            numbers.push(number);
        }
    }
    numbers
}

/// Whether the text holds these words side by side.
pub(crate) fn says(text: &str, phrase: &str) -> bool {
    spaced(text).contains(&format!(" {phrase} "))
}

/// Lower-case words with one blank before, between and after them.
fn spaced(text: &str) -> String {
    let mut words = String::from(" ");
    for letter in text.chars() {
        if letter.is_alphanumeric() || matches!(letter, '_' | '\'' | '-') {
            words.extend(letter.to_lowercase());
        } else if !words.ends_with(' ') {
            words.push(' ');
        }
    }
    if !words.ends_with(' ') {
        words.push(' ');
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn handling_is_found_and_a_denial_is_not() {
        assert_eq!(impossible("Walks in, picks up a box and pushes the cart."), ["picks up", "pushes"]);
        assert!(impossible("Walks on and does not push the robot.").is_empty());
        assert!(impossible("Follows the robot, then stands still as the door opens.").is_empty());
    }

    #[test]
    fn humans_are_found_in_every_spelling() {
        assert_eq!(humans_named("human_2 waits for Human 3; human2 again, humans talk"), [2, 3]);
    }
}
