//! From how far people notice the robot, where the text leaves that open and many different scenarios are wanted.

use socrates_model::{Action, Gesture, PlaceClass, Relation, Rule, Trigger};

use crate::draw::Draw;

/// How much nearer robot and person come to each other in 2 s and a little, m: what is nearer to another moment than this is the same
/// moment to anybody who watches.
const fn step_m(relation: Relation) -> f64 {
    match relation {
        Relation::Frontal => 4.1,
        Relation::Crossing => 3.0,
        Relation::Behind
        | Relation::Ahead
        | Relation::Static
        | Relation::Leaving
        | Relation::Staying
        | Relation::Abreast
        | Relation::Aside => 1.7,
    }
}

/// The usual distance at which something is done, and the nearest and farthest that are natural, m; nothing for what does not depend on
/// a moment. The usual ones are those of `deed.rs` and `timing.rs`; nobody makes way or stops so far off that the two no longer meet.
fn reach_m(act: &Action, gesture: Option<Gesture>) -> Option<(f64, [f64; 2])> {
    let signs = gesture.is_some();
    let all = [
        (Action::RunAway, (3.0, [2.0, 5.4])),
        (Action::GiveWay, (3.5, [2.5, 5.9])),
        (Action::Block, (4.0, [2.5, 5.9])),
        (Action::LookAtRobot, (4.0, [2.5, 7.6])),
        (Action::Approach, (5.0, [3.3, 8.4])),
        (Action::StandStill, (3.0, [2.5, 5.9])),
        (Action::Navigate, (5.0, [2.5, 9.3])),
    ];
    all.into_iter().find(|(own, _)| own == act && (signs || *own != Action::Navigate)).map(|(_, reach)| reach)
}

/// The rules of a person with distances by the draw; `open` tells for each whether the text leaves its distance open. What is done one
/// after the other keeps its order: all distances grow or shrink alike.
pub(crate) fn rules(
    rules: &[Rule],
    open: &[bool],
    relation: Relation,
    (place, grouped, draw): (PlaceClass, bool, &mut Draw),
) -> Vec<Rule> {
    // Where only one gets through they have to be near before one makes room.
    if matches!(place, PlaceClass::Doorway | PlaceClass::NarrowPassage) {
        return rules.to_vec();
    }
    // Others see the robot as soon as it is there: behind it, or when a door opens; a circle holds until it is near.
    let meets = matches!(relation, Relation::Frontal | Relation::Crossing | Relation::Static);
    let is_open = |at: usize| meets && open.get(at).copied().unwrap_or(false);
    let reached = rules.iter().enumerate().filter(|(at, _)| is_open(*at) && !(grouped && relation == Relation::Static));
    let reached = reached.filter_map(|(_, rule)| {
        let m = rule.when.iter().find_map(Trigger::distance_m)?;
        reach_m(&rule.act, rule.gesture).map(|reach| (m, reach))
    });
    let all: Vec<(f64, (f64, [f64; 2]))> = reached.collect();
    // What has to come nearer than usual here stays as it is.
    let Some((first_m, _)) = all.first().copied().filter(|_| all.iter().all(|(m, (usual_m, _))| m >= usual_m)) else {
        return rules.to_vec();
    };
    let least_m = all.iter().map(|(_, (_, [least, _]))| *least).fold(0.0, f64::max);
    let most_m = all.iter().map(|(_, (_, [_, most]))| *most).fold(f64::INFINITY, f64::min);
    let steps =
        std::iter::successors(Some(least_m), |m| Some(m + step_m(relation))).take_while(|m| *m <= most_m + 1e-9);
    let steps: Vec<f64> = steps.collect();
    let Some(drawn_m) = draw.pick(&steps).copied().filter(|_| steps.len() > 1) else { return rules.to_vec() };
    let scaled = |trigger: &Trigger| match trigger.distance_m() {
        Some(m) => {
            let m = libm::round(m * drawn_m / first_m * 10.0) / 10.0;
            trigger.clone().at_distance(m.clamp(least_m.min(drawn_m), most_m))
        }
        None => trigger.clone(),
    };
    let noticed = |(at, rule): (usize, &Rule)| {
        if is_open(at) { Rule { when: rule.when.iter().map(scaled).collect(), ..rule.clone() } } else { rule.clone() }
    };
    rules.iter().enumerate().map(noticed).collect()
}

/// Whether two rules are one but for how near the robot is.
pub(crate) fn is_same(one: &Rule, other: &Rule) -> bool {
    let far = |rule: &Rule| -> Vec<Trigger> { rule.when.iter().map(|when| when.clone().at_distance(0.0)).collect() };
    far(one) == far(other) && Rule { when: Vec::new(), ..one.clone() } == Rule { when: Vec::new(), ..other.clone() }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use socrates_model::{Breadth, Fact, FactKind, Predicate};

    use crate::tests::{answers, map, request};

    /// Distances of the first trigger of the first person in the proposals of so many seeds, dm.
    fn drawn(rough: &str, breadth: Breadth) -> BTreeSet<u64> {
        let mut asked = request("Drive to the exit", Some(rough));
        asked.run.breadth = breadth;
        (1..=6)
            .map(|seed| {
                let (_, proposal, _) = answers(&asked, &map("hospital"), seed);
                let m = proposal.humans[0].rules[0].when[0].distance_m().unwrap();
                (m * 10.0).round() as u64
            })
            .collect()
    }

    #[test]
    fn a_distance_that_is_said_is_never_drawn_and_one_that_is_open_only_where_many_are_wanted() {
        let open = "A nurse crosses the robot's way. When she sees the robot, she looks at it.";
        let said = "A nurse crosses the robot's way. When the robot is 3 m away, she looks at it.";
        assert_eq!(drawn(open, Breadth::Usual).len(), 1);
        assert!(drawn(open, Breadth::Wide).len() > 1, "{:?}", drawn(open, Breadth::Wide));
        assert_eq!(drawn(said, Breadth::Wide), BTreeSet::from([30]));
    }

    #[test]
    fn a_reaction_is_judged_by_the_distance_that_was_drawn() {
        let rough = "A nurse crosses the robot's way. When she sees the robot, she looks at it.";
        let mut wide = request("Drive to the exit", Some(rough));
        wide.run.breadth = Breadth::Wide;
        for seed in 1..=4 {
            let (asked, proposal, _) = answers(&wide, &map("hospital"), seed);
            let own = &proposal.humans[0].rules[0].when;
            let fact = |fact: &&Fact| matches!(fact.kind, FactKind::Reacts { .. });
            let id = &asked.reading.facts.iter().find(fact).unwrap().id;
            let judged = proposal.expected_events.iter().filter(|clause| clause.source == *id);
            let whens: Vec<_> = judged
                .filter_map(
                    |clause| if let Predicate::Reacts { when, .. } = &clause.predicate { Some(when) } else { None },
                )
                .collect();
            assert!(!whens.is_empty() && whens.iter().all(|when| *when == own), "{own:?} {whens:?}");
        }
    }
}
