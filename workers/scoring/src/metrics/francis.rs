//! The names of Francis et al. 2023, table 1, for the metrics of ours that they are.

use socrates_model::MetricValue;

/// Name in the table, and our id.
pub const NAMES: &[(&str, &str)] = &[
    ("francis.S", "success"),
    ("francis.C", "collisions"),
    ("francis.WC", "wall_collisions"),
    ("francis.AC", "agent_collisions"),
    ("francis.HC", "human_collisions"),
    ("francis.TO", "timeout"),
    ("francis.FP", "failure_to_progress"),
    ("francis.ST", "stalled_time"),
    ("francis.T", "time_to_goal"),
    ("francis.PL", "path_length"),
    ("francis.SPL", "spl"),
    ("francis.V_min", "robot_speed_min"),
    ("francis.V_avg", "robot_speed_mean"),
    ("francis.V_max", "robot_speed_max"),
    ("francis.A_min", "acceleration_min"),
    ("francis.A_avg", "acceleration_mean"),
    ("francis.A_max", "acceleration_max"),
    ("francis.J_min", "jerk_min"),
    ("francis.J_avg", "jerk_mean"),
    ("francis.J_max", "jerk_max"),
    ("francis.CD_min", "clearing_distance_min"),
    ("francis.CD_avg", "clearing_distance_mean"),
    ("francis.SC", "space_compliance"),
    ("francis.DH_min", "human_distance_min"),
    ("francis.TTC", "ttc_min"),
    ("francis.AT", "aggregated_time"),
];

/// The values under the names of the table, for those that have been computed.
#[must_use]
pub(super) fn named(values: &[MetricValue]) -> Vec<MetricValue> {
    NAMES
        .iter()
        .filter_map(|(name, ours)| {
            let value = values.iter().find(|value| value.id == *ours)?;
            Some(MetricValue { id: (*name).to_owned(), ..value.clone() })
        })
        .collect()
}
