//! How many tokens a scenario of two people costs, by stage and style, counted with the o200k tokenizer on a shipped
//! location and request.
//!
//! `cargo run --release -p socrates-author --example tokens`; with `-- show` the questions themselves, with `-- map.png` the picture
#![expect(clippy::print_stdout, reason = "the figures are what it is for")]
#![expect(clippy::expect_used, reason = "without its inputs there are no figures")]

use std::collections::BTreeMap;
use std::time::Instant;

use socrates_author::offline::Offline;
use socrates_author::{Answer, AskError, Author, Desk, Papers, Written, attempt, llm};
use socrates_llm::estimate::{picture_tokens, png_size, request_tokens};
use socrates_llm::{Detail, Dialect};
use socrates_model::Request;
use socrates_model::job::Stage;
use socrates_prompts::{BehaviorsForm, Image, Mode, PathsForm, Question, Style};

const REQUEST: &str = include_str!("../../../maps/warehouse/scenarios/coffee.toml");
const STAGES: [Stage; 3] = [Stage::Proposal, Stage::Paths, Stage::Behaviors];

#[tokio::main(flavor = "current_thread")]
async fn main() {
    let request: Request = toml::from_str(REQUEST).expect("the request is read");
    let location = socrates_maps::shipped::load(&request.location).expect("the location is shipped");
    let reading = socrates_offline::read(&request, &location);
    let mut papers = Papers {
        stage: Stage::Proposal,
        request,
        reading,
        location,
        proposal: None,
        only: Vec::new(),
        feedback: Vec::new(),
        refused: None,
        seed: 1,
        settings: BTreeMap::from([("author".to_owned(), "offline".to_owned())]),
        attempt: 1,
    };
    // What a proposal says is the next stages' question; the offline author's is as long as another's.
    let answer = Desk::default().answer(papers.clone()).await.expect("the offline author proposes");
    let Written::Proposal(proposal) = answer.written else { unreachable!("a proposal was asked for") };
    papers.proposal = Some(proposal);
    let questions = STAGES.map(|stage| Papers { stage, ..papers.clone() }.question());
    let plain = Style::default();
    let off = Style { image: Image::Off, ..plain };
    let styles = [
        ("default, image low", plain),
        ("default, image off", off),
        ("default, image high", Style { image: Image::High, ..plain }),
        ("paths as nodes", Style { paths: PathsForm::Nodes, ..off }),
        ("paths as walk", Style { paths: PathsForm::Walk, ..off }),
        ("behaviors as json_tree", Style { behaviors: BehaviorsForm::JsonTree, ..off }),
        ("behaviors as xml", Style { behaviors: BehaviorsForm::Xml, ..off }),
        (
            "naive",
            Style { mode: Mode::Naive, paths: PathsForm::Nodes, behaviors: BehaviorsForm::Xml, image: Image::Off },
        ),
    ];
    println!("two people, warehouse, o200k tokens (messages + form + picture = all)");
    for (name, style) in styles {
        let counted = questions.each_ref().map(|question| count(question, &style));
        let sum = |part: fn(&Counted) -> usize| counted.iter().map(part).sum::<usize>();
        let (words, form, picture) = (sum(|c| c.words), sum(|c| c.form), sum(|c| c.picture));
        let each: Vec<String> = counted
            .iter()
            .zip(STAGES)
            .map(|(c, stage)| format!("{stage} {} + {} + {}", c.words, c.form, c.picture))
            .collect();
        println!("{name:24} {words:5} + {form:4} + {picture:3} = {:5}   {}", words + form + picture, each.join(" · "));
        if style == plain || style == off {
            let limit = if style == plain { 5_500 } else { 5_000 };
            // The figure to compare with counts messages and picture: forms are left out of it on both sides.
            let within = if words + picture <= limit { "within" } else { "NOT within" };
            let estimate = sum(|c| c.estimated);
            println!(
                "{:24} messages and picture {} are {within} {limit}; all, estimated by bytes: {estimate}",
                "",
                words + picture
            );
        }
    }
    let word = std::env::args().nth(1);
    if let Some(file) = word.as_deref().filter(|word| word.ends_with(".png")) {
        for question in &questions {
            for png in request_of(question, &plain).turns.into_iter().filter_map(|turn| turn.png) {
                std::fs::write(file, png).expect("the picture is written");
            }
        }
    } else if word.is_some() {
        for question in &questions {
            let prompt = question.prompt(&off);
            for message in &prompt.messages {
                let tokens = tiktoken_rs::o200k_base_singleton().encode_ordinary(&message.text).len();
                println!("--- {:?}, {tokens} tokens\n{}", message.role, message.text);
            }
            println!("--- form\n{}", prompt.schema.unwrap_or_default());
        }
    }
    println!("serial calls: 2 (the proposal; then paths and the behaviors of everybody side by side)");
    let mut all: Vec<u128> = Vec::new();
    for (question, stage) in questions.iter().zip(STAGES) {
        let text = Offline.ask(question).await.expect("the offline author answers").text;
        let mut spent: Vec<u128> = Vec::new();
        for _ in 0..41 {
            let start = Instant::now();
            let request = request_of(question, &plain);
            let body = serde_json::to_string(&request).expect("a request is JSON");
            let made = attempt(&Says(text.clone()), question).await;
            spent.push(start.elapsed().as_micros());
            std::hint::black_box((body.len(), made.is_ok()));
        }
        spent.sort_unstable();
        let median = spent.get(20).copied().unwrap_or_default();
        println!(
            "own time, {stage}: median {median} µs to write the question, picture included, and to read and check the answer"
        );
        all.append(&mut spent);
    }
    all.sort_unstable();
    println!("own time per call: median {} µs", all.get(all.len() / 2).copied().unwrap_or_default());
}

/// Says one text at once: what remains is our own time.
struct Says(String);

#[async_trait::async_trait]
impl Author for Says {
    async fn ask(&self, _question: &Question) -> Result<Answer, AskError> {
        Ok(Answer { text: self.0.clone(), ..Answer::default() })
    }

    fn name(&self) -> String {
        "says".into()
    }
}

struct Counted {
    words: usize,
    form: usize,
    picture: usize,
    estimated: usize,
}

fn request_of(question: &Question, style: &Style) -> socrates_llm::ChatRequest {
    llm::chat_request(question, &question.prompt(style), style.image, 1_000).expect("the map is drawn")
}

fn count(question: &Question, style: &Style) -> Counted {
    let tokenizer = tiktoken_rs::o200k_base_singleton();
    let tokens = |text: &str| tokenizer.encode_ordinary(text).len();
    let request = request_of(question, style);
    // Each turn has a frame of about four tokens.
    let words = request.turns.iter().map(|turn| tokens(&turn.text) + 4).sum();
    let form = request.schema.as_ref().map_or(0, |schema| tokens(&schema.to_string()));
    let detail = if style.image == Image::High { Detail::High } else { Detail::Low };
    let picture = |png: &Vec<u8>| picture_tokens(png_size(png), detail, Dialect::OpenAi);
    let picture: u64 = request.turns.iter().filter_map(|turn| turn.png.as_ref()).map(picture).sum();
    let count = |tokens: u64| usize::try_from(tokens).unwrap_or(usize::MAX);
    Counted { words, form, picture: count(picture), estimated: count(request_tokens(&request, Dialect::OpenAi)) }
}
