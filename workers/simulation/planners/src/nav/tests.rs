//! The stack in the world of the planners' tests, and among posts.

use std::sync::Arc;

use socrates_maps::DistanceField;
use socrates_model::{Cell, Command, Cues, HumanId, Observation, Point, Pose, RobotDriver as _, SeenPerson, SimTime};

use super::*;
use crate::Mission;
use crate::costmap::fixture::Chance;
use crate::costmap::{LayerParams, OraclePeopleParams, UpoSocialParams};
use crate::navfn::PlanError;
use crate::rpp::{RegulatedPurePursuit, RppParams};
use crate::tests::{drive, mission, person, scan};

fn stack(params: StackParams, mission: &Mission) -> Stack {
    let period_s = 1.0 / params.controller_frequency;
    let rpp = RppParams { period_s, robot_radius: params.robot_radius, ..RppParams::default() };
    Stack::new(params, mission, Box::new(RegulatedPurePursuit::new(&rpp)))
}

fn shipped(mission: &Mission) -> StackParams {
    StackParams::shipped(&mission.robot)
}

/// Smallest distance between the surfaces of the robot and of somebody who stands, m.
fn least_m(way: &[(Pose, Command)], stands: &SeenPerson) -> f64 {
    way.iter().map(|(pose, _)| (pose.point() - stands.at).norm() - 0.53).fold(9.0, f64::min)
}

#[test]
fn the_setup_of_the_paper_goes_through_its_waypoints_at_half_a_meter_a_second() {
    let mut task = mission(vec![]);
    task.waypoints = vec![Point::new(2.0, 3.0), Point::new(6.0, 4.5), Point::new(10.0, 2.0)];
    let mut stack = stack(StackParams::default(), &task);
    assert!((stack.rate_hz() - 30.0).abs() < 1e-12);
    let way = drive(&mut stack, &|_| vec![], 35.0);
    for point in &task.waypoints {
        let near = way.iter().map(|(pose, _)| (pose.point() - point).norm()).fold(9.0, f64::min);
        assert!(near < 0.26, "{point} passed at {near} m");
    }
    let fastest = way.iter().map(|(_, command)| command.v).fold(0.0, f64::max);
    assert!((0.45..=0.5).contains(&fastest), "{fastest} m/s");
    let (end, command) = way.last().unwrap();
    assert!((end.point() - Point::new(10.0, 2.0)).norm() < 0.3 && command.waiting, "{end:?}, {command:?}");
    assert_eq!((stack.waypoints().index(), stack.waypoints().missed().len()), (3, 0));
    assert_eq!(stack.errors().last(), None);
}

#[test]
fn it_pauses_at_a_waypoint() {
    let mut task = mission(vec![]);
    task.waypoints = vec![Point::new(2.0, 3.0), Point::new(4.0, 3.0), Point::new(6.0, 3.0)];
    let mut stack = stack(shipped(&task), &task);
    let way = drive(&mut stack, &|_| vec![], 30.0);
    let pauses = way.iter().filter(|(pose, command)| command.waiting && (pose.x - 4.0).abs() < 0.5).count();
    assert!((4..=5).contains(&pauses), "{pauses} calls of 0.05 s");
}

#[test]
fn people_are_seen_by_lidar_alone_unless_a_layer_is_about_them() {
    let task = mission(vec![]);
    let stands = person(9.0, 3.05, 0.0, 0.0);
    let run = |params: StackParams, lidar: bool| {
        let mut stack = stack(params, &task);
        let mut pose = Pose::new(2.0, 3.0, 0.0);
        let (mut least, mut v) = (9.0_f64, 0.0);
        for call in 0..800_u64 {
            let seen = [stands];
            let ranges = || scan(&pose, if lidar { &seen } else { &[] });
            let command = stack.drive(&Observation {
                time: SimTime::from_nanos(call * 50_000_000),
                pose,
                v,
                vy: 0.0,
                omega: 0.0,
                people: &seen,
                robot: None,
                everybody: &Vec::new,
                doors: &[],
                lidar: &ranges,
                cues: Cues::default(),
            });
            v = command.v;
            pose.yaw += command.omega * 0.05;
            pose.x += command.v * libm::cos(pose.yaw) * 0.05;
            pose.y += command.v * libm::sin(pose.yaw) * 0.05;
            least = least.min((pose.point() - stands.at).norm() - 0.53);
        }
        least
    };
    assert!(run(shipped(&task), true) > 0.05);
    assert!(run(shipped(&task), false) < 0.0, "somebody whom the lidar does not see is not seen");
    let mut oracle = shipped(&task);
    for costmap in [&mut oracle.global_costmap, &mut oracle.local_costmap] {
        costmap.layers.insert(1, LayerParams::OraclePeople(OraclePeopleParams::default()));
    }
    assert!(run(oracle, false) > 0.05);
}

#[test]
fn a_social_layer_gives_people_a_wider_berth() {
    let task = mission(vec![]);
    let stands = person(9.0, 3.05, 0.0, 0.0);
    let run = |params: StackParams| {
        let way = drive(&mut stack(params, &task), &|_| vec![stands], 75.0);
        assert!((way.last().unwrap().0.x - 18.0).abs() < 0.4, "{:?}", way.last());
        least_m(&way, &stands)
    };
    let paper = || StackParams::default().with_robot(&task.robot);
    let plain = run(paper());
    let mut social = paper();
    for costmap in [&mut social.global_costmap, &mut social.local_costmap] {
        costmap.layers.push(LayerParams::UpoSocial(UpoSocialParams::example()));
    }
    let social = run(social);
    assert!(social > plain + 0.3, "{social} m with the layer, {plain} m without");
}

/// The lidar marks and clears all over the floor: else what is between both ranges is forgotten, and it looks there again.
fn far_seeing(mission: &Mission) -> StackParams {
    let mut params = shipped(mission);
    for layer in params.global_costmap.layers.iter_mut().chain(&mut params.local_costmap.layers) {
        if let LayerParams::Obstacle(obstacle) = layer {
            (obstacle.obstacle_max_range, obstacle.raytrace_max_range) = (8.0, 8.0);
        }
    }
    params
}

/// People across the whole floor, until they leave.
fn wall(until_s: f64) -> impl Fn(f64) -> Vec<SeenPerson> {
    move |now_s: f64| {
        let people = (0..11).map(|place| person(9.0, 0.4 + 0.52 * f64::from(place), 0.0, 0.0));
        if now_s < until_s { people.collect() } else { vec![] }
    }
}

#[test]
fn where_no_way_leads_it_recovers_and_goes_on_when_the_way_is_free() {
    let task = mission(vec![]);
    let mut stack = stack(far_seeing(&task), &task);
    let way = drive(&mut stack, &wall(18.0), 75.0);
    let before = way.iter().take(18 * 20).map(|(pose, _)| pose.x).fold(0.0, f64::max);
    assert!(before < 9.0 - 0.53, "{before}");
    assert!((way.last().unwrap().0.x - 18.0).abs() < 0.4, "{:?}, {:?}", way.last(), stack.errors());
    let counts = stack.errors().counts();
    assert!(counts.contains_key(&NavError::Plan(PlanError::NoValidPath)), "{counts:?}");
    assert!(way.iter().any(|(_, command)| command.v.abs() < 0.01 && command.omega > 0.9), "it spins");
}

#[test]
fn a_waypoint_behind_a_wall_of_people_is_given_up_after_six_recoveries() {
    let task = mission(vec![]);
    let mut stack = stack(far_seeing(&task), &task);
    drive(&mut stack, &wall(1000.0), 200.0);
    // Both the middle waypoint and the last are beyond the people.
    assert_eq!((stack.waypoints().missed(), stack.waypoints().goal()), ([1, 2].as_slice(), None));
    assert_eq!(stack.errors().last(), Some(NavError::GivenUp));
    assert_eq!(stack.errors().counts().get(&NavError::GivenUp), Some(&2));
    assert_eq!(stack.errors().last().map(NavError::code), Some(9002));
}

#[test]
fn a_robot_that_is_held_makes_no_progress() {
    let task = mission(vec![]);
    let mut stack = stack(shipped(&task), &task);
    let pose = Pose::new(2.0, 3.0, 0.0);
    let lidar = || scan(&pose, &[]);
    for call in 0..240_u64 {
        let time = SimTime::from_nanos(call * 50_000_000);
        let cues = Cues::default();
        let seen = Observation {
            time,
            pose,
            v: 0.0,
            vy: 0.0,
            omega: 0.0,
            people: &[],
            robot: None,
            everybody: &Vec::new,
            doors: &[],
            lidar: &lidar,
            cues,
        };
        stack.drive(&seen);
        // The ten seconds begin after the pause at the start.
        let error = stack.errors().last();
        assert!(error.is_none() || error == Some(NavError::FailedToMakeProgress) && call > 200, "{error:?} at {call}");
    }
    assert_eq!(stack.errors().counts().get(&NavError::FailedToMakeProgress), Some(&1));
}

#[test]
fn the_same_run_twice_gives_the_same_commands() {
    let task = mission(vec![]);
    let run = || {
        let walks = |now: f64| vec![person(14.0 - 0.8 * now, 3.1, -0.8, 0.0), person(9.0, 2.5, 0.0, 0.0)];
        drive(&mut stack(shipped(&task), &task), &walks, 30.0)
    };
    let (first, second) = (run(), run());
    assert!(first.iter().zip(&second).all(|(a, b)| a.0 == b.0 && a.1 == b.1));
}

/// A room of 10 m with posts of 0.2 m, free at two corners.
fn among_posts(seed: u64) -> Mission {
    let mut task = mission(vec![]);
    let side = 200_usize;
    let mut chance = Chance::new(seed);
    let mut cells = vec![Cell::Free; side * side];
    for place in 0..side {
        for wall in [place, place * side, place * side + side - 1, (side - 1) * side + place] {
            cells[wall] = Cell::Occupied;
        }
    }
    for _ in 0..12 {
        let (column, row) = (10 + chance.below(176) as usize, 10 + chance.below(176) as usize);
        // Rows come from the top: the robot starts at the lower left.
        if (column < 40 && row > 150) || (column > 150 && row < 40) {
            continue;
        }
        (0..4).for_each(|up| cells[(row + up) * side + column..(row + up) * side + column + 4].fill(Cell::Occupied));
    }
    task.grid.width = side;
    task.grid.height = side;
    task.grid.resolution_m = 0.05;
    task.grid.cells = cells;
    task.field = Arc::new(DistanceField::new(&task.grid));
    task.waypoints = vec![Point::new(1.0, 1.0), Point::new(9.0, 9.0)];
    task
}

#[test]
fn among_posts_it_reaches_its_goal_and_touches_none() {
    for seed in 0..12 {
        let task = among_posts(seed);
        let mut stack = stack(shipped(&task), &task);
        let (mut pose, mut v, mut omega, mut least) = (Pose::new(1.0, 1.0, 0.0), 0.0_f64, 0.0_f64, 9.0_f64);
        for call in 0..1200_u64 {
            let field = &task.field;
            let range = |beam: u32| {
                let angle = pose.yaw + f64::from(beam).to_radians();
                let mut gone = 0.0;
                while gone < 12.0 {
                    let free = field.clearance(&Point::new(pose.x + gone * angle.cos(), pose.y + gone * angle.sin()));
                    if free < 0.005 {
                        return gone;
                    }
                    gone += free;
                }
                12.0
            };
            let lidar = || (0..360).map(range).collect();
            let time = SimTime::from_nanos(call * 50_000_000);
            let cues = Cues::default();
            let seen = Observation {
                time,
                pose,
                v,
                vy: 0.0,
                omega,
                people: &[],
                robot: None,
                everybody: &Vec::new,
                doors: &[],
                lidar: &lidar,
                cues,
            };
            let command = stack.drive(&seen);
            v += (command.v - v).clamp(-0.05, 0.05);
            omega = command.omega;
            pose.yaw += omega * 0.05;
            pose.x += v * libm::cos(pose.yaw) * 0.05;
            pose.y += v * libm::sin(pose.yaw) * 0.05;
            least = least.min(field.clearance(&pose.point()) - task.robot.radius_m);
            if stack.waypoints().goal().is_none() {
                break;
            }
        }
        let errors = stack.errors();
        assert!((pose.point() - Point::new(9.0, 9.0)).norm() < 0.3, "seed {seed}: ends at {pose:?}, {errors:?}");
        assert!(least > 0.0, "seed {seed}: {least} m from a post");
    }
}

#[test]
fn among_people_who_walk_up_and_down_it_reaches_its_goal() {
    let task = mission(vec![]);
    for seed in 0..4 {
        let mut chance = Chance::new(seed);
        let mut walker = || (20.0 * chance.share(), 0.8 + 4.4 * chance.share(), 0.6 + 0.6 * chance.share());
        let walkers: Vec<(f64, f64, f64)> = (0..6).map(|_| walker()).collect();
        let people = |now: f64| -> Vec<SeenPerson> {
            let walk = |(number, (from, y, speed)): (u32, &(f64, f64, f64))| {
                let gone = (from + speed * now) % 36.0;
                let (x, speed) = if gone < 18.0 { (1.0 + gone, *speed) } else { (37.0 - gone, -speed) };
                SeenPerson { id: HumanId::new(number), ..person(x, *y, speed, 0.0) }
            };
            (1..).zip(&walkers).map(walk).collect()
        };
        let mut stack = stack(shipped(&task), &task);
        drive(&mut stack, &people, 80.0);
        assert_eq!((stack.waypoints().goal(), stack.waypoints().missed()), (None, [].as_slice()), "seed {seed}");
    }
}
