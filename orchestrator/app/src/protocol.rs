//! Specifications of evaluations and experiments: a TOML file, or one that comes with the program, read once at the door.

use std::path::Path;

use serde::de::DeserializeOwned;

use crate::exit::Diagnostic;
use crate::files;

/// A specification larger than this is not read.
const MAX_BYTES: u64 = 256 * 1024;

/// Where specifications of one kind come in.
#[derive(Debug)]
pub struct Door {
    /// What they specify, in one word.
    pub(crate) what: &'static str,
    /// Those that come with the program: name and text.
    pub shipped: &'static [(&'static str, &'static str)],
}

impl Door {
    /// Names of those that come with the program.
    pub(crate) fn names(&self) -> String {
        self.shipped.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
    }

    /// Whether one of this name comes with the program.
    pub(crate) fn ships(&self, name: &str) -> bool {
        self.shipped.iter().any(|(shipped, _)| *shipped == name)
    }

    /// The specification of this name, or of this file, as it is written; what it says may still be impossible.
    ///
    /// # Errors
    /// Bad input: no such file, too large, not UTF-8, not TOML, a key that is not known or a value of another kind; with its line.
    pub(crate) fn read<T: DeserializeOwned>(&self, from: &Path) -> Result<T, Diagnostic> {
        let shown = from.display().to_string();
        let hint = format!("name a file, or one that comes with the program: {}", self.names());
        let text = match self.shipped.iter().find(|(name, _)| *name == shown) {
            Some((_, text)) => (*text).to_owned(),
            None => files::text(from, MAX_BYTES, &hint)?,
        };
        toml::from_str(&text).map_err(|why| {
            let mut diagnostic = Diagnostic::input(format!("the {} `{shown}` cannot be read", self.what), hint);
            diagnostic.causes = why.to_string().lines().map(str::to_owned).collect();
            diagnostic
        })
    }

    /// Refuses a specification for these reasons, a line each.
    pub(crate) fn refused(&self, from: &Path, problems: Vec<String>) -> Diagnostic {
        let what = format!("the {} `{}` cannot be done", self.what, from.display());
        let mut diagnostic = Diagnostic::input(what, "correct these lines");
        diagnostic.causes = problems;
        diagnostic
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOOR: Door = Door { what: "trial", shipped: &[("small", "n = 3")] };

    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Small {
        n: u32,
    }

    #[test]
    fn a_shipped_name_wins_and_what_cannot_be_read_is_told_with_its_file_and_line() {
        assert_eq!(DOOR.read::<Small>(Path::new("small")).unwrap().n, 3);
        assert!(DOOR.ships("small") && !DOOR.ships("large"));
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("mine.toml");
        let told = |text: &[u8]| {
            std::fs::write(&file, text).unwrap();
            DOOR.read::<Small>(&file).unwrap_err().to_string()
        };
        for (text, words) in [("n = \"x\"", "n = \"x\""), ("n = 1\nm = 2", "unknown field `m`"), ("n = -1", "-1")] {
            let told = told(text.as_bytes());
            assert!(told.contains("the trial `") && told.contains("mine.toml") && told.contains(words), "{told}");
            assert!(told.contains("hint: name a file, or one that comes with the program: small"), "{told}");
        }
        assert!(told(&vec![b' '; 300 * 1024]).contains("at most 262144 bytes"));
        assert!(told(b"\xff").contains("not UTF-8"));
        assert!(DOOR.read::<Small>(Path::new("nowhere.toml")).unwrap_err().hint.contains("small"));
    }
}
