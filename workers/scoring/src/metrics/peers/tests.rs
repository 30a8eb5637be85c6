//! What other tools' names give, and what their code would have given.

use std::f64::consts::{FRAC_PI_4, PI, TAU};

use socrates_model::geometry::wrap_angle;
use socrates_model::{AgentId, EventKind, Recording, Vector};

use super::*;
use crate::evidence::Evidence;
use crate::fixture::{Walk, event, recording};
use crate::metrics::tests::{at_both_rates, value, value_of};
use crate::metrics::{sheet, sheets};

fn robot(run: &Recording) -> Vec<(f64, f64, f64)> {
    run.frames.iter().filter(|state| state.agent == AgentId::Robot.number()).map(|s| (s.x, s.y, s.yaw)).collect()
}

/// Path length as Arena's evaluation has it: pairs by rolling the list and cutting as many as the group is long off the
/// end, positions with the yaw as their third coordinate.
fn arena_path_length(run: &Recording, with_yaw: bool) -> f64 {
    let poses = robot(run);
    let rolled = poses.iter().cycle().skip(poses.len() - 1).take(poses.len());
    let pairs: Vec<_> = poses.iter().zip(rolled).collect();
    let step = |(a, b): &(&(f64, f64, f64), &(f64, f64, f64))| {
        let turn = if with_yaw { a.2 - b.2 } else { 0.0 };
        ((a.0 - b.0).powi(2) + (a.1 - b.1).powi(2) + turn.powi(2)).sqrt()
    };
    pairs[..pairs.len() - 2].iter().map(step).sum()
}

#[test]
fn every_name_is_a_metric_of_the_catalog_and_none_is_given_twice() {
    let spaces = ["sean.", "socnavbench.", "arena.", "crowdnav.", "socnavgym."];
    let mut all: Vec<&str> = NAMES.iter().map(|one| one.name).chain(sheets().map(|sheet| sheet.id)).collect();
    for one in NAMES {
        assert!(sheet(one.ours).is_some(), "{} is {}, which is no metric", one.name, one.ours);
        assert!(spaces.iter().any(|space| one.name.starts_with(space)), "{}", one.name);
        assert_eq!(ours(&one.name.to_lowercase()), Some(one));
    }
    for space in spaces {
        assert!(all.iter().filter(|name| name.starts_with(space)).count() >= 6, "{space}");
    }
    all.sort_unstable();
    let count = all.len();
    all.dedup();
    assert_eq!(all.len(), count);
    assert_eq!(ours("sean.mean_dist_to_target_not_moving"), None);
}

#[test]
fn names_have_the_values_and_the_reasons_of_ours() {
    let run = recording(&[Walk::robot(0., 0., 0.5, 0.)], 4.0, 0.1);
    let tracks = crate::tracks::Tracks::read(&run).unwrap();
    let evidence = Evidence::of(&run);
    let signals = crate::fidelity::Signals::new(&evidence, &tracks);
    let values = crate::metrics::measure(&crate::metrics::Scene::new(&signals));
    let found = named(&values);
    assert_eq!(found.len(), NAMES.len());
    let of = |id: &str| found.iter().find(|value| value.id == id).unwrap();
    assert_eq!(of("socnavgym.PATH_LENGTH").value, Some(2.0));
    let nobody = of("socnavgym.MINIMUM_DISTANCE_TO_HUMAN");
    assert!(nobody.value.is_none() && nobody.note.contains("no human"), "{nobody:?}");
}

#[test]
fn seans_goal_is_larger_and_its_standing_is_a_second_on_one_spot() {
    let goal = Some(Point::new(6., 0.));
    let stops = [(0., 0., 0.), (5., 5., 0.), (1000., 5., 0.)];
    let run = recording(&[Walk::through(AgentId::Robot, &stops)], 12.0, 0.1);
    let evidence = Evidence { goal, ..Evidence::of(&run) };
    assert_eq!(value_of(&evidence, "sean.completed"), Some(1.0));
    assert_eq!(value_of(&evidence, "arrived"), Some(0.0));
    assert!((value_of(&evidence, "sean.targ_dist_norm").unwrap() - 1.0 / 6.0).abs() < 1e-6);
    let short = Evidence { goal: Some(Point::new(6.3, 0.)), ..evidence };
    assert_eq!(value_of(&short, "sean.completed"), Some(0.0));
    // It stands from 5 s on; less than 0.05 m in a second since 5.95 s.
    let walks = || vec![Walk::through(AgentId::Robot, &stops)];
    at_both_rates(&walks, 12.0, "sean.time_not_moving", 12.0 - 5.95, 1e-6);
    at_both_rates(&walks, 12.0, "socnavbench.total_sim_time_taken", 12.0, 1e-9);
}

#[test]
fn arenas_personal_space_is_a_meter_between_centers_and_its_speed_is_that_of_the_robot() {
    // Past somebody at 0.6 m at 0.5 m/s: 1.6 m of way.
    let walks = || vec![Walk::robot(-4., 0.6, 0.5, 0.), Walk::human(1, 0., 0., 0., 0.)];
    at_both_rates(&walks, 16.0, "arena.total_time_in_personal_space", 1.6 / 0.5, 0.01);
    at_both_rates(&walks, 16.0, "arena.avg_velocity_in_personal_space", 0.5, 1e-6);
    let far = recording(&[Walk::robot(-4., 3., 0.5, 0.), Walk::human(1, 0., 0., 0., 0.)], 16.0, 0.1);
    assert_eq!(value(&far, "arena.total_time_in_personal_space"), Some(0.0));
    assert_eq!(value(&far, "arena.avg_velocity_in_personal_space"), None);
}

#[test]
fn crowdnavs_reward_is_one_for_the_goal_less_the_discomfort_and_a_quarter_off_for_a_contact() {
    // 0.1 m between surfaces for 4 s beside somebody, then to the goal.
    let walk = |y: f64| Walk::through(AgentId::Robot, &[(0., 0., y), (4., 0., y), (10., 6., y)]);
    let rewarded = |y: f64| {
        let mut run = recording(&[walk(y), Walk::human(1, 0., 0., 0., 0.)], 10.0, 0.1);
        event(&mut run, 10.0, EventKind::RobotArrived);
        [value(&run, "crowdnav.reward").unwrap(), value(&run, "crowdnav.collision").unwrap()]
    };
    let [reward, touched] = rewarded(0.63);
    // The way out of 0.2 m adds a little.
    let out = 0.5 * 0.1 * (0.73_f64.powi(2) - 0.63_f64.powi(2)).sqrt();
    assert!((reward - (1.0 - 0.5 * 0.1 * 4.0)).abs() <= out && reward < 0.8 && touched < 0.5, "{reward}");
    let [reward, touched] = rewarded(0.3);
    assert!(touched > 0.5 && (reward - (-0.25 - 0.5 * 0.2 * 4.0)).abs() < 0.06, "{reward}");
}

#[test]
fn arena_counts_the_way_from_the_last_to_the_first_and_drops_two_steps() {
    // A straight path of 10 m in 11 poses: 10 m back, and 8 of 10 steps.
    let run = recording(&[Walk::robot(0., 0., 1., 0.)], 10.0, 1.0);
    assert!((arena_path_length(&run, false) - 18.0).abs() < 1e-9);
    assert!((value(&run, "path_length").unwrap() - 10.0).abs() < 1e-6);
}

#[test]
fn arena_takes_yaw_for_a_third_coordinate_of_the_path() {
    let mut run = recording(&[Walk::robot(2., 1., 0., 0.)], 10.0, 0.1);
    for state in run.frames.iter_mut() {
        state.yaw = state.tick as f64 * 0.02;
    }
    assert!(arena_path_length(&run, true) > 3.0);
    assert_eq!(value(&run, "path_length"), Some(0.0));
}

#[test]
fn arena_takes_the_place_for_the_velocity() {
    let run = recording(&[Walk::circle(2.0, 20.0)], 19.9, 0.1);
    let theirs: Vec<f64> = robot(&run).iter().map(|(x, y, _)| x.hypot(*y)).collect();
    assert!(theirs.iter().all(|speed| (speed - 2.0).abs() < 1e-3), "the radius, whatever the speed");
    assert!((value(&run, "robot_speed_mean").unwrap() - TAU * 2.0 / 20.0).abs() < 0.01);
}

#[test]
fn arena_counts_tens_of_seconds_against_nanoseconds_and_never_times_out() {
    let run = recording(&[Walk::robot(0., 0., 0.1, 0.)], 200.0, 1.0);
    let (time, limit) = (200.0 * 1e9 / 1e10, 180e9);
    assert!(time < limit, "so that reaching the goal, its default, is the result");
    let evidence = Evidence { goal: Some(Point::new(90., 0.)), ..Evidence::of(&run) };
    assert_eq!(value_of(&evidence, "timeout"), Some(1.0));
    assert_eq!(value_of(&evidence, "time_to_goal"), None);
}

#[test]
fn arena_mirrors_the_bearing_of_who_looks_at_the_robot() {
    // The robot at the origin, a person at 45° of it who faces it.
    let run =
        recording(&[Walk::robot(0., 0., 0., 0.), Walk::human(1, 2., 2., 0., 0.).facing(-3.0 * FRAC_PI_4)], 4.0, 0.1);
    let angle = Vector::new(2., 2.);
    let angle = angle.y.atan2(angle.x);
    let off = |bearing: f64| wrap_angle(-3.0 * FRAC_PI_4 - bearing).abs();
    assert!(off(PI - angle) > 1.5 && off(angle + PI) < 1e-9);
    assert!((value(&run, "time_watched").unwrap() - 4.0).abs() < 1e-6);
}

#[test]
fn a_mean_over_successes_alone_prefers_the_run_that_fails_where_it_is_slow() {
    // Two runs of each: one planner arrives after 10 and 30 s, the other after 10 s and never.
    let goal = Some(Point::new(9., 0.));
    let time = |speed: f64, seconds: f64| {
        let run = recording(&[Walk::robot(0., 0., speed, 0.)], seconds, 0.1);
        value_of(&Evidence { goal, ..Evidence::of(&run) }, "time_to_goal")
    };
    let (quick, slow, never) = (time(0.85, 12.0), time(0.8 / 2.8, 32.0), time(0.0, 32.0));
    let mean = |times: &[Option<f64>]| {
        let had: Vec<f64> = times.iter().flatten().copied().collect();
        had.iter().sum::<f64>() / had.len() as f64
    };
    assert!(mean(&[quick, never]) < mean(&[quick, slow]), "the one that fails looks faster");
    assert!(slow.is_some() && never.is_none(), "ours says that there is none, and tables count it apart");
}

#[test]
fn socnav3_takes_a_robot_for_larger_where_it_foresees_contacts_than_where_it_measures() {
    // A square of 0.5 m: half the diagonal in times to collision, half the length in distances.
    let foreseen = 0.5_f64.hypot(0.5) / 2.0;
    let run = recording(&[Walk::robot(0., 0., 0.5, 0.), Walk::human(1, 4., 0., 0., 0.)], 4.0, 0.1);
    let (ours, distance) = (value(&run, "fear_max").unwrap(), value(&run, "human_distance_min").unwrap());
    assert!((1.0 / ours - distance / 0.5).abs() < 1e-3, "one radius in both");
    let theirs = 0.5 / (4.0 - 2.0 - 0.3 - foreseen);
    assert!(theirs > ours * 1.05, "{theirs} {ours}");
}
