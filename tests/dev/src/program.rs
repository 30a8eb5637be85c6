//! The program `socrates`, whose processes some tools start: it lies beside `socrates-dev`.

use std::path::{Path, PathBuf};

use socrates_app::config::Config;
use socrates_app::exit::Diagnostic;
use socrates_model::Digest;

/// Name of its file.
const NAME: &str = "socrates";

/// The file of the program: the named one, else the one in the folder of this program; none where there is none.
///
/// # Errors
/// A named file that is not there.
pub fn find(named: Option<&Path>, own: Option<&Path>) -> Result<Option<PathBuf>, Diagnostic> {
    match named {
        Some(file) if file.is_file() => Ok(Some(file.to_path_buf())),
        Some(file) => {
            let what = format!("--program: `{}` is no file", file.display());
            Err(Diagnostic::input(
                what,
                "name the program `socrates`; by default it is looked for beside `socrates-dev`",
            ))
        }
        None => {
            let beside = own.map(|own| own.with_file_name(format!("{NAME}{}", std::env::consts::EXE_SUFFIX)));
            Ok(beside.filter(|file| file.is_file()))
        }
    }
}

/// The program that was found.
///
/// # Errors
/// None was found.
pub fn of(config: &Config) -> Result<&Path, Diagnostic> {
    config.program().file.as_deref().ok_or_else(|| {
        Diagnostic::input(
            format!("the program `{NAME}` does not lie beside `socrates-dev`"),
            "build it with the same profile, such as `cargo build --profile ci -p socrates`, or name it with --program FILE",
        )
    })
}

/// A digest of its file, which tells which build is measured; empty where it was not found.
#[must_use]
pub fn build(config: &Config) -> String {
    let bytes = config.program().file.as_ref().and_then(|file| std::fs::read(file).ok());
    bytes.map_or_else(String::new, |bytes| Digest::of(&bytes).to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_program_is_the_named_one_or_the_one_beside_this_one() {
        let folder = tempfile::tempdir().unwrap();
        let (own, beside, other) =
            (folder.path().join("socrates-dev"), folder.path().join(NAME), folder.path().join("other"));
        assert_eq!(find(None, Some(&own)).unwrap(), None);
        std::fs::write(&beside, "").unwrap();
        assert_eq!(find(None, Some(&own)).unwrap(), Some(beside));
        let refused = find(Some(&other), Some(&own)).unwrap_err().to_string();
        assert!(refused.contains("--program") && refused.contains("other"), "{refused}");
        std::fs::write(&other, "").unwrap();
        assert_eq!(find(Some(&other), Some(&own)).unwrap(), Some(other));
    }

    #[test]
    fn a_missing_program_is_named_with_what_to_do() {
        let config = Config::load(None, std::iter::empty(), &[]).unwrap();
        let refused = of(&config).unwrap_err().to_string();
        for words in ["`socrates`", "`socrates-dev`", "cargo build", "--program"] {
            assert!(refused.contains(words), "{words}: {refused}");
        }
    }
}
