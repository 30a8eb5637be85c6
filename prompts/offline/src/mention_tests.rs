//! Whom mentions speak of.

use crate::cut::sentences;
use crate::mention::{Who, mentions};

fn who(text: &str) -> Vec<Who> {
    mentions(&sentences(text)[0][0].words).into_iter().map(|mention| mention.who).collect()
}

#[test]
fn counts_are_read_from_nouns_for_people_only() {
    assert_eq!(who("two busy employees walk"), [Who::New { count: Some(2), article: false }]);
    assert_eq!(
        who("a few people"),
        [Who::New { count: Some(3), article: false }].map(|_| Who::New { count: Some(3), article: false })
    );
    assert_eq!(who("a group of 4 employees talking"), [Who::New { count: Some(4), article: true }]);
    assert_eq!(who("the robot drives to room 214"), []);
    assert_eq!(who("the robot passes rack 7"), []);
    assert_eq!(who("during the night shift of 12"), []);
    assert_eq!(who("within 3 m of the robot"), []);
}

#[test]
fn references_are_told_from_new_people() {
    assert_eq!(who("2 leave the elevator"), [Who::Bare(2)]);
    assert_eq!(who("one of them stays"), [Who::PartOf(1)]);
    assert_eq!(who("other one follows the robot"), [Who::Other(Some(1))]);
    assert_eq!(who("the others wait"), [Who::Other(None)]);
    assert_eq!(who("the second person stops"), [Who::Ordinal(2)]);
    assert_eq!(who("human 2 stops"), [Who::Number(2)]);
    assert_eq!(who("another nurse waits"), [Who::More(1)]);
    assert_eq!(who("no people are there"), [Who::Nobody]);
    assert_eq!(who("both stop"), [Who::All]);
}
