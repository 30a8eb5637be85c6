//! American spelling in everything that people read: code, comments, messages, documents.

use std::path::PathBuf;

use super::{files, shown};

/// Beginnings of British spellings, in small letters: a word that begins so is one.
const STEMS: &[&str] = &[
    "metre",
    "centimetre",
    "millimetre",
    "kilometre",
    "decimetre",
    "micrometre",
    "centre",
    "centring",
    "colour",
    "neighbour",
    "behaviour",
    "favour",
    "honour",
    "labour",
    "flavour",
    "humour",
    "rumour",
    "harbour",
    "labell",
    "unlabell",
    "travell",
    "signall",
    "cancelled",
    "cancelling",
    "modelled",
    "modelling",
    "levelled",
    "judgement",
    "fulfilment",
    "learnt",
    "spelt",
    "catalogue",
    "whilst",
    "authoris",
    "unauthoris",
    "recognis",
    "realisation",
    "realising",
    "organise",
    "organisa",
    "normalis",
    "initialis",
    "optimise",
    "optimisa",
    "serialis",
    "summaris",
    "minimis",
    "maximis",
    "visualis",
    "randomis",
    "utilis",
    "analyse",
    "analysing",
    "licence",
    "defence",
    "offence",
    "artefact",
    "synchronis",
    "penalis",
    "ageing",
    "customis",
    "categoris",
    "characterise",
    "characterisa",
    "standardis",
    "generalise",
    "generalisa",
    "specialise",
    "specialisa",
    "discretis",
    "apologis",
    "memoris",
    "finalise",
    "programmes",
];
/// British spellings that are beginnings of American words too.
const WORDS: &[&str] =
    &["fulfil", "fulfils", "grey", "greys", "realise", "realises", "programme", "practise", "kerb", "tyre"];
/// `(path, reason)`: files below it may hold them.
const FILES: &[(&str, &str)] = &[
    ("tests/asked/", "requests stand as they were written"),
    ("prompts/offline/", "requests are read however people spell: tables, sentences of tests, corpus"),
    ("prompts/reader/data/", "the same, of the reader"),
    ("tests/house/spelling.rs", "lists them"),
    ("orchestrator/app/src/ask/command.rs", "a person may type `again behaviours`"),
];
/// `(text, reason)`: a line with it may hold one.
const LINES: &[(&str, &str)] =
    &[("is_cancelled", "a name of tokio"), ("visible_alias = ", "a verb is found however people spell it")];
/// Endings of files that people read.
const ENDINGS: &[&str] = &[".rs", ".md", ".toml", ".html", ".js", ".css", ".sh", ".xml", ".yaml"];

/// The words of a line: stretches of letters, cut where a capital follows a small letter.
fn words(line: &str) -> Vec<String> {
    let (mut found, mut word, mut small) = (Vec::new(), String::new(), false);
    // In a text of a program `\n` is a line's end and no letter.
    for letter in line.replace("\\n", " ").chars() {
        if !letter.is_ascii_alphabetic() || letter.is_ascii_uppercase() && small {
            found.push(std::mem::take(&mut word));
        }
        if letter.is_ascii_alphabetic() {
            word.push(letter.to_ascii_lowercase());
        }
        small = letter.is_ascii_lowercase();
    }
    found.push(word);
    found
}

fn is_british(word: &str) -> bool {
    STEMS.iter().any(|stem| word.starts_with(stem)) || WORDS.contains(&word)
}

#[test]
fn spelling_is_american() {
    let all: Vec<PathBuf> = ENDINGS.iter().flat_map(|ending| files(ending)).collect();
    let mut found = Vec::new();
    for path in all {
        let name = shown(&path);
        if FILES.iter().any(|(place, _)| name.starts_with(place)) {
            continue;
        }
        for (number, line) in std::fs::read_to_string(&path).unwrap().lines().enumerate() {
            if LINES.iter().any(|(text, _)| line.contains(text)) {
                continue;
            }
            found.extend(
                words(line)
                    .iter()
                    .filter(|word| is_british(word))
                    .map(|word| format!("  {name}:{}: `{word}`", number + 1)),
            );
        }
    }
    assert!(found.is_empty(), "British spellings:\n{}", found.join("\n"));
}

#[test]
fn a_british_word_is_found_within_names_and_the_verdicts_are_none() {
    let british = |line: &str| words(line).iter().filter(|word| is_british(word)).count();
    assert_eq!(british("let per_metre = NeighbourList::centred(\"\\ncolour\");"), 4);
    for fine in [
        "realised",
        "realised_late",
        "not realised",
        "NotRealised",
        "parameter",
        "optimistic",
        "greet",
        "programmer",
        "characteristic",
        "specialist",
    ] {
        assert_eq!(british(fine), 0, "{fine}");
    }
}
