//! Configuration: built-in, file, environment, flag; each value remembers where it came from.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use socrates_author::here::LocalServer;

use crate::exit::{Code, Diagnostic};

/// The default configuration is also the manual.
pub const BUILT_IN: &str = include_str!("../../../deploy/socrates.toml");

/// Prefix of environment variables: `SOCRATES_SUPERVISOR__WORKERS=2` sets `supervisor.workers`.
const ENV_PREFIX: &str = "SOCRATES_";

/// The running program and its place, as its caller knows them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Program {
    /// Its file, which children are started from.
    pub file: Option<PathBuf>,
    /// What it was built from.
    pub build: String,
    /// Folder for files that are soon removed again.
    pub temp: PathBuf,
}

/// Effective values by dotted key, and what else surrounds a verb.
#[derive(Debug, Clone)]
pub struct Config {
    values: BTreeMap<String, (toml::Value, String)>,
    variables: BTreeMap<String, String>,
    /// What children of this process are told, so that their values are the same.
    passed_on: Vec<String>,
    program: Program,
    /// Servers of this machine, once they were looked for; none where they are not.
    servers: Option<Arc<OnceLock<Vec<LocalServer>>>>,
}

impl Config {
    /// Reads all layers.
    pub fn load(
        file: Option<&Path>,
        env: impl Iterator<Item = (String, String)>,
        flags: &[String],
    ) -> Result<Self, Diagnostic> {
        let variables: BTreeMap<String, String> = env.collect();
        let mut values = BTreeMap::new();
        let built_in = parse(BUILT_IN, "built-in")?;
        flatten("", &built_in, "built-in", &mut values);
        let found = file.unwrap_or_else(|| Path::new("socrates.toml"));
        if file.is_some() || found.is_file() {
            let text = std::fs::read_to_string(found).map_err(|why| {
                Diagnostic::input(
                    format!("cannot read the configuration `{}`: {why}", found.display()),
                    "check the path after --config",
                )
            })?;
            let mut layer = BTreeMap::new();
            flatten("", &parse(&text, &found.display().to_string())?, &found.display().to_string(), &mut layer);
            for (key, entry) in layer {
                known(&values, &key, &found.display().to_string())?;
                same_kind(&values, &key, &entry)?;
                values.insert(key, entry);
            }
        }
        for (name, text) in &variables {
            let Some(rest) = name.strip_prefix(ENV_PREFIX) else { continue };
            let key = rest.to_lowercase().replace("__", ".");
            if values.contains_key(&key) {
                let value = typed(&values, &key, text, name)?;
                values.insert(key, (value, format!("environment {name}")));
            }
        }
        let passed_on = file.iter().flat_map(|file| ["--config".to_owned(), file.display().to_string()]).collect();
        let program = Program { file: None, build: String::new(), temp: PathBuf::from("/tmp") };
        Self { values, variables, passed_on, program, servers: None }.with(flags)
    }

    /// The same with these values, written `key=value`, over its own.
    pub fn with(mut self, flags: &[String]) -> Result<Self, Diagnostic> {
        let values = &mut self.values;
        for flag in flags {
            let (key, text) = flag.split_once('=').ok_or_else(|| {
                Diagnostic::input(
                    format!("`--set {flag}` has no value"),
                    "write --set key=value, for example --set supervisor.workers=2",
                )
            })?;
            known(values, key, "--set")?;
            let value = typed(values, key, text, "--set")?;
            values.insert(key.to_owned(), (value, "flag --set".to_owned()));
            self.passed_on.extend(["--set".to_owned(), flag.clone()]);
        }
        // Addresses may have changed.
        self.servers = self.servers.map(|_| Arc::default());
        Ok(self)
    }

    /// The same for this program, which a person started: it may look for servers of language models on this machine.
    pub fn of(self, program: Program) -> Self {
        Self { program, servers: Some(Arc::default()), ..self }
    }

    /// The same without servers of this machine: for work on other machines, which reaches none of them, and for work by rules.
    pub(crate) fn without_servers(&self) -> Self {
        Self { servers: None, ..self.clone() }
    }

    /// Where servers of this machine are kept once they were looked for; none where they are not looked for.
    pub(crate) fn servers(&self) -> Option<&OnceLock<Vec<LocalServer>>> {
        self.servers.as_deref()
    }

    /// The running program.
    pub const fn program(&self) -> &Program {
        &self.program
    }

    /// The file of the running program.
    pub(crate) fn executable(&self) -> Result<&Path, Diagnostic> {
        self.program.file.as_deref().ok_or_else(|| {
            Diagnostic::input("this program cannot find itself", "`socrates doctor` checks this machine")
                .with_code(Code::Ours)
        })
    }

    /// Flags that give a child the same configuration.
    pub fn passed_on(&self) -> &[String] {
        &self.passed_on
    }

    /// A variable of the environment, where it is set and not empty.
    pub(crate) fn variable(&self, name: &str) -> Option<&str> {
        self.variables.get(name).map(String::as_str).filter(|text| !text.is_empty())
    }

    /// A program by its name, where the environment says that programs are.
    pub(crate) fn installed(&self, name: &str) -> Option<PathBuf> {
        std::env::split_paths(self.variable("PATH")?).map(|folder| folder.join(name)).find(|file| file.is_file())
    }

    /// A text value.
    pub fn text(&self, key: &str) -> String {
        self.values.get(key).and_then(|(value, _)| value.as_str()).unwrap_or_default().to_owned()
    }

    /// A truth value.
    pub fn truth(&self, key: &str) -> bool {
        self.values.get(key).and_then(|(value, _)| value.as_bool()).unwrap_or_default()
    }

    /// A whole number.
    pub fn number(&self, key: &str) -> u64 {
        self.values
            .get(key)
            .and_then(|(value, _)| value.as_integer())
            .and_then(|n| u64::try_from(n).ok())
            .unwrap_or_default()
    }

    /// Every value with its origin, in order of the keys.
    pub fn lines(&self, part: Option<&str>) -> Vec<(String, String, String)> {
        self.values
            .iter()
            .filter(|(key, _)| part.is_none_or(|part| key.starts_with(part)))
            .map(|(key, (value, origin))| (key.clone(), value.to_string(), origin.clone()))
            .collect()
    }
}

fn parse(text: &str, origin: &str) -> Result<toml::Table, Diagnostic> {
    text.parse::<toml::Table>().map_err(|why| {
        Diagnostic::input(
            format!("the configuration `{origin}` is not valid TOML: {why}"),
            "`socrates config` prints a valid one",
        )
    })
}

fn flatten(prefix: &str, table: &toml::Table, origin: &str, out: &mut BTreeMap<String, (toml::Value, String)>) {
    for (name, value) in table {
        let key = if prefix.is_empty() { name.clone() } else { format!("{prefix}.{name}") };
        match value {
            toml::Value::Table(inner) => flatten(&key, inner, origin, out),
            toml::Value::String(_)
            | toml::Value::Integer(_)
            | toml::Value::Float(_)
            | toml::Value::Boolean(_)
            | toml::Value::Datetime(_)
            | toml::Value::Array(_) => {
                out.insert(key, (value.clone(), origin.to_owned()));
            }
        }
    }
}

fn known(values: &BTreeMap<String, (toml::Value, String)>, key: &str, origin: &str) -> Result<(), Diagnostic> {
    if values.contains_key(key) {
        return Ok(());
    }
    let all = values.keys().cloned().collect::<Vec<_>>().join(", ");
    Err(Diagnostic::input(format!("{origin}: unknown configuration key `{key}`"), format!("allowed keys: {all}")))
}

/// A file has the kinds of the built-in values: a text where a number is due would be read as 0.
fn same_kind(
    values: &BTreeMap<String, (toml::Value, String)>,
    key: &str,
    (value, origin): &(toml::Value, String),
) -> Result<(), Diagnostic> {
    let Some((due, _)) = values.get(key) else { return Ok(()) };
    let is_whole = matches!((due, value), (toml::Value::Float(_), toml::Value::Integer(_)));
    // Counts are whole numbers from 0.
    let is_negative = value.as_integer().is_some_and(|number| number < 0);
    if (due.same_type(value) || is_whole) && !is_negative {
        return Ok(());
    }
    let (found, kind) = (value.type_str(), due.type_str());
    Err(Diagnostic::input(
        format!("{origin}: `{key}` is `{value}`, {found}"),
        format!("it takes {kind}, such as `{due}`; `socrates config` prints the manual"),
    ))
}

fn typed(
    values: &BTreeMap<String, (toml::Value, String)>,
    key: &str,
    text: &str,
    origin: &str,
) -> Result<toml::Value, Diagnostic> {
    let wrong = |what: &str| {
        Diagnostic::input(
            format!("{origin}: `{key}` is `{text}`"),
            format!("it takes {what}; `socrates config` prints the manual"),
        )
    };
    match values.get(key).map(|(value, _)| value) {
        Some(toml::Value::Integer(_)) => {
            text.parse::<i64>().map(toml::Value::Integer).map_err(|_why| wrong("a whole number"))
        }
        Some(toml::Value::Float(_)) => text.parse::<f64>().map(toml::Value::Float).map_err(|_why| wrong("a number")),
        Some(toml::Value::Boolean(_)) => {
            text.parse::<bool>().map(toml::Value::Boolean).map_err(|_why| wrong("true or false"))
        }
        Some(toml::Value::String(_) | toml::Value::Datetime(_) | toml::Value::Array(_) | toml::Value::Table(_))
        | None => Ok(toml::Value::String(text.to_owned())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flag_wins_over_the_environment_and_an_unknown_key_is_named() {
        let env = || [("SOCRATES_SUPERVISOR__WORKERS".to_owned(), "3".to_owned())].into_iter();
        let config = Config::load(None, env(), &[]).unwrap();
        assert_eq!(config.number("supervisor.workers"), 3);
        let config = Config::load(None, env(), &["supervisor.workers=2".to_owned()]).unwrap();
        assert_eq!(config.number("supervisor.workers"), 2);
        let why = Config::load(None, env(), &["supervisor.wrokers=2".to_owned()]).unwrap_err();
        assert!(why.to_string().contains("wrokers"));
        let why = Config::load(None, env(), &["supervisor.workers=two".to_owned()]).unwrap_err();
        assert!(why.to_string().contains("a whole number"));
    }

    #[test]
    fn a_file_with_a_text_for_a_number_is_refused_with_its_name_and_key() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("socrates.toml");
        for (text, words) in [
            ("[supervisor]\nworkers = \"two\"\n", ["socrates.toml", "supervisor.workers", "two"]),
            ("[supervisor]\nworkers = -2\n", ["socrates.toml", "supervisor.workers", "-2"]),
        ] {
            std::fs::write(&file, text).unwrap();
            let why = Config::load(Some(&file), std::iter::empty(), &[]).unwrap_err().to_string();
            assert!(words.iter().all(|word| why.contains(word)), "{why}");
        }
    }
}
