//! Undo and redo without end, and what a journal has to keep of them.

use serde::{Deserialize, Serialize};

use crate::edit::{Edit, EditError};
use crate::sketch::Sketch;

/// The sketch is kept after every so many edits, so that undoing does not begin at the beginning.
const MARK_EVERY: usize = 64;

/// One thing that happened to a sketch: a line of a journal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Step {
    /// An edit, as it was done.
    Edit(Edit),
    /// The last edit was taken back.
    Undo,
    /// The edit that was taken back last was done again.
    Redo,
}

/// A sketch with everything that was done to it.
#[derive(Debug, Clone)]
pub struct History {
    edits: Vec<Edit>,
    /// How many of them count.
    done: usize,
    now: Sketch,
    /// The sketch after 0, [`MARK_EVERY`], … edits.
    marks: Vec<Sketch>,
    revision: u64,
}

impl History {
    /// A sketch to which nothing was done yet.
    #[must_use]
    pub fn new(base: Sketch) -> Self {
        Self { edits: Vec::new(), done: 0, now: base.clone(), marks: vec![base], revision: 0 }
    }

    /// The sketch as it is.
    #[must_use]
    pub fn sketch(&self) -> &Sketch {
        &self.now
    }

    /// How often the sketch became another one, undoing and doing again counted too.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// How many edits can be undone.
    #[must_use]
    pub fn undoable(&self) -> usize {
        self.done
    }

    /// The edit that an undo takes back.
    #[must_use]
    pub fn last(&self) -> Option<&Edit> {
        self.edits.get(self.done.checked_sub(1)?)
    }

    /// How many can be done again.
    #[must_use]
    pub fn redoable(&self) -> usize {
        self.edits.len().saturating_sub(self.done)
    }

    /// Does an edit; what was undone before can no longer be done again. Gives the edit as it was done.
    ///
    /// # Errors
    /// As [`Sketch::apply`].
    pub fn act(&mut self, edit: Edit) -> Result<Edit, EditError> {
        let done = self.now.apply(edit)?;
        self.edits.truncate(self.done);
        self.edits.push(done.clone());
        self.done += 1;
        self.marks.truncate(self.done.div_ceil(MARK_EVERY));
        if self.done.is_multiple_of(MARK_EVERY) {
            self.marks.push(self.now.clone());
        }
        self.revision += 1;
        Ok(done)
    }

    /// Takes the last edit back; false where there is none.
    pub fn undo(&mut self) -> bool {
        let Some(before) = self.done.checked_sub(1) else { return false };
        self.go_to(before)
    }

    /// Does the edit again that was undone last; false where there is none.
    pub fn redo(&mut self) -> bool {
        self.done < self.edits.len() && self.go_to(self.done + 1)
    }

    /// Does what a line of a journal says; false for an undo or redo of nothing.
    ///
    /// # Errors
    /// As [`Sketch::apply`].
    pub fn take(&mut self, step: Step) -> Result<bool, EditError> {
        match step {
            Step::Edit(edit) => self.act(edit).map(|_| true),
            Step::Undo => Ok(self.undo()),
            Step::Redo => Ok(self.redo()),
        }
    }

    fn go_to(&mut self, done: usize) -> bool {
        let mark = done / MARK_EVERY;
        let Some(from) = self.marks.get(mark) else { return false };
        let mut sketch = from.clone();
        for edit in self.edits.iter().take(done).skip(mark * MARK_EVERY) {
            // What was done once can be done again from the same sketch.
            if sketch.apply(edit.clone()).is_err() {
                return false;
            }
        }
        self.now = sketch;
        self.done = done;
        self.revision += 1;
        true
    }
}
