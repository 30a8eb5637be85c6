//! What a library keeps of its scenarios, beside the list, the page and the tables.

use std::path::Path;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use socrates_model::Verdict;

use crate::exit::Diagnostic;

/// Libraries of more scenarios than this have packed bundles, unless something else is asked for: folders are nice to look into, and a
/// hundred thousand of them are two million files.
const FOLDERS: usize = 1_000;

/// The form of one bundle in a library.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// A folder, to look into.
    Folder,
    /// One file, `NAME.tar.zst`.
    Packed,
    /// None: its figures stand in the library alone.
    Nothing,
}

/// Which bundles a library keeps, and in which form.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Keep {
    /// All, as folders.
    Folders,
    /// All, each as one file.
    Packed,
    /// Those that were not realised, each as one file.
    Failed,
    /// None.
    Index,
}

impl Keep {
    /// Every value, as it is written.
    pub const ALL: [Self; 4] = [Self::Folders, Self::Packed, Self::Failed, Self::Index];

    /// What is kept of a library of this many scenarios where nothing is asked for.
    #[must_use]
    pub const fn of(scenarios: usize) -> Self {
        if scenarios > FOLDERS { Self::Packed } else { Self::Folders }
    }

    /// As it is written.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Folders => "folders",
            Self::Packed => "packed",
            Self::Failed => "failed",
            Self::Index => "index",
        }
    }

    /// The form of the bundle of a scenario with this verdict.
    #[must_use]
    pub const fn form(self, verdict: Verdict) -> Form {
        match self {
            Self::Folders => Form::Folder,
            Self::Packed => Form::Packed,
            Self::Failed if !matches!(verdict, Verdict::Realised) => Form::Packed,
            Self::Failed | Self::Index => Form::Nothing,
        }
    }
}

/// What is kept in a folder: what was fixed when it was begun, else what is asked for.
///
/// # Errors
/// Something else is asked for than was fixed: what was made would have to be made again.
pub(crate) fn agreed(root: &Path, fixed: Option<Keep>, asked: Option<Keep>) -> Result<Option<Keep>, Diagnostic> {
    match (fixed, asked) {
        (Some(fixed), Some(asked)) if fixed != asked => Err(Diagnostic::input(
            format!(
                "`{}` was begun with `--keep {}`, and `--keep {}` does not change what lies in it",
                root.display(),
                fixed.name(),
                asked.name()
            ),
            format!(
                "leave `--keep` out to go on with it, or make a library beside it: `--keep {} --out ANOTHER`",
                asked.name()
            ),
        )),
        (fixed, asked) => Ok(fixed.or(asked)),
    }
}

impl FromStr for Keep {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = Self::ALL.map(Self::name);
        let found = Self::ALL.into_iter().find(|keep| keep.name() == text);
        found.ok_or_else(|| format!("`{text}` is none of {}", known.join(", ")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_follows_from_the_word_and_the_verdict() {
        for keep in Keep::ALL {
            assert_eq!(keep.name().parse::<Keep>().unwrap(), keep);
        }
        assert!("all".parse::<Keep>().unwrap_err().contains("folders, packed"));
        let failed =
            [Verdict::Realised, Verdict::Contradicted, Verdict::NotTriggered].map(|one| Keep::Failed.form(one));
        assert_eq!(failed, [Form::Nothing, Form::Packed, Form::Packed]);
        assert_eq!(Keep::Index.form(Verdict::Contradicted), Form::Nothing);
        let agreed = |fixed, asked| agreed(Path::new("lib"), fixed, asked);
        assert_eq!(agreed(None, Some(Keep::Index)).unwrap(), Some(Keep::Index));
        assert_eq!(agreed(Some(Keep::Packed), None).unwrap(), Some(Keep::Packed));
        let why = agreed(Some(Keep::Index), Some(Keep::Packed)).unwrap_err();
        assert!(why.what.contains("`--keep index`") && why.hint.contains("--keep packed --out"), "{why}");
        assert_eq!((Keep::of(1_000), Keep::of(1_001)), (Keep::Folders, Keep::Packed));
    }
}
