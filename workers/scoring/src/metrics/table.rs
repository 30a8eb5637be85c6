//! Metrics as a table for spreadsheets and scripts.

use socrates_model::{Missing, Report};
use socrates_stream::csv::joined;

use crate::metrics::peers;

/// One line per metric, and then per name of other tools' tables: `run,planner,seed,id,value,unit,direction,version,missing,note,thresholds`.
/// An absent value is an empty cell.
#[must_use]
pub fn csv(report: &Report) -> String {
    let mut text = String::from("run,planner,seed,id,value,unit,direction,version,missing,note,thresholds\n");
    let named = peers::named(&report.metrics);
    for metric in report.metrics.iter().chain(&named) {
        let value = metric.value.map_or_else(String::new, |value| value.to_string());
        let missing = match metric.missing {
            None => "",
            Some(Missing::Unavailable) => "unavailable",
            Some(Missing::NotApplicable) => "not_applicable",
        };
        let cells = [
            report.run.as_str(),
            report.planner.as_str(),
            &report.seed.to_string(),
            &metric.id,
            &value,
            metric.unit.as_str(),
            &metric.direction.to_string(),
            &metric.version.to_string(),
            missing,
            &metric.note,
            &report.thresholds,
        ];
        text.push_str(&joined(cells));
        text.push('\n');
    }
    text
}
