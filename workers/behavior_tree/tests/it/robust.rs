//! Many rule lists and many broken documents: always an answer, never a panic, never without end.

use std::collections::BTreeMap;

use crate::common::Room;
use socrates_bt::{
    CheckContext, Format, Library, Meaning, NodeSheet, Options, PortKind, Tree, check, compile, convert, draw_svg,
    draw_text, nodes,
};
use socrates_model::seeds::SplitMix64;
use socrates_model::{Action, FaultCode, Gesture, HumanId, Rule, Trigger};

/// Throws of a fixed sequence.
struct Dice(SplitMix64);

impl Dice {
    fn below(&mut self, n: usize) -> usize {
        self.0.below(n)
    }
    fn pick<T: Clone>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())].clone()
    }
}

fn trigger(dice: &mut Dice) -> Trigger {
    let m = dice.pick(&[1.0, 2.0, 3.5, 5.0, 8.0]);
    let gesture = dice.pick(&Gesture::ALL);
    let choices = [
        Trigger::Always,
        Trigger::RobotVisible(m),
        Trigger::RobotVisible(m),
        Trigger::RobotNear(m),
        Trigger::RobotBlocking(m),
        Trigger::RobotMoving,
        Trigger::RobotStopped,
        Trigger::RobotSays(gesture),
        Trigger::HumanSays(HumanId::new(2), gesture),
        Trigger::GoalReached,
        Trigger::AtEncounter,
        Trigger::AfterSecs(m * 3.0),
    ];
    dice.pick(&choices)
}

fn rules(dice: &mut Dice) -> Vec<Rule> {
    let actions = [
        Action::Navigate,
        Action::FollowRobot,
        Action::FollowHuman(HumanId::new(2)),
        Action::RunAway,
        Action::GiveWay,
        Action::Block,
        Action::LookAtRobot,
        Action::Approach,
        Action::StandStill,
    ];
    (0..dice.below(5))
        .map(|_| Rule {
            when: (0..dice.below(4)).map(|_| trigger(dice)).collect(),
            act: dice.pick(&actions),
            gesture: dice.pick(&[None, None, Some(Gesture::Wait), Some(Gesture::Proceed)]),
            for_s: dice.pick(&[None, Some(2.0), Some(7.5)]),
            latched: dice.below(3) == 0,
            ..Rule::default()
        })
        .collect()
}

#[test]
fn a_rule_list_compiles_or_has_a_rule_that_cannot_run() {
    let mut dice = Dice(SplitMix64::new(7));
    let mut compiled = 0;
    for _ in 0..1500 {
        let rules = rules(&mut dice);
        match compile(HumanId::new(1), &rules) {
            Ok(xml) => {
                let tree = Tree::parse(&xml).unwrap();
                assert!(rules.iter().all(|rule| tree.actions().contains(&rule.act)));
                compiled += 1;
            }
            Err(faults) => {
                for fault in &faults {
                    assert!(matches!(fault.code, FaultCode::BDead | FaultCode::BContra), "{rules:#?}\n{fault}");
                }
            }
        }
    }
    assert!(compiled > 500, "only {compiled} lists compiled");
}

/// Changes, drops, doubles or swaps a few bytes.
fn broken(text: &str, dice: &mut Dice) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..=dice.below(4) {
        if bytes.is_empty() {
            break;
        }
        let at = dice.below(bytes.len());
        match dice.below(5) {
            0 => bytes[at] = dice.below(256) as u8,
            1 => bytes.truncate(at),
            2 => {
                let end = (at + dice.below(40)).min(bytes.len());
                bytes.drain(at..end);
            }
            3 => {
                let end = (at + dice.below(80)).min(bytes.len());
                let part: Vec<u8> = bytes[at..end].to_vec();
                let to = dice.below(bytes.len());
                bytes.splice(to..to, part);
            }
            _ => bytes[at] = dice.pick(b"<>/\"'{}&;=0123456789 "),
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[test]
fn no_broken_document_is_taken_without_an_answer() {
    let mut dice = Dice(SplitMix64::new(11));
    let rule = Rule {
        when: vec![Trigger::RobotVisible(5.0), Trigger::RobotStopped],
        act: Action::LookAtRobot,
        gesture: Some(Gesture::Wait),
        for_s: Some(5.0),
        latched: true,
        ..Rule::default()
    };
    let rules = [rule];
    let v3 = compile(HumanId::new(1), &rules).unwrap();
    let v4 = Tree::parse(&v3).unwrap().to_xml(Format::V4);
    let scripted = "<root BTCPP_format='4' main_tree_to_execute='T'><BehaviorTree ID='T'><Repeat num_cycles='3'>\
        <Parallel success_count='1' failure_count='1'><Script code='n := 1; m := n + 2'/>\
        <StandStill agent_id='{id}' _skipIf='n &gt; 3'/></Parallel></Repeat></BehaviorTree></root>";
    let humans = BTreeMap::new();
    let ctx = CheckContext { human: HumanId::new(1), humans: 1, robot_says: &[], human_says: &humans, rules: &rules };
    for text in [v3.as_str(), v4.as_str(), scripted] {
        for _ in 0..3000 {
            match Tree::parse(&broken(text, &mut dice)) {
                Ok(tree) => {
                    let mut state = tree.start();
                    Room::default().tick(&tree, &mut state);
                    let found = check(&tree, &ctx);
                    assert!(found.iter().all(|fault| fault.message.bytes() > 0));
                    Tree::parse(&tree.to_xml(tree.format())).unwrap_or_else(|faults| panic!("{faults:#?}"));
                }
                Err(faults) => assert!(!faults.is_empty() && faults.iter().all(|fault| fault.message.bytes() > 0)),
            }
        }
    }
}

#[test]
fn nested_repetitions_come_back() {
    let mut body = "<StandStill agent_id='{id}'/>".to_owned();
    for _ in 0..8 {
        body = format!("<Repeat num_cycles='-1'>{body}</Repeat>");
    }
    let xml = format!("<root main_tree_to_execute='T'><BehaviorTree ID='T'>{body}</BehaviorTree></root>");
    let tree = Tree::parse(&xml).unwrap();
    let mut state = tree.start();
    let mut room = Room::default();
    for _ in 0..3 {
        assert!(!room.tick(&tree, &mut state).is_empty());
    }
}

/// A random tree of every kind of node of a library, with ports that are allowed.
fn generated(dice: &mut Dice, library: Library, format: Format) -> String {
    let sheets = nodes::known_to(library);
    let fits = |sheet: &&NodeSheet| sheet.only_in().is_none_or(|only| only == format);
    let all: Vec<&NodeSheet> = sheets.into_iter().filter(fits).collect();
    let leaves: Vec<&NodeSheet> = all.iter().copied().filter(|sheet| sheet.arity.most == 0).collect();
    let attribute = if format == Format::V4 { "BTCPP_format='4' " } else { "" };
    let body = branch(dice, &all, &leaves, format, 4);
    let inner = branch(dice, &all, &leaves, format, 1).replace("ID=\"S\"", "ID=\"RegularNavTree\"");
    format!(
        "<root {attribute}main_tree_to_execute='T'><include path='BTRegularNav.xml'/>\
         <BehaviorTree ID='T'>{body}</BehaviorTree><BehaviorTree ID='S'>{inner}</BehaviorTree></root>"
    )
}

fn branch(dice: &mut Dice, all: &[&NodeSheet], leaves: &[&NodeSheet], format: Format, depth: usize) -> String {
    let sheet = if depth == 0 { dice.pick(leaves) } else { dice.pick(all) };
    let arity = sheet.arity_in(format);
    let most = arity.most.min(arity.least + 2);
    let n = arity.least + dice.below(most - arity.least + 1);
    let below: String = (0..n).map(|_| branch(dice, all, leaves, format, depth.saturating_sub(1))).collect();
    let mut text = format!("<{}", if format == Format::V3 { sheet.v3_tag.unwrap_or(sheet.tag) } else { sheet.tag });
    for port in sheet.ports {
        if port.default.is_some() && dice.below(2) == 0 {
            continue;
        }
        let value = match port.kind {
            PortKind::Own => "{id}",
            PortKind::Step => dice.pick(&["{dt}", "0.01"]),
            PortKind::Meters | PortKind::Distance | PortKind::Span | PortKind::Seconds | PortKind::Speed => {
                dice.pick(&["1.5", "3", "{x}"])
            }
            PortKind::Number => dice.pick(&["-2.5", "3", "{x}"]),
            PortKind::Gesture => dice.pick(&["0", "1", "4"]),
            PortKind::Human | PortKind::Agent => dice.pick(&["1", "2"]),
            PortKind::Agents => "2,3",
            PortKind::Flag => dice.pick(&["true", "False", "1"]),
            PortKind::Count(least) => {
                if least < 0 {
                    dice.pick(&["-1", "2"])
                } else {
                    "2"
                }
            }
            PortKind::Text if port.name == "ID" => "S",
            PortKind::Text => dice.pick(&["a &lt;b&gt; &amp; &quot;c&quot;", "1", "{x}", "", "two&#10;lines\u{e4}"]),
            PortKind::Key => "x",
            PortKind::Output => "{x}",
            PortKind::Code => dice.pick(&["x := 1", "x := 'a'; y := x .. 'b'", "x := 2; x += 3 &lt; 4 ? 1 : 2"]),
            PortKind::Angle | PortKind::Share => "0.5",
        };
        let name = if format == Format::V4 { port.v4_name.unwrap_or(port.name) } else { port.name };
        text.push_str(&format!(" {name}=\"{value}\""));
    }
    if format == Format::V4 && dice.below(6) == 0 {
        text.push_str(dice.pick(&[" _skipIf='x == 1'", " _while='x != 2'", " _onSuccess='x := 1'", " _post='y := 3'"]));
    }
    if below.is_empty() {
        return text + "/>";
    }
    let tag = if format == Format::V3 { sheet.v3_tag.unwrap_or(sheet.tag) } else { sheet.tag };
    format!("{text}>{below}</{tag}>")
}

/// What holds for every tree that was read: it ticks, is drawn, and is written so that it reads back the same.
fn holds_for(tree: &Tree, options: &Options<'_>) {
    let mut state = tree.start_with(&BTreeMap::from([("id".to_owned(), "1".to_owned())]));
    let mut room = Room { distance_m: Some(2.0), visible: true, moving: true, ..Room::default() };
    let bytes = state.bytes();
    for _ in 0..3 {
        room.tick(tree, &mut state);
    }
    assert_eq!(state.bytes(), bytes);
    let xml = tree.to_xml(tree.format());
    let copy = Tree::parse_with(&xml, options).unwrap_or_else(|faults| panic!("{faults:#?} in {xml}"));
    assert_eq!(copy.to_xml(copy.format()), xml);
    assert_eq!(draw_text(&copy), draw_text(tree));
    assert!(draw_svg(tree).ends_with("</svg>\n"));
    for format in [Format::V3, Format::V4] {
        let (xml, notes) = convert(tree, format, options.library);
        let cannot = notes.iter().any(|note| note.message.contains("cannot load") || note.message.contains("demands"));
        match Tree::parse_with(&xml, options) {
            Ok(other) => assert_eq!(other.format(), format),
            Err(faults) => assert!(cannot, "{faults:#?} in {xml}, made without a word: {notes:#?}"),
        }
    }
}

const LIBRARIES: [Library; 5] =
    [Library::Native, Library::SocratesFork, Library::HunavSim1_0, Library::HunavSim1_1, Library::HunavSim2];

#[test]
fn generated_trees_of_every_library_read_tick_draw_and_write() {
    let mut dice = Dice(SplitMix64::new(23));
    for round in 0..400 {
        for library in LIBRARIES {
            for format in [Format::V3, Format::V4] {
                let xml = generated(&mut dice, library, format);
                let options = Options { library, meaning: Meaning::World, ..Options::default() };
                match Tree::parse_with(&xml, &options) {
                    Ok(tree) => holds_for(&tree, &options),
                    Err(faults) => panic!("round {round} {library:?} {format:?}: {faults:#?} in {xml}"),
                }
            }
        }
    }
}

/// Swaps tags, doubles or drops elements, and breaks bytes.
fn mutated(xml: &str, dice: &mut Dice) -> String {
    const TAGS: [&str; 6] = ["Sequence", "Fallback", "Inverter", "Parallel", "SubTree", "Nothing"];
    match dice.below(4) {
        0 => {
            let (from, to) = (dice.pick(&TAGS), dice.pick(&TAGS));
            xml.replacen(from, to, 1 + dice.below(3))
        }
        1 => {
            let parts: Vec<&str> = xml.split_inclusive('>').collect();
            if parts.is_empty() {
                return String::new();
            }
            let at = dice.below(parts.len());
            let copies = dice.below(3);
            let part = |(place, part): (usize, &&str)| part.repeat(if place == at { copies } else { 1 });
            parts.iter().enumerate().map(part).collect()
        }
        _ => broken(xml, dice),
    }
}

#[test]
fn mutated_trees_are_refused_with_places_or_hold() {
    let mut dice = Dice(SplitMix64::new(29));
    let (mut taken, mut refused) = (0, 0);
    for _ in 0..250 {
        for library in LIBRARIES {
            let format = dice.pick(&[Format::V3, Format::V4]);
            let mut xml = generated(&mut dice, library, format);
            let options = Options { library, meaning: Meaning::World, ..Options::default() };
            for _ in 0..4 {
                xml = mutated(&xml, &mut dice);
                match Tree::parse_with(&xml, &options) {
                    Ok(tree) => {
                        taken += 1;
                        holds_for(&tree, &options);
                    }
                    Err(faults) => {
                        refused += 1;
                        assert!(!faults.is_empty());
                        for fault in faults {
                            let place = fault.at.line.zip(fault.at.column);
                            assert!(
                                place.is_some_and(|(line, column)| line > 0 && column > 0),
                                "no place in `{fault}`"
                            );
                            assert!(fault.message.bytes() > 0);
                        }
                    }
                }
            }
        }
    }
    assert!(taken > 300 && refused > 300, "{taken} taken, {refused} refused");
}
