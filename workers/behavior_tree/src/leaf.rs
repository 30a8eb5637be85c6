//! What a world is told about a leaf that it may tick itself.

use std::borrow::Cow;

use crate::blackboard::{Input, Ports, Value};
use crate::sheet::NodeSheet;

/// A leaf about to be ticked or just halted: which one, its ports by place, and whether it was running.
///
/// Ports are counted from 0 in the order of [`NodeSheet::ports`](crate::NodeSheet::ports) of the library the tree
/// was read with. Constants were read as numbers when the tree was; entries of the blackboard are read now.
#[derive(Debug)]
pub struct LeafCall<'a> {
    pub(crate) sheet: &'static NodeSheet,
    pub(crate) leaf: u16,
    pub(crate) running: bool,
    pub(crate) inputs: &'a [Input],
    pub(crate) board: &'a mut [Option<Value>],
}

impl LeafCall<'_> {
    /// Tag, as the catalog spells it.
    #[must_use]
    pub const fn tag(&self) -> &'static str {
        self.sheet.tag
    }

    /// The sheet of the leaf, in the library the tree was read with.
    #[must_use]
    pub const fn sheet(&self) -> &'static NodeSheet {
        self.sheet
    }

    /// Number of the leaf, from 1 to the length of [`Tree::leaf_names`](crate::Tree::leaf_names). It is the same
    /// in every tick and for every agent of the tree, so that a world may keep memory by it.
    #[must_use]
    pub const fn leaf(&self) -> u16 {
        self.leaf
    }

    /// Whether the leaf was running after the tick before: false where it starts.
    #[must_use]
    pub const fn is_running(&self) -> bool {
        self.running
    }

    /// Number in a port; `None` where there is none or it is not a number.
    #[must_use]
    pub fn real(&self, port: usize) -> Option<f64> {
        self.ports().real(port)
    }

    /// Whole number in a port; `None` where there is none or it is not whole.
    #[must_use]
    pub fn int(&self, port: usize) -> Option<i64> {
        self.ports().whole(port)
    }

    /// Truth value in a port: `true`, `True`, `1`, `false`, `False`, `0`.
    #[must_use]
    pub fn flag(&self, port: usize) -> Option<bool> {
        self.ports().flag(port)
    }

    /// Text in a port; `None` where its entry is not set.
    #[must_use]
    pub fn text(&self, port: usize) -> Option<Cow<'_, str>> {
        self.ports().text(port)
    }

    /// Writes the entry that stands in a port; says whether there is one.
    pub fn set(&mut self, port: usize, value: impl Into<LeafValue>) -> bool {
        let Some(Input::Slot(slot)) = self.inputs.get(port) else { return false };
        let Some(entry) = self.board.get_mut(*slot) else { return false };
        *entry = Some(match value.into() {
            LeafValue::Number(number) => Value::Number(number),
            LeafValue::Text(text) => Value::of_text(&text),
        });
        true
    }

    fn ports(&self) -> Ports<'_> {
        Ports { inputs: self.inputs, board: self.board }
    }
}

/// A value that a leaf writes.
#[derive(Debug, Clone, PartialEq)]
pub enum LeafValue {
    /// A number.
    Number(f64),
    /// A text.
    Text(String),
}

impl From<f64> for LeafValue {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<i32> for LeafValue {
    fn from(number: i32) -> Self {
        Self::Number(f64::from(number))
    }
}

impl From<u32> for LeafValue {
    fn from(number: u32) -> Self {
        Self::Number(f64::from(number))
    }
}

impl From<bool> for LeafValue {
    fn from(holds: bool) -> Self {
        Self::Number(if holds { 1.0 } else { 0.0 })
    }
}

impl From<&str> for LeafValue {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}
