//! What holds in every native run: nobody goes through a wall, a person or the robot, everything is finite, and the same
//! seed gives the same bytes.

use std::collections::BTreeMap;

use crate::common::{Walker, file, read, section, shown};
use socrates_engine::Floor;
use socrates_hunav::{Inputs, Profile, RobotSpec, simulate};
use socrates_maps::shipped;
use socrates_model::seeds::SplitMix64;
use socrates_model::{Grid, Point, Pose, Recording};

/// Largest overlap of two bodies, m.
const OVERLAP_M: f64 = 0.005;
/// Largest depth of a body in a wall, m.
const WALL_M: f64 = 0.005;

/// Whole numbers below n.
struct Draw(SplitMix64);

impl Draw {
    fn below(&mut self, n: usize) -> usize {
        self.0.below(n.max(1))
    }

    fn real(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * (self.below(1_000_000) as f64) / 1e6
    }
}

/// A free spot of the map with this clearance, apart from those taken.
fn spot(draw: &mut Draw, grid: &Grid, floor: &Floor, taken: &[Point]) -> (f64, f64) {
    loop {
        let at = grid.world_from_pixel(draw.real(0.0, grid.width as f64), draw.real(0.0, grid.height as f64));
        let at = Point::new((at.x * 1e3).round() / 1e3, (at.y * 1e3).round() / 1e3);
        if floor.clearance_m(&at) > 0.45 && taken.iter().all(|other| (other - at).norm() > 0.9) {
            return (at.x, at.y);
        }
    }
}

/// Random agents, and a robot that drives, on a shipped map.
fn random(map: &str, seed: u64, people: usize, seconds: f64) -> (Recording, Grid) {
    let grid = shipped::load(map).unwrap().grid;
    let floor = Floor::new(&grid);
    let mut draw = Draw(SplitMix64::new(seed));
    let mut taken: Vec<Point> = Vec::new();
    let mut walkers = Vec::new();
    for id in 1..=people {
        let (x, y) = spot(&mut draw, &grid, &floor, &taken);
        taken.push(Point::new(x, y));
        let goals: Vec<(f64, f64)> = (0..=draw.below(3)).map(|_| spot(&mut draw, &grid, &floor, &[])).collect();
        let kind = u8::try_from(1 + draw.below(6)).unwrap();
        let configuration = u8::try_from(draw.below(4)).unwrap();
        walkers.push(Walker {
            group: if draw.below(4) == 0 { 1 } else { -1 },
            speed: draw.real(0.6, 1.8),
            cyclic: draw.below(2) == 0,
            ..Walker::new(
                i64::try_from(id).unwrap(),
                &section(kind, configuration),
                (x, y, draw.real(-3.0, 3.0)),
                &goals,
            )
        });
    }
    let start = spot(&mut draw, &grid, &floor, &taken);
    let location = shipped::load(map).unwrap();
    let nearest = |(x, y): (f64, f64)| {
        let at = Point::new(x, y);
        let nodes = location.graph.nodes().iter().map(|node| node.at);
        nodes.min_by(|a, b| (a - at).norm().total_cmp(&(b - at).norm())).unwrap()
    };
    // A robot without a planner drives straight: its points are the corners of a way.
    let to = nearest(spot(&mut draw, &grid, &floor, &[]));
    let way = floor.way(&Point::new(start.0, start.1), &to, 0.4);
    let goals = way.map_or_else(Vec::new, |way| way.points().to_vec());
    let robot = RobotSpec { goals, ..RobotSpec::standing(Pose::new(start.0, start.1, 0.0)) };
    let agents = read(&file(&walkers));
    let inputs = Inputs {
        grid: Some(&grid),
        robot: Some(robot),
        seed,
        duration_s: seconds,
        ..Inputs::new(&agents, "agents.yaml")
    };
    let recording = simulate(&inputs).unwrap_or_else(|problems| panic!("{map} {seed}: {}", shown(&problems)));
    (recording, grid)
}

/// Deepest overlap of two agents and of an agent with a wall, and the largest step through a wall.
fn worst(recording: &Recording, grid: &Grid) -> (f64, f64) {
    let floor = Floor::new(grid);
    let radii: BTreeMap<u32, f64> =
        recording.header.agents.iter().map(|info| (info.agent.number(), info.radius_m)).collect();
    let (mut overlap, mut wall) = (0.0_f64, 0.0_f64);
    // The first half second is for those who start too close to each other.
    for tick in 50..recording.ticks() {
        let states = recording.tick(tick);
        for (number, state) in states.iter().enumerate() {
            assert!(state.x.is_finite() && state.y.is_finite() && state.vx.is_finite() && state.vy.is_finite());
            assert!(state.yaw.is_finite() && state.omega.is_finite());
            let before = &recording.tick(tick - 1)[number];
            assert!((state.point() - before.point()).norm() < 0.3, "{} jumps at {tick}", state.agent);
            // People keep out of walls; the robot drives as it was told.
            if state.agent > 0 {
                assert!(floor.sees(&before.point(), &state.point()), "{} went through a wall at {tick}", state.agent);
                wall = wall.max(radii[&state.agent] - floor.clearance_m(&state.point()));
            }
            for other in &states[number + 1..] {
                let apart = (state.point() - other.point()).norm();
                overlap = overlap.max(radii[&state.agent] + radii[&other.agent] - apart);
            }
        }
    }
    (overlap, wall)
}

#[test]
fn nobody_goes_through_anybody_or_anything() {
    for (map, people, runs) in [("office", 12, 6_u64), ("warehouse", 14, 6), ("hospital", 12, 6)] {
        for seed in 1..=runs {
            let (recording, grid) = random(map, seed, people, 30.0);
            let (overlap, wall) = worst(&recording, &grid);
            assert!(overlap <= OVERLAP_M, "{map} {seed}: two overlap by {overlap:.4} m");
            assert!(wall <= WALL_M, "{map} {seed}: somebody is {wall:.4} m deep in a wall");
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_one_others() {
    let hash = |seed| random("office", seed, 6, 10.0).0.hash();
    assert_eq!(hash(3), hash(3));
    assert_ne!(hash(3), hash(4));
}

#[test]
fn profiles_are_deterministic_too() {
    let walkers = [
        Walker::new(1, &section(5, 2), (0.0, 0.0, 0.0), &[(5.0, 0.0), (0.0, 4.0)]),
        Walker::new(2, &section(4, 3), (5.0, 1.0, 3.0), &[(-5.0, 0.0)]),
    ];
    let agents = read(&file(&walkers));
    for profile in [Profile::Hunav10, Profile::Hunav11] {
        let run = |seed| {
            let robot = RobotSpec::standing(Pose::new(2.0, 2.0, 0.0));
            let inputs =
                Inputs { profile, seed, robot: Some(robot), duration_s: 20.0, ..Inputs::new(&agents, "a.yaml") };
            simulate(&inputs).unwrap().hash()
        };
        assert_eq!(run(1), run(1));
        assert_eq!(run(1) == run(2), profile == Profile::Hunav10, "only 1.1 draws");
    }
}

#[test]
fn people_reach_their_goals_round_corners() {
    let grid = crate::common::hall_with_wall(0.0, -4.0, 4.0);
    let walker = Walker { cyclic: false, ..Walker::new(1, " 1", (-2.0, 0.0, 0.0), &[(2.0, 0.0), (-2.0, 1.0)]) };
    let agents = read(&file(&[walker]));
    let inputs = Inputs { grid: Some(&grid), ..Inputs::new(&agents, "agents.yaml") };
    let recording = simulate(&inputs).unwrap();
    let end = recording.tick(recording.ticks() - 1)[0];
    assert!((end.point() - Point::new(-2.0, 1.0)).norm() < 0.45, "{}", end.point());
    assert!(worst(&recording, &grid).1 <= WALL_M);
}

#[test]
fn what_cannot_run_is_said_at_once() {
    let grid = crate::common::hall_with_wall(5.0, -3.0, 3.0);
    let agents = read(&file(&[
        Walker::new(1, " 1", (0.0, 0.0, 0.0), &[(5.0, 0.0)]),
        Walker::new(2, " 9", (3.0, 0.0, 0.0), &[(0.0, 3.0)]),
    ]));
    let robot = RobotSpec { id: Some(2), radius_m: -1.0, ..RobotSpec::standing(Pose::new(f64::NAN, 0.0, 0.0)) };
    let inputs = Inputs {
        grid: Some(&grid),
        robot: Some(robot),
        duration_s: f64::NAN,
        models: BTreeMap::from([(9, socrates_hunav::HumanModel::Orca)]),
        ..Inputs::new(&agents, "agents.yaml")
    };
    let said = shown(&simulate(&inputs).unwrap_err());
    for word in ["agent1.g0", "in a wall", "LLMBT_2.xml", "robot's id", "radius", "position", "--duration", "nobody"] {
        assert!(said.contains(word), "{word}: {said}");
    }
}

#[test]
fn models_are_mixed_in_one_run_and_recorded_people_come_and_go() {
    let agents = read(&file(&[
        Walker { cyclic: false, ..Walker::new(1, " 1", (-4.0, 0.1, 0.0), &[(4.0, 0.1)]) },
        Walker { cyclic: false, ..Walker::new(2, " 1", (4.0, 0.0, 3.1), &[(-4.0, 0.0)]) },
        Walker { cyclic: false, ..Walker::new(3, " 1", (0.0, -4.0, 1.5), &[(0.0, 4.0)]) },
        Walker::new(4, " 1", (0.0, 8.0, 0.0), &[(1.0, 8.0)]),
    ]));
    // Person 4 of the file replays a track; person 9 is in the tracks alone.
    let tracks = "t,id,x,y\n2.0,9,-3.0,0.6\n12.0,9,3.0,0.6\n0.0,4,0.0,8.0\n5.0,4,5.0,8.0\n";
    let tracks = socrates_crowd::tracks::Tracks::read(tracks).unwrap();
    let inputs = Inputs {
        models: BTreeMap::from([(1, socrates_hunav::HumanModel::Orca), (2, socrates_hunav::HumanModel::Orca)]),
        tracks: Some(&tracks),
        duration_s: 20.0,
        ..Inputs::new(&agents, "agents.yaml")
    };
    let recording = simulate(&inputs).unwrap_or_else(|problems| panic!("{}", shown(&problems)));
    assert_eq!(recording.header.agents.len(), 5);
    let leaf =
        |tick: usize, number: usize| recording.header.leaves[usize::from(recording.tick(tick)[number].leaf())].clone();
    assert_eq!((leaf(100, 4), leaf(500, 4), leaf(1500, 4)), ("absent".into(), "track".into(), "absent".into()));
    assert_eq!((leaf(0, 3), leaf(600, 3)), ("track".into(), "absent".into()));
    assert!((recording.tick(700)[4].x - 0.0).abs() < 1e-9 && (recording.tick(250)[3].x - 2.5).abs() < 1e-9);
    let end = recording.tick(2000);
    for (number, goal) in [(0, (4.0, 0.1)), (1, (-4.0, 0.0)), (2, (0.0, 4.0))] {
        let left = (end[number].point() - Point::new(goal.0, goal.1)).norm();
        assert!(left < 0.45, "agent {number} is {left:.2} m from its goal");
    }
    // Nobody there overlaps anybody there.
    for tick in 50..=2000 {
        let there: Vec<_> = (0..5).filter(|number| leaf(tick, *number) != "absent").collect();
        for (place, a) in there.iter().enumerate() {
            for b in &there[place + 1..] {
                let (one, other) = (&recording.tick(tick)[*a], &recording.tick(tick)[*b]);
                let radii = recording.header.agents[*a].radius_m + recording.header.agents[*b].radius_m;
                let depth = radii - (one.point() - other.point()).norm();
                assert!(depth <= OVERLAP_M, "{a} and {b} at {tick}: {depth:.4} m");
            }
        }
    }
}

#[test]
fn a_model_without_a_track_or_outside_native_is_refused() {
    let agents = read(&file(&[Walker::new(1, " 1", (0.0, 0.0, 0.0), &[(4.0, 0.1)])]));
    let refused = |profile, model| {
        let models = BTreeMap::from([(1, model)]);
        shown(&simulate(&Inputs { profile, models, ..Inputs::new(&agents, "agents.yaml") }).unwrap_err())
    };
    assert!(refused(Profile::Native, socrates_hunav::HumanModel::Track).contains("no recorded track"));
    assert!(refused(Profile::Hunav10, socrates_hunav::HumanModel::Orca).contains("social forces only"));
}

#[test]
fn people_get_where_they_want_to_go() {
    let (mut reached, mut all) = (0_u32, 0_u32);
    for map in ["office", "warehouse", "hospital"] {
        let grid = shipped::load(map).unwrap().grid;
        let floor = Floor::new(&grid);
        for seed in 1..=4 {
            let mut draw = Draw(SplitMix64::new(seed));
            let mut taken: Vec<Point> = Vec::new();
            let walkers: Vec<Walker> = (1..=8)
                .map(|id| {
                    let (x, y) = spot(&mut draw, &grid, &floor, &taken);
                    taken.push(Point::new(x, y));
                    let goal = spot(&mut draw, &grid, &floor, &[]);
                    Walker { speed: 1.3, cyclic: false, ..Walker::new(id, " 1", (x, y, 0.0), &[goal]) }
                })
                .collect();
            let agents = read(&file(&walkers));
            let inputs = Inputs { grid: Some(&grid), seed, duration_s: 90.0, ..Inputs::new(&agents, "agents.yaml") };
            let recording = simulate(&inputs).unwrap_or_else(|problems| panic!("{}", shown(&problems)));
            for (state, agent) in recording.tick(9000).iter().zip(&agents.agents) {
                all += 1;
                reached += u32::from((state.point() - agent.goals[0].at).norm() < 0.45);
            }
        }
    }
    // Who stands at a goal in a doorway keeps others from going through.
    assert!(reached * 100 >= all * 90, "{reached} of {all} are at their goal after 90 s");
}

/// Frames of the first people of a crowd around the middle of the hall, some in groups, with others who stand far off.
fn crossing(people: u32, far_off: u32) -> Vec<(f64, f64)> {
    let mut draw = Draw(SplitMix64::new(3));
    let mut walkers = Vec::new();
    for id in 0..people {
        let (x, y) = (1.5 * f64::from(id % 5) - 3.0, 1.5 * f64::from(id / 5) - 3.0);
        let start = (x + draw.real(-0.2, 0.2), y + draw.real(-0.2, 0.2), 0.0);
        walkers.push(Walker {
            group: if id % 6 == 0 { 4 } else { -1 },
            ..Walker::new(
                i64::from(id) + 1,
                &section(1, 1),
                start,
                &[(-start.1 * 2.0, start.0 * 2.0), (start.0, start.1)],
            )
        });
    }
    for id in 0..far_off {
        let start = (-18.0 + f64::from(id % 30), 18.0 - f64::from(id / 30), 0.0);
        walkers.push(Walker::new(i64::from(people + id) + 1, &section(1, 1), start, &[(start.0, start.1)]));
    }
    let text = file(&walkers);
    let agents = read(&text);
    let grid = crate::common::hall();
    let inputs = Inputs { grid: Some(&grid), duration_s: 3.0, ..Inputs::new(&agents, "agents.yaml") };
    let recording = simulate(&inputs).unwrap_or_else(|problems| panic!("{}", shown(&problems)));
    recording.frames.iter().filter(|state| state.agent <= people).map(|state| (state.x, state.y)).collect()
}

#[test]
fn people_far_off_change_nothing_beyond_rounding() {
    let largest = |a: &[(f64, f64)], b: &[(f64, f64)]| {
        assert_eq!(a.len(), b.len());
        a.iter().zip(b).map(|(a, b)| (a.0 - b.0).abs().max((a.1 - b.1).abs())).fold(0.0, f64::max)
    };
    // With 24 people every force is that of the library to the last bit, with 25 and more within 1e-12 of it.
    let (alone, one_more, many) = (crossing(24, 0), crossing(24, 1), crossing(24, 150));
    let walked = largest(&alone[..24], &alone[alone.len() - 24..]);
    assert!(walked > 1.0, "nobody walked: {walked}");
    let off = largest(&alone, &one_more);
    assert!(off > 0.0 && off < 1e-9, "{off}");
    assert_eq!(one_more, many);
}
