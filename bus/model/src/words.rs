//! The words that output, pages and tables use, with what they mean.

/// The glossary: `## word · other spelling`, then what it means; `# …` begins a section.
const PAGE: &str = include_str!("../words.md");

/// One entry of the glossary.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Word {
    /// Section it stands in.
    pub section: &'static str,
    /// The word, then its other spellings.
    pub names: Vec<&'static str>,
    /// What it means.
    pub about: &'static str,
}

/// Every entry, in order.
#[must_use]
pub fn words() -> Vec<Word> {
    let mut found = Vec::new();
    for section in PAGE.split("\n# ") {
        let (title, entries) = section.split_once('\n').unwrap_or((section, ""));
        // Before the first entry of a section stands what it is about.
        for entry in entries.split("\n## ").skip(usize::from(!entries.starts_with("## "))) {
            let Some((names, about)) = entry.trim_start_matches("## ").split_once('\n') else { continue };
            let names = names.split(" · ").map(str::trim).collect();
            found.push(Word { section: title.trim_start_matches("# "), names, about: about.trim() });
        }
    }
    found
}

/// The entry of a word, whatever its case, and with `_` and `-` as blanks. Ids such as `c7`, `f2` and `auto-time-human_1` have the
/// entry of their kind.
#[must_use]
pub fn word(text: &str) -> Option<Word> {
    let all = words();
    let of = |wanted: &str| all.iter().find(|word| word.names.iter().any(|name| plain(name) == wanted)).cloned();
    let wanted = plain(text);
    // `c7` is as `c1`; what follows `auto time` says whom it is about.
    let numbered = match wanted.split_at_checked(1) {
        Some((kind, number)) if !number.is_empty() && number.chars().all(|c| c.is_ascii_digit()) => format!("{kind}1"),
        Some(_) | None => String::new(),
    };
    let kind = wanted.split(' ').take(2).collect::<Vec<_>>().join(" ");
    let of_auto = || wanted.starts_with("auto ").then(|| of(&kind).or_else(|| of("auto"))).flatten();
    of(&wanted).or_else(|| of(&numbered)).or_else(of_auto)
}

/// Words as they are compared.
fn plain(text: &str) -> String {
    let text = text.trim().trim_matches(['`', '"', ':']).to_lowercase().replace(['_', '-'], " ");
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::Verdict;

    #[test]
    fn every_entry_has_a_name_of_its_own_and_says_something() {
        let all = words();
        assert!(all.len() > 90, "{}", all.len());
        let mut seen = BTreeSet::new();
        for word in &all {
            assert!(word.about.len() > 12 && word.about.ends_with(['.', '"']), "{:?}", word.names);
            for name in &word.names {
                assert!(seen.insert(plain(name)), "`{name}` stands twice");
            }
        }
        let sections: BTreeSet<&str> = all.iter().map(|word| word.section).collect();
        assert!(sections.contains("Verdicts") && sections.contains("Columns"), "{sections:?}");
    }

    #[test]
    fn words_are_found_in_every_spelling() {
        for (text, name) in [
            ("Encounter gap", "encounter gap"),
            ("realised late", "realised_late"),
            ("REALISED-LATE", "realised_late"),
            ("c17", "c1"),
            ("f2", "f1"),
            ("auto-time-human_1", "auto time"),
            ("auto-meet-human_2-2", "auto meet"),
            ("auto-elsewhere", "auto"),
            ("`surface distance`", "surface distance"),
        ] {
            assert_eq!(word(text).map(|word| word.names[0]), Some(name), "{text}");
        }
        assert_eq!(word("sandwich"), None);
        assert_eq!(word(""), None);
    }

    #[test]
    fn every_verdict_is_a_word() {
        for verdict in [
            Verdict::Realised,
            Verdict::RealisedLate,
            Verdict::NotTriggered,
            Verdict::Contradicted,
            Verdict::Invalid,
            Verdict::RobotPrevented,
        ] {
            assert_eq!(word(verdict.name()).map(|word| word.section), Some("Verdicts"), "{verdict}");
        }
    }
}
