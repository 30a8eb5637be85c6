//! C: one follows the robot, another obstructs it.

use socrates_model::{AgentState, Point, Relation, Vector};

use super::{Case, FEW, MANY, STOPPED_MPS, Wrong, check, longest, off_heading, secs, study, tick};

/// At every tick where the follower is on the way that the robot has come: gap along it, distance from it, and the
/// angle between its heading and the way on towards the robot.
fn trail_gaps(robot: &[AgentState], follower: &[AgentState]) -> Vec<(f64, f64, f64)> {
    let first = robot[0].point();
    let back = Vector::new(robot[0].yaw.cos(), robot[0].yaw.sin());
    // The way straight back from its start comes first.
    let mut trail: Vec<(f64, Point)> =
        (1..=60).rev().map(|k| (-0.1 * f64::from(k), first - back * (0.1 * f64::from(k)))).collect();
    trail.push((0.0, first));
    let mut found = Vec::new();
    for (r, h) in robot.iter().zip(follower) {
        let (arc, last) = trail[trail.len() - 1];
        let now = arc + (r.point() - last).norm();
        if now - arc >= 0.1 {
            trail.push((now, r.point()));
        }
        let recent = &trail[trail.len().saturating_sub(80)..];
        let near = recent
            .iter()
            .enumerate()
            .min_by(|(_, a), (_, b)| (a.1 - h.point()).norm().total_cmp(&(b.1 - h.point()).norm()));
        let (index, (at, point)) = near.unwrap();
        let on = recent.get(index + 10).map_or_else(|| r.point(), |(_, point)| *point);
        found.push((now - at, (point - h.point()).norm(), off_heading(h, &on)));
    }
    found
}

/// Where the robot shifts by 0.4 m sideways within 2 s while somebody blocks it, and whether that one shifts the same way
/// within 2 s of it.
fn shifts(robot: &[AgentState], other: &[AgentState], blocks: &[bool]) -> Vec<(f64, bool)> {
    let two = tick(2.0);
    let mut found = Vec::new();
    let mut k = 0;
    while k < robot.len() {
        let way = other[k].point() - robot[k].point();
        let left = Vector::new(-way.y, way.x) / way.norm();
        let moved = |j: usize| left.dot(&(robot[j].point() - robot[k].point()));
        let mut span = (k..(k + two).min(robot.len())).take_while(|j| blocks[*j]);
        let Some(j) = span.find(|j| moved(*j).abs() >= 0.4) else {
            k += 10;
            continue;
        };
        let along = |m: usize| left.dot(&(other[m].point() - other[k].point())) * moved(j).signum();
        let goes = (k..(j + two).min(other.len())).any(|m| along(m) >= 0.2);
        // Whoever stops blocking before the 2 s are over owes no answer.
        if goes || blocks.get(j + two).is_some_and(|blocks| *blocks) {
            found.push((secs(j), goes));
        }
        k = j + 1;
    }
    found
}

pub(super) fn items(case: &Case<'_>) -> Wrong {
    let mut wrong = Wrong::new();
    let behind = case.of_relation(Relation::Behind);
    let Some(follower) = behind.first() else { return vec!["S2: nobody is behind the robot".to_owned()] };
    let (robot, track) = (&case.robot, case.person(*follower));
    // S1: the robot's way is along corridors or passages for 10 m.
    let place = &case.scenario.prepared.location;
    let ways = case.scenario.made.paths.robot.windows(2).filter_map(|pair| {
        let edge = place
            .graph
            .edges()
            .iter()
            .find(|e| [&e.from, &e.to] == [&pair[0], &pair[1]] || [&e.from, &e.to] == [&pair[1], &pair[0]])?;
        let kind = edge.kind.to_lowercase();
        (kind.contains("corridor") || kind.contains("passage") || kind.contains("hall"))
            .then(|| (case.node(&pair[1]) - case.node(&pair[0])).norm())
    });
    let corridor: f64 = ways.sum();
    check(&mut wrong, corridor >= 10.0, || format!("S1: {corridor:.1} m of the robot's way are corridor"));
    // S2: it starts behind; then a gap of 0.6 to 3 m, behind, the same way, for eight seconds and most of the motion.
    let ahead = |k: usize| {
        let line = track[k].point() - robot[k].point();
        line.x * robot[k].yaw.cos() + line.y * robot[k].yaw.sin()
    };
    let near = (0..track.len()).find(|k| (track[*k].point() - robot[*k].point()).norm() <= 5.0);
    check(&mut wrong, near.is_some() && ahead(0) < 0.0, || {
        format!("S2: starts {:.1} m ahead, near {near:?}", ahead(0))
    });
    let gaps = trail_gaps(robot, track);
    let follows = |k: usize| {
        let (gap, off, turned) = gaps[k];
        (0.6..=3.0).contains(&gap) && off <= 1.0 && turned <= 45.0_f64.to_radians()
    };
    let (from, length) = longest((0..track.len()).map(follows));
    check(&mut wrong, secs(length) >= 8.0, || {
        format!("S2: follows for {:.1} s from {:.1} s", secs(length), secs(from))
    });
    let moving: Vec<usize> = (0..robot.len()).filter(|k| robot[*k].speed() > STOPPED_MPS).collect();
    let share = moving.iter().filter(|k| follows(**k)).count() as f64 / moving.len().max(1) as f64;
    check(&mut wrong, share >= 0.6, || format!("S2: follows for {:.0} % of the robot's motion", share * 100.0));
    // S3: it stops behind a robot that stops: slow within 2 s of it, and never too near as long as it stands.
    let mut still = 0;
    for k in from..(from + length).min(robot.len()) {
        still = if robot[k].speed() < STOPPED_MPS { still + 1 } else { 0 };
        if still == tick(2.0) {
            check(&mut wrong, track[k].speed() < 0.3, || {
                format!("S3: at {:.1} m/s behind a robot that stands", track[k].speed())
            });
        }
        if still >= tick(2.0) {
            let gap = (track[k].point() - robot[k].point()).norm();
            check(&mut wrong, gap >= 0.5, || format!("S3: {gap:.2} m behind a robot that stands at {:.1} s", secs(k)));
        }
    }
    // S4: somebody else ahead in the way for three seconds. Nearer than 0.6 m to the line, a person leaves less than the
    // robot's width and 0.3 m on it, whatever there is beside.
    let mut blocked = Vec::new();
    for id in case.people.keys().filter(|id| *id != follower) {
        let other = case.person(*id);
        let first = (0..other.len()).find(|k| (other[*k].point() - robot[*k].point()).norm() <= 4.0);
        let (begun, lasts) = longest((0..other.len()).map(|k| {
            let at = other[k].point();
            (at - robot[k].point()).norm() <= 2.5 && case.on_way(&at).1 < 0.6
        }));
        blocked.push((
            secs(lasts),
            secs(begun),
            *id,
            first.map(|k| off_heading(&robot[k], &other[k].point()).to_degrees()),
        ));
    }
    blocked.sort_by(|a, b| b.0.total_cmp(&a.0));
    let Some((lasts, begun, id, angle)) = blocked.first() else {
        wrong.push("S4: there is nobody else".to_owned());
        return wrong;
    };
    check(&mut wrong, *lasts >= 3.0, || format!("S4: {id} is in the way for {lasts:.1} s"));
    check(&mut wrong, angle.is_some_and(|angle| angle <= 30.0), || {
        format!("S4: {id} first comes near at {angle:?} degrees")
    });
    let (first, last) = (tick(*begun), tick(begun + lasts));
    // S5: who blocks by a rule goes along with a robot that shifts, at least once.
    let leaves = &case.scenario.run.header.leaves;
    let blocks = |state: &AgentState| leaves.get(usize::from(state.leaf())).is_some_and(|leaf| leaf == "BlockRobot");
    let blocking: Vec<bool> = case.person(*id).iter().map(blocks).collect();
    check(&mut wrong, blocking.contains(&true), || format!("S5: {id} never blocks by its rule"));
    let shifts = shifts(robot, case.person(*id), &blocking);
    check(&mut wrong, shifts.is_empty() || shifts.iter().any(|(_, along)| *along), || {
        format!("S5: {id} goes along with none of the robot's shifts: {shifts:?}")
    });
    // S6: following for three seconds before, and both together for two.
    let (_, before) = longest((0..first).map(follows));
    check(&mut wrong, secs(before) >= 3.0, || {
        format!("S6: follows for {:.1} s before {id} is in the way", secs(before))
    });
    let together = (first..last).filter(|k| follows(*k)).count();
    check(&mut wrong, secs(together) >= 2.0, || format!("S6: both together for {:.1} s", secs(together)));
    // S7: the way opens within 30 s, and the robot arrives.
    check(&mut wrong, *lasts <= 30.0, || format!("S7: in the way for {lasts:.1} s"));
    check(&mut wrong, case.arrival().is_some(), || "S7: the robot never arrives".to_owned());
    wrong
}

/// Spoiled runs that must be tried and refused.
pub(super) const KINDS: &[&str] = &[
    "N: follower ahead",
    "N: follower beside",
    "N: gap over 5 m",
    "N: obstruction of 0.5 s",
    "N: beside the way all the time",
];

#[tokio::test]
async fn in_the_corridor_one_follows_and_one_obstructs() {
    study("corridor", items, KINDS, FEW).await;
}

#[tokio::test]
#[ignore = "sweep: 20 seeds"]
async fn in_the_corridor_one_follows_and_one_obstructs_over_twenty_seeds() {
    study("corridor", items, KINDS, MANY).await;
}
