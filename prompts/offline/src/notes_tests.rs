//! Notes of test engineers, written out and read.

use crate::notes::{notes, written};
use crate::summary;
use crate::tests::told;
use crate::words::pieces;

fn out(text: &str) -> String {
    written(&notes(text, pieces(text))).replace("..", ".").trim_end_matches('.').to_owned()
}

fn read(rough: &str) -> String {
    summary(&told(rough, "hospital")).replace(" · robot: deliver mail", "")
}

#[test]
fn labels_are_people_and_their_definitions_a_sentence() {
    for (text, line) in [
        (
            "ped A (employee): head-on. ped B (visitor): overtakes bot",
            "2 people(employee visitor). human 1 head on. human 2 overtakes bot",
        ),
        ("actor 1 = patient, actor 2 = nurse. actor 2 waits", "2 people(patient nurse). human 2 waits"),
        (
            "3 peds. P1+P2 = workers, cross. P3 = forklift driver (on foot), waits",
            "[3] [peds]. 3 people(worker worker driver). human 1 and human 2 cross. human 3 on foot,, waits",
        ),
        (
            "N=4 employees. E1, E2: frontal. E3: crossing",
            "n 4 employees. human 1 and human 2 head on. human 3 crossing",
        ),
        (
            "4 peds = grp (A,B,C) + D. A-C: employees, chatting. D: intern, waits",
            "[4] [peds]. 4 people(employee employee employee intern). human 1 and human 2 and human 3 stand in a group. \
             human 1 and human 2 and human 3 chatting. human 4 waits",
        ),
        ("2x employee: #1 oncoming, #2 ahead", "2 employees: human 1 oncoming, human 2 ahead"),
        (
            "(1) doctor - ahead; (2) nurse - waits. Only (2) reacts",
            "2 people(doctor nurse). human 1 ahead. human 2 waits. only, human 2, reacts",
        ),
        ("A nurse, B+C visitors. A leaves, B stays", "3 people(nurse visitor visitor). human 1 leaves, human 2 stays"),
        ("two dockers (actor 1, actor 2) walk", "2 people(docker docker). human 1 and human 2 walk"),
        ("a guard (actor 1) blocks robot", "1 person(guard). human 1 blocks robot"),
        (
            "Nurse (N) and patient (P) wait. N leads P",
            "2 people(nurse patient). human 1 and human 2 wait. human 1 leads human 2",
        ),
        ("doctor D1 leads patient P1", "2 people(doctor patient). human 1 leads human 2"),
        ("2 workers cross. w2 stops", "2 workers cross. human 2 stops"),
        ("1 ped (cleaner) waits", "1 cleaner waits"),
        ("role doctor + visitor", "2 people(doctor visitor)"),
    ] {
        assert_eq!(out(text), line, "{text}");
    }
}

#[test]
fn what_is_no_label_stays() {
    for text in [
        "a nurse waits in ward b",
        "in condition a, a nurse waits",
        "the rooms a, b and c are empty",
        "take lift b, or lift c",
        "a nurse and a doctor, who waits, look at it",
    ] {
        let capital = text.replace(" b", " B").replace(" c ", " C ").replace("condition a", "condition A");
        assert_eq!(out(&capital), text, "{capital}");
    }
}

#[test]
fn arrows_are_conditions_or_rows_of_deeds() {
    for (text, line) in [
        ("bot in sight -> P3 stops, then resumes", "when bot in sight, human 3 stops, then resumes"),
        ("P1: dist <1.5m -> steps aside", "when robot distance within 1.5 m, human 1 steps aside"),
        ("robot @ 3m => ped stops + looks", "when robot at 3 m, ped stops and looks"),
        ("visual contact → freezes 3s", "when robot is visible [visual] [contact], freezes 3 s"),
        ("P1: 'stop' gesture to bot -> walks out -> nods", "human 1 stop gesture to bot, then walks out, then nods"),
        ("bot past -> ped continues", "when bot drives past, ped continues"),
        ("P1 waves -> P2 goes", "when human 1 waves, human 2 goes"),
        ("door opens -> ped 1 exits", "when door opens, human 1 exits"),
        ("2m -> stops", "when robot within 2 m, stops"),
        ("he walks on -> collision w/ left bumper", "he walks on. [collision] [with] [left] [bumper]"),
        ("trigger: robot < 3 m; reaction: the nurse stops", "when robot within 3 m, the nurse stops"),
        ("crosses L->R", "crosses from the left"),
        ("4-way crossing, 1 ped, L->R, 1 m/s", "intersection, 1 ped, crosses from the left, 1 m s"),
        ("P2: behind P1", "human 2 walks behind human 1"),
        (
            "3m -> looks; robot behind, asks -> stops",
            "when robot within 3 m, looks. robot behind, when robot asks, stops",
        ),
    ] {
        assert_eq!(out(text), line, "{text}");
    }
}

#[test]
fn what_notes_leave_out_is_written_out() {
    for (text, line) in [
        ("P1 walks, no look, no yielding", "human 1 walks, does not look, does not yield"),
        ("no stop, no look, either one", "nobody stop, nobody look, either one"),
        ("ped: no reaction for 5s, then steps aside", "ped: does not react, after 5 s steps aside"),
        ("bot asks -> ped to the side", "when bot asks, ped steps to the side"),
        ("ped 2: static, no eye contact", "human 2 stands, does not look"),
        ("robot @ lift, wants in", "robot at lift, wants to get in"),
        ("robot goal: loading dock. goal = exit", "robot goal be the loading dock. robot goal be the exit"),
        ("bot start: corridor, bot goal: rm 114", "robot starts in the corridor. robot goal be the room 114"),
        ("expected: bot reaches goal, no contact", "[expected]: [bot] [reaches] [goal], [no] [contact]"),
        ("Fail if bot speed >0.3m/s", "[fail] [if] [bot] [speed] [0.3] [m] [s]"),
        ("1. ped waits. 2. bot asks; then ped walks on", "[1]. ped waits. [2]. bot asks, then ped walks on"),
        ("A nurse waits. Loc: corridor.", "location: corridor. a nurse waits"),
    ] {
        assert_eq!(out(text), line, "{text}");
    }
}

#[test]
fn notes_are_read() {
    for (text, line) in [
        (
            "TC-12 / corridor. ped A (employee): head-on. ped B (visitor): behind bot. A: dist <1.5m -> steps aside. B: no reaction.",
            "2 humans · 1 employee comes towards the robot, gives way · 1 visitor follows the robot, ignores the robot · place: corridor",
        ),
        (
            "Lift test. 3 peds inside: A nurse, B+C visitors. A gets out, B+C stay in.",
            "3 humans · 1 nurse leaves the elevator · 2 visitors stay · place: elevator",
        ),
        ("2x employee. no stop, no look, either one.", "2 humans"),
        (
            "P1 = nurse, P2 = doctor. P1 stands. P1 signals P2 to wait -> P2 stops",
            "2 humans · 1 nurse stands, gestures WAIT · 1 doctor stops",
        ),
    ] {
        assert_eq!(read(text), line, "{text}");
    }
}
