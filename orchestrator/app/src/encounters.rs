//! From where people come to the robot where the two meet: the angle between their ways there, in sectors of 45°.
//!
//! The angle is the person's direction less the robot's, each taken over the last 2 m of its way before the meeting, as the paths have
//! it: what was asked for, whatever the two do when they see each other. Whether it happened is what the verdict says. Frontal,
//! crossing and overtaking are the encounters of Francis et al. 2023 (figure 7); the sectors between them are where a way joins
//! another obliquely.

use socrates_model::{HumanId, Location, NodeId, Paths, Polyline, Proposal, Relation, Vector, Visit};

/// The direction of a way is taken over so much of it before the meeting, m: less is at the mercy of a node beside a door.
const BEFORE_M: f64 = 2.0;
/// Cosine of the angle to which a direction counts as the other's, 22.5°, and to which as oblique to it, 67.5°.
const ALONG: f64 = 0.923_879_532_511_286_7;
const OBLIQUE: f64 = 0.382_683_432_365_089_8;

/// From where a person comes, as the robot drives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Sector {
    /// Towards the robot: 157.5° to 180°.
    Frontal,
    /// Towards the robot from the front left: 112.5° to 157.5°.
    FrontalLeft,
    /// The same from the front right.
    FrontalRight,
    /// Across its way from the left: 67.5° to 112.5°.
    CrossingLeft,
    /// The same from the right.
    CrossingRight,
    /// Into its way from behind on the left: 22.5° to 67.5°.
    MergingLeft,
    /// The same from the right.
    MergingRight,
    /// The same way ahead of it, below 22.5°: the robot follows or overtakes.
    Ahead,
    /// The same way from behind: the person follows or overtakes.
    Behind,
    /// The same way beside it.
    Beside,
    /// No way: they stand where the robot meets them.
    Standing,
}

impl Sector {
    /// Every sector, from ahead to behind.
    pub(crate) const ALL: [Self; 11] = [
        Self::Frontal,
        Self::FrontalLeft,
        Self::FrontalRight,
        Self::CrossingLeft,
        Self::CrossingRight,
        Self::MergingLeft,
        Self::MergingRight,
        Self::Ahead,
        Self::Behind,
        Self::Beside,
        Self::Standing,
    ];

    /// Name, as written in tables.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Frontal => "frontal",
            Self::FrontalLeft => "frontal_left",
            Self::FrontalRight => "frontal_right",
            Self::CrossingLeft => "crossing_left",
            Self::CrossingRight => "crossing_right",
            Self::MergingLeft => "merging_left",
            Self::MergingRight => "merging_right",
            Self::Ahead => "ahead",
            Self::Behind => "behind",
            Self::Beside => "beside",
            Self::Standing => "standing",
        }
    }

    /// What follows `an encounter`: `from behind`.
    pub(crate) const fn phrase(self) -> &'static str {
        match self {
            Self::Frontal => "from the front",
            Self::FrontalLeft => "from the front left",
            Self::FrontalRight => "from the front right",
            Self::CrossingLeft => "across from the left",
            Self::CrossingRight => "across from the right",
            Self::MergingLeft => "that merges from the left",
            Self::MergingRight => "that merges from the right",
            Self::Ahead => "with somebody ahead on the same way",
            Self::Behind => "from behind",
            Self::Beside => "with somebody beside the robot",
            Self::Standing => "with somebody who stands",
        }
    }

    /// The sector of the directions of robot and person, both of length 1.
    fn of(robot: &Vector, person: &Vector, relation: Relation) -> Self {
        // A person that goes to the left as the robot drives comes from its right.
        let of_side = |left, right| if robot.perp(person) < 0.0 { left } else { right };
        let cosine = robot.dot(person);
        if cosine <= -ALONG {
            Self::Frontal
        } else if cosine <= -OBLIQUE {
            of_side(Self::FrontalLeft, Self::FrontalRight)
        } else if cosine < OBLIQUE {
            of_side(Self::CrossingLeft, Self::CrossingRight)
        } else if cosine < ALONG {
            of_side(Self::MergingLeft, Self::MergingRight)
        } else {
            match relation {
                Relation::Behind => Self::Behind,
                Relation::Abreast => Self::Beside,
                Relation::Frontal
                | Relation::Ahead
                | Relation::Crossing
                | Relation::Static
                | Relation::Leaving
                | Relation::Staying
                | Relation::Aside => Self::Ahead,
            }
        }
    }
}

/// The sector of every meeting, people in their order, each as often as they meet the robot.
pub(crate) fn sectors(proposal: &Proposal, paths: &Paths, location: &Location) -> Vec<Sector> {
    let of = |(human, relation): (HumanId, Relation)| {
        paths.visits(human).into_iter().filter_map(move |visit| sector(human, relation, &visit, paths, location))
    };
    proposal.humans.iter().map(|human| (human.id, human.relation)).flat_map(of).collect()
}

/// The sector of one meeting; none where the paths do not lead there.
fn sector(human: HumanId, relation: Relation, visit: &Visit<'_>, paths: &Paths, location: &Location) -> Option<Sector> {
    let own = paths.humans.get(&human)?;
    if own.len() < 2 {
        return Some(Sector::Standing);
    }
    let robot = direction(&paths.robot, visit.robot_step?, location)?;
    let person = direction(own, visit.human_step?, location)?;
    Some(Sector::of(&robot, &person, relation))
}

/// The direction of a way where it comes to a step, or where it leaves its start.
fn direction(nodes: &[NodeId], step: usize, location: &Location) -> Option<Vector> {
    let until = if step == 0 { nodes } else { nodes.get(..=step)? };
    let way = Polyline::new(&location.graph.polyline(until));
    let from_m = if step == 0 { 0.0 } else { way.length_m() - BEFORE_M };
    (way.point(from_m + BEFORE_M) - way.point(from_m)).try_normalize(1e-9)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn the_sides_are_those_of_the_robot_as_it_drives() {
        let robot = Vector::new(1.0, 0.0);
        let of = |x: f64, y: f64| Sector::of(&robot, &Vector::new(x, y).normalize(), Relation::Crossing);
        let ways = [(-1., 0.), (-1., -0.2), (-1., 1.), (-1., -1.), (0., 1.), (0., -1.), (1., 1.), (1., -1.), (1., 0.2)];
        let found = ways.map(|(x, y)| of(x, y));
        assert_eq!(
            found.map(Sector::name),
            [
                "frontal",
                "frontal",
                "frontal_right",
                "frontal_left",
                "crossing_right",
                "crossing_left",
                "merging_right",
                "merging_left",
                "ahead"
            ]
        );
        assert_eq!(Sector::of(&robot, &robot, Relation::Behind), Sector::Behind);
        assert_eq!(Sector::of(&robot, &-robot, Relation::Behind), Sector::Frontal, "the way says more than the word");
    }

    #[test]
    fn every_sector_has_a_name_of_its_own() {
        let names: std::collections::BTreeSet<&str> = Sector::ALL.iter().map(|sector| sector.name()).collect();
        assert_eq!(names.len(), Sector::ALL.len());
    }

    #[test]
    fn the_card_of_a_crossing_crosses_and_that_of_an_overtaker_comes_from_behind() {
        let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
        let found = |pattern: &str| {
            let office = socrates_maps::shipped::load("office").unwrap();
            let request = serde_json::from_value(json!({
                "location": "office", "social_context": "", "task": "Deliver mail", "expect": { "pattern": pattern },
            }))
            .unwrap();
            let reading = socrates_offline::read(&request, &office);
            let (proposal, paths) =
                runtime.block_on(crate::in_process::foresee(&request, &reading, &office, 1)).unwrap();
            sectors(&proposal, &paths, &office)
        };
        assert!(found("frontal_approach").contains(&Sector::Frontal), "{:?}", found("frontal_approach"));
        let crossing = found("intersection_crossing");
        assert!(crossing.iter().all(|one| matches!(one, Sector::CrossingLeft | Sector::CrossingRight)), "{crossing:?}");
        assert_eq!(found("human_overtaking"), [Sector::Behind]);
        assert_eq!(found("robot_overtaking"), [Sector::Ahead]);
        assert_eq!(found("pedestrian_obstruction").len(), 1);
    }
}
