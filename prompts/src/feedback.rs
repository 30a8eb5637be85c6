//! Why the last answer was refused, as the author reads it.

use socrates_model::{Fault, FaultCode};

use crate::message::{Message, Role};

/// Most reasons that are given at once; more only confuse.
const MOST: usize = 8;
/// Longest refused answer that is shown again, characters.
const LONGEST: usize = 24_000;
const CLOSING: &str =
    "Keep what is correct, change only what is listed, and answer in the same form with the whole answer.";

/// What an author can do about a fault whose message is written for people.
const ADVICE: &[(FaultCode, &str)] = &[
    (
        FaultCode::PVerify,
        "expected_events: give each such human and each such fact a test in `setup` that shows it, such as `meets`, `reacts` or \
         `stands_still`, with the id of the fact as `source`",
    ),
    (FaultCode::EJson, FORM),
    (FaultCode::ESchema, FORM),
    (FaultCode::ETrunc, FORM),
    (FaultCode::EEmpty, FORM),
    (FaultCode::TOversize, FORM),
];
const FORM: &str = "the answer of the example above is complete and has the form";

/// What is said of a refused answer where no reasons are given.
const VAGUE: &str = "This answer is wrong. Try again: answer in the same form with the whole answer.";

/// The refused answer, the reasons and an example of what passes; the reasons alone where the answer is not kept; the answer alone
/// where no reasons are given.
pub(crate) fn messages(faults: &[Fault], refused: Option<&str>, example: &str) -> Vec<Message> {
    let shown = refused.map(|answer| {
        let shown: String = answer.chars().take(LONGEST).collect();
        Message::text(Role::Assistant, shown)
    });
    if faults.is_empty() {
        return shown.map_or_else(Vec::new, |answer| vec![answer, Message::text(Role::User, VAGUE)]);
    }
    let mut listed: Vec<&Fault> = Vec::new();
    // Newest last: those are the faults of the refused answer. The same one twice says nothing more.
    for fault in faults.iter().rev() {
        if !listed.contains(&fault) {
            listed.push(fault);
        }
    }
    let more = listed.len().saturating_sub(MOST);
    listed.truncate(MOST);
    listed.reverse();
    let mut text = String::new();
    for (index, fault) in listed.iter().enumerate() {
        text.push_str(&format!("{}. {}\n", index + 1, words(fault)));
    }
    for (code, advice) in ADVICE.iter().filter(|(code, _)| listed.iter().any(|fault| fault.code == *code)) {
        text.push_str(&format!("To mend {code}: {advice}.\n"));
    }
    if more > 0 {
        text.push_str(&format!("(and {more} more of the same kinds)\n"));
    }
    text.push_str(example);
    match shown {
        Some(answer) => {
            let wished = listed.iter().all(|fault| fault.code == FaultCode::PPerson);
            let opening = if wished { "A change of this answer is asked for:" } else { "This answer is refused:" };
            vec![answer, Message::text(Role::User, format!("{opening}\n{text}{CLOSING}"))]
        }
        None => vec![Message::text(Role::User, format!("Earlier answers were refused. Avoid this:\n{text}"))],
    }
}

/// A reason in words; those of a person as theirs.
fn words(fault: &Fault) -> String {
    if fault.code == FaultCode::PPerson {
        format!("The person who ordered the scenario looked at it and says: \"{}\"", fault.message)
    } else {
        fault.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_an_author_can_do_is_told_to_the_author_and_not_to_people() {
        let fault = Fault::new(FaultCode::PVerify, "fact f2", "\"runs away\" was asked for, and no clause shows it");
        let texts = messages(&[fault.clone(), fault], Some("{}"), "");
        let text = &texts.last().unwrap().text;
        assert_eq!(text.matches("To mend P-VERIFY: expected_events").count(), 1, "{text}");
        let other = messages(
            &[Fault::new(
                FaultCode::GDisc,
                socrates_model::Where::agent(socrates_model::AgentId::Robot).step(1),
                "jumps",
            )],
            Some("{}"),
            "",
        );
        assert!(!other.last().unwrap().text.contains("To mend"));
    }

    #[test]
    fn the_words_of_a_person_come_as_theirs() {
        let fault = Fault::new(FaultCode::PPerson, "proposal", "too crowded for a night");
        let text = &messages(&[fault], Some("{}"), "").last().unwrap().text.clone();
        assert!(
            text.contains("1. The person who ordered the scenario looked at it and says: \"too crowded for a night\"")
        );
        assert!(text.starts_with("A change of this answer is asked for:"), "{text}");
    }

    #[test]
    fn at_most_eight_reasons_are_given_and_none_twice() {
        let mut faults: Vec<Fault> = (0..10)
            .map(|k| {
                Fault::new(
                    FaultCode::GDisc,
                    socrates_model::Where::agent(socrates_model::AgentId::Robot).step(k),
                    "jumps",
                )
            })
            .collect();
        faults.push(faults[9].clone());
        let messages = messages(&faults, Some("{}"), "");
        let text = &messages[1].text;
        assert!(text.contains("8. G-DISC robot step 9") && !text.contains("9. G-DISC"), "{text}");
        assert!(text.contains("and 2 more"), "{text}");
    }
}
