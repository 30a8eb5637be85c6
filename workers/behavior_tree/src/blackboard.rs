//! The blackboard: entries by slot, and ports that read them. Texts are read as numbers once, when they are written.

use std::borrow::Cow;
use std::fmt;
use std::sync::Arc;

use socrates_model::Gesture;

/// A text with what it reads as.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Written {
    pub(crate) text: String,
    number: Option<f64>,
    whole: Option<i64>,
    flag: Option<bool>,
    /// Whether the text is just how the number is printed, so that the number can stand for it.
    plain: bool,
}

impl Written {
    pub(crate) fn new(text: &str) -> Self {
        let trimmed = text.trim();
        let number: Option<f64> = trimmed.parse().ok();
        Self {
            text: text.to_owned(),
            number,
            whole: trimmed.parse().ok(),
            flag: read_flag(text),
            // `-0` would read as 0 in one way and not in another.
            plain: number.is_some_and(|number| number.to_string() == text && text != "-0"),
        }
    }

    /// The text as a value.
    pub(crate) fn value(self: &Arc<Self>) -> Value {
        match self.number {
            Some(number) if self.plain => Value::Numeral(number),
            Some(_) | None => Value::Text(Arc::clone(self)),
        }
    }
}

/// A value of the blackboard; 16 bytes, and never a copy of a text.
#[derive(Debug, Clone)]
pub(crate) enum Value {
    /// As written in XML.
    Text(Arc<Written>),
    /// A text that is just how this number is printed.
    Numeral(f64),
    /// A number, from a script or a leaf.
    Number(f64),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(written) => f.write_str(&written.text),
            Self::Numeral(number) | Self::Number(number) => write!(f, "{number}"),
        }
    }
}

impl PartialEq for Value {
    fn eq(&self, other: &Self) -> bool {
        self.is_text() == other.is_text() && self.same_text(other)
    }
}

impl Value {
    /// A text as a value.
    pub(crate) fn of_text(text: &str) -> Self {
        Arc::new(Written::new(text)).value()
    }

    /// Whether it is a text, be it one that reads as a number.
    pub(crate) const fn is_text(&self) -> bool {
        matches!(self, Self::Text(_) | Self::Numeral(_))
    }

    /// Whether both are printed the same way.
    pub(crate) fn same_text(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Text(a), Self::Text(b)) => Arc::ptr_eq(a, b) || a.text == b.text,
            (Self::Numeral(a) | Self::Number(a), Self::Numeral(b) | Self::Number(b)) => {
                a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
            }
            // A text that is printed as a number is never kept as a text.
            (Self::Text(_), _) | (_, Self::Text(_)) => false,
        }
    }

    /// As a number, if it is one.
    pub(crate) fn number(&self) -> Option<f64> {
        match self {
            Self::Text(written) => written.number,
            Self::Numeral(number) | Self::Number(number) => Some(*number),
        }
    }

    /// As a whole number, if it is one.
    pub(crate) fn whole(&self) -> Option<i64> {
        match self {
            Self::Text(written) => written.whole,
            Self::Numeral(number) | Self::Number(number) => whole_of(*number),
        }
    }

    /// Whether blanks surround the text or a plus sign begins it; it then reads as a number in ports, but not where the whole
    /// text must be one.
    pub(crate) fn is_padded(&self) -> bool {
        match self {
            Self::Text(written) => written.text.trim().len() != written.text.len() || written.text.starts_with('+'),
            Self::Numeral(_) | Self::Number(_) => false,
        }
    }

    /// As a truth value of a port.
    fn port_flag(&self) -> Option<bool> {
        match self {
            Self::Text(written) => written.flag,
            Self::Numeral(number) | Self::Number(number) => match whole_of(*number) {
                Some(1) => Some(true),
                Some(0) => Some(false),
                Some(_) | None => None,
            },
        }
    }

    /// As a truth value of a script: `true`, `1` and numbers other than 0 are true.
    pub(crate) fn flag(&self) -> bool {
        match self {
            Self::Text(written) => written.flag.unwrap_or(false),
            Self::Numeral(_) => self.port_flag().unwrap_or(false),
            Self::Number(number) => *number != 0.0,
        }
    }
}

/// A real that is a whole number, as it would be read from its print.
fn whole_of(number: f64) -> Option<i64> {
    const LARGEST: f64 = 9.2e18;
    (number.fract() == 0.0 && number.abs() < LARGEST).then_some(number as i64)
}

/// What stands in a port: a text known when the tree is read, or a slot read at every tick.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Input {
    /// Known.
    Fixed(Arc<Written>),
    /// An entry of the blackboard.
    Slot(usize),
}

impl Input {
    /// A known text.
    pub(crate) fn fixed(text: &str) -> Self {
        Self::Fixed(Arc::new(Written::new(text)))
    }
}

/// Reads `true`, `True`, `1`, `false`, `False`, `0`.
pub(crate) fn read_flag(text: &str) -> Option<bool> {
    match text.trim() {
        "true" | "True" | "TRUE" | "1" => Some(true),
        "false" | "False" | "FALSE" | "0" => Some(false),
        _ => None,
    }
}

/// The ports of one node with the blackboard they read.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ports<'a> {
    pub(crate) inputs: &'a [Input],
    pub(crate) board: &'a [Option<Value>],
}

impl<'a> Ports<'a> {
    /// The entry of a slot.
    fn entry(&self, slot: usize) -> Option<&'a Value> {
        self.board.get(slot)?.as_ref()
    }

    /// Value of a port; `None` where the entry is not set.
    pub(crate) fn value(&self, port: usize) -> Option<Value> {
        match self.inputs.get(port)? {
            Input::Fixed(written) => Some(written.value()),
            Input::Slot(slot) => self.entry(*slot).cloned(),
        }
    }

    /// Text of a port; `None` where the entry is not set.
    pub(crate) fn text(&self, port: usize) -> Option<Cow<'a, str>> {
        match self.inputs.get(port)? {
            Input::Fixed(written) => Some(Cow::Borrowed(&written.text)),
            Input::Slot(slot) => Some(match self.entry(*slot)? {
                Value::Text(written) => Cow::Borrowed(written.text.as_str()),
                value @ (Value::Numeral(_) | Value::Number(_)) => Cow::Owned(value.to_string()),
            }),
        }
    }

    /// Number of a port.
    pub(crate) fn real(&self, port: usize) -> Option<f64> {
        match self.inputs.get(port)? {
            Input::Fixed(written) => written.number,
            Input::Slot(slot) => self.entry(*slot)?.number(),
        }
    }

    /// Whole number of a port.
    pub(crate) fn whole(&self, port: usize) -> Option<i64> {
        match self.inputs.get(port)? {
            Input::Fixed(written) => written.whole,
            Input::Slot(slot) => self.entry(*slot)?.whole(),
        }
    }

    /// Truth value of a port.
    pub(crate) fn flag(&self, port: usize) -> Option<bool> {
        match self.inputs.get(port)? {
            Input::Fixed(written) => written.flag,
            Input::Slot(slot) => self.entry(*slot)?.port_flag(),
        }
    }

    /// What a port says: a gesture, or none for the code 0; `None` where there is no code of the table.
    pub(crate) fn said(&self, port: usize) -> Option<Option<Gesture>> {
        u8::try_from(self.whole(port)?).ok().and_then(|code| Gesture::from_code(code).ok())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_small_and_a_plain_number_keeps_no_text() {
        assert_eq!(size_of::<Option<Value>>(), 16);
        assert!(matches!(Value::of_text("0.01"), Value::Numeral(_)));
        assert!(matches!(Value::of_text("1.0"), Value::Text(_)));
        assert!(matches!(Value::of_text("red"), Value::Text(_)));
    }

    #[test]
    fn a_numeral_reads_as_its_text_would() {
        for text in ["1", "0", "-3", "0.5", "inf", "NaN", "true", "1.0", " 7", "1e3", "-0", "9007199254740993", "x"] {
            let value = Value::of_text(text);
            let written = Arc::new(Written::new(text));
            assert_eq!(value.to_string(), text);
            assert_eq!(value.whole(), if written.plain { written.whole } else { text.trim().parse().ok() }, "{text}");
            assert_eq!(value.port_flag(), read_flag(text), "{text}");
            assert!(value.same_text(&Value::of_text(text)), "{text}");
        }
        assert!(!Value::of_text("1").same_text(&Value::of_text("1.0")));
        assert!(Value::Number(2.0).same_text(&Value::of_text("2")));
        assert_ne!(Value::Number(2.0), Value::of_text("2"));
    }
}
