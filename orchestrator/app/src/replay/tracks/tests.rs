use super::*;

/// The robot past a person and on to (6, 0), and two who stand together, ten times a second.
fn table(change: impl Fn(usize, &str) -> String) -> String {
    let mut text = change(0, "t,id,x,y,yaw,gesture") + "\n";
    for k in 0..=130_usize {
        let t = k as f64 * 0.1;
        let x = (0.5 * t).min(6.0);
        let lines = [
            format!("{t:.1},robot,{x:.3},0,0,"),
            format!("{t:.1},human_1,{:.3},1,3.1416,{}", 6.0 - 0.5 * t, if k > 20 { "WAIT" } else { "NONE" }),
            format!("{t:.1},human_2,3,-1.2,1.57,"),
            format!("{t:.1},human_3,3,-2.4,-1.57,"),
        ];
        for line in lines {
            text.push_str(&change(k + 1, &line));
            text.push('\n');
        }
    }
    text
}

fn of(text: &str, known: &Known) -> Scored {
    score("t.csv", text.as_bytes(), known).unwrap()
}

fn value(scored: &Scored, id: &str) -> Option<f64> {
    scored.report.metrics.iter().find(|metric| metric.id == id).unwrap().value
}

fn tells(scored: &Scored, what: &str) -> bool {
    scored.told.iter().any(|told| told.contains(what))
}

fn asked(place: Location) -> Known {
    Known {
        location: Some(place),
        goal: Some(point("6,0").unwrap()),
        groups: vec![group("2+3").unwrap()],
        ..Known::default()
    }
}

/// A shipped map with nothing on it, round the origin.
fn floor() -> Location {
    let mut place = socrates_maps::shipped::load(socrates_maps::shipped::names()[0]).unwrap();
    place.grid.cells.iter_mut().for_each(|cell| *cell = socrates_model::Cell::Free);
    place.grid.origin = socrates_model::Pose::new(-10.0, -10.0, 0.0);
    place
}

#[test]
fn with_a_goal_a_map_and_groups_anyones_robot_has_the_figures_of_a_trip() {
    let alone = of(&table(|_, line| line.to_owned()), &Known::default());
    for id in ["success", "spl", "stl", "path_efficiency", "failure_to_progress", "o_space_seconds"] {
        assert_eq!(value(&alone, id), None, "{id}");
    }
    assert!(tells(&alone, "the robot's goal is not known") && tells(&alone, "assumed: radius of people"));
    let scored = of(&table(|_, line| line.to_owned()), &asked(floor()));
    assert!(!tells(&scored, "goal is not known"));
    assert_eq!(value(&scored, "success"), Some(1.0), "{:?}", scored.told);
    assert!((value(&scored, "time_to_goal").unwrap() - 11.0).abs() < 0.01);
    assert!((value(&scored, "spl").unwrap() - 1.0).abs() < 0.1);
    for id in ["stl", "path_efficiency", "failure_to_progress", "aggregated_time", "group_splits"] {
        assert!(value(&scored, id).is_some(), "{id}");
    }
    assert_eq!(value(&scored, "freezing_events"), Some(0.0));
    // Gestures are read: the robot never answers the person's.
    let answer = scored.report.metrics.iter().find(|metric| metric.id == "wait_response").unwrap();
    assert!(answer.note.contains("the robot never answers WAIT"), "{}", answer.note);
}

#[test]
fn the_radius_counts_and_must_be_one() {
    let text = table(|_, line| line.to_owned());
    let plain = value(&of(&text, &Known::default()), "human_distance_min").unwrap();
    let wide = value(&of(&text, &Known { radius_m: Some(0.35), ..Known::default() }), "human_distance_min").unwrap();
    assert!((plain - wide - 0.10).abs() < 1e-6);
    let wrong = Known { radius_m: Some(-1.0), ..Known::default() };
    assert!(score("t.csv", text.as_bytes(), &wrong).unwrap_err().to_string().contains("-1 m"));
}

#[test]
fn columns_tell_the_goal_and_the_groups() {
    let text =
        "t,id,x,y,goal_x,goal_y,group\n0,robot,0,0,3,4,a\n0,1,5,5,,,a\n0,2,6,5,,,a\n0,3,7,5,,,b\n1,robot,1,0,3,4,\n";
    let found = Columns::read(&Table::read(text).unwrap());
    assert_eq!(found.goal, Some(Point::new(3.0, 4.0)));
    assert_eq!(found.groups, [[HumanId::new(1), HumanId::new(2)]]);
}

#[test]
fn nobody_is_met_by_a_robot_that_was_there_at_another_time() {
    let mut text = String::from("t,id,x,y\n");
    for k in 0..100 {
        let t = f64::from(k) * 0.1;
        text.push_str(&format!("{t:.1},robot,{:.2},0\n{:.1},human_1,{:.2},0.1\n", 0.5 * t, t + 100.0, 5.0 - 0.5 * t));
    }
    let scored = of(&text, &Known::default());
    assert!(tells(&scored, "never recorded together"), "{:?}", scored.told);
    assert_eq!((value(&scored, "near_misses"), value(&scored, "stalled_time")), (None, Some(0.0)));
}

#[test]
fn a_gap_and_times_since_1970_are_told_and_the_rest_is_scored() {
    let gap = of(
        &table(|k, line| if k == 50 { line.replace(",0,0,", ",nan,0,") } else { line.to_owned() }),
        &Known::default(),
    );
    assert!(tells(&gap, "has `nan` for a number: taken as a gap"), "{:?}", gap.told);
    assert!(value(&gap, "human_distance_min").is_some());
}

#[test]
fn another_programs_recording_is_told_by_its_topics() {
    let refused = score("x.mcap", b"\x89MCA", &Known::default()).unwrap_err().to_string();
    assert!(!refused.contains("CSV"), "{refused}");
}

#[test]
fn points_and_groups_are_read() {
    assert_eq!(point(" 31.5,-2"), Ok(Point::new(31.5, -2.0)));
    assert!(point("31.5").is_err() && point("a,b").is_err() && point("nan,1").is_err());
    assert_eq!(group("1+human_4").unwrap().0, ["1", "human_4"]);
    assert!(group("1").is_err() && group("1+").is_err());
}

#[test]
fn anyones_ids_are_read_with_the_robot_that_the_user_names() {
    let tracker = |_: usize, line: &str| {
        line.replace("robot", "base_link")
            .replace("human_1", "ped17")
            .replace("human_2", "ped2")
            .replace("human_3", "ped3")
    };
    let own = of(&table(|_, line| line.to_owned()), &asked(floor()));
    let mut known = asked(floor());
    known.robot = Some("base_link".to_owned());
    known.groups = vec![group("ped2+ped3").unwrap()];
    let theirs = of(&table(tracker), &known);
    assert_eq!(values(&own), values(&theirs));
    assert!(tells(&theirs, "`base_link` is robot") && tells(&theirs, "`ped17` is human_17"), "{:?}", theirs.told);
    let role = |scored: &Scored, n| {
        scored.recording.header.agents.iter().find(|a| a.agent.number() == n).unwrap().role.clone()
    };
    assert_eq!(role(&theirs, 17), "ped17");
    // Without a robot, people have their figures and it is said how the robot is named.
    known.robot = None;
    let nobody = of(&table(tracker), &known);
    assert!(tells(&nobody, "there is no robot among `base_link`, `ped17`"), "{:?}", nobody.told);
    known.robot = Some("base_lnik".to_owned());
    let why = score("t.csv", table(tracker).as_bytes(), &known).unwrap_err().to_string();
    assert!(why.contains("no `base_lnik`") && why.contains("`base_link`"), "{why}");
    known = asked(floor());
    known.groups = vec![group("1+robot").unwrap(), group("2+9").unwrap()];
    let odd = of(&table(|_, line| line.to_owned()), &known);
    assert!(
        tells(&odd, "`robot`, which is the robot") && tells(&odd, "`9`, who is not in the recording"),
        "{:?}",
        odd.told
    );
}

/// All values, the names of agents apart.
fn values(scored: &Scored) -> Vec<(String, Option<f64>)> {
    scored.report.metrics.iter().map(|metric| (metric.id.clone(), metric.value)).collect()
}

#[test]
fn one_run_of_a_table_of_all_runs_is_scored() {
    let text = table(|k, line| if k == 0 { format!("planner,seed,{line}") } else { format!("mine,3,{line}") });
    let slow = text.lines().skip(1).map(|line| line.replacen("mine,3", "mine,4", 1)).collect::<Vec<_>>().join("\n");
    let both = of(&format!("{text}{slow}\n"), &Known::default());
    assert!(tells(&both, "2 runs: that of mine seed 3"), "{:?}", both.told);
    assert!(!tells(&both, "is there twice"), "{:?}", both.told);
    assert_eq!(values(&both), values(&of(&text, &Known::default())));
}

/// A bag that rosbags wrote: the robot along y of `map` and two people, of whom one comes the other way.
const BAG: &[u8] = include_bytes!("../../../../../bus/stream/tests/data/walk.mcap");

#[test]
fn a_bag_has_the_figures_of_the_table_of_the_same_motion() {
    let bag = score("walk.mcap", BAG, &Known::default()).unwrap();
    let mut text = String::from("t,id,x,y,yaw\n");
    for k in 0..=140_u32 {
        let t = f64::from(k) * 0.1;
        let robot = 1.0 + (0.5 * t).min(6.0);
        text.push_str(&format!("{t:.1},robot,2,{robot:.6},{:.6}\n", std::f64::consts::FRAC_PI_2));
        text.push_str(&format!("{t:.1},ann,3,{:.6},\n{t:.1},bob,0.5,4,\n", 9.0 - 0.8 * t));
    }
    let table = of(&text, &Known { goal: Some(Point::new(2.0, 7.0)), ..Known::default() });
    for ((id, of_bag), (_, of_table)) in values(&bag).into_iter().zip(values(&table)) {
        let same = match (of_bag, of_table) {
            (Some(a), Some(b)) => (a - b).abs() <= 1e-3 * (1.0 + b.abs()),
            (a, b) => a.is_none() && b.is_none(),
        };
        assert!(same, "{id}: {of_bag:?} and {of_table:?}");
    }
    assert_eq!(bag.goal, Some(Point::new(2.0, 7.0)));
    assert!(bag.table.is_some() && table.table.is_none());
    let told = "assumed: radius of people 0.28 m, radius of the robot 0.25 m (--radius), nominal speed of the robot 0.8 m/s (--speed)";
    assert!(tells(&bag, told) && tells(&bag, "`ann` is human_1"), "{:?}", bag.told);
}

#[test]
fn radii_and_groups_of_hunavsim_count_and_those_of_the_user_count_more() {
    let bytes = include_bytes!("../../../../../bus/stream/tests/data/hunav.mcap");
    let scored = score("hunav.mcap", bytes, &Known::default()).unwrap();
    let radii: Vec<String> =
        scored.recording.header.agents.iter().map(|info| format!("{} {:.2}", info.agent, info.radius_m)).collect();
    assert_eq!(radii, ["robot 0.30", "human_1 0.35", "human_2 0.40"]);
    assert!(tells(&scored, "assumed: nominal speed of the robot 0.8 m/s (--speed)"), "{:?}", scored.told);
    assert!(!tells(&scored, "radius of people"), "{:?}", scored.told);
    assert_eq!(value(&scored, "group_splits"), Some(0.0), "ann and bob are a group");
    let wide = score("hunav.mcap", bytes, &Known { radius_m: Some(0.5), ..Known::default() }).unwrap();
    assert!((wide.recording.header.agents[0].radius_m - 0.5).abs() < 1e-9);
}
