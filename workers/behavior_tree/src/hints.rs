//! Names in messages: lists of them, the one that was probably meant, and paths of included files.

use crate::xml::short_text;

/// Most names that a message lists.
const MAX_LISTED: usize = 24;
/// Longest name that is compared with others, bytes.
const MAX_COMPARED: usize = 64;

/// Names in a message, not too many of them.
pub(crate) fn listed<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.into_iter().collect();
    let mut text = names.iter().take(MAX_LISTED).map(|name| short_text(name)).collect::<Vec<_>>().join(", ");
    if text.is_empty() {
        text.push_str("none");
    }
    if names.len() > MAX_LISTED {
        text.push_str(&format!(" and {} more", names.len() - MAX_LISTED));
    }
    text
}

/// `; nearest: NAME` where one of the names is like the one that was written.
pub(crate) fn nearest<'a>(written: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    if written.len() > MAX_COMPARED {
        return String::new();
    }
    let wanted = written.to_lowercase();
    let allowed = (written.chars().count() / 2).clamp(1, 6);
    let distance = |name: &str| strsim::levenshtein(&name.to_lowercase(), &wanted);
    let found = names.into_iter().take(1000).map(|name| (distance(name), name)).min();
    found
        .filter(|(distance, _)| *distance <= allowed)
        .map_or_else(String::new, |(_, name)| format!("; nearest: {name}"))
}

/// Path of an included file seen from the document itself: paths are relative to the file that names them.
pub(crate) fn resolved(file: &str, path: &str) -> String {
    let folder = file.rfind('/').and_then(|end| file.get(..=end)).unwrap_or("");
    if folder.is_empty() || path.starts_with('/') {
        return path.to_owned();
    }
    let mut parts: Vec<&str> = Vec::new();
    for part in folder.split('/').chain(path.split('/')).filter(|part| !part.is_empty() && *part != ".") {
        match (part, parts.last()) {
            ("..", Some(last)) if *last != ".." => drop(parts.pop()),
            _ => parts.push(part),
        }
    }
    let root = if folder.starts_with('/') { "/" } else { "" };
    format!("{root}{}", parts.join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_relative_to_the_file_that_names_them() {
        assert_eq!(resolved("", "a.xml"), "a.xml");
        assert_eq!(resolved("lib/a.xml", "b.xml"), "lib/b.xml");
        assert_eq!(resolved("lib/deep/a.xml", "../b.xml"), "lib/b.xml");
        assert_eq!(resolved("lib/a.xml", "../../b.xml"), "../b.xml");
        assert_eq!(resolved("/lib/a.xml", "./b.xml"), "/lib/b.xml");
        assert_eq!(resolved("lib/a.xml", "/b.xml"), "/b.xml");
    }

    #[test]
    fn only_a_like_name_is_the_nearest() {
        assert_eq!(nearest("Sequens", ["Sequence", "Fallback"]), "; nearest: Sequence");
        assert_eq!(nearest("x", ["Sequence", "Fallback"]), "");
        assert_eq!(nearest(&"x".repeat(100), ["Sequence"]), "");
    }

    #[test]
    fn long_lists_are_cut() {
        assert_eq!(listed([]), "none");
        assert!(listed(["a"; 30]).ends_with("and 6 more"));
    }
}
