//! What would pass in place of a refused answer, for the author that is asked again.

use std::borrow::Cow;

use serde::Serialize;
use socrates_model::FaultCode;
use socrates_model::fault::hard;
use socrates_model::job::Stage;
use socrates_prompts::{Mode, Passing, Question};

use crate::attempt::{Written, check, read};
use crate::{compiled, paths_by};

/// The question as a model is asked it, live and recorded: with an example of what passes where there is one. The naive baseline is shown
/// nothing but its own answer.
pub(crate) fn asked(question: &Question, mode: Mode) -> Cow<'_, Question> {
    let shown = if mode == Mode::Naive { None } else { shown(question) };
    shown.map_or(Cow::Borrowed(question), Cow::Owned)
}

/// The question with an example of what passes, where an answer was refused and the program finds one: the solver's paths, the trees of
/// the proposal's rules. It has passed the checks itself. None where there is nothing to show.
fn shown(question: &Question) -> Option<Question> {
    // What a person wishes of an answer no check knows.
    if question.feedback.iter().all(|fault| fault.code == FaultCode::PPerson) {
        return None;
    }
    Some(Question { passing: Some(passing(question)?), ..question.clone() })
}

fn passing(question: &Question) -> Option<Passing> {
    match (question.stage, &question.proposal) {
        (Stage::Paths, Some(proposal)) => taken(&paths_by::answer(question, proposal), question),
        (Stage::Behaviors, Some(proposal)) => taken(&compiled::answer(question, proposal), question),
        (Stage::Paths | Stage::Behaviors, None) => None,
        // The program does not know what else a scenario could mean.
        (Stage::Proposal | Stage::Simulation | Stage::Scoring | Stage::Review, _) => None,
    }
}

/// An answer in full form, where the checks take it.
fn taken(text: &str, question: &Question) -> Option<Passing> {
    let (written, _) = read(text, question).ok()?;
    if !hard(&check(&written, question)).is_empty() {
        return None;
    }
    let answer = match &written {
        Written::Proposal(proposal) => full(proposal),
        Written::Paths(paths) => full(paths),
        Written::Behaviors(behaviors) => full(behaviors),
    };
    Some(Passing { answer: answer? })
}

fn full(artifact: &impl Serialize) -> Option<String> {
    serde_json::to_string(artifact).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    use crate::attempt::attempt;
    use crate::author::Says;
    use crate::confusion::answers;
    use crate::fault_model::FaultKind;
    use crate::mutate;
    use crate::offline::Offline;
    use crate::testing;
    use serde_json::json;
    use socrates_model::{Family, Request};

    /// Requests with people of each kind: alone, in groups, with signs, without a rough scenario.
    const ROUGH: [&str; 4] = [
        "It is a busy morning. A visitor comes towards the robot in the corridor and stops when the robot is near.",
        "A group of three people stands and talks in the corridor. One person is afraid and runs away from the robot.",
        "A nurse crosses the robot's way at an intersection. When the nurse sees the robot, the nurse gestures WAIT. A visitor stops when \
         the nurse gestures WAIT.",
        "",
    ];

    /// First questions of every request, read by its author and by the grammar.
    fn questions() -> Vec<Question> {
        let location = socrates_maps::shipped::load("office").unwrap();
        let request = |rough: &str| -> Request {
            let mut request =
                json!({"location": "office", "social_context": "An office.", "task": "Drive to the exit."});
            if !rough.is_empty() {
                request["rough_scenario"] = json!(rough);
            }
            serde_json::from_value(request).unwrap()
        };
        let both = |rough: &str| {
            let request = request(rough);
            [socrates_offline::stated(&request, &location), socrates_offline::read(&request, &location)]
                .map(|reading| Question::first(request.clone(), reading, location.clone(), 5))
        };
        ROUGH.into_iter().flat_map(both).collect()
    }

    #[tokio::test]
    async fn whatever_is_refused_comes_back_with_an_answer_that_passes() {
        let (mut seen, mut without) = (BTreeSet::new(), Vec::new());
        for first in questions() {
            for clean in answers(&Offline, &first).await {
                let question = &clean.question;
                if question.stage == Stage::Proposal {
                    continue;
                }
                for (draw, kind) in (0_u64..).zip(FaultKind::ALL.iter().copied()) {
                    if matches!(kind.code().family(), Family::Answer | Family::Transport) {
                        continue;
                    }
                    let Some(bad) = mutate::apply(kind, question, &clean.answer, draw) else { continue };
                    let Err(refused) = attempt(&Says(bad), question).await else { continue };
                    let codes: Vec<&str> = refused.faults.iter().map(|fault| fault.code.code()).collect();
                    // What can no longer be read has the worked example of the question.
                    if codes.iter().any(|code| code.starts_with("E-")) {
                        continue;
                    }
                    let asked =
                        Question { feedback: refused.faults.clone(), refused: refused.text, ..question.clone() };
                    let Some(passing) = shown(&asked).and_then(|shown| shown.passing) else {
                        without.push(format!("{kind:?} {codes:?}"));
                        continue;
                    };
                    let (written, _) = read(&passing.answer, question).unwrap();
                    assert_eq!(hard(&check(&written, question)), [], "{kind:?}");
                    seen.insert(kind);
                }
            }
        }
        assert_eq!(without, Vec::<String>::new());
        let wanted = FaultKind::ALL.iter().filter(|kind| kind.code().family() == Family::Paths);
        // Ways that meet at another kind of place fail other checks first on this map.
        let never: Vec<&FaultKind> =
            wanted.filter(|kind| !seen.contains(*kind) && **kind != FaultKind::Gtype).collect();
        assert_eq!(never, Vec::<&FaultKind>::new(), "of {seen:?}");
    }

    #[tokio::test]
    async fn a_first_question_has_no_example() {
        assert_eq!(shown(&testing::question(Stage::Paths)), None);
    }
}
