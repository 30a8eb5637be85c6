//! Tokens that a scenario is expected to cost, for `run --dry-run`: its questions as a model would be sent them, estimated by bytes.

use socrates_author::offline::Offline;
use socrates_author::{Asking, Author as _, AuthorContext, Written, compiled, llm};
use socrates_llm::estimate::{request_tokens, text_tokens};
use socrates_llm::{ChatRequest, Dialect};
use socrates_model::job::Stage;
use socrates_model::{Location, Reading, Request};
use socrates_prompts::{Question, Style};

use crate::exit::{Code, Diagnostic};

/// Stages that ask a model.
const STAGES: [Stage; 3] = [Stage::Proposal, Stage::Paths, Stage::Behaviors];
/// Limit of an answer in the questions that are only measured, tokens.
const MAX_TOKENS: u32 = 1_000;

fn ours(why: &str) -> Diagnostic {
    Diagnostic::input(why, "this build is damaged").with_code(Code::Ours)
}

/// The questions of a scenario, one per stage. The proposal in the later ones is that of the offline author, which is as long as another's.
///
/// # Errors
/// The offline author has no answer to the request.
pub async fn questions_of(request: Request, reading: Reading, location: Location) -> Result<Vec<Question>, Diagnostic> {
    let mut question = Question::first(request, reading, location, 1);
    let answer = AuthorContext::default().answer(&question, &Asking::offline()).await;
    let answer = answer.map_err(|_refusal| ours("the offline author has no answer"))?;
    if let Written::Proposal(proposal) = answer.written {
        question.proposal = Some(proposal);
    }
    Ok(STAGES.map(|stage| Question { stage, ..question.clone() }).into())
}

/// The questions that a model is asked in a style: not those whose answer is compiled.
pub fn asked<'a>(questions: &'a [Question], style: &Style) -> impl Iterator<Item = &'a Question> {
    let compiled = compiled::compiles(style);
    questions.iter().filter(move |question| !(compiled && question.stage == Stage::Behaviors))
}

/// A question as it is sent.
///
/// # Errors
/// A question that cannot be written.
pub fn request_of(question: &Question, style: &Style) -> Result<ChatRequest, Diagnostic> {
    llm::chat_request(question, &question.prompt(style), style.image, MAX_TOKENS).map_err(|why| ours(&why.message))
}

/// Tokens that a model is sent and answers, by stage, for one scenario of a request when every first answer is taken: estimated by bytes,
/// answers as long as those of the offline author.
pub(crate) async fn expected(
    request: &Request,
    reading: &Reading,
    location: &Location,
    style: &Style,
) -> Result<Vec<(Stage, [u64; 2])>, Diagnostic> {
    let mut found = Vec::new();
    let questions = questions_of(request.clone(), reading.clone(), location.clone()).await?;
    for question in asked(&questions, style) {
        let answer = Offline.ask(question).await.map_err(|why| ours(&why.message))?.text;
        let sent = request_tokens(&request_of(question, style)?, Dialect::OpenAi);
        found.push((question.stage, [sent, text_tokens(&answer)]));
    }
    Ok(found)
}
