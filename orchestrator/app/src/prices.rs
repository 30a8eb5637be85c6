//! Prices of models: the table that a user keeps, and the limits of money that need it.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;
use socrates_model::AuthorSpec;
use socrates_orchestrator::price_of;

use crate::config::Config;
use crate::exit::Diagnostic;

/// Largest table of prices that is read, bytes.
const MAX_PRICES_BYTES: u64 = 4 * 1024 * 1024;

/// Prices of one model, per million tokens.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Price {
    /// Of input.
    pub(crate) input: f64,
    /// Of input that came from the server's cache; without one, as other input.
    #[serde(default)]
    pub(crate) cached_input: Option<f64>,
    /// Of output.
    pub(crate) output: f64,
    #[serde(default = "dollars")]
    /// Its currency.
    pub(crate) currency: String,
    /// Since when they hold; for people.
    #[serde(default, rename = "valid_from")]
    pub(crate) _valid_from: Option<String>,
}

/// The currency where none is named.
pub(crate) fn dollars() -> String {
    "USD".to_owned()
}

/// Prices of a million tokens in and out by model, in millionths, of the table that the configuration names; none without one.
pub(crate) fn prices_of(config: &Config) -> Result<BTreeMap<String, (u64, u64)>, Diagnostic> {
    let named = config.text("author.prices");
    if named.is_empty() {
        return Ok(BTreeMap::new());
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "read_prices takes no negative one")]
    let millionths = |price: f64| (price * 1e6).round() as u64;
    let prices = read_prices(Path::new(&named))?;
    Ok(prices.into_iter().map(|(model, price)| (model, (millionths(price.input), millionths(price.output)))).collect())
}

/// A limit of money holds only where the author has a price.
pub(crate) fn check_limit(config: &Config, author: &AuthorSpec) -> Result<(), Diagnostic> {
    let limit = config.number("orchestrator.cents_per_scenario");
    check_cents(config, author, "orchestrator.cents_per_scenario", limit)
}

/// The same of a limit in cents that has another name; 0 sets none.
pub(crate) fn check_cents(config: &Config, author: &AuthorSpec, name: &str, limit: u64) -> Result<(), Diagnostic> {
    let Some((kind, model)) = author.server().filter(|_| limit > 0) else { return Ok(()) };
    if price_of(&prices_of(config)?, &format!("{}:{model}", kind.name())).is_some() {
        return Ok(());
    }
    Err(Diagnostic::input(
        format!("`{name}` is {limit}, but `{model}` has no price"),
        "`author.prices` names a table of prices; a model without one would be asked without a limit",
    ))
}

/// Prices by model.
pub fn read_prices(file: &Path) -> Result<BTreeMap<String, Price>, Diagnostic> {
    let hint = "each table is a model: [\"gpt-4o\"] with input, output, perhaps cached_input, currency, valid_from";
    let text = crate::files::text(file, MAX_PRICES_BYTES, hint)?;
    let prices: BTreeMap<String, Price> = toml::from_str(&text)
        .map_err(|why| Diagnostic::input(format!("`{}` is no table of prices: {why}", file.display()), hint))?;
    for (model, price) in &prices {
        let all = [price.input, price.output, price.cached_input.unwrap_or(0.0)];
        if all.iter().any(|value| !value.is_finite() || *value < 0.0) {
            let what = format!("`{}`: a price of `{model}` is negative or no number", file.display());
            return Err(Diagnostic::input(what, hint));
        }
    }
    Ok(prices)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_of_prices_that_cannot_be_used_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("prices.toml");
        for (text, word) in
            [("[m]\ninput = -1\noutput = 1", "negative"), ("[m]\nprice = 1", "no table"), ("x", "no table")]
        {
            std::fs::write(&file, text).unwrap();
            assert!(read_prices(&file).unwrap_err().to_string().contains(word), "{text}");
        }
        std::fs::write(&file, "[\"gpt-4o\"]\ninput = 2.5\noutput = 10\nvalid_from = \"2026-01\"").unwrap();
        assert_eq!(read_prices(&file).unwrap()["gpt-4o"].currency, "USD");
    }
}
