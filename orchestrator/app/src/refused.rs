//! A request that cannot be run, as it is told to people and to programs.

use std::path::PathBuf;

use crate::exit::Complaint;

/// A request file that cannot be run, beside others that can.
#[derive(Debug)]
pub(crate) struct Refused {
    /// The file.
    pub(crate) file: PathBuf,
    /// Why.
    pub(crate) why: Complaint,
}

impl Refused {
    /// The reason, which names the file, then causes and hint, a line each.
    pub(crate) fn lines(&self) -> Vec<String> {
        let first = self.why.what.clone();
        let hint = Some(&self.why.hint).filter(|hint| !hint.is_empty()).map(|hint| format!("hint: {hint}"));
        std::iter::once(first).chain(self.why.causes.iter().cloned()).chain(hint).collect()
    }

    /// The same for programs.
    pub(crate) fn object(&self) -> serde_json::Value {
        let mut object = self.why.object();
        if let Some(members) = object.as_object_mut() {
            members.insert("request".to_owned(), self.file.display().to_string().into());
        }
        object
    }
}
