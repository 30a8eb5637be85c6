//! `explain`, `config`, `doctor`, `open`: verbs that run nothing.

use std::path::Path;

use serde_json::json;
use socrates_model::FaultCode;
use socrates_scoring::metrics::peers::{self, Name};
use socrates_scoring::metrics::{CATALOG, Direction, Family, Sheet};

use crate::bundle;
use crate::config::Config;
use crate::exit::Diagnostic;
use crate::output::{Format, Printer};

/// The word for the list of metrics.
const METRICS: &str = "metrics";
/// The word for the glossary.
const WORDS: &str = "words";
/// Words that are proposed for one that is not known, at most.
const NEAR: usize = 5;

/// Prints the list of metrics: for each its unit, whether it is known while a run goes on, and what it is.
fn metrics(talk: &Printer) {
    let mut rows = Vec::new();
    for family in CATALOG {
        let known = if family.waits().is_none() { "online" } else { "at the end" };
        for sheet in family.sheets() {
            talk.line(&format!("{:<34} {:<10} {known:<11} {}", sheet.id, sheet.unit, sheet.about));
            rows.push(json!({ "id": sheet.id, "unit": sheet.unit, "online": family.waits().is_none() }));
        }
    }
    for name in peers::NAMES {
        talk.line(&format!("{:<58} is {}", name.name, name.ours));
    }
    let names: Vec<_> = peers::NAMES.iter().map(|name| json!({ "name": name.name, "is": name.ours })).collect();
    let signature = socrates_scoring::metrics::signature();
    talk.line(&format!("thresholds {signature}"));
    talk.result(&json!({ "metrics": rows, "names": names, "thresholds": signature }));
}

/// Prints the fact sheet of a metric, by its own name or by that of another tool.
fn metric(talk: &Printer, family: &Family, sheet: &Sheet, name: Option<&Name>) {
    if let Some(name) = name {
        talk.line(&format!("{} is {}", name.name, name.ours));
        if !name.differs.is_empty() {
            talk.line(&format!("differs    {}", name.differs));
        }
    }
    talk.line(&format!("{} ({}, version {})", sheet.id, sheet.unit, sheet.version()));
    talk.line(sheet.about);
    let better = match sheet.direction {
        Direction::Up => "more is better",
        Direction::Down => "less is better",
        Direction::Neutral => "neither more nor less is better",
    };
    talk.line(&format!("better     {better}"));
    talk.line(&format!("source     {}", sheet.source));
    let known = family.waits().map_or_else(|| "while the run goes on".to_owned(), |why| format!("at the end: {why}"));
    talk.line(&format!("known      {known}"));
    for (name, value) in family.thresholds {
        talk.line(&format!("threshold  {name} = {value}"));
    }
    let thresholds: serde_json::Map<String, serde_json::Value> =
        family.thresholds.iter().map(|(name, value)| ((*name).to_owned(), json!(value))).collect();
    talk.result(&json!({
        "metric": sheet.id, "asked": name.map(|name| name.name), "differs": name.map(|name| name.differs), "unit": sheet.unit, "about": sheet.about, "direction": sheet.direction.sign(),
        "source": sheet.source, "version": sheet.version(), "online": family.waits().is_none(),
        "waits": family.waits(), "thresholds": thresholds,
    }));
}

/// Prints the glossary: every word with the beginning of what it means.
fn words(talk: &Printer) {
    let all = socrates_model::words::words();
    let mut section = "";
    for word in &all {
        if word.section != section {
            section = word.section;
            talk.line(section);
        }
        let first = word.about.split_inclusive(". ").next().unwrap_or(word.about);
        talk.line(&format!("  {:<22} {}", word.names.first().unwrap_or(&""), first.trim_end()));
    }
    talk.line("Coverage");
    for (name, about) in crate::coverage::WORDS {
        talk.line(&format!("  {name:<22} {}", about.split_inclusive(". ").next().unwrap_or(about).trim_end()));
    }
    talk.result(&json!({
        "words": all.iter().map(|word| json!({ "word": word.names.first(), "also": word.names.get(1..), "section": word.section, "about": word.about })).collect::<Vec<_>>(),
    }));
}

/// What there is a page for.
enum Page {
    Metric(&'static Family, &'static Sheet, Option<&'static Name>),
    Fault(FaultCode),
    Word(socrates_model::words::Word),
    Coverage(&'static str, &'static str),
}

/// The page of a metric, a code or a word, whatever its case and with blanks for `_`.
fn page(text: &str) -> Option<Page> {
    let id = text.trim().trim_matches('`').to_lowercase().replace([' ', '-'], "_");
    let mut sheets = CATALOG.iter().flat_map(|family| family.sheets().iter().map(move |sheet| (family, sheet)));
    let name = peers::ours(&id);
    let meant = name.map_or(id.as_str(), |name| name.ours);
    let metric = sheets.find(|(_, sheet)| sheet.id == meant).map(|(family, sheet)| Page::Metric(family, sheet, name));
    let code = || text.trim().to_uppercase().parse().ok().map(Page::Fault);
    let covered = || {
        let mut words = crate::coverage::WORDS.iter();
        words.find(|(name, _)| name.replace(' ', "_") == id).map(|(name, about)| Page::Coverage(name, about))
    };
    metric.or_else(code).or_else(|| socrates_model::words::word(text).map(Page::Word)).or_else(covered)
}

/// What is nearest to a word that nobody knows.
fn near(text: &str) -> Vec<String> {
    let wanted = text.to_lowercase().replace(['_', '-'], " ");
    let words = socrates_model::words::words();
    let known = FaultCode::ALL.iter().map(|code| code.code().to_owned());
    let known = known.chain(CATALOG.iter().flat_map(Family::sheets).map(|sheet| sheet.id.to_owned()));
    let known = known.chain(peers::NAMES.iter().map(|name| name.name.to_owned()));
    let known = known.chain(crate::coverage::WORDS.iter().map(|(name, _)| (*name).to_owned()));
    let known = known.chain(words.iter().flat_map(|word| &word.names).map(|name| (*name).to_owned()));
    let mut all: Vec<(f64, String)> = known
        .map(|name| (strsim::jaro_winkler(&name.to_lowercase().replace(['_', '-'], " "), &wanted), name))
        .filter(|(alike, _)| *alike > 0.75)
        .collect();
    all.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
    all.into_iter().map(|(_, name)| name).take(NEAR).collect()
}

/// Prints the page of a code, a metric or a word, or a list of them.
pub fn explain(talk: &Printer, what: &[String]) -> Result<(), Diagnostic> {
    let what = what.join(" ");
    match what.as_str() {
        "" => {
            for code in FaultCode::ALL {
                talk.line(&format!("{:<11} {}", code.code(), code.about()));
            }
            talk.line(&format!("`socrates explain {METRICS}` lists the metrics, `socrates explain {WORDS}` the words"));
            talk.result(&json!({ "codes": FaultCode::ALL.iter().map(|code| code.code()).collect::<Vec<_>>() }));
            return Ok(());
        }
        METRICS => {
            metrics(talk);
            return Ok(());
        }
        WORDS => {
            words(talk);
            return Ok(());
        }
        _ => {}
    }
    match page(&what) {
        Some(Page::Metric(family, sheet, name)) => metric(talk, family, sheet, name),
        Some(Page::Fault(code)) => {
            talk.line(code.page().trim_end());
            talk.result(&json!({ "code": code.code(), "about": code.about(), "page": code.page() }));
        }
        Some(Page::Word(word)) => {
            talk.line(&format!("{} ({})", word.names.join(" · "), word.section.to_lowercase()));
            talk.line(word.about);
            talk.result(
                &json!({ "word": word.names.first(), "also": word.names.get(1..), "section": word.section, "about": word.about }),
            );
        }
        Some(Page::Coverage(word, about)) => {
            talk.line(&format!("{word} (coverage)"));
            talk.line(about);
            talk.result(&json!({ "word": word, "also": [], "section": "Coverage", "about": about }));
        }
        None => {
            let near = near(&what);
            let lists = format!(
                "`socrates explain` lists every code, `socrates explain {METRICS}` every metric, `socrates explain {WORDS}` every word"
            );
            let hint = if near.is_empty() { lists } else { format!("near: {}; {lists}", near.join(", ")) };
            return Err(Diagnostic::input(
                format!("`{what}` is neither a code nor a metric nor a word of the program"),
                hint,
            ));
        }
    }
    Ok(())
}

/// Prints the effective configuration.
pub fn config(talk: &Printer, config: &Config, part: Option<&str>) -> Result<(), Diagnostic> {
    let lines = config.lines(part);
    if lines.is_empty() {
        return Err(Diagnostic::input(
            format!("no configuration key begins with `{}`", part.unwrap_or_default()),
            "`socrates config` prints all of them",
        ));
    }
    if talk.format == Format::Text && part.is_none() {
        talk.line(crate::config::BUILT_IN.trim_end());
        talk.line("");
        talk.line("# Effective values and where they come from:");
    }
    for (key, value, origin) in &lines {
        talk.line(&format!("{key:<24} {value:<32} # {origin}"));
    }
    if part.is_none_or(|part| "author.timeout_s".starts_with(part) || "orchestrator.".starts_with(part)) {
        talk.line("");
        for line in crate::authors::consequences(config)? {
            talk.line(&line);
        }
    }
    if part == Some("author") {
        talk.line("");
        talk.line("# To ask a language model: put the key into the variable named by author.key_variable, and");
        talk.line("# SOCRATES_AUTHOR__MODEL=<model> socrates run my.toml      or      socrates run my.toml --author openai:<model>");
    }
    let map: serde_json::Map<String, serde_json::Value> =
        lines.iter().map(|(key, value, origin)| (key.clone(), json!({ "value": value, "origin": origin }))).collect();
    talk.result(&json!({ "config": map }));
    Ok(())
}

/// Opens the page of a bundle with the desktop's program, or says where it is. A packed bundle becomes a folder beside its file.
pub fn open(talk: &Printer, what: &Path) -> Result<(), Diagnostic> {
    let folder = match bundle::archive(what) {
        Some(archive) => {
            let folder = bundle::unpack_beside(&archive)?;
            talk.line(&format!("unpacked   {}", folder.display()));
            folder
        }
        None => what.to_path_buf(),
    };
    let page = folder.join(crate::layout::PAGE.path);
    if !page.is_file() {
        return Err(Diagnostic::input(
            format!("`{}` has no report.html", what.display()),
            "name the folder that `socrates run` printed after `look`",
        ));
    }
    let opened = crate::files::open_outside(page.as_os_str());
    talk.line(&format!("{}{}", if opened { "opened     " } else { "look       " }, page.display()));
    talk.result(&json!({ "page": page.display().to_string(), "opened": opened }));
    Ok(())
}

/// Checks what this machine can do.
pub fn doctor(talk: &Printer, config: &Config) -> Result<(), Diagnostic> {
    let key_found = crate::authors::key_found(config)?;
    let program = |name: &str| config.installed(name).is_some();
    let listen = std::net::TcpListener::bind("127.0.0.1:0").is_ok();
    let shm_free = shm_free_mib();
    let here = tempfile_ok();
    let mut checks: Vec<(&str, bool, bool, String)> = vec![
        ("loopback network", listen, true, "worker processes talk over 127.0.0.1".to_owned()),
        (
            "this folder is writable",
            here,
            true,
            "bundles are written to runs/; --out chooses another folder".to_owned(),
        ),
        (
            "shared memory",
            shm_free.is_some_and(|mib| mib >= 16),
            false,
            format!("/dev/shm has {} MiB free; without it runs stream over the network only", shm_free.unwrap_or(0)),
        ),
        (
            "language model key",
            key_found,
            false,
            "without it `auto` takes a server on this machine, else the offline author".to_owned(),
        ),
        ("ffmpeg", program("ffmpeg"), false, "only for MP4 and WebM videos; GIF and SVG need nothing".to_owned()),
        (
            "browser",
            program("xdg-open") || program("chromium") || program("firefox"),
            false,
            "only for `socrates open`".to_owned(),
        ),
    ];
    for server in crate::authors::servers_here(config)? {
        let (told, url) = (server.model.as_ref().map_or_else(String::clone, |model| format!("`{model}`")), &server.url);
        let note = if url.is_empty() { told } else { format!("{url}: {told}") };
        checks.push((server.kind.name(), server.model.is_ok(), false, note));
    }
    let mut missing = Vec::new();
    for (name, ok, needed, note) in &checks {
        let mark = if *ok {
            "✔"
        } else if *needed {
            "✘"
        } else {
            "–"
        };
        talk.line(&format!("{mark} {name:<24} {note}"));
        if !ok && *needed {
            missing.push((*name).to_owned());
        }
    }
    talk.result(&json!({ "checks": checks.iter().map(|(name, ok, needed, note)| json!({"name": name, "ok": ok, "needed": needed, "note": note})).collect::<Vec<_>>() }));
    if missing.is_empty() {
        Ok(())
    } else {
        Err(Diagnostic::input(format!("missing: {}", missing.join(", ")), "see the lines marked ✘"))
    }
}

fn tempfile_ok() -> bool {
    let probe = Path::new(".socrates-probe");
    let ok = std::fs::write(probe, b"x").is_ok();
    ok && std::fs::remove_file(probe).is_ok()
}

/// Free shared memory in MiB, from `df`; `None` where there is none.
fn shm_free_mib() -> Option<u64> {
    let out = std::process::Command::new("df").args(["-m", "--output=avail", "/dev/shm"]).output().ok()?;
    String::from_utf8(out.stdout).ok()?.lines().nth(1)?.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use socrates_model::Verdict;

    use super::*;

    const WEB: [&str; 4] = [
        include_str!("../../../maps/draw/src/web/page.html"),
        include_str!("../../../maps/draw/src/web/batch.html"),
        include_str!("../../../maps/draw/src/web/tracks.html"),
        include_str!("../../../maps/draw/src/page.rs"),
    ];
    const SCRIPTS: [&str; 3] = [
        include_str!("../../../maps/draw/src/web/page.js"),
        include_str!("../../../maps/draw/src/web/batch.js"),
        include_str!("../../../maps/draw/src/web/tracks.js"),
    ];

    /// What stands between these two marks, wherever they do.
    fn between<'a>(text: &'a str, from: &'a str, to: &'a str) -> impl Iterator<Item = &'a str> {
        text.split(from).skip(1).filter_map(move |rest| rest.split_once(to).map(|(inside, _)| inside))
    }

    /// Headings of the pages: of sections, of folded parts, of columns, and of what stands beside a value.
    fn headings() -> Vec<String> {
        let mut found: Vec<String> = Vec::new();
        for text in WEB {
            for (from, to) in [("<h2", "</h2>"), ("<dt", "</dt>"), ("<th", "</th>"), ("<summary", "</summary>")] {
                let inside = between(text, from, to).filter_map(|rest| rest.split_once('>'));
                found.extend(inside.map(|(_, words)| words.split('<').next().unwrap_or_default().trim().to_owned()));
            }
        }
        for script in SCRIPTS {
            for from in
                ["heading(table, [", "heading(at(\"runs\"), [", "heading(at(\"metrics\"), [", "for (const name of [\""]
            {
                for list in between(script, from, "]") {
                    let whole = if from.ends_with('"') { format!("\"{list}") } else { list.to_owned() };
                    found.extend(whole.split('"').skip(1).step_by(2).map(str::to_owned));
                }
            }
        }
        found.retain(|words| !words.is_empty() && !words.contains(['{', '$', '(']));
        found.into_iter().map(|words| words.trim_end_matches(", median").to_owned()).collect()
    }

    #[test]
    fn names_of_other_tools_lead_to_the_metric_that_they_mean() {
        let Some(Page::Metric(_, sheet, Some(name))) = page("`Arena.Path_Length`") else { panic!("no page") };
        assert_eq!((sheet.id, name.name), ("path_length", "arena.path_length"));
        assert!(name.differs.contains("origin"), "{}", name.differs);
        let Some(Page::Metric(_, sheet, None)) = page("sean.completed") else { panic!("no page") };
        assert_eq!(sheet.id, "sean.completed");
        assert!(near("socnavbench.path_lenght").contains(&"socnavbench.path_length".to_owned()));
    }

    #[test]
    fn every_word_of_output_pages_and_tables_has_a_page() {
        let mut needed: Vec<String> = headings();
        assert!(needed.len() > 40, "{needed:?}");
        let verdicts = [
            Verdict::Realised,
            Verdict::RealisedLate,
            Verdict::NotTriggered,
            Verdict::Contradicted,
            Verdict::Invalid,
            Verdict::RobotPrevented,
        ];
        needed.extend(verdicts.map(|verdict| verdict.name().to_owned()));
        needed.push(crate::index::FAILED.to_owned());
        let serde_name = |value: serde_json::Value| value.as_str().unwrap().to_owned();
        use socrates_model::ClauseRole;
        use socrates_model::report::Standing;
        needed.extend([ClauseRole::Setup, ClauseRole::Outcome].map(|role| serde_name(json!(role))));
        let standings =
            [Standing::Holds, Standing::Late, Standing::NotTriggered, Standing::Fails, Standing::NotApplicable];
        needed.extend(standings.map(|standing| serde_name(json!(standing))));
        needed.extend(socrates_stream::csv::AGENT_COLUMNS.map(str::to_owned));
        needed.extend(crate::index::Index::default().csv().trim().split(',').map(str::to_owned));
        needed.extend(crate::bundle::METRIC_COLUMNS.map(str::to_owned));
        let pool = socrates_scoring::pool(&[]).unwrap();
        needed.extend(pool.csv().trim().split(',').map(str::to_owned));
        needed.extend(
            ["encounter gap", "setup clause", "surface distance", "center distance", "promised by", "c7", "f1"]
                .map(str::to_owned),
        );
        needed.extend(
            ["auto-time-human_1", "auto-meet-human_2-2", "auto-group_1", "auto-humans", "auto-start-human_1"]
                .map(str::to_owned),
        );
        needed.extend(socrates_planners::names().iter().map(|name| (*name).to_owned()));
        let without: Vec<&String> = needed.iter().filter(|word| page(word).is_none()).collect();
        assert!(without.is_empty(), "`explain` knows nothing of {without:?}: add them to bus/model/words.md");
    }

    #[test]
    fn a_word_that_nobody_knows_is_answered_with_near_ones() {
        let talk = Printer::to_nobody(Format::Json);
        assert!(explain(&talk, &["encounter".to_owned(), "gap".to_owned()]).is_ok());
        let why = explain(&talk, &["contradictd".to_owned()]).unwrap_err();
        assert!(why.hint.contains("near: contradicted"), "{}", why.hint);
        let why = explain(&talk, &["G-DISK".to_owned()]).unwrap_err();
        assert!(why.hint.contains("G-DISC"), "{}", why.hint);
        assert!(explain(&talk, &["g-disc".to_owned()]).is_ok());
    }
}
