//! Scenarios at the edge of formats: turned maps, ids above a range, very many people, odd names.

use socrates_export::scenario::{FORMATS, File, Format, Package, Scenario};
use socrates_model::{AgentId, AgentState, GroupId, HumanId, Point, Pose, recording::AgentInfo};

use crate::whole::whole;

fn texts(package: &Package) -> impl Iterator<Item = (&str, &str)> {
    package.files.iter().filter_map(|(name, file)| match file {
        File::Text(text) => Some((name.as_str(), text.as_str())),
        File::Bytes(_) | File::Database(_) | File::Columns(_) | File::Bag(_) => None,
    })
}

/// Another scenario in which the second human has this number.
fn renumbered(number: u32) -> Scenario {
    let mut scenario = whole();
    let (old, new) = (HumanId::new(2), HumanId::new(number));
    let agent = |agent: AgentId| if agent == AgentId::Human(old) { AgentId::Human(new) } else { agent };
    scenario.proposal.humans.iter_mut().filter(|human| human.id == old).for_each(|human| human.id = new);
    for group in &mut scenario.proposal.groups {
        group.members.iter_mut().filter(|member| **member == old).for_each(|member| *member = new);
    }
    if let Some(nodes) = scenario.paths.humans.remove(&old) {
        scenario.paths.humans.insert(new, nodes);
    }
    if let Some(behavior) = scenario.behaviors.humans.remove(&old) {
        scenario.behaviors.humans.insert(new, behavior);
    }
    let run = scenario.recording.as_mut().unwrap();
    run.header.agents.iter_mut().for_each(|info| info.agent = agent(info.agent));
    run.frames.iter_mut().filter(|state| state.agent == old.number()).for_each(|state| state.agent = number);
    scenario
}

/// Walls of every format that has some lie on the cells of a map that is turned.
#[test]
fn a_turned_map_turns_the_walls_of_every_format() {
    let mut scenario = whole();
    scenario.location.grid.origin = Pose::new(-3.0, 1.5, 0.3);
    let grid = &scenario.location.grid;
    // In cells of the map, whether a place is on the lattice of half cells.
    let on_lattice = |x: f64, y: f64| {
        let (px, py) = grid.pixel_from_world(&Point::new(x, y));
        [px, py].iter().all(|side| (side * 2.0 - (side * 2.0).round()).abs() < 1e-3)
    };
    let numbers = |text: &str| -> Vec<f64> {
        let parts = text.split(|letter: char| !(letter.is_ascii_digit() || "+-.e".contains(letter)));
        parts.filter_map(|number| number.parse().ok()).collect()
    };
    let mut looked = 0;
    let mut look = |format: &str, ending: &str, mark: &str, end: &str, skip: usize| {
        let package = Format::named(format).unwrap().export(&scenario).unwrap_or_else(|why| panic!("{format}: {why}"));
        let text = texts(&package).find(|(name, _)| name.ends_with(ending)).unwrap_or_else(|| panic!("{format}")).1;
        let mut walls = 0;
        for part in text.split(mark).skip(1) {
            let found = numbers(part.split(end).next().unwrap());
            let (x, y) = (found[skip], found[skip + 1]);
            assert!(on_lattice(x, y), "{format}: a wall at {x}, {y}");
            walls += 1;
        }
        assert!(walls > 20, "{format}: {walls} walls");
        looked += 1;
    };
    look("sdf", ".world", "<collision name=\"wall_", "</pose>", 1);
    look("usda", ".usda", "def Cube \"wall_", "double xformOp:rotateZ", 9);
    look("humansim", ".yaml", "name: wall_", "end:", 1);
    look("arena-5", "world.yaml", "  - {start:", "end:", 0);
    assert_eq!(looked, 4);
    // A piece at an axis is nudged by a millimeter in a kit, so its turn is looked at.
    let kit = Format::named("hunav-1.1").unwrap().export(&scenario).unwrap();
    let world = texts(&kit).find(|(name, _)| name.ends_with(".world")).unwrap().1;
    let walls = world.split("<model name=\"wall_").skip(1).map(|part| numbers(part.split("</pose>").next().unwrap()));
    assert!(walls.clone().count() > 20 && walls.clone().all(|pose| (pose.last().unwrap() - 0.3).abs() < 1e-6));
    for format in ["sdf", "rosbag2", "hunav-1.1", "arena-3", "arena-5"] {
        let package = Format::named(format).unwrap().export(&scenario).unwrap();
        let map = texts(&package).find(|(name, _)| name.ends_with("map.yaml")).unwrap().1;
        assert!(map.contains("origin: [-3.0, 1.5, 0.3]"), "{format}: {map}");
    }
}

#[test]
fn an_id_above_the_range_of_a_format_is_refused_and_others_keep_it() {
    let number = 4_000_000_000;
    let scenario = renumbered(number);
    let mut refused = Vec::new();
    for format in FORMATS {
        match format.export(&scenario) {
            Ok(package) => {
                let is_told = texts(&package).any(|(_, text)| text.contains(&number.to_string()));
                let has_names = !texts(&package).any(|(_, text)| text.contains("human_") || text.contains(" 1\t"));
                assert!(is_told || has_names, "{} loses the number", format.name);
            }
            Err(why) => {
                assert!(
                    why.to_string().contains("human_4000000000") && why.to_string().contains("2147483647"),
                    "{why}"
                );
                refused.push(format.name);
            }
        }
    }
    assert_eq!(refused, ["rosbag2-5", "hunav-1.0", "hunav-1.1", "hunav-2.0", "hunav-fork"]);
    let mut scenario = whole();
    scenario.proposal.groups[0].id = GroupId(300);
    let package = Format::named("rosbag2").unwrap().export(&scenario).unwrap();
    assert!(package.losses.rows().iter().any(|row| row.what == "groups above 254" && row.at[0].contains("300")));
}

/// Half a second of 10 000 people: written, or refused with the number and the limit.
#[test]
fn ten_thousand_people_are_written_or_refused_with_their_number() {
    let mut scenario = whole();
    let run = scenario.recording.as_mut().unwrap();
    let many = 10_000;
    let human = scenario.proposal.humans[0].clone();
    let ids: Vec<HumanId> = (1..=many).map(HumanId::new).collect();
    scenario.proposal.humans =
        ids.iter().map(|id| socrates_model::HumanProposal { id: *id, group: None, ..human.clone() }).collect();
    scenario.proposal.groups.clear();
    let info = run.header.agents[1].clone();
    run.header.agents.truncate(1);
    run.header.agents.extend(ids.iter().map(|id| AgentInfo { agent: (*id).into(), ..info.clone() }));
    let robot = run.frames[0];
    run.frames.clear();
    for tick in [0, 1] {
        run.frames.push(AgentState { tick, ..robot });
        let place = |id: &HumanId| AgentState {
            tick,
            agent: id.number(),
            flags: AgentState::flags((*id).into(), None, 1),
            x: 8.0 + f64::from(id.number() % 100) * 0.001,
            y: 12.0 + f64::from(id.number() / 100) * 0.001,
            ..robot
        };
        run.frames.extend(ids.iter().map(place));
    }
    let nodes = scenario.paths.humans[&HumanId::new(1)].clone();
    scenario.paths.humans = ids.iter().map(|id| (*id, nodes.clone())).collect();
    scenario.paths.encounters.clear();
    scenario.behaviors.humans.clear();
    for format in FORMATS {
        match format.export(&scenario) {
            Ok(package) => assert!(!package.files.is_empty(), "{}", format.name),
            Err(why) => {
                let said = why.to_string();
                assert!(said.contains("10000") || said.contains("tick"), "{}: {said}", format.name);
            }
        }
    }
}
