//! What became of a planner's runs, and by whose doing a scenario did not come about.

use std::collections::BTreeMap;

use socrates_model::{PlannerName, Report, Verdict};

use super::{Entry, Key};

/// People who are on average over time so much farther from where they are without a robot than they are with the reference robot, m,
/// were held up or moved by this one: as much as a person's width. With the reference robot too they wait and step aside.
const HELD_M: f64 = 0.5;

/// By whose doing a run was not realised.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cause {
    /// Realised with the reference robot and the same seed; people were held up or moved more than by that one.
    HeldPeople,
    /// Realised with the reference robot; people went as they go with that one, and this one was elsewhere or there at another time.
    Elsewhere,
    /// Realised with the reference robot; without figures against a run without a robot it is not known how.
    Robot,
    /// Not realised with the reference robot either, with the same seed: the scenario, not the planner.
    Scenario,
    /// There is no run of the reference robot with this seed.
    Unknown,
}

impl Cause {
    /// Every cause.
    pub const ALL: [Self; 5] = [Self::HeldPeople, Self::Elsewhere, Self::Robot, Self::Scenario, Self::Unknown];

    /// As tables have it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::HeldPeople => "robot_held_people",
            Self::Elsewhere => "robot_elsewhere",
            Self::Robot => "robot",
            Self::Scenario => "scenario",
            Self::Unknown => "unknown",
        }
    }

    /// What it means, in words.
    #[must_use]
    pub const fn told(self) -> &'static str {
        match self {
            Self::HeldPeople => {
                "realised with the reference robot and the same seed; this one held people up or moved them: on average 0.5 m or more farther from where they are without a robot than with the reference robot"
            }
            Self::Elsewhere => {
                "realised with the reference robot and the same seed; people went as they go with that one, and this one was elsewhere or there at another time"
            }
            Self::Robot => {
                "realised with the reference robot and the same seed; how it came is not known, for lack of figures against a run without a robot (the first run of a scenario has none)"
            }
            Self::Scenario => {
                "not realised with the reference robot and the same seed either: the scenario, not the planner"
            }
            Self::Unknown => "there is no run of the reference robot with this seed to compare with",
        }
    }
}

/// What became of a planner's runs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Outcome {
    /// The planner.
    pub planner: PlannerName,
    /// Runs that were wanted.
    pub runs: usize,
    /// Runs by verdict.
    pub verdicts: BTreeMap<Verdict, usize>,
    /// Runs without a result: the driver failed, or the simulation was refused.
    pub without_result: usize,
    /// Runs that were not realised, by cause.
    pub causes: BTreeMap<Cause, usize>,
    /// Runs in which the robot had success.
    pub success: usize,
    /// Runs in which the robot touched somebody.
    pub contact: usize,
}

impl Outcome {
    /// Runs that were realised, late ones included.
    #[must_use]
    pub fn realised(&self) -> usize {
        let of = |verdict: Verdict| self.verdicts.get(&verdict).copied().unwrap_or_default();
        of(Verdict::Realised) + of(Verdict::RealisedLate)
    }
}

/// Whether the scenario came about.
const fn came_about(verdict: Verdict) -> bool {
    match verdict {
        Verdict::Realised | Verdict::RealisedLate => true,
        Verdict::NotTriggered | Verdict::Contradicted | Verdict::Invalid | Verdict::RobotPrevented => false,
    }
}

/// The runs of the reference robot, by scenario and seed: what the others are held against.
pub(super) struct References<'a>(BTreeMap<Key<'a>, &'a Report>);

impl<'a> References<'a> {
    /// Those among these runs.
    pub(super) fn of(all: &[Entry<'a>]) -> Self {
        let reference = all.iter().filter(|entry| entry.planner.is_reference());
        Self(reference.filter_map(|entry| Some((entry.key(), entry.result.ok()?))).collect())
    }

    /// By whose doing a run was not realised; `None` for one that was, or that has no result.
    pub(super) fn cause(&self, entry: &Entry<'a>) -> Option<Cause> {
        let report = entry.result.ok().filter(|report| !came_about(report.verdict))?;
        Some(match self.0.get(&entry.key()) {
            Some(reference) if came_about(reference.verdict) => by_robot(report, reference),
            Some(_) => Cause::Scenario,
            None => Cause::Unknown,
        })
    }
}

fn by_robot(report: &Report, reference: &Report) -> Cause {
    let apart = |report: &Report| report.metric("people_deviation").and_then(|metric| metric.value);
    match apart(report).zip(apart(reference)) {
        Some((with_this, with_that)) if with_this - with_that >= HELD_M => Cause::HeldPeople,
        Some(_) => Cause::Elsewhere,
        None => Cause::Robot,
    }
}

/// What became of a planner's runs among all.
pub(super) fn of<'a>(planner: &PlannerName, all: &[Entry<'a>], references: &References<'a>) -> Outcome {
    let own = || all.iter().filter(|entry| entry.planner == planner);
    let reports = || own().filter_map(|entry| entry.result.ok());
    let above = |id: &str| {
        let value = |report: &&Report| report.metric(id).and_then(|metric| metric.value);
        reports().filter(|report| value(report).is_some_and(|value| value > 0.5)).count()
    };
    let (mut verdicts, mut causes) = (BTreeMap::new(), BTreeMap::new());
    reports().for_each(|report| *verdicts.entry(report.verdict).or_default() += 1);
    own().filter_map(|entry| references.cause(entry)).for_each(|cause| *causes.entry(cause).or_default() += 1);
    Outcome {
        planner: planner.clone(),
        runs: own().count(),
        verdicts,
        without_result: own().filter(|entry| entry.result.is_err()).count(),
        causes,
        success: above("success"),
        contact: above("human_collisions"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixture::{entries, made};
    use super::*;

    #[test]
    fn a_run_that_was_lost_is_told_by_the_reference_and_by_the_run_without_a_robot() {
        let with = |planner: &str, verdict: Verdict, moved_m: Option<f64>| {
            let mut one = made("a", planner, 1, Some(1.0));
            let report = one.report.as_mut().unwrap();
            report.verdict = verdict;
            report.metrics.iter_mut().filter(|it| it.id == "people_deviation").for_each(|it| it.value = moved_m);
            one
        };
        let caused = |reference: Option<(Verdict, Option<f64>)>, moved_m: Option<f64>| {
            let mut all = vec![with("orca", Verdict::NotTriggered, moved_m)];
            all.extend(reference.map(|(verdict, moved_m)| with("reference", verdict, moved_m)));
            let entries = entries(&all);
            References::of(&entries).cause(&entries[0])
        };
        let realised = Some((Verdict::RealisedLate, Some(1.0)));
        assert_eq!(caused(realised, Some(1.8)), Some(Cause::HeldPeople));
        assert_eq!(caused(realised, Some(1.1)), Some(Cause::Elsewhere));
        assert_eq!(caused(realised, None), Some(Cause::Robot));
        assert_eq!(
            caused(Some((Verdict::Realised, None)), Some(1.8)),
            Some(Cause::Robot),
            "nothing to hold it against"
        );
        assert_eq!(caused(Some((Verdict::Contradicted, Some(1.0))), Some(1.8)), Some(Cause::Scenario));
        assert_eq!(caused(None, Some(1.8)), Some(Cause::Unknown));
        let all = [with("orca", Verdict::Realised, None)];
        let entries = entries(&all);
        assert_eq!(References::of(&entries).cause(&entries[0]), None);
    }

    #[test]
    fn every_run_is_counted_once() {
        let mut all =
            vec![made("a", "orca", 1, Some(1.0)), made("a", "orca", 2, None), made("a", "orca", 3, Some(0.1))];
        all[0].report.as_mut().unwrap().verdict = Verdict::Realised;
        let entries = entries(&all);
        let found = of(entries[0].planner, &entries, &References::of(&entries));
        assert_eq!((found.runs, found.without_result, found.realised(), found.contact), (3, 1, 1, 1));
        assert_eq!(found.verdicts.values().sum::<usize>() + found.without_result, found.runs);
        assert_eq!(found.causes.get(&Cause::Unknown), Some(&1));
    }
}
