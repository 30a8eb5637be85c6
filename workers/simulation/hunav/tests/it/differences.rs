//! What each profile does that others do not: the rows of `DIFFERENCES.md`, one test each.

use crate::common::{Walker, file, hall, hall_with_wall, read, section, shown};
use socrates_hunav::{AgentsFile, Configuration, Inputs, Profile, RobotSpec, configure, simulate};
use socrates_model::{AgentId, AgentState, EventKind, Gesture, Grid, HumanId, Point, Pose, Recording};

/// A run of the agents in `text`, 20 s unless said otherwise.
struct Case {
    text: String,
    robot: Option<RobotSpec>,
    tree: Option<String>,
    grid: Option<Grid>,
    seconds: f64,
}

impl Case {
    fn of(walkers: &[Walker]) -> Self {
        Self { text: file(walkers), robot: None, tree: None, grid: None, seconds: 20.0 }
    }

    fn robot(mut self, x: f64, y: f64, yaw: f64, goals: &[(f64, f64)]) -> Self {
        let goals = goals.iter().map(|(x, y)| Point::new(*x, *y)).collect();
        self.robot = Some(RobotSpec { goals, ..RobotSpec::standing(Pose::new(x, y, yaw)) });
        self
    }

    /// A tree for behavior 7, which takes the first branch that succeeds.
    fn tree(mut self, branches: &str) -> Self {
        self.tree = Some(format!(
            "<root main_tree_to_execute='T'><BehaviorTree ID='T'><Fallback name='f'>{branches}</Fallback></BehaviorTree></root>"
        ));
        self
    }

    fn on(mut self, grid: Grid) -> Self {
        self.grid = Some(grid);
        self
    }

    fn lasting(mut self, seconds: f64) -> Self {
        self.seconds = seconds;
        self
    }

    fn run(&self, profile: Profile) -> Recording {
        let agents = read(&self.text);
        let find = |name: &str| self.tree.clone().filter(|_| name == "LLMBT_0.xml");
        let inputs = Inputs {
            profile,
            robot: self.robot.clone(),
            trees: &find,
            grid: self.grid.as_ref(),
            duration_s: self.seconds,
            ..Inputs::new(&agents, "agents.yaml")
        };
        simulate(&inputs).unwrap_or_else(|problems| panic!("{profile}: {}", shown(&problems)))
    }
}

const WALK: &str = "<Sequence name='w'><Inverter><IsGoalReached agent_id='{id}'/></Inverter>\
                    <RegularNav agent_id='{id}' time_step='{dt}'/></Sequence><UpdateGoal agent_id='{id}'/>";

fn human(number: u32) -> AgentId {
    AgentId::Human(HumanId::new(number))
}

/// Times and names of the leaves of a human.
fn leaves(recording: &Recording, number: u32) -> Vec<(f64, String)> {
    let mut found = Vec::new();
    for event in &recording.events {
        if let EventKind::Leaf { human, leaf } = &event.kind
            && human.number() == number
        {
            found.push((event.time.secs(), leaf.clone()));
        }
    }
    found
}

fn does(recording: &Recording, number: u32, leaf: &str) -> bool {
    leaves(recording, number).iter().any(|(_, name)| name == leaf)
}

fn track(recording: &Recording, number: u32) -> Vec<AgentState> {
    recording.track(human(number)).copied().collect()
}

fn end(recording: &Recording, number: u32) -> AgentState {
    *track(recording, number).last().unwrap()
}

/// Smallest distance between two agents, center to center.
fn nearest(recording: &Recording, a: AgentId, b: AgentId) -> f64 {
    recording.track(a).zip(recording.track(b)).map(|(a, b)| (a.point() - b.point()).norm()).fold(f64::MAX, f64::min)
}

fn surprised(start: (f64, f64, f64), goals: &[(f64, f64)]) -> Walker {
    Walker::new(1, " 3", start, goals)
}

#[test]
fn the_field_of_view_is_narrow_wide_or_all_round() {
    // The robot is right behind somebody who walks away from it.
    let behind = |code: &str| {
        Case::of(&[Walker::new(1, code, (0.0, 0.0, 0.0), &[(9.0, 0.0)])]).robot(-1.5, 0.0, 0.0, &[]).lasting(1.5)
    };
    for profile in [Profile::Native, Profile::Hunav10, Profile::Hunav11] {
        assert!(!does(&behind(" 3").run(profile), 1, "SurprisedNav"), "{profile}");
    }
    let look = format!(
        "<Sequence name='s'><IsRobotVisible agent_id='{{id}}' distance='4.0'/><LookAtRobot agent_id='{{id}}'/></Sequence>{WALK}"
    );
    assert!(does(&behind(" 7").tree(&look).run(Profile::SocratesFork), 1, "LookAtRobot"));
    assert!(!does(&behind(" 7").tree(&look).run(Profile::Native), 1, "LookAtRobot"));
}

#[test]
fn walls_hide_the_robot_in_native_alone() {
    let case = Case::of(&[surprised((0.0, 0.0, 0.0), &[(0.0, 9.0)])])
        .robot(3.0, 1.0, 0.0, &[])
        .on(hall_with_wall(1.5, -9.0, 9.0))
        .lasting(3.0);
    assert!(!does(&case.run(Profile::Native), 1, "SurprisedNav"));
    assert!(does(&case.run(Profile::Hunav10), 1, "SurprisedNav"));
    assert!(does(&case.run(Profile::Hunav11), 1, "SurprisedNav"));
    let open = Case { grid: Some(hall()), ..case };
    assert!(does(&open.run(Profile::Native), 1, "SurprisedNav"));
}

#[test]
fn give_way_gives_way_in_native_alone() {
    let case = Case::of(&[Walker { cyclic: false, ..Walker::new(1, " 7", (0.0, 0.0, 3.1), &[(-9.0, 0.0)]) }])
        .robot(-4.0, 0.0, 0.0, &[(9.0, 0.0)])
        .tree(&format!(
            "<Sequence name='s'><IsRobotNearby agent_id='{{id}}' distance='5.0'/>\
             <GiveWaytoRobot agent_id='{{id}}' time_step='{{dt}}'/></Sequence>{WALK}"
        ));
    let off_line = |recording: &Recording| track(recording, 1).iter().map(|state| state.y.abs()).fold(0.0, f64::max);
    let native = case.run(Profile::Native);
    assert!(off_line(&native) > 0.8, "{}", off_line(&native));
    assert!(nearest(&native, AgentId::Robot, human(1)) > 0.75 - 0.02);
    let fork = case.run(Profile::SocratesFork);
    assert!(does(&fork, 1, "GiveWaytoRobot") && off_line(&fork) < 0.1, "{}", off_line(&fork));
}

#[test]
fn a_robot_that_drives_backwards_along_x_moves_in_native_alone() {
    let case = Case::of(&[Walker::new(1, " 7", (0.0, 3.0, 0.0), &[(9.0, 3.0)])])
        .robot(8.0, -3.0, 3.1, &[(-8.0, -3.0)])
        .tree(&format!(
            "<Sequence name='s'><RobotMoved agent_id='{{id}}'/><LookAtRobot agent_id='{{id}}'/></Sequence>{WALK}"
        ))
        .lasting(3.0);
    assert!(does(&case.run(Profile::Native), 1, "LookAtRobot"));
    assert!(!does(&case.run(Profile::SocratesFork), 1, "LookAtRobot"));
}

#[test]
fn who_feels_the_robot_depends_on_the_profile() {
    // Somebody walks straight at a standing robot.
    let toward = |code: &str| {
        Case::of(&[Walker { cyclic: false, ..Walker::new(1, code, (0.0, 0.05, 0.0), &[(9.0, 0.05)]) }])
            .robot(4.0, 0.0, 3.1, &[])
            .lasting(12.0)
    };
    let gap = |recording: &Recording| nearest(recording, AgentId::Robot, human(1));
    // Regular people feel it everywhere; natively they do not touch it either.
    assert!(gap(&toward(" 1").run(Profile::Hunav10)) > 0.2);
    assert!(gap(&toward(" 1").run(Profile::Native)) > 0.75 - 0.02);
    // With a tree of its own, the fork's people walk through it.
    let walk = toward(" 7").tree(WALK);
    assert!(gap(&walk.run(Profile::SocratesFork)) < 0.2);
    assert!(gap(&walk.run(Profile::Native)) > 0.75 - 0.02);
    // Whoever is scared feels it in 1.1 while not reacting; in 1.0 never.
    let behind_its_back = |code: &str, profile| {
        let walker = Walker { cyclic: false, ..Walker::new(1, code, (0.0, 0.0, 0.0), &[(9.0, 0.0)]) };
        let recording = Case::of(&[walker]).robot(-0.8, 0.3, 0.0, &[]).lasting(0.3).run(profile);
        assert!(!does(&recording, 1, "ScaredNav"), "{profile}");
        end(&recording, 1).y
    };
    assert!(behind_its_back(" 4", Profile::Hunav10).abs() < 1e-12);
    assert!(behind_its_back(&section(4, 0), Profile::Hunav11).abs() > 1e-6);
}

#[test]
fn an_impassive_agent_of_1_0_feels_the_robot_as_one_point() {
    let run = |code: &str| {
        let walker = Walker { cyclic: false, ..Walker::new(1, code, (0.0, 0.05, 0.0), &[(9.0, 0.05)]) };
        Case::of(&[walker]).robot(4.0, 0.0, 3.1, &[]).lasting(10.0).run(Profile::Hunav10)
    };
    // An obstacle point is felt at arm's length only, a person from far off.
    let at_2_m = |recording: &Recording| track(recording, 1).iter().find(|state| state.x > 2.0).unwrap().y - 0.05;
    let (impassive, regular) = (at_2_m(&run(" 2")).abs(), at_2_m(&run(" 1")).abs());
    assert!(impassive < 1e-3 && regular > 10.0 * impassive, "{impassive} {regular}");
}

#[test]
fn turning_is_a_rate_in_native_and_a_step_with_an_overshoot_elsewhere() {
    // The robot drives slowly past the right hand of somebody who looks at it.
    let case = Case::of(&[surprised((0.0, 0.0, 1.0), &[(0.0, 9.0)])]).robot(2.0, 0.2, 0.0, &[]).lasting(4.0);
    let steps = |recording: &Recording| -> Vec<f64> {
        let yaws: Vec<f64> = track(recording, 1).iter().skip(100).map(|state| state.yaw).collect();
        yaws.windows(2).map(|pair| pair[1] - pair[0]).collect()
    };
    let native = steps(&case.run(Profile::Native));
    assert!(native.iter().all(|step| *step <= 1e-12 && *step >= -std::f64::consts::PI * 0.01 - 1e-9));
    assert!(native.iter().rev().take(50).all(|step| step.abs() < 1e-9));
    let upstream = case.run(Profile::Hunav10);
    let target = libm::atan2(0.2, 2.0);
    let lowest = track(&upstream, 1).iter().skip(2).map(|state| state.yaw).fold(f64::MAX, f64::min);
    assert!(lowest < target - 1e-4, "{lowest} never goes past {target}");
    assert!((target - lowest) < std::f64::consts::PI * 0.01);
}

#[test]
fn who_threatens_stands_before_the_robot_natively_and_beside_it_upstream() {
    // Heading 0: before it is +x; with sine and cosine swapped it is +y.
    let case = Case::of(&[Walker::new(1, " 6", (2.0, 1.5, -2.5), &[(-9.0, 0.0)])]).robot(0.0, 0.0, 0.0, &[]);
    let native = end(&case.run(Profile::Native), 1);
    assert!(native.x > 0.9 && native.y.abs() < 0.3, "{} {}", native.x, native.y);
    let last = |profile: Profile| track(&case.run(profile), 1)[1500];
    let upstream = last(Profile::Hunav10);
    assert!(upstream.y > 0.6 && upstream.x.abs() < 0.4, "{} {}", upstream.x, upstream.y);
    let fork = Case::of(&[Walker::new(1, " 7", (2.0, 1.5, -2.5), &[(-9.0, 0.0)])])
        .robot(0.0, 0.0, 0.0, &[])
        .tree("<BlockRobot agent_id='{id}' time_step='{dt}'/>")
        .run(Profile::SocratesFork);
    let fork = end(&fork, 1);
    assert!(fork.x > 1.0 && fork.y.abs() < 0.4, "{} {}", fork.x, fork.y);
}

#[test]
fn timers_of_native_end_at_the_tick_they_name() {
    let case = Case::of(&[Walker { id: 1, ..surprised((0.0, 0.0, 0.0), &[(0.0, 9.0)]) }])
        .robot(2.0, 0.2, 3.1, &[])
        .lasting(40.0);
    let told = leaves(&case.run(Profile::Native), 1);
    let start = told.iter().find(|(_, leaf)| leaf == "SurprisedNav").unwrap().0;
    let over = told.iter().find(|(at, leaf)| *at > start && leaf == "RegularNav").unwrap().0;
    assert!((over - start - 29.99).abs() < 1e-9, "{start} {over}");
    let told = leaves(&case.run(Profile::Hunav10), 1);
    let start = told.iter().find(|(_, leaf)| leaf == "SurprisedNav").unwrap().0;
    let over = told.iter().find(|(at, leaf)| *at > start && leaf == "RegularNav").unwrap().0;
    assert!((over - start - 29.99).abs() < 0.011, "{start} {over}");
}

#[test]
fn fear_starts_over_in_1_0_and_happens_once_in_1_1() {
    let scared = |code: &str| {
        Case::of(&[Walker { speed: 0.0, ..Walker::new(1, code, (0.0, 0.0, 0.0), &[(9.0, 0.0)]) }])
            .robot(2.5, 0.0, 3.1, &[])
            .lasting(60.0)
    };
    let starts = |recording: &Recording| {
        leaves(recording, 1).iter().filter(|(_, leaf)| leaf == "ScaredNav").map(|(at, _)| *at).collect::<Vec<_>>()
    };
    let first = starts(&scared(" 4").run(Profile::Hunav10));
    let second = starts(&scared(&section(4, 0)).run(Profile::Hunav11));
    assert!(first.len() >= second.len(), "{first:?} {second:?}");
    assert!(second.iter().all(|at| *at < 40.1), "{second:?}");
}

#[test]
fn gesture_codes_of_people_differ_in_the_fork() {
    let case = Case::of(&[Walker::new(1, " 7", (0.0, 0.0, 0.0), &[(9.0, 0.0)])])
        .tree(&format!("<Inverter><MakeGesture agent_id='{{id}}' message='3'/></Inverter>{WALK}"))
        .lasting(0.5);
    let gesture = |profile| {
        let recording = case.run(profile);
        let first = recording.events.iter().find(|event| matches!(event.kind, EventKind::Gesture { .. })).unwrap();
        if let EventKind::Gesture { gesture, .. } = &first.kind { *gesture } else { None }
    };
    assert_eq!(gesture(Profile::Native), Some(Gesture::Acknowledged));
    assert_eq!(gesture(Profile::SocratesFork), Some(Gesture::ExcuseMe));
}

#[test]
fn a_gesture_made_as_the_state_changes_is_lost_in_the_fork() {
    // The gesture is made in the one tick in which the agent begins to look at the robot.
    let case = Case::of(&[Walker::new(1, " 7", (0.0, 0.0, 0.0), &[(9.0, 0.0)])])
        .robot(4.0, 1.0, 3.1, &[(-9.0, 1.0)])
        .tree(&format!(
            "<Sequence name='s'><IsRobotNearby agent_id='{{id}}' distance='3.0'/>\
             <Inverter><TimeExpiredCondition seconds='0.015' ts='{{dt}}' only_once='true'/></Inverter>\
             <MakeGesture agent_id='{{id}}' message='1'/><LookAtRobot agent_id='{{id}}'/></Sequence>\
             <Inverter><MakeGesture agent_id='{{id}}' message='0'/></Inverter>{WALK}"
        ))
        .lasting(6.0);
    let waits = |profile| {
        let recording = case.run(profile);
        assert!(does(&recording, 1, "LookAtRobot"), "{profile}");
        recording.events.iter().any(|event| {
            matches!(&event.kind, EventKind::Gesture { gesture: Some(Gesture::Wait), agent: AgentId::Human(_), .. })
        })
    };
    assert!(waits(Profile::Native));
    assert!(!waits(Profile::SocratesFork));
}

#[test]
fn people_walk_through_walls_upstream_and_round_them_natively() {
    let case = Case::of(&[Walker { cyclic: false, ..Walker::new(1, " 1", (-3.0, 0.0, 0.0), &[(3.0, 0.0)]) }])
        .on(hall_with_wall(0.0, -2.5, 2.5));
    let crosses = |recording: &Recording| {
        track(recording, 1).windows(2).any(|pair| pair[0].x < 0.0 && pair[1].x >= 0.0 && pair[0].y.abs() < 2.4)
    };
    let native = case.run(Profile::Native);
    assert!(!crosses(&native) && end(&native, 1).x > 2.5, "{}", end(&native, 1).x);
    let walls = |recording: &Recording| {
        recording
            .events
            .iter()
            .any(|event| matches!(event.kind, EventKind::WallContact { depth_m, .. } if depth_m > 0.02))
    };
    assert!(!walls(&native));
    // Upstream somebody who was told to go there pushes against its one obstacle point, straight ahead.
    let upstream = case.run(Profile::Hunav10);
    assert!(walls(&upstream) || track(&upstream, 1).iter().all(|state| state.y.abs() < 0.5));
}

#[test]
fn two_who_meet_exactly_head_on_pass_each_other_in_native_alone() {
    let case = Case::of(&[
        Walker { cyclic: false, ..Walker::new(1, " 1", (-4.0, 0.0, 0.0), &[(5.0, 0.0)]) },
        Walker { cyclic: false, ..Walker::new(2, " 1", (4.0, 0.0, 3.1), &[(-5.0, 0.0)]) },
    ]);
    let native = case.run(Profile::Native);
    assert!(nearest(&native, human(1), human(2)) > 0.8 - 0.02);
    assert!(end(&native, 1).x > 4.0 && end(&native, 2).x < -4.0);
    let upstream = case.run(Profile::Hunav10);
    assert!(end(&upstream, 1).x < end(&upstream, 2).x, "{} {}", end(&upstream, 1).x, end(&upstream, 2).x);
}

#[test]
fn bodies_overlap_upstream_alone() {
    let walker = Walker { cyclic: false, ..Walker::new(1, " 7", (0.0, 0.05, 0.0), &[(9.0, 0.05)]) };
    let case = Case::of(&[walker]).robot(4.0, 0.0, 3.1, &[]).tree(WALK).lasting(12.0);
    let deepest = |recording: &Recording| 0.75 - nearest(recording, AgentId::Robot, human(1));
    let told = |recording: &Recording| {
        recording.events.iter().any(|event| matches!(event.kind, EventKind::Contact { a: AgentId::Robot, .. }))
    };
    let native = case.run(Profile::Native);
    assert!(deepest(&native) < 0.02 && !told(&native), "{}", deepest(&native));
    let fork = case.run(Profile::SocratesFork);
    assert!(deepest(&fork) > 0.5 && told(&fork), "{}", deepest(&fork));
}

#[test]
fn a_component_that_is_not_a_number_is_taken_as_0() {
    // Two on one spot, and a goal on the spot of the third.
    let case = Case::of(&[
        Walker { group: 1, ..Walker::new(1, " 1", (0.0, 0.0, 0.0), &[(5.0, 0.0)]) },
        Walker { group: 1, ..Walker::new(2, " 1", (0.0, 0.0, 0.0), &[(5.0, 0.0)]) },
        Walker::new(3, " 4", (2.0, 0.0, 0.0), &[(2.0, 0.0)]),
    ])
    .robot(2.0, 0.0, 0.0, &[]);
    for profile in Profile::ALL {
        if profile == Profile::SocratesFork {
            continue;
        }
        let recording = case.run(profile);
        assert!(recording.frames.iter().all(|state| state.x.is_finite() && state.vx.is_finite()), "{profile}");
    }
}

#[test]
fn the_last_goal_stays_on_the_list_in_native_and_the_fork() {
    let once = |code: &str| {
        Case::of(&[Walker { cyclic: false, ..Walker::new(1, code, (0.0, 0.0, 0.0), &[(2.0, 0.0)]) }]).lasting(10.0)
    };
    let reached =
        |recording: &Recording| recording.events.iter().any(|event| matches!(event.kind, EventKind::Node { .. }));
    assert!(!reached(&once(" 1").run(Profile::Native)));
    assert!(!reached(&once(" 7").tree(WALK).run(Profile::SocratesFork)));
    assert!(reached(&once(" 1").run(Profile::Hunav10)));
    let rest = end(&once(" 1").run(Profile::Native), 1);
    assert!((rest.x - 2.0).abs() < 0.45 && rest.speed() < 0.05, "{} {}", rest.x, rest.speed());
}

fn drawn(seed: u64, kind: u8, configuration: u8, mend: bool) -> Vec<socrates_hunav::Parameters> {
    let walkers: Vec<Walker> =
        (1..=200).map(|id| Walker::new(id, &section(kind, configuration), (0.0, 0.0, 0.0), &[(1.0, 0.0)])).collect();
    let agents: AgentsFile = read(&file(&walkers));
    agents.agents.iter().map(|agent| configure(agent, agents.dialect, seed, mend)).collect()
}

#[test]
fn drawn_behaviors_follow_the_seed_and_native_mends_what_cannot_be_meant() {
    for kind in 1..=6 {
        for configuration in [2, 3] {
            let first = drawn(5, kind, configuration, false);
            assert_eq!(first, drawn(5, kind, configuration, false));
            assert_ne!(first, drawn(6, kind, configuration, false));
            for parameters in &first {
                if configuration == 2 {
                    assert!(parameters.goal_force >= 0.5 && parameters.obstacle_force >= 0.5);
                    assert!(parameters.social_force >= 2.0);
                } else {
                    assert!((2.0..5.0).contains(&parameters.goal_force));
                    assert!((8.0..15.0).contains(&parameters.obstacle_force));
                    assert!((2.1..15.0).contains(&parameters.social_force));
                    assert!((25.0..60.0).contains(&parameters.duration_s));
                }
            }
            for parameters in drawn(5, kind, configuration, true) {
                assert!(parameters.duration_s >= 1.0 && parameters.vel_mps > 0.0 && parameters.dist_m >= 0.5);
                assert!(parameters.other_force <= 25.0);
            }
        }
    }
    // Normal durations have a tail below 0: 1 in 260.
    let tail = (0..20).flat_map(|seed| drawn(seed, 5, 2, false)).filter(|parameters| parameters.duration_s < 0.0);
    assert!(tail.count() > 0);
    assert_eq!(Configuration::ALL.len(), 4);
}

#[test]
fn the_mean_of_drawn_behaviors_is_the_stated_one() {
    let mean = |values: Vec<f64>| values.iter().sum::<f64>() / values.len() as f64;
    let all: Vec<_> = (0..20).flat_map(|seed| drawn(seed, 5, 2, false)).collect();
    let duration = mean(all.iter().map(|parameters| parameters.duration_s).collect());
    assert!((duration - 40.0).abs() < 1.0, "{duration}");
    let stop = mean(all.iter().map(|parameters| parameters.dist_m).collect());
    assert!((stop - 1.5).abs() < 0.02, "{stop}");
    let all: Vec<_> = (0..20).flat_map(|seed| drawn(seed, 4, 3, false)).collect();
    let seen = mean(all.iter().map(|parameters| parameters.dist_m).collect());
    assert!((seen - 4.0).abs() < 0.1, "{seen}");
}

#[test]
fn gestures_are_seen_a_tick_later_natively_and_at_once_by_those_after_upstream() {
    // The second agent in the list listens to the first.
    let trees = [
        format!("<Inverter><MakeGesture agent_id='{{id}}' message='1'/></Inverter>{WALK}"),
        format!(
            "<Sequence name='s'><HumanSays agent_id='{{id}}' target_id='WHO' message='1'/><LookAtRobot agent_id='{{id}}'/></Sequence>{WALK}"
        ),
    ];
    let agents = read(&file(&[
        Walker::new(1, " 7", (0.0, 0.0, 0.0), &[(9.0, 0.0)]),
        Walker::new(2, " 8", (0.0, 5.0, 0.0), &[(9.0, 5.0)]),
    ]));
    let first_look = |profile, who: &str| {
        let find = |name: &str| {
            let body = if name == "LLMBT_0.xml" { &trees[0] } else { &trees[1] }.replace("WHO", who);
            name.starts_with("LLMBT").then(|| {
                format!("<root main_tree_to_execute='T'><BehaviorTree ID='T'><Fallback name='f'>{body}</Fallback></BehaviorTree></root>")
            })
        };
        let inputs = Inputs {
            profile,
            trees: &find,
            duration_s: 1.0,
            robot: Some(RobotSpec::standing(Pose::new(3.0, 2.0, 0.0))),
            ..Inputs::new(&agents, "agents.yaml")
        };
        let recording = simulate(&inputs).unwrap_or_else(|problems| panic!("{}", shown(&problems)));
        leaves(&recording, 2).iter().find(|(_, leaf)| leaf == "LookAtRobot").map(|(at, _)| *at)
    };
    // Natively people are numbered from 1, and nobody sees a gesture in the tick it is made in (tick 0).
    assert_eq!(first_look(Profile::Native, "1"), Some(0.01));
    // The fork counts from 0 and starts its trees at tick 1; the gesture shows once the state has settled.
    let fork = first_look(Profile::SocratesFork, "1");
    assert_eq!(fork, None, "1 is the listener itself there");
}

#[test]
fn curiosity_slows_down_with_distance_upstream() {
    let case = Case::of(&[Walker::new(1, " 5", (-6.0, 0.0, 0.0), &[(-9.0, 0.0)])]).robot(0.0, 0.0, 3.1, &[]);
    let speed_at = |recording: &Recording, x: f64| {
        track(recording, 1).iter().find(|state| state.x > x).map_or(0.0, AgentState::speed)
    };
    let upstream = case.run(Profile::Hunav10);
    assert!((speed_at(&upstream, -4.0) - 1.8 * 4.0 / 10.0).abs() < 0.05, "{}", speed_at(&upstream, -4.0));
    let native = case.run(Profile::Native);
    assert!(speed_at(&native, -4.0) > 1.2, "{}", speed_at(&native, -4.0));
    let rest = end(&native, 1);
    assert!((1.2..1.8).contains(&-rest.x) && rest.speed() < 0.05, "{}", rest.x);
}

#[test]
fn who_is_scared_gets_away_natively_and_is_pulled_in_at_contact_upstream() {
    let case = |x: f64| {
        Case::of(&[Walker::new(1, " 4", (x, 0.0, 3.1), &[(-9.0, 0.0)])]).robot(0.0, 0.0, 0.0, &[]).lasting(2.0)
    };
    let native = case(1.5).run(Profile::Native);
    assert!(end(&native, 1).point().coords.norm() > 2.0, "{}", end(&native, 1).point());
    // Nearer than its radius the denominator is negative: the force points to the robot.
    let upstream = case(0.3).run(Profile::Hunav10);
    assert!(track(&upstream, 1)[20].x < 0.3, "{}", track(&upstream, 1)[20].x);
}

#[test]
fn somebody_at_rest_looks_along_x_upstream_and_keeps_the_heading_natively() {
    let case = Case::of(&[Walker { speed: 0.0, ..Walker::new(1, " 1", (0.0, 0.0, 2.0), &[(5.0, 0.0)]) }]).lasting(1.0);
    assert!((end(&case.run(Profile::Native), 1).yaw - 2.0).abs() < 1e-12);
    assert!(end(&case.run(Profile::Hunav10), 1).yaw.abs() < 1e-12);
}

#[test]
fn turning_steps_are_0_04_in_2_0() {
    let text = file(&[surprised((0.0, 0.0, -2.0), &[(0.0, 9.0)])]);
    let agents = read(&text).converted(socrates_hunav::Dialect::V2_0).0;
    let tree = "<root BTCPP_format='4' main_tree_to_execute='T'><BehaviorTree ID='T'>\
                <SurprisedNav agent_id='{id}' time_step='{dt}'/></BehaviorTree></root>";
    let find = |name: &str| name.ends_with("_bt.xml").then(|| tree.to_owned());
    let inputs = Inputs {
        profile: Profile::Hunav20,
        trees: &find,
        duration_s: 0.3,
        robot: Some(RobotSpec::standing(Pose::new(2.0, 0.0, 0.0))),
        ..Inputs::new(&agents, "agents.yaml")
    };
    let recording = simulate(&inputs).unwrap_or_else(|problems| panic!("{}", shown(&problems)));
    let yaws: Vec<f64> = track(&recording, 1).iter().map(|state| state.yaw).collect();
    assert!((yaws[10] - yaws[9] - 0.04).abs() < 1e-12, "{yaws:?}");
}

#[test]
fn every_row_of_the_page_names_a_test_and_every_test_has_a_row() {
    let page = include_str!("../../DIFFERENCES.md");
    let source = include_str!("differences.rs");
    let tests: Vec<&str> = source
        .split("#[test]\nfn ")
        .skip(1)
        .filter_map(|rest| rest.split_once('(').map(|(name, _)| name))
        .filter(|name| !name.starts_with("every_row_of_the_page") && !name.contains("mean_of_drawn"))
        .collect();
    assert!(tests.len() > 15);
    for name in &tests {
        assert!(page.contains(&format!("`{name}`")), "`{name}` has no row");
    }
    for row in
        page.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| what") && !line.starts_with("| ---"))
    {
        let cell = row.trim_end_matches('|').rsplit('|').next().unwrap().trim();
        let name = cell.trim_matches('`');
        assert!(tests.contains(&name), "the row names `{name}`, which is no test: {row}");
    }
}
