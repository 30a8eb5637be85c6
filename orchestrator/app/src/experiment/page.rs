//! The report of an experiment: one page that a stranger can read, which loads nothing.

use std::collections::BTreeMap;

use socrates_draw::svg::{escape, escape_code};
use socrates_experiment::beside::Beside;
use socrates_experiment::heat::Heat;
use socrates_experiment::plots::Plot;
use socrates_experiment::spec::{Cell, Level};
use socrates_experiment::{CellResult, Figures, Kind, Limited, Pairing, Spec, Tally};

use super::{chart, heat};
use crate::words::plural;

/// The look of the page.
const STYLE: &str = ":root{color-scheme:light}*{box-sizing:border-box}\
body{margin:0;background:#f3f5f8;color:#1f2328;font:15px/1.5 Ubuntu,'Segoe UI',Helvetica,Arial,sans-serif}\
main{max-width:1380px;margin:0 auto;padding:24px 20px}h1{font-size:28px;line-height:1.2;margin:0 0 6px}\
h2{font-size:18px;margin:0 0 8px}h3{font-size:15px;margin:18px 0 6px}p{margin:4px 0 8px}\
section{background:#fff;border:1px solid #dde1e6;border-radius:10px;padding:16px 18px;margin:14px 0}\
.stamp{border-color:#b3400b;color:#b3400b;font-weight:600}.bad{color:#b3400b;font-weight:600}.good{color:#00795c;font-weight:600}\
.quiet{color:#5b636e}.wide{overflow-x:auto}table{border-collapse:collapse;font-size:12px;font-variant-numeric:tabular-nums}\
th,td{padding:3px 6px;text-align:right;border-bottom:1px solid #dde1e6;white-space:nowrap}\
th{border-bottom-color:#5b636e;vertical-align:bottom}td.name,th.name{text-align:left}tr.first td{background:#f3f5f8}\
td.about{text-align:left;white-space:normal}figure{margin:18px 0 26px}figure svg{width:100%;max-width:1080px;height:auto;display:block}\
figcaption{font-size:13px;color:#5b636e;margin-top:4px}code{font-size:13px}li{margin:3px 0}";

/// What the page tells.
pub(super) struct Told<'a> {
    pub(super) spec: &'a Spec,
    pub(super) results: &'a [CellResult],
    pub(super) figures: &'a [Figures],
    pub(super) means: &'a [Limited],
    pub(super) pairings: &'a [Option<Pairing>],
    pub(super) plots: &'a [Plot],
    /// How scenarios ended.
    pub(super) heats: &'a [Heat],
    /// The command that does it again.
    pub(super) again: &'a str,
    /// Attempts that `attempts.csv` does not have.
    pub(super) attempts_left_out: u64,
    /// Every cell beside what the simulator says of it, where it was played on processes.
    pub(super) besides: &'a [Beside],
    /// The machine that it was played on, where that matters.
    pub(super) machine: &'a [String],
}

/// The page.
pub(super) fn html(told: &Told<'_>) -> String {
    let title = escape(&told.spec.title);
    let mut out = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">\
         <title>{title}</title><style>{STYLE}</style></head><body><main>\n<h1>{title}</h1>\n"
    );
    if !told.spec.about.is_empty() {
        out.push_str(&format!("<p>{}</p>\n", escape_code(&told.spec.about)));
    }
    let stamp = match told.spec.level {
        Level::Simulator => {
            "Injected faults and a simulated author, no language model and no real process: this shows what the orchestrator's rules \
             make of faults, and says nothing about any model."
        }
        Level::Processes => {
            "Injected faults and a simulated author, no language model. Level: real processes, wall time: orchestrator, store, bus and \
             workers are those of the program, and were killed and stopped by signals. It says nothing about any model."
        }
    };
    out.push_str(&format!("<section class=\"stamp\">{stamp}</section>\n"));
    section(&mut out, "What was done", &done(told));
    section(&mut out, "What struck", &struck(told));
    if !told.besides.is_empty() {
        section(&mut out, "Beside the simulator", &beside(told));
    }
    section(&mut out, "Nothing lost, nothing done twice", &safety(told));
    section(&mut out, "What is assumed", &assumed(told.spec));
    section(&mut out, "Policies", &policies(told.spec));
    section(&mut out, "How scenarios ended", &ends(told.heats));
    section(&mut out, "Plots", &plots(told.plots));
    section(&mut out, "Every cell", &tables(told));
    section(&mut out, "Files beside this page", &files(told));
    out.push_str("</main></body></html>\n");
    out
}

fn section(out: &mut String, heading: &str, body: &str) {
    out.push_str(&format!("<section><h2>{heading}</h2>\n{body}</section>\n"));
}

fn list(lines: &[String]) -> String {
    let items: Vec<String> = lines.iter().map(|line| format!("<li>{line}</li>")).collect();
    format!("<ul>{}</ul>\n", items.join("\n"))
}

fn names(of: impl Iterator<Item = String>) -> String {
    let quoted: Vec<String> = of.map(|name| format!("<b>{}</b>", escape(&name))).collect();
    quoted.join(", ")
}

/// A share of a specification in percent, as it was given: 0.025 is 2.5, and 0.55 no 55.00000000000001.
pub(super) fn percent(share: f64) -> f64 {
    (share * 1e6).round() / 1e4
}

/// In three lines.
fn done(told: &Told<'_>) -> String {
    let spec = told.spec;
    let jobs: u64 = told.figures.iter().map(|figures| figures.jobs).sum();
    let attempts: u64 = told.figures.iter().map(|figures| figures.attempts).sum();
    let level = match spec.level {
        Level::Simulator => {
            "the orchestrator's own state machine in virtual time, with workers and authors that are simulated"
        }
        Level::Processes => "real processes in wall time, with authors that are simulated",
    };
    let tries: Vec<String> = spec.tries.iter().map(ToString::to_string).collect();
    let mut lines = vec![
        format!(
            "{} of {} scenarios, in batches of {}: {jobs} jobs and {attempts} attempts by {level}; seed {}.",
            plural(told.results.len(), "cell"),
            spec.scenarios,
            spec.batch.min(spec.scenarios),
            spec.seed
        ),
        format!(
            "Workloads {}; faults {}; policies {}; {} tries of each job.",
            names(spec.workload.iter().map(|workload| workload.name.clone())),
            names(spec.fault.iter().map(socrates_experiment::spec::Strike::shown)),
            names(spec.policies.iter().cloned()),
            tries.join(", ")
        ),
        "Whether a fault strikes is a hash of seed, kind, scenario, stage, revision and attempt: every policy meets the same faults, \
         so policies are compared scenario by scenario."
            .to_owned(),
    ];
    lines.extend(told.machine.iter().map(|line| format!("<code>{}</code>", escape(line))));
    list(&lines)
}

/// What was drawn for attempts, and what was seen of it.
fn struck(told: &Told<'_>) -> String {
    let mut sums: BTreeMap<Kind, Tally> = BTreeMap::new();
    for (kind, tally) in told.results.iter().flat_map(|one| &one.faults) {
        let sum = sums.entry(*kind).or_default();
        sum.scheduled += tally.scheduled;
        sum.struck += tally.struck;
    }
    if sums.is_empty() {
        return "<p>No faults were put in.</p>".to_owned();
    }
    let seen = match told.spec.level {
        Level::Simulator => "it happened",
        Level::Processes => {
            "the killed process was gone by that signal, the kernel said that the stopped one was stopped, the author's failure is in \
             the store"
        }
    };
    let row = |(kind, tally): (&Kind, &Tally)| {
        format!(
            "<tr><td class=\"name\"><code>{}</code></td><td>{}</td><td>{}</td></tr>",
            kind.word(),
            tally.scheduled,
            tally.struck
        )
    };
    format!(
        "<table><tr><th class=\"name\">fault</th><th>scheduled</th><th>struck</th></tr>{}</table><p class=\"quiet\">Scheduled: drawn for \
         an attempt that began. Struck: {seen}. The rest came too late: another fault had ended the attempt, or its lease, before.</p>",
        sums.iter().map(row).collect::<String>()
    )
}

/// What was measured beside what the simulator says of the same cells.
fn beside(told: &Told<'_>) -> String {
    let real = |value: f64| format!("{value:.2}");
    let times = |times: Option<[f64; 2]>| times.map_or_else(String::new, |[p50, p95]| format!("{p50:.1} / {p95:.1}"));
    let row = |(one, result): (&Beside, &CellResult)| {
        let (cell, share) = (&result.cell, one.success);
        format!(
            "<tr><td class=\"name\">{}</td><td class=\"name\">{}</td><td>{} %</td><td class=\"name\">{}</td><td>{} of {}</td>\
             <td>{:.1} ({:.1} to {:.1})</td><td>{:.1}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
            escape(&cell.workload.name),
            escape(&cell.strike.shown()),
            percent(cell.rate),
            escape(&cell.policy.name),
            one.same,
            one.of,
            100.0 * share.measured.estimate,
            100.0 * share.measured.low,
            100.0 * share.measured.high,
            100.0 * share.simulated.estimate,
            real(one.amplification.measured),
            real(one.amplification.simulated),
            one.struck.measured,
            one.struck.simulated,
            times(one.time_s.measured),
            times(one.time_s.simulated),
            times(one.recovery_s.measured),
            times(one.recovery_s.simulated),
        )
    };
    let rows: String = told.besides.iter().zip(told.results).map(row).collect();
    let pair = "<th>measured</th><th>simulated</th>";
    format!(
        "<p class=\"quiet\">The same cells with the same faults in the simulator. Ends: scenarios that ended the same way in both. Times \
         and recoveries: 50 / 95 %, s.</p><div class=\"wide\"><table><tr><th colspan=\"4\"></th><th></th><th colspan=\"2\">realised, %</th>\
         <th colspan=\"2\">attempts a job</th><th colspan=\"2\">faults struck</th><th colspan=\"2\">time, s</th><th colspan=\"2\">recovery, s</th></tr>\
         <tr><th class=\"name\">workload</th><th class=\"name\">fault</th><th>rate</th><th class=\"name\">policy</th><th>same end</th>{}</tr>{rows}</table></div>",
        pair.repeat(5)
    )
}

fn safety(told: &Told<'_>) -> String {
    let sum = |of: &dyn Fn(&CellResult) -> u64| told.results.iter().map(of).sum::<u64>();
    let (lost, doubled, complaints) =
        (sum(&|one| one.safety.lost), sum(&|one| one.safety.doubled), sum(&|one| one.safety.complaints));
    let scenarios = sum(&|one| one.scenarios.len() as u64);
    let recoveries = sum(&|one| one.recoveries.len() as u64);
    let class = if lost + doubled + complaints == 0 { "good" } else { "bad" };
    let bound = if lost == 0 && scenarios > 0 {
        format!(
            " None of {scenarios} scenarios lost means, at 95 %, fewer than {:.1} in a million.",
            3e6 / count(scenarios)
        )
    } else {
        String::new()
    };
    let bad: Vec<String> = told
        .results
        .iter()
        .filter(|one| !one.safety.is_clean())
        .map(|one| {
            format!(
                "cell {}: {} lost, {} doubled, {} complaints; {}",
                one.cell.number,
                one.safety.lost,
                one.safety.doubled,
                one.safety.complaints,
                escape(&one.safety.first)
            )
        })
        .collect();
    let bad = if bad.is_empty() { String::new() } else { list(&bad) };
    let meaning = match told.spec.level {
        Level::Simulator => {
            "Lost: a scenario that was taken and never ended, or a result that was acknowledged and is not in the store. Doubled: a result \
             or an end that was written or acknowledged twice. The checker looks at the state while a batch runs, and at what another \
             orchestrator would find in its store."
        }
        Level::Processes => {
            "Lost: a scenario that was taken and never ended. Doubled: one that was told to have ended in two ways. The checker asks the \
             rules of <code>socrates fsck</code> of the store that is left; a process that ended by itself is a complaint too."
        }
    };
    format!(
        "<p><span class=\"{class}\">{lost} lost, {doubled} doubled, {complaints} complaints of the checker</span> over {scenarios} \
         scenarios, with {recoveries} struck jobs that went on.{bound}</p>{bad}<p class=\"quiet\">{meaning}</p>"
    )
}

#[expect(clippy::cast_precision_loss, reason = "scenarios of an experiment are at most two million")]
const fn count(of: u64) -> f64 {
    of as f64
}

fn assumed(spec: &Spec) -> String {
    let (model, times) = (&spec.model, &spec.times_ms);
    let mut lines: Vec<String> = spec.workload.iter().map(workload).collect();
    lines.push(format!(
        "<b>Asked from the beginning</b>, two answers at the same stage of the same scenario are wrong with correlation {}: each takes \
         the draw that they have in common with probability √ρ, else one of its own. So a scenario can be hard, and tries fail together.",
        model.correlation
    ));
    lines.push(format!(
        "<b>Told what was wrong</b>, an author mends it with probability {} where the fault is named and {} where it is not; a mended \
         answer has another violation with probability {}. These are choices, measured on no model.",
        model.fix_if_named, model.fix_if_vague, model.collateral
    ));
    lines.push(format!(
        "<b>Checks</b> find a violation with probability {}. What they do not find is simulated and judged <code>contradicted</code>.",
        model.found
    ));
    let kinds: std::collections::BTreeSet<Kind> =
        spec.fault.iter().flat_map(|strike| strike.kinds.iter().copied()).collect();
    for kind in kinds {
        let time = match kind {
            Kind::WorkerKill => format!(
                " Its token is missed after {} ms, its successor comes after {} ms.",
                times.token, times.restart
            ),
            Kind::WorkerFreeze => format!(" It lasts {} ms.", times.cut),
            Kind::Partition => format!(" It lasts {} ms.", times.cut),
            Kind::LlmTimeout => format!(" It is waited for {} ms; what was asked is paid for.", times.timeout),
            Kind::Overload if times.retry_after > 0 => format!(" It asks for a wait of {} ms.", times.retry_after),
            Kind::OrchestratorKill => format!(" It is back after {} ms.", times.down),
            Kind::SlowStore => format!(" The commit takes {} ms.", times.slow),
            Kind::Overload | Kind::LlmError | Kind::Malformed | Kind::SemanticViolation => String::new(),
        };
        lines.push(format!("<code>{}</code>: {}{time}", kind.word(), escape(kind.about())));
    }
    for strike in spec.fault.iter().filter(|strike| strike.from_ms > 0 || strike.to_ms.is_some()) {
        let to = strike.to_ms.map_or_else(|| "the end".to_owned(), |to| format!("{} s", to / 1_000));
        lines.push(format!(
            "<b>{}</b> strikes from {} s to {to} of {} time.",
            escape(&strike.shown()),
            strike.from_ms / 1_000,
            spec.level.clock()
        ));
    }
    lines.push(match spec.level {
        Level::Simulator => {
            "Hints and answers arrive unless a fault keeps them from it; machines do not slow down under load, and no message is torn. \
             <code>spec.lock.toml</code> has every value."
                .to_owned()
        }
        Level::Processes => {
            "Answers of authors, how long work takes and when faults are due are as in the simulator. Messages, commits, polls, tokens and \
             restarts take the time that they take here; what is said of them above holds for the simulator's figures. A successor is \
             started at once. <code>spec.lock.toml</code> has every value."
                .to_owned()
        }
    });
    list(&lines)
}

fn workload(workload: &socrates_experiment::spec::Workload) -> String {
    let asked: Vec<String> = socrates_experiment::spec::AUTHORED
        .into_iter()
        .filter(|stage| workload.asks.of(*stage).is_some())
        .map(|stage| format!("{stage} {:.1} %", 100.0 * workload.violation(stage)))
        .collect();
    let about = if workload.about.is_empty() { String::new() } else { format!("{} ", escape_code(&workload.about)) };
    format!(
        "<b>{}</b>: {about}The first answers are all right in {} % of scenarios; a first answer breaks a rule in: {}.",
        escape(&workload.name),
        percent(workload.first_cut),
        asked.join(", ")
    )
}

fn policies(spec: &Spec) -> String {
    let row = |(name, tuned): (&String, &socrates_experiment::policies::Tuned)| {
        let about = tuned.about.clone().unwrap_or_default();
        format!(
            "<tr><td class=\"name\"><b>{}</b></td><td class=\"about\">{}</td></tr>",
            escape(name),
            escape_code(&about)
        )
    };
    let rows: Vec<String> = spec.policies.iter().filter_map(|name| spec.policy.get_key_value(name)).map(row).collect();
    let first = spec.policies.first().map_or("", String::as_str);
    format!(
        "<table>{}</table><p class=\"quiet\">The others are compared with <b>{}</b>.</p>",
        rows.concat(),
        escape(first)
    )
}

fn ends(heats: &[Heat]) -> String {
    format!(
        "<figure>{}<figcaption>Share of scenarios by how they ended, at the highest rate and with the most tries: realised, judged otherwise, or \
         by the class of the failure that ended the newest job which was given up. <code>scenarios.csv</code> has stage and class of \
         each.</figcaption></figure>\n",
        heat::svg(heats)
    )
}

fn plots(plots: &[Plot]) -> String {
    let figure = |plot: &Plot| {
        let more = match plot.left_out {
            0 => String::new(),
            more => format!(" {more} further panels are left out; <code>cells.csv</code> has their figures."),
        };
        format!(
            "<h3>{}</h3><figure>{}<figcaption>{}{more}</figcaption></figure>\n",
            escape(&plot.title),
            chart::svg(plot),
            escape_code(&plot.caption)
        )
    };
    plots.iter().map(figure).collect()
}

/// A table for each workload and fault.
fn tables(told: &Told<'_>) -> String {
    let same = |a: &Cell, b: &Cell| a.workload.name == b.workload.name && a.strike.shown() == b.strike.shown();
    let mut out = String::from(
        "<p class=\"quiet\">In brackets 95 % intervals: Wilson for shares, Bonett and Price for differences; p of McNemar's test. \
         Times are from the first attempt of a scenario to its end: the median is that of realised ones; the mean counts those that were not realised \
         with the longest time that any of the policies beside it took. Recovery is from a fault until its job went on.</p>",
    );
    let mut from = 0;
    while let Some(first) = told.results.get(from) {
        let until = told.results.iter().skip(from).take_while(|one| same(&one.cell, &first.cell)).count();
        let rows: String = (from..from + until).filter_map(|place| row(told, place)).collect();
        let strike = if first.cell.strike.kinds.is_empty() {
            String::new()
        } else {
            format!(" · {}", first.cell.strike.shown())
        };
        out.push_str(&format!(
            "<h3>{}{}</h3><div class=\"wide\"><table><tr><th>rate</th><th>tries</th><th class=\"name\">policy</th><th>realised, %</th>\
             <th>difference<br>to first, points</th><th>p</th><th>first<br>cut, %</th><th>questions<br>a scenario</th><th>attempts<br>a job</th>\
             <th>tokens a<br>realised one</th><th>tokens for<br>a further one</th><th>median<br>time, s</th><th>mean<br>time, s</th>\
             <th>recovery, s<br>50 / 95 / 99 %</th><th>lost,<br>doubled</th></tr>{rows}</table></div>\n",
            escape(&first.cell.workload.name),
            escape(&strike)
        ));
        from += until.max(1);
    }
    out
}

fn row(told: &Told<'_>, place: usize) -> Option<String> {
    let (result, figures) = (told.results.get(place)?, told.figures.get(place)?);
    let (cell, safety) = (&result.cell, &result.safety);
    let base = told.figures.get(cell.base)?;
    let tenths = |share: f64| format!("{:.1}", 100.0 * share);
    let pairing = told.pairings.get(place)?.as_ref().filter(|_| cell.base != cell.number);
    let difference = pairing.map_or_else(String::new, |pair| {
        let of = pair.difference;
        format!("{:+.1} ({:+.1} to {:+.1})", 100.0 * of.estimate, 100.0 * of.low, 100.0 * of.high)
    });
    let p = pairing.map_or_else(String::new, |pair| {
        if pair.p < 1e-4 { "&lt; 0.0001".to_owned() } else { format!("{:.4}", pair.p) }
    });
    let whole = |tokens: Option<f64>| tokens.map_or_else(String::new, |tokens| format!("{tokens:.0}"));
    let recovery =
        figures.recovery_s.map_or_else(String::new, |[p50, p95, p99]| format!("{p50:.1} / {p95:.1} / {p99:.1}"));
    let class = if safety.is_clean() { "" } else { " class=\"bad\"" };
    let first = if cell.base == cell.number { " class=\"first\"" } else { "" };
    let asks = count(figures.asks) / count(result.scenarios.len().max(1) as u64);
    Some(format!(
        "<tr{first}><td>{} %</td><td>{}</td><td class=\"name\">{}</td><td><b>{}</b> ({} to {})</td><td>{difference}</td><td>{p}</td>\
         <td>{}</td><td>{asks:.2}</td><td>{:.2}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.1}</td><td>{recovery}</td><td{class}>{}, {}</td></tr>",
        percent(cell.rate),
        cell.policy.tries(cell.tries),
        escape(&cell.policy.name),
        tenths(figures.success.estimate),
        tenths(figures.success.low),
        tenths(figures.success.high),
        tenths(figures.first_cut.estimate),
        figures.amplification(),
        whole(figures.tokens_per_success()),
        whole(pairing.and_then(|_| figures.tokens_per_saved(base))),
        figures.time_s.map_or_else(String::new, |(p50, _)| format!("{p50:.1}")),
        told.means.get(place)?.time_s,
        safety.lost,
        safety.doubled,
    ))
}

fn files(told: &Told<'_>) -> String {
    let left_out = match told.attempts_left_out {
        0 => String::new(),
        more => format!(" Left out, beyond <code>attempt_rows</code>: {more} attempts."),
    };
    let foretold = match told.spec.level {
        Level::Simulator => "",
        Level::Processes => " <code>predictions.csv</code>: each beside the simulator's.",
    };
    let how = match told.spec.level {
        Level::Simulator => "does it again, byte for byte",
        Level::Processes => "does it again with the same faults",
    };
    list(&[
        format!("<code>cells.csv</code>: a row a cell, with every figure of this page.{foretold}"),
        "<code>scenarios.csv</code>: a row a scenario of each cell.".to_owned(),
        format!("<code>attempts.csv</code>: a row an attempt, in the order of cells and batches.{left_out}"),
        "<code>plots/*.svg</code>: the plots by themselves.".to_owned(),
        format!("<code>spec.lock.toml</code>: everything that was assumed; <code>{}</code> {how}.", escape(told.again)),
    ])
}
