//! `cost`: what the authors of bundles were asked, in calls, tokens and money.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use serde::Deserialize as _;
use serde_json::{Value, json};
use socrates_author::{compiled, paths_by};
use socrates_model::{FaultCode, Signature};
use socrates_orchestrator::{pipeline, price_of};

use crate::bundle;
use crate::config::Config;
use crate::exit::Diagnostic;
use crate::ledger;
use crate::output::Printer;
use crate::prices::{Price, dollars, read_prices};

/// What one model was asked.
#[derive(Debug, Clone, Default, PartialEq)]
struct Sum {
    calls: u64,
    input: u64,
    cached: u64,
    output: u64,
    /// Of the output, what was thinking and stands in no text.
    thought: u64,
    estimated: bool,
    /// Of the calls, those that got no answer: their tokens are not known.
    unanswered: u64,
}

impl Sum {
    fn add(&mut self, other: &Self) {
        self.calls += other.calls;
        self.input += other.input;
        self.cached += other.cached;
        self.output += other.output;
        self.thought += other.thought;
        self.estimated |= other.estimated;
        self.unanswered += other.unanswered;
    }

    #[expect(clippy::cast_precision_loss, reason = "sums of tokens stay far below 2^53")]
    fn cost(&self, price: &Price) -> f64 {
        let cached = price.cached_input.unwrap_or(price.input);
        ((self.input.saturating_sub(self.cached)) as f64 * price.input
            + self.cached as f64 * cached
            + self.output as f64 * price.output)
            / 1e6
    }
}

/// Adds up the exchanges of bundles, of folders that hold bundles, and of folders of what was asked beside them.
pub fn cost(talk: &Printer, config: &Config, what: &[PathBuf], prices: Option<&Path>) -> Result<(), Diagnostic> {
    let named = config.text("author.prices");
    let file = prices.map(Path::to_path_buf).or_else(|| (!named.is_empty()).then(|| PathBuf::from(named)));
    let prices = file.as_deref().map_or_else(|| Ok(BTreeMap::new()), read_prices)?;
    let (mut ledgers, mut folders) = (Vec::new(), Vec::new());
    for path in what {
        match ledger::in_folder(path) {
            Some(file) => ledgers.push((path.clone(), sums(&ledger::read(&file)?))),
            None => folders.push(path.clone()),
        }
    }
    let bundles = bundles_in(&folders)?;
    let mut total: BTreeMap<String, Sum> = BTreeMap::new();
    let mut rows = Vec::new();
    let booked = ledgers.len();
    let of_bundles = bundles.iter().map(|bundle| Ok((bundle.clone(), exchanges(bundle)?)));
    for asked in ledgers.into_iter().map(Ok).chain(of_bundles) {
        let (bundle, models) = asked?;
        for (model, sum) in &models {
            total.entry(model.clone()).or_default().add(sum);
        }
        rows.push(json!({"bundle": bundle.display().to_string(), "models": lines(&models, &prices)}));
    }
    let width = total.keys().map(String::len).max().unwrap_or(0).max(7);
    talk.line(&format!(
        "{:width$}  {:>6}  {:>10}  {:>10}  {:>10}  {:>10}  cost",
        "author", "calls", "tokens in", "of cache", "tokens out", "of thought"
    ));
    for (model, sum) in &total {
        let mark = if sum.estimated { "~" } else { "" };
        let cost = money(model, sum, &prices)
            .map_or_else(|| "unknown price".to_owned(), |(cost, of)| format!("{cost:.4} {of}"));
        talk.line(&format!(
            "{model:width$}  {:>6}  {:>10}  {:>10}  {:>10}  {:>10}  {cost}",
            sum.calls,
            format!("{mark}{}", sum.input),
            sum.cached,
            format!("{mark}{}", sum.output),
            sum.thought
        ));
    }
    for (model, sum) in total.iter().filter(|(_, sum)| sum.unanswered > 0) {
        let calls = crate::words::plural(usize::try_from(sum.unanswered).unwrap_or(usize::MAX), "call");
        talk.line(&format!("{calls} of {model} got no answer; what they cost is not known and not in the sum"));
    }
    if booked > 0 {
        talk.line(&format!("{} of what was asked beside bundles", crate::words::plural(booked, "folder")));
    }
    talk.line(&format!("{} bundles; `~` marks figures that hold estimates (bytes / 4)", bundles.len()));
    if total.keys().any(|model| money(model, &Sum::default(), &prices).is_none()) {
        talk.line("hint: --prices FILE takes a table such as [\"gpt-4o\"] input = 2.5, cached_input = 1.25, output = 10.0 (per million)");
    }
    talk.result(&json!({"bundles": rows, "total": lines(&total, &prices)}));
    Ok(())
}

fn lines(models: &BTreeMap<String, Sum>, prices: &BTreeMap<String, Price>) -> Vec<Value> {
    models
        .iter()
        .map(|(model, sum)| {
            let cost = money(model, sum, prices);
            json!({"author": model, "calls": sum.calls, "tokens_in": sum.input, "cached": sum.cached,
                "tokens_out": sum.output, "thought": sum.thought, "estimated": sum.estimated, "unanswered": sum.unanswered,
                "cost": cost.as_ref().map(|(cost, _)| cost), "currency": cost.as_ref().map(|(_, currency)| currency)})
        })
        .collect()
}

/// The cost and its currency; nothing where the price is not known. The offline author costs nothing.
fn money(model: &str, sum: &Sum, prices: &BTreeMap<String, Price>) -> Option<(f64, String)> {
    if Signature::from(model).is_rules() {
        return Some((0.0, dollars()));
    }
    let price = price_of(prices, model)?;
    Some((sum.cost(price), price.currency.clone()))
}

/// The bundles among these folders and in them.
pub(crate) fn bundles_in(what: &[PathBuf]) -> Result<Vec<PathBuf>, Diagnostic> {
    let mut bundles = Vec::new();
    for path in what {
        let found = inside(path);
        if found.is_empty() {
            return Err(Diagnostic::input(
                format!("`{}` is neither a bundle nor a folder of bundles", path.display()),
                "name what `socrates run` wrote, such as runs/NAME",
            ));
        }
        bundles.extend(found);
    }
    Ok(bundles)
}

/// The folder itself where it is a bundle, else the bundles inside, in order of their names.
fn inside(path: &Path) -> Vec<PathBuf> {
    let is_bundle = |dir: &Path| bundle::archive(dir).is_some() || dir.join(crate::layout::PROVENANCE.path).is_file();
    if is_bundle(path) {
        return vec![path.to_path_buf()];
    }
    let entries = std::fs::read_dir(path).into_iter().flatten().filter_map(Result::ok);
    let mut found: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|dir| is_bundle(dir)).collect();
    found.sort();
    found
}

/// What each model was asked for a bundle: every attempt of every revision, refused ones included.
fn exchanges(dir: &Path) -> Result<BTreeMap<String, Sum>, Diagnostic> {
    let name = crate::layout::PROVENANCE.path;
    let provenance: Value = serde_json::from_slice(&bundle::file(dir, name)?)
        .map_err(|why| Diagnostic::input(format!("`{}`: {why}", dir.join(name).display()), "make the bundle again"))?;
    Ok(sums(&provenance))
}

/// The models that were asked for a bundle, or rules, by their names.
pub(crate) fn models(dir: &Path) -> Result<Vec<String>, Diagnostic> {
    Ok(exchanges(dir)?.into_keys().collect())
}

fn sums(provenance: &Value) -> BTreeMap<String, Sum> {
    let list = |value: &Value, key: &str| value.get(key).and_then(Value::as_array).cloned().unwrap_or_default();
    let mut models: BTreeMap<String, Sum> = BTreeMap::new();
    for job in list(provenance, "jobs") {
        let attempts = list(&job, "attempts");
        let of_attempts: Vec<Value> = attempts.iter().flat_map(|attempt| list(attempt, "exchanges")).collect();
        // The exchange of the attempt that was taken may stand with the job as well. Two attempts with the same exchange were
        // two calls: a question that got no answer is put again word for word.
        let seen: BTreeSet<String> = of_attempts.iter().map(Value::to_string).collect();
        let of_job = list(&job, "exchanges").into_iter().filter(|exchange| !seen.contains(&exchange.to_string()));
        for exchange in of_attempts.iter().cloned().chain(of_job).filter(Value::is_object) {
            let Some([input, output]) = tokens(&exchange) else { continue };
            let name = |key: &str| exchange.get(key).and_then(Value::as_str).filter(|name| !name.is_empty());
            let model = name("model").or_else(|| name("author")).unwrap_or("unknown");
            // Compiled rules and the solver's paths are no call of anybody.
            if [compiled::NAME, paths_by::NAME].contains(&model) {
                continue;
            }
            let unanswered = u64::from(name("model").is_none() && (input, output) == (0, 0));
            let how = exchange.get("how").cloned().unwrap_or_default();
            models.entry(model.to_owned()).or_default().add(&Sum {
                calls: 1,
                input,
                output,
                cached: how.get("cached").and_then(Value::as_u64).unwrap_or(0),
                thought: how.get("thought").and_then(Value::as_u64).unwrap_or(0),
                estimated: how.get("estimated").and_then(Value::as_bool).unwrap_or(false),
                unanswered,
            });
        }
        // An attempt that was ended from outside left no exchange, though its author was asked.
        let author = provenance.get("author").and_then(Value::as_str).unwrap_or("unknown");
        let lost = attempts.iter().filter(|attempt| is_authored(&job) && ended_from_outside(attempt)).count() as u64;
        if lost > 0 {
            models.entry(author.to_owned()).or_default().add(&Sum { calls: lost, unanswered: lost, ..Sum::default() });
        }
    }
    models
}

/// Whether an author was asked for this job.
fn is_authored(job: &Value) -> bool {
    let stage = job.pointer("/job/stage").and_then(Value::as_str).unwrap_or_default();
    stage.parse().is_ok_and(pipeline::is_authored)
}

/// Whether an attempt was ended by its deadline or the loss of its worker, with no word of its author.
fn ended_from_outside(attempt: &Value) -> bool {
    let is_empty = |key: &str| attempt.get(key).and_then(Value::as_array).is_none_or(Vec::is_empty);
    let faults = attempt.get("faults").and_then(Value::as_array).into_iter().flatten();
    let mut codes = faults.filter_map(|fault| FaultCode::deserialize(fault.get("code")?).ok());
    is_empty("exchanges") && codes.any(|code| matches!(code, FaultCode::JDeadline | FaultCode::JLost))
}

fn tokens(exchange: &Value) -> Option<[u64; 2]> {
    let pair = exchange.get("tokens")?.as_array()?;
    Some([pair.first()?.as_u64()?, pair.get(1)?.as_u64()?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_exchange_counts_once() {
        let exchange = |model: &str, answer: &str, tokens: [u64; 2]| json!({"model": model, "answer": answer, "tokens": tokens, "how": {"cached": 10, "thought": 5, "estimated": false}});
        let (bad, good) =
            (exchange("openai:gpt-4o-2024", "a", [100, 20]), exchange("openai:gpt-4o-2024", "b", [120, 30]));
        let provenance = json!({"jobs": [
            {"attempts": [{"exchanges": [bad, "refused text"]}, {"exchanges": [good]}], "exchanges": [good]},
            {"attempts": [], "exchanges": [exchange("offline/1", "c", [0, 0])]},
            {"attempts": [], "exchanges": [exchange("compiled/1", "d", [0, 0])]},
            {"attempts": [], "exchanges": [exchange("solver/1", "e", [0, 0])]},
        ]});
        let found = sums(&provenance);
        let sum = Sum { calls: 2, input: 220, cached: 20, output: 50, thought: 10, estimated: false, unanswered: 0 };
        assert_eq!(found["openai:gpt-4o-2024"], sum);
        let price =
            |input, cached_input| Price { input, cached_input, output: 10.0, currency: dollars(), _valid_from: None };
        let prices =
            BTreeMap::from([("gpt-4o".to_owned(), price(2.5, Some(1.0))), ("gpt-4".to_owned(), price(9.0, None))]);
        let (cost, _) = money("openai:gpt-4o-2024", &sum, &prices).unwrap();
        assert!((cost - (200.0 * 2.5 + 20.0 + 500.0) / 1e6).abs() < 1e-12);
        assert_eq!(money("anthropic:other", &sum, &prices), None);
        assert_eq!(money("offline/1", &sum, &prices).unwrap().0.to_bits(), 0.0_f64.to_bits());
    }

    #[test]
    fn a_question_that_got_no_answer_counts_as_often_as_it_was_put() {
        let silent = json!({"author": "openai:gpt-4o", "model": "", "answer": "", "tokens": [0, 0]});
        let answered = json!({"author": "openai:gpt-4o", "model": "openai:gpt-4o", "answer": "a", "tokens": [100, 20]});
        let ended = |code: &str| json!({"exchanges": [], "faults": [{"code": code}]});
        let job = |stage: &str| {
            json!({"job": {"stage": stage}, "exchanges": [answered],
                   "attempts": [{"exchanges": [silent]}, {"exchanges": [silent]}, ended("J-DEADLINE"), {"exchanges": []}]})
        };
        let found = sums(&json!({"author": "openai:gpt-4o", "jobs": [job("paths")]}));
        let sum = &found["openai:gpt-4o"];
        assert_eq!((sum.calls, sum.unanswered, sum.input), (4, 3, 100), "{found:?}");
        let found = sums(
            &json!({"author": "openai:gpt-4o", "jobs": [{"job": {"stage": "scoring"}, "attempts": [ended("J-DEADLINE")]}]}),
        );
        assert!(found.is_empty(), "scoring asks nobody: {found:?}");
    }
}
