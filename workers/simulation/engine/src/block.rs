//! Standing in the robot's way, alone or with others.

use socrates_model::{Action, HumanProposal, Vector};

use crate::human::Human;
use crate::motion::{Scene, Want, round};
use crate::robot::Robot;
use crate::setup::Setup;

/// Where somebody stands who blocks: ahead of the robot's center, m.
const AHEAD_M: f64 = 1.25;
/// From one to the next of those who stand in the robot's way together, m.
const SHOULDERS_M: f64 = 0.62;

/// How many block the robot where this human meets it, itself among them.
pub(crate) fn blockers(setup: &Setup, proposal: &HumanProposal) -> usize {
    let node = setup.paths.encounters_of(proposal.id).next();
    let blocks = |human: &&HumanProposal| {
        human.rules.iter().any(|rule| rule.act == Action::Block) && setup.paths.encounters_of(human.id).next() == node
    };
    setup.proposal.humans.iter().filter(blocks).count()
}

/// Gives everybody who has begun to block together with others a place: two by two before the robot, an odd one behind
/// them. Who comes first stands in front; of the two of a row everybody stands on its own side.
pub(crate) fn take_places(humans: &mut [Human], robot: &Robot) {
    let intent = robot.intent();
    let left = Vector::new(-intent.y, intent.x);
    let aside = |human: &Human| (human.at - robot.at()).dot(&left);
    for human in humans.iter_mut().filter(|human| human.action != Action::Block) {
        human.place_m = None;
    }
    let new = |human: &Human| human.action == Action::Block && human.place_m.is_none();
    while let Some(number) = humans.iter().position(new) {
        let taken: Vec<(f64, f64)> = humans.iter().filter_map(|human| human.place_m).collect();
        let Some(human) = humans.get_mut(number) else { return };
        let pairs = human.blockers / 2;
        let behind_m = |row: usize| (0..row).map(|_| SHOULDERS_M).sum::<f64>();
        let mut places = (0..pairs).flat_map(|row| [0.5, -0.5].map(|side| (side * SHOULDERS_M, behind_m(row))));
        let place = places.find(|place| !taken.contains(place)).unwrap_or_else(|| (0.0, behind_m(pairs)));
        human.place_m = Some(place);
        let beside = aside(human);
        let mate = humans.iter_mut().find(|other| other.place_m == Some((-place.0, place.1)) && place.0 != 0.0);
        if let Some(mate) = mate
            && (aside(mate) > beside) != (-place.0 > place.0)
        {
            mate.place_m = Some(place);
            if let Some(human) = humans.get_mut(number) {
                human.place_m = Some((-place.0, place.1));
            }
        }
    }
}

/// What somebody wants who blocks the robot.
pub(crate) fn block(human: &mut Human, scene: &Scene<'_>) -> Want {
    let Some(robot) = scene.robot else { return Want::STAND };
    let intent = robot.intent();
    let left = Vector::new(-intent.y, intent.x);
    let (beside_m, behind_m) = human.place_m.unwrap_or_default();
    let mut spot = robot.at() + intent * (AHEAD_M + behind_m) + left * beside_m;
    if scene.floor.clearance_m(&spot) < human.radius_m {
        // Round a corner the straight line ahead ends in a wall; the way itself does not.
        spot = robot.route.point(robot.s + AHEAD_M + behind_m);
    }
    let way = human.at - robot.at();
    let (ahead, aside) = (way.dot(&intent) - behind_m, way.dot(&left) - beside_m);
    let in_place = ahead > 0.75 && ahead < 1.6 && aside.abs() < if human.anchor.is_some() { 0.3 } else { 0.12 };
    if in_place || (spot - human.at).norm() < 0.1 {
        return Want::stand_facing(robot.at());
    }
    // Far ahead it waits in the line instead of running against the robot.
    let target = if ahead > 1.6 && aside.abs() > 0.12 && robot.speed_mps() > 0.1 && ahead < 4.0 {
        robot.at() + intent * (ahead.min(2.0) + behind_m) + left * beside_m
    } else {
        spot
    };
    let speed = (2.0 * (target - human.at).norm() + 0.1).min(human.speed_mps.max(1.0));
    let next = round(human, scene, &target).unwrap_or(target);
    Want { target: Some(next), speed_mps: speed, face: Some(robot.at()), drawn: true }
}
