//! A document in the other version, with a note for everything that does not mean the same there.

use std::fmt;

use crate::parse::GUARDS;
use crate::sheet::{Library, NodeSheet};
use crate::tree::{Format, Tree};
use crate::xml::{Element, Site};

/// Something that is different after a conversion.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Note {
    /// Place and tag in the document that was converted: `4:7 Repeat \`twice\``.
    pub at: String,
    /// What is different, and what to do about it.
    pub message: String,
    /// Whether the tree may behave differently; false where only the spelling changed.
    pub changes_meaning: bool,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.at, self.message)
    }
}

/// A tree as XML of a version, for the simulators of a library. What has no counterpart there is written as it is and
/// noted. Included files stay includes and are converted apart.
///
/// Notes come in the order of the document, each once; an empty list means the same tree.
#[must_use]
pub fn convert(tree: &Tree, format: Format, library: Library) -> (String, Vec<Note>) {
    let document = &tree.document;
    let mut notes = Notes { from: document.format, to: format, library, found: Vec::new() };
    for def in document.trees.iter().filter(|def| def.root.site.file.is_empty()) {
        notes.below(&def.root);
    }
    if document.format != format && !document.includes.is_empty() {
        let message = format!("the included files must be of {} too: {}", format.name(), document.includes.join(", "));
        notes.found.push((Site::default(), Note { at: "include".to_owned(), message, changes_meaning: false }));
    }
    let xml = crate::write::write_for(document, format, library);
    let mut found: Vec<Note> = notes.found.into_iter().map(|(_, note)| note).collect();
    found.dedup();
    (xml, found)
}

struct Notes {
    from: Format,
    to: Format,
    library: Library,
    found: Vec<(Site, Note)>,
}

impl Notes {
    fn add(&mut self, it: &Element, changes_meaning: bool, message: impl Into<String>) {
        self.found.push((it.site.clone(), Note { at: it.at().to_string(), message: message.into(), changes_meaning }));
    }

    fn below(&mut self, root: &Element) {
        let mut open = vec![root];
        while let Some(it) = open.pop() {
            let sheet = crate::nodes::sheet_of(&it.tag);
            if let Some(sheet) = sheet {
                self.library(it, sheet);
                if self.from != self.to {
                    self.version(it, sheet);
                }
            }
            open.extend(it.children.iter().rev());
        }
    }

    /// What a simulator of the library makes of the node.
    fn library(&mut self, it: &Element, sheet: &'static NodeSheet) {
        let library = self.library;
        let Some(theirs) = crate::nodes::sheet_in(sheet.tag, library) else {
            let instead = crate::nodes::alias(sheet.tag, library);
            let message = match instead {
                Some(other) => format!("{} calls `{}` `{other}`; written so", library.name(), sheet.tag),
                None => format!("{} has no node `{}` and cannot load the tree", library.name(), sheet.tag),
            };
            return self.add(it, instead.is_none(), message);
        };
        if matches!(sheet.tag, "SubTree" | "SubTreePlus") {
            return;
        }
        for (name, _) in &it.attrs {
            let is_common =
                matches!(name.as_str(), "name" | "_uid" | "_description") || GUARDS.contains(&name.as_str());
            if !is_common && !theirs.ports.iter().any(|port| port.is_called(name)) {
                let message = format!("`{}` of {} has no port `{name}`; left out", sheet.tag, library.name());
                self.add(it, true, message);
            }
        }
    }

    /// What another version makes of the node.
    fn version(&mut self, it: &Element, sheet: &'static NodeSheet) {
        let to_v4 = self.to == Format::V4;
        match sheet.tag {
            "Repeat" | "RetryUntilSuccessful" => {
                let message = if to_v4 {
                    "version 4 gives RUNNING between two rounds of a child that finishes at once, version 3 does all in one tick"
                } else {
                    "version 3 does all rounds in one tick, version 4 gives RUNNING between two of them"
                };
                self.add(it, true, message);
            }
            "SequenceWithMemory" => {
                self.add(
                    it,
                    false,
                    format!("written as {}", if to_v4 { "SequenceWithMemory" } else { "SequenceStar" }),
                );
                let message = if to_v4 {
                    "version 4 keeps its place when it is halted, and gives RUNNING between two children that finish at once; version 3 starts anew and goes on"
                } else {
                    "version 3 starts at the first child after it was halted, and goes on to the next child in the same tick; version 4 keeps its place and gives RUNNING"
                };
                self.add(it, true, message);
            }
            "Parallel" => {
                let message = if to_v4 {
                    "success_threshold and failure_threshold are success_count and failure_count; version 4 counts all children that finished so far, version 3 only those up to the present one"
                } else {
                    "success_count and failure_count are success_threshold and failure_threshold; version 3 counts only the children up to the present one, version 4 all that finished so far"
                };
                self.add(it, true, message);
            }
            "Switch2" | "Switch3" | "Switch4" | "Switch5" | "Switch6" => {
                self.add(it, true, "version 4 compares texts, then numbers (1 is 1.0); version 3 only texts");
            }
            "WhileDoElse" if !to_v4 && it.children.len() < 3 => {
                self.add(it, true, "version 3 demands a third child; add <AlwaysFailure/>");
            }
            tag if sheet.only_in() == Some(self.from) && tag != "SubTreePlus" => {
                self.add(it, true, format!("{} has no `{tag}` and cannot load the tree", self.to.name()));
            }
            "SubTree" | "SubTreePlus" => self.subtree(it),
            _ => {}
        }
        for guard in GUARDS {
            if !to_v4 && it.attr(guard).is_some() {
                self.add(it, true, format!("version 3 has no attribute `{guard}`; left out"));
            }
        }
    }

    fn subtree(&mut self, it: &Element) {
        if it.attr("__shared_blackboard").is_some() {
            self.add(
                it,
                false,
                "__shared_blackboard is written as _autoremap; the same but for names that begin with `_`",
            );
        }
        let hands_over = it.attrs.iter().any(|(name, _)| name != "ID" && name != "name" && !name.starts_with('_'));
        if hands_over && it.tag == "SubTree" {
            let message = if self.to == Format::V4 {
                "hand-overs are written with braces"
            } else {
                "written as SubTreePlus, which takes braces and constants"
            };
            self.add(it, false, message);
        }
    }
}
