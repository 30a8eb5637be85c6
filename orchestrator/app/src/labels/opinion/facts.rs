//! The facts of a run that a second opinion is asked about: the sentences of its request, as blind judges are asked about them, and the
//! lines of a form in words.

use socrates_draw::fact_words;
use socrates_model::report::{ClauseResult, Standing};
use socrates_model::statement::{Became, Statement};
use socrates_model::{Fact, FactKind, Reading, Request};
use socrates_prompts::{Sentence, sentences};

/// A fact to ask about.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Asked {
    /// What is asked: a sentence of the request, or a line of its form in words.
    pub(super) words: String,
    /// The words of the request that it stands for.
    pub(super) quote: String,
    /// What these very words say, as they were read.
    pub(super) kinds: Vec<FactKind>,
    /// Whether the program finds it in the run; nothing where it does not judge it.
    pub(super) program: Option<bool>,
}

/// The facts that a request asks for, in its order; of the program's judgment only where clauses of a run are given.
pub(super) fn facts(request: &Request, reading: &Reading, clauses: &[ClauseResult]) -> Vec<Asked> {
    let all = sentences(request);
    let mut found: Vec<Asked> = all.iter().filter_map(|sentence| of_sentence(sentence, reading, clauses)).collect();
    for fact in reading.facts.iter().filter(|fact| !fact.quote.is_empty() && is_seen(fact)) {
        let of_text = all.iter().any(|sentence| says(&sentence.quote, &fact.quote))
            || reading.statements.iter().any(|piece| became(piece, &fact.id));
        let words = fact_words(&fact.kind);
        let unsaid = matches!(fact.kind, FactKind::Asked { .. });
        if of_text || unsaid || found.iter().any(|one| one.words == words) {
            continue;
        }
        let program = judged(&[fact.id.as_str()], clauses);
        found.push(Asked { words, quote: fact.quote.clone(), kinds: vec![fact.kind.clone()], program });
    }
    found
}

/// Whether pictures can show what a fact says.
const fn is_seen(fact: &Fact) -> bool {
    !matches!(fact.kind, FactKind::RobotTask(_) | FactKind::Pattern(_))
}

/// A sentence, where anything of it is a wish.
fn of_sentence(sentence: &Sentence, reading: &Reading, clauses: &[ClauseResult]) -> Option<Asked> {
    let mut pieces: Vec<&Statement> = Vec::new();
    pieces.extend(reading.statements.iter().filter(|piece| piece.meets(sentence.at, sentence.span)));
    let named = |fact: &Fact| pieces.iter().any(|piece| became(piece, &fact.id));
    let of = |is: &dyn Fn(&Fact) -> bool| -> Vec<&Fact> {
        reading.facts.iter().filter(|fact| is_seen(fact) && is(fact)).collect()
    };
    // Sentences about one person may be read as one, with the facts of all of them: what the words say themselves comes first, and
    // nothing else is ever planted.
    let own = of(&|fact| says(&sentence.quote, &fact.quote));
    let kinds = own.iter().map(|fact| fact.kind.clone()).collect();
    let own = if own.is_empty() { of(&named) } else { own };
    let is_wish = |piece: &&Statement| piece.is_unplayed() || matches!(piece.became, Became::Read { .. });
    if own.is_empty() && !pieces.iter().any(is_wish) {
        return None;
    }
    let ids: Vec<&str> = own.iter().map(|fact| fact.id.as_str()).collect();
    let unplayed = pieces.iter().any(|piece| piece.is_unplayed());
    Some(Asked {
        words: sentence.shown.clone(),
        quote: sentence.quote.clone(),
        kinds,
        program: if unplayed { Some(false) } else { judged(&ids, clauses) },
    })
}

/// Whether a sentence has the words of a fact: one quote, or several with commas between them.
fn says(sentence: &str, quote: &str) -> bool {
    !quote.is_empty() && (sentence.contains(quote) || quote.split(", ").all(|part| sentence.contains(part)))
}

/// Whether a piece of a text became a fact of the reading.
fn became(piece: &Statement, id: &str) -> bool {
    matches!(&piece.became, Became::Read { facts, .. } if facts.iter().any(|fact| fact == id))
}

/// Whether every clause of these facts holds; nothing where none of them was judged.
fn judged(ids: &[&str], clauses: &[ClauseResult]) -> Option<bool> {
    let mut holds = None;
    for clause in clauses.iter().filter(|clause| clause.must && ids.contains(&clause.source.as_str())) {
        match clause.standing {
            Standing::Holds | Standing::Late => holds = Some(holds.unwrap_or(true)),
            Standing::Fails | Standing::NotTriggered => holds = Some(false),
            Standing::NotApplicable => {}
        }
    }
    holds
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn request(rough: &str) -> Request {
        let value = json!({"location": "x", "social_context": "A hall.", "task": "Go on", "rough_scenario": rough});
        serde_json::from_value(value).unwrap()
    }

    fn reading(facts: serde_json::Value, statements: serde_json::Value) -> Reading {
        let value = json!({"format": 1, "humans": [], "task": "", "facts": facts, "statements": statements, "notes": [], "problems": []});
        serde_json::from_value(value).unwrap()
    }

    fn clause(source: &str, standing: &str) -> ClauseResult {
        let value = json!({"id": "c", "text": "", "role": "setup", "must": true, "source": source, "standing": standing,
            "margin": 0.0, "times_s": [], "evidence": ""});
        serde_json::from_value(value).unwrap()
    }

    fn statement(at: &str, from: usize, quote: &str, became: serde_json::Value) -> serde_json::Value {
        json!({"at": at, "span": {"from": from, "to": from + quote.chars().count()}, "quote": quote, "became": became})
    }

    #[test]
    fn sentences_are_asked_about_and_background_is_not() {
        let rough = "A nurse waits at the door. It is a gray day. She says stop.";
        let read = reading(
            json!([
                {"id": "f1", "quote": "A nurse", "kind": {"humans": 1}},
                {"id": "f2", "quote": "A nurse waits", "kind": {"relates": {"human": "human_1", "relation": "static"}}},
                {"id": "f3", "quote": "She says stop", "kind": {"gestures": {"human": "human_1", "gesture": "PROCEED"}}},
                {"id": "f4", "quote": "Go on", "kind": {"robot_task": "Go on"}},
            ]),
            json!([
                statement(
                    "rough_scenario",
                    0,
                    "A nurse waits at the door",
                    json!({"read": {"lines": [], "facts": ["f2"]}})
                ),
                statement("rough_scenario", 27, "It is a gray day", json!({"background": "setting"})),
                statement("rough_scenario", 45, "She says stop", json!({"read": {"lines": [], "facts": ["f3"]}})),
                statement("task", 0, "Go on", json!({"background": "errand"})),
                statement("social_context", 0, "A hall", json!({"background": "setting"})),
            ]),
        );
        let clauses = [clause("f1", "holds"), clause("f2", "late"), clause("f3", "not_triggered")];
        let found = facts(&request(rough), &read, &clauses);
        let told: Vec<(&str, Option<bool>)> = found.iter().map(|one| (one.words.as_str(), one.program)).collect();
        assert_eq!(told, [("A nurse waits at the door.", Some(true)), ("She says stop.", Some(false))]);
        assert_eq!(found[0].kinds.len(), 2);
        assert_eq!(facts(&request(rough), &read, &[])[0].program, None, "nothing was judged");
    }

    #[test]
    fn two_sentences_about_one_person_keep_their_own_facts() {
        let rough = "A nurse comes in. She flees when she sees it.";
        let rule = json!({"when": [{"robot_visible": 3.0}], "act": "run_away"});
        let both = json!({"read": {"lines": [], "facts": ["f1", "f2"]}});
        let read = reading(
            json!([
                {"id": "f1", "quote": "A nurse comes in", "kind": {"relates": {"human": "human_1", "relation": "frontal"}}},
                {"id": "f2", "quote": "She flees, she sees it", "kind": {"reacts": {"human": "human_1", "rule": rule}}},
            ]),
            json!([
                statement("rough_scenario", 0, "A nurse comes in", both.clone()),
                statement("rough_scenario", 18, "She flees when she sees it", both),
            ]),
        );
        let found = facts(&request(rough), &read, &[clause("f1", "holds"), clause("f2", "fails")]);
        let told: Vec<(&str, Option<bool>, usize)> =
            found.iter().map(|one| (one.words.as_str(), one.program, one.kinds.len())).collect();
        assert_eq!(told, [("A nurse comes in.", Some(true), 1), ("She flees when she sees it.", Some(false), 1)]);
    }

    #[test]
    fn what_is_not_played_is_asked_about_and_the_program_does_not_find_it() {
        let rough = "Two workers dance on the table.";
        let why = json!({"not_played": {"why": "nobody dances"}});
        let read = reading(json!([]), json!([statement("rough_scenario", 0, rough, why)]));
        let found = facts(&request(rough), &read, &[]);
        assert_eq!((found.len(), found[0].program), (1, Some(false)));
    }

    #[test]
    fn lines_of_a_form_are_told_in_words_and_defaults_are_not_asked() {
        let relates = |human: &str| json!({"relates": {"human": human, "relation": "leaving"}});
        let read = reading(
            json!([
                {"id": "f1", "quote": "relation = \"leaving\"", "kind": relates("human_1")},
                {"id": "f2", "quote": "relation = \"leaving\"", "kind": relates("human_2")},
                {"id": "f3", "quote": "", "kind": {"place": "elevator"}},
            ]),
            json!([]),
        );
        let found = facts(&request(""), &read, &[clause("f2", "holds")]);
        let told: Vec<(&str, Option<bool>)> = found.iter().map(|one| (one.words.as_str(), one.program)).collect();
        let out = "comes out as the robot arrives";
        assert_eq!(told, [(&*format!("human_1 {out}"), None), (&*format!("human_2 {out}"), Some(true))]);
    }
}
