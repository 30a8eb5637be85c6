//! What the configuration and the environment say of authors: keys, addresses, the style of questions.
//!
//! A key comes from an environment variable or a file that the configuration names; it is held in memory and goes into the
//! header of a request, nowhere else.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::time::Duration;

use socrates_author::here::{self, LocalServer};
use socrates_author::{AskError, Keys, Server};
use socrates_llm::probe::Kept;
use socrates_llm::{ApiKey, Dialect, Rung};
use socrates_model::AuthorSpec;
use socrates_model::job::{BEHAVIORS_BY, BY_PROPOSAL};
use socrates_model::request::ServerKind;
use socrates_orchestrator::policy::AFTER_CALL_MS;
use socrates_prompts::Style;

use crate::config::Config;
use crate::exit::{Code, Diagnostic};
use crate::output::Printer;

/// Largest key file that is read, bytes.
const MAX_KEY_BYTES: u64 = 16 * 1024;

/// Keys and addresses of this process.
pub(crate) fn keys(config: &Config) -> Result<Keys, Diagnostic> {
    let mut servers = BTreeMap::new();
    for dialect in Dialect::ALL {
        let part = part(dialect);
        let url = Some(config.text(&format!("{part}url"))).filter(|url| !url.is_empty());
        servers.insert(dialect, Server { key: key(config, &part)?, url });
    }
    let form = config.text("author.form");
    let rung = if form == "auto" { None } else { Some(word::<Rung>("author.form", &form, "auto, ")?) };
    Ok(Keys {
        servers,
        auto_model: Some(config.text("author.model")).filter(|model| !model.is_empty()),
        rung,
        silence: Some(Duration::from_secs(seconds(config, "author.timeout_s")?)),
        longest: Some(Duration::from_secs(seconds(config, "author.longest_s")?)),
        in_one_piece: !config.truth("author.stream"),
        max_tokens: u32::try_from(config.number("author.max_tokens")).ok().filter(|most| *most > 0),
        plain_http: config.truth("author.plain_http"),
        ..Keys::default()
    })
}

/// Longest time that can be set for anything, s: a day.
const LONGEST_S: u64 = 86_400;

/// A time of the configuration in seconds. One that cannot be kept is refused, not replaced by another.
fn seconds(config: &Config, key: &str) -> Result<u64, Diagnostic> {
    let found = config.number(key);
    if (1..=LONGEST_S).contains(&found) {
        return Ok(found);
    }
    let what = format!("`{key}` is {found}; it takes whole seconds, 1 to {LONGEST_S}");
    Err(Diagnostic::input(what, "`socrates config` prints the manual"))
}

/// Longest attempts of authoring, simulation and scoring, ms.
pub(crate) fn deadlines_ms(config: &Config) -> Result<(u64, u64, u64), Diagnostic> {
    let ms = |key: &str| seconds(config, key).map(|seconds| seconds * 1_000);
    // Whichever of the two limits comes first ends a call.
    ms("author.timeout_s")?;
    let author = ms("author.longest_s")? + AFTER_CALL_MS;
    Ok((author, ms("orchestrator.simulation_s")?, ms("orchestrator.scoring_s")?))
}

/// What follows from the times of the configuration, in sentences.
pub(crate) fn consequences(config: &Config) -> Result<Vec<String>, Diagnostic> {
    let (author, simulation, scoring) = deadlines_ms(config)?;
    let again = config.number("orchestrator.asks_again").min(10);
    Ok(vec![
        format!(
            "# A server may be silent for {} s (author.timeout_s), and a call may take {} s (author.longest_s); with reading and \
             checking, an attempt ends after {} s.",
            config.number("author.timeout_s"),
            config.number("author.longest_s"),
            author / 1_000
        ),
        format!(
            "# Without an answer in time a question is put {} at most (orchestrator.asks_again); each counts in `socrates cost`.",
            crate::words::plural(usize::try_from(again + 1).unwrap_or(1), "time")
        ),
        format!(
            "# A simulation ends after {} s, scoring after {} s (orchestrator.simulation_s, scoring_s). A worker that is silent for \
             {} s loses its job (orchestrator.lease_ms); a person who looks never does.",
            simulation / 1_000,
            scoring / 1_000,
            config.number("orchestrator.lease_ms") / 1_000
        ),
    ])
}

/// Every key that this process knows. One whose file cannot be used is told by whoever needs it.
pub(crate) fn secrets(config: &Config) -> Vec<ApiKey> {
    Dialect::ALL.into_iter().filter_map(|dialect| key(config, &part(dialect)).ok().flatten()).collect()
}

/// Whether a key for Chat Completions is there, which `auto` looks for.
pub(crate) fn key_found(config: &Config) -> Result<bool, Diagnostic> {
    Ok(key(config, &part(Dialect::OpenAi))?.is_some())
}

/// The author that `auto` means, and why: a model with a key, else one of a server on this machine, else rules.
pub(crate) fn auto(config: &Config) -> Result<(AuthorSpec, String), Diagnostic> {
    let model = config.text("author.model");
    let key_found = key_found(config)?;
    if key_found && !model.is_empty() {
        let author = AuthorSpec::Server(ServerKind::OpenAi, model);
        let note = author.to_string();
        return Ok((author, note));
    }
    let why = if key_found { "a key was found, but no model" } else { "no key found" };
    let servers = servers_here(config)?;
    if let Some((kind, model)) = servers.iter().find_map(|server| Some((server.kind, server.model.as_ref().ok()?))) {
        let author = AuthorSpec::Server(kind, model.clone());
        let note = format!("{author} (found on this machine; {why}: `--author offline` for rules)");
        return Ok((author, note));
    }
    let none = if servers.is_empty() { "" } else { ", no server on this machine" };
    Ok((AuthorSpec::Offline, format!("offline, rules ({why}{none}: `socrates config author` to change)")))
}

/// The same author, where recordings have an author behind them that is not `auto`.
pub(crate) fn settled(author: AuthorSpec, config: &Config) -> Result<AuthorSpec, Diagnostic> {
    let behind = |inner: AuthorSpec| settled(inner, config).map(Box::new);
    Ok(match author {
        AuthorSpec::Auto => auto(config)?.0,
        AuthorSpec::Record(folder, inner) => AuthorSpec::Record(folder, behind(*inner)?),
        AuthorSpec::Replay(folder, inner) => AuthorSpec::Replay(folder, behind(*inner)?),
        AuthorSpec::Offline | AuthorSpec::Server(..) | AuthorSpec::Cassette(_) => author,
    })
}

/// The servers that were looked for on this machine, once for all requests; empty where the configuration looks for none.
pub(crate) fn servers_here(config: &Config) -> Result<&[LocalServer], Diagnostic> {
    let Some(kept) = config.servers() else { return Ok(&[]) };
    let keys = keys(config)?;
    let look = || {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().ok()?;
        Some(runtime.block_on(here::look(&keys, here::LIMIT)))
    };
    // A thread of its own: the caller may be one that must not wait for a second runtime.
    let found = || std::thread::scope(|scope| scope.spawn(look).join()).ok().flatten().unwrap_or_default();
    Ok(kept.get_or_init(found))
}

/// The style of questions, as settings of jobs; empty for the default.
pub(crate) fn style(config: &Config) -> Result<BTreeMap<String, String>, Diagnostic> {
    let words = ["mode", "paths", "behaviors", "image", "feedback"]
        .into_iter()
        .map(|name| (name, config.text(&format!("author.{name}"))))
        .chain([("variants", config.number("author.variants").to_string())]);
    let mut asked = BTreeMap::new();
    for (name, word) in words {
        let setting = BTreeMap::from([(format!("prompt.{name}"), word)]);
        Style::from_settings(&setting).map_err(|fault| {
            let what = format!("`author.{name}`: {}", fault.message);
            Diagnostic::input(what, "`socrates config author` prints the manual")
        })?;
        asked.extend(setting);
    }
    let broken = |fault: socrates_model::Fault| Diagnostic::input(fault.to_string(), String::new());
    Style::from_settings(&asked).map(|style| style.settings()).map_err(broken)
}

/// What behaviors are made from, as a setting of jobs: a model that writes rules in its proposal is not asked for them again.
pub(crate) fn behaviors_by(author: &AuthorSpec, style: &BTreeMap<String, String>) -> BTreeMap<String, String> {
    let compiled =
        author.is_model() && Style::from_settings(style).is_ok_and(|style| socrates_author::compiled::compiles(&style));
    if compiled { BTreeMap::from([(BEHAVIORS_BY.to_owned(), BY_PROPOSAL.to_owned())]) } else { BTreeMap::new() }
}

/// The writer of paths, as a setting of jobs; empty where the author writes them.
pub(crate) fn paths_by(config: &Config, author: &AuthorSpec) -> Result<BTreeMap<String, String>, Diagnostic> {
    let word = config.text("author.paths_by");
    match word.as_str() {
        "solver" => Ok(BTreeMap::new()),
        // Rules have the solver anyway, and their results stay the same results.
        "model" | "model_alone" if *author == AuthorSpec::Offline => Ok(BTreeMap::new()),
        "model" | "model_alone" => Ok(BTreeMap::from([("paths_by".to_owned(), word)])),
        _ => {
            let what = format!("`author.paths_by`: `{word}` is unknown; allowed: model, model_alone, solver");
            Err(Diagnostic::input(what, "`socrates config author` prints the manual"))
        }
    }
}

/// That an author gave nothing, and why: its server's fault or the input's.
pub(crate) fn unasked(what: String, why: &AskError, hint: &str) -> Diagnostic {
    let code = if why.code.family() == socrates_model::Family::Transport { Code::Author } else { Code::Input };
    Diagnostic::faults(what, &[why.fault()], hint).with_code(code)
}

/// Looks whether these authors can be asked, before anything is made.
pub(crate) async fn check(config: &Config, authors: impl IntoIterator<Item = &AuthorSpec>) -> Result<(), Diagnostic> {
    let authors: BTreeSet<String> = authors.into_iter().map(AuthorSpec::to_string).collect();
    let keys = keys(config)?;
    for author in authors {
        if let Err(why) = socrates_author::check(&author, &keys).await {
            let what = format!("the author `{author}` cannot be asked; nothing was made");
            let hint = "`socrates config author` shows model, address and key; `--author offline` needs none";
            return Err(unasked(what, &why, hint));
        }
    }
    Ok(())
}

/// `dev probe`: what a server enforces.
pub async fn probe(talk: &Printer, config: &Config, author: &str) -> Result<(), Diagnostic> {
    let found = socrates_author::probe(author, &keys(config)?).await.map_err(|why| {
        Diagnostic::input(why.to_string(), "`socrates config author` shows address and key").with_code(Code::Author)
    })?;
    let rung = found.rung.map_or("none", Rung::name);
    let (kept, told) = match found.kept {
        Kept::Enforced => ("enforced", "it cannot answer in another form"),
        Kept::Hinted => ("hinted", "it answers in JSON with what it likes; every answer is checked in any case"),
        Kept::Ignored => ("ignored", "it answers with any text; expect answers that have to be asked for again"),
    };
    talk.line(&format!("model      {}", found.model));
    for step in &found.steps {
        talk.line(&format!("           {step}"));
    }
    talk.line(&format!("form       {rung}: {kept}, {told}"));
    talk.result(&serde_json::json!({"model": found.model, "form": rung, "kept": kept, "steps": found.steps}));
    Ok(())
}

/// Where the settings of a kind of server stand.
fn part(dialect: Dialect) -> String {
    if dialect == Dialect::OpenAi { "author.".to_owned() } else { format!("author.{dialect}.") }
}

/// The key of a kind of server: of its variable, else of its file.
fn key(config: &Config, part: &str) -> Result<Option<ApiKey>, Diagnostic> {
    let variable = config.text(&format!("{part}key_variable"));
    let found = Some(variable).filter(|name| !name.is_empty()).and_then(|name| config.variable(&name));
    if let Some(key) = found.filter(|key| !key.trim().is_empty()) {
        return Ok(Some(ApiKey::new(key)));
    }
    let file = config.text(&format!("{part}key_file"));
    if file.is_empty() {
        return Ok(None);
    }
    let path = Path::new(&file);
    let unusable = |why: String| {
        Diagnostic::input(
            format!("the key file `{file}` cannot be used: {why}"),
            format!("`{part}key_file` names a file that holds the key alone"),
        )
    };
    let size = std::fs::metadata(path).map_err(|why| unusable(why.to_string()))?.len();
    if size > MAX_KEY_BYTES {
        return Err(unusable(format!("it has {size} bytes")));
    }
    let text = std::fs::read_to_string(path).map_err(|why| unusable(why.to_string()))?;
    Ok(Some(ApiKey::new(&text)).filter(|key| !key.is_empty()))
}

fn word<T: std::str::FromStr<Err: std::fmt::Display>>(key: &str, text: &str, more: &str) -> Result<T, Diagnostic> {
    text.parse::<T>().map_err(|why| {
        Diagnostic::input(format!("`{key}`: {why}"), format!("it also takes {}", more.trim_end_matches(", ")))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Program;

    fn config(flags: &[&str]) -> Config {
        let flags: Vec<String> = flags.iter().map(|flag| (*flag).to_owned()).collect();
        Config::load(None, std::iter::empty(), &flags).unwrap()
    }

    #[test]
    fn a_key_comes_from_its_file_and_prints_nowhere() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("key");
        std::fs::write(&file, "sk-of-the-file\n").unwrap();
        let config = config(&["author.key_variable=", &format!("author.key_file={}", file.display())]);
        assert!(key_found(&config).unwrap());
        let keys = keys(&config).unwrap();
        assert!(!format!("{keys:?} {:?}", config.lines(None)).contains("sk-of-the-file"));
        assert!(keys.servers[&Dialect::OpenAi].key.is_some() && keys.servers[&Dialect::Ollama].key.is_none());
    }

    #[test]
    fn auto_is_a_key_then_a_server_on_this_machine_then_rules() {
        let servers = ["ollama", "llamacpp", "vllm", "lmstudio"];
        let closed = || std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
        let urls: Vec<String> = servers.map(|kind| format!("author.{kind}.url=http://{}/v1", closed())).into();
        let flags = |more: &[&str]| {
            let all: Vec<&str> = urls.iter().map(String::as_str).chain(more.iter().copied()).collect();
            config(&all)
        };
        let program = || Program { file: None, build: String::new(), temp: "/tmp".into() };
        let none = flags(&[]).of(program());
        let (author, why) = auto(&none).unwrap();
        assert_eq!(author, AuthorSpec::Offline);
        assert!(why.contains("no key found, no server on this machine"), "{why}");
        assert_eq!(servers_here(&none).unwrap().len(), servers.len());

        let found = flags(&[]).of(program());
        let model = |name: &str| Ok(name.to_owned());
        let server = |kind, model| LocalServer { kind, url: String::new(), model };
        let here = vec![server(ServerKind::Vllm, Err(String::new())), server(ServerKind::LmStudio, model("m:7b"))];
        found.servers().unwrap().set(here).unwrap();
        let (author, why) = auto(&found).unwrap();
        assert_eq!(author.to_string(), "lmstudio:m:7b");
        assert!(why.starts_with("lmstudio:m:7b (found on this machine; no key found"), "{why}");
        let recorded = settled("record:tape=replay:old=auto".parse().unwrap(), &found).unwrap();
        assert_eq!(recorded.to_string(), "record:tape=replay:old=lmstudio:m:7b");
        // Workers of a cluster have other servers around them, and other addresses want another look.
        assert_eq!(auto(&found.without_servers()).unwrap().0, AuthorSpec::Offline);
        assert!(found.clone().with(&[]).unwrap().servers().unwrap().get().is_none());

        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("key");
        std::fs::write(&file, "sk-of-the-file").unwrap();
        let key = format!("author.key_file={}", file.display());
        let keyed = found.with(&[key, "author.model=m".to_owned()]).unwrap();
        assert_eq!(auto(&keyed).unwrap().0.to_string(), "openai:m");
        assert!(keyed.servers().unwrap().get().is_none(), "nothing is looked for where there is a key");
    }

    #[test]
    fn the_time_that_is_configured_is_the_time_that_an_author_has() {
        let slow = config(&["author.timeout_s=500", "author.longest_s=600", "author.stream=false"]);
        let known = keys(&slow).unwrap();
        assert_eq!(known.silence.zip(known.longest), Some((Duration::from_secs(500), Duration::from_secs(600))));
        assert!(known.in_one_piece && !keys(&config(&[])).unwrap().in_one_piece);
        let (author, ..) = deadlines_ms(&slow).unwrap();
        assert!(author > 600_000, "the attempt of {author} ms does not end before its call");
        let told = consequences(&slow).unwrap().join("\n");
        assert!(told.contains("500 s") && told.contains("630 s") && told.contains("4 times"), "{told}");
        for wrong in ["author.timeout_s=0", "author.longest_s=100000", "orchestrator.simulation_s=0"] {
            let key = wrong.split('=').next().unwrap();
            assert!(deadlines_ms(&config(&[wrong])).unwrap_err().what.contains(key), "{wrong}");
        }
    }

    #[test]
    fn every_key_that_a_page_of_a_fault_names_exists() {
        let config = config(&[]);
        let known: Vec<String> = config.lines(None).into_iter().map(|(key, ..)| key).collect();
        let sections: Vec<&str> = known.iter().filter_map(|key| key.split('.').next()).collect();
        let mut named = 0;
        for code in socrates_model::FaultCode::ALL {
            for word in code.page().split('`').skip(1).step_by(2) {
                let is_key = word.split_once('.').is_some_and(|(section, rest)| {
                    sections.contains(&section) && rest.chars().all(|c| c.is_ascii_lowercase() || "_.".contains(c))
                });
                if is_key {
                    named += 1;
                    assert!(known.iter().any(|key| key == word), "{}: there is no `{word}`", code.code());
                }
            }
        }
        assert!(named >= 4, "{named}");
    }

    #[test]
    fn settings_that_cannot_be_used_are_named() {
        let told = |flags: &[&str]| keys(&config(flags)).unwrap_err().to_string();
        assert!(told(&["author.key_variable=", "author.key_file=/no/such/key"]).contains("/no/such/key"));
        assert!(told(&["author.form=strict"]).contains("`author.form`: `strict` is unknown"));
        let by = |word: &str| paths_by(&config(&[&format!("author.paths_by={word}")]), &AuthorSpec::Auto);
        assert!(by("solver").unwrap().is_empty() && by("model").unwrap()["paths_by"] == "model");
        assert!(by("oracle").unwrap_err().to_string().contains("allowed: model, model_alone, solver"));
        let why = style(&config(&["author.paths=edges"])).unwrap_err().to_string();
        assert!(why.contains("`author.paths`: `edges` is unknown; allowed: anchors, nodes, walk"), "{why}");
        assert!(style(&config(&[])).unwrap().is_empty());
        assert_eq!(style(&config(&["author.image=off"])).unwrap()["prompt.image"], "off");
    }
}
