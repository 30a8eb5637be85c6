//! Whole folders: a foreign one, and one with a flaw in every file.

#[cfg(test)]
mod folders {
    use std::collections::BTreeMap;

    use socrates_maps::{DistanceField, generate, load, parse, shipped};
    use socrates_model::{Fault, FaultCode, NodeId, PlaceClass};
    use socrates_tests::skip::shared;

    fn codes(faults: &[Fault]) -> Vec<FaultCode> {
        faults.iter().map(|fault| fault.code).collect()
    }

    #[test]
    fn a_foreign_location_is_read_with_its_extra_key_as_a_warning() {
        let Some(dir) = shared("socrates_hunav/socrates/locations/small_warehouse") else { return };
        let location = load(&dir).unwrap_or_else(|faults| panic!("{faults:#?}"));
        assert_eq!((location.graph.nodes().len(), location.graph.edges().len()), (18, 19));
        assert_eq!(location.name, "small_warehouse");
        assert_eq!(location.warnings.len(), 1, "{:?}", location.warnings);
        assert!(location.warnings[0].contains("`type`"), "{:?}", location.warnings);
        // Node `ef` is at pixel (88, 31) of 250 by 250 at 0.1 m from (-12.5, -12.5).
        let node = location.graph.node(&NodeId::new("ef").unwrap()).unwrap();
        assert!((node.at.x - -3.7).abs() < 1e-9 && (node.at.y - 9.4).abs() < 1e-9, "{}", node.at);
        assert_eq!(PlaceClass::of_type(&node.kind), PlaceClass::BlindCorner);
        let field = DistanceField::new(&location.grid);
        assert!(location.graph.nodes().iter().all(|node| field.clearance(&node.at) > 0.1));
    }

    #[test]
    fn a_location_off_the_center_is_read_with_its_extra_key_as_a_warning() {
        let location =
            load(&socrates_tests::root().join(socrates_tests::ANNEX)).unwrap_or_else(|faults| panic!("{faults:#?}"));
        assert_eq!((location.graph.nodes().len(), location.graph.edges().len()), (20, 21));
        assert_eq!((location.name.as_str(), location.grid.width, location.grid.height), ("annex", 120, 80));
        assert_eq!(location.warnings.len(), 1, "{:?}", location.warnings);
        assert!(location.warnings[0].contains("`type`"), "{:?}", location.warnings);
        // 0.2 m a pixel from (-3, -12.4): `a1` is at pixel (13, 68) of 80 rows, `c7` at pixel (107, 31).
        for (id, x, y, class) in [("a1", -0.4, -10.0, Some(PlaceClass::BlindCorner)), ("c7", 18.4, -2.6, None)] {
            let node = location.graph.node(&NodeId::new(id).unwrap()).unwrap();
            assert!((node.at.x - x).abs() < 1e-9 && (node.at.y - y).abs() < 1e-9, "{id}: {}", node.at);
            assert!(class.is_none_or(|class| PlaceClass::of_type(&node.kind) == class), "{id}");
        }
        // The nearest wall of `a1` is 2.0 m below it; `b4` stands between racks, 1.6 m from either.
        let field = DistanceField::new(&location.grid);
        for (id, clearance_m) in [("a1", 2.0), ("b4", 1.6)] {
            let at = location.graph.node(&NodeId::new(id).unwrap()).unwrap().at;
            assert!((field.clearance(&at) - clearance_m).abs() < 0.3, "{id}: {}", field.clearance(&at));
        }
    }

    #[test]
    fn a_map_without_its_graph_or_its_image_misses_just_that() {
        let dir = socrates_tests::root().join(socrates_tests::ANNEX);
        let read = |names: &[&str]| -> BTreeMap<String, Vec<u8>> {
            names.iter().map(|name| ((*name).to_owned(), std::fs::read(dir.join(name)).unwrap())).collect()
        };
        let found = |names: &[&str]| {
            let mut found = codes(&parse(&read(names), "annex").unwrap_err());
            found.sort();
            found
        };
        assert_eq!(found(&["map.yaml", "map.pgm"]), [FaultCode::MRead]);
        assert_eq!(found(&["map.yaml"]), [FaultCode::MRead, FaultCode::MImage]);
        assert_eq!(found(&["map.yaml", "scene_graph.json"]), [FaultCode::MImage]);
    }

    #[test]
    fn foreign_map_images_are_read_and_only_the_missing_graph_is_missed() {
        for (folder, maps) in [
            ("hunav_sim_v1_1/maps", ["cafe", "map_cafe2", "small_house", "small_warehouse"].as_slice()),
            ("isaac_wrapper_v2/maps", ["office", "warehouse"].as_slice()),
        ] {
            let Some(dir) = shared(&format!("socrates_hunav/{folder}")) else { return };
            for map in maps {
                let mut files = BTreeMap::new();
                for entry in std::fs::read_dir(&dir).unwrap() {
                    let path = entry.unwrap().path();
                    let name = path.file_name().unwrap().to_string_lossy().into_owned();
                    files.insert(name, std::fs::read(&path).unwrap());
                }
                let Some(yaml) = files.get(&format!("{map}.yaml")).cloned() else { panic!("{map}") };
                files.insert("map.yaml".to_owned(), yaml);
                let faults = parse(&files, map).unwrap_err();
                // The image of the first one does not come with the folder.
                let image_there =
                    files.contains_key(&format!("{map}.pgm")) || files.contains_key(&format!("{map}.png"));
                let want = if image_there { vec![FaultCode::MRead] } else { vec![FaultCode::MRead, FaultCode::MImage] };
                let mut found = codes(&faults);
                found.sort();
                assert_eq!(found, want, "{map}: {faults:#?}");
            }
        }
    }

    #[test]
    fn flaws_of_all_files_are_named_at_once() {
        let dir = tempfile::tempdir().unwrap();
        let mut files = shipped::files("office").unwrap();
        let text = |files: &BTreeMap<String, Vec<u8>>, name: &str| String::from_utf8(files[name].clone()).unwrap();
        let yaml = text(&files, "map.yaml").replace("negate: 0", "negated: 0");
        let graph = text(&files, "scene_graph.json").replacen("\"INTERSECTION\"", "7", 1).replace("\"rx\"}", "\"ry\"}");
        let extra = text(&files, "location.toml").replace("hold_s", "holds");
        files.insert("map.yaml".into(), yaml.into_bytes());
        files.insert("scene_graph.json".into(), graph.into_bytes());
        files.insert("location.toml".into(), extra.into_bytes());
        files.insert("map.png".into(), b"\x89PNG broken".to_vec());
        for (name, bytes) in &files {
            std::fs::write(dir.path().join(name), bytes).unwrap();
        }
        let faults = load(dir.path()).unwrap_err();
        let all: String = faults.iter().map(|fault| format!("{fault}\n")).collect();
        for part in [
            "M-KEY map.yaml:5",
            "`negated`",
            "M-IMAGE map.png",
            "M-VALUE scene_graph.json:",
            "`ry`",
            "M-KEY location.toml:",
        ] {
            assert!(all.contains(part), "{part} not in\n{all}");
        }
    }

    #[test]
    fn an_empty_folder_names_what_belongs_there() {
        let dir = tempfile::tempdir().unwrap();
        let faults = load(dir.path()).unwrap_err();
        assert_eq!(codes(&faults), [FaultCode::MRead, FaultCode::MRead], "{faults:#?}");
        assert!(faults[0].message.to_string().contains("scene_graph.json"));
    }

    #[test]
    fn a_written_folder_loads_as_the_parsed_one() {
        let dir = tempfile::tempdir().unwrap();
        let folder = dir.path().join("office");
        std::fs::create_dir(&folder).unwrap();
        for (name, bytes) in shipped::files("office").unwrap() {
            std::fs::write(folder.join(name), bytes).unwrap();
        }
        assert_eq!(load(&folder).unwrap(), shipped::load("office").unwrap());
    }

    #[test]
    fn the_plan_of_the_readme_makes_a_location() {
        let readme = include_str!("../README.md");
        let plan = readme.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
        let files = generate(plan).unwrap_or_else(|faults| panic!("{faults:#?}"));
        let location = parse(&files, "fourth").unwrap();
        assert_eq!((location.graph.nodes().len(), location.doors.len()), (8, 1));
        assert_eq!(location.warnings, Vec::<String>::new());
    }

    /// Bytes of a little generator; the same every time.
    fn numbers() -> impl FnMut(usize) -> usize {
        let mut random = socrates_model::seeds::SplitMix64::new(0x9e37_79b9);
        move |n| random.below(n.max(1))
    }

    #[test]
    fn damaged_files_give_a_location_or_faults_and_never_a_panic() {
        let plan = include_str!("../README.md").split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
        let whole = generate(plan).unwrap();
        let mut number = numbers();
        let mut refused = 0;
        for name in whole.keys() {
            for _ in 0..150 {
                let mut files = whole.clone();
                let bytes = files.get_mut(name).unwrap();
                let at = number(bytes.len());
                match number(3) {
                    0 => bytes[at] = u8::try_from(number(256)).unwrap(),
                    1 => bytes.truncate(at),
                    _ => drop(bytes.drain(at..(at + 9).min(bytes.len()))),
                }
                match parse(&files, "damaged") {
                    Ok(location) => assert!(socrates_maps::check(&location).iter().all(Fault::is_soft)),
                    Err(faults) => {
                        refused += 1;
                        assert!(
                            !faults.is_empty()
                                && faults.iter().all(|fault| !fault.at.is_nowhere() && fault.message.bytes() > 0)
                        );
                    }
                }
            }
        }
        assert!(refused > 200, "{refused}");
    }

    #[test]
    fn damaged_plans_give_files_or_faults_and_never_a_panic() {
        let plan = include_str!("../README.md").split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
        let mut number = numbers();
        let mut refused = 0;
        for _ in 0..300 {
            let mut text: Vec<char> = plan.chars().collect();
            let at = number(text.len());
            match number(3) {
                0 => text[at] = ['9', '-', '.', 'e', ']', '"'][number(6)],
                1 => text.truncate(at),
                _ => text.insert(at, ['7', '0', ',', 'x'][number(4)]),
            }
            refused += usize::from(generate(&text.into_iter().collect::<String>()).is_err());
        }
        assert!(refused > 50, "{refused}");
    }
}
