//! The text of a request as values that know where they stand.

use std::fmt;
use std::ops::Range;

use serde_json::Value;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Deepest nesting that is read; a request has four.
const DEEPEST: usize = 16;

/// A place in a text: line and column, both from 1; the column counts characters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct TextPlace {
    /// The line.
    pub line: usize,
    /// The column.
    pub column: usize,
}

impl TextPlace {
    /// The place of a byte of a text.
    fn of(text: &str, byte: usize) -> Self {
        let before = text.get(..byte).unwrap_or(text);
        let line = before.bytes().filter(|byte| *byte == b'\n').count() + 1;
        let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
        Self { line, column }
    }
}

impl fmt::Display for TextPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.line, self.column)
    }
}

/// A value and where it stands; values that come as JSON stand nowhere.
#[derive(Debug, Clone)]
pub(super) struct Node {
    pub(super) at: Option<TextPlace>,
    pub(super) kind: Kind,
}

/// A value.
#[derive(Debug, Clone)]
pub(super) enum Kind {
    /// Names with their own places.
    Table(Vec<(String, Option<TextPlace>, Node)>),
    /// A list.
    List(Vec<Node>),
    /// A text, a number or a truth value.
    Plain(Value),
    /// What no key of a request takes, by name.
    Odd(&'static str),
}

impl Kind {
    /// What it is, for messages.
    pub(super) const fn name(&self) -> &'static str {
        match self {
            Self::Table(_) => "a table",
            Self::List(_) => "a list",
            Self::Plain(Value::String(_)) => "a text",
            Self::Plain(Value::Number(_)) => "a number",
            Self::Plain(Value::Bool(_)) => "a truth value",
            Self::Plain(_) => "nothing",
            Self::Odd(name) => name,
        }
    }
}

/// What is wrong with the text itself, before its keys are looked at.
pub(super) struct BadText {
    pub(super) at: Option<TextPlace>,
    pub(super) message: String,
}

impl Node {
    /// The table of a TOML text, or everything that keeps it from being one.
    pub(super) fn of_toml(text: &str) -> Result<Self, Vec<BadText>> {
        let (table, errors) = DeTable::parse_recoverable(text);
        let place = |span: Range<usize>| TextPlace::of(text, span.start);
        if !errors.is_empty() {
            let bad =
                |error: &toml::de::Error| BadText { at: error.span().map(place), message: error.message().to_owned() };
            return Err(errors.iter().map(bad).collect());
        }
        let span = table.span();
        Ok(Self { at: Some(place(span)), kind: table_of(table.get_ref(), &place, DEEPEST) })
    }

    /// The same of a JSON value.
    pub(super) fn of_json(value: &Value) -> Self {
        let kind = match value {
            Value::Object(members) => {
                Kind::Table(members.iter().map(|(name, value)| (name.clone(), None, Self::of_json(value))).collect())
            }
            Value::Array(values) => Kind::List(values.iter().map(Self::of_json).collect()),
            Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => Kind::Plain(value.clone()),
        };
        Self { at: None, kind }
    }

    /// The value without places, for types that read themselves.
    pub(super) fn value(&self) -> Value {
        match &self.kind {
            Kind::Table(entries) => {
                Value::Object(entries.iter().map(|(name, _, node)| (name.clone(), node.value())).collect())
            }
            Kind::List(nodes) => Value::Array(nodes.iter().map(Self::value).collect()),
            Kind::Plain(value) => value.clone(),
            Kind::Odd(_) => Value::Null,
        }
    }
}

type Place<'a> = dyn Fn(Range<usize>) -> TextPlace + 'a;

fn table_of(table: &DeTable<'_>, place: &Place<'_>, deepest: usize) -> Kind {
    let entry = |(key, value): (&Spanned<std::borrow::Cow<'_, str>>, &Spanned<DeValue<'_>>)| {
        (key.get_ref().to_string(), Some(place(key.span())), node_of(value, place, deepest))
    };
    Kind::Table(table.iter().map(entry).collect())
}

fn node_of(value: &Spanned<DeValue<'_>>, place: &Place<'_>, deepest: usize) -> Node {
    let kind = match value.get_ref() {
        DeValue::String(text) => Kind::Plain(Value::String(text.to_string())),
        DeValue::Integer(digits) => {
            let (digits, radix) = (digits.as_str(), digits.radix());
            let signed = i64::from_str_radix(digits, radix).map(Value::from);
            let read = signed.or_else(|_wide| u64::from_str_radix(digits, radix).map(Value::from));
            read.map_or(Kind::Odd("a number that is too large"), Kind::Plain)
        }
        DeValue::Float(digits) => {
            let number = digits.as_str().parse::<f64>().ok().and_then(serde_json::Number::from_f64);
            number.map_or(Kind::Odd("no finite number"), |number| Kind::Plain(Value::Number(number)))
        }
        DeValue::Boolean(truth) => Kind::Plain(Value::Bool(*truth)),
        DeValue::Datetime(_) => Kind::Odd("a date"),
        DeValue::Array(_) | DeValue::Table(_) if deepest == 0 => Kind::Odd("nested too deep"),
        DeValue::Array(values) => Kind::List(values.iter().map(|value| node_of(value, place, deepest - 1)).collect()),
        DeValue::Table(table) => table_of(table, place, deepest - 1),
    };
    Node { at: Some(place(value.span())), kind }
}
