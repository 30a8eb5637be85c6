//! The house rules, each as a test.
#![cfg(test)]

mod budgets;
mod circles;
mod documents;
mod english;
mod features;
mod layout;
mod lexer;
mod modules;
mod openness;
mod purity;
mod rings;
mod rooms;
mod sources;
mod spelling;
mod strings;
mod tables;
mod walls;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use socrates_tests::root;

/// Every member of the workspace with its manifest.
fn members() -> BTreeMap<String, toml::Table> {
    let manifest: toml::Table = std::fs::read_to_string(root().join("Cargo.toml")).unwrap().parse().unwrap();
    manifest["workspace"]["members"]
        .as_array()
        .unwrap()
        .iter()
        .map(|member| {
            let member = member.as_str().unwrap().to_owned();
            let text = std::fs::read_to_string(root().join(&member).join("Cargo.toml")).unwrap();
            (member, text.parse().unwrap())
        })
        .collect()
}

/// Files under the root with this ending, without what is built.
fn files(ending: &str) -> Vec<PathBuf> {
    fn walk(dir: &Path, ending: &str, found: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(dir).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_dir() {
                if !matches!(name.as_str(), "target" | ".git" | "runs" | ".socrates" | "node_modules") {
                    walk(&path, ending, found);
                }
            } else if name.ends_with(ending) {
                found.push(path);
            }
        }
    }
    let mut found = Vec::new();
    walk(&root(), ending, &mut found);
    found.sort();
    found
}

fn shown(path: &Path) -> String {
    path.strip_prefix(root()).unwrap_or(path).display().to_string()
}
