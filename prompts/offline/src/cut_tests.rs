//! Sentences cut into clauses.

use crate::cut::{Joint, sentences};

fn cuts(text: &str) -> Vec<(Joint, String)> {
    sentences(text).into_iter().flatten().map(|s| (s.joint, s.quote(text).to_owned())).collect()
}

#[test]
fn a_sentence_is_cut_at_commas_and_joining_words() {
    let cut = cuts("Two leave, and one stays when it sees the robot. Done!");
    assert_eq!(
        cut,
        [
            (Joint::Opens, "Two leave".to_owned()),
            (Joint::And, "one stays".to_owned()),
            (Joint::When, "it sees the robot".to_owned()),
            (Joint::Opens, "Done".to_owned()),
        ]
    );
}

#[test]
fn numbers_units_and_apostrophes_are_taken_apart() {
    let words: Vec<String> = sentences("within 1.5m, 10,000 people don't; human_2's")
        .into_iter()
        .flatten()
        .flat_map(|s| s.words)
        .map(|w| w.text)
        .collect();
    assert_eq!(words, ["within", "1.5", "m", "10000", "people", "do", "not", "human", "2"]);
}

#[test]
fn a_clause_begins_where_somebody_else_does_something() {
    let cut = cuts("As soon as she sees the robot she signals it to wait");
    assert_eq!(
        cut,
        [(Joint::When, "she sees the robot".to_owned()), (Joint::Comma, "she signals it to wait".to_owned())]
    );
    let cut = cuts("On seeing the robot halts a visitor");
    assert_eq!(cut, [(Joint::When, "seeing the robot".to_owned()), (Joint::Comma, "halts a visitor".to_owned())]);
}

#[test]
fn manners_come_after_whose_they_are_and_names_beside_names() {
    let cut = cuts("Walking ahead of the robot, a couple talks.");
    assert_eq!(
        cut,
        [(Joint::Comma, "a couple talks".to_owned()), (Joint::Comma, "Walking ahead of the robot".to_owned())]
    );
    let text = "The cleaner, a shy man, stands still.";
    let found = sentences(text);
    assert_eq!(found[0].len(), 1);
    let also: Vec<&str> = found[0][0].also.iter().map(|word| word.text.as_str()).collect();
    assert_eq!(also, ["a", "shy", "man"]);
    assert_eq!(cuts("A doctor, a nurse and a patient wait").len(), 3);
}

#[test]
fn numbers_of_headings_and_times_of_day_count_nothing() {
    for text in ["Test case 14: a nurse waits", "Study 2: a nurse waits", "At 14:30 a nurse waits"] {
        let counts = sentences(text).into_iter().flatten().flat_map(|s| s.words).filter(|w| w.count().is_some());
        assert_eq!(counts.count(), 0, "{text}");
    }
}

#[test]
fn any_text_is_cut_without_breaking() {
    for text in ["", "…", "'''", "1.2.3,,,4", "ß’t né", "\u{202e}and and and", "- -- —"] {
        let _cut = sentences(text);
    }
}
