//! Worlds of Gazebo, read back from their text.

use std::collections::BTreeMap;

use socrates_export::scenario::{Content, File, Format, Scenario};
use socrates_model::{AgentId, Cell, DoorOpens, Point, Pose};

use crate::whole::{whole, without};

fn world(format: &str, scenario: &Scenario) -> String {
    let package = Format::named(format).unwrap().export(scenario).unwrap_or_else(|why| panic!("{format}: {why}"));
    let file = package.files.iter().find(|(name, _)| name.ends_with(".world"));
    match file {
        Some((_, File::Text(text))) => text.clone(),
        other => panic!("{other:?}"),
    }
}

/// What stands between two marks, each time.
fn between<'a>(text: &'a str, from: &'a str, to: &'a str) -> impl Iterator<Item = &'a str> {
    text.split(from).skip(1).map(move |rest| rest.split(to).next().unwrap())
}

fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace().map(|number| number.parse().unwrap()).collect()
}

/// Boxes of walls: pose and size.
fn boxes(text: &str) -> Vec<(Vec<f64>, Vec<f64>)> {
    let walls = between(text, "<collision name=\"wall_", "</collision>");
    walls
        .map(|wall| {
            let one = |from, to| numbers(between(wall, from, to).next().unwrap());
            (one("<pose>", "</pose>"), one("<size>", "</size>"))
        })
        .collect()
}

/// Whether the occupied cells are those whose middle lies in a box.
fn same_walls(scenario: &Scenario, boxes: &[(Vec<f64>, Vec<f64>)]) {
    let grid = &scenario.location.grid;
    let mut inside = BTreeMap::new();
    for (pose, size) in boxes {
        let (sin, cos) = pose[5].sin_cos();
        let half = [size[0] / 2.0, size[1] / 2.0];
        let reach = half[0].hypot(half[1]) / grid.resolution_m + 2.0;
        let (px, py) = grid.pixel_from_world(&Point::new(pose[0], pose[1]));
        for row in (py - reach).max(0.0) as usize..(py + reach) as usize {
            for column in (px - reach).max(0.0) as usize..(px + reach) as usize {
                let off = grid.center_of(column, row) - Point::new(pose[0], pose[1]);
                let (along, across) = (off.x * cos + off.y * sin, off.y * cos - off.x * sin);
                if along.abs() < half[0] && across.abs() < half[1] {
                    *inside.entry((column, row)).or_insert(0) += 1;
                }
            }
        }
    }
    for row in 0..grid.height {
        for column in 0..grid.width {
            let found = inside.get(&(column, row)).copied().unwrap_or(0);
            assert_eq!(found, i32::from(grid.at(column, row) == Cell::Occupied), "{column} {row}");
        }
    }
}

#[test]
fn the_boxes_of_a_world_are_the_occupied_cells_on_straight_and_turned_maps() {
    let mut scenario = whole();
    same_walls(&scenario, &boxes(&world("sdf", &scenario)));
    scenario.location.grid.origin = Pose::new(-7.5, 3.25, 0.7);
    let text = world("sdf", &scenario);
    let boxes = boxes(&text);
    assert!(
        boxes.len() > 20
            && boxes.iter().all(|(pose, size)| (pose[5] - 0.7).abs() < 1e-9 && (size[2] - 2.5).abs() < 1e-9)
    );
    same_walls(&scenario, &boxes);
    assert!(!text.contains("NaN") && !text.contains("inf"));
}

#[test]
fn an_actor_is_within_a_millimeter_of_the_run_at_every_tick() {
    let scenario = whole();
    let run = scenario.recording.as_ref().unwrap();
    let text = world("sdf", &scenario);
    let actors: Vec<&str> = between(&text, "<actor name=\"", "</actor>").collect();
    assert_eq!(actors.len(), 2);
    for (actor, number) in actors.iter().zip(1..) {
        assert!(actor.starts_with(&format!("human_{number}\"")));
        let poses: Vec<(f64, Vec<f64>)> = between(actor, "<waypoint>", "</waypoint>")
            .map(|pose| {
                let time = between(pose, "<time>", "</time>").next().unwrap().parse().unwrap();
                (time, numbers(between(pose, "<pose>", "</pose>").next().unwrap()))
            })
            .collect();
        for state in run.track(AgentId::from_number(number)).filter(|state| state.is_there(run.header.absent())) {
            let time = state.tick as f64 * 0.01;
            let pair = poses.windows(2).find(|pair| pair[0].0 <= time + 1e-9 && time <= pair[1].0 + 1e-9).unwrap();
            let share = (time - pair[0].0) / (pair[1].0 - pair[0].0);
            let at = |axis: usize| pair[0].1[axis] + (pair[1].1[axis] - pair[0].1[axis]) * share;
            assert!((at(0) - state.x).hypot(at(1) - state.y) < 0.001 + 1e-6, "{number} at {time}");
            assert!((at(5) - state.yaw).sin().abs() < 0.021);
        }
    }
    // Human 2 comes at 3 s, which an actor cannot.
    let package = Format::named("sdf").unwrap().export(&scenario).unwrap();
    let row = package.losses.rows().iter().find(|row| row.what == "absence of people").unwrap();
    assert_eq!((row.count, row.at[0].as_str()), (1, "recording: human_2"));
}

#[test]
fn doors_stand_on_their_lines_and_those_that_are_always_open_beside_them() {
    let mut scenario = whole();
    let door = scenario.location.doors[0].clone();
    let text = world("sdf", &scenario);
    let model = |text: &str| between(text, "<model name=\"door_", "</model>").next().unwrap().to_owned();
    let (closed, middle) = (model(&text), door.middle());
    let pose = numbers(between(&closed, "<pose>", "</pose>").next().unwrap());
    assert!((pose[0] - middle.x).abs() < 1e-6 && (pose[1] - middle.y).abs() < 1e-6, "{pose:?}");
    let leaf = |model: &str| numbers(between(model, "<pose>", "</pose>").nth(1).unwrap())[0];
    assert!(leaf(&closed).abs() < 1e-9);
    scenario.location.doors[0].opens = DoorOpens::Always;
    let open = model(&world("sdf", &scenario));
    let length = (door.to - door.from).norm();
    assert!((leaf(&open) - length).abs() < 1e-5, "{open}");
    assert!(open.contains("<upper>0.0</upper>") && closed.contains("<lower>0.0</lower>"));
    let none = without(&scenario, Content::Doors);
    assert!(!world("sdf", &none).contains("door_"));
}
