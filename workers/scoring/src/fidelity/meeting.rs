//! Monitors of how a human and the robot come together: meets, head-on, crosses, ahead, overtakes, passes.

use std::f64::consts::PI;

use socrates_model::{Clause, HumanId, Point, Predicate, Relation, ordinal};

use crate::fidelity::finding::Finding;
use crate::fidelity::signals::{Moment, Signals, Way};
use crate::fidelity::windows::{Mark, best, first, held, stretches};
use crate::tracks::{Sample, Track};

/// How near to the encounter node a meeting counts, m.
pub(super) const MEET_NODE_M: f64 = 3.0;
/// Somebody whom the robot never comes nearer to than this has nothing to do with it, m: nobody notices a robot from farther away.
const PRESENT_M: f64 = 15.0;
/// Distance from which two who approach are judged, m.
const APPROACH_M: f64 = 10.0;
/// Distance within which somebody passes or overtakes, m.
const PASS_M: f64 = 3.0;
/// How long a direction must be kept to count, s.
const KEPT_SECS: f64 = 0.5;
/// Speed from which somebody has a direction, m/s.
const WALKING_MPS: f64 = 0.2;
/// Speed away from the robot from which somebody goes ahead of it, m/s.
const GOES_MPS: f64 = 0.1;
/// Radius of the place where two ways meet, m; arriving is entering it.
const CONFLICT_M: f64 = 1.5;
/// A time limit missed by at most this factor is late; by more it is not what was asked.
pub(super) const LATE_FACTOR: f64 = 2.0;

/// The evidence when a human or the robot is missing from the recording, or the human never comes so near that the robot could have
/// to do with them.
pub(super) fn absent(signals: &Signals<'_>, human: HumanId) -> Option<Finding> {
    if signals.tracks.human(human).is_none() {
        return Some(Finding::fails(-1.0, vec![], format!("{human} is not in the recording")));
    }
    if signals.tracks.robot.is_none() {
        return Some(Finding::not_applicable("there is no robot in the recording"));
    }
    let nearest = closest(signals.of(human)).filter(|nearest| nearest.distance_m > PRESENT_M)?;
    let text = format!(
        "{human} is {:.1} m from the robot at their nearest, at {:.1} s (at most {PRESENT_M:.0} m)",
        nearest.distance_m, nearest.t
    );
    Some(Finding::never(PRESENT_M - nearest.distance_m, vec![nearest.t], text))
}

fn closest(moments: &[Moment]) -> Option<&Moment> {
    moments.iter().min_by(|a, b| a.distance_m.total_cmp(&b.distance_m))
}

/// Robot and human come within `within_m` of each other, both near the human's nth encounter node, in the time that is
/// this encounter's.
pub(super) fn meets(signals: &Signals<'_>, human: HumanId, nth: u32, within_m: f64) -> Finding {
    if let Some(found) = absent(signals, human) {
        return found;
    }
    let meeting = signals.meeting(human, nth);
    if nth > 1 && meeting.is_none() {
        let text = format!("{human} has no {} encounter with the robot in the paths", ordinal(nth));
        return Finding::fails(-1.0, vec![], text);
    }
    let moments = signals.of_meeting(human, nth);
    if moments.is_empty() && meeting.is_some() {
        let text = format!("the robot never got near the {} encounter with {human}", ordinal(nth));
        return Finding::never(-1.0, vec![], text);
    }
    let near = meeting.map_or_else(|| signals.encounter(human), |meeting| Some((&meeting.node, meeting.at)));
    // A person who comes up from behind and stops meets the robot there.
    let near = near.filter(|_| nth > 1 || !comes_up(signals, human));
    let mark = |moment: &Moment| {
        let both = near.map_or(f64::INFINITY, |(_, at)| {
            MEET_NODE_M - (moment.robot.at - at).norm().max((moment.human.at - at).norm())
        });
        Mark::new(moment.t, (within_m - moment.distance_m).min(both))
    };
    let (Some(nearest), Some(top)) = (closest(moments), best(moments.iter().map(mark))) else {
        return Finding::not_applicable("the recording is empty");
    };
    let which = if meeting.is_some() { format!(", {} meeting,", ordinal(nth)) } else { String::new() };
    let place = near.map_or_else(String::new, |(id, _)| format!("{which} near `{id}`"));
    if let Some(mark) = first(moments.iter().map(mark)) {
        let text = format!(
            "{human} and the robot within {within_m:.1} m{place} at {:.1} s; closest {:.2} m at {:.1} s",
            mark.t, nearest.distance_m, nearest.t
        );
        return Finding::holds(top.margin, vec![mark.t, nearest.t], text)
            .shifted(room_s(signals, human, nth, within_m, true));
    }
    let missing = near.map_or_else(String::new, |(id, at)| {
        let reach = |samples: Vec<Sample>| {
            samples
                .iter()
                .map(|sample| ((sample.at - at).norm(), sample.t))
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .unwrap_or((f64::INFINITY, 0.0))
        };
        let robot = reach(moments.iter().map(|moment| moment.robot).collect());
        let person = reach(moments.iter().map(|moment| moment.human).collect());
        format!(
            "; nearest to `{id}`: robot {:.1} m at {:.1} s, {human} {:.1} m at {:.1} s",
            robot.0, robot.1, person.0, person.1
        )
    });
    let text = format!(
        "{human} and the robot were never within {within_m:.1} m of each other{place}; closest anywhere {:.1} m at {:.1} s{missing}",
        nearest.distance_m, nearest.t
    );
    Finding::never(top.margin, vec![nearest.t], text).shifted(-room_s(signals, human, nth, within_m, false))
}

/// Whether a person comes up with the robot from behind, and no clause has them overtake it.
fn comes_up(signals: &Signals<'_>, human: HumanId) -> bool {
    let Some(proposal) = signals.evidence.proposal else { return false };
    let behind = proposal.human(human).is_some_and(|human| human.relation == Relation::Behind);
    let overtakes = |clause: &Clause| matches!(clause.predicate, Predicate::Overtakes { human: who } if who == human);
    behind && !proposal.expected_events.iter().any(overtakes)
}

/// Step and end of the shifts that are tried, s.
const SHIFT_STEP_SECS: f64 = 0.25;
const SHIFT_STEPS: u32 = 40;

/// How much sooner or later the human could come, whichever is less, and they would still meet; `meets` false: how much
/// it takes for them to meet. Infinite beyond 10 s.
fn room_s(signals: &Signals<'_>, human: HumanId, nth: u32, within_m: f64, meets: bool) -> f64 {
    let (Some(robot), Some(person)) = (&signals.tracks.robot, signals.tracks.human(human)) else {
        return f64::INFINITY;
    };
    let meeting = signals.meeting(human, nth);
    let near = meeting.map(|meeting| meeting.at).or_else(|| signals.encounter(human).map(|(_, at)| at));
    let reach = |at: &Point| near.is_none_or(|node| (at - node).norm() <= MEET_NODE_M);
    let own = |t: f64| meeting.is_none_or(|meeting| (meeting.from_s..meeting.to_s).contains(&t));
    let grid = |track: &Track| -> Vec<Option<Point>> {
        let even = (0..).map(|k| f64::from(k) * SHIFT_STEP_SECS).take_while(|t| *t <= signals.end_s());
        even.map(|t| track.at(t).filter(|_| own(t)).map(|sample| sample.at).filter(&reach)).collect()
    };
    let (mine, theirs) = (grid(robot), grid(person));
    let met = |shift: u32, sooner: bool| {
        let (a, b) = if sooner { (&mine, &theirs) } else { (&theirs, &mine) };
        let skipped = b.iter().skip(usize::try_from(shift).unwrap_or(usize::MAX));
        a.iter().zip(skipped).any(|(p, q)| p.zip(*q).is_some_and(|(p, q)| (p - q).norm() <= within_m))
    };
    let ends = [false, true].map(|sooner| (1..=SHIFT_STEPS).find(|shift| met(*shift, sooner) != meets));
    // Meeting ends with the first shift that parts them; the last one before it still holds.
    let first = ends.into_iter().flatten().min();
    first.map_or(f64::INFINITY, |shift| f64::from(if meets { shift - 1 } else { shift }) * SHIFT_STEP_SECS)
}

/// Smallest angle to the robot's heading of a person who comes towards it, degrees: up to 135° they cross its way.
const HEAD_ON_DEG: f64 = 135.0;

/// Distance from the robot's intended way within which a human is on it, m.
const ON_WAY_M: f64 = 1.2;

/// Angle between the course of a human and the robot's intended way, rad, where they are on it ahead of the robot: round a corner the
/// robot's heading does not tell that they come towards it.
fn along_way_rad(way: &Way, moment: &Moment) -> Option<f64> {
    let (ahead_m, off_m) = moment.way?;
    let on = ahead_m > 0.0 && ahead_m <= APPROACH_M && off_m <= ON_WAY_M;
    let (along, course) =
        way.direction(&moment.human.at).filter(|_| on).zip(moment.human.velocity.try_normalize(1e-9))?;
    Some(libm::acos(along.dot(&course).clamp(-1.0, 1.0)))
}

/// The human comes towards the robot as they approach.
pub(super) fn head_on(signals: &Signals<'_>, human: HumanId) -> Finding {
    if let Some(found) = absent(signals, human) {
        return found;
    }
    let moments = signals.of_meeting(human, 1);
    let Some(nearest) = closest(moments) else { return Finding::not_applicable("the recording is empty") };
    let Some(start) = moments.iter().find(|moment| moment.distance_m <= APPROACH_M) else {
        let text = format!("never within {APPROACH_M:.0} m: closest {:.1} m at {:.1} s", nearest.distance_m, nearest.t);
        return Finding::never((APPROACH_M - nearest.distance_m) / APPROACH_M, vec![nearest.t], text);
    };
    // A stop in the middle of the approach must not hide it: every stretch up to the closest point counts.
    let approach = moments.iter().filter(|moment| moment.t >= start.t && moment.t <= nearest.t.max(start.t + 1.0));
    let limit = HEAD_ON_DEG.to_radians();
    let along_rad = |moment: &Moment| signals.way.as_ref().and_then(|way| along_way_rad(way, moment));
    let course_rad = |moment: &Moment| along_rad(moment).map_or(moment.course_rad, |rad| rad.max(moment.course_rad));
    let parts = |moment: &Moment| {
        let by_heading = if moment.distance_m > 1e-6 { moment.ahead_m / moment.distance_m } else { 1.0 };
        let ahead = if along_rad(moment).is_some_and(|rad| rad >= limit) { 1.0 } else { by_heading };
        [
            (course_rad(moment) - limit, "is not head on"),
            ((moment.human.speed() - WALKING_MPS) * 2.0, "hardly walks"),
            (moment.closing_mps, "comes no nearer"),
            (ahead - 0.5, "is not ahead of the robot"),
        ]
    };
    let worst =
        |moment: &Moment| parts(moment).into_iter().min_by(|one, other| one.0.total_cmp(&other.0)).unwrap_or((0.0, ""));
    let marks = approach.map(|moment| Mark::new(moment.t, worst(moment).0));
    let marks: Vec<Mark> = marks.collect();
    let Some(found) = held(marks.iter().copied(), KEPT_SECS, 0.0) else {
        return Finding::fails(
            -0.1,
            vec![start.t],
            format!("the approach from {:.1} s was too short to judge", start.t),
        );
    };
    let at = found.first_s.unwrap_or(found.best_s);
    let then = moments.iter().find(|moment| moment.t >= at);
    let angle = then.map_or(0.0, |moment| course_rad(moment).to_degrees());
    // The moment is the best that there was; where that is not good enough, what it lacks is said.
    let lacks = then.filter(|_| found.margin < 0.0).map_or("", |moment| worst(moment).1);
    let lacks = if lacks.is_empty() { String::new() } else { format!(", but {lacks} for {KEPT_SECS:.1} s on end") };
    let text = format!(
        "{human} at {angle:.0}° to the robot's heading or way at {at:.1} s ({HEAD_ON_DEG:.0}° to 180° asked){lacks}, closest {:.2} m at {:.1} s",
        nearest.distance_m, nearest.t
    );
    let longest = stretches(marks, 0.0).into_iter().map(|(from, to)| to - from).fold(0.0, f64::max);
    Finding::by_margin(found.margin, vec![at, nearest.t], text).scaled(0.3).shifted(longest - KEPT_SECS)
}

/// Where two tracks meet in space, whenever each is there.
struct Conflict {
    at: Point,
    apart_m: f64,
    robot_course: socrates_model::Vector,
    human_course: socrates_model::Vector,
}

/// The tracks at every 0.25 m of way, each with its direction.
fn steps(track: &Track) -> Vec<(Point, socrates_model::Vector)> {
    let mut kept: Vec<Point> = Vec::new();
    for sample in track.present() {
        if kept.last().is_none_or(|last| (sample.at - last).norm() >= 0.25) {
            kept.push(sample.at);
        }
    }
    // A chord of two steps smooths the sway of a walk.
    let ahead = kept.iter().skip(2).chain(kept.last().into_iter().cycle());
    let back = kept.first().into_iter().chain(kept.first()).chain(kept.iter());
    kept.iter()
        .zip(ahead.zip(back))
        .map(|(at, (next, before))| {
            let chord = next - before;
            let length = chord.norm();
            (*at, if length > 1e-9 { chord / length } else { socrates_model::Vector::zeros() })
        })
        .collect()
}

/// The tracks of robot and human as they are at the human's first encounter, where it has several: the robot's in the time
/// that is this encounter's, the human's until it leaves the place for the first time.
fn first_part(signals: &Signals<'_>, human: HumanId, robot: &Track, person: &Track) -> Option<(Track, Track)> {
    let meeting = signals.meeting(human, 1)?;
    let off = |sample: &Sample| (sample.at - meeting.at).norm();
    let mut passed = person.present().skip_while(|sample| off(sample) > CONFLICT_M);
    let left_s = passed.find(|sample| off(sample) > MEET_NODE_M).map_or(meeting.to_s, |sample| sample.t);
    let until = |track: &Track, end_s: f64| {
        let mut part = track.clone();
        part.samples.retain(|sample| sample.t < end_s);
        part
    };
    Some((until(robot, meeting.to_s), until(person, left_s.min(meeting.to_s))))
}

fn conflict(robot: &Track, human: &Track, near: Option<Point>) -> Option<Conflict> {
    let inside = |at: &Point| near.is_none_or(|node| (at - node).norm() <= MEET_NODE_M);
    let theirs: Vec<_> = steps(human).into_iter().filter(|(at, _)| inside(at)).collect();
    let mut found: Option<Conflict> = None;
    for (at, course) in steps(robot).into_iter().filter(|(at, _)| inside(at)) {
        for (other, other_course) in &theirs {
            // Somebody who stands at the place does not cross it.
            if *other_course == socrates_model::Vector::zeros() {
                continue;
            }
            let apart_m = (at - other).norm();
            if found.as_ref().is_none_or(|best| apart_m < best.apart_m) {
                found = Some(Conflict { at, apart_m, robot_course: course, human_course: *other_course });
            }
        }
    }
    found
}

/// The human's way crosses the robot's, both there at about the same time.
pub(super) fn crosses(signals: &Signals<'_>, human: HumanId, gap_s: f64) -> Finding {
    if let Some(found) = absent(signals, human) {
        return found;
    }
    let (Some(robot), Some(person)) = (&signals.tracks.robot, signals.tracks.human(human)) else {
        return Finding::not_applicable("the recording is empty");
    };
    let part = first_part(signals, human, robot, person);
    let (robot, person) = part.as_ref().map_or((robot, person), |(robot, person)| (robot, person));
    let near = signals.encounter(human);
    let place = near.map_or_else(String::new, |(id, _)| format!(" near `{id}`"));
    let Some(meet) = conflict(robot, person, near.map(|(_, at)| at)).filter(|meet| meet.apart_m <= 1.0) else {
        return Finding::never(-1.0, vec![], format!("the ways of {human} and the robot never meet{place}"));
    };
    let arrival = |track: &Track| {
        track.present().find(|sample| (sample.at - meet.at).norm() <= CONFLICT_M).map(|sample| sample.t)
    };
    let (Some(first), Some(second)) = (arrival(robot), arrival(person)) else {
        return Finding::never(-1.0, vec![], format!("the ways of {human} and the robot never meet{place}"));
    };
    let angle = libm::acos(meet.robot_course.dot(&meet.human_course).clamp(-1.0, 1.0));
    let gap = second - first;
    let times = vec![first.max(second), first, second];
    let text = format!(
        "ways meet{place} at {:.0}°; robot there at {:.1} s, {human} at {:.1} s: gap {:.1} s (at most {gap_s:.1} s asked)",
        angle.to_degrees(),
        first,
        second,
        gap.abs()
    );
    let square = PI / 4.0 - (angle - PI / 2.0).abs();
    if square < 0.0 {
        return Finding::fails(square, times, format!("{text}; 45° to 135° asked")).scaled(0.3);
    }
    let finding = match gap.abs() {
        gap if gap <= gap_s => Finding::holds((gap_s - gap).min(square), times, text),
        gap if gap <= LATE_FACTOR * gap_s => Finding::late(gap_s - gap, times, text),
        gap => Finding::fails(gap_s - gap, times, text),
    };
    finding.shifted(gap_s - gap.abs())
}

/// The human is ahead of the robot on its way for some time.
pub(super) fn ahead(signals: &Signals<'_>, human: HumanId, within_m: f64, for_s: f64) -> Finding {
    if let Some(found) = absent(signals, human) {
        return found;
    }
    let moments = signals.of(human);
    let marks = moments.iter().map(|moment| {
        let by_heading = moment.ahead_m.min(1.2 - moment.left_m.abs());
        let by_way = moment.way.map_or(f64::NEG_INFINITY, |(ahead, off)| ahead.min(1.2 - off));
        // Somebody who stands, or comes towards the robot, does not go ahead of it.
        let goes = moment.human.velocity.dot(&moment.away()) - GOES_MPS;
        Mark::new(moment.t, (within_m - moment.distance_m).min(by_heading.max(by_way)).min(goes))
    });
    let what = format!("ahead of the robot within {within_m:.1} m for {for_s:.1} s");
    lasting(signals, human, marks.collect(), for_s, within_m, &what)
}

/// A condition that must hold for some time, with a premise on the distance.
pub(super) fn lasting(
    signals: &Signals<'_>,
    human: HumanId,
    marks: Vec<Mark>,
    for_s: f64,
    near_m: f64,
    what: &str,
) -> Finding {
    let Some(nearest) = closest(signals.of(human)) else { return Finding::not_applicable("the recording is empty") };
    let Some(found) = held(marks.iter().copied(), for_s, 0.0) else {
        return Finding::fails(-1.0, vec![], format!("{human} {what}: the run is shorter than that"));
    };
    if let Some(at) = found.first_s {
        let longest = stretches(marks, for_s).into_iter().map(|(from, to)| to - from).fold(0.0, f64::max);
        let text = format!("{human} {what}: from {at:.1} s, longest {longest:.1} s, margin {:.2}", found.margin);
        return Finding::holds(found.margin, vec![at, at + longest], text).shifted(longest - for_s);
    }
    if nearest.distance_m > near_m + 1.0 {
        let text = format!("{human} {what}: never near, closest {:.1} m at {:.1} s", nearest.distance_m, nearest.t);
        return Finding::never(found.margin, vec![nearest.t], text);
    }
    let longest =
        stretches(marks, 0.0).into_iter().map(|(from, to)| (to - from, from)).max_by(|a, b| a.0.total_cmp(&b.0));
    let text = match longest {
        Some((length, from)) => format!("{human} {what}: only {length:.1} s from {from:.1} s"),
        None if found.margin.is_finite() => {
            format!("{human} {what}: not once; best at {:.1} s, short by {:.2}", found.best_s, -found.margin)
        }
        None => format!("{human} {what}: it never came about"),
    };
    Finding::fails(found.margin, vec![found.best_s], text).shifted(longest.map_or(0.0, |(length, _)| length) - for_s)
}

/// One goes from behind the other to ahead of it, close by. `overtakes`: the human passes the robot
/// the same way; else the robot passes the human.
pub(super) fn passes(signals: &Signals<'_>, human: HumanId, overtakes: bool) -> Finding {
    passes_since(signals, human, overtakes, f64::NEG_INFINITY)
}

/// The same from a time on.
pub(super) fn passes_since(signals: &Signals<'_>, human: HumanId, overtakes: bool, since_s: f64) -> Finding {
    if let Some(found) = absent(signals, human) {
        return found;
    }
    let all = signals.of(human);
    let moments = all.get(all.partition_point(|moment| moment.t < since_s)..).unwrap_or_default();
    let near: Vec<&Moment> = moments.iter().filter(|moment| moment.distance_m <= PASS_M).collect();
    let Some(nearest) = closest(moments) else { return Finding::not_applicable("the recording is empty") };
    if near.is_empty() {
        let text = format!("never within {PASS_M:.0} m: closest {:.1} m at {:.1} s", nearest.distance_m, nearest.t);
        return Finding::never(PASS_M - nearest.distance_m, vec![nearest.t], text);
    }
    // Nobody passes somebody behind a wall.
    let near: Vec<&Moment> = near.into_iter().filter(|moment| moment.sight != Some(false)).collect();
    if near.is_empty() {
        let text = format!(
            "a wall is between them whenever they are within {PASS_M:.0} m, {:.1} m at {:.1} s",
            nearest.distance_m, nearest.t
        );
        return Finding::never(-1.0, vec![nearest.t], text);
    }
    let sign = if overtakes { 1.0 } else { -1.0 };
    let same_way = |moment: &Moment| !overtakes || moment.course_rad <= PI / 4.0 && moment.human.speed() > WALKING_MPS;
    // Largest lead gained after the largest one held on the first side, among moments the same way.
    let mut before: Option<(f64, f64)> = None;
    let mut top: Option<(f64, f64, f64)> = None;
    for moment in near.iter().filter(|moment| same_way(moment)) {
        let lead = sign * moment.ahead_m;
        if let Some((behind, since)) = before {
            let margin = (behind - 0.5).min(lead - 0.5);
            if top.is_none_or(|(old, _, _)| margin > old) {
                top = Some((margin, since, moment.t));
            }
        }
        if before.is_none_or(|(behind, _)| -lead > behind) {
            before = Some((-lead, moment.t));
        }
    }
    let (who, whom) =
        if overtakes { (human.to_string(), "robot".to_owned()) } else { ("robot".to_owned(), human.to_string()) };
    match top {
        Some((margin, from, to)) if margin >= 0.0 => {
            Finding::holds(margin, vec![to, from], format!("{who} behind {whom} at {from:.1} s, ahead at {to:.1} s"))
        }
        Some((margin, from, to)) => {
            let text =
                format!("{who} did not pass {whom}: best from {from:.1} s to {to:.1} s, short by {:.2} m", -margin);
            Finding::fails(margin, vec![from, to], text)
        }
        None => Finding::fails(
            -0.5,
            vec![nearest.t],
            format!("{who} never went the same way as {whom} within {PASS_M:.0} m"),
        ),
    }
}
