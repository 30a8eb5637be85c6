//! Features of the trace format and of both versions that follow from the rules, written down by hand.

use socrates_bt::trace;
use socrates_model::FaultCode;

const V3: &str = "";
const V4: &str = "BTCPP_format='4'";

fn document(format: &str, trees: &[(&str, &str)]) -> String {
    let trees: String =
        trees.iter().map(|(id, body)| format!("<BehaviorTree ID='{id}'>{body}</BehaviorTree>")).collect();
    format!("<root {format} main_tree_to_execute='T'>{trees}</root>")
}

/// Events of every tick, leaf by leaf: `a+` success, `a-` failure, `a~` running, `!a` halted, `=` what the root gave.
fn events(xml: &str, ticks: &[&str]) -> Vec<String> {
    let entries: Vec<String> = ticks
        .iter()
        .map(|tick| {
            let leaves: Vec<String> = tick
                .split_whitespace()
                .map(|leaf| {
                    let (name, sign) = leaf.split_at(leaf.len() - 1);
                    format!("\"{name}\":\"{}\"", ["SUCCESS", "FAILURE", "RUNNING"]["+-~".find(sign).unwrap()])
                })
                .collect();
            format!("{{{}}}", leaves.join(","))
        })
        .collect();
    let script = format!("{{\"ticks\":[{}]}}", entries.join(","));
    let traced = trace(xml, None, &script).unwrap_or_else(|faults| panic!("{faults:#?}"));
    let mut found = vec![String::new(); ticks.len()];
    for line in traced.events_csv.lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let sign = match fields[3] {
            "SUCCESS" => "+",
            "FAILURE" => "-",
            "RUNNING" => "~",
            "SKIPPED" => "?",
            _ => "",
        };
        let text = match fields[1] {
            "TICK" => format!("{}{sign} ", fields[2]),
            "HALT" => format!("!{} ", fields[2]),
            _ => format!("={sign}"),
        };
        found[fields[0].parse::<usize>().unwrap()].push_str(&text);
    }
    found
}

fn action(name: &str) -> String {
    format!("<ScriptAction name='{name}'/>")
}

fn actions(names: &str) -> String {
    names.split_whitespace().map(action).collect()
}

#[test]
fn every_switch_picks_its_branch_or_the_last() {
    for n in 2..=6 {
        for (format, port) in [(V3, "0"), (V4, "0")] {
            let cases: String = (1..=n).map(|case| format!(" case_{case}='{case}'")).collect();
            let branches: String = (1..=n + 1).map(|branch| action(&format!("b{branch}"))).collect();
            for chosen in 1..=n + 1 {
                let set = format!("<SetBlackboard name='s' output_key='x' value='{chosen}'/>");
                let body = format!(
                    "<Sequence name='q'>{set}<Switch{n} name='w' variable='{{x}}'{cases}>{branches}</Switch{n}></Sequence>"
                );
                let expected = format!("b{chosen}+ =+");
                assert_eq!(events(&document(format, &[("T", &body)]), &[""]), [expected], "{n} {port}");
            }
        }
    }
}

#[test]
fn version_4_switch_compares_whole_numbers_and_reals_version_3_texts() {
    let body = "<Sequence name='q'><SetBlackboard name='s' output_key='x' value='2.0'/>\
        <Switch2 name='w' variable='{x}' case_1='1' case_2='2'>{B}</Switch2></Sequence>"
        .replace("{B}", &actions("a b c"));
    assert_eq!(events(&document(V3, &[("T", &body)]), &[""]), ["c+ =+"]);
    assert_eq!(events(&document(V4, &[("T", &body)]), &[""]), ["b+ =+"]);
}

#[test]
fn a_plus_sign_makes_no_number_in_a_switch_of_version_4() {
    // Numbers are read as `std::from_chars` reads them: a minus sign is part of one, a plus sign or a blank is not.
    for (value, case, equal) in [
        ("3.0", "3", true),
        ("3", "+3", false),
        ("+3", "3", false),
        ("3.0", "+3", false),
        ("+3", "+3", true),
        ("+3", "+3.0", false),
        ("-3.0", "-3", true),
        ("3", " 3", false),
    ] {
        let body = format!(
            "<Sequence name='q'><SetBlackboard name='s' output_key='x' value='{value}'/>\
             <Switch2 name='w' variable='{{x}}' case_1='1' case_2='{case}'>{}</Switch2></Sequence>",
            actions("a b c")
        );
        let chosen = if equal { "b+ =+" } else { "c+ =+" };
        assert_eq!(events(&document(V4, &[("T", &body)]), &[""]), [chosen], "`{value}` and `{case}`");
    }
}

#[test]
fn a_while_attribute_stops_a_running_node_and_leaves_it_out() {
    let body = format!(
        "<Parallel name='p' success_count='2' failure_count='2'><Script name='s' code='n := n0'/>\
         <Sequence name='q' _while='n0 &lt; 3'>{}</Sequence><Script name='i' code='n0 += 1'/></Parallel>",
        actions("a b")
    );
    let with_start =
        format!("<Sequence name='r'><RunOnce name='o'><Script name='z' code='n0 := 1'/></RunOnce>{body}</Sequence>");
    let found = events(&document(V4, &[("T", &with_start)]), &["a~", "", "", ""]);
    assert_eq!(found[0], "a~ =+".replace("a~ ", "a~ !a "), "enough successes end the parallel and halt the rest");
    assert_eq!(found[1], "a~ !a =+");
    assert_eq!(found[2], "=+", "the condition of `_while` no longer holds");
}

#[test]
fn post_attributes_run_after_a_node_finished_or_was_halted() {
    let body = "<Sequence name='q'><RunOnce name='o'><Script name='z' code='x := 0'/></RunOnce>\
        <ReactiveFallback name='f'><ScriptCond name='c'/>\
        <ScriptAction name='a' _onHalted='x = 9' _onSuccess='x = 1' _onFailure='x = 2' _post='x = x + 10'/></ReactiveFallback>\
        <Switch4 name='w' variable='{x}' case_1='11' case_2='12' case_3='9' case_4='0'>{B}</Switch4></Sequence>"
        .replace("{B}", &actions("ok bad halted nothing other"));
    let found = events(&document(V4, &[("T", &body)]), &["c-", "a-", "a~", "c+"]);
    assert_eq!(found, ["c- a+ ok+ =+", "c- a- =-", "c- a~ =~", "c+ !a halted+ =+"]);
}

#[test]
fn a_run_once_that_does_not_skip_repeats_its_outcome() {
    let of = |then_skip: &str| {
        let body = format!(
            "<Fallback name='f'><RunOnce name='o' then_skip='{then_skip}'>{}</RunOnce>{}</Fallback>",
            action("a"),
            action("b")
        );
        events(&document(V4, &[("T", &body)]), &["a~ b-", "a-", "a+", "b+"])
    };
    assert_eq!(of("true"), ["a~ =~", "a- b- =-", "b- =-", "b+ =+"]);
    assert_eq!(of("false"), ["a~ =~", "a- b- =-", "b- =-", "b+ =+"]);
    let alone = |then_skip: &str| {
        let body = format!("<RunOnce name='o' then_skip='{then_skip}'>{}</RunOnce>", action("a"));
        events(&document(V4, &[("T", &body)]), &["a-", "a+"])
    };
    assert_eq!(alone("true"), ["a- =-", "=?"]);
    assert_eq!(alone("false"), ["a- =-", "=-"]);
}

#[test]
fn scripts_compute_with_texts_and_numbers() {
    let of = |code: &str, condition: &str| {
        let body = format!(
            "<Sequence name='q'><Script name='s' code=\"{code}\"/><ScriptAction name='a' _skipIf=\"{condition}\"/>{}</Sequence>",
            action("b")
        );
        events(&document(V4, &[("T", &body)]), &[""]).concat()
    };
    let (skipped, ticked) = ("b+ =+", "a+ b+ =+");
    assert_eq!(of("n := 3; n = n * 2 - 1", "n == 5"), skipped);
    assert_eq!(of("n := 7 / 2", "n == 3"), ticked);
    assert_eq!(of("s := 'red'", "s == 'red' &amp;&amp; s != 'blue'"), skipped);
    assert_eq!(of("s := 'a'; s = s .. 'b'", "s == 'ab'"), skipped);
    assert_eq!(of("n := 1; n += 4; m := n > 4 ? 'many' : 'few'", "m == 'many'"), skipped);
    assert_eq!(of("n := 2", "!(n >= 2) || n &lt; 0"), ticked);
}

#[test]
fn a_subtree_used_twice_has_two_memories_and_one_script() {
    let inner = format!("<Sequence name='q'>{}</Sequence>", actions("a b"));
    for format in [V3, V4] {
        let outer = "<Fallback name='f'><Inverter name='i'><SubTree ID='S' name='one'/></Inverter><SubTree ID='S' name='two'/></Fallback>";
        let xml = document(format, &[("T", outer), ("S", &inner)]);
        assert_eq!(events(&xml, &["b~", "b+"]), ["a+ b~ =~", "b+ a#2+ b#2+ =+"]);
        let traced = trace(&xml, None, "{\"ticks\":[{}]}").unwrap().trace_csv;
        let names: Vec<&str> = traced.lines().skip(1).map(|line| line.split(',').nth(1).unwrap()).collect();
        let (first, second) = if format == V3 { ("S", "S#2") } else { ("one", "two") };
        assert_eq!(names, ["f", "i", first, "q", "a", "b", second, "q#2", "a#2", "b#2"]);
    }
}

#[test]
fn blackboards_of_subtrees_are_their_own_unless_something_is_handed_over() {
    let inner = |key: &str| {
        format!("<Switch2 name='w' variable='{{{key}}}' case_1='1' case_2='2'>{}</Switch2>", actions("one two other"))
    };
    let outer =
        |call: &str| format!("<Sequence name='q'><SetBlackboard name='s' output_key='x' value='1'/>{call}</Sequence>");
    let of = |format: &str, call: &str, key: &str| {
        let (outer, inner) = (outer(call), inner(key));
        events(&document(format, &[("T", &outer), ("S", &inner)]), &[""]).concat()
    };
    assert_eq!(of(V3, "<SubTree ID='S'/>", "x"), "other+ =+");
    assert_eq!(of(V3, "<SubTree ID='S' y='x'/>", "y"), "one+ =+");
    assert_eq!(of(V3, "<SubTree ID='S' y='{x}'/>", "y"), "other+ =+");
    assert_eq!(of(V3, "<SubTree ID='S' __shared_blackboard='true'/>", "x"), "one+ =+");
    assert_eq!(of(V3, "<SubTree ID='S' __shared_blackboard='false'/>", "x"), "other+ =+");
    assert_eq!(of(V3, "<SubTreePlus ID='S' y='{x}'/>", "y"), "one+ =+");
    assert_eq!(of(V3, "<SubTreePlus ID='S' y='2'/>", "y"), "two+ =+");
    assert_eq!(of(V3, "<SubTreePlus ID='S' __autoremap='1'/>", "x"), "one+ =+");
    assert_eq!(of(V4, "<SubTree ID='S'/>", "x"), "other+ =+");
    assert_eq!(of(V4, "<SubTree ID='S' y='{x}'/>", "y"), "one+ =+");
    assert_eq!(of(V4, "<SubTree ID='S' y='2'/>", "y"), "two+ =+");
    assert_eq!(of(V4, "<SubTree ID='S' _autoremap='true'/>", "x"), "one+ =+");
    assert_eq!(of(V4, "<SubTree ID='S' _autoremap='false'/>", "x"), "other+ =+");
    assert_eq!(of(V4, "<SubTree ID='S' x='{=}'/>", "x"), "one+ =+");
    assert_eq!(of(V4, "<SubTree ID='S'/>", "@x"), "one+ =+");
}

#[test]
fn a_model_gives_the_ports_of_a_subtree_their_defaults() {
    let of = |call: &str| {
        let inner =
            format!("<Switch2 name='w' variable='{{y}}' case_1='1' case_2='2'>{}</Switch2>", actions("one two other"));
        let model = "<TreeNodesModel><SubTree ID='S'><input_port name='y' default='2'/><input_port name='z'/></SubTree></TreeNodesModel>";
        let xml = document(V4, &[("T", call), ("S", &inner)]).replace("</root>", &format!("{model}</root>"));
        trace(&xml, None, "{\"ticks\":[{}]}").map(|traced| traced.events_csv.lines().nth(1).unwrap().to_owned())
    };
    assert_eq!(of("<SubTree ID='S' name='s' z='0'/>").unwrap(), "0,TICK,two,SUCCESS");
    assert_eq!(of("<SubTree ID='S' name='s' z='0' y='1'/>").unwrap(), "0,TICK,one,SUCCESS");
    assert_eq!(of("<SubTree ID='S' name='s' _autoremap='true'/>").unwrap(), "0,TICK,other,SUCCESS");
    let faults = of("<SubTree ID='S' name='s'/>").unwrap_err();
    assert!(faults[0].message.to_string().contains("`z` without a default"), "{}", faults[0]);
}

#[test]
fn what_a_subtree_writes_comes_out_only_by_a_hand_over() {
    let inner = "<SetBlackboard name='s' output_key='y' value='2'/>";
    let of = |format: &str, call: &str| {
        let outer = format!(
            "<Sequence name='q'><SetBlackboard name='z' output_key='x' value='1'/>{call}<Switch2 name='w' variable='{{x}}' case_1='1' case_2='2'>{}</Switch2></Sequence>",
            actions("one two other")
        );
        events(&document(format, &[("T", &outer), ("S", inner)]), &[""]).concat()
    };
    assert_eq!(of(V3, "<SubTree ID='S'/>"), "one+ =+");
    assert_eq!(of(V3, "<SubTree ID='S' y='x'/>"), "two+ =+");
    assert_eq!(of(V4, "<SubTree ID='S' y='{x}'/>"), "two+ =+");
}

#[test]
fn a_parallel_counts_from_the_end_with_negative_thresholds() {
    let of = |format: &str, success: &str, failure: &str, leaves: &str| {
        let (s, f) =
            if format == V3 { ("success_threshold", "failure_threshold") } else { ("success_count", "failure_count") };
        let body = format!("<Parallel name='p' {s}='{success}' {f}='{failure}'>{}</Parallel>", actions("a b c"));
        events(&document(format, &[("T", &body)]), &[leaves]).concat()
    };
    for format in [V3, V4] {
        assert_eq!(of(format, "-2", "-1", "a+ b- c+"), "a+ b- c+ =+");
        assert_eq!(of(format, "-1", "-2", "a~ b- c-"), "a~ b- !a =-");
        assert_eq!(of(format, "1", "-1", "a- b- c~"), "a- b- c~ =~");
        assert_eq!(of(format, "2", "2", "a+ b~ c+"), "a+ b~ c+ !b =+");
    }
}

#[test]
fn a_halted_sequence_with_memory_forgets_its_place_in_version_3_only() {
    let of = |format: &str, tag: &str| {
        let body = format!(
            "<ReactiveFallback name='f'><ScriptCond name='c'/><{tag} name='m'>{}</{tag}></ReactiveFallback>",
            actions("a b")
        );
        events(&document(format, &[("T", &body)]), &["c- b~", "", "c+", "c-"])
    };
    assert_eq!(of(V3, "SequenceStar"), ["c- a+ b~ =~", "c- b~ =~", "c+ !b =+", "c- a+ b~ =~"]);
    assert_eq!(of(V4, "SequenceWithMemory"), ["c- a+ =~", "c- b~ =~", "c+ !b =+", "c- b~ =~"]);
}

#[test]
fn nested_decorators_pass_outcomes_inside_out() {
    let body = format!(
        "<Inverter name='i'><ForceFailure name='ff'><Repeat name='r' num_cycles='2'><RetryUntilSuccessful name='u' num_attempts='2'>{}</RetryUntilSuccessful></Repeat></ForceFailure></Inverter>",
        action("a")
    );
    assert_eq!(events(&document(V3, &[("T", &body)]), &["a-", "a+"]), ["a- a- =+", "a+ a+ =+"]);
    assert_eq!(events(&document(V4, &[("T", &body)]), &["a-", "", "a+", ""]), ["a- =~", "a- =+", "a+ =~", "a+ =+"]);
}

#[test]
fn rare_nodes_of_version_4_are_ticked() {
    let of = |body: String, ticks: &[&str]| events(&document(V4, &[("T", &body)]), ticks);
    let list = actions("a b");
    assert_eq!(of(format!("<AsyncSequence name='q'>{list}</AsyncSequence>"), &["", "b-"]), ["a+ =~", "b- =-"]);
    assert_eq!(
        of(format!("<AsyncFallback name='q'>{list}</AsyncFallback>"), &["a~", "a- b+", "a- b-", ""]),
        ["a~ =~", "a- b+ =+", "a- =~", "b- =-"]
    );
    let set = "<Script name='s' code='n := 2'/>";
    let asked = |code: &str| {
        of(format!("<Sequence name='q'>{set}<ScriptCondition name='c' code='{code}'/>{list}</Sequence>"), &[""])
    };
    assert_eq!(asked("n == 2"), ["a+ b+ =+"]);
    assert_eq!(asked("n &gt; 2"), ["=-"]);
    let guarded = |code: &str| {
        of(
            format!(
                "<Sequence name='q'>{set}<Precondition name='p' if='{code}' else='SUCCESS'>{}</Precondition></Sequence>",
                action("a")
            ),
            &["a~", "a-"],
        )
    };
    assert_eq!(guarded("n == 2"), ["a~ =~", "a- =-"]);
    assert_eq!(guarded("n == 3"), ["=+", "=+"]);
    assert_eq!(
        of(format!("<Timeout name='t' msec='20'>{}</Timeout>", action("a")), &["a~", "", "", ""]),
        ["a~ =~", "a~ =~", "!a =-", "a~ =~"]
    );
    assert_eq!(
        of(format!("<Delay name='d' delay_msec='20'>{}</Delay>", action("a")), &["", "", "", ""]),
        ["=~", "=~", "a+ =+", "=~"]
    );
    assert_eq!(of("<Sleep name='z' msec='20'/>".to_owned(), &["", "", ""]), ["=~", "=~", "=+"]);
}

#[test]
fn the_long_form_of_a_node_says_the_same() {
    let body = "<Control ID='Sequence' name='q'><Action ID='ScriptAction' name='a'/><Condition ID='ScriptCond' name='c'/>\
        <Decorator ID='Inverter' name='i'><Action ID='ScriptAction' name='b'/></Decorator></Control>";
    assert_eq!(events(&document(V3, &[("T", body)]), &["b-"]), ["a+ c+ b- =+"]);
}

#[test]
fn a_wrong_script_is_answered_with_every_fault() {
    let xml = document(V3, &[("T", "<Sequence name='q'><ScriptAction name='a'/><ScriptCond name='c'/></Sequence>")]);
    let faults = trace(&xml, None, "{\"ticks\":[{\"a\":\"DONE\",\"c\":\"RUNNING\"},7,{\"x\":\"SUCCESS\"}],\"tick\":1}")
        .unwrap_err();
    let told: Vec<String> = faults.iter().map(ToString::to_string).collect();
    assert_eq!(faults.len(), 5, "{told:#?}");
    assert!(faults.iter().all(|fault| fault.code == FaultCode::ESchema));
    assert!(told.iter().any(|text| text.contains("tick 0 `a`") && text.contains("DONE") && text.contains("RUNNING")));
    assert!(told.iter().any(|text| text.contains("tick 2 `x`") && text.contains("c, a")));
    assert_eq!(trace(&xml, None, "{").unwrap_err()[0].code, FaultCode::EJson);
    assert!(trace(&xml, None, "[]").is_err());
    assert!(trace("<root", None, "{}").is_err());
}
