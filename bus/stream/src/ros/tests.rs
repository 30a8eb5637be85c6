//! Bags that rosbags wrote (`tests/data/bag.py`), and bags of our own with everything that can be wrong.

use super::*;
use crate::csv::{Table, read_table};
use socrates_model::AgentId;

mod pen;
use pen::{Pen, odometry};

/// `bag.py people zstd`: 14 s, people seen by a camera on the robot.
const WALK: &[u8] = include_bytes!("../../tests/data/walk.mcap");
/// `bag.py hunav1 short`: 2 s of HuNavSim at half the speed of the recorder's clock.
const HUNAV: &[u8] = include_bytes!("../../tests/data/hunav.mcap");
const SECOND: i64 = 1_000_000_000;

fn tracks_of(files: &[&[u8]], choice: &Choice) -> Result<Tracks, BagFault> {
    let mut bag = Bag::new();
    for (place, bytes) in files.iter().enumerate() {
        bag.add(&format!("bag_{place}.mcap"), *bytes)?;
    }
    bag.tracks(choice)
}

fn tracks(bytes: &[u8]) -> Result<Tracks, BagFault> {
    tracks_of(&[bytes], &Choice::default())
}

fn refused(bytes: &[u8]) -> String {
    let why = tracks(bytes).unwrap_err();
    assert!(!why.hint().is_empty());
    why.to_string()
}

fn tells(tracks: &Tracks, what: &str) -> bool {
    tracks.told.iter().any(|told| told.contains(what))
}

/// Cells of a column in the lines of somebody.
fn cells<'a>(table: &'a Table, id: &str, column: &str) -> Vec<&'a str> {
    let (own, at) = (table.column("id").unwrap(), table.column(column).unwrap());
    table.rows.iter().filter(|row| row.cells[own] == id).map(|row| row.cells[at].as_str()).collect()
}

fn numbers(table: &Table, id: &str, column: &str) -> Vec<f64> {
    cells(table, id, column).iter().map(|cell| cell.parse().unwrap()).collect()
}

/// Where somebody is at every line, and how far that is from where they should be, m: at most.
fn farthest(table: &Table, id: &str, wanted: impl Fn(f64) -> (f64, f64)) -> f64 {
    let places = numbers(table, id, "x").into_iter().zip(numbers(table, id, "y"));
    let off = numbers(table, id, "t").into_iter().zip(places).map(|(t, (x, y))| {
        let (x0, y0) = wanted(t);
        (x - x0).hypot(y - y0)
    });
    off.fold(0.0, f64::max)
}

/// The robot along x of `odom`, ten times a second for two seconds, and a person beside it.
fn pen() -> Pen {
    let mut pen = Pen::new();
    for k in 0..=20 {
        let at = k * SECOND / 10 + SECOND;
        pen.odometry("/odom", at, "odom", [k as f64 * 0.05, 0.0]);
        pen.people("/people", at, "odom", &[("ann", [3.0, 1.0])]);
    }
    pen
}

#[test]
fn a_bag_of_rosbags_becomes_tracks_in_the_map_within_a_millimeter() {
    let found = tracks(WALK).unwrap();
    let table = &found.table;
    assert_eq!(cells(table, "robot", "t").len(), 141);
    let off = farthest(table, "robot", |t| (2.0, 1.0 + (0.5 * t).min(6.0)));
    assert!(off < 1e-3, "robot {off}");
    // Through the optical frame of the camera, the robot, its odometry and the map.
    let off = farthest(table, "ann", |t| (3.0, 9.0 - 0.8 * t));
    assert!(off < 1e-3, "ann {off}");
    let off = farthest(table, "bob", |_| (0.5, 4.0));
    assert!(off < 1e-3, "bob {off}");
    let yaw = numbers(table, "robot", "yaw");
    assert!(yaw.iter().all(|yaw| (yaw - std::f64::consts::FRAC_PI_2).abs() < 1e-5));
    assert!(cells(table, "ann", "yaw").iter().all(|cell| cell.is_empty()));
    let goal = (cells(table, "robot", "goal_x")[140], cells(table, "robot", "goal_y")[140]);
    assert_eq!(goal, ("2.000000", "7.000000"));
    for what in [
        "robot: `/odom` (nav_msgs/msg/Odometry), placed in `map`",
        "people: `/people` (people_msgs/msg/People)",
        "goal: the last of 2 of `/goal_pose`",
        "not read: `/chatter` (std_msgs/msg/String) 141",
    ] {
        assert!(tells(&found, what), "{what}: {:?}", found.told);
    }
    assert_eq!(found.told.len(), 4, "{:?}", found.told);
    let mut table = table.clone();
    crate::csv::named(&mut table, None).unwrap();
    let recording = read_table(&table).unwrap();
    assert_eq!((recording.ticks(), recording.header.agents.len()), (1401, 3));
    // A person without a heading faces where they go.
    let ann = recording.track(AgentId::from_number(1)).nth(300).unwrap();
    assert!((ann.yaw + std::f64::consts::FRAC_PI_2).abs() < 1e-6, "{ann:?}");
}

#[test]
fn hunavsim_is_read_with_its_radii_headings_and_groups_by_the_clock_of_the_simulator() {
    let found = tracks(HUNAV).unwrap();
    // Messages of the robot have no time stamp, and the recorder's clock runs twice as fast.
    let off = farthest(&found.table, "robot", |t| (2.0, 1.0 + 0.5 * t));
    assert!(off < 1e-3, "robot {off}");
    assert!(farthest(&found.table, "ann", |t| (3.0, 9.0 - 0.8 * t)) < 1e-3);
    assert_eq!(found.radii_m.keys().collect::<Vec<_>>(), ["ann", "bob", "robot"]);
    assert!((found.radii_m["ann"] - 0.35).abs() < 1e-6 && (found.radii_m["robot"] - 0.3).abs() < 1e-6);
    let yaw = numbers(&found.table, "ann", "yaw");
    assert!(yaw.iter().all(|yaw| (yaw + std::f64::consts::FRAC_PI_2).abs() < 1e-5));
    assert_eq!((cells(&found.table, "ann", "group")[0], cells(&found.table, "bob", "group")[0]), ("1", "1"));
    assert_eq!(cells(&found.table, "robot", "goal_y").last(), Some(&"7.000000"));
    for what in [
        "robot: `/robot_states` (hunav_msgs/msg/Agent), placed in `map`; --robot chooses another of `/odom`",
        "people: `/human_states` (hunav_msgs/msg/Agents); --people chooses another of `/people`",
        "names no frame: taken to be in `map`",
        "have no time stamp",
        "holds robots among its agents",
        "goal: `/robot_states`, (2.00, 7.00) in `map`",
    ] {
        assert!(tells(&found, what), "{what}: {:?}", found.told);
    }
    let choice = Choice { robot: Some("/odom".to_owned()), people: Some("people".to_owned()) };
    let other = tracks_of(&[HUNAV], &choice).unwrap();
    assert!(farthest(&other.table, "robot", |t| (2.0, 1.0 + 0.5 * t)) < 1e-3);
    assert!(tells(&other, "people: `/people`") && !tells(&other, "chooses another"), "{:?}", other.told);
    let frame = Choice { robot: Some("base_link".to_owned()), people: None };
    assert!(farthest(&tracks_of(&[HUNAV], &frame).unwrap().table, "robot", |t| (2.0, 1.0 + 0.5 * t)) < 1e-3);
}

#[test]
fn a_choice_that_is_not_there_is_told_with_what_is() {
    let why = |robot: Option<&str>, people: Option<&str>| {
        let choice = Choice { robot: robot.map(str::to_owned), people: people.map(str::to_owned) };
        tracks_of(&[HUNAV], &choice).unwrap_err().to_string()
    };
    let robot = why(Some("/scan"), None);
    assert!(robot.contains("--robot names `/scan`") && robot.contains("`/odom`") && robot.contains("`base_footprint`"));
    let people = why(None, Some("/odom"));
    assert!(people.contains("--people names `/odom`") && people.contains("`/human_states`"), "{people}");
}

#[test]
fn a_bag_in_several_files_is_one() {
    let (mut first, mut second) = (Pen::new(), Pen::new());
    for k in 0..20 {
        let pen = if k < 10 { &mut first } else { &mut second };
        pen.odometry("/odom", k * SECOND, "map", [k as f64, 0.0]);
    }
    let found = tracks_of(&[&first.bytes(), &second.bytes()], &Choice::default()).unwrap();
    assert!(farthest(&found.table, "robot", |t| (t, 0.0)) < 1e-6);
    assert_eq!(cells(&found.table, "robot", "t").len(), 20);
    assert!(tells(&found, "people: no topic of people is there"), "{:?}", found.told);
}

#[test]
fn big_endian_messages_are_read_the_same() {
    let of = |big_endian: bool| {
        let mut pen = Pen::new();
        pen.big_endian = big_endian;
        pen.transform("/tf_static", 0, "map", "odom", [5.0, 0.0]);
        for k in 0..5 {
            pen.odometry("/odom", k * SECOND + 1, "odom", [k as f64, 2.5]);
            pen.people("/people", k * SECOND + 1, "map", &[("ann", [1.0, -k as f64])]);
        }
        tracks(&pen.bytes()).unwrap()
    };
    assert_eq!(of(true), of(false));
    assert!(farthest(&of(true).table, "robot", |t| (5.0 + t, 2.5)) < 1e-6);
}

#[test]
fn without_a_robot_or_a_message_it_is_said_what_there_is() {
    let mut pen = Pen::new();
    pen.people("/people", 1, "map", &[("ann", [0.0, 0.0])]);
    let why = refused(&pen.bytes());
    assert!(why.contains("where the robot was") && why.contains("`/people` (people_msgs/msg/People) 1"), "{why}");
    assert!(refused(&Pen::new().bytes()).contains("no message"));
    let mut json = Pen::new();
    json.raw("/x", "a/msg/B", "json", "{}", 1, b"{}");
    let why = refused(&json.bytes());
    assert!(why.contains("no message of ROS 2") && why.contains("`/x` (a/msg/B, json) 1"), "{why}");
    assert!(refused(b"not at all").contains("no MCAP"));
}

#[test]
fn a_file_that_ends_anywhere_is_read_up_to_there_or_refused() {
    for (bytes, name) in [(WALK, "walk"), (&pen().bytes()[..], "pen")] {
        let (mut read, mut cut) = (0, 0);
        for end in (0..bytes.len()).step_by(if name == "walk" { 211 } else { 37 }) {
            match tracks(&bytes[..end]) {
                Ok(found) => {
                    assert!(tells(&found, "is cut off or damaged"), "{name} {end}: {:?}", found.told);
                    read += 1;
                }
                Err(why) => {
                    assert!(matches!(why, BagFault::Read { .. } | BagFault::NoRobot { .. }), "{name} {end}: {why}");
                    cut += 1;
                }
            }
        }
        // The bag of rosbags is one chunk, of which there is nothing before it is whole.
        assert!(cut > 0 && (read > 0 || name == "walk"), "{name}: {read} {cut}");
    }
}

#[test]
fn damaged_bytes_anywhere_never_break_the_reader() {
    let good = pen().bytes();
    for at in (0..good.len()).step_by(3) {
        for value in [0, 0xff, good[at] ^ 0x10] {
            let mut bytes = good.clone();
            bytes[at] = value;
            drop(tracks(&bytes).map(|found| read_table(&found.table)));
        }
    }
}

#[test]
fn messages_that_cannot_be_read_are_left_out_and_refused_where_they_are_most() {
    let message = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut pen = pen();
        let mut bytes = Pen::new().odometry_bytes(SECOND, "odom", [9.0, 9.0]);
        change(&mut bytes);
        pen.raw("/odom", "nav_msgs/msg/Odometry", "cdr", &odometry(), 4 * SECOND, &bytes);
        tracks(&pen.bytes()).unwrap()
    };
    let capsule = message(&|bytes| bytes[1] = 9);
    assert!(
        tells(&capsule, "1 of 22 messages of `/odom` are left out: its encapsulation is `00 09`"),
        "{:?}",
        capsule.told
    );
    // The length of the name of the frame stands behind the stamp.
    let long = message(&|bytes| bytes[12..16].copy_from_slice(&[0xff; 4]));
    assert!(tells(&long, "`header.frame_id`: its text claims 4294967295 bytes"), "{:?}", long.told);
    let short = message(&|bytes| bytes.truncate(60));
    assert!(tells(&short, "messages of `/odom` are left out: `pose.pose."), "{:?}", short.told);
    let packed = message(&|bytes| bytes[..4].copy_from_slice(&[0x28, 0xb5, 0x2f, 0xfd]));
    assert!(tells(&packed, "compressed one by one"), "{:?}", packed.told);
    let mut most = Pen::new();
    for k in 0..4 {
        most.raw("/odom", "nav_msgs/msg/Odometry", "cdr", &odometry(), k, &[0, 1, 0, 0]);
    }
    most.odometry("/odom", 5, "odom", [0.0, 0.0]);
    assert!(refused(&most.bytes()).contains("4 of 5 messages of `/odom`"));
}

#[test]
fn definitions_that_are_missing_or_hold_themselves_are_told_with_their_topic() {
    let of = |definition: &str| {
        let mut pen = Pen::new();
        pen.raw("/odom", "nav_msgs/msg/Odometry", "cdr", definition, 1, &[0, 1, 0, 0, 0]);
        refused(&pen.bytes())
    };
    assert!(
        of("").contains("`/odom` (nav_msgs/msg/Odometry) cannot be read: the bag holds no definition"),
        "{}",
        of("")
    );
    let ring = of("Odometry inner\n");
    assert!(ring.contains("`nav_msgs/Odometry` holds itself"), "{ring}");
    let other = of("uint8 x\n");
    assert!(other.contains("no field `header`"), "{other}");
}

#[test]
fn times_that_go_back_a_little_are_put_in_order_and_a_clock_that_starts_again_is_refused() {
    let mut late = pen();
    late.odometry("/odom", 3 * SECOND - SECOND / 20, "odom", [0.975, 0.0]);
    let found = tracks(&late.bytes()).unwrap();
    assert!(tells(&found, "the times of `/odom` go back once"), "{:?}", found.told);
    assert!(farthest(&found.table, "robot", |t| (0.5 * t, 0.0)) < 1e-6);
    let mut again = pen();
    again.odometry("/odom", SECOND, "odom", [0.0, 0.0]);
    assert!(refused(&again.bytes()).contains("jump from 3.00 s to 1.00 s"));
    let mut twice = pen();
    twice.odometry("/odom", 3 * SECOND, "odom", [1.001, 0.0]);
    assert!(tells(&tracks(&twice.bytes()).unwrap(), "1 places have the time of the one before"));
}

#[test]
fn two_clocks_in_one_bag_are_refused() {
    let mut pen = Pen::new();
    for k in 0..5 {
        pen.odometry("/odom", k * SECOND + 1, "map", [0.0, 0.0]);
        pen.people("/people", 1_760_000_000 * SECOND + k * SECOND, "map", &[("ann", [1.0, 1.0])]);
    }
    let why = refused(&pen.bytes());
    assert!(why.contains("`the robot` begins at 0.0 s") && why.contains("`/people` at 1760000000.0 s"), "{why}");
}

#[test]
fn places_that_are_none_are_gaps_and_refused_where_they_are_most() {
    let mut some = pen();
    some.people("/people", 3 * SECOND + 1, "odom", &[("ann", [f64::NAN, 1.0]), ("bob", [1e300, 0.0])]);
    let found = tracks(&some.bytes()).unwrap();
    let told = "2 places of `/people` are taken as gaps: the position of `ann` is (NaN, 1, 0) m";
    assert!(tells(&found, told), "{:?}", found.told);
    let mut most = Pen::new();
    for k in 0..5 {
        most.odometry("/odom", k * SECOND, "odom", [f64::INFINITY, 0.0]);
    }
    assert!(refused(&most.bytes()).contains("5 of 5 places of `/odom`"));
}

#[test]
fn nobody_is_placed_without_a_transform() {
    let mut apart = pen();
    apart.people("/people", 2 * SECOND, "camera", &[("bob", [0.0, 1.0])]);
    let why = refused(&apart.bytes());
    assert!(why.contains("`/people` is in the frame `camera` and the robot in `odom`"), "{why}");
    // Odometry without `/tf` says where its own frame stands.
    let mut own = pen();
    own.transform("/tf_static", 0, "base_link", "camera", [0.5, 0.0]);
    own.people("/people", 2 * SECOND, "camera", &[("bob", [0.0, 1.0])]);
    let found = tracks(&own.bytes()).unwrap();
    assert!(farthest(&found.table, "bob", |_| (1.0, 1.0)) < 1e-6, "{:?}", found.table);
    assert!(tells(&found, "no transform leads from `odom` to `map`: places are in `odom`"), "{:?}", found.told);
    // Localization that begins late leaves out what was before it.
    let mut late = pen();
    for k in 0..10 {
        late.transform("/tf", 5 * SECOND / 2 + k * SECOND / 10, "map", "odom", [1.0, 0.0]);
    }
    let found = tracks(&late.bytes()).unwrap();
    assert!(
        tells(&found, "5 of 21 places of `/odom` are left out: no transform from `odom` to `map`"),
        "{:?}",
        found.told
    );
    let mut never = pen();
    (0..2).for_each(|k| never.transform("/tf", 90 * SECOND + k, "map", "odom", [1.0, 0.0]));
    assert!(refused(&never.bytes()).contains("no transform from `odom` to `map` is within 1 s"));
}

#[test]
fn the_robot_is_a_frame_where_nothing_else_tells_and_people_may_be_called_like_it() {
    let mut pen = Pen::new();
    for k in 0..=10 {
        pen.transform("/tf", k * SECOND / 10 + 1, "world", "r1/base_link", [k as f64 * 0.1, 0.0]);
        pen.transform("/tf", k * SECOND / 10 + 1, "world", "r2/base_link", [0.0, 0.0]);
        pen.people(
            "/people",
            k * SECOND / 10 + 1,
            "world",
            &[("robot", [2.0, 0.0]), ("0", [3.0, 0.0]), ("", [4.0, 0.0])],
        );
    }
    let found = tracks(&pen.bytes()).unwrap();
    assert!(farthest(&found.table, "robot", |t| (t, 0.0)) < 1e-6);
    let told = "robot: the frame `r1/base_link` of /tf, placed in `world`; --robot chooses another of the frame `r2/base_link`";
    assert!(tells(&found, told), "{:?}", found.told);
    for (id, x) in [("person_robot", 2.0), ("person_0", 3.0), ("3", 4.0)] {
        assert!(farthest(&found.table, id, |_| (x, 0.0)) < 1e-6, "{id}");
    }
}

#[test]
fn files_of_ros_are_told_from_ours_by_their_profile() {
    assert!(Bag::begins(WALK) && Bag::begins(&Pen::new().bytes()));
    let recording = crate::csv::read_tracks("t,id,x,y\n0,robot,0,0\n1,robot,1,0\n").unwrap();
    assert!(!Bag::begins(&crate::mcap::write(&recording, None).unwrap()));
    assert!(!Bag::begins(b"") && !Bag::begins(&WALK[..20]));
}
