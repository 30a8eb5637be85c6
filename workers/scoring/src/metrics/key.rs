//! The twelve key figures: what a table of runs shows where all metrics are too many.

use socrates_model::{MetricValue, Report};

/// Ids of the key figures, in the order of every table and list: success and time, way, people, comfort. They are what papers of the
/// field report most (Francis et al. 2023, table 1; SEAN 2.0; HuNavSim).
pub const KEY_FIGURES: [&str; 12] = [
    "success",
    "time_to_goal",
    "path_length",
    "path_efficiency",
    "robot_speed_mean",
    "stalled_time",
    "human_collisions",
    "wall_collisions",
    "human_distance_min",
    "ttc_min",
    "space_compliance",
    "jerk_mean",
];

/// The key figures of a report, in their order; a report of an older version may lack some.
pub fn key_figures(report: &Report) -> impl Iterator<Item = &MetricValue> {
    KEY_FIGURES.iter().filter_map(|id| report.metrics.iter().find(|metric| metric.id == *id))
}

/// A value as people read it: `yes`, `3`, `0.43 m`; `n/a` where there is none.
#[must_use]
pub fn in_words(metric: &MetricValue) -> String {
    let Some(value) = metric.value else { return "n/a".to_owned() };
    let size = value.abs();
    let unit = &metric.unit;
    if unit.is_yes_or_no() {
        return if size < 0.5 { "no" } else { "yes" }.to_owned();
    }
    if unit.is_count() {
        return value.to_string();
    }
    let number = if size >= 100.0 { format!("{value:.0}") } else { format!("{value:.2}") };
    if unit.is_share() { number } else { format!("{number} {unit}") }
}

#[cfg(test)]
mod tests {
    use socrates_model::Unit;

    use std::collections::BTreeSet;

    use super::*;
    use crate::evidence::Evidence;
    use crate::fixture::{Walk, recording};
    use crate::metrics::sheet;

    #[test]
    fn every_key_figure_is_a_metric_and_none_is_listed_twice() {
        for id in KEY_FIGURES {
            assert!(sheet(id).is_some(), "`{id}` is no metric");
        }
        assert_eq!(KEY_FIGURES.iter().collect::<BTreeSet<_>>().len(), KEY_FIGURES.len());
        let run = recording(&[Walk::robot(0., 0., 0.5, 0.), Walk::human(1, 6., 1., -1., 0.)], 10.0, 0.1);
        let report = crate::score(&Evidence::of(&run));
        let found: Vec<&str> = key_figures(&report).map(|metric| metric.id.as_str()).collect();
        assert_eq!(found, KEY_FIGURES);
    }

    #[test]
    fn values_are_told_with_their_unit() {
        let told = |unit: &str, value: Option<f64>| {
            in_words(&MetricValue {
                id: "any".into(),
                unit: Unit::new(unit),
                value,
                direction: 1,
                version: 1,
                missing: None,
                note: String::new(),
            })
        };
        assert_eq!((told("0/1", Some(1.0)), told("0/1", Some(0.0))), ("yes".to_owned(), "no".to_owned()));
        assert_eq!((told("count", Some(3.0)), told("share", Some(0.256))), ("3".to_owned(), "0.26".to_owned()));
        assert_eq!((told("m", Some(-0.014)), told("s", Some(123.4))), ("-0.01 m".to_owned(), "123 s".to_owned()));
        assert_eq!(told("m", None), "n/a");
    }
}
