//! One attempt: ask, read, check. Once.

use serde::{Deserialize, Serialize};
use socrates_checks::{check_behaviors, check_paths, check_proposal};
use socrates_model::fault::hard;
use socrates_model::job::Stage;
use socrates_model::{Behaviors, Digest, FORMAT, FailureClass, Fault, FaultCode, Paths, Proposal, Reading, Scenario};
use socrates_prompts::{
    Account, Message, Question, json, parse_account, parse_behaviors, parse_paths, parse_proposal, parse_scenario,
    scenario,
};

use crate::author::{Answer, AskError, Author, How};
use crate::{account, stated, variants};

/// What an author wrote, typed.
#[derive(Debug, Clone, PartialEq)]
pub enum Written {
    /// Answer of the proposal stage.
    Proposal(Proposal),
    /// Answer of the paths stage.
    Paths(Paths),
    /// Answer of the behaviors stage.
    Behaviors(Behaviors),
}

impl Written {
    /// Short words for the status line: `2 people`, `8 nodes · 2 encounters`, `2 trees`.
    #[must_use]
    pub fn remark(&self) -> String {
        let some = |count: usize, one: &str, many: &str| format!("{count} {}", if count == 1 { one } else { many });
        match self {
            Self::Proposal(proposal) => some(proposal.humans.len(), "person", "people"),
            Self::Paths(paths) => format!(
                "{} · {}",
                some(paths.robot.len(), "node", "nodes"),
                some(paths.encounters.len(), "encounter", "encounters")
            ),
            Self::Behaviors(behaviors) => some(behaviors.humans.len(), "tree", "trees"),
        }
    }

    /// Trees that an author wrote as XML are written anew from what was read and checked: nothing that the checks did not see,
    /// such as a comment, goes on.
    fn rewrite(&mut self) {
        let Self::Behaviors(behaviors) = self else { return };
        for human in behaviors.humans.values_mut() {
            if let Ok(tree) = socrates_bt::Tree::parse(&human.tree) {
                human.tree = tree.to_xml(tree.format());
            }
        }
    }

    /// What an author says beside its proposal stays with it, for the person who looks.
    fn note(&mut self, answer: &str) {
        if let (Self::Proposal(proposal), Some(words)) = (self, json::words_around(answer)) {
            proposal.notes.push(format!("beside its answer the author says: {words}"));
        }
    }

    fn sign(&mut self, author: &str) {
        let place = match self {
            Self::Proposal(proposal) => &mut proposal.author,
            Self::Paths(paths) => &mut paths.author,
            Self::Behaviors(behaviors) => &mut behaviors.author,
        };
        *place = author.into();
    }
}

/// One exchange with an author, kept for provenance whether the answer was good or not.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Exchange {
    /// Format number.
    pub format: u32,
    /// Stage of the question.
    pub stage: Stage,
    /// Author as configured.
    pub author: String,
    /// Author as it answered (the model the server names).
    pub model: String,
    /// Content address of the question's JSON.
    pub question: Digest,
    /// Seed of the question.
    pub seed: u64,
    /// What the question says was wrong with earlier answers; the rest of it are the inputs of the job.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub feedback: Vec<Fault>,
    /// What was sent, for authors that read messages.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub messages: Vec<Message>,
    /// The answer as it came; empty where none came.
    pub answer: String,
    /// Tokens in and out.
    pub tokens: (u64, u64),
    /// How it was asked and answered.
    #[serde(default)]
    pub how: How,
    /// What was repaired to read it; such an answer is not counted as right at first pass.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub repairs: Vec<Fault>,
    /// Faults of each of several proposals, where the answer holds several; the answer keeps them all.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub variants: Vec<Vec<Fault>>,
    /// Place of the one that was taken, from 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chosen: Option<usize>,
    /// Faults put in on purpose.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub injected: Vec<String>,
    /// What was found wrong; warnings too.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<Fault>,
}

/// A good answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Made {
    /// The artifact, signed with its author.
    pub written: Written,
    /// How the author read the request, where it read it itself.
    pub reading: Option<Reading>,
    /// How it came about.
    pub exchange: Exchange,
}

/// A refused answer, or none.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{} faults, the first: {}", faults.len(), faults.first().map(ToString::to_string).unwrap_or_default())]
pub struct Refused {
    /// How the orchestrator treats it.
    pub class: FailureClass,
    /// Every reason at once; warnings come last.
    pub faults: Vec<Fault>,
    /// The refused text, for the next ask; nothing where there is no text worth showing again.
    pub text: Option<String>,
    /// How long the server wants us to wait, ms.
    pub retry_after_ms: Option<u64>,
    /// How it came about.
    pub exchange: Box<Exchange>,
}

/// Asks once, reads the answer, checks it.
///
/// # Errors
/// [`Refused`] with every reason at once.
pub async fn attempt(author: &dyn Author, question: &Question) -> Result<Made, Refused> {
    let asked = serde_json::to_vec(question).map(|bytes| Digest::of(&bytes));
    let mut exchange = Exchange {
        format: FORMAT,
        stage: question.stage,
        author: author.name(),
        model: String::new(),
        question: asked.unwrap_or_else(|_no_json| Digest::of(&[])),
        seed: question.seed,
        feedback: question.feedback.clone(),
        messages: Vec::new(),
        answer: String::new(),
        tokens: (0, 0),
        how: How::default(),
        repairs: Vec::new(),
        variants: Vec::new(),
        chosen: None,
        injected: Vec::new(),
        faults: Vec::new(),
    };
    let answer = match author.ask(question).await {
        Ok(answer) => answer,
        Err(error) => return Err(unanswered(&error, exchange)),
    };
    exchange.repairs = json::repairs(&answer.text);
    let taken = if answer.cut { Err(vec![cut(&answer)]) } else { chosen(&answer.text, question, &mut exchange) };
    let (outcome, own) = match taken {
        Ok(Some(text)) => (read(&text, question), Some(text)),
        Ok(None) => (read(&answer.text, question), None),
        Err(faults) => (Err(faults), None),
    };
    let model = answer.model.clone();
    exchange.model = answer.model;
    exchange.messages = answer.sent;
    exchange.tokens = answer.tokens;
    exchange.how = answer.how;
    exchange.injected = answer.injected;
    exchange.answer = answer.text;
    let (written, reading, faults) = match outcome {
        Ok((written, as_read)) => {
            let (reading, faults) = checked(&written, as_read.as_ref(), question);
            (Some(written), reading, faults)
        }
        Err(faults) => (None, None, faults),
    };
    exchange.faults.clone_from(&faults);
    match written {
        Some(mut written) if hard(&faults).is_empty() => {
            written.sign(&model);
            written.note(&exchange.answer);
            if exchange.answer.contains('<') {
                written.rewrite();
            }
            Ok(Made { written, reading, exchange })
        }
        Some(_) | None => {
            let mut refused = refused(faults, exchange);
            // Of several only the one that is to be mended is shown again.
            refused.text = own.or(refused.text);
            Err(refused)
        }
    }
}

/// The text of the best of several proposals; nothing where the answer is one.
fn chosen(text: &str, question: &Question, exchange: &mut Exchange) -> Result<Option<String>, Vec<Fault>> {
    // A glance is enough to leave other answers to their own reader.
    if question.stage != Stage::Proposal || !text.contains(variants::MEMBER) {
        return Ok(None);
    }
    if json::object(text)?.get(variants::MEMBER).is_none() {
        return Ok(None);
    }
    let mut all = variants::read(text, question)?;
    let best = variants::best(&all);
    exchange.variants = all.iter().map(|variant| variant.faults.clone()).collect();
    exchange.chosen = Some(best);
    Ok((best < all.len()).then(|| all.swap_remove(best).text))
}

/// How the author reads the request.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AsRead {
    /// The fate of each sentence.
    pub(crate) account: Account,
    /// The scenario of the author; none in an answer that is a proposal.
    pub(crate) scenario: Option<Scenario>,
}

/// Reads a text: the artifact, and the author's reading of the request where it reads it itself.
pub(crate) fn read(text: &str, question: &Question) -> Result<(Written, Option<AsRead>), Vec<Fault>> {
    match question.stage {
        Stage::Proposal if question.reading.by.is_author() => {
            let scenario = json::object(text).is_ok_and(|answer| scenario::is_stated(&answer));
            let proposal = if scenario {
                parse_scenario(text).and_then(|mut all| {
                    // Statements of the request win.
                    all.scenario = Scenario::of(&all.scenario.stated_in(&question.request));
                    Ok((stated::proposal(&all, question)?, Some(all.scenario)))
                })
            } else {
                parse_proposal(text).map(|proposal| (proposal, None))
            };
            match (proposal, parse_account(text)) {
                (Ok((proposal, scenario)), Ok(account)) => {
                    Ok((Written::Proposal(proposal), Some(AsRead { account, scenario })))
                }
                (Ok(_), Err(faults)) | (Err(faults), Ok(_)) => Err(faults),
                (Err(mut faults), Err(others)) => {
                    faults.extend(others);
                    faults.dedup();
                    Err(faults)
                }
            }
        }
        Stage::Proposal => parse_proposal(text).map(|proposal| (Written::Proposal(proposal), None)),
        Stage::Paths => parse_paths(text, question).map(|paths| (Written::Paths(paths), None)),
        Stage::Behaviors => parse_behaviors(text, question).map(|behaviors| (Written::Behaviors(behaviors), None)),
        Stage::Simulation | Stage::Scoring | Stage::Review => Err(vec![Fault::new(
            FaultCode::JSpec,
            question.stage,
            "is no authoring stage; allowed: proposal, paths, behaviors",
        )]),
    }
}

/// How the request is read with an answer, where its author reads it, and every fault of the answer, warnings too.
pub(crate) fn checked(
    written: &Written,
    as_read: Option<&AsRead>,
    question: &Question,
) -> (Option<Reading>, Vec<Fault>) {
    let (Written::Proposal(proposal), Some(AsRead { account, scenario })) = (written, as_read) else {
        return (None, check(written, question));
    };
    let mut faults = account::check(account, question);
    let reading = match scenario {
        Some(scenario) => {
            faults.extend(stated::check(account, scenario));
            stated::reading(account, scenario, proposal, question)
        }
        None => account::reading(account, proposal, question),
    };
    faults.extend(check_proposal(proposal, &reading, &question.location));
    (Some(reading), faults)
}

/// Every fault of an answer whose author did not read the request itself, warnings too.
pub(crate) fn check(written: &Written, question: &Question) -> Vec<Fault> {
    let place = &question.location;
    match (written, &question.proposal) {
        (Written::Proposal(proposal), _) => check_proposal(proposal, &question.reading, place),
        (Written::Paths(paths), Some(proposal)) => check_paths(paths, proposal, place),
        (Written::Behaviors(behaviors), Some(proposal)) if question.only.is_empty() => {
            check_behaviors(behaviors, proposal, place)
        }
        (Written::Behaviors(behaviors), Some(proposal)) => {
            // A split question answers for some; what they hear from the others is checked when all are together.
            let mut part = proposal.clone();
            part.humans.retain(|human| question.only.contains(&human.id));
            let mut faults = check_behaviors(behaviors, &part, place);
            faults.retain(|fault| fault.code != FaultCode::BHear);
            faults
        }
        (Written::Paths(_) | Written::Behaviors(_), None) => {
            vec![Fault::new(FaultCode::JSpec, question.stage, "needs a proposal to be checked against")]
        }
    }
}

fn cut(answer: &Answer) -> Fault {
    let message = format!(
        "was cut by the limit of tokens after {} characters; answer again, and shorter",
        answer.text.chars().count()
    );
    Fault::new(FaultCode::ETrunc, "answer", message)
}

fn unanswered(error: &AskError, mut exchange: Exchange) -> Refused {
    let fault = error.fault();
    exchange.faults = vec![fault.clone()];
    Refused {
        class: error.code.class(),
        faults: vec![fault],
        text: None,
        retry_after_ms: error.retry_after_ms,
        exchange: Box::new(exchange),
    }
}

fn refused(mut faults: Vec<Fault>, exchange: Exchange) -> Refused {
    faults.sort_by_key(Fault::is_soft);
    let text = (!exchange.answer.trim().is_empty()).then(|| exchange.answer.clone());
    Refused { class: FailureClass::of(&faults), faults, text, retry_after_ms: None, exchange: Box::new(exchange) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Scripted, good_paths, question};

    #[tokio::test]
    async fn a_good_answer_is_signed_by_its_author() {
        let made = attempt(&Scripted::says(&good_paths()), &question(Stage::Paths)).await.unwrap();
        let Written::Paths(paths) = &made.written else { panic!("{made:?}") };
        assert_eq!(paths.author, "scripted".into());
        assert_eq!(made.written.remark(), "5 nodes · 2 encounters");
        assert!(made.exchange.faults.is_empty() && made.exchange.repairs.is_empty());
    }

    #[tokio::test]
    async fn what_an_author_says_against_the_request_is_kept_as_a_note() {
        let asked = question(Stage::Proposal);
        let answer = serde_json::to_string(&crate::testing::proposal()).unwrap();
        let argues = format!("A corridor is the wrong place for this.\n{answer}");
        let made = attempt(&Scripted::says(&argues), &asked).await.unwrap();
        let Written::Proposal(proposal) = &made.written else { panic!("{made:?}") };
        let note = proposal.notes.last().unwrap();
        assert_eq!(note, "beside its answer the author says: A corridor is the wrong place for this.");
    }

    #[tokio::test]
    async fn a_wrong_answer_is_refused_with_its_text_and_every_reason() {
        let text = good_paths().replace("\"w_1\",", "");
        let refused = attempt(&Scripted::says(&text), &question(Stage::Paths)).await.unwrap_err();
        assert_eq!((refused.class, refused.text.as_deref()), (FailureClass::Semantic, Some(text.as_str())));
        assert_eq!(refused.faults[0].code, FaultCode::GDisc);
        assert_eq!(refused.exchange.answer, text);
    }

    #[tokio::test]
    async fn a_cut_answer_is_unparsable_and_a_fence_is_repaired() {
        let cut = Scripted { cut: true, ..Scripted::says(&good_paths()) };
        let refused = attempt(&cut, &question(Stage::Paths)).await.unwrap_err();
        assert_eq!((refused.class, refused.faults[0].code), (FailureClass::Unparsable, FaultCode::ETrunc));
        let fenced = format!("```json\n{}\n```", good_paths());
        let made = attempt(&Scripted::says(&fenced), &question(Stage::Paths)).await.unwrap();
        assert_eq!(made.exchange.repairs[0].code, FaultCode::EExtra);
    }

    #[tokio::test]
    async fn no_answer_keeps_its_class_and_its_wish_to_wait() {
        let slow = Scripted::fails(AskError { code: FaultCode::T429, message: "slow".into(), retry_after_ms: Some(7) });
        let refused = attempt(&slow, &question(Stage::Paths)).await.unwrap_err();
        assert_eq!((refused.class, refused.retry_after_ms, refused.text), (FailureClass::Overload, Some(7), None));
    }
}
