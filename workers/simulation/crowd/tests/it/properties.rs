//! What holds for every crowd: symmetries, error bounds, the same bytes on every processor, edges.

use nalgebra::{Point2, Rotation2, Vector2};
use socrates_crowd::cross::{DT_S, SplitMix64, WALL_RANGE_M, cross};
use socrates_crowd::fast::{self, Instructions, Settings, Social};
use socrates_crowd::strict::{self, Model};
use socrates_crowd::{Drive, Goal, Params, Person, Route, Segment, Walker, forces};

/// People anywhere in a square, in every direction, some in groups, some on one spot.
fn random_walkers(seed: u64, n: u32, side_m: f64) -> Vec<Walker> {
    let mut random = SplitMix64::new(seed);
    let mut number = |low: f64, high: f64| low + (high - low) * random.next_f64();
    let mut walkers: Vec<Walker> = (0..n)
        .map(|id| {
            let person = Person {
                velocity: Vector2::new(number(-1.6, 1.6), number(-1.6, 1.6)),
                yaw: number(-3.0, 3.0),
                radius_m: number(0.2, 0.4),
                speed_mps: number(0.5, 1.8),
                group: (id % 5 == 0).then_some(id / 20),
                ..Person::standing(id, Point2::new(number(0.0, side_m), number(0.0, side_m)))
            };
            let goals =
                [0, 1].map(|_| Goal { at: Point2::new(number(0.0, side_m), number(0.0, side_m)), radius_m: 0.3 });
            Walker::walking(person, Route::new(goals.to_vec(), true))
        })
        .collect();
    if n > 20 {
        walkers[11].person.position = walkers[10].person.position;
        walkers[12].person.position = walkers[10].person.position;
        walkers[12].person.velocity = walkers[11].person.velocity;
    }
    walkers
}

fn people(walkers: &[Walker]) -> Vec<Person> {
    walkers.iter().map(|walker| Person { goal: walker.route.goal(), ..walker.person.clone() }).collect()
}

/// The social force on everybody by the sum over all pairs, and by the fast way.
type Law = Box<dyn Fn(&[Person], &Params) -> Vec<Vector2<f64>>>;

fn laws() -> [(&'static str, Law, f64); 3] {
    let portable: Law =
        Box::new(|people, params| forces(people, &[], params).iter().map(|force| force.social).collect());
    let fast = |error: f64| -> Law {
        Box::new(move |people, params| Social::new(params, error).unwrap().forces(people).to_vec())
    };
    [("portable", portable, 1e-11), ("fast 0", fast(0.0), 1e-11), ("fast 1e-3", fast(1e-3), 2e-3)]
}

fn largest(found: &[Vector2<f64>], wanted: impl Iterator<Item = Vector2<f64>>) -> f64 {
    found.iter().zip(wanted).map(|(found, wanted)| (found - wanted).norm()).fold(0.0, f64::max)
}

/// A crowd without exact ties: those are decided by rounding.
fn plain_people(seed: u64) -> Vec<Person> {
    people(&random_walkers(seed, 20, 12.0))
}

#[test]
fn a_turned_crowd_feels_turned_forces() {
    for (name, law, close) in laws() {
        for params in [Params::lightsfm_hunav(), Params::lightsfm_batch()] {
            for seed in 0..20 {
                let crowd = plain_people(seed);
                let turn = Rotation2::new(0.7 + seed as f64);
                let turned: Vec<Person> = crowd
                    .iter()
                    .map(|person| Person {
                        position: turn * person.position,
                        velocity: turn * person.velocity,
                        ..person.clone()
                    })
                    .collect();
                let wanted = law(&crowd, &params).into_iter().map(|force| turn * force);
                let off = largest(&law(&turned, &params), wanted);
                assert!(off < close, "{name} {seed}: {off}");
            }
        }
    }
}

#[test]
fn a_mirrored_crowd_feels_mirrored_forces_where_there_is_no_bias() {
    for (name, law, close) in laws() {
        for seed in 0..20 {
            let crowd = plain_people(seed);
            let mirror = |v: Vector2<f64>| Vector2::new(-v.x, v.y);
            let mirrored: Vec<Person> = crowd
                .iter()
                .map(|person| Person {
                    position: mirror(person.position.coords).into(),
                    velocity: mirror(person.velocity),
                    ..person.clone()
                })
                .collect();
            let params = Params::lightsfm_hunav();
            let off = largest(&law(&mirrored, &params), law(&crowd, &params).into_iter().map(mirror));
            assert!(off < close, "{name} {seed}: {off}");
        }
    }
}

#[test]
fn a_moved_crowd_feels_the_same_forces() {
    for (name, law, close) in laws() {
        for seed in 0..20 {
            let crowd = plain_people(seed);
            let away = Vector2::new(512.0, -2048.0);
            let moved: Vec<Person> =
                crowd.iter().map(|person| Person { position: person.position + away, ..person.clone() }).collect();
            let params = Params::default();
            let off = largest(&law(&moved, &params), law(&crowd, &params).into_iter());
            assert!(off < close, "{name} {seed}: {off}");
        }
    }
}

#[test]
fn the_order_of_people_does_not_matter() {
    for (name, law, close) in laws() {
        for seed in 0..20 {
            let crowd = plain_people(seed);
            let mut backwards = crowd.clone();
            backwards.reverse();
            let params = Params::default();
            let off = largest(&law(&backwards, &params), law(&crowd, &params).into_iter().rev());
            assert!(off < close.min(1e-11), "{name} {seed}: {off}");
        }
    }
}

#[test]
fn social_forces_of_a_crowd_add_up_to_nothing() {
    for (name, law, _) in laws() {
        for seed in 0..5 {
            let mut crowd = people(&random_walkers(seed, 300, 20.0));
            // On one spot the law knows no direction, and the two forces are not opposite.
            crowd.drain(10..13);
            let sum: Vector2<f64> = law(&crowd, &Params::default()).iter().sum();
            assert!(sum.norm() < 1e-9, "{name}: {sum}");
        }
    }
}

#[test]
fn in_a_crowd_of_ties_the_portable_functions_decide() {
    // Equal velocities make every interaction point straight at the other.
    let mut crowd = people(&random_walkers(5, 200, 15.0));
    for person in &mut crowd {
        person.velocity = Vector2::new(0.5, 0.25);
    }
    for params in [Params::lightsfm_hunav(), Params::lightsfm_batch()] {
        let wanted = forces(&crowd, &[], &params);
        for error_mps2 in [0.0, 1e-3] {
            let found = Social::new(&params, error_mps2).unwrap().forces(&crowd).to_vec();
            let off = largest(&found, wanted.iter().map(|force| force.social));
            assert!(off < error_mps2 + 1e-11, "{off}");
        }
    }
}

/// Crowds of every kind, with their walls.
fn crowds() -> Vec<(String, Vec<Walker>, Vec<Segment>)> {
    let mut crowds = Vec::new();
    for n in [10, 50, 100, 1000] {
        let floor = cross(n);
        crowds.push((format!("CROSS-{n}"), floor.walkers.clone(), floor.walls.clone()));
        // The same some seconds on, when ways have met.
        let params = Model::Hunav.params();
        let settings = Settings { params, ..Settings::default() };
        let mut crowd = fast::Crowd::new(&floor.walkers, &floor.walls, &settings).unwrap();
        for _ in 0..300 {
            crowd.step(DT_S).unwrap();
        }
        let walkers = crowd.people().iter().zip(&floor.walkers);
        let later = walkers.map(|(person, walker)| Walker { person: person.clone(), ..walker.clone() });
        crowds.push((format!("CROSS-{n} later"), later.collect(), floor.walls));
    }
    for (seed, (n, side_m)) in
        [(300, 8.0), (300, 30.0), (600, 4.0), (500, 120.0), (40, 3000.0), (2, 3.0)].into_iter().enumerate()
    {
        crowds.push((format!("random {n} in {side_m} m"), random_walkers(seed as u64, n, side_m), Vec::new()));
    }
    // Everybody in two lines that face each other, some faster than they wish.
    let mut lines = random_walkers(99, 200, 1.0);
    for (place, walker) in lines.iter_mut().enumerate() {
        let side = if place % 2 == 0 { 1.0 } else { -1.0 };
        walker.person.position = Point2::new(side * (3.0 + 0.1 * place as f64), 0.3 * side + 1e-3 * place as f64);
        walker.person.velocity = Vector2::new(-side * 2.5, 1e-3 * place as f64 * place as f64);
    }
    crowds.push(("two lines".to_owned(), lines, Vec::new()));
    crowds
}

#[test]
fn the_error_bound_is_kept_in_every_state() {
    for (name, walkers, walls) in crowds() {
        for model in Model::ALL {
            let params = model.params();
            let strict = strict::Crowd::new(&walkers, &walls, WALL_RANGE_M, &params);
            let points = strict.wall_points();
            let wanted = strict.forces(&points);
            for error_mps2 in [0.0, 1e-9, 1e-6, 1e-3, 1e-1] {
                let settings = Settings { params: params.clone(), error_mps2, ..Settings::default() };
                let mut crowd = fast::Crowd::new(&walkers, &walls, &settings).unwrap();
                for (place, (found, wanted)) in crowd.forces().iter().zip(&wanted).enumerate() {
                    let what = format!("{name} {} {error_mps2} person {place}", model.name());
                    let off = (found.social - wanted.social).norm();
                    assert!(off <= error_mps2 + 2e-11, "{what}: social {off}");
                    let rest = [
                        found.desired - wanted.desired,
                        found.obstacle - wanted.obstacle,
                        found.gaze - wanted.gaze,
                        found.coherence - wanted.coherence,
                        found.repulsion - wanted.repulsion,
                    ];
                    for (part, off) in rest.iter().enumerate() {
                        assert!(off.norm() < 1e-9, "{what}: part {part} {off}");
                    }
                }
            }
        }
    }
}

#[test]
fn one_step_is_the_strict_step_within_the_bound() {
    for n in [10, 100] {
        let floor = cross(n);
        let params = Model::Batch.params();
        let settings = Settings { params: params.clone(), error_mps2: 1e-9, ..Settings::default() };
        let mut walkers = floor.walkers.clone();
        walkers[1].drive = Some(Drive { linear_mps: 0.7, angular_radps: 0.4 });
        let mut strict = strict::Crowd::new(&walkers, &floor.walls, WALL_RANGE_M, &params);
        let mut fast = fast::Crowd::new(&walkers, &floor.walls, &settings).unwrap();
        for step in 0..20 {
            strict.step(DT_S);
            fast.step(DT_S).unwrap();
            for (one, other) in strict.people().iter().zip(fast.people()) {
                assert!((one.position - other.position).norm() < 1e-9, "step {step} person {}", one.id);
                assert!((one.yaw - other.yaw).abs() < 1e-6, "step {step} person {}", one.id);
                assert_eq!(one.goal, other.goal);
            }
        }
    }
}

fn bits(people: &[Person]) -> Vec<[u64; 5]> {
    let numbers = people.iter().map(|p| [p.position.x, p.position.y, p.velocity.x, p.velocity.y, p.yaw]);
    numbers.map(|five| five.map(f64::to_bits)).collect()
}

#[test]
fn every_set_of_instructions_gives_the_same_bytes() {
    for (name, walkers, walls) in crowds() {
        for (model, error_mps2) in [(Model::Hunav, 1e-3), (Model::Batch, 1e-9)] {
            let run = |instructions| {
                let settings = Settings { params: model.params(), error_mps2, instructions, ..Settings::default() };
                let mut crowd = fast::Crowd::new(&walkers, &walls, &settings).unwrap();
                for _ in 0..20 {
                    crowd.step(DT_S).unwrap();
                }
                bits(crowd.people())
            };
            let wanted = run(Instructions::Baseline);
            assert_eq!(run(Instructions::Avx2), wanted, "{name}");
            assert_eq!(run(Instructions::Detected), wanted, "{name}");
        }
    }
}

#[test]
fn earlier_calls_leave_no_trace_in_later_ones() {
    let (one, other) = (people(&random_walkers(1, 200, 20.0)), people(&random_walkers(2, 90, 5.0)));
    let mut used = Social::new(&Params::default(), 1e-3).unwrap();
    let first = used.forces(&one).to_vec();
    used.forces(&other);
    used.forces(&[]);
    let again = used.forces(&one);
    assert_eq!(first, again);
}

#[test]
fn who_is_nowhere_feels_nobody_and_is_felt_by_nobody() {
    for strange in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let sound = people(&random_walkers(3, 30, 10.0));
        let mut crowd = sound.clone();
        crowd[4].position.x = strange;
        crowd[9].velocity.y = strange;
        let without: Vec<Person> = sound
            .iter()
            .enumerate()
            .filter(|(place, _)| ![4, 9].contains(place))
            .map(|(_, person)| person.clone())
            .collect();
        for (name, law, close) in laws() {
            let found = law(&crowd, &Params::default());
            assert_eq!((found[4], found[9]), (Vector2::zeros(), Vector2::zeros()), "{name}");
            let rest: Vec<Vector2<f64>> = found
                .iter()
                .enumerate()
                .filter(|(place, _)| ![4, 9].contains(place))
                .map(|(_, force)| *force)
                .collect();
            assert!(largest(&rest, law(&without, &Params::default()).into_iter()) < close, "{name}");
        }
        let walkers: Vec<Walker> =
            crowd.iter().map(|person| Walker::walking(person.clone(), Route::default())).collect();
        let mut fast = fast::Crowd::new(&walkers, &[], &Settings::default()).unwrap();
        for forces in fast.forces() {
            assert!(!forces.total().iter().any(|number| number.is_nan()));
        }
        fast.step(DT_S).unwrap();
    }
}

#[test]
fn people_on_one_spot_who_walk_alike_do_not_feel_each_other() {
    let twin = Person { velocity: Vector2::new(0.3, 0.4), ..Person::standing(1, Point2::new(2.0, 2.0)) };
    let crowd = [twin.clone(), twin.clone(), twin];
    for (name, law, _) in laws() {
        assert!(law(&crowd, &Params::default()).iter().all(|force| *force == Vector2::zeros()), "{name}");
    }
}

#[test]
fn an_exact_meeting_is_decided_as_by_the_portable_functions() {
    for angle in [0.0, 0.3, 1.0, 2.5] {
        let ahead = Vector2::new(f64::cos(angle), f64::sin(angle));
        let one = Person { velocity: ahead, ..Person::standing(1, Point2::origin()) };
        let other = Person { velocity: -ahead, ..Person::standing(2, Point2::from(ahead * 3.0)) };
        for params in [Params::lightsfm_hunav(), Params::lightsfm_batch()] {
            let crowd = [one.clone(), other.clone()];
            let wanted = forces(&crowd, &[], &params);
            let found = Social::new(&params, 0.0).unwrap().forces(&crowd).to_vec();
            assert!(largest(&found, wanted.iter().map(|force| force.social)) < 1e-13);
        }
    }
}

#[test]
fn a_step_of_no_time_changes_nothing_and_a_step_back_is_refused() {
    let floor = cross(50);
    let mut crowd = fast::Crowd::new(&floor.walkers, &floor.walls, &Settings::default()).unwrap();
    let before = bits(crowd.people());
    crowd.step(0.0).unwrap();
    for dt in [-0.01, f64::NAN, f64::INFINITY] {
        let error = crowd.step(dt).unwrap_err().to_string();
        assert!(error.contains(&dt.to_string()), "{error}");
    }
    assert_eq!(before, bits(crowd.people()));
}

#[test]
fn settings_that_cannot_be_meant_are_refused_by_name() {
    let good = Settings::default();
    let cases = [
        (Settings { error_mps2: -1.0, ..good.clone() }, "error_mps2"),
        (Settings { error_mps2: f64::NAN, ..good.clone() }, "error_mps2"),
        (Settings { wall_range_m: f64::INFINITY, ..good.clone() }, "wall_range_m"),
        (Settings { params: Params { gamma_m: 0.0, ..Params::default() }, ..good.clone() }, "gamma_m"),
    ];
    for (settings, name) in cases {
        let error = fast::Crowd::new(&[], &[], &settings).unwrap_err().to_string();
        assert!(error.contains(name), "{error}");
    }
    let mut empty = fast::Crowd::new(&[], &[], &good).unwrap();
    empty.step(DT_S).unwrap();
}

/// Numbers between two bounds, and place and velocity of somebody from them.
type Draw<'a> = dyn FnMut(f64, f64) -> f64 + 'a;
type Spot<'a> = dyn FnMut(u32, &mut Draw<'_>) -> [f64; 4] + 'a;

/// Scenes that are hard on an error bound: everybody on one side, on few spots, straight at each other, one runner
/// against all, thin, dense, in one place at one speed.
fn hard_scenes(seed: u64) -> Vec<(&'static str, Vec<Person>)> {
    let mut random = SplitMix64::new(1000 + seed);
    let mut number = |low: f64, high: f64| low + (high - low) * random.next_f64();
    let mut crowd = |n: u32, place: &mut Spot<'_>| {
        (0..n)
            .map(|id| {
                let [x, y, vx, vy] = place(id, &mut number);
                Person { velocity: Vector2::new(vx, vy), ..Person::standing(id, Point2::new(x, y)) }
            })
            .collect::<Vec<Person>>()
    };
    vec![
        ("sparse", crowd(400, &mut |_, n| [n(0.0, 300.0), n(0.0, 300.0), n(-1.6, 1.6), n(-1.6, 1.6)])),
        ("dense", crowd(600, &mut |_, n| [n(0.0, 10.0), n(0.0, 10.0), n(-1.6, 1.6), n(-1.6, 1.6)])),
        ("crush", crowd(300, &mut |_, n| [n(0.0, 1.0), n(0.0, 1.0), n(-0.3, 0.3), n(-0.3, 0.3)])),
        (
            "one side",
            crowd(700, &mut |id, n| {
                // All come at the first, who walks towards them.
                if id == 0 { [0.0, 0.0, 1.5, 0.0] } else { [n(9.0, 40.0), n(-9.0, 9.0), n(-1.6, -1.4), n(-0.1, 0.1)] }
            }),
        ),
        (
            "straight at each other",
            crowd(500, &mut |id, n| {
                let (side, y) = (if id % 2 == 0 { 1.0 } else { -1.0 }, f64::from(id / 2 % 25) * 0.8);
                [side * n(1.0, 30.0), y, -side * n(1.2, 1.6), 0.0]
            }),
        ),
        (
            "few spots",
            crowd(500, &mut |id, n| [f64::from(id % 5) * 3.0, f64::from(id % 3) * 3.0, n(-1.5, 1.5), n(-1.5, 1.5)]),
        ),
        ("at rest", crowd(500, &mut |_, n| [n(0.0, 40.0), n(0.0, 40.0), n(-1e-6, 1e-6), n(-1e-6, 1e-6)])),
        (
            "one runner",
            crowd(600, &mut |id, n| {
                if id == 7 { [0.0, 20.0, 9.0, 0.1] } else { [n(0.0, 60.0), n(0.0, 40.0), n(-1.2, -0.4), n(-0.2, 0.2)] }
            }),
        ),
        (
            "far from the origin",
            crowd(500, &mut |_, n| [n(4e5, 4e5 + 50.0), n(-3e5, -3e5 + 40.0), n(-1.6, 1.6), n(-1.6, 1.6)]),
        ),
    ]
}

#[test]
fn hard_scenes_keep_every_error_bound_on_every_processor() {
    for params in [Params::lightsfm_hunav(), Params::default(), Params::lightsfm_batch()] {
        for seed in 0..1 {
            for (name, crowd) in hard_scenes(seed) {
                let wanted: Vec<Vector2<f64>> = forces(&crowd, &[], &params).iter().map(|force| force.social).collect();
                for error in [0.0, 1e-9, 1e-6, 1e-4, 1e-3, 1e-2, 1e-1] {
                    let found = Social::new(&params, error).unwrap().forces(&crowd).to_vec();
                    let off = largest(&found, wanted.iter().copied());
                    let rounding = 1e-11 * wanted.iter().fold(1.0, |most: f64, force| most.max(force.norm()));
                    assert!(off <= error + rounding, "{name} {seed} {error:e}: {off:e}");
                    for instructions in [Instructions::Avx2, Instructions::Baseline] {
                        let social = Social::new(&params, error)
                            .unwrap()
                            .with_instructions(instructions)
                            .forces(&crowd)
                            .to_vec();
                        let bits = |forces: &[Vector2<f64>]| -> Vec<u64> {
                            forces.iter().flat_map(|f| [f.x.to_bits(), f.y.to_bits()]).collect()
                        };
                        assert_eq!(bits(&social), bits(&found), "{name} {seed} {error:e}");
                    }
                }
            }
        }
    }
}
