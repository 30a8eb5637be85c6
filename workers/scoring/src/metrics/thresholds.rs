//! The signature of the thresholds: figures made with different ones are not mixed.

use socrates_model::hash::Digest;

use crate::metrics::CATALOG;

/// The profile of the thresholds as they are written in the families.
const PROFILE: &str = "standard";

/// Profile and signature of all thresholds, such as `standard-1f3a9c2e8b07`: it changes when the value or the name of one
/// does.
#[must_use]
pub fn signature() -> String {
    let named = |of: &str, (name, value): &(&str, f64)| format!("{of}.{name}={value}\n");
    let text: String = CATALOG
        .iter()
        .filter_map(|family| Some((family.sheets().first()?.id, family.thresholds)))
        .flat_map(|(of, thresholds)| thresholds.iter().map(move |threshold| named(of, threshold)))
        .collect();
    format!("{PROFILE}-{}", Digest::of(text.as_bytes()).short())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_threshold_has_a_name_of_its_own_in_its_family() {
        for family in CATALOG {
            let names: std::collections::BTreeSet<&str> = family.thresholds.iter().map(|(name, _)| *name).collect();
            assert_eq!(names.len(), family.thresholds.len(), "{}", family.sheets()[0].id);
            assert!(family.thresholds.iter().all(|(_, value)| value.is_finite()));
        }
        assert!(signature().starts_with("standard-") && signature() == signature());
    }

    #[test]
    fn the_signature_is_that_of_the_thresholds_in_use() {
        // A changed threshold changes this line, and with it what may be pooled.
        assert_eq!(signature(), "standard-d3e87984a4fe");
    }
}
