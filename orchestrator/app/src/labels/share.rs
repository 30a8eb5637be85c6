//! A count of runs or facts with the Wilson interval of its share, for programs and for people.

use serde_json::{Value, json};
use socrates_stats::{Count, Z_95, wilson};

/// The count, its share and the interval; nothing for the share of none.
pub(super) fn told(count: Count) -> Value {
    let share = wilson(count.hits, count.of, Z_95).ok();
    json!({ "count": count.hits, "of": count.of, "share": share.map(|share| share.estimate),
        "low": share.map(|share| share.low), "high": share.map(|share| share.high) })
}

/// `8 of 10, 80.0 % (49.0 to 94.3)`.
pub(super) fn words(count: Count) -> String {
    let share = wilson(count.hits, count.of, Z_95).map_or_else(
        |_none| "n/a".to_owned(),
        |share| format!("{:.1} % ({:.1} to {:.1})", share.estimate * 100.0, share.low * 100.0, share.high * 100.0),
    );
    format!("{} of {}, {share}", count.hits, count.of)
}
