//! Avoidance, recorded tracks, and people of several models together.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use nalgebra::{Point2, Vector2};
use socrates_crowd::cross::{self, SplitMix64};
use socrates_crowd::mix::{Member, Mix};
use socrates_crowd::model::{CrowdModel, Room, SocialForces, View};
use socrates_crowd::orca::{Orca, OrcaSettings};
use socrates_crowd::tracks::Tracks;
use socrates_crowd::{Goal, Params, Person, Route, Segment, Walker};

const DT_S: f64 = 0.05;
const RADIUS_M: f64 = 0.28;

fn walker(id: u32, from: (f64, f64), to: (f64, f64)) -> Walker {
    let person = Person { radius_m: RADIUS_M, ..Person::standing(id, Point2::new(from.0, from.1)) };
    Walker::walking(person, Route::new(vec![Goal { at: Point2::new(to.0, to.1), radius_m: 0.1 }], false))
}

fn avoiding(walker: Walker) -> Member {
    Member::walking(walker, Arc::new(Orca::new(OrcaSettings::default()).unwrap()))
}

/// As in the paper, without a side that people keep to.
fn fair(walker: Walker) -> Member {
    let settings = OrcaSettings { keep_right_rad: 0.0, ..OrcaSettings::default() };
    Member::walking(walker, Arc::new(Orca::new(settings).unwrap()))
}

/// Runs for a time and gives the smallest distance between two people, less their radii, on the way.
fn run(mix: &mut Mix, seconds: f64) -> f64 {
    let start = mix.now_s();
    let mut least = f64::INFINITY;
    let mut step = 0.0;
    while step * DT_S < seconds {
        step += 1.0;
        mix.advance_to(start + step * DT_S).unwrap();
        let people: Vec<&Person> = mix.people().collect();
        for (place, one) in people.iter().enumerate() {
            for other in &people[place + 1..] {
                least = least.min((one.position - other.position).norm() - one.radius_m - other.radius_m);
            }
        }
    }
    least
}

fn people(mix: &Mix) -> Vec<Person> {
    mix.people().cloned().collect()
}

#[test]
fn a_circle_of_avoiders_changes_sides_without_overlap() {
    for n in [2_u32, 5, 12, 24] {
        let mut random = SplitMix64::new(u64::from(n));
        let radius = 1.0 + f64::from(n) * 0.35;
        let members = (0..n).map(|id| {
            let angle = TAU * f64::from(id) / f64::from(n) + 0.05 * random.next_f64();
            let (x, y) = (radius * angle.cos(), radius * angle.sin());
            avoiding(walker(id, (x, y), (-x, -y)))
        });
        let mut mix = Mix::new(members.collect(), Vec::new(), 0.0);
        let least = run(&mut mix, 60.0);
        assert!(least > -1e-3, "{n} people: {least}");
        for (member, start) in mix.members().iter().zip(0..) {
            assert_eq!(member.route.reached(), 1, "person {start} of {n} is at {}", member.person.position);
        }
    }
}

#[test]
fn two_who_meet_head_on_pass_each_other_alike() {
    let members = vec![avoiding(walker(0, (-4.0, 0.0), (4.0, 0.0))), avoiding(walker(1, (4.0, 0.0), (-4.0, 0.0)))];
    let mut mix = Mix::new(members, Vec::new(), 0.0);
    let mut widest: f64 = 0.0;
    for step in 1..200 {
        mix.advance_to(f64::from(step) * DT_S).unwrap();
        let people = people(&mix);
        let middle = people[0].position + (people[1].position - people[0].position) / 2.0;
        assert!(middle.coords.norm() < 1e-9, "one gives more way than the other: {middle}");
        assert!((people[0].position - people[1].position).norm() > 2.0 * RADIUS_M - 1e-6);
        widest = widest.max(people[0].position.y.abs());
    }
    assert!(widest > 0.2, "nobody gave way: {widest}");
    assert!(people(&mix)[0].position.x > 3.5);
}

#[test]
fn mirrored_avoiders_walk_mirrored_ways() {
    let ways = [((-4.0, 0.3), (4.0, 0.1)), ((4.0, -0.2), (-4.0, 0.2)), ((0.3, -4.0), (-0.1, 4.0))];
    let crowd = |side: f64| {
        let members =
            (0..).zip(ways).map(|(id, (from, to))| fair(walker(id, (from.0, side * from.1), (to.0, side * to.1))));
        Mix::new(members.collect(), Vec::new(), 0.0)
    };
    let (mut plain, mut mirrored) = (crowd(1.0), crowd(-1.0));
    for step in 1..200 {
        plain.advance_to(f64::from(step) * DT_S).unwrap();
        mirrored.advance_to(f64::from(step) * DT_S).unwrap();
        for (one, other) in plain.people().zip(mirrored.people()) {
            let apart = Vector2::new(one.position.x - other.position.x, one.position.y + other.position.y).norm();
            assert!(apart < 1e-9, "step {step}: {apart}");
        }
    }
}

#[test]
fn avoiders_do_not_walk_through_walls() {
    let wall = |ax: f64, ay: f64, bx: f64, by: f64| Segment { from: Point2::new(ax, ay), to: Point2::new(bx, by) };
    // A room with a gap of 1.2 m between two halves.
    let walls = vec![wall(0.0, -5.0, 0.0, -0.6), wall(0.0, 0.6, 0.0, 5.0)];
    let members = (0..8).map(|id| {
        let y = f64::from(id) - 3.5;
        let x = if id % 2 == 0 { -3.0 } else { 3.0 };
        avoiding(walker(id, (x, y), (-x, 0.2 * y)))
    });
    let mut mix = Mix::new(members.collect(), walls.clone(), 0.0);
    for step in 1..1200 {
        let before = people(&mix);
        mix.advance_to(f64::from(step) * DT_S).unwrap();
        for (old, new) in before.iter().zip(mix.people()) {
            let crossed = old.position.x.signum() != new.position.x.signum();
            let at = old.position.y + (new.position.y - old.position.y) * 0.5;
            assert!(!crossed || at.abs() < 0.6, "person {} went through the wall at {at}", new.id);
            for wall in &walls {
                let gap = (wall.closest(&new.position) - new.position).norm();
                assert!(gap > RADIUS_M - 0.06, "person {} is {gap} m from a wall", new.id);
            }
        }
    }
}

#[test]
fn a_dense_crowd_of_avoiders_stays_finite_and_parts() {
    let mut random = SplitMix64::new(9);
    let members = (0..40).map(|id| {
        // Some stand on one spot.
        let spot = if id < 4 { (0.5, 0.5) } else { (random.next_f64() * 3.0, random.next_f64() * 3.0) };
        avoiding(walker(id, spot, (random.next_f64() * 20.0, random.next_f64() * 20.0)))
    });
    let mut mix = Mix::new(members.collect(), Vec::new(), 0.0);
    run(&mut mix, 10.0);
    let apart = run(&mut mix, 1.0);
    assert!(apart > -1e-2, "{apart}");
    assert!(mix.people().all(|person| person.position.iter().all(|number| number.is_finite())));
}

/// What everybody does next when models look at everybody and every wall.
fn by_looking_at_all(mix: &Mix, walls: &[Segment], time_s: f64) -> Vec<Person> {
    let people = people(mix);
    let mut room = Room::default();
    let mut next = Vec::new();
    for (place, (me, member)) in people.iter().zip(mix.members()).enumerate() {
        let view = View {
            me,
            place: Some(place),
            people: &people,
            walls,
            now_s: mix.now_s(),
            dt_s: time_s - mix.now_s(),
            index: None,
        };
        let mut person = member.model.next(&view, &mut room).unwrap();
        member.route.clone().follow(&mut person);
        next.push(person);
    }
    next
}

#[test]
fn a_crowd_with_an_index_moves_as_one_that_looks_at_everybody() {
    let far =
        OrcaSettings { neighbor_range_m: 30.0, most_neighbors: 40, wall_horizon_s: 9.0, ..OrcaSettings::default() };
    let models: [Arc<dyn CrowdModel + Send + Sync>; 3] = [
        Arc::new(Orca::new(OrcaSettings::default()).unwrap()),
        Arc::new(Orca::new(far).unwrap()),
        Arc::new(SocialForces::new(Params::default(), 2.5).unwrap()),
    ];
    let mut floor = cross::cross(90);
    // Some on one spot, some who are nowhere.
    floor.walkers[11].person.position = floor.walkers[10].person.position;
    floor.walkers[12].person = Person { id: 12, ..floor.walkers[10].person.clone() };
    floor.walkers[30].person.position.x = f64::NAN;
    let members = floor.walkers.iter().enumerate();
    let members = members.map(|(place, walker)| Member::walking(walker.clone(), models[place % 3].clone())).collect();
    let mut mix = Mix::new(members, floor.walls.clone(), 0.0);
    for step in 1..=200 {
        let time_s = f64::from(step) * cross::DT_S;
        let wanted = by_looking_at_all(&mix, &floor.walls, time_s);
        mix.advance_to(time_s).unwrap();
        let all = |people: &[Person]| format!("{people:?}");
        assert_eq!(all(&people(&mix)), all(&wanted), "step {step}");
    }
}

const TABLE: &str = "t,id,x,y\n0.0,7,0,0\n1.0,7,2,0\n2.0,7,2,2\n\n0.5,8,5,5\n1.5,8,5,5\n";

#[test]
fn a_recorded_person_comes_walks_and_goes() {
    let tracks = Tracks::read(TABLE).unwrap();
    let person = Person { yaw: 0.25, ..Person::standing(7, Point2::origin()) };
    let track = tracks.get(7).unwrap();
    assert!(track.at(-0.1, &person).is_none() && track.at(2.1, &person).is_none());
    let first = track.at(0.0, &person).unwrap();
    assert_eq!((first.position, first.velocity), (Point2::origin(), Vector2::new(2.0, 0.0)));
    let halfway = track.at(1.5, &person).unwrap();
    assert_eq!((halfway.position, halfway.velocity), (Point2::new(2.0, 1.0), Vector2::new(0.0, 2.0)));
    assert!((halfway.yaw - PI / 2.0).abs() < 1e-12);
    assert_eq!(track.at(2.0, &person).unwrap().position, Point2::new(2.0, 2.0));
    // Standing still, the heading stays.
    let still = tracks.get(8).unwrap().at(1.0, &person).unwrap();
    assert_eq!((still.velocity, still.yaw.to_bits()), (Vector2::zeros(), 0.25_f64.to_bits()));
    assert_eq!(
        tracks.iter().map(|(id, track)| (id, track.first_s(), track.last_s())).collect::<Vec<_>>(),
        [(7, 0.0, 2.0), (8, 0.5, 1.5)]
    );
}

#[test]
fn recorded_headings_turn_the_shorter_way_round() {
    let tracks = Tracks::read("id,t,y,x,yaw,vx,vy\n1,0,0,0,3.1,1,0\n1,1,0,1,-3.1,3,0\n").unwrap();
    let half = tracks.get(1).unwrap().at(0.5, &Person::standing(1, Point2::origin())).unwrap();
    assert!((half.yaw.abs() - PI).abs() < 1e-9, "{}", half.yaw);
    assert_eq!(half.velocity, Vector2::new(2.0, 0.0));
}

#[test]
fn people_feel_a_recorded_person_who_feels_nobody() {
    let tracks = Tracks::read("t,id,x,y\n1,9,0,6\n5,9,0,-2\n").unwrap();
    let recorded =
        |now_s| Member::recorded(Person::standing(9, Point2::origin()), tracks.get(9).unwrap().clone(), now_s);
    let model = Arc::new(SocialForces::new(Params::default(), 3.0).unwrap());
    let standing = Member::walking(walker(0, (0.2, 2.0), (0.2, 2.0)), model);
    let mut mix =
        Mix::new(vec![recorded(0.0), standing.clone(), avoiding(walker(2, (-0.2, 1.0), (-0.2, 1.0)))], Vec::new(), 0.0);
    assert_eq!(mix.people().count(), 2);
    let mut seen = 0;
    for step in 1..=120 {
        let now = f64::from(step) * DT_S;
        mix.advance_to(now).unwrap();
        let there = (1.0..=5.0).contains(&now);
        assert_eq!(mix.people().count(), if there { 3 } else { 2 }, "{now}");
        if there {
            seen += 1;
            let walked = mix.people().next().unwrap();
            assert!((walked.position - Point2::new(0.0, 8.0 - 2.0 * now)).norm() < 1e-9);
        }
    }
    assert!(seen > 70);
    assert!((people(&mix)[0].position - Point2::new(0.2, 2.0)).norm() > 0.05, "the walker felt nothing");
    assert!((people(&mix)[1].position - Point2::new(-0.2, 1.0)).norm() > 0.05, "the avoider felt nothing");
    assert!(mix.advance_to(0.0).is_err() && mix.advance_to(f64::NAN).is_err());
}

#[test]
fn a_bad_file_of_tracks_is_refused_with_every_line() {
    let cases = [
        ("", "a column `t`"),
        ("t,id,x\n0,1,2\n", "a column `y`"),
        ("t,id,x,y,speed\n", "line 1, `line` is `speed`"),
        ("t,id,x,y,x\n", "each column once"),
        ("t,id,x,y,vx\n", "both or neither"),
        ("t,id,x,y\n", "at least one row"),
        ("t,id,x,y\n0,1,2\n", "line 2, `line` is `3 cells`"),
        ("t,id,x,y\n0,-1,2,3\n", "line 2, `id` is `-1`"),
        ("t,id,x,y\n0,1,NaN,3\n", "line 2, `x` is `NaN`"),
        ("t,id,x,y\n0,1,\"1,5\",3\n", "line 2, `x` is `1,5`"),
        ("\nt,id,x,y\n\n \n0,1,\"2\n\",3\n0,1,2\n", "line 7, `line` is `3 cells`"),
        ("t,id,x,y\n1,1,2,3\n1,1,2,3\n", "line 3, `t` is `1`; allowed: later than 1 s"),
    ];
    for (text, wanted) in cases {
        let error = Tracks::read(text).unwrap_err().to_string();
        assert!(error.contains(wanted), "{text:?}: {error}");
    }
    let error = Tracks::read("t,id,x,y\na,1,2,3\n0,b,c,3\n").unwrap_err();
    assert_eq!(error.problems.len(), 3);
}

#[test]
fn cells_in_quotes_and_blanks_around_cells_are_read_as_what_they_hold() {
    let plain = Tracks::read("t,id,x,y\n0,7,1.5,2\n1,7,2.5,2\n").unwrap();
    assert_eq!(Tracks::read("\"t\",\"id\" ,\"x\", y\r\n\r\n\"0\",7, 1.5,\"2\"\r\n1,\" 7\",2.5,2").unwrap(), plain);
}

#[test]
fn spoiled_files_of_tracks_never_panic() {
    let mut random = SplitMix64::new(77);
    let mut read = 0;
    for _ in 0..20_000 {
        let mut text: Vec<char> = TABLE.chars().collect();
        for _ in 0..=random.next_u64() % 4 {
            let at = (random.next_u64() % text.len() as u64) as usize;
            let signs: Vec<char> = "0123456789.,-+einNaxyt\n\r\t \"é\u{0}".chars().collect();
            let sign = signs[(random.next_u64() % signs.len() as u64) as usize];
            match random.next_u64() % 3 {
                0 => text[at] = sign,
                1 => text.insert(at, sign),
                _ => drop(text.remove(at)),
            }
        }
        if let Ok(tracks) = Tracks::read(&text.iter().collect::<String>()) {
            read += 1;
            for (id, track) in tracks.iter() {
                let person = Person::standing(id, Point2::origin());
                for time in [-1.0, 0.0, 0.7, 2.0, 1e9, f64::NAN] {
                    let _state: Option<Person> = track.at(time, &person);
                }
            }
        }
    }
    assert!(read > 100, "{read}");
}
