//! Which check finds which injected fault, as a table.

use std::collections::{BTreeMap, BTreeSet};

use socrates_author::confusion::{Confusion, Row, answers, confusion};
use socrates_author::offline::Offline;
use socrates_author::{FaultKind, Question};
use socrates_model::FaultCode;
use socrates_stats::{Z_95, wilson};

use super::spec::Spec;
use crate::output::Printer;
use crate::prepare::Prepared;
use crate::progress::Progress;

/// What stands over every table and in every line.
const STAMP: &str = "injected faults, not a model's";

/// Asks the offline author for every scenario and puts every fault into every answer.
pub(super) async fn table(talk: &Printer, cases: &[(Prepared, u64)]) -> Confusion {
    let mut all = Vec::new();
    let mut progress = Progress::new(*talk, "asking", cases.len());
    for (index, (prepared, seed)) in cases.iter().enumerate() {
        progress.at(index, "");
        let first =
            Question::first(prepared.request.clone(), prepared.reading.clone(), prepared.location.clone(), *seed);
        all.extend(answers(&Offline, &first).await);
    }
    confusion(&all).await
}

/// The classes of the table with their rows over all stages.
fn by_kind(table: &Confusion) -> BTreeMap<FaultKind, Row> {
    let mut kinds: BTreeMap<FaultKind, Row> = BTreeMap::new();
    for ((_, kind), row) in &table.rows {
        let sum = kinds.entry(*kind).or_default();
        sum.put_in += row.put_in;
        sum.no_place += row.no_place;
        sum.noticed += row.noticed;
        sum.own += row.own;
        for (code, count) in &row.found {
            *sum.found.entry(*code).or_default() += count;
        }
    }
    kinds
}

/// One line for each stage, fault that was put in and code that was found; `none` in place of the fault for clean answers.
pub(super) fn csv(table: &Confusion) -> String {
    let mut out = String::from("stage,injected,code_wanted,answers,no_place,noticed,code_found,found_in,note\n");
    for ((stage, kind), row) in &table.rows {
        let head = format!("{stage},{},{},{},{},{}", kind.word(), kind.code(), row.put_in, row.no_place, row.noticed);
        let found: Vec<(String, usize)> = row.found.iter().map(|(code, count)| (code.to_string(), *count)).collect();
        lines(&mut out, &head, &found);
    }
    for (stage, alarms) in &table.clean {
        let head = format!("{stage},none,none,{},0,{}", alarms.answers, alarms.refused);
        let found: Vec<(String, usize)> = alarms.found.iter().map(|(code, count)| (code.to_string(), *count)).collect();
        lines(&mut out, &head, &found);
    }
    out
}

fn lines(out: &mut String, head: &str, found: &[(String, usize)]) {
    let none = [("none".to_owned(), 0)];
    for (code, count) in if found.is_empty() { none.as_slice() } else { found } {
        out.push_str(&format!("{head},{code},{count},{STAMP}\n"));
    }
}

/// The table for people.
pub(super) fn markdown(spec: &Spec, shown: &str, table: &Confusion) -> String {
    let clean: usize = table.clean.values().map(|alarms| alarms.answers).sum();
    let refused: usize = table.clean.values().map(|alarms| alarms.refused).sum();
    let mut out = format!(
        "# {}\n\n> **Injected faults, not a model's.** The figures say what the checks are worth and nothing about any language model;\n> \
         they do not belong on one axis with one.\n\nMade by `socrates evaluate author {shown}`: {clean} answers of the offline author at {}; \
         every kind of fault is put\ninto every answer that has a place for it, one at a time.\n\n",
        spec.title,
        spec.locations.join(", ")
    );
    out.push_str(&format!(
        "## Answers into which nothing was put\n\nRefused: {} (Wilson, 95 %). By the code of the check:\n\n| stage | answers | refused | codes |\n|---|---|---|---|\n",
        share(refused, clean)
    ));
    for (stage, alarms) in &table.clean {
        let codes: Vec<String> = alarms.found.iter().map(|(code, count)| format!("{code} {count}")).collect();
        let codes = if codes.is_empty() { "none".to_owned() } else { codes.join(", ") };
        out.push_str(&format!("| {stage} | {} | {} | {codes} |\n", alarms.answers, alarms.refused));
    }
    out.push_str(
        "\n## Class by class\n\nFound: the fault's own code is among the reasons. Noticed: the answer did not pass as it was. No place: answers that\nhave nothing that could be made wrong in this way (nobody in a group, no timer …).\n\n| fault | what is wrong | code | put in | found | noticed | no place | other codes found with it |\n|---|---|---|---|---|---|---|---|\n",
    );
    for (kind, row) in by_kind(table) {
        let others: Vec<String> = row
            .found
            .iter()
            .filter(|(code, _)| **code != kind.code())
            .map(|(code, count)| format!("{code} {count}"))
            .collect();
        out.push_str(&format!(
            "| {} | {} | {} | {} | {} | {} | {} | {} |\n",
            kind.word(),
            kind.about().trim_end_matches('.').to_lowercase(),
            kind.code(),
            row.put_in,
            share(row.own, row.put_in),
            share(row.noticed, row.put_in),
            row.no_place,
            others.join(", ")
        ));
    }
    out.push_str(&untried(table));
    out
}

/// Hard codes of answers that no operator makes, said rather than left out.
fn untried(table: &Confusion) -> String {
    let tried: BTreeSet<FaultCode> = table.rows.keys().map(|(_, kind)| kind.code()).collect();
    let of_answers = |code: &FaultCode| matches!(code.code().get(..2), Some("T-" | "E-" | "P-" | "G-" | "B-"));
    let missing: Vec<&str> = FaultCode::ALL
        .iter()
        .filter(|code| of_answers(code) && !code.is_soft() && !tried.contains(code))
        .map(|code| code.code())
        .collect();
    format!(
        "\nNot put in: {}: of the request, the map or the configuration, not of an answer, or of its size.\n",
        missing.join(", ")
    )
}

fn share(count: usize, of: usize) -> String {
    match wilson(count, of, Z_95) {
        Ok(found) => format!(
            "{count}/{of} = {:.0} % ({:.1}–{:.1})",
            100.0 * found.estimate,
            100.0 * found.low,
            100.0 * found.high
        ),
        Err(_none) => "none".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use socrates_model::job::Stage;

    #[test]
    fn every_line_is_stamped_and_every_class_has_its_row() {
        let mut table = Confusion::default();
        let row = Row { put_in: 4, noticed: 4, own: 3, found: BTreeMap::from([(FaultCode::GDisc, 3)]), no_place: 1 };
        table.rows.insert((Stage::Paths, FaultKind::Gdisc), row);
        table.clean.entry(Stage::Paths).or_default().answers = 5;
        let text = csv(&table);
        assert!(text.lines().skip(1).all(|line| line.ends_with(STAMP)), "{text}");
        assert!(
            text.contains("paths,gdisc,G-DISC,4,1,4,G-DISC,3,") && text.contains("paths,none,none,5,0,0,none,0,"),
            "{text}"
        );
        let page = markdown(&Spec::load(Path::new("faults")).unwrap(), "faults", &table);
        assert!(
            page.contains("Injected faults, not a model's") && page.contains("| G-DISC | 4 | 3/4 = 75 %"),
            "{page}"
        );
        assert!(page.contains("Not put in: ") && page.contains("G-FREE"), "{page}");
    }
}
