//! What would pass in place of a refused answer, for the author that is asked again.

use std::collections::BTreeMap;

use serde::Serialize;
use socrates_checks::passing_proposal;
use socrates_model::FaultCode;
use socrates_model::fault::hard;
use socrates_model::job::Stage;
use socrates_prompts::{Account, Passing, Question};

use crate::attempt::{AsRead, Written, check, checked, read};
use crate::{account, compiled, paths_by};

/// The question with an example of what passes, where an answer was refused and the program finds one: the refused proposal made right,
/// the solver's paths, the trees of the proposal's rules. It has passed the checks itself. None where there is nothing to show.
pub(crate) fn shown(question: &Question) -> Option<Question> {
    // What a person wishes of an answer no check knows.
    if question.feedback.iter().all(|fault| fault.code == FaultCode::PPerson) {
        return None;
    }
    Some(Question { passing: Some(passing(question)?), ..question.clone() })
}

fn passing(question: &Question) -> Option<Passing> {
    match (question.stage, &question.proposal) {
        (Stage::Proposal, _) => proposal(question),
        (Stage::Paths, Some(proposal)) => taken(&paths_by::answer(question, proposal), question),
        (Stage::Behaviors, Some(proposal)) => taken(&compiled::answer(question, proposal), question),
        (Stage::Paths | Stage::Behaviors, None) => None,
        (Stage::Simulation | Stage::Scoring | Stage::Review, _) => None,
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
    Some(Passing { answer: answer?, reading: BTreeMap::new() })
}

fn full(artifact: &impl Serialize) -> Option<String> {
    serde_json::to_string(artifact).ok()
}

/// The refused proposal with its account made right first, as facts are read from it.
fn proposal(question: &Question) -> Option<Passing> {
    let (written, told) = read(question.refused.as_deref()?, question).ok()?;
    let Written::Proposal(bad) = &written else { return None };
    // The program does not know what else a scenario could mean.
    if told.as_ref().is_some_and(|told| told.scenario.is_some()) {
        return None;
    }
    let told = told.map(|told| told.account);
    let mended = told.as_ref().map(|told| account::mended(told, question));
    let as_read = mended.clone().map(|account| AsRead { account, scenario: None });
    let reading = checked(&written, as_read.as_ref(), question).0.unwrap_or_else(|| question.reading.clone());
    let good = passing_proposal(bad, &reading, &question.location, &question.request.task)?;
    let faults = checked(&Written::Proposal(good.clone()), as_read.as_ref(), question).1;
    if !hard(&faults).is_empty() {
        return None;
    }
    let reading = mended.zip(told).map(|(mended, told)| changed(&told, &mended)).unwrap_or_default();
    Some(Passing { answer: full(&good)?, reading })
}

/// The lines of each sentence of which the two say something else.
fn changed(before: &Account, after: &Account) -> BTreeMap<String, Vec<String>> {
    after
        .0
        .iter()
        .filter(|(id, share)| before.0.get(*id) != Some(share))
        .map(|(id, share)| (id.clone(), share.lines()))
        .collect()
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
                    // Of an account only what is changed is there.
                    if !question.reading.by.is_author() || question.stage != Stage::Proposal {
                        let (written, _) = read(&passing.answer, question).unwrap();
                        assert_eq!(hard(&check(&written, question)), [], "{kind:?}");
                    }
                    seen.insert(kind);
                }
            }
        }
        assert_eq!(without, Vec::<String>::new());
        let wanted =
            FaultKind::ALL.iter().filter(|kind| matches!(kind.code().family(), Family::Proposal | Family::Paths));
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
