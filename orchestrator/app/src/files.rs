//! Reading and writing the files that are named on the command line.

use std::ffi::OsStr;
use std::path::Path;

use crate::exit::Diagnostic;
use crate::output::Printer;

/// Bytes of a file of at most `max` bytes.
pub fn bytes(path: &Path, max: u64, hint: &str) -> Result<Vec<u8>, Diagnostic> {
    let cannot = |why: std::io::Error| Diagnostic::input(format!("cannot read `{}`: {why}", path.display()), hint);
    let length = std::fs::metadata(path).map_err(cannot)?.len();
    if length > max {
        let what = format!("`{}` has {length} bytes", path.display());
        return Err(Diagnostic::input(what, format!("at most {max} bytes are read")));
    }
    std::fs::read(path).map_err(cannot)
}

/// Text of a file of at most `max` bytes.
pub fn text(path: &Path, max: u64, hint: &str) -> Result<String, Diagnostic> {
    String::from_utf8(bytes(path, max, hint)?).map_err(|why| {
        let at = why.utf8_error().valid_up_to();
        Diagnostic::input(format!("`{}` is not UTF-8 text (byte {at})", path.display()), "save it as UTF-8")
    })
}

/// Writes a file, and the folders above it.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Diagnostic> {
    let cannot = |why: std::io::Error| {
        Diagnostic::input(format!("cannot write `{}`: {why}", path.display()), "--out chooses another place")
    };
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(cannot)?;
    }
    std::fs::write(path, bytes).map_err(cannot)
}

/// Writes a text to a file, or says it where none is named.
pub(crate) fn write_or_say(talk: &Printer, text: &str, out: Option<&Path>) -> Result<(), Diagnostic> {
    match out {
        Some(out) => {
            write(out, text.as_bytes())?;
            talk.line(&format!("wrote      {}", out.display()));
        }
        None => talk.line(text),
    }
    Ok(())
}

/// Opens a file or an address with the desktop's program; whether there is one that did.
pub(crate) fn open_outside(what: &OsStr) -> bool {
    ["xdg-open", "open"].into_iter().any(|program| {
        let mut command = std::process::Command::new(program);
        command.arg(what).stdout(std::process::Stdio::null()).stderr(std::process::Stdio::null());
        command.status().is_ok_and(|status| status.success())
    })
}

/// A folder as a page beside it refers to it: with `..` where that is needed, and slashes.
pub(crate) fn relative(page: &Path, folder: &Path) -> String {
    let whole = |path: &Path| path.canonicalize().unwrap_or_else(|_gone| path.to_path_buf());
    let from =
        page.parent().filter(|parent| !parent.as_os_str().is_empty()).map_or_else(|| whole(Path::new(".")), whole);
    let to = whole(folder);
    let shared = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    let up = from.components().skip(shared).map(|_above| "..".to_owned());
    let down = to.components().skip(shared).map(|part| part.as_os_str().to_string_lossy().into_owned());
    let parts: Vec<String> = up.chain(down).collect();
    if parts.is_empty() { ".".to_owned() } else { parts.join("/") }
}

/// A path, or another word, as a shell takes it: in quotes where it holds a blank or anything else that a shell would read.
pub(crate) fn shell(path: &Path) -> String {
    let text = path.display().to_string();
    // Only a byte that no path holds cannot be quoted.
    shlex::try_quote(&text).map_or_else(|_why| text.clone(), |quoted| quoted.into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_named_from_where_the_page_lies() {
        let root = tempfile::tempdir().unwrap();
        let of = |page: &str, folder: &str| {
            std::fs::create_dir_all(root.path().join(folder)).unwrap();
            std::fs::create_dir_all(root.path().join(page).parent().unwrap()).unwrap();
            relative(&root.path().join(page), &root.path().join(folder))
        };
        assert_eq!(of("out/compare.html", "out/scenarios/hall-1"), "scenarios/hall-1");
        assert_eq!(of("out/compare.html", "library/hall-1"), "../library/hall-1");
        assert_eq!(of("out/compare.html", "out"), ".");
    }

    #[test]
    fn a_path_with_a_blank_stays_one_word_of_a_shell() {
        for (path, word) in
            [("runs/my-1", "runs/my-1"), ("mein Büro/out put", "'mein Büro/out put'"), ("it's", "\"it's\"")]
        {
            assert_eq!(shell(Path::new(path)), word);
            assert_eq!(shlex::split(&shell(Path::new(path))), Some(vec![path.to_owned()]));
        }
    }
}
