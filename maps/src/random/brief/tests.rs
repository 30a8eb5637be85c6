use super::*;
use crate::check;

fn brief(text: &str) -> BuildingBrief {
    toml::from_str(text).unwrap()
}

/// Briefs of every kind, with everything that can be asked.
const BRIEFS: [&str; 7] = [
    "kind = 'hospital'\nelevators = 2\nrooms = [{ type = 'ward', count = 2, name = 'ward' }]",
    "kind = 'hospital'\nform = 'ring'\ncorridor_m = 2.8\ndoor_m = 1.2\nelevators = 3\nrooms = [{ type = 'ward', count = 6, area_m2 = [20, 45] }, { type = 'nurse station', open = true }, { type = 'pharmacy', name = 'pharmacy', beside = 'ward', door_m = 1.4 }]",
    "kind = 'office'\nform = 'spine'\nrooms = [{ type = 'office', count = 8 }, { type = 'meeting room', count = 2, beside = 'kitchen' }, { type = 'kitchen' }]",
    "kind = 'office'\nform = 'two_rings'\nelevators = 1\nrooms = [{ type = 'meeting room', count = 3 }, { type = 'reception' }]",
    "kind = 'office'\nform = 'bend'\nonly = true\nrooms = [{ type = 'office', count = 5 }, { type = 'server', area_m2 = [8, 20] }]",
    "kind = 'home'\nrooms = [{ type = 'bedroom', count = 2 }, { type = 'kitchen' }, { type = 'bathroom' }]",
    "kind = 'hospital'\nform = 'wings'\nelevators = 4\nrooms = [{ type = 'operating room', count = 2, name = 'OP-Saal Süd' }]",
];

#[test]
fn a_building_has_what_its_brief_asks_for() {
    for (number, text) in BRIEFS.into_iter().enumerate() {
        let brief = brief(text);
        for seed in 0..3 {
            let built = match build(&brief, seed) {
                Ok(built) => built,
                Err(why) => panic!("{number} {seed}: {why:?}"),
            };
            assert_eq!(check(&built.location), [], "{number} {seed}");
            assert_eq!(built.location.warnings, Vec::<String>::new(), "{number} {seed}");
            let style = style(brief.kind);
            for row in brief.rooms.iter().map(|room| Asked::of(room, style)) {
                let rooms: Vec<&BuiltRoom> = built.rooms.iter().filter(|room| room.kind == row.template.kind).collect();
                assert_eq!(rooms.len(), usize::try_from(row.room.count).unwrap(), "{number} {seed} {}", row.room.kind);
                if let Some([least, most]) = row.room.area_m2 {
                    assert!(
                        rooms.iter().all(|room| room.area_m2 >= least - 1.0 && room.area_m2 <= most + 1.0),
                        "{rooms:?}"
                    );
                }
            }
            let lifts = built.location.doors.iter().filter(|door| door.kind == socrates_model::DoorKind::Elevator);
            assert_eq!(lifts.count(), usize::try_from(brief.elevators).unwrap(), "{number} {seed}");
            assert!(!brief.only || built.others.is_empty(), "{number} {seed}: {:?}", built.others);
            assert_eq!(built.files, build(&brief, seed).unwrap().files, "{number} {seed}");
        }
    }
}

#[test]
fn names_of_a_brief_are_names_of_the_location() {
    let wards = build(&brief(BRIEFS[0]), 1).unwrap().location;
    let names: Vec<&str> = wards.names.iter().map(|area| area.name.as_str()).collect();
    assert_eq!(names, ["ward 1", "ward 2"]);
    let first = wards.graph.node(&wards.names[0].nodes[0]).unwrap();
    assert_eq!(first.kind, "WARD");
}

#[test]
fn rooms_beside_each_other_share_a_wall() {
    let brief = brief(BRIEFS[2]);
    let style = style(brief.kind);
    let asked: Vec<Asked<'_>> = brief.rooms.iter().map(|room| Asked::of(room, style)).collect();
    let mut seen = 0;
    for seed in 0..40 {
        let mut chance = Chance::new(seed, "beside");
        let Some(attempt) = Attempt::draw(&brief, style, &asked, (80, 110), &mut chance) else { continue };
        if !attempt.unmet.is_empty() {
            continue;
        }
        let of = |kind: &str| attempt.draft.rooms.iter().filter(|room| room.kind == kind).collect::<Vec<_>>();
        let kitchen = of("KITCHEN")[0];
        assert!(of("MEETING ROOM").iter().all(|room| room.area.grown(3).meets(&kitchen.area)), "{seed}");
        seen += 1;
    }
    assert!(seen >= 5, "{seen}");
}

#[test]
fn what_cannot_be_met_is_named_with_what_was_asked() {
    let told = |text: &str| match build(&brief(text), 1) {
        Err(NotBuilt::Unmet(unmet)) => unmet.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"),
        other => panic!("{:?}", other.map(|built| built.rooms)),
    };
    for (text, part) in [
        ("kind = 'office'\nrooms = [{ type = 'hall', area_m2 = [900, 950] }]", "rooms `hall`: asked 1, 900 to 950 m²"),
        ("kind = 'home'\nform = 'spine'\nelevators = 3", "elevators: asked 3; got"),
        ("kind = 'office'\ncorridor_m = 9.0\nelevators = 1", "corridor_m: asked 9 m; allowed: 1.2 to 6 m"),
        ("kind = 'office'\nrooms = [{ type = 'kitchen', beside = 'pool' }]", "rooms `kitchen`: beside: asked `pool`"),
        ("kind = 'office'", "rooms: asked none"),
        (
            "kind = 'office'\nform = 'spine'\nrooms = [{ type = 'office', count = 40, area_m2 = [45, 60] }]",
            "rooms `office`: asked",
        ),
    ] {
        let told = told(text);
        assert!(told.contains(part), "{part} not in {told}");
    }
}

#[test]
fn widths_below_those_of_real_buildings_are_remarked() {
    let narrow =
        build(&brief("kind = 'hospital'\ncorridor_m = 1.8\ndoor_m = 0.9\nrooms = [{ type = 'ward', count = 2 }]"), 1);
    let remarks = narrow.unwrap().remarks;
    let found: Vec<(&str, f64)> = remarks.iter().map(|remark| (remark.what.as_str(), remark.least_m)).collect();
    assert_eq!(found, [("doorways", 1.05), ("corridors", 2.44)]);
    assert_eq!(build(&brief(BRIEFS[0]), 1).unwrap().remarks, []);
}
