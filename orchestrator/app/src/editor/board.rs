//! What lies on the table: the sketch with its history, its journal, and the files that it came from.

use std::sync::{Arc, Mutex, PoisonError};

use serde_json::{Value, json};
use socrates_edit::{Edit, EditError, History, Proposal, Remark, Sketch, Step, check};
use socrates_model::{Fault, Location, PlaceClass};

use super::journal::{Journal, Opened};
use super::site::{Disk, Site, WORK, differing};
use crate::exit::Diagnostic;
use crate::words::plural;

/// Why something is not done.
#[derive(Debug)]
pub(super) enum Refusal {
    /// It was asked of a sketch that is another one now.
    Stale,
    /// Nothing may be changed.
    ReadOnly,
    /// The edit cannot be done.
    Edit(EditError),
    /// There is nothing to undo, or to do again.
    Nothing(&'static str),
    /// These files were changed by another program.
    Changed(Vec<String>),
    /// The disk, or the map.
    Outside(Diagnostic),
}

impl From<EditError> for Refusal {
    fn from(why: EditError) -> Self {
        Self::Edit(why)
    }
}

impl From<Diagnostic> for Refusal {
    fn from(why: Diagnostic) -> Self {
        Self::Outside(why)
    }
}

/// The sketch that is edited.
#[derive(Debug)]
pub(super) struct Board {
    site: Site,
    history: History,
    /// None where nothing may be changed.
    journal: Option<Journal>,
    /// The drawn files as they were when they were read or written last.
    disk: Disk,
    /// What they hold; none where a copy is begun that is not written yet.
    saved: Option<Sketch>,
    /// What the page says at the beginning.
    pub(super) notes: Vec<String>,
}

impl Board {
    /// Lays out a location: what its files hold, with what a journal says was done since. Gives the map besides.
    ///
    /// # Errors
    /// A [`Diagnostic`] where files or journal cannot be read.
    pub(super) fn lay(site: Site, read_only: bool) -> Result<(Self, Location), Diagnostic> {
        let draft = site.draft()?;
        let (base, disk) = (Sketch::of(&draft.location), site.disk.clone());
        let mut notes: Vec<String> = draft.location.warnings.clone();
        if !draft.faults.is_empty() {
            notes.push("Some of the files was not taken over as it is; saving writes them without it:".to_owned());
            notes.extend(draft.faults.iter().map(Fault::to_string));
        }
        let saved = site.is_saved().then(|| base.clone());
        let mut board =
            Self { history: History::new(base.clone()), journal: None, disk: disk.clone(), saved, notes, site };
        if !read_only {
            let work = board.site.folder.join(WORK);
            let opened = Journal::open(&work, board.site.map_digest(), base, disk)?;
            board.go_on(opened);
        }
        if board.site.has_plan {
            let note = "This folder has a plan.toml, from which `map generate` would make the scene graph and the doors anew: what is drawn here is not in the plan.";
            board.notes.push(note.to_owned());
        }
        Ok((board, draft.location))
    }

    /// Takes over what a journal holds.
    fn go_on(&mut self, opened: Opened) {
        let Opened { journal, history, disk, steps } = opened;
        if steps > 0 {
            let note = if self.saved.as_ref() == Some(history.sketch()) {
                format!(
                    "Went on with the journal: {} can be undone, and all is saved.",
                    plural(history.undoable(), "edit")
                )
            } else {
                format!("Went on with the journal of {}: what it drew is not saved yet.", plural(steps, "step"))
            };
            self.notes.insert(0, note);
        }
        let changed = differing(&disk, &self.disk);
        if !changed.is_empty() {
            self.notes.insert(
                0,
                format!("{} was changed by another program since; saving asks what to do.", changed.join(" and ")),
            );
        }
        (self.journal, self.history, self.disk) = (Some(journal), history, disk);
    }

    /// The sketch as it is.
    pub(super) fn sketch(&self) -> &Sketch {
        self.history.sketch()
    }

    /// Its number.
    pub(super) fn revision(&self) -> u64 {
        self.history.revision()
    }

    /// The sketch and how it stands, for the page.
    pub(super) fn state(&self, said: &str) -> Value {
        let sketch = self.sketch();
        let kinds = sketch.nodes.iter().map(|node| &node.kind).chain(sketch.edges.iter().map(|edge| &edge.kind));
        let classes: serde_json::Map<String, Value> =
            kinds.map(|kind| (kind.clone(), json!(PlaceClass::of_type(kind).name()))).collect();
        json!({
            "rev": self.revision(), "sketch": sketch, "classes": classes, "said": said,
            "undo": self.history.undoable(), "redo": self.history.redoable(),
            "dirty": self.saved.as_ref() != Some(sketch), "read_only": self.journal.is_none(),
        })
    }

    fn may_change(&self, rev: u64) -> Result<(), Refusal> {
        if self.journal.is_none() {
            Err(Refusal::ReadOnly)
        } else if rev == self.revision() {
            Ok(())
        } else {
            Err(Refusal::Stale)
        }
    }

    /// Does an edit of the sketch of this number, and keeps it before it counts as done.
    pub(super) fn act(&mut self, rev: u64, edit: Edit) -> Result<Value, Refusal> {
        self.may_change(rev)?;
        let done = self.history.act(edit)?;
        let said = done.said();
        if let Err(why) = self.keep(Step::Edit(done)) {
            self.history.undo();
            return Err(why.into());
        }
        Ok(self.state(&said))
    }

    /// Takes the last edit back.
    pub(super) fn undo(&mut self, rev: u64) -> Result<Value, Refusal> {
        self.may_change(rev)?;
        let said = self.history.last().map(Edit::said).ok_or(Refusal::Nothing("there is nothing to undo"))?;
        self.history.undo();
        if let Err(why) = self.keep(Step::Undo) {
            self.history.redo();
            return Err(why.into());
        }
        Ok(self.state(&format!("took back: {said}")))
    }

    /// Does it again.
    pub(super) fn redo(&mut self, rev: u64) -> Result<Value, Refusal> {
        self.may_change(rev)?;
        if !self.history.redo() {
            return Err(Refusal::Nothing("there is nothing to do again"));
        }
        if let Err(why) = self.keep(Step::Redo) {
            self.history.undo();
            return Err(why.into());
        }
        let said = self.history.last().map(Edit::said).unwrap_or_default();
        Ok(self.state(&format!("did again: {said}")))
    }

    fn keep(&mut self, step: Step) -> Result<(), Diagnostic> {
        self.journal.as_mut().map_or(Ok(()), |journal| journal.step(step))
    }

    /// Writes the files; where another program changed them meanwhile, only if they may be overwritten, and with a copy of theirs.
    pub(super) fn save(&mut self, rev: u64, overwrite: bool, map: &Location) -> Result<Value, Refusal> {
        self.may_change(rev)?;
        self.site.check_map()?;
        let changed = differing(&self.disk, &self.site.disk_now()?);
        if !changed.is_empty() && !overwrite {
            return Err(Refusal::Changed(changed));
        }
        let kept = self.site.keep_theirs(&changed)?;
        let written = self.site.write(&self.sketch().files(&map.grid))?;
        self.disk = self.site.disk_now()?;
        self.saved = Some(self.sketch().clone());
        if let Some(journal) = self.journal.as_mut() {
            journal.saved(&self.disk)?;
        }
        let mut said = format!("saved {} in {}", written.join(", "), self.site.folder.display());
        if !kept.is_empty() {
            said.push_str(&format!("; what was there is kept as {}", kept.join(", ")));
        }
        Ok(self.state(&said))
    }

    /// Takes over what another program wrote into the files, as an edit.
    pub(super) fn take_theirs(&mut self, rev: u64) -> Result<Value, Refusal> {
        self.may_change(rev)?;
        let (draft, disk) = self.site.again()?;
        let theirs = Sketch::of(&draft.location);
        let state = self.act(rev, Edit::Replace(theirs.clone()))?;
        (self.disk, self.saved) = (disk, Some(theirs));
        if let Some(journal) = self.journal.as_mut() {
            journal.saved(&self.disk)?;
        }
        let said = state.get("said").and_then(Value::as_str).unwrap_or_default();
        Ok(self.state(&format!("{said} from the files on the disk")))
    }

    /// The folder where it is kept.
    pub(super) fn folder(&self) -> String {
        self.site.folder.display().to_string()
    }
}

/// What was worked out of a sketch, kept until there is another one.
#[derive(Debug)]
struct Checked {
    location: Location,
    of: Option<u64>,
    remarks: Vec<Remark>,
}

/// What is worked out of the map and the sketch.
#[derive(Debug)]
pub(super) struct Checker {
    checked: Mutex<Checked>,
    proposal: Mutex<Option<Arc<Proposal>>>,
}

impl Checker {
    pub(super) fn new(map: &Location) -> Self {
        let checked = Checked { location: map.clone(), of: None, remarks: Vec::new() };
        Self { checked: Mutex::new(checked), proposal: Mutex::new(None) }
    }

    /// Looks at the sketch of this number, and does something with it as the program reads it and with what is to be said of it.
    pub(super) fn with<T>(&self, rev: u64, sketch: &Sketch, act: impl FnOnce(&Location, &[Remark]) -> T) -> T {
        let mut checked = self.checked.lock().unwrap_or_else(PoisonError::into_inner);
        if checked.of != Some(rev) {
            let Checked { location, of, remarks } = &mut *checked;
            // A check that broke leaves no answer behind that looks like one.
            *of = None;
            *remarks = check(sketch, location);
            *of = Some(rev);
        }
        act(&checked.location, &checked.remarks)
    }

    /// What the program finds on the map by itself.
    pub(super) fn proposal(&self, map: &Location) -> Result<Arc<Proposal>, Vec<Fault>> {
        let mut kept = self.proposal.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(proposal) = kept.as_ref() {
            return Ok(Arc::clone(proposal));
        }
        let made = Arc::new(Proposal::of(&map.grid)?);
        *kept = Some(Arc::clone(&made));
        Ok(made)
    }
}
