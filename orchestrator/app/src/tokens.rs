//! `dev tokens`: how many tokens a scenario of two people costs, by stage and style, counted with the o200k tokenizer on
//! a shipped location and request, and how long our own part of a call takes.

use std::path::Path;
use std::time::Instant;

use serde_json::json;
use socrates_author::offline::Offline;
use socrates_author::{Asking, Author as _, AuthorContext, Says, Written, attempt, llm};
use socrates_llm::estimate::{picture_tokens, png_size, request_tokens};
use socrates_llm::{Detail, Dialect};
use socrates_model::job::Stage;
use socrates_model::{Location, Reading, Request};
use socrates_prompts::{BehaviorsForm, Image, Mode, PathsForm, Question, Style};

use crate::exit::{Code, Complaint};
use crate::output::Printer;

const REQUEST: &str = include_str!("../../../maps/warehouse/scenarios/coffee.toml");
const STAGES: [Stage; 3] = [Stage::Proposal, Stage::Paths, Stage::Behaviors];
/// Times that our own part of a call is measured.
const ROUNDS: usize = 41;

/// Counts and measures; with a folder, writes the questions and the picture there.
pub async fn tokens(talk: &Printer, out: Option<&Path>) -> Result<(), Complaint> {
    let questions = questions().await?;
    let plain = Style::default();
    let off = Style { image: Image::Off, ..plain };
    talk.line("two people, warehouse, o200k tokens: messages + form + picture = all");
    let mut found = serde_json::Map::new();
    for (name, style) in styles() {
        let questions = || asked(&questions, &style);
        let counted = questions().map(|question| count(question, &style)).collect::<Result<Vec<_>, _>>()?;
        let sum = |part: fn(&Counted) -> usize| counted.iter().map(part).sum::<usize>();
        let (words, form, picture) = (sum(|c| c.words), sum(|c| c.form), sum(|c| c.picture));
        let each: Vec<String> = counted
            .iter()
            .zip(questions())
            .map(|(c, question)| format!("{} {} + {} + {}", question.stage, c.words, c.form, c.picture))
            .collect();
        let all = words + form + picture;
        talk.line(&format!("{name:24} {words:5} + {form:4} + {picture:3} = {all:5}   {}", each.join(" · ")));
        if style == plain || style == off {
            let limit = if style == plain { 5_500 } else { 5_000 };
            // The figure to compare with counts messages and picture: forms are left out of it on both sides.
            let within = if words + picture <= limit { "within" } else { "NOT within" };
            let (both, estimate) = (words + picture, sum(|c| c.estimated));
            talk.line(&format!(
                "{:24} messages and picture {both}: {within} {limit}; all, estimated by bytes: {estimate}",
                ""
            ));
        }
        found.insert(name.to_owned(), json!({"messages": words, "form": form, "picture": picture}));
    }
    if let Some(out) = out {
        write(&questions, &plain, out)?;
        talk.line(&format!("wrote      {}", out.display()));
    }
    talk.line(
        "serial calls: 2 (the proposal; then the paths, and beside them the behaviors where trees are written freely)",
    );
    let median = own_time(talk, &questions, &plain).await?;
    talk.line(&format!("own time per call: median {median} µs"));
    talk.result(&json!({"styles": found, "serial_calls": 2, "own_us": u64::try_from(median).unwrap_or(u64::MAX)}));
    Ok(())
}

fn ours(why: &str) -> Complaint {
    Complaint::input(why, "this build is damaged").with_code(Code::Ours)
}

/// The three questions of a scenario. What a proposal says is the next stages' question; the offline author's is as long as another's.
async fn questions() -> Result<Vec<Question>, Complaint> {
    let request: Request = toml::from_str(REQUEST).map_err(|why| ours(&why.to_string()))?;
    let location =
        socrates_maps::shipped::load(&request.location).map_err(|_faults| ours("a shipped location is broken"))?;
    let reading = socrates_offline::stated(&request, &location);
    questions_of(request, reading, location).await
}

/// The questions that a model is asked in a style: not those whose answer is compiled.
fn asked<'a>(questions: &'a [Question], style: &Style) -> impl Iterator<Item = &'a Question> {
    let compiled = socrates_author::compiled::compiles(style);
    questions.iter().filter(move |question| !(compiled && question.stage == Stage::Behaviors))
}

/// The same of any request.
async fn questions_of(request: Request, reading: Reading, location: Location) -> Result<Vec<Question>, Complaint> {
    let mut question = Question::first(request, reading, location, 1);
    let answer = AuthorContext::default().answer(&question, &Asking::offline()).await;
    let answer = answer.map_err(|_refusal| ours("the offline author has no answer"))?;
    if let Written::Proposal(proposal) = answer.written {
        question.proposal = Some(proposal);
    }
    Ok(STAGES.map(|stage| Question { stage, ..question.clone() }).into())
}

/// Tokens that a model is sent and answers, by stage, for one scenario of a request when every answer is taken: questions in this style
/// are counted as they are, answers are as long as those of the offline author.
pub(crate) async fn expected(
    request: &Request,
    reading: &Reading,
    location: &Location,
    style: &Style,
) -> Result<Vec<(Stage, [usize; 2])>, Complaint> {
    let tokenizer = tiktoken_rs::o200k_base_singleton();
    let mut found = Vec::new();
    let questions = questions_of(request.clone(), reading.clone(), location.clone()).await?;
    for question in asked(&questions, style) {
        let counted = count(question, style)?;
        let answer = Offline.ask(question).await.map_err(|why| ours(&why.message))?.text;
        let sent = counted.words + counted.form + counted.picture;
        found.push((question.stage, [sent, tokenizer.encode_ordinary(&answer).len()]));
    }
    Ok(found)
}

fn styles() -> [(&'static str, Style); 8] {
    let plain = Style::default();
    let off = Style { image: Image::Off, ..plain };
    [
        ("default, image low", plain),
        ("default, image off", off),
        ("default, image high", Style { image: Image::High, ..plain }),
        ("paths as nodes", Style { paths: PathsForm::Nodes, ..off }),
        ("paths as walk", Style { paths: PathsForm::Walk, ..off }),
        ("behaviors as json_tree", Style { behaviors: BehaviorsForm::JsonTree, ..off }),
        ("behaviors as xml", Style { behaviors: BehaviorsForm::Xml, ..off }),
        ("naive", Style { mode: Mode::Naive, paths: PathsForm::Nodes, behaviors: BehaviorsForm::Xml, ..off }),
    ]
}

/// Writes what is sent: one text per stage, and the picture.
fn write(questions: &[Question], style: &Style, out: &Path) -> Result<(), Complaint> {
    for question in asked(questions, style) {
        let stage = question.stage;
        let request = request_of(question, style)?;
        let mut text = String::new();
        for turn in &request.turns {
            text.push_str(&format!("--- {:?}\n{}\n", turn.speaker, turn.text));
            if let Some(png) = &turn.png {
                crate::files::write(&out.join(format!("{stage}.png")), png)?;
            }
        }
        let form = request.schema.as_ref().map(ToString::to_string).unwrap_or_default();
        crate::files::write(&out.join(format!("{stage}.txt")), format!("{text}--- form\n{form}\n").as_bytes())?;
    }
    Ok(())
}

/// Median time to write a question, picture included, and to read and check its answer, µs.
async fn own_time(talk: &Printer, questions: &[Question], style: &Style) -> Result<u128, Complaint> {
    let mut all: Vec<u128> = Vec::new();
    for question in asked(questions, style) {
        let stage = question.stage;
        let text = Offline.ask(question).await.map_err(|why| ours(&why.message))?.text;
        let mut spent: Vec<u128> = Vec::new();
        for _ in 0..ROUNDS {
            let start = Instant::now();
            let body = serde_json::to_string(&request_of(question, style)?).map_err(|why| ours(&why.to_string()))?;
            let made = attempt(&Says(text.clone()), question).await;
            spent.push(start.elapsed().as_micros());
            std::hint::black_box((body.len(), made.is_ok()));
        }
        spent.sort_unstable();
        let median = spent.get(ROUNDS / 2).copied().unwrap_or_default();
        talk.line(&format!("own time, {stage}: median {median} µs to write the question, picture included, and to read and check the answer"));
        all.append(&mut spent);
    }
    all.sort_unstable();
    Ok(all.get(all.len() / 2).copied().unwrap_or_default())
}

struct Counted {
    words: usize,
    form: usize,
    picture: usize,
    estimated: usize,
}

fn request_of(question: &Question, style: &Style) -> Result<socrates_llm::ChatRequest, Complaint> {
    llm::chat_request(question, &question.prompt(style), style.image, 1_000).map_err(|why| ours(&why.message))
}

fn count(question: &Question, style: &Style) -> Result<Counted, Complaint> {
    let tokenizer = tiktoken_rs::o200k_base_singleton();
    let tokens = |text: &str| tokenizer.encode_ordinary(text).len();
    let request = request_of(question, style)?;
    // Each turn has a frame of about four tokens.
    let words = request.turns.iter().map(|turn| tokens(&turn.text) + 4).sum();
    let form = request.schema.as_ref().map_or(0, |schema| tokens(&schema.to_string()));
    let detail = if style.image == Image::High { Detail::High } else { Detail::Low };
    let picture = |png: &Vec<u8>| picture_tokens(png_size(png), detail, Dialect::OpenAi);
    let picture: u64 = request.turns.iter().filter_map(|turn| turn.png.as_ref()).map(picture).sum();
    let count = |tokens: u64| usize::try_from(tokens).unwrap_or(usize::MAX);
    Ok(Counted { words, form, picture: count(picture), estimated: count(request_tokens(&request, Dialect::OpenAi)) })
}
