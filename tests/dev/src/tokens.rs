//! `socrates-dev tokens`: how many tokens a scenario of two people costs, by stage and style, counted with the o200k tokenizer on
//! a shipped location and request, and how long our own part of a call takes.

use std::path::Path;
use std::time::Instant;

use serde_json::json;
use socrates_app::exit::{Code, Diagnostic};
use socrates_app::expected_tokens::{asked, questions_of, request_of};
use socrates_app::output::Printer;
use socrates_author::offline::Offline;
use socrates_author::{Author as _, Says, attempt};
use socrates_llm::estimate::{picture_tokens, png_size, request_tokens};
use socrates_llm::{Detail, Dialect};
use socrates_model::Request;
use socrates_prompts::{BehaviorsForm, Image, Mode, PathsForm, Question, Style};

const REQUEST: &str = include_str!("../../../maps/warehouse/scenarios/coffee.toml");
/// Times that our own part of a call is measured.
const ROUNDS: usize = 41;

/// Counts and measures; with a folder, writes the questions and the picture there.
pub async fn tokens(talk: &Printer, out: Option<&Path>) -> Result<(), Diagnostic> {
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

fn ours(why: &str) -> Diagnostic {
    Diagnostic::input(why, "this build is damaged").with_code(Code::Ours)
}

/// The three questions of a scenario. What a proposal says is the next stages' question; the offline author's is as long as another's.
async fn questions() -> Result<Vec<Question>, Diagnostic> {
    let request: Request = toml::from_str(REQUEST).map_err(|why| ours(&why.to_string()))?;
    let location =
        socrates_maps::shipped::load(&request.location).map_err(|_faults| ours("a shipped location is broken"))?;
    let reading = socrates_offline::stated(&request, &location);
    questions_of(request, reading, location).await
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
fn write(questions: &[Question], style: &Style, out: &Path) -> Result<(), Diagnostic> {
    for question in asked(questions, style) {
        let stage = question.stage;
        let request = request_of(question, style)?;
        let mut text = String::new();
        for turn in &request.turns {
            text.push_str(&format!("--- {:?}\n{}\n", turn.speaker, turn.text));
            if let Some(png) = &turn.png {
                socrates_app::files::write(&out.join(format!("{stage}.png")), png)?;
            }
        }
        let form = request.schema.as_ref().map(ToString::to_string).unwrap_or_default();
        socrates_app::files::write(&out.join(format!("{stage}.txt")), format!("{text}--- form\n{form}\n").as_bytes())?;
    }
    Ok(())
}

/// Median time to write a question, picture included, and to read and check its answer, µs.
async fn own_time(talk: &Printer, questions: &[Question], style: &Style) -> Result<u128, Diagnostic> {
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

fn count(question: &Question, style: &Style) -> Result<Counted, Diagnostic> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn an_estimate_by_bytes_is_within_a_fifth_of_what_the_tokenizer_counts() {
        let questions = questions().await.unwrap();
        for (name, style) in styles().into_iter().filter(|(_, style)| style.mode != Mode::Naive) {
            let counted = asked(&questions, &style).map(|question| count(question, &style).unwrap());
            let (exact, estimated) = counted.fold((0, 0), |(exact, estimated), one| {
                (exact + one.words + one.form + one.picture, estimated + one.estimated)
            });
            assert!(exact.abs_diff(estimated) * 5 <= exact, "{name}: {estimated} for {exact}");
        }
    }
}
