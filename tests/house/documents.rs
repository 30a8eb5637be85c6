//! Documents: links lead somewhere, every fault has its page, every library its front page.

use socrates_tests::root;

use super::{files, members, shown};

#[test]
fn every_library_opens_with_a_page_and_a_never_list() {
    let mut thin = Vec::new();
    for member in members().keys() {
        let lib = root().join(member).join("src/lib.rs");
        let Ok(text) = std::fs::read_to_string(&lib) else { continue };
        let page: String = text.lines().take_while(|line| line.starts_with("//!")).collect::<Vec<_>>().join("\n");
        if !page.contains("```text") || !page.to_lowercase().contains("never") {
            thin.push(format!("  {}", shown(&lib)));
        }
    }
    assert!(thin.is_empty(), "front pages without a drawing or a never list:\n{}", thin.join("\n"));
}

#[test]
fn every_fault_has_a_page_and_every_page_a_fault() {
    let pages = root().join("bus/model/faults");
    let mut names: Vec<String> = std::fs::read_dir(pages)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().trim_end_matches(".md").to_owned())
        .collect();
    names.sort();
    let mut codes: Vec<String> = socrates_model::FaultCode::ALL.iter().map(|code| code.code().to_owned()).collect();
    codes.sort();
    assert_eq!(names, codes);
}

#[test]
fn links_and_paths_in_documents_lead_somewhere() {
    let mut dead = Vec::new();
    for document in files(".md") {
        let text = std::fs::read_to_string(&document).unwrap();
        let folder = document.parent().unwrap();
        for part in text.split("](").skip(1) {
            let target = part.split([')', '#', ' ']).next().unwrap_or_default();
            if target.is_empty() || target.contains("://") || target.starts_with('#') {
                continue;
            }
            if !folder.join(target).exists() {
                dead.push(format!("  {}: {target}", shown(&document)));
            }
        }
    }
    assert!(dead.is_empty(), "dead links:\n{}", dead.join("\n"));
}
