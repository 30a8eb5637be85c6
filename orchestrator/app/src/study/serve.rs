//! `study serve`: the survey page on a port of this machine, and the answers that it sends, each on the disk before it is acknowledged.
//!
//! ```text
//! page ─► /api/begin, film, end ─► Journal: may it? ─► answers.jsonl, flushed to the disk ─► Journal: it is ─► page
//! ```

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use axum::Router;
use axum::body::Bytes;
use axum::extract::rejection::BytesRejection;
use axum::extract::{DefaultBodyLimit, Path as At, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse as _, Response};
use axum::routing::{get, post};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::json;
use socrates_gateway::guard::Rules;
use socrates_study::design::Design;
use socrates_study::kit::journal::{Journal, Refusal, Said, Standing};
use socrates_study::read::{HASHED, Line, Pseudonyms};
use tokio::time::Instant;

use super::build::{FILMS, SURVEY, lock};
use super::{MAX_ANSWERS, bad, design, key, name};
use crate::exit::Diagnostic;
use crate::files;
use crate::loopback::{self, Loopback, body, refused, told};
use crate::output::Printer;
use crate::process::leave;
use crate::view::new_token;

/// Bytes of a request, at most.
const MOST_BYTES: usize = 1 << 20;
/// Largest file of a film, bytes.
const MOST_FILM: u64 = 256 << 20;
/// Characters of an id, at most.
const MOST_ID: usize = 128;
/// The book.
const BOOK: &str = "answers.jsonl";
/// What a stranger is told; the page brings its own policy.
const WORDS: loopback::Words = loopback::Words {
    stranger: "this survey is not open under this name; `--host NAME` of `socrates study serve` opens it",
    token: "",
    policy: "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline' 'self'; img-src data: blob:; connect-src 'self'; \
             base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
};

/// Options of `study serve`.
#[derive(Debug, Clone)]
pub struct ServeOptions {
    /// The kit.
    pub kit: PathBuf,
    /// Study file.
    pub design: PathBuf,
    /// Folder of answers.
    pub answers: PathBuf,
    /// Key of the names.
    pub key: PathBuf,
    /// Port of this machine; none for any that is free.
    pub port: Option<u16>,
    /// Names under which a proxy of yours passes people on.
    pub hosts: Vec<String>,
    /// Minutes without a sign after which an order is given to somebody else.
    pub patience_min: u64,
    /// Leave when standard input closes.
    pub tied: bool,
}

/// The book and its file: what is asked and what is written goes one after another.
struct Book {
    journal: Journal,
    file: File,
    heard: BTreeMap<String, Instant>,
}

struct Shared {
    design: Design,
    kit: PathBuf,
    names: Pseudonyms,
    patience: Duration,
    book: Mutex<Book>,
}

/// Does `study serve`.
pub async fn serve(talk: &Printer, options: &ServeOptions) -> Result<(), Diagnostic> {
    let design = design(&options.design)?;
    if lock(&options.kit)?.study != design.digest {
        return Err(Diagnostic::input(
            format!(
                "`{}` is not the kit of `{}`: the study file was changed since",
                options.kit.display(),
                name(&options.design)
            ),
            "`socrates study build` makes its kit; --design names another study file",
        ));
    }
    let names = key(talk, &options.key)?;
    let book = open(talk, &design, &options.answers)?;
    let (began, ended) = book.journal.people();
    let loopback = Loopback::bind(options.port).await?;
    let mut rules = Rules { token: None, ..(*loopback.rules).clone() };
    rules.hosts.clone_from(&options.hosts);
    rules.origins =
        options.hosts.iter().flat_map(|host| [format!("https://{host}"), format!("http://{host}")]).collect();
    let page = format!("http://{}/", loopback.address);
    talk.line(&format!("page       {page}"));
    talk.line(&format!("people     {page}?PROLIFIC_PID={{{{%PROLIFIC_PID%}}}} is what a recruiting platform fills in"));
    talk.line(&format!("answers    {} · {began} began, {ended} came to the end", options.answers.join(BOOK).display()));
    talk.line("This machine alone reaches it; a proxy of yours lets others in. Ctrl-C ends; the same command goes on.");
    talk.result(&json!({ "page": page, "answers": options.answers.join(BOOK), "began": began, "ended": ended }));
    let shared = Arc::new(Shared {
        design,
        kit: options.kit.clone(),
        names,
        patience: Duration::from_secs(options.patience_min.saturating_mul(60)),
        book: Mutex::new(book),
    });
    let served = loopback.serve(routes(shared, rules));
    tokio::pin!(served);
    let mut leaves = leave(options.tied);
    tokio::select! {
        () = &mut served => Ok(()),
        _ = leaves.changed() => Ok(()),
    }
}

/// Opens the book. A last line that was cut off was never acknowledged: it is put aside.
fn open(talk: &Printer, design: &Design, folder: &Path) -> Result<Book, Diagnostic> {
    let path = folder.join(BOOK);
    let cannot = |why: std::io::Error| {
        Diagnostic::input(format!("cannot write `{}`: {why}", path.display()), "--answers names another folder")
    };
    std::fs::create_dir_all(folder).map_err(cannot)?;
    let mut text = if path.exists() { files::text(&path, MAX_ANSWERS, "the answers so far")? } else { String::new() };
    let whole = text.rfind('\n').map_or(0, |at| at + 1);
    if whole < text.len() {
        let torn = text.split_off(whole);
        let aside = folder.join(format!("{BOOK}.torn"));
        files::write(&aside, torn.as_bytes())?;
        let file = File::options().write(true).open(&path).map_err(cannot)?;
        file.set_len(whole as u64).map_err(cannot)?;
        file.sync_all().map_err(cannot)?;
        talk.warn(&format!("a line that was cut off was put aside: {}", aside.display()));
    }
    let journal = Journal::replay(design.clone(), &text, &name(&path)).map_err(|why| bad(&why))?;
    let file = File::options().append(true).create(true).open(&path).map_err(cannot)?;
    // One program at a time writes it.
    file.try_lock().map_err(|why| {
        Diagnostic::input(
            format!("`{}` is in use: {why}", path.display()),
            "another `socrates study serve` has it; --answers names another folder",
        )
    })?;
    let now = Instant::now();
    let heard = journal.unfinished().into_iter().map(|who| (who, now)).collect();
    Ok(Book { journal, file, heard })
}

impl Book {
    /// Writes a line, and takes it in once the disk has it.
    fn add(&mut self, line: &Line) -> Result<(), Response> {
        let ours = |why: String| {
            tracing::error!(%why, "an answer was not written");
            refused(
                StatusCode::INTERNAL_SERVER_ERROR,
                "your answers could not be kept; please try again",
                None,
                "not_kept",
            )
        };
        let mut text = serde_json::to_string(line).map_err(|why| ours(why.to_string()))?;
        text.push('\n');
        let written = self.file.write_all(text.as_bytes()).and_then(|()| self.file.sync_data());
        written.map_err(|why| ours(why.to_string()))?;
        self.journal.apply(line).map_err(|why| ours(why.to_string()))
    }

    /// Those who began and were not heard of for so long.
    fn gone(&self, patience: Duration) -> BTreeSet<String> {
        let late = |(_, at): &(&String, &Instant)| at.elapsed() > patience;
        self.heard.iter().filter(late).map(|(who, _)| who.clone()).collect()
    }

    fn hear(&mut self, who: &str) {
        self.heard.insert(who.to_owned(), Instant::now());
    }
}

fn routes(shared: Arc<Shared>, rules: Rules) -> Router {
    let door = Arc::new(loopback::Door { rules: Arc::new(rules), words: WORDS });
    let all = Router::new()
        .route("/", get(page))
        .route("/films/{film}", get(film_file))
        .route("/api/begin", post(begin))
        .route("/api/film", post(film))
        .route("/api/end", post(end))
        .layer(DefaultBodyLimit::max(MOST_BYTES))
        .fallback(nowhere);
    door.guarded(all).with_state(shared)
}

async fn nowhere() -> Response {
    refused(StatusCode::NOT_FOUND, "there is nothing at this address; the survey is at /", None, "unknown_url")
}

fn file(shared: &Shared, path: &Path, kind: &'static str, cached: &'static str) -> Response {
    match files::bytes(&shared.kit.join(SURVEY).join(path), MOST_FILM, "") {
        Ok(bytes) => ([(header::CONTENT_TYPE, kind), (header::CACHE_CONTROL, cached)], bytes).into_response(),
        Err(why) => {
            tracing::error!(what = %why.what, "a file of the kit cannot be read");
            refused(StatusCode::NOT_FOUND, "the kit lacks this file", None, "unknown_url")
        }
    }
}

async fn page(State(shared): State<Arc<Shared>>) -> Response {
    blocking(move || file(&shared, Path::new("index.html"), "text/html; charset=utf-8", "no-cache")).await
}

async fn film_file(State(shared): State<Arc<Shared>>, At(film): At<String>) -> Response {
    // Only films of the study: nothing else of this machine has such a name.
    let known = film.strip_suffix(".js").and_then(|id| shared.design.film(id)).map(|film| film.id.clone());
    let Some(id) = known else { return nowhere().await };
    let path = Path::new(FILMS).join(format!("{id}.js"));
    blocking(move || file(&shared, &path, "text/javascript; charset=utf-8", "private, max-age=86400")).await
}

/// Does what waits for the disk where it holds nobody up.
async fn blocking(act: impl FnOnce() -> Response + Send + 'static) -> Response {
    tokio::task::spawn_blocking(act).await.unwrap_or_else(|why| {
        tracing::error!(%why, "an answer was lost");
        refused(StatusCode::INTERNAL_SERVER_ERROR, "something failed here; please try again", None, "failed")
    })
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Begin {
    participant: String,
    token: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Answered {
    token: String,
    said: Said,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct End {
    token: String,
    duration_s: f64,
}

fn parsed<T: DeserializeOwned>(bytes: Result<Bytes, BytesRejection>) -> Result<T, Response> {
    let bytes = body(bytes, MOST_BYTES)?;
    serde_json::from_slice(&bytes).map_err(|why| {
        refused(StatusCode::BAD_REQUEST, &format!("the request cannot be read: {why}"), None, "invalid_value")
    })
}

fn of_journal(why: &Refusal) -> Response {
    let status = match why {
        Refusal::Unknown => StatusCode::UNAUTHORIZED,
        Refusal::Empty => StatusCode::SERVICE_UNAVAILABLE,
        Refusal::NotDue { .. } | Refusal::Twice { .. } | Refusal::Open { .. } => StatusCode::CONFLICT,
        Refusal::Answer { .. } | Refusal::Time { .. } => StatusCode::UNPROCESSABLE_ENTITY,
    };
    refused(status, &why.to_string(), None, "refused")
}

fn standing(at: &Standing) -> Response {
    told(&json!({ "token": at.token, "order": at.order, "films": at.films, "done": at.done, "ended": at.ended }))
}

async fn begin(State(shared): State<Arc<Shared>>, bytes: Result<Bytes, BytesRejection>) -> Response {
    let begin: Begin = match parsed(bytes) {
        Ok(begin) => begin,
        Err(why) => return why,
    };
    let id = begin.participant.trim().to_owned();
    if id.is_empty() || id.chars().count() > MOST_ID || id.starts_with(HASHED) {
        let what = format!("an id of 1 to {MOST_ID} characters is expected");
        return refused(StatusCode::UNPROCESSABLE_ENTITY, &what, Some("participant"), "invalid_value");
    }
    let token = match new_token() {
        Ok(token) => token,
        Err(why) => return refused(StatusCode::INTERNAL_SERVER_ERROR, &why.what, None, "failed"),
    };
    blocking(move || {
        let mut book = shared.book.lock().unwrap_or_else(PoisonError::into_inner);
        // Somebody who comes back with their token goes on, whatever they typed.
        let known = begin.token.and_then(|token| book.journal.of_token(&token).ok()).map(|at| at.participant);
        let who = known.unwrap_or_else(|| format!("{HASHED}{}", shared.names.of(&id)));
        let gone = book.gone(shared.patience);
        match book.journal.enter(&who, &token, &gone) {
            Err(why) => return of_journal(&why),
            Ok(None) => {}
            Ok(Some(line)) => {
                if let Err(why) = book.add(&line) {
                    return why;
                }
            }
        }
        book.hear(&who);
        book.journal.standing(&who).map_or_else(|| of_journal(&Refusal::Unknown), |at| standing(&at))
    })
    .await
}

async fn film(State(shared): State<Arc<Shared>>, bytes: Result<Bytes, BytesRejection>) -> Response {
    let Answered { token, said } = match parsed(bytes) {
        Ok(said) => said,
        Err(why) => return why,
    };
    blocking(move || {
        let mut book = shared.book.lock().unwrap_or_else(PoisonError::into_inner);
        match book.journal.film(&token, &said) {
            Err(why) => return of_journal(&why),
            Ok(None) => {}
            Ok(Some(line)) => {
                if let Err(why) = book.add(&line) {
                    return why;
                }
            }
        }
        match book.journal.of_token(&token) {
            Err(why) => of_journal(&why),
            Ok(at) => {
                book.hear(&at.participant);
                standing(&at)
            }
        }
    })
    .await
}

async fn end(State(shared): State<Arc<Shared>>, bytes: Result<Bytes, BytesRejection>) -> Response {
    let End { token, duration_s } = match parsed(bytes) {
        Ok(end) => end,
        Err(why) => return why,
    };
    blocking(move || {
        let mut book = shared.book.lock().unwrap_or_else(PoisonError::into_inner);
        match book.journal.end(&token, duration_s) {
            Err(why) => return of_journal(&why),
            Ok(None) => {}
            Ok(Some(line)) => {
                if let Err(why) = book.add(&line) {
                    return why;
                }
            }
        }
        // Only now: who has it has answered everything.
        let survey = &shared.design.survey;
        told(&json!({ "code": survey.completion_code, "url": survey.completion_url }))
    })
    .await
}
