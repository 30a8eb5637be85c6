//! The four case studies as forms, as `docs/form.md` writes them: they show the same items as the texts, and each way in which they
//! can go wrong is refused.

use std::path::Path;

use socrates_app::config::Config;
use socrates_app::prepare::{Prepared, prepare_text};
use socrates_model::act::ACTS;
use socrates_model::rule::{ROBOT_MOMENTS, TRIGGERS};

use super::{FEW, MANY, corridor, elevator, group, intersection, study_of};

/// The page with the forms.
const PAGE: &str = "docs/form.md";
/// Longest form of a case study, lines that are not empty.
const LINES: usize = 20;

/// The form of a case study: the first block of the page that names its location and holds these words.
fn stated(name: &str, words: &str) -> Prepared {
    let page = std::fs::read_to_string(socrates_tests::root().join(PAGE)).unwrap();
    let blocks = page.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next());
    let text = blocks.into_iter().find(|block| block.contains("location") && block.contains(words)).unwrap();
    let lines = text.lines().filter(|line| !line.trim().is_empty()).count();
    assert!(lines <= LINES, "{name}: {lines} lines");
    let config = Config::load(None, std::iter::empty(), &[]).unwrap();
    let prepared = prepare_text(name, text, name, Path::new("."), None, &config).unwrap();
    assert_eq!(prepared.reading.problems, [], "{name}");
    prepared
}

#[test]
fn every_word_of_steps_and_moments_stands_on_the_page() {
    let page = std::fs::read_to_string(socrates_tests::root().join(PAGE)).unwrap();
    let acts = ACTS.iter().map(|act| (act.word, act.argument));
    let moments = TRIGGERS.iter().chain(ROBOT_MOMENTS).map(|moment| (moment.word, moment.argument));
    for (word, argument) in acts.chain(moments) {
        let written = if argument.is_empty() {
            [format!("`{word}`"), format!("\"{word}\"")]
        } else {
            [format!("{{ {word} = "), String::from("\0")]
        };
        assert!(written.iter().any(|form| page.contains(form)), "{PAGE} lacks {}", written[0]);
    }
}

#[tokio::test]
async fn the_elevator_as_a_form() {
    study_of(stated("elevator", "Take the elevator"), elevator::items, elevator::KINDS, FEW).await;
}

#[tokio::test]
#[ignore = "sweep: 20 seeds"]
async fn the_elevator_as_a_form_over_twenty_seeds() {
    study_of(stated("elevator", "Take the elevator"), elevator::items, elevator::KINDS, MANY).await;
}

#[tokio::test]
async fn the_corridor_as_a_form() {
    study_of(stated("corridor", "Deliver a parcel"), corridor::items, corridor::KINDS, FEW).await;
}

#[tokio::test]
#[ignore = "sweep: 20 seeds"]
async fn the_corridor_as_a_form_over_twenty_seeds() {
    study_of(stated("corridor", "Deliver a parcel"), corridor::items, corridor::KINDS, MANY).await;
}

#[tokio::test]
async fn the_intersection_as_a_form() {
    study_of(stated("intersection", "Bring the mail"), intersection::items, intersection::KINDS, FEW).await;
}

#[tokio::test]
#[ignore = "sweep: 20 seeds"]
async fn the_intersection_as_a_form_over_twenty_seeds() {
    study_of(stated("intersection", "Bring the mail"), intersection::items, intersection::KINDS, MANY).await;
}

#[tokio::test]
async fn the_group_as_a_form() {
    study_of(stated("group", "Carry a box"), group::items, group::KINDS, FEW).await;
}

#[tokio::test]
#[ignore = "sweep: 20 seeds"]
async fn the_group_as_a_form_over_twenty_seeds() {
    study_of(stated("group", "Carry a box"), group::items, group::KINDS, MANY).await;
}
