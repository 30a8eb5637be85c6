//! The monitor of where somebody faces who stands, as the robot comes near and before they react to it.

use socrates_model::proposal::Facing;
use socrates_model::{HumanId, Vector};

use crate::fidelity::finding::Finding;
use crate::fidelity::meeting::absent;
use crate::fidelity::signals::{MOMENT_SECS, Moment, Signals};
use crate::tracks::MOVING_MPS;

/// The robot is that near, m: as it comes, and where it is seen no farther away.
const COMES_M: [f64; 2] = [3.0, 6.0];
const CLOSE_M: [f64; 2] = [1.0, 3.0];
/// So long at least, s.
const LASTS_S: f64 = 0.3;
/// Largest angle between heading and what is faced, and from straight away, degrees.
const TO_DEG: f64 = 45.0;
const AWAY_DEG: f64 = 60.0;
/// The angle is kept for all of the time but this part.
const FIFTH: usize = 5;

/// The human faces so while the robot comes near, until they react.
pub(super) fn faces(signals: &Signals<'_>, human: HumanId, facing: &Facing) -> Finding {
    if let Some(found) = absent(signals, human) {
        return found;
    }
    let moments = signals.of(human);
    let Some(nearest) = moments.iter().min_by(|a, b| a.distance_m.total_cmp(&b.distance_m)) else {
        return Finding::not_applicable("the recording is empty");
    };
    // What begins with the run is how they stand; the next leaf is a reaction.
    let reacts_s = signals.leaves_of(human).get(1).map_or(f64::INFINITY, |leaf| leaf.from_s);
    let counts = |moment: &&Moment| {
        moment.t <= nearest.t
            && moment.t < reacts_s
            && moment.human.speed() <= MOVING_MPS
            && moment.robot.speed() > MOVING_MPS
            && moment.sight != Some(false)
    };
    let within = |[least, most]: [f64; 2]| {
        moments.iter().filter(counts).filter(|moment| (least..=most).contains(&moment.distance_m)).collect::<Vec<_>>()
    };
    let long_s = |list: &[&Moment]| MOMENT_SECS * f64::from(u32::try_from(list.len()).unwrap_or(u32::MAX));
    let seen = [COMES_M, CLOSE_M].map(within).into_iter().find(|list| long_s(list) >= LASTS_S);
    let Some(seen) = seen else {
        let text = format!("{human} does not stand in view of a robot that comes within 6 m, before they react");
        return Finding::never(-1.0, vec![nearest.t], text);
    };
    let target = match facing {
        Facing::Human(id) => match signals.tracks.human(*id).and_then(|track| track.samples.first()) {
            Some(other) => Some(other.at),
            None => return Finding::fails(-1.0, vec![], format!("{id} is not in the recording")),
        },
        Facing::Node(id) => match signals.node(id) {
            Some(at) => Some(at),
            None => return Finding::not_applicable(format!("the map has no node `{id}`, or there is no map")),
        },
        Facing::Robot | Facing::Away | Facing::Left | Facing::Right => None,
    };
    let wanted = |moment: &Moment| -> Vector {
        let ahead = moment.robot.facing();
        let left = Vector::new(-ahead.y, ahead.x);
        match facing {
            Facing::Robot => -moment.away(),
            Facing::Away => moment.away(),
            Facing::Left => left,
            Facing::Right => -left,
            Facing::Human(_) | Facing::Node(_) => target.map_or_else(Vector::zeros, |at| at - moment.human.at),
        }
    };
    let angle_deg = |moment: &&Moment| {
        let wanted = wanted(moment);
        let length = wanted.norm();
        if length < 1e-9 {
            return 180.0;
        }
        libm::acos((wanted.dot(&moment.human.facing()) / length).clamp(-1.0, 1.0)).to_degrees()
    };
    let mut angles: Vec<f64> = seen.iter().map(angle_deg).collect();
    angles.sort_by(f64::total_cmp);
    let kept = angles.get(angles.len() - 1 - angles.len() / FIFTH).copied().unwrap_or(180.0);
    let most = if *facing == Facing::Away { AWAY_DEG } else { TO_DEG };
    let (from_s, far_m) = seen.first().map_or((0.0, 0.0), |moment| (moment.t, moment.distance_m));
    let text = format!(
        "from {from_s:.1} s, with the robot {far_m:.1} m away, {human} faces {kept:.0}° or less from {} for 80 % of {:.1} s \
         (at most {most:.0}° asked)",
        facing.phrase(),
        long_s(&seen),
    );
    Finding::by_margin((most - kept).to_radians(), vec![from_s], text)
}
