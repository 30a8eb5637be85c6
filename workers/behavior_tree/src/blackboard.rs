//! The blackboard: entries by slot, and ports that read them.

use std::fmt;

use socrates_model::Gesture;

/// A value of the blackboard.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Value {
    /// As written in XML.
    Text(String),
    /// From a script.
    Number(f64),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(text) => f.write_str(text),
            Self::Number(number) => write!(f, "{number}"),
        }
    }
}

impl Value {
    /// As a number, if it is one.
    pub(crate) fn number(&self) -> Option<f64> {
        match self {
            Self::Text(text) => text.trim().parse().ok(),
            Self::Number(number) => Some(*number),
        }
    }

    /// As a truth value: `true`, `1` and numbers other than 0 are true.
    pub(crate) fn flag(&self) -> bool {
        match self {
            Self::Text(text) => read_flag(text).unwrap_or(false),
            Self::Number(number) => *number != 0.0,
        }
    }
}

/// What stands in a port: a text known when the tree is read, or a slot read at every tick.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Input {
    /// Known.
    Fixed(String),
    /// An entry of the blackboard.
    Slot(usize),
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

impl Ports<'_> {
    /// Text of a port; `None` where the entry is not set.
    pub(crate) fn text(&self, port: usize) -> Option<String> {
        match self.inputs.get(port)? {
            Input::Fixed(text) => Some(text.clone()),
            Input::Slot(slot) => self.board.get(*slot)?.as_ref().map(ToString::to_string),
        }
    }

    /// Number of a port.
    pub(crate) fn real(&self, port: usize) -> Option<f64> {
        match self.inputs.get(port)? {
            Input::Fixed(text) => text.trim().parse().ok(),
            Input::Slot(slot) => self.board.get(*slot)?.as_ref()?.number(),
        }
    }

    /// Whole number of a port.
    pub(crate) fn whole(&self, port: usize) -> Option<i64> {
        match self.inputs.get(port)? {
            Input::Fixed(text) => text.trim().parse().ok(),
            Input::Slot(_) => self.text(port)?.trim().parse().ok(),
        }
    }

    /// Truth value of a port.
    pub(crate) fn flag(&self, port: usize) -> Option<bool> {
        match self.inputs.get(port)? {
            Input::Fixed(text) => read_flag(text),
            Input::Slot(_) => read_flag(&self.text(port)?),
        }
    }

    /// Gesture of a port.
    pub(crate) fn gesture(&self, port: usize) -> Option<Gesture> {
        u8::try_from(self.whole(port)?).ok().and_then(Gesture::from_code)
    }
}
