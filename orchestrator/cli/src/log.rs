//! The log of this process: words on standard error, or a JSON object a line; and the same lines in a file where one is kept.

use std::fmt::{Debug, Write as _};
use std::io::{IsTerminal as _, Write as _};

use serde_json::{Map, Value};
use socrates_app::config::Config;
use socrates_app::exit::Diagnostic;
use socrates_app::logs;
use tracing::field::{Field, Visit};
use tracing::span::{Attributes, Id, Record};
use tracing::{Event, Subscriber};
use tracing_subscriber::layer::{Context, Layer as _, SubscriberExt as _};
use tracing_subscriber::registry::LookupSpan;
use tracing_subscriber::util::SubscriberInitExt as _;
use tracing_subscriber::{EnvFilter, fmt};

/// Starts it as the configuration says.
pub(crate) fn start(config: &Config) -> Result<(), Diagnostic> {
    logs::strike_keys_of(config);
    let filter = |key: &str| {
        EnvFilter::try_new(config.text(key)).map_err(|why| {
            Diagnostic::input(
                format!("`{key}` is not a filter: {why}"),
                "for example \"warn\" or \"socrates_kit=debug\"",
            )
        })
    };
    let shown = filter("log.filter")?;
    let shown = match config.text("log.format").as_str() {
        "text" => {
            // Codes of colors are for terminals; in a file or a pipe they are letters that nobody wrote.
            let colored =
                std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|text| text.is_empty());
            let words = fmt::layer().with_ansi(colored).with_writer(std::io::stderr).without_time().compact();
            words.with_filter(shown).boxed()
        }
        "json" => Lines { kept: false }.with_filter(shown).boxed(),
        other => {
            let what = format!("`log.format` is `{other}`; it takes text or json");
            return Err(Diagnostic::input(what, "`socrates config log` prints the manual"));
        }
    };
    // Lines for a file are made only where there may be one.
    let kept = match config.text("log.keep").as_str() {
        "off" => None,
        _some => Some(Lines { kept: true }.with_filter(filter("log.keep")?)),
    };
    tracing_subscriber::registry().with(kept).with(shown).init();
    Ok(())
}

/// Writes events as JSON objects, a line each, with the fields of the spans round them.
struct Lines {
    /// Into the file that is kept; else on standard error.
    kept: bool,
}

/// Fields of a span or an event, without secrets.
#[derive(Debug, Default)]
struct Fields(Map<String, Value>);

impl Visit for Fields {
    fn record_str(&mut self, field: &Field, value: &str) {
        self.0.insert(field.name().to_owned(), logs::struck(value).into());
    }

    fn record_i64(&mut self, field: &Field, value: i64) {
        self.0.insert(field.name().to_owned(), value.into());
    }

    fn record_u64(&mut self, field: &Field, value: u64) {
        self.0.insert(field.name().to_owned(), value.into());
    }

    fn record_f64(&mut self, field: &Field, value: f64) {
        self.0.insert(field.name().to_owned(), value.into());
    }

    fn record_bool(&mut self, field: &Field, value: bool) {
        self.0.insert(field.name().to_owned(), value.into());
    }

    fn record_debug(&mut self, field: &Field, value: &dyn Debug) {
        self.0.insert(field.name().to_owned(), logs::struck(&format!("{value:?}")).into());
    }
}

/// A line: what everybody looks for first, then the fields by name.
fn line(event: &Event<'_>, mut fields: Map<String, Value>) -> String {
    let meta = event.metadata();
    // Libraries also say things by fields alone.
    let message = fields.remove("message").unwrap_or_else(|| Value::from(""));
    let process = logs::process();
    let head = [
        ("ts", Value::from(logs::stamp(logs::now_ms()))),
        ("level", meta.level().as_str().to_ascii_lowercase().into()),
        ("target", meta.target().into()),
        ("process", process.map_or(Value::Null, Value::from)),
        ("pid", std::process::id().into()),
        ("msg", message),
    ];
    let mut text = String::from("{");
    for (name, value) in head.into_iter().filter(|(_, value)| !value.is_null()) {
        let _written = write!(text, "\"{name}\":{value},");
    }
    for (name, value) in &fields {
        let _written = write!(text, "{}:{value},", Value::from(name.as_str()));
    }
    text.truncate(text.len() - 1);
    text.push_str("}\n");
    text
}

impl<S: Subscriber + for<'a> LookupSpan<'a>> tracing_subscriber::Layer<S> for Lines {
    fn on_new_span(&self, attributes: &Attributes<'_>, id: &Id, context: Context<'_, S>) {
        let Some(span) = context.span(id) else { return };
        let mut fields = Fields::default();
        attributes.record(&mut fields);
        span.extensions_mut().replace(fields);
    }

    fn on_record(&self, id: &Id, values: &Record<'_>, context: Context<'_, S>) {
        let Some(span) = context.span(id) else { return };
        if let Some(fields) = span.extensions_mut().get_mut::<Fields>() {
            values.record(fields);
        }
    }

    fn on_event(&self, event: &Event<'_>, context: Context<'_, S>) {
        if self.kept && !logs::is_kept() {
            return;
        }
        let mut all = Fields::default();
        for span in context.event_scope(event).into_iter().flat_map(|scope| scope.from_root()) {
            if let Some(fields) = span.extensions().get::<Fields>() {
                all.0.extend(fields.0.clone());
            }
        }
        event.record(&mut all);
        let line = line(event, all.0);
        if self.kept {
            logs::write(&line);
        } else {
            // Nothing else may fail for a log.
            drop(std::io::stderr().write_all(line.as_bytes()));
        }
    }
}
