//! The catalog in the page of this crate is the catalog.

use std::fs;

use socrates_bt::{CATALOG, DIALECTS, NodeSheet, RARE, STEPS};

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/README.md");
const FROM: &str = "<!-- catalog: as the test `readme` writes it -->\n";
const TO: &str = "<!-- end of the catalog -->";

fn rows<'a>(sheets: impl IntoIterator<Item = &'a NodeSheet>, text: &mut String) {
    text.push_str("| node | kind | children | ports (default) | what it does |\n|---|---|---|---|---|\n");
    for sheet in sheets {
        let tag = match (sheet.v3_tag, sheet.only_in()) {
            (Some(v3), _) => format!("`{}` (v3 `{v3}`)", sheet.tag),
            (None, Some(format)) => format!("`{}` ({} only)", sheet.tag, format.name()),
            (None, None) => format!("`{}`", sheet.tag),
        };
        let ports: Vec<String> = sheet
            .ports
            .iter()
            .map(|port| {
                let name = port
                    .v4_name
                    .map_or_else(|| format!("`{}`", port.name), |v4| format!("`{}` (v4 `{v4}`)", port.name));
                match port.default {
                    Some("") => format!("{name} (may be left out)"),
                    Some(default) => format!("{name} ({default})"),
                    None => name,
                }
            })
            .collect();
        let native = if sheet.is_native() { "" } else { " *World only.*" };
        text.push_str(&format!(
            "| {tag} | {} | {} | {} | {}{native} |\n",
            sheet.kind.name(),
            sheet.arity.allowed(),
            ports.join(", "),
            sheet.about.replace('|', "\\|")
        ));
    }
}

fn catalog() -> String {
    let mut text = String::from("\n### Ours: BehaviorTree.CPP, the SocRATES fork, and our own nodes\n\n");
    rows(CATALOG.iter().copied(), &mut text);
    text.push_str("\n### Nodes by which the steps of a form are played, offered to nobody\n\n");
    rows(STEPS.iter().copied(), &mut text);
    text.push_str("\n### Rare nodes of BehaviorTree.CPP, read and ticked but offered to nobody\n\n");
    rows(RARE.iter().copied(), &mut text);
    for (library, sheets) in DIALECTS.iter() {
        text.push_str(&format!("\n### `{}`, beside the nodes of BehaviorTree.CPP\n\n", library.name()));
        rows(sheets, &mut text);
    }
    text.push('\n');
    text
}

fn split(page: &str) -> (&str, &str, &str) {
    let from = page.find(FROM).unwrap() + FROM.len();
    let to = page.find(TO).unwrap();
    (&page[..from], &page[from..to], &page[to..])
}

#[test]
fn the_page_lists_the_catalog() {
    let page = fs::read_to_string(PAGE).unwrap();
    let (before, listed, after) = split(&page);
    if listed != catalog() {
        // The page as it should be lies beside the built tests, ready to be copied.
        let right = concat!(env!("CARGO_TARGET_TMPDIR"), "/README.md");
        fs::write(right, format!("{before}{}{after}", catalog())).unwrap();
        panic!("the catalog of the page is out of date; copy {right} over it");
    }
}
