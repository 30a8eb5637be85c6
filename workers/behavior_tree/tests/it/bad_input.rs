//! Bad documents, one kind after the other: each is refused with line, column, node, value and what is allowed.

use socrates_bt::{Options, Tree, decode};
use socrates_model::{Fault, FaultCode};

fn document(body: &str) -> String {
    format!("<root main_tree_to_execute='T'>\n<BehaviorTree ID='T'>\n{body}\n</BehaviorTree>\n</root>")
}

fn refused(xml: &str) -> Vec<Fault> {
    match Tree::parse(xml) {
        Ok(_) => panic!("taken: {}", xml.chars().take(200).collect::<String>()),
        Err(faults) => faults,
    }
}

/// One of the faults has this code and place, and says all of this.
fn says(xml: &str, code: FaultCode, at: &str, parts: &[&str]) {
    let faults = refused(xml);
    let fits = |fault: &&Fault| {
        fault.code == code
            && fault.at.to_string().starts_with(at)
            && parts.iter().all(|part| fault.to_string().contains(part))
    };
    assert!(faults.iter().any(|fault| fits(&fault)), "no {code} at {at} with {parts:?} in {faults:#?}");
    assert!(faults.iter().all(|fault| fault.message.bytes() < 3000), "a message is too long");
}

#[test]
fn unknown_nodes_and_ports_are_refused_with_the_nearest_name() {
    says(
        &document("  <Sequens/>"),
        FaultCode::BNode,
        "3:3",
        &["`Sequens`", "nearest: Sequence", "allowed: Sequence, Fallback"],
    );
    says(
        &document("<IsRobotVisible agent_id='{id}' distanse='2'/>"),
        FaultCode::BPort,
        "3:1",
        &["no attribute `distanse`", "nearest: distance", "allowed: agent_id, distance"],
    );
    says(&document("<IsRobotVisible agent_id='{id}'/>"), FaultCode::BPort, "3:1", &["lacks `distance`", "0.3 to 15 m"]);
}

#[test]
fn a_wrong_main_tree_is_refused_with_the_nearest_name() {
    let xml = "<root main_tree_to_execute='Tre'><BehaviorTree ID='Tree'><AlwaysSuccess/></BehaviorTree></root>";
    says(xml, FaultCode::BMain, "1:1", &["`Tre`", "nearest: Tree", "trees here: Tree"]);
    says("<root main_tree_to_execute='T'/>", FaultCode::BMain, "1:1", &["trees here: none"]);
}

#[test]
fn slips_in_the_outermost_element_are_refused() {
    let xml = |attribute: &str| {
        format!(
            "<root {attribute} main_tree_to_execute='T'><BehaviorTree ID='T'><AlwaysSuccess/></BehaviorTree></root>"
        )
    };
    says(&xml("BTCPP_format='5'"), FaultCode::BXml, "1:1", &["BTCPP_format=`5`", "allowed: 3, 4"]);
    says(&xml("BTCPP_fromat='4'"), FaultCode::BXml, "1:1", &["`BTCPP_fromat`", "nearest: BTCPP_format"]);
    for fine in ["", "BTCPP_format='3'", "BTCPP_format='4.2'", "project_name='Project'", "xmlns:x='y'"] {
        assert!(Tree::parse(&xml(fine)).is_ok(), "{fine}");
    }
}

#[test]
fn faults_name_their_file() {
    let find = |_: &str| Some("<root>\n<BehaviorTree ID='Q'><Nothing/></BehaviorTree></root>".to_owned());
    let options = Options { file: "mine.xml", includes: Some(&find), ..Options::default() };
    let xml = "<root main_tree_to_execute='T'><include path='other.xml'/>\n<BehaviorTree ID='T'><Something/></BehaviorTree></root>";
    let faults = Tree::parse_with(xml, &options).map(|_| ()).unwrap_err();
    let places: Vec<String> = faults.iter().map(|fault| fault.at.to_string()).collect();
    assert_eq!(places, ["other.xml:2:22 Nothing", "mine.xml:2:22 Something"]);
}

#[test]
fn values_out_of_range_or_not_numbers_are_refused() {
    let seen = |value: &str| document(&format!("<IsRobotVisible agent_id='{{id}}' distance='{value}'/>"));
    for value in ["99", "-1", "0"] {
        says(&seen(value), FaultCode::BRange, "3:1", &["IsRobotVisible", &format!("`{value}`"), "0.3 to 15 m"]);
    }
    for value in ["near", "", "NaN", "inf", "1e999", "0x10", "1,5"] {
        says(&seen(value), FaultCode::BPort, "3:1", &[&format!("`{value}`"), "not a number", "0.3 to 15 m"]);
    }
    says(
        &document("<Repeat num_cycles='1.5'><AlwaysSuccess/></Repeat>"),
        FaultCode::BPort,
        "3:1",
        &["`1.5`", "whole number"],
    );
    says(
        &document("<Repeat num_cycles='-7'><AlwaysSuccess/></Repeat>"),
        FaultCode::BRange,
        "3:1",
        &["`-7`", "at least -1"],
    );
}

#[test]
fn wrong_numbers_of_children_are_refused() {
    let two = "<Inverter><AlwaysSuccess/><AlwaysFailure/></Inverter>";
    says(&document(two), FaultCode::BArity, "3:1", &["`Inverter` has `2` children", "exactly 1"]);
    says(&document("<Sequence/>"), FaultCode::BArity, "3:1", &["`0`", "at least 1"]);
    says(&document("<AlwaysSuccess><AlwaysFailure/></AlwaysSuccess>"), FaultCode::BArity, "3:1", &["allowed: none"]);
    says(&document("<AlwaysSuccess/><AlwaysFailure/>"), FaultCode::BArity, "2:1", &["the tree `T` has `2` children"]);
    let three = "<WhileDoElse><AlwaysSuccess/><AlwaysSuccess/></WhileDoElse>";
    says(&document(three), FaultCode::BArity, "3:1", &["`WhileDoElse` has `2` children", "exactly 3"]);
    let switch = "<Switch2 variable='{x}' case_1='1' case_2='2'><AlwaysSuccess/></Switch2>";
    says(&document(switch), FaultCode::BArity, "3:1", &["exactly 3"]);
}

#[test]
fn subtrees_that_contain_themselves_are_refused_with_the_way() {
    let xml = "<root main_tree_to_execute='A'>\n<BehaviorTree ID='A'><SubTree ID='B'/></BehaviorTree>\n\
               <BehaviorTree ID='B'><Inverter><SubTree ID='A'/></Inverter></BehaviorTree></root>";
    says(xml, FaultCode::BMain, "3:32", &["`A` contains itself", "`A` → `B`"]);
    says(&document("<SubTree ID='Nowhere'/>"), FaultCode::BPort, "3:1", &["`Nowhere`", "trees here: T"]);
}

#[test]
fn includes_are_found_from_the_file_that_names_them_and_cycles_are_refused() {
    let tree = |id: &str| format!("<BehaviorTree ID='{id}'><AlwaysSuccess/></BehaviorTree>");
    let find = |path: &str| match path {
        "lib/a.xml" => Some(format!("<root><include path='deep/b.xml'/>{}</root>", tree("A"))),
        "lib/deep/b.xml" => Some(format!("<root><include path='../c.xml'/>{}</root>", tree("B"))),
        "lib/c.xml" => Some(format!("<root>{}</root>", tree("C"))),
        "x.xml" => Some("<root><include path='y.xml'/></root>".to_owned()),
        "y.xml" => Some("<root>\n<include path='x.xml'/></root>".to_owned()),
        "bad.xml" => Some("<root>\n <BehaviorTree ID='Q'><Nothing/></BehaviorTree></root>".to_owned()),
        _ => None,
    };
    let with = |path: &str, body: &str| {
        let xml = format!(
            "<root main_tree_to_execute='T'><include path='{path}'/><BehaviorTree ID='T'>{body}</BehaviorTree></root>"
        );
        Tree::parse_with(&xml, &Options { includes: Some(&find), ..Options::default() })
    };
    let all = "<Sequence><SubTree ID='A'/><SubTree ID='B'/><SubTree ID='C'/></Sequence>";
    assert!(with("lib/a.xml", all).is_ok());
    let told = |path: &str| match with(path, "<AlwaysSuccess/>") {
        Ok(_) => panic!("{path} was taken"),
        Err(faults) => faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"),
    };
    assert!(
        told("x.xml").contains("y.xml:2:1") && told("x.xml").contains("includes itself, by way of x.xml, y.xml"),
        "{}",
        told("x.xml")
    );
    assert!(told("gone.xml").contains("`gone.xml` is not there"), "{}", told("gone.xml"));
    assert!(told("bad.xml").contains("bad.xml:2:23 Nothing"), "{}", told("bad.xml"));
}

#[test]
fn documents_that_are_no_xml_are_refused_with_their_place() {
    for (xml, at) in [
        ("", "1:1"),
        ("   \n ", "1:1"),
        ("\u{feff}", "1:1"),
        ("no xml at all", "1:1"),
        ("<root", "1:1"),
        ("<root>\n<BehaviorTree>", "2:1"),
        ("<root></roto>", "1:7"),
        ("<a/>\n<b/>", "2:1"),
        ("<root>&bomb;</root>", "1:7"),
        ("<!DOCTYPE lolz [<!ENTITY lol \"lol\"><!ENTITY lol2 \"&lol;&lol;\">]>\n<root/>", "1:1"),
        ("<?xml version='1.0' encoding='UTF-16'?>\n<root/>", "1:1"),
        ("<root a='1' a='2'/>", "1:1"),
    ] {
        let faults = refused(xml);
        assert!(faults[0].at.to_string().starts_with(at), "{xml:?}: {}", faults[0]);
        assert_eq!(faults[0].code, FaultCode::BXml);
    }
    assert!(decode(b"<root>\n  <a b='\xff'/></root>").is_err_and(|fault| fault.at.to_string().starts_with("2:9")));
}

#[test]
fn large_and_deep_documents_are_refused_soon() {
    let large = document(&"<AlwaysSuccess/>\n".repeat(700_000));
    says(&large, FaultCode::BXml, "1:1", &["bytes", "at most 1048576"]);
    let deep = document(&format!("{}{}", "<Inverter>".repeat(100_000), "</Inverter>".repeat(100_000)));
    assert!(refused(&deep)[0].message.to_string().contains("bytes"));
    let deep = document(&"<Inverter>".repeat(90_000));
    says(&deep, FaultCode::BXml, "3:621", &["deeper than 64"]);
    let many_attributes: String = (0..60_000).map(|k| format!(" a{k}='1'")).collect();
    assert!(refused(&document(&format!("<AlwaysSuccess{many_attributes}/>"))).len() > 100);
    let many_unknown: String = (0..40_000).map(|k| format!("<Unknown{k}/>\n")).collect();
    let faults = refused(&document(&format!("<Sequence>{many_unknown}</Sequence>")));
    assert!(faults.len() <= 201 && faults[200].message.to_string().contains("more faults"));
    let many_trees: String =
        (0..15_000).map(|k| format!("<BehaviorTree ID='t{k}'><SubTree ID='no{k}'/></BehaviorTree>")).collect();
    let faults = refused(&format!("<root main_tree_to_execute='none'>{many_trees}</root>"));
    assert!(faults.iter().all(|fault| fault.message.bytes() < 2000));
    let wide = document(&format!("<Sequence>{}</Sequence>", "<AlwaysSuccess/>".repeat(5000)));
    says(&wide, FaultCode::BMain, "3:", &["more than 4096 nodes"]);
    let long = format!("<IsRobotVisible agent_id='{{id}}' distance='{}'/>", "x".repeat(500_000));
    says(&document(&long), FaultCode::BPort, "3:1", &["not a number", "…"]);
}

#[test]
fn subtrees_nested_to_the_limit_do_not_exhaust_the_stack() {
    let mut xml = "<root main_tree_to_execute='t0'>".to_owned();
    for level in 0..15 {
        let (open, close) = ("<Inverter>".repeat(60), "</Inverter>".repeat(60));
        xml.push_str(&format!(
            "<BehaviorTree ID='t{level}'>{open}<SubTree ID='t{}'/>{close}</BehaviorTree>",
            level + 1
        ));
    }
    xml.push_str("<BehaviorTree ID='t15'><AlwaysSuccess/></BehaviorTree></root>");
    says(&xml, FaultCode::BMain, "1:", &["deeper than 256"]);
    let tree = Tree::parse(&xml.replace("main_tree_to_execute='t0'", "main_tree_to_execute='t11'")).unwrap();
    assert_eq!(tree.node_names().len(), 4 * 61 + 1);
    let mut state = tree.start();
    crate::common::Room::default().tick(&tree, &mut state);
    assert!(state.visited().iter().all(|visited| *visited));
}

#[test]
fn comments_models_and_both_root_attributes_are_taken() {
    let xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?><!-- a tree --><root main_tree_to_execute='T' BTCPP_format='4'>\
        <TreeNodesModel><Action ID='Any'><input_port name='x' type='int' default='1'>text</input_port></Action></TreeNodesModel>\
        <BehaviorTree ID='T'><!-- in it --><AlwaysSuccess/></BehaviorTree></root>";
    assert!(Tree::parse(xml).is_ok());
    assert!(Tree::parse(&format!("\u{feff}{xml}")).is_ok());
}
