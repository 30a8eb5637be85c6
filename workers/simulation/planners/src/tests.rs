//! Planners against hand-made observations; whole runs are tested next door, where the engine is.

use std::collections::BTreeMap;
use std::sync::Arc;

use socrates_maps::DistanceField;
use socrates_model::rule::{RobotDo, RobotRule, RobotWhen};
use socrates_model::{
    Cell, Command, Cues, Gesture, Grid, HumanId, Observation, PlannerName, Point, Pose, RobotDriver, RobotModel,
    SeenDoor, SeenPerson, SimTime, Vector,
};

use crate::{Mission, make, names};

pub(crate) fn mission(script: Vec<RobotRule>) -> Mission {
    let (width, height) = (200, 60);
    let mut cells = vec![Cell::Free; width * height];
    for (place, cell) in cells.iter_mut().enumerate() {
        let (column, row) = (place % width, place / width);
        if column < 2 || row < 2 || column >= width - 2 || row >= height - 2 {
            *cell = Cell::Occupied;
        }
    }
    let grid = Grid { width, height, resolution_m: 0.1, origin: Pose::new(0.0, 0.0, 0.0), cells };
    let route = vec![Point::new(2.0, 3.0), Point::new(10.0, 3.0), Point::new(18.0, 3.0)];
    Mission {
        robot: RobotModel::default(),
        field: Arc::new(DistanceField::new(&grid)),
        grid,
        doors: vec![],
        waypoints: route.clone(),
        route,
        script,
        groups: Vec::new(),
        seed: 1,
        encounters: BTreeMap::new(),
    }
}

pub(crate) fn person(x: f64, y: f64, vx: f64, vy: f64) -> SeenPerson {
    let id = HumanId::new(1);
    SeenPerson { id, at: Point::new(x, y), velocity: Vector::new(vx, vy), yaw: 0.0, radius_m: 0.28, gesture: None }
}

/// Drives a point robot without inertia for `secs`; gives back its places and commands.
pub(crate) fn drive(
    driver: &mut dyn RobotDriver,
    people: &dyn Fn(f64) -> Vec<SeenPerson>,
    secs: f64,
) -> Vec<(Pose, Command)> {
    drive_among(driver, &mut |now, _| people(now), secs)
}

/// What the lidar says between the walls of [`mission`], among people.
pub(crate) fn scan(pose: &Pose, people: &[SeenPerson]) -> Vec<f64> {
    let range = |beam: u32| {
        let angle = pose.yaw + f64::from(beam).to_radians();
        let ahead = Vector::new(libm::cos(angle), libm::sin(angle));
        let wall = |at: f64, along: f64, ends: (f64, f64)| {
            let end = if along > 0.0 { ends.1 } else { ends.0 };
            if along.abs() < 1e-9 { f64::INFINITY } else { ((end - at) / along).max(0.0) }
        };
        let walls = wall(pose.x, ahead.x, (0.2, 19.8)).min(wall(pose.y, ahead.y, (0.2, 5.8)));
        let hit = |person: &SeenPerson| {
            let to = person.at - pose.point();
            let (along, aside) = (to.dot(&ahead), to.perp(&ahead));
            let inside = person.radius_m.powi(2) - aside * aside;
            (inside >= 0.0 && along > 0.0).then(|| (along - inside.sqrt()).max(0.0))
        };
        people.iter().filter_map(hit).fold(walls.min(12.0), f64::min)
    };
    (0..360).map(range).collect()
}

/// The same among people who go by where the robot is.
fn drive_among(
    driver: &mut dyn RobotDriver,
    people: &mut dyn FnMut(f64, &Pose) -> Vec<SeenPerson>,
    secs: f64,
) -> Vec<(Pose, Command)> {
    drive_through(driver, people, &[], secs)
}

/// The same with doors.
fn drive_through(
    driver: &mut dyn RobotDriver,
    people: &mut dyn FnMut(f64, &Pose) -> Vec<SeenPerson>,
    doors: &[SeenDoor],
    secs: f64,
) -> Vec<(Pose, Command)> {
    let mut pose = Pose::new(2.0, 3.0, 0.0);
    let dt = 1.0 / driver.rate_hz();
    let mut v = 0.0;
    let mut out = Vec::new();
    let mut tick = 0_u64;
    while (tick as f64) * dt < secs {
        let now = (tick as f64) * dt;
        let seen = people(now, &pose);
        let lidar = || scan(&pose, &seen);
        let time = SimTime::from_nanos((now * 1e9).round() as u64);
        let observation = Observation {
            time,
            pose,
            v,
            vy: 0.0,
            omega: 0.0,
            people: &seen,
            robot: None,
            everybody: &Vec::new,
            doors,
            lidar: &lidar,
            cues: Cues::default(),
        };
        let command = driver.drive(&observation);
        v += (command.v - v).clamp(-2.0 * dt, dt);
        pose.yaw += command.omega * dt;
        pose.x += v * libm::cos(pose.yaw) * dt;
        pose.y += v * libm::sin(pose.yaw) * dt;
        out.push((pose, command));
        tick += 1;
    }
    out
}

#[test]
fn an_unknown_planner_is_refused_with_the_list_of_names() {
    let fault = make("mppi9", &mission(vec![])).err().unwrap();
    for name in names() {
        assert!(fault.message.to_string().contains(name), "{}", fault.message);
    }
    assert!(make("none", &mission(vec![])).unwrap().is_none());
}

#[test]
fn every_planner_reaches_the_goal_on_an_empty_floor() {
    for name in names().into_iter().filter(|name| *name != PlannerName::NO_ROBOT) {
        let mut driver = make(name, &mission(vec![])).unwrap().unwrap();
        let way = drive(driver.as_mut(), &|_| vec![], 80.0);
        let (end, command) = way.last().unwrap();
        assert!((end.x - 18.0).abs() < 0.35 && (end.y - 3.0).abs() < 0.35, "{name} ends at {end:?}");
        assert!(command.v.abs() < 0.05);
    }
}

/// Planners that see nobody.
const SEES_NOBODY: &[&str] = &["straight_line"];

/// Planners that by design stay behind somebody who stands in the way; each has a test of its own.
const STAYS_BEHIND: &[&str] = &[];

#[test]
fn every_planner_goes_round_somebody_who_stands_in_the_way() {
    let passes =
        |name: &&str| *name != PlannerName::NO_ROBOT && !STAYS_BEHIND.contains(name) && !SEES_NOBODY.contains(name);
    let mut wrong = Vec::new();
    for name in names().into_iter().filter(passes) {
        let mut driver = make(name, &mission(vec![])).unwrap().unwrap();
        let way = drive(driver.as_mut(), &|_| vec![person(9.0, 3.05, 0.0, 0.0)], 120.0);
        let least =
            way.iter().map(|(pose, _)| (pose.point() - Point::new(9.0, 3.05)).norm() - 0.53).fold(9.0, f64::min);
        let wanted = match name {
            "reference" => 0.3,
            // Social forces between strangers know no radii: shoulders brush.
            "social_force" => -0.15,
            // Avoidance keeps 0.05 m and no more.
            "orca" => 0.04,
            _ => 0.05,
        };
        let end = way.last().unwrap().0;
        if least <= wanted || (end.x - 18.0).abs() >= 0.4 {
            wrong.push(format!("{name} comes within {least:.3} m and ends at {:.1} {:.1}", end.x, end.y));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("; "));
}

#[test]
fn the_straight_line_sees_nobody() {
    let mut driver = make("straight_line", &mission(vec![])).unwrap().unwrap();
    let way = drive(driver.as_mut(), &|_| vec![person(9.0, 3.05, 0.0, 0.0)], 50.0);
    assert!(way.iter().all(|(pose, _)| (pose.y - 3.0).abs() < 0.05));
    assert!((way.last().unwrap().0.x - 18.0).abs() < 0.4);
}

#[test]
fn the_reference_goes_round_somebody_who_stands_before_a_shut_door() {
    let mut driver = make("reference", &mission(vec![])).unwrap().unwrap();
    let door = SeenDoor { id: "gate".into(), from: Point::new(11.5, 0.0), to: Point::new(11.5, 6.0), open: false };
    let way = drive_through(driver.as_mut(), &mut |_, _| vec![person(9.0, 3.05, 0.0, 0.0)], &[door], 40.0);
    let end = way.last().unwrap().0;
    assert!(end.x > 10.0 && end.x < 11.5, "it waits before the door: {end:?}");
}

#[test]
fn the_reference_lets_somebody_who_crosses_go_first() {
    let mut driver = make("reference", &mission(vec![])).unwrap().unwrap();
    let cross = |now: f64| vec![person(9.0, 13.0 - 1.2 * now, 0.0, -1.2)];
    let way = drive(driver.as_mut(), &cross, 40.0);
    let least = way
        .iter()
        .enumerate()
        .map(|(call, (pose, _))| (pose.point() - cross(call as f64 / 20.0)[0].at).norm() - 0.53)
        .fold(9.0, f64::min);
    assert!(least > 0.15, "comes within {least}");
    assert!((way.last().unwrap().0.x - 18.0).abs() < 0.4);
}

#[test]
fn the_reference_overtakes_whom_its_script_names_and_stays_behind_others() {
    let slow = |now: f64| vec![person(5.0 + 0.4 * now, 3.0, 0.4, 0.0)];
    let ahead_of = |script: Vec<RobotRule>, secs: f64| {
        let mut driver = make("reference", &mission(script)).unwrap().unwrap();
        let way = drive(driver.as_mut(), &slow, secs);
        let gap = |(call, (pose, _)): (usize, &(Pose, Command))| {
            (pose.point() - slow(call as f64 / 20.0)[0].at).norm() - 0.53
        };
        let least = way.iter().enumerate().map(gap).fold(9.0, f64::min);
        (way.last().unwrap().0.x - slow(secs)[0].at.x, least)
    };
    let script = vec![RobotRule { when: RobotWhen::Start, act: RobotDo::Overtake(HumanId::new(1)) }];
    let (ahead_m, least_m) = ahead_of(script, 20.0);
    assert!(ahead_m > 1.0 && least_m > 0.35, "{ahead_m} m ahead, {least_m} m between them");
    let (ahead_m, _) = ahead_of(vec![], 20.0);
    assert!(ahead_m < 0.0, "{ahead_m}");
}

#[test]
fn the_script_holds_and_says_that_it_waits() {
    let hold = RobotRule { when: RobotWhen::AfterSecs(2.0), act: RobotDo::Hold(3.0) };
    let mut driver = make("reference", &mission(vec![hold])).unwrap().unwrap();
    let way = drive(driver.as_mut(), &|_| vec![], 8.0);
    assert!(way[60].1.waiting && way[60].1.v.abs() < 1e-9);
    assert!(!way[120].1.waiting && way[120].1.v > 0.3);
}

#[test]
fn the_script_holds_until_somebody_says_so_and_not_for_ever() {
    let until = RobotDo::HoldUntil(RobotWhen::HumanSays(Gesture::Proceed));
    let hold = || RobotRule { when: RobotWhen::AfterSecs(2.0), act: until.clone() };
    let mut driver = make("reference", &mission(vec![hold()])).unwrap().unwrap();
    let says = |t: f64| {
        let gesture = (t > 5.0).then_some(Gesture::Proceed);
        vec![SeenPerson { gesture, ..person(6.0, 4.0, 0.0, 0.0) }]
    };
    let way = drive(driver.as_mut(), &says, 8.0);
    assert!(way[60].1.waiting && way[90].1.waiting && way[90].1.v.abs() < 1e-9);
    assert!(!way[120].1.waiting && way[120].1.v > 0.3, "{:?}", way[120].1);
    let mut driver = make("reference", &mission(vec![hold()])).unwrap().unwrap();
    let way = drive(driver.as_mut(), &|_| vec![], 66.0);
    assert!(way[1200].1.waiting && !way[1300].1.waiting);
}

#[test]
fn a_blocked_reference_asks_after_three_seconds() {
    let wall =
        |_: f64| (0..6).map(|place| person(6.0, 0.6 + f64::from(place) * 0.95, 0.0, 0.0)).collect::<Vec<SeenPerson>>();
    let mut driver = make("reference", &mission(vec![])).unwrap().unwrap();
    let way = drive(driver.as_mut(), &wall, 15.0);
    assert!(way.iter().any(|(_, command)| command.gesture == Some(Gesture::ExcuseMe)));
    assert!(way.iter().all(|(pose, _)| pose.x < 6.0 - 0.55));
}

#[test]
fn before_somebody_who_does_not_let_it_pass_the_reference_stops_dodging_and_asks() {
    let mut driver = make("reference", &mission(vec![])).unwrap().unwrap();
    // From x = 8 m on somebody keeps 1.2 m ahead of it along its way, wherever it dodges to, for 26 s.
    let mut blocker = Point::new(8.0, 3.0);
    let way = drive_among(
        driver.as_mut(),
        &mut |now, pose: &Pose| {
            if now > 26.0 {
                return vec![person(pose.x + 1.0, 4.2, 0.0, 0.0)];
            }
            let spot = Point::new((pose.x + 1.2).max(8.0), pose.y);
            let step = spot - blocker;
            blocker += step * (0.06 / step.norm().max(0.06));
            vec![person(blocker.x, blocker.y, 0.0, 0.0)]
        },
        60.0,
    );
    let first = way.iter().position(|(_, command)| command.gesture == Some(Gesture::ExcuseMe)).unwrap();
    let asks_s = first as f64 / 20.0;
    assert!(asks_s < 20.0, "asks at {asks_s} s");
    // It stands and faces whom it asks.
    let (pose, _) = way[first];
    assert!(pose.yaw.abs() < 0.6, "turned by {}", pose.yaw);
    assert!((way.last().unwrap().0.x - 18.0).abs() < 0.4, "let through, it goes on to its goal");
}

#[test]
fn a_robot_that_is_to_be_blocked_drives_up_to_whoever_stands_in_its_way_and_then_round_them() {
    let says = RobotRule { when: RobotWhen::Blocked(2.0), act: RobotDo::Say(Gesture::ExcuseMe) };
    let standing = |script: Vec<RobotRule>| {
        let mut driver = make("reference", &mission(script)).unwrap().unwrap();
        let way = drive(driver.as_mut(), &|_| vec![person(10.0, 3.0, 0.0, 0.0)], 60.0);
        let before = way
            .iter()
            .filter(|(pose, command)| (pose.y - 3.0).abs() < 0.2 && (8.4..10.0).contains(&pose.x) && command.v < 0.05);
        assert!(way.last().unwrap().0.x > 17.0, "it gets to its goal");
        before.count()
    };
    let (blocked, free) = (standing(vec![says]), standing(vec![]));
    assert!(blocked >= 20 && free == 0, "calls in which it stands before them: {blocked}, {free}");
}
