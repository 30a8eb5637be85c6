//! Native contacts on the shipped locations: nobody crosses a wall or a closed door, hardly anybody overlaps,
//! every number is finite, whatever a random crowd does.
#![expect(clippy::print_stdout, reason = "the worst of each run is told")]

use crate::common::scenario::{Cast, place, run, scenario};
use crate::common::scene::Random;
use socrates_engine::{Body, Floor, resolve};
use socrates_model::{
    Action, AgentId, EventKind, Gesture, HumanId, Location, NodeId, Point, Recording, Relation, Rule, Trigger, Vector,
};

/// Overlap of two bodies that a tick may leave, m.
const BODIES_M: f64 = 0.01;
/// The same where thirty press towards one spot at 1.6 m/s and only contacts hold them back, m.
const CRUSH_M: f64 = 0.01;
/// Depth in a wall or closed door that a tick may leave, m.
const WALLS_M: f64 = 0.01;

fn pick<'a, T>(random: &mut Random, list: &'a [T]) -> &'a T {
    &list[((random.uniform() * list.len() as f64) as usize).min(list.len() - 1)]
}

/// A way between two random nodes, at most 40 m.
fn wander(random: &mut Random, location: &Location) -> Vec<NodeId> {
    loop {
        let nodes = location.graph.nodes();
        let (from, to) = (pick(random, nodes).id.clone(), pick(random, nodes).id.clone());
        if let Some(way) = location.graph.shortest(&from, &to)
            && location.graph.length_m(&way) < 40.0
        {
            return way;
        }
    }
}

/// Random rules that make a tree: those that contradict each other are drawn anew.
fn rules(random: &mut Random, me: u32, n: u32) -> Vec<Rule> {
    loop {
        let drawn = some_rules(random, n);
        if socrates_bt::compile(HumanId::new(me), &drawn).is_ok() {
            return drawn;
        }
    }
}

fn some_rules(random: &mut Random, n: u32) -> Vec<Rule> {
    let acts = [
        Action::Navigate,
        Action::FollowRobot,
        Action::FollowHuman(HumanId::new(1 + (random.uniform() * f64::from(n)) as u32 % n)),
        Action::RunAway,
        Action::GiveWay,
        Action::Block,
        Action::LookAtRobot,
        Action::Approach,
        Action::StandStill,
    ];
    let triggers = [
        Trigger::RobotVisible(5.0),
        Trigger::RobotNear(3.0),
        Trigger::RobotBlocking(2.0),
        Trigger::AfterSecs(4.0),
        Trigger::GoalReached,
        Trigger::RobotSays(Gesture::ExcuseMe),
        Trigger::RobotStopped,
    ];
    let count = (random.uniform() * 3.0) as usize;
    (0..count)
        .map(|_| Rule {
            when: vec![pick(random, &triggers).clone()],
            act: pick(random, &acts).clone(),
            gesture: None,
            for_s: (random.uniform() < 0.5).then(|| random.between(1.0, 9.0)),
            latched: random.uniform() < 0.3,
            ..Rule::default()
        })
        .collect()
}

struct Worst {
    overlap_m: f64,
    wall_m: f64,
}

/// How deep a disc is in a wall surface; the clearance is interpolated and a centimeter off in corners.
fn in_wall_m(floor: &Floor, at: &Point, radius_m: f64) -> f64 {
    if floor.clearance_m(at) > radius_m + 0.1 {
        return 0.0;
    }
    floor.nearest_wall(at, radius_m + 0.5).map_or(radius_m, |(distance, _)| radius_m - distance)
}

/// Looks at every tick; panics where somebody goes through a wall or a number is none.
fn worst(recording: &Recording, location: &Location, about: &str) -> Worst {
    let mut floor = Floor::new(&location.grid);
    let mut open: Vec<bool> = vec![false; location.doors.len()];
    let radii: Vec<f64> = recording.header.agents.iter().map(|agent| agent.radius_m).collect();
    let mut found = Worst { overlap_m: 0.0, wall_m: 0.0 };
    let mut events = recording.events.iter().peekable();
    let mut before: Vec<socrates_model::Point> = recording.tick(0).iter().map(|state| state.point()).collect();
    for tick in 0..recording.ticks() {
        while let Some(event) = events.next_if(|event| event.time.tick() <= tick as u64) {
            if let EventKind::Door { door, open: now } = &event.kind {
                let place = location.doors.iter().position(|known| known.id == *door).unwrap();
                open[place] = *now;
            }
        }
        let shut = location
            .doors
            .iter()
            .zip(&open)
            .filter(|(door, open)| !**open && door.opens != socrates_model::DoorOpens::Always);
        floor.close(shut.map(|(door, _)| (door.from, door.to)).collect());
        let states = recording.tick(tick);
        for (i, a) in states.iter().enumerate() {
            let finite = [a.x, a.y, a.yaw, a.vx, a.vy, a.omega].iter().all(|value| value.is_finite());
            assert!(finite && a.speed() <= 2.0, "{about}: {a:?}");
            let at = a.point();
            assert!(floor.sees(&before[i], &at), "{about}: {} goes through a wall at tick {tick}", a.agent_id());
            before[i] = at;
            // The start may be narrower than the body: nodes lie in doorways.
            if tick > 100 {
                found.wall_m = found.wall_m.max(in_wall_m(&floor, &at, radii[i]));
                for (j, b) in states.iter().enumerate().skip(i + 1) {
                    found.overlap_m = found.overlap_m.max(radii[i] + radii[j] - (at - b.point()).norm());
                }
            }
        }
    }
    found
}

#[test]
fn a_random_crowd_crosses_no_wall_and_hardly_overlaps() {
    let mut random = Random::new(2024);
    for name in socrates_maps::shipped::names() {
        let location = place(name);
        for (round, people) in [4_u32, 12, 30].into_iter().enumerate() {
            let cast: Vec<Cast> = (1..=people)
                .map(|me| Cast(Relation::Crossing, wander(&mut random, &location), rules(&mut random, me, people)))
                .collect();
            let robot = wander(&mut random, &location);
            let mut made = scenario(&location, robot, cast, &[], vec![], false);
            made.duration_s = Some(30.0);
            made.seed = round as u64 + 1;
            let planner = *pick(&mut random, &["reference", "reactive", "none"]);
            let about = format!("{name}, {people} people, {planner}");
            let found = worst(&run(made, planner), &location, &about);
            println!("{about}: overlap {:.4} m, in walls {:.4} m", found.overlap_m, found.wall_m);
            assert!(found.overlap_m <= BODIES_M && found.wall_m <= WALLS_M, "{about}");
        }
    }
}

/// People who all press towards one node, with nothing but contacts to hold them back.
#[test]
fn a_crush_stays_apart_and_out_of_walls() {
    let mut random = Random::new(7);
    for name in socrates_maps::shipped::names() {
        let location = place(name);
        let mut floor = Floor::new(&location.grid);
        floor.close(location.doors.iter().map(|door| (door.from, door.to)).collect());
        for _ in 0..6 {
            let goal = pick(&mut random, location.graph.nodes()).at;
            let mut bodies: Vec<Body> = Vec::new();
            for _ in 0..20_000 {
                let at = goal + Vector::new(random.between(-4.0, 4.0), random.between(-4.0, 4.0));
                let free = floor.clearance_m(&at) > 0.28 && floor.sees(&goal, &at);
                if free && bodies.len() < 30 && bodies.iter().all(|body| (body.at - at).norm() > 0.56) {
                    let agent = AgentId::from_number(bodies.len() as u32 + 1);
                    let yields = if bodies.len() % 7 == 3 { 0.02 } else { 1.0 };
                    bodies.push(Body { agent, at, velocity: Vector::zeros(), radius_m: 0.28, yields, clear: false });
                }
            }
            let (mut overlap, mut wall): (f64, f64) = (0.0, 0.0);
            for _ in 0..400 {
                let before: Vec<Point> = bodies.iter().map(|body| body.at).collect();
                for body in &mut bodies {
                    let way = goal - body.at;
                    body.velocity = if body.yields > 0.5 { way / way.norm().max(0.1) * 1.6 } else { Vector::zeros() };
                    body.at += body.velocity * 0.01;
                }
                resolve(&mut bodies, &floor);
                for (i, (a, old)) in bodies.iter().zip(&before).enumerate() {
                    assert!(a.at.x.is_finite() && a.at.y.is_finite() && a.velocity.norm() < 2.0);
                    assert!(floor.sees(old, &a.at), "{name}: {} goes through a wall near {goal}", a.agent);
                    wall = wall.max(in_wall_m(&floor, &a.at, 0.28));
                    for b in bodies.iter().skip(i + 1) {
                        overlap = overlap.max(0.56 - (a.at - b.at).norm());
                    }
                }
            }
            println!("{name}: {} press towards {goal}: overlap {overlap:.4} m, in walls {wall:.4} m", bodies.len());
            assert!(overlap <= CRUSH_M && wall <= CRUSH_M, "{name}: {overlap} {wall}");
        }
    }
}
