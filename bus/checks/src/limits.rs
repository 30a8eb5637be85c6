//! P-VERIFY: limits of a clause that are so loose, or so tight, that it tells nothing.
//!
//! Each number of each predicate has a range. Its ends lie well outside what the catalog and people ask for, and inside what
//! still says something: whoever is `within 1000 m` of the robot has not met it.

use std::f64::consts::PI;

use socrates_model::{HumanId, Predicate, Proposal, Trigger};

use crate::people::DISTANCE_M;

/// Two who have met were no farther apart than this, m: both are within 3 m of their encounter node then.
const MEET_M: f64 = 6.0;
/// Who reacts at a distance need not come nearer than that and a little, m.
const BEYOND_M: f64 = 0.5;
/// The shortest of what is seen to last, s, and the longest that a run has room for, s.
const LASTS_S: (f64, f64) = (0.2, 600.0);
/// Who reacts does so at most so long after it could, s; what it does before that comes on top.
const REACTS_S: f64 = 15.0;
/// The loosest group, m from its center.
const SPREAD_M: f64 = 4.0;
/// More people than fit on a square meter.
const CROWD_PER_M2: f64 = 8.0;
/// A band of courses wider than this leaves hardly one out, degrees.
const BAND_DEG: f64 = 120.0;

/// One number of a clause, with the range in which it says something.
struct Limit {
    /// Its key, with what is made of it where two keys make one number.
    name: &'static str,
    /// What it is.
    value: f64,
    /// Smallest and largest that is taken.
    range: (f64, f64),
    /// With its blank: ` m`, ` s`, or nothing.
    unit: &'static str,
}

const fn meters(name: &'static str, value: f64, range: (f64, f64)) -> Limit {
    Limit { name, value, range, unit: " m" }
}

const fn secs(name: &'static str, value: f64, range: (f64, f64)) -> Limit {
    Limit { name, value, range, unit: " s" }
}

const fn plain(name: &'static str, value: f64, range: (f64, f64)) -> Limit {
    Limit { name, value, range, unit: "" }
}

/// A sentence per number out of its range: which, its value, what is taken, and why.
pub(crate) fn faults(predicate: &Predicate, proposal: &Proposal) -> Vec<String> {
    limits(predicate, proposal)
        .into_iter()
        .filter(|limit| !(limit.range.0..=limit.range.1).contains(&limit.value))
        .map(|limit| {
            let Limit { name, value, range: (least, most), unit } = limit;
            let why =
                if value > most { "a looser limit promises nothing" } else { "less cannot be seen or does not happen" };
            let what = match name.split_once(", ") {
                Some((key, rest)) => format!("`{key}`, {rest} is"),
                None => format!("`{name}` is"),
            };
            format!("{what} {value}{unit}; allowed: {} to {}{unit}; {why}", round(least), round(most))
        })
        .collect()
}

/// Without the digits that only arithmetic makes.
fn round(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

/// Largest distance of any trigger of a human, m.
fn reach_m(human: HumanId, proposal: &Proposal) -> f64 {
    let rules = proposal.human(human).into_iter().flat_map(|human| &human.rules);
    rules.flat_map(|rule| &rule.when).filter_map(Trigger::distance_m).fold(0.0, f64::max).min(DISTANCE_M.1)
}

/// What a human does by its rules altogether, s.
fn busy_s(human: HumanId, proposal: &Proposal) -> f64 {
    let rules = proposal.human(human).into_iter().flat_map(|human| &human.rules);
    rules.filter_map(|rule| rule.for_s).filter(|secs| secs.is_finite()).sum::<f64>().clamp(0.0, LASTS_S.1)
}

/// How many people walk by, how near, and in which band of angles.
fn flow(count: u32, within_m: f64, [least, most]: [f64; 2]) -> [Limit; 5] {
    [
        plain("count", f64::from(count), (1.0, f64::INFINITY)),
        meters("within_m", within_m, (0.5, 12.0)),
        plain("angle_deg, smallest,", least, (0.0, 180.0)),
        plain("angle_deg, largest,", most, (0.0, 180.0)),
        plain("angle_deg, largest less smallest,", most - least, (0.0, BAND_DEG)),
    ]
}

/// How many people per square meter are in a disc.
fn density([least, most]: [f64; 2], radius_m: f64) -> [Limit; 3] {
    [
        // At least somebody is in the disc.
        plain("per_m2, smallest,", least, (0.5 / (PI * radius_m * radius_m).max(0.1), CROWD_PER_M2)),
        plain("per_m2, largest less smallest,", most - least, (0.0, CROWD_PER_M2)),
        meters("radius_m", radius_m, (0.5, 8.0)),
    ]
}

/// The numbers of a predicate.
fn limits(predicate: &Predicate, proposal: &Proposal) -> Vec<Limit> {
    let for_s = |value: f64| secs("for_s", value, LASTS_S);
    match predicate {
        Predicate::Meets { human, within_m } => {
            let most = MEET_M.max(reach_m(*human, proposal) + BEYOND_M);
            vec![meters("within_m", *within_m, (0.5, most))]
        }
        Predicate::MeetsAgain { nth, within_m, .. } => {
            vec![plain("nth", f64::from(*nth), (2.0, 20.0)), meters("within_m", *within_m, (0.5, MEET_M))]
        }
        Predicate::HiddenUntil { within_m, .. } => vec![meters("within_m", *within_m, (0.5, DISTANCE_M.1))],
        Predicate::StartsAt { within_m, .. } | Predicate::Reaches { within_m, .. } => {
            vec![meters("within_m", *within_m, (0.1, 4.0))]
        }
        // Whoever stops on the way leaves a long gap.
        // Somebody who is let through is there long before a robot that waits for them.
        Predicate::Crosses { human, gap_s } => {
            let most = if proposal.is_let_through(*human) { 40.0 } else { 12.0 };
            vec![secs("gap_s", *gap_s, (0.2, most))]
        }
        Predicate::OnTime { gap_s, .. } => vec![secs("gap_s", *gap_s, (0.2, 10.0))],
        Predicate::Ahead { within_m, for_s: time, .. } => {
            vec![meters("within_m", *within_m, (0.5, 12.0)), for_s(*time)]
        }
        Predicate::Follows { gap_m: [least, most], for_s: time, .. } => vec![
            meters("gap_m, smallest,", *least, (0.0, 6.0)),
            meters("gap_m, largest,", *most, (0.5, 8.0)),
            meters("gap_m, largest less smallest,", most - least, (0.0, 8.0)),
            for_s(*time),
        ],
        Predicate::Abreast { for_s: time, .. }
        | Predicate::Parallel { for_s: time, .. }
        | Predicate::Blocks { for_s: time, .. }
        | Predicate::Looks { for_s: time, .. }
        | Predicate::StandsStill { for_s: time, .. } => vec![for_s(*time)],
        Predicate::Flow { count, within_m, angle_deg } => Vec::from(flow(*count, *within_m, *angle_deg)),
        Predicate::Density { per_m2, radius_m, for_s: time } => {
            density(*per_m2, *radius_m).into_iter().chain([for_s(*time)]).collect()
        }
        Predicate::Surrounds { count, within_m, for_s: time } => vec![
            plain("count", f64::from(*count), (1.0, f64::INFINITY)),
            meters("within_m", *within_m, (0.5, 8.0)),
            for_s(*time),
        ],
        Predicate::Converges { within_m, within_s } => {
            vec![meters("within_m", *within_m, (0.5, MEET_M)), secs("within_s", *within_s, (0.2, 15.0))]
        }
        Predicate::Queues { gap_m: [least, most], .. } => vec![
            meters("gap_m, smallest,", *least, (0.0, 3.0)),
            meters("gap_m, largest less smallest,", most - least, (0.0, 3.0)),
        ],
        Predicate::RunsAway { by_m, .. } => vec![meters("by_m", *by_m, (0.3, 10.0))],
        Predicate::Step { within_s, .. } | Predicate::RobotStep { within_s, .. } => {
            vec![secs("within_s", *within_s, (0.1, REACTS_S))]
        }
        Predicate::Reacts { human, when, within_s, .. } => {
            let mut found = vec![secs("within_s", *within_s, (0.1, REACTS_S + busy_s(*human, proposal)))];
            found.extend(when.iter().filter_map(Trigger::distance_m).map(|m| meters("when, distance,", m, DISTANCE_M)));
            found
        }
        Predicate::RobotObeys { within_s, .. } => vec![secs("within_s", *within_s, (0.1, REACTS_S))],
        Predicate::DoorOpens { robot_m: [least, most], .. } => vec![
            meters("robot_m, smallest,", *least, (0.0, DISTANCE_M.1)),
            meters("robot_m, largest,", *most, (0.0, DISTANCE_M.1)),
            meters("robot_m, largest less smallest,", most - least, (0.0, DISTANCE_M.1)),
        ],
        Predicate::Formation { spread_m, .. } | Predicate::WalksTogether { spread_m, .. } => {
            vec![meters("spread_m", *spread_m, (0.2, SPREAD_M))]
        }
        Predicate::RobotKeeps { min_m } => vec![meters("min_m", *min_m, (0.01, 5.0))],
        Predicate::Humans { .. }
        | Predicate::HeadOn { .. }
        | Predicate::OnSide { .. }
        | Predicate::Faces { .. }
        | Predicate::RobotWay { .. }
        | Predicate::Overtakes { .. }
        | Predicate::RobotPasses { .. }
        | Predicate::GivesWay { .. }
        | Predicate::Gestures { .. }
        | Predicate::Leaves { .. }
        | Predicate::StaysInside { .. }
        | Predicate::Enters { .. }
        | Predicate::Order { .. }
        | Predicate::Before { .. }
        | Predicate::EncounterAt { .. }
        | Predicate::Plausible
        | Predicate::RobotArrives
        | Predicate::RobotEntersLast
        | Predicate::RobotLeavesFirst
        | Predicate::RobotJoins { .. }
        | Predicate::GesturesTo { .. }
        | Predicate::TurnsBack { .. }
        | Predicate::ComesBack { .. }
        | Predicate::GoesTo { .. }
        | Predicate::StaysAside { .. }
        | Predicate::MakesRoom { .. }
        | Predicate::GetsTo { .. }
        | Predicate::RobotLeavesGroup { .. } => Vec::new(),
        Predicate::ChangesPace { mps, .. } | Predicate::Walks { mps, .. } => vec![plain("mps", *mps, (0.2, 1.8))],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::crossing_proposal;
    use socrates_model::{Action, GroupId};

    #[test]
    fn a_limit_that_promises_nothing_is_refused_for_every_predicate_that_has_one() {
        let proposal = crossing_proposal();
        let (human, group) = (HumanId::new(1), GroupId(1));
        for far in [1e6, f64::NAN, f64::INFINITY, -1.0, 0.0] {
            let all = [
                Predicate::Meets { human, within_m: far },
                Predicate::MeetsAgain { human, nth: 2, within_m: far },
                Predicate::HiddenUntil { human, within_m: far },
                Predicate::StartsAt { agent: human.into(), node: "a".parse().unwrap(), within_m: far },
                Predicate::Reaches { agent: human.into(), node: "a".parse().unwrap(), within_m: far },
                Predicate::Crosses { human, gap_s: far },
                Predicate::OnTime { human, gap_s: far },
                Predicate::Ahead { human, within_m: far, for_s: 2.0 },
                Predicate::Looks { human, for_s: far },
                Predicate::StandsStill { human, for_s: far },
                Predicate::RunsAway { human, by_m: far },
                Predicate::Reacts { human, when: vec![Trigger::RobotNear(2.0)], act: Action::GiveWay, within_s: far },
                Predicate::Reacts { human, when: vec![Trigger::RobotNear(far)], act: Action::GiveWay, within_s: 2.0 },
                Predicate::Converges { within_m: 3.0, within_s: far },
                Predicate::Surrounds { count: 1, within_m: far, for_s: 2.0 },
                Predicate::Formation { group, spread_m: far },
                Predicate::WalksTogether { group, spread_m: far },
                Predicate::RobotKeeps { min_m: far },
            ];
            for predicate in all {
                let faults = faults(&predicate, &proposal);
                assert_eq!(faults.len(), 1, "{predicate:?}: {faults:?}");
                assert!(faults[0].contains("; allowed: "), "{faults:?}");
            }
        }
        let wide = Predicate::Flow { count: 1, within_m: 4.0, angle_deg: [0.0, 180.0] };
        assert!(faults(&wide, &proposal)[0].contains("largest less smallest, is 180; allowed: 0 to 120"));
    }

    #[test]
    fn who_reacts_from_afar_need_not_come_nearer() {
        let mut proposal = crossing_proposal();
        let human = HumanId::new(1);
        let meets = Predicate::Meets { human, within_m: 8.5 };
        assert_eq!(faults(&meets, &proposal).len(), 1);
        proposal.humans[0].rules[0].when = vec![Trigger::RobotVisible(8.0)];
        assert_eq!(faults(&meets, &proposal), Vec::<String>::new());
    }
}
