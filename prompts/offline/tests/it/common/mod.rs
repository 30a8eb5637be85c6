//! What the tests of whole questions share.

use socrates_prompts::Question;

/// What is read of a rough scenario on a shipped map, with what became of its words.
pub(crate) fn reading(on: &str, rough: &str) -> socrates_model::Reading {
    let question = question(on, rough);
    socrates_offline::read(&question.request, &question.location)
}

/// The question for a proposal on a shipped map, as the stages would ask it; without a text it is unguided.
pub(crate) fn question<'a>(on: &str, rough: impl Into<Option<&'a str>>) -> Question {
    let request: socrates_model::Request = serde_json::from_value(serde_json::json!({
        "location": on, "social_context": "", "task": "Deliver mail", "rough_scenario": rough.into(),
    }))
    .unwrap();
    let location = socrates_maps::shipped::load(on).unwrap();
    let reading = socrates_offline::understood(&request, &location);
    Question::first(request, reading, location, 3)
}
