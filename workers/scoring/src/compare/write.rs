//! A comparison as tables of other programs: every run as CSV, the differences as CSV, the figures as LaTeX.

use socrates_stream::csv::{joined, one_line};

use super::outcome::References;
use super::{Comparison, Entry, LEAST_ARRIVALS, MARKED, OF_ARRIVALS, Resampled, Row};
use crate::metrics::{Direction, Sheet, sheets};

/// First columns of the table of runs; a column per metric follows.
const COLUMNS: [&str; 8] = ["scenario", "request", "location", "planner", "seed", "verdict", "cause", "reason"];

/// One row per run: scenario, request, location, planner, seed, verdict (`failed` without a result), by whose doing it was not
/// realised ([`super::Cause::name`]), the reason, and every metric in report order. What has no value is an empty cell.
#[must_use]
pub fn runs_csv(entries: &[Entry<'_>]) -> String {
    let metrics: Vec<&Sheet> = sheets().collect();
    let mut text = joined(COLUMNS.into_iter().chain(metrics.iter().map(|metric| metric.id))) + "\n";
    let references = References::of(entries);
    for entry in entries {
        let (verdict, reason) = match entry.result {
            Ok(report) => (report.verdict.name(), report.verdict_text.as_str()),
            Err(why) => (socrates_model::ScenarioEnd::Failed.name(), why),
        };
        let caused = references.cause(entry).map_or("", super::Cause::name);
        let head = [entry.scenario, entry.request, entry.location, entry.planner.as_str()].map(str::to_owned);
        let middle = [entry.seed.to_string(), verdict.to_owned(), caused.to_owned(), one_line(reason)];
        let values = metrics.iter().map(|metric| {
            let value = entry.result.ok().and_then(|report| report.metric(metric.id)?.value);
            value.map_or_else(String::new, |value| value.to_string())
        });
        text.push_str(&joined(head.into_iter().chain(middle).chain(values)));
        text.push('\n');
    }
    text
}

/// A metric as LaTeX has it, with its unit and an arrow to what is better.
fn heading(metric: &Sheet) -> String {
    // Powers and products of units as mathematics has them: `m/s^3`, `m*s`.
    let unit =
        metric.unit_shown().map_or_else(String::new, |unit| format!(" [{}]", powers(unit).replace('*', "$\\cdot$")));
    let arrow = match metric.direction {
        Direction::Up => " $\\uparrow$",
        Direction::Down => " $\\downarrow$",
        Direction::Neutral => "",
    };
    format!("{}{unit}{arrow}", tex(&spaced(metric.id)))
}

/// A unit whose powers are set as such.
fn powers(unit: &str) -> String {
    let mut parts = unit.split('^');
    let mut out = tex(parts.next().unwrap_or_default());
    for part in parts {
        let digits = part.find(|c: char| !c.is_ascii_digit()).unwrap_or(part.len());
        let (power, rest) = part.split_at(digits);
        out.push_str(&format!("$^{{{power}}}${}", tex(rest)));
    }
    out
}

/// Text in which nothing is a command of LaTeX.
fn tex(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => {
                out.push('\\');
                out.push(c);
            }
            '~' => out.push_str("\\textasciitilde{}"),
            '^' => out.push_str("\\textasciicircum{}"),
            '\\' => out.push_str("\\textbackslash{}"),
            '²' => out.push_str("$^2$"),
            '³' => out.push_str("$^3$"),
            c => out.push(c),
        }
    }
    out
}

impl Comparison {
    /// The differences to the first planner, one row per metric and planner.
    #[must_use]
    pub fn differences_csv(&self) -> String {
        let mut text = joined([
            "metric",
            "unit",
            "direction",
            "planner",
            "against",
            "runs",
            "of",
            "mean",
            "mean_against",
            "difference",
            "low",
            "high",
            "larger",
            "smaller",
        ]) + "\n";
        let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
        for row in &self.rows {
            let Some((first, against)) = row.means.first().zip(self.planners.first()) else { continue };
            let others = self.planners.iter().zip(&row.means).skip(1).zip(&row.differences);
            for ((planner, mean), difference) in others {
                text.push_str(&joined([
                    row.metric.id.to_owned(),
                    row.metric.unit.to_owned(),
                    row.metric.direction.sign().to_string(),
                    planner.to_string(),
                    against.to_string(),
                    row.runs.to_string(),
                    self.common.to_string(),
                    mean.estimate.to_string(),
                    first.estimate.to_string(),
                    difference.estimate.to_string(),
                    number(difference.interval.map(|(low, _)| low)),
                    number(difference.interval.map(|(_, high)| high)),
                    difference.larger.to_string(),
                    difference.smaller.to_string(),
                ]));
                text.push('\n');
            }
        }
        text
    }

    /// Runs behind the figures, in sentences.
    #[must_use]
    pub fn basis(&self) -> String {
        let seeds = |n: usize| if n == 1 { "1 seed".to_owned() } else { format!("{n} seeds") };
        let mut text = match self.resampled {
            Resampled::Scenarios(n) => format!(
                "Paired over {} runs of {n} scenarios that all {} planners had; scenarios weigh the same; intervals of 95 % by resampling scenarios.",
                self.common,
                self.planners.len()
            ),
            Resampled::Seeds(n) => format!(
                "Paired over {} of one scenario that all {} planners had; intervals of 95 % by resampling seeds: what is found holds for this scenario.",
                seeds(n),
                self.planners.len()
            ),
        };
        let has_goal = self.has_row("success");
        let of_arrivals: Vec<String> =
            OF_ARRIVALS.iter().filter(|id| has_goal && self.has_row(id)).map(|id| spaced(id)).collect();
        if !of_arrivals.is_empty() {
            text.push_str(&format!(" Of arrivals only: {}.", of_arrivals.join(", ")));
        }
        if !self.unpaired.is_empty() {
            let names: Vec<String> = self.unpaired.iter().map(|metric| spaced(metric.id)).collect();
            text.push_str(&format!(
                " Not compared, because no run has a value of every planner: {}.",
                names.join(", ")
            ));
        }
        let seldom: Vec<&str> = self
            .planners
            .iter()
            .zip(&self.seldom)
            .filter(|(_, seldom)| **seldom)
            .map(|(name, _)| name.as_str())
            .collect();
        if !seldom.is_empty() {
            text.push_str(&format!(
                " Never best except in success, because of fewer arrivals than {:.0} % of those of the planner with the most: {}.",
                LEAST_ARRIVALS * 100.0,
                seldom.join(", ")
            ));
        }
        text
    }

    fn has_row(&self, id: &str) -> bool {
        self.rows.iter().any(|row| row.metric.id == id)
    }

    /// Caption of the table of LaTeX: true of every row.
    fn caption(&self) -> String {
        let column = match self.resampled {
            Resampled::Scenarios(_) => {
                "Column n: runs of a row, those in which every planner has a value, with the number of their scenarios in brackets."
            }
            Resampled::Seeds(_) => "Column n: runs of a row, those in which every planner has a value.",
        };
        format!(
            "{} {column} Runs realised and runs without a result are of all runs of a planner, paired or not. Bold: best in at least {:.0} % of the resamples.",
            self.basis(),
            MARKED * 100.0
        )
    }

    /// The figures as a table of LaTeX (package `booktabs`): a row per metric with the runs that it is of, a column per planner, bold for
    /// [`Row::best`].
    #[must_use]
    pub fn latex(&self) -> String {
        let columns = "lr".to_owned() + &"r".repeat(self.planners.len());
        let dagger = |seldom: bool| if seldom { "$^\\dagger$" } else { "" };
        let names = self.planners.iter().zip(&self.seldom);
        let head: Vec<String> = names.map(|(name, seldom)| tex(name.as_str()) + dagger(*seldom)).collect();
        let note = if self.seldom.contains(&true) {
            format!(" {}: too few arrivals to be marked.", dagger(true))
        } else {
            String::new()
        };
        let mut text = format!(
            "% Needs \\usepackage{{booktabs}}.\n\\begin{{table}}\n\\centering\n\\caption{{{}}}\n\\begin{{tabular}}{{{columns}}}\n\\toprule\nMetric & n & {} \\\\\n\\midrule\n",
            tex(&self.caption()) + &note,
            head.join(" & ")
        );
        let outcome = |name: &str, of: &dyn Fn(&super::Outcome) -> usize| {
            let cells: Vec<String> = self.outcomes.iter().map(|one| format!("{} of {}", of(one), one.runs)).collect();
            format!("{name} & & {} \\\\\n", cells.join(" & "))
        };
        text.push_str(&outcome("runs realised $\\uparrow$", &super::Outcome::realised));
        text.push_str(&outcome("runs without a result $\\downarrow$", &|one| one.without_result));
        text.push_str("\\midrule\n");
        for row in &self.rows {
            let cells = cells(row).join(" & ");
            text.push_str(&format!("{} & {} & {cells} \\\\\n", heading(row.metric), self.runs_of(row)));
        }
        text.push_str("\\bottomrule\n\\end{tabular}\n\\end{table}\n");
        text
    }

    /// The runs of a row, with the number of their scenarios where those are resampled.
    fn runs_of(&self, row: &Row) -> String {
        let scenarios = row.means.first().map_or(0, |mean| mean.parts.len());
        match self.resampled {
            Resampled::Scenarios(_) => format!("{} ({scenarios})", row.runs),
            Resampled::Seeds(_) => row.runs.to_string(),
        }
    }
}

/// The cells of a metric, by planner.
fn cells(row: &Row) -> Vec<String> {
    let (best, decimals) = (row.best(), row.decimals());
    let cell = |(place, mean): (usize, &super::Mean)| {
        let ends =
            mean.interval.map_or_else(String::new, |(low, high)| format!(" [{low:.decimals$}, {high:.decimals$}]"));
        let text = format!("{:.decimals$}{ends}", mean.estimate);
        if best == Some(place) { format!("\\textbf{{{text}}}") } else { text }
    };
    row.means.iter().enumerate().map(cell).collect()
}

/// Name of a metric in words.
fn spaced(id: &str) -> String {
    id.replace('_', " ")
}

#[cfg(test)]
mod tests {
    use super::super::compare;
    use super::super::fixture::{batch, entries, made, names};
    use super::*;

    #[test]
    fn every_run_has_a_row_with_as_many_cells_as_the_head() {
        let mut all = batch();
        all.push(made("d", "near", 1, None));
        let text = runs_csv(&entries(&all));
        let table = socrates_stream::csv::Table::read(&text).unwrap();
        assert_eq!(table.rows.len(), 19, "{text}");
        assert!(table.rows.iter().all(|row| row.cells.len() == table.head.cells.len()));
        let last = table.rows.last().unwrap();
        assert_eq!(last.cells[..8], ["d", "d", "hall", "near", "1", "failed", "", "J-DRIVER: it is gone"]);
        assert!(last.cells[8..].iter().all(String::is_empty));
    }

    #[test]
    fn latex_marks_the_best_and_has_no_command_of_a_name() {
        let all = batch();
        let found = compare(&entries(&all), &names(&["near", "wide"])).unwrap();
        let text = found.latex();
        let line = text.lines().find(|line| line.starts_with("human distance min")).unwrap();
        let cells: Vec<&str> = line.split(" & ").collect();
        let [_, _, near, wide] = cells[..] else { panic!("{line}") };
        assert!(wide.starts_with("\\textbf{") && !near.contains("textbf"), "{line}");
        assert!(line.contains("[m] $\\uparrow$"), "{line}");
        assert!(text.contains("resampling scenarios"), "{text}");
        assert_eq!(tex("a_b & 5 % \\x"), "a\\_b \\& 5 \\% \\textbackslash{}x");
        assert_eq!(text.matches("\\begin").count(), text.matches("\\end").count());
    }

    #[test]
    fn every_row_of_latex_says_of_how_many_runs_it_is() {
        let mut all = batch();
        for one in &mut all {
            let unseen = one.scenario == "b" && one.planner.as_str() == "wide";
            for metric in &mut one.report.as_mut().unwrap().metrics {
                let is_unseen = unseen && metric.id == "ttc_min";
                metric.value = if is_unseen { None } else { metric.value.or(Some(1.0)) };
            }
        }
        let found = compare(&entries(&all), &names(&["near", "wide"])).unwrap();
        let text = found.latex();
        let n = |name: &str| {
            let line = text.lines().find(|line| line.starts_with(name)).unwrap();
            line.split(" & ").nth(1).unwrap().to_owned()
        };
        for row in &found.rows {
            let scenarios = row.means[0].parts.len();
            assert_eq!(n(&spaced(row.metric.id)), format!("{} ({scenarios})", row.runs), "{text}");
        }
        assert_eq!((n("human distance min").as_str(), n("ttc min").as_str()), ("9 (3)", "6 (2)"));
        let cells = |line: &str| line.matches('&').count();
        let mut figures = text.lines().filter(|line| line.ends_with("\\\\"));
        assert!(figures.all(|line| cells(line) == 3), "{text}");
        assert!(
            text.contains("Column n: runs of a row") && text.contains("all runs of a planner, paired or not"),
            "{text}"
        );
        assert!(text.contains("Of arrivals only: time to goal, path length"), "{text}");
    }

    #[test]
    fn latex_names_the_planner_that_is_not_marked_for_lack_of_arrivals() {
        let mut all = batch();
        for one in &mut all {
            let arrived = if one.planner.as_str() == "near" { 0.0 } else { 1.0 };
            let metrics = &mut one.report.as_mut().unwrap().metrics;
            metrics
                .iter_mut()
                .filter(|it| it.id == "arrived" || it.id == "success")
                .for_each(|it| it.value = Some(arrived));
        }
        let text = compare(&entries(&all), &names(&["near", "wide"])).unwrap().latex();
        assert!(text.contains("Metric & n & near$^\\dagger$ & wide \\\\"), "{text}");
        assert!(text.contains("of the planner with the most: near.") && text.contains("too few arrivals"), "{text}");
        let marked: Vec<&str> = text.lines().filter(|line| line.contains("\\textbf")).collect();
        assert!(marked.iter().all(|line| line.starts_with("success")), "{marked:?}");
    }

    #[test]
    fn units_with_powers_are_set_as_mathematics() {
        assert_eq!(heading(crate::metrics::sheet("jerk_mean").unwrap()), "jerk mean [m/s$^{3}$] $\\downarrow$");
        assert_eq!(powers("1/m^2"), "1/m$^{2}$");
        assert_eq!(powers("m^2/s"), "m$^{2}$/s");
        assert_eq!(powers("%"), "\\%");
        assert!(crate::metrics::sheets().all(|sheet| !heading(sheet).contains("textasciicircum")));
    }

    #[test]
    fn differences_have_a_row_per_metric_and_planner() {
        let all = batch();
        let found = compare(&entries(&all), &names(&["near", "wide"])).unwrap();
        let table = found.differences_csv();
        let line = table.lines().find(|line| line.starts_with("human_distance_min,m,1,wide,near,9,9,")).unwrap();
        assert!(line.ends_with(",9,0"), "{line}");
        assert_eq!(table.lines().count(), found.rows.len() + 1);
    }
}
