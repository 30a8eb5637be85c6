//! A request that cannot be run, as it is told to people and to programs.

use std::path::PathBuf;

use crate::exit::Diagnostic;
use crate::output::Printer;

/// A request file that cannot be run, beside others that can.
#[derive(Debug)]
pub(crate) struct Refused {
    /// The file.
    pub(crate) file: PathBuf,
    /// Why.
    pub(crate) why: Diagnostic,
}

impl Refused {
    /// Says which requests cannot be run, beside the `others` that can, and gives that in a line.
    ///
    /// # Errors
    /// When none can.
    pub(crate) fn told(talk: &Printer, refused: &[Self], others: usize) -> Result<String, Diagnostic> {
        let names: Vec<String> = refused.iter().map(|bad| format!("`{}`", bad.file.display())).collect();
        let all = refused.len() + others;
        let what = format!("{} of {all} requests cannot be run: {}", refused.len(), names.join(", "));
        if others == 0 {
            let mut diagnostic = Diagnostic::input(what, "correct them; `socrates read FILE` looks at one alone");
            diagnostic.causes = refused.iter().flat_map(Self::lines).collect();
            return Err(diagnostic);
        }
        for bad in refused {
            talk.warn(&format!("refused    {}", bad.lines().join("\n           ")));
        }
        Ok(what)
    }

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
