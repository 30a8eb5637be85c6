//! A comparison as tables of other programs: every run as CSV, the differences as CSV, the figures as LaTeX.

use socrates_stream::csv::{joined, one_line};

use super::outcome::References;
use super::{Comparison, Entry, Resampled, Row};
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
    let unit = metric.unit_shown().map_or_else(String::new, |unit| format!(" [{}]", tex(unit)));
    let arrow = match metric.direction {
        Direction::Up => " $\\uparrow$",
        Direction::Down => " $\\downarrow$",
        Direction::Neutral => "",
    };
    format!("{}{unit}{arrow}", tex(&metric.id.replace('_', " ")))
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

    /// What the figures are of, in a sentence.
    #[must_use]
    pub fn basis(&self) -> String {
        let seeds = |n: usize| if n == 1 { "1 seed".to_owned() } else { format!("{n} seeds") };
        match self.resampled {
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
        }
    }

    /// The figures as a table of LaTeX (package `booktabs`): a row per metric, a column per planner, bold where a planner is best in
    /// at least 95 % of the resamples.
    #[must_use]
    pub fn latex(&self) -> String {
        let columns = "l".to_owned() + &"r".repeat(self.planners.len());
        let head: Vec<String> = self.planners.iter().map(|planner| tex(planner.as_str())).collect();
        let mut text = format!(
            "% Needs \\usepackage{{booktabs}}.\n\\begin{{table}}\n\\centering\n\\caption{{{}}}\n\\begin{{tabular}}{{{columns}}}\n\\toprule\nMetric & {} \\\\\n\\midrule\n",
            tex(&self.basis()),
            head.join(" & ")
        );
        let outcome = |name: &str, of: &dyn Fn(&super::Outcome) -> usize| {
            let cells: Vec<String> = self.outcomes.iter().map(|one| format!("{} of {}", of(one), one.runs)).collect();
            format!("{name} & {} \\\\\n", cells.join(" & "))
        };
        text.push_str(&outcome("runs realised $\\uparrow$", &super::Outcome::realised));
        text.push_str(&outcome("runs without a result $\\downarrow$", &|one| one.without_result));
        text.push_str("\\midrule\n");
        for row in &self.rows {
            text.push_str(&format!("{} & {} \\\\\n", heading(row.metric), self.cells(row).join(" & ")));
        }
        text.push_str("\\bottomrule\n\\end{tabular}\n\\end{table}\n");
        text
    }

    /// The cells of a metric, by planner.
    fn cells(&self, row: &Row) -> Vec<String> {
        let best = |place: usize| {
            row.order.as_ref().and_then(|order| order.best.get(place)).is_some_and(|share| *share >= 0.95)
        };
        let cell = |(place, mean): (usize, &super::Mean)| {
            let ends = mean.interval.map_or_else(String::new, |(low, high)| format!(" [{low:.2}, {high:.2}]"));
            let text = format!("{:.2}{ends}", mean.estimate);
            if best(place) { format!("\\textbf{{{text}}}") } else { text }
        };
        row.means.iter().enumerate().map(cell).collect()
    }
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
        let (near, wide) = line.split_once(" & ").unwrap().1.split_once(" & ").unwrap();
        assert!(wide.starts_with("\\textbf{") && !near.contains("textbf"), "{line}");
        assert!(line.contains("[m] $\\uparrow$"), "{line}");
        assert!(text.contains("resampling scenarios"), "{text}");
        assert_eq!(tex("a_b & 5 % \\x"), "a\\_b \\& 5 \\% \\textbackslash{}x");
        assert_eq!(text.matches("\\begin").count(), text.matches("\\end").count());
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
