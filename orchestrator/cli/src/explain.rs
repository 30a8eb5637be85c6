//! `explain`, `config`, `doctor`, `new`, `open`: verbs that run nothing.

use std::path::Path;

use serde_json::json;
use socrates_model::FaultCode;
use socrates_scoring::metrics::{CATALOG, Direction, Family, Sheet};

use crate::args::Format;
use crate::config::Config;
use crate::exit::Complaint;
use crate::talk::Talk;

/// The word for the list of metrics.
const METRICS: &str = "metrics";

/// Prints the list of metrics: for each its unit, whether it is known while a run goes on, and what it is.
fn metrics(talk: &Talk) {
    let mut rows = Vec::new();
    for family in CATALOG {
        let known = if family.waits().is_none() { "online" } else { "at the end" };
        for sheet in family.sheets {
            talk.line(&format!("{:<34} {:<10} {known:<11} {}", sheet.id, sheet.unit, sheet.about));
            rows.push(json!({ "id": sheet.id, "unit": sheet.unit, "online": family.waits().is_none() }));
        }
    }
    let signature = socrates_scoring::metrics::signature();
    talk.line(&format!("thresholds {signature}"));
    talk.result(&json!({ "metrics": rows, "thresholds": signature }));
}

/// Prints the fact sheet of a metric.
fn metric(talk: &Talk, family: &Family, sheet: &Sheet) {
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
        "metric": sheet.id, "unit": sheet.unit, "about": sheet.about, "direction": sheet.direction.sign(),
        "source": sheet.source, "version": sheet.version(), "online": family.waits().is_none(),
        "waits": family.waits(), "thresholds": thresholds,
    }));
}

/// Prints the page of a code or of a metric, or the list of codes or metrics.
pub(crate) fn explain(talk: &Talk, code: Option<&str>) -> Result<(), Complaint> {
    if code == Some(METRICS) {
        metrics(talk);
        return Ok(());
    }
    let mut sheets = CATALOG.iter().flat_map(|family| family.sheets.iter().map(move |sheet| (family, sheet)));
    if let Some((family, sheet)) = sheets.find(|(_, sheet)| Some(sheet.id) == code) {
        metric(talk, family, sheet);
        return Ok(());
    }
    let Some(code) = code else {
        for code in FaultCode::ALL {
            talk.line(&format!("{:<11} {}", code.code(), code.about()));
        }
        talk.result(&json!({ "codes": FaultCode::ALL.iter().map(|code| code.code()).collect::<Vec<_>>() }));
        return Ok(());
    };
    let code: FaultCode = code.parse().map_err(|bad: socrates_model::ids::BadId| {
        let wanted = bad.found.to_ascii_uppercase();
        let near: Vec<&str> = FaultCode::ALL
            .iter()
            .map(|code| code.code())
            .filter(|code| wanted.get(..2) == code.get(..2))
            .take(8)
            .collect();
        let hint = if near.is_empty() {
            format!("`socrates explain` lists every code, `socrates explain {METRICS}` every metric")
        } else {
            format!("codes of this kind: {}", near.join(", "))
        };
        Complaint::input(bad.to_string(), hint)
    })?;
    talk.line(code.page().trim_end());
    talk.result(&json!({ "code": code.code(), "about": code.about(), "page": code.page() }));
    Ok(())
}

/// Prints the effective configuration.
pub(crate) fn config(talk: &Talk, config: &Config, part: Option<&str>) -> Result<(), Complaint> {
    let lines = config.lines(part);
    if lines.is_empty() {
        return Err(Complaint::input(
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

/// Writes a commented request.
pub(crate) fn new(talk: &Talk, file: &Path, location: &str) -> Result<(), Complaint> {
    if file.exists() {
        return Err(Complaint::input(
            format!("`{}` exists already", file.display()),
            "choose another name; nothing was written",
        ));
    }
    crate::prepare::load_location(location, Path::new("."))?;
    let text = include_str!("request.toml").replace("LOCATION", location);
    std::fs::write(file, text)
        .map_err(|why| Complaint::input(format!("cannot write `{}`: {why}", file.display()), "check the folder"))?;
    talk.line(&format!("wrote      {}", file.display()));
    talk.line(&format!("next       socrates read {}", crate::files::shell(file)));
    talk.result(&json!({ "request": file.display().to_string() }));
    Ok(())
}

/// Opens the page of a bundle with the desktop's program, or says where it is.
pub(crate) fn open(talk: &Talk, bundle: &Path) -> Result<(), Complaint> {
    let page = bundle.join("report.html");
    if !page.is_file() {
        return Err(Complaint::input(
            format!("`{}` has no report.html", bundle.display()),
            "name the folder that `socrates run` printed after `look`",
        ));
    }
    let opened = ["xdg-open", "open"].into_iter().any(|program| {
        std::process::Command::new(program)
            .arg(&page)
            .stdout(std::process::Stdio::null())
            .stderr(std::process::Stdio::null())
            .status()
            .is_ok_and(|status| status.success())
    });
    talk.line(&format!("{}{}", if opened { "opened     " } else { "look       " }, page.display()));
    talk.result(&json!({ "page": page.display().to_string(), "opened": opened }));
    Ok(())
}

/// Checks what this machine can do.
pub(crate) fn doctor(talk: &Talk, config: &Config) -> Result<(), Complaint> {
    let key_found = crate::authors::key_found(config)?;
    let program = |name: &str| {
        std::env::var_os("PATH").is_some_and(|paths| std::env::split_paths(&paths).any(|dir| dir.join(name).is_file()))
    };
    let listen = std::net::TcpListener::bind("127.0.0.1:0").is_ok();
    let shm_free = shm_free_mib();
    let here = tempfile_ok();
    let checks: Vec<(&str, bool, bool, String)> = vec![
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
        ("language model key", key_found, false, "without it the offline author writes the scenarios".to_owned()),
        ("ffmpeg", program("ffmpeg"), false, "only for MP4 and WebM videos; GIF and SVG need nothing".to_owned()),
        (
            "browser",
            program("xdg-open") || program("chromium") || program("firefox"),
            false,
            "only for `socrates open`".to_owned(),
        ),
    ];
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
    talk.result(&json!({ "checks": checks.iter().map(|(name, ok, needed, _)| json!({"name": name, "ok": ok, "needed": needed})).collect::<Vec<_>>() }));
    if missing.is_empty() {
        Ok(())
    } else {
        Err(Complaint::input(format!("missing: {}", missing.join(", ")), "see the lines marked ✘"))
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
