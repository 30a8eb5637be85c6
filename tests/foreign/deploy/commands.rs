//! What the files of `deploy/` ask the program for, against the program.

use std::path::Path;

use serde_json::Value;
use socrates_tests::{root, skip};

use super::{KUSTOMIZATIONS, composed, deployed, documents, rendered, tools};
use crate::socrates;

/// Every verb that the files use.
const VERBS: [&str; 9] = [
    "run",
    "status",
    "library merge",
    "cluster up",
    "cluster work",
    "cluster worker",
    "cluster keys",
    "cluster submit",
    "cluster collect",
];

/// A verb, and the options that a file gives it.
#[derive(Debug)]
struct Asked {
    place: String,
    verb: &'static str,
    options: Vec<String>,
}

/// The verb that these words begin with, and its options up to whatever else the line does.
fn asked(place: &str, words: &[String]) -> Option<Asked> {
    let line = words.join(" ");
    let begins = |verb: &str| line.strip_prefix(verb).is_some_and(|rest| rest.is_empty() || rest.starts_with(' '));
    let verb = VERBS.into_iter().filter(|verb| begins(verb)).max_by_key(|verb| verb.len())?;
    let ours = words.iter().take_while(|word| !matches!(word.as_str(), "||" | "&" | ";" | "#" | ">/dev/null"));
    let option = |word: &String| {
        let name = word.split('=').next().unwrap_or_default();
        let name = name.trim_end_matches(|c: char| !c.is_ascii_alphanumeric());
        name.starts_with("--").then(|| name.to_owned())
    };
    Some(Asked { place: place.to_owned(), verb, options: ours.filter_map(option).collect() })
}

/// What the lines of a text that start the program ask for.
fn of_text(path: &Path, starts: &[&str]) -> Vec<Asked> {
    let text = std::fs::read_to_string(path).unwrap().replace("\\\n", " ");
    let place = path.strip_prefix(root()).unwrap().display().to_string();
    let mut found = Vec::new();
    for line in text.lines() {
        for start in starts {
            let Some((_, rest)) = line.split_once(start) else { continue };
            let words: Vec<String> = rest.split_whitespace().map(str::to_owned).collect();
            found.extend(asked(&place, &words));
        }
    }
    found
}

/// What lists of words in a document ask for.
fn of_document(place: &str, document: &Value) -> Vec<Asked> {
    match document {
        Value::Array(list) => {
            let words: Vec<String> = list.iter().filter_map(|word| word.as_str().map(str::to_owned)).collect();
            let own = asked(place, &words);
            own.into_iter().chain(list.iter().flat_map(|one| of_document(place, one))).collect()
        }
        Value::Object(members) => members.values().flat_map(|one| of_document(place, one)).collect(),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => Vec::new(),
    }
}

/// What all files ask for, but those for which a program is missing here.
fn all(tools: &Path, folder: &Path) -> Vec<Asked> {
    let mut found = Vec::new();
    for (path, starts) in [
        ("README.md", ["socrates ", "./socrates.sif "]),
        ("container/socrates.def", ["socrates.sif ", "`socrates "]),
        ("compose/compose.yaml", ["#   socrates ", "# $ socrates "]),
        ("compose/compose.keys.yaml", ["#   socrates ", "# $ socrates "]),
        ("systemd/socrates-cluster.service", ["ExecStart=/usr/local/bin/socrates ", "`socrates "]),
        ("systemd/socrates-workers.service", ["ExecStart=/usr/local/bin/socrates ", "`socrates "]),
        ("slurm/shards.sbatch", ["\"${SOCRATES:-socrates}\" ", "#   socrates "]),
        ("slurm/merge.sbatch", ["\"${SOCRATES:-socrates}\" ", "#   socrates "]),
        ("slurm/cluster.sbatch", ["\"$program\" ", "#   socrates "]),
    ] {
        let asked = of_text(&deployed(path), &starts);
        assert!(!asked.is_empty(), "{path} starts nothing");
        found.extend(asked);
    }
    for files in [["compose.yaml"].as_slice(), &["compose.yaml", "compose.keys.yaml"]] {
        found.extend(of_document("compose", &composed(tools, files, Some("/keys")).unwrap()));
    }
    for name in KUSTOMIZATIONS {
        if let Some(file) = rendered(name, folder) {
            found.extend(documents(tools, &file).iter().flat_map(|document| of_document(name, document)));
        }
    }
    found
}

#[test]
fn the_files_use_no_option_that_the_program_lacks() {
    let Some(tools) = tools() else { return };
    let folder = tempfile::tempdir().unwrap();
    let help = VERBS.map(|verb| {
        let words: Vec<&str> = verb.split(' ').chain(["--help"]).collect();
        let told = socrates(folder.path(), "help", &words);
        (verb, (told.code == 0).then_some(told.out))
    });
    let missing: Vec<&str> = help.iter().filter(|(_, told)| told.is_none()).map(|(verb, _)| *verb).collect();
    let whole = if missing.is_empty() { Ok(()) } else { Err(format!("the program has no {}", missing.join(", "))) };
    if skip::elsewhere(whole).is_none() {
        return;
    }
    let mut unknown = Vec::new();
    for Asked { place, verb, options } in all(&tools, folder.path()) {
        let told = help.iter().find(|(name, _)| *name == verb).and_then(|(_, told)| told.clone()).unwrap_or_default();
        let known: Vec<&str> = told.split(|c: char| !c.is_ascii_alphanumeric() && c != '-').collect();
        let lacking = options.iter().filter(|option| !known.contains(&option.as_str()));
        unknown.extend(lacking.map(|option| format!("  {place}: {verb} {option}")));
    }
    assert!(unknown.is_empty(), "the program does not know:\n{}", unknown.join("\n"));
}

#[test]
fn versions_in_the_files_are_those_of_the_workspace() {
    let manifest: toml::Table = std::fs::read_to_string(root().join("Cargo.toml")).unwrap().parse().unwrap();
    let package = &manifest["workspace"]["package"];
    let text = |path: &str| std::fs::read_to_string(deployed(path)).unwrap();
    let image = format!("docker.io/library/rust:{}-bookworm", package["rust-version"].as_str().unwrap());
    for path in ["container/Containerfile", "container/socrates.def"] {
        assert!(text(path).contains(&image), "{path} builds with another compiler than {image}");
    }
    let version = package["version"].as_str().unwrap();
    assert!(text("container/Containerfile").contains(&format!("ARG SOCRATES_VERSION={version}\n")));
    assert!(text("kubernetes/overlays/prod/kustomization.yaml").contains(&format!("newTag: \"{version}\"")));
}
