//! Requests in people's words against what a careful person reads in them; see `corpus/README.md`.

use serde::Deserialize;
use socrates_model::job::Stage;
use socrates_model::{Action, FactKind, Fault, Gesture, HumanId, PlaceClass, Reading, Relation, Rule, Trigger};
use socrates_offline::Offline;

/// What the grammar is worked on with: name, text, and how many in a hundred facts have to hold. How many held at the first
/// look stands in `corpus/README.md`.
const OPEN: [(&str, &str, usize); 55] = [
    ("open", include_str!("../../corpus/open.toml"), 95),
    // Written before the grammar was mended for them.
    ("open, second", include_str!("../../corpus/open-2.toml"), 95),
    // Written by people who did not know the grammar.
    ("open, third", include_str!("../../corpus/open-3.toml"), 97),
    ("open, fourth", include_str!("../../corpus/open-4.toml"), 97),
    // Written in nine rounds while the grammar was mended, by one who knew it, each round before it was read.
    ("open, fifth", include_str!("../../corpus/open-5.toml"), 96),
    // Written by people who did not know the grammar, each set read only when all of it had been judged.
    ("open, sixth", include_str!("../../corpus/open-6.toml"), 94),
    ("researchers", include_str!("../../corpus/open-7.toml"), 98),
    ("practitioners", include_str!("../../corpus/open-8.toml"), 98),
    ("test engineers", include_str!("../../corpus/open-9.toml"), 95),
    ("newcomers", include_str!("../../corpus/open-10.toml"), 98),
    ("a bit of all", include_str!("../../corpus/open-11.toml"), 98),
    ("long sentences", include_str!("../../corpus/open-12.toml"), 96),
    ("a bit of all, again", include_str!("../../corpus/open-13.toml"), 97),
    ("staff", include_str!("../../corpus/open-14.toml"), 98),
    ("newcomers, again", include_str!("../../corpus/open-15.toml"), 98),
    // Written to be hard.
    ("a student, an engineer, a manager", include_str!("../../corpus/open-16.toml"), 90),
    ("a researcher, an engineer, staff", include_str!("../../corpus/open-17.toml"), 94),
    // Each read only when all of it had been judged, by the same three hands in turn.
    ("three hands", include_str!("../../corpus/open-18.toml"), 97),
    ("three hands, second", include_str!("../../corpus/open-19.toml"), 98),
    ("three hands, third", include_str!("../../corpus/open-20.toml"), 96),
    ("three hands, fourth", include_str!("../../corpus/open-21.toml"), 98),
    ("three hands, fifth", include_str!("../../corpus/open-22.toml"), 97),
    ("reasons before the scene", include_str!("../../corpus/open-23.toml"), 98),
    ("four hands", include_str!("../../corpus/open-24.toml"), 98),
    ("three hands, sixth", include_str!("../../corpus/open-25.toml"), 98),
    ("three hands, seventh", include_str!("../../corpus/open-26.toml"), 96),
    ("names and jobs", include_str!("../../corpus/open-27.toml"), 94),
    ("three hands, eighth", include_str!("../../corpus/open-28.toml"), 98),
    // Notes in a hurry, tales of last week, conditions of studies, test cases.
    ("four hands, in a hurry", include_str!("../../corpus/open-29.toml"), 88),
    // A student, an engineer, a coordinator and an author of a benchmark, each set read only when all of it had been judged.
    ("four hands", include_str!("../../corpus/open-30.toml"), 97),
    ("four hands, second", include_str!("../../corpus/open-31.toml"), 93),
    // A student, a test engineer, staff and an author of a benchmark, in six rounds, each read only when the one before was mended;
    // the second round was asked for what is not the first to come to mind.
    ("a student, first round", include_str!("../../corpus/open-32.toml"), 98),
    ("a test engineer, first round", include_str!("../../corpus/open-33.toml"), 98),
    ("staff, first round", include_str!("../../corpus/open-34.toml"), 98),
    ("an author of a benchmark, first round", include_str!("../../corpus/open-35.toml"), 98),
    ("a student, second round", include_str!("../../corpus/open-36.toml"), 94),
    ("a test engineer, second round", include_str!("../../corpus/open-37.toml"), 95),
    ("staff, second round", include_str!("../../corpus/open-38.toml"), 95),
    ("an author of a benchmark, second round", include_str!("../../corpus/open-39.toml"), 94),
    ("a student, third round", include_str!("../../corpus/open-40.toml"), 98),
    ("a test engineer, third round", include_str!("../../corpus/open-41.toml"), 97),
    ("staff, third round", include_str!("../../corpus/open-42.toml"), 97),
    ("an author of a benchmark, third round", include_str!("../../corpus/open-43.toml"), 97),
    ("a student, fourth round", include_str!("../../corpus/open-44.toml"), 98),
    ("a test engineer, fourth round", include_str!("../../corpus/open-45.toml"), 98),
    ("staff, fourth round", include_str!("../../corpus/open-46.toml"), 97),
    ("an author of a benchmark, fourth round", include_str!("../../corpus/open-47.toml"), 98),
    ("a student, fifth round", include_str!("../../corpus/open-48.toml"), 98),
    ("a test engineer, fifth round", include_str!("../../corpus/open-49.toml"), 98),
    ("staff, fifth round", include_str!("../../corpus/open-50.toml"), 96),
    ("an author of a benchmark, fifth round", include_str!("../../corpus/open-51.toml"), 96),
    ("a student, sixth round", include_str!("../../corpus/open-52.toml"), 98),
    ("a test engineer, sixth round", include_str!("../../corpus/open-53.toml"), 97),
    ("staff, sixth round", include_str!("../../corpus/open-54.toml"), 96),
    ("an author of a benchmark, sixth round", include_str!("../../corpus/open-55.toml"), 96),
];

/// Facts of the sets kept aside that were right when the test saw them first; of the eleventh, one less since.
const FIRST_LOOKS: [usize; 9] = [107, 120, 127, 220, 199, 208, 128, 133, 137];

#[derive(Deserialize)]
struct Corpus {
    request: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    on: String,
    text: String,
    facts: Vec<String>,
}

/// Facts that hold, all facts, and a line for each that does not.
fn judge(corpus: &str) -> (usize, usize, Vec<String>) {
    let corpus: Corpus = toml::from_str(corpus).unwrap();
    let (mut right, mut all, mut wrong) = (0, 0, Vec::new());
    for case in &corpus.request {
        let reading = crate::common::question(&case.on, case.text.as_str()).reading;
        for fact in &case.facts {
            all += 1;
            if holds(fact, &reading) {
                right += 1;
            } else {
                wrong.push(format!("`{fact}` in “{}”\n    read: {}", case.text, socrates_offline::summary(&reading)));
            }
        }
    }
    (right, all, wrong)
}

pub(crate) fn holds(fact: &str, reading: &Reading) -> bool {
    if let Some(rest) = fact.strip_prefix("not ") {
        return !holds(rest, reading);
    }
    let words: Vec<&str> = fact.split_whitespace().collect();
    let kinds = || reading.facts.iter().map(|fact| &fact.kind);
    match words[..] {
        ["humans", count] => reading.humans.len() == count.parse::<usize>().unwrap(),
        ["group", ..] => {
            let members: Vec<HumanId> = words[1..].iter().map(|n| id(n)).collect();
            kinds().any(|kind| matches!(kind, FactKind::Group { members: found, .. } if *found == members))
        }
        ["place", class] => reading.place == Some(class.parse::<PlaceClass>().unwrap()),
        ["robot", "says", gesture] => kinds().any(|kind| *kind == FactKind::RobotSays(gesture.parse().unwrap())),
        ["robot", "start", class] => kinds().any(|kind| *kind == FactKind::RobotStart(class.parse().unwrap())),
        ["robot", "goal", class] => kinds().any(|kind| *kind == FactKind::RobotGoal(class.parse().unwrap())),
        ["problem", code] => reading.problems.iter().any(|fault| fault.code.code() == code),
        ["ignored", word] => reading.statements.iter().any(|s| {
            s.is_unread() && s.quote.split(|c: char| !c.is_alphanumeric()).any(|w| w.eq_ignore_ascii_case(word))
        }),
        [who, "role", role] => human(who, reading).is_some_and(|human| human.role == role),
        [who, "says", gesture] => {
            let gesture: Gesture = gesture.parse().unwrap();
            kinds().any(|kind| *kind == FactKind::Gestures { human: id(who), gesture })
                || human(who, reading).is_some_and(|human| human.rules.iter().any(|rule| rule.gesture == Some(gesture)))
        }
        [who, relation] if !who.ends_with(':') => {
            let relation: Relation = serde_json::from_value(serde_json::json!(relation)).unwrap();
            human(who, reading).is_some_and(|human| human.relation == Some(relation))
        }
        [who, ..] => human(who.trim_end_matches(':'), reading)
            .is_some_and(|human| (0..human.rules.len()).any(|at| does(&words[1..], &timed(human, at)))),
        [] => false,
    }
}

fn id(number: &str) -> HumanId {
    HumanId::new(number.parse().unwrap())
}

fn human<'a>(number: &str, reading: &'a Reading) -> Option<&'a socrates_model::reading::ReadHuman> {
    reading.humans.iter().find(|human| human.id == id(number))
}

/// The rule; where one with the same trigger lasts so long before it, it also waits for that time, and who walks ahead of the
/// robot notices it where others would see it.
pub(crate) fn timed(human: &socrates_model::reading::ReadHuman, at: usize) -> Rule {
    let (rules, mut rule) = (&human.rules, human.rules[at].clone());
    let before = at.checked_sub(1).map(|before| &rules[before]).filter(|before| before.when == rule.when);
    rule.when.extend(before.and_then(|before| before.for_s).map(Trigger::AfterSecs));
    let ahead = human.relation == Some(Relation::Ahead);
    let near =
        |trigger: &Trigger| if let Trigger::RobotNear(m) = trigger { Some(Trigger::RobotVisible(*m)) } else { None };
    let noticed: Vec<Trigger> = rule.when.iter().filter(|_| ahead).filter_map(near).collect();
    rule.when.extend(noticed);
    rule
}

/// `look_at_robot when near`, `block for 10`, `follow_human 1`.
fn does(words: &[&str], rule: &Rule) -> bool {
    let [action, rest @ ..] = words else { return false };
    let (same, rest) = if *action == "follow_human" {
        (rule.act == Action::FollowHuman(id(rest[0])), &rest[1..])
    } else {
        (rule.act == serde_json::from_value::<Action>(serde_json::json!(action)).unwrap(), rest)
    };
    same && match *rest {
        [] => true,
        ["for", seconds] => rule.for_s == Some(seconds.parse().unwrap()),
        ["at", value] => rule.when.iter().any(|trigger| amount(trigger) == Some(value.parse().unwrap())),
        ["when", ..] => waits(&rest[1..], rule),
        _ => panic!("the corpus says {words:?}"),
    }
}

/// `near`, `robot_says WAIT`: whether a rule waits for it.
pub(crate) fn waits(words: &[&str], rule: &Rule) -> bool {
    let [kind, more @ ..] = words else { return false };
    rule.when.iter().any(|trigger| is(trigger, kind, more))
}

fn amount(trigger: &Trigger) -> Option<f64> {
    if let Trigger::AfterSecs(secs) = trigger { Some(*secs) } else { trigger.distance_m() }
}

fn is(trigger: &Trigger, kind: &str, more: &[&str]) -> bool {
    match (kind, trigger) {
        ("visible", Trigger::RobotVisible(_))
        | ("near", Trigger::RobotNear(_))
        | ("blocking", Trigger::RobotBlocking(_))
        | ("moving", Trigger::RobotMoving)
        | ("stopped", Trigger::RobotStopped)
        | ("passed", Trigger::RobotPassed)
        | ("goal", Trigger::GoalReached)
        | ("encounter", Trigger::AtEncounter)
        | ("after", Trigger::AfterSecs(_)) => true,
        ("robot_says", Trigger::RobotSays(gesture)) => gesture.name() == more[0],
        ("human_says", Trigger::HumanSays(who, gesture)) => *who == id(more[0]) && gesture.name() == more[1],
        _ => false,
    }
}

/// Prints what is read otherwise and how much is right; at least so many percent have to be.
#[expect(clippy::print_stdout, reason = "the figure is what the tests are for")]
fn reads(name: &str, corpus: &str, percent: usize) {
    let (right, all, wrong) = judge(corpus);
    for line in &wrong {
        println!("{line}");
    }
    println!("{name}: {right} of {all} facts");
    assert!(right * 100 >= all * percent, "{right} of {all} facts");
}

#[test]
fn what_people_write_is_read() {
    for (name, corpus, percent) in OPEN {
        reads(name, corpus, percent);
    }
}

/// What a stage says of the answer, if it does not take it.
fn refused(case: &Case) -> Option<(Stage, Vec<Fault>)> {
    let mut ask = crate::common::question(&case.on, case.text.as_str());
    if ask.reading.problems.iter().any(|fault| !fault.is_soft()) {
        return None;
    }
    match socrates_prompts::parse_proposal(&Offline::answer(&ask), &ask) {
        Ok(proposal) => ask.proposal = Some(proposal),
        Err(faults) => return Some((Stage::Proposal, faults)),
    }
    ask.stage = Stage::Paths;
    if let Err(faults) = socrates_prompts::parse_paths(&Offline::answer(&ask), &ask) {
        return Some((Stage::Paths, faults));
    }
    ask.stage = Stage::Behaviors;
    socrates_prompts::parse_behaviors(&Offline::answer(&ask), &ask).err().map(|faults| (Stage::Behaviors, faults))
}

/// No answer is ever refused for its form; what a map cannot hold may still be said by the stage of paths.
#[test]
#[expect(clippy::print_stdout, reason = "the figure is what the test is for")]
fn what_people_write_is_answered_at_every_stage() {
    let (mut all, mut failed) = (0_usize, Vec::new());
    for (_, corpus, _) in OPEN {
        let corpus: Corpus = toml::from_str(corpus).unwrap();
        for case in &corpus.request {
            all += 1;
            if let Some((stage, faults)) = refused(case) {
                println!("{stage}: “{}”: {}", case.text, faults.first().map(ToString::to_string).unwrap_or_default());
                failed.push(stage);
            }
        }
    }
    println!("{} of {all} requests are refused by a stage", failed.len());
    assert!(failed.len() * 200 <= all, "{} of {all} requests are refused by a stage", failed.len());
}

/// Written before the grammar was worked on: 78 of 91 at the first look. Its misses were read then, and the grammar was
/// mended in general; so it is no measure of unseen requests any more.
#[test]
fn what_was_kept_aside_once_is_read() {
    reads("kept aside once", include_str!("../../corpus/sealed.toml"), 95);
}

/// Kept aside for a while: 67 of 99 at the first look, 72 after open-3 to open-5 had been mended; then its misses were read.
#[test]
fn what_was_kept_aside_later_is_read() {
    reads("kept aside later", include_str!("../../corpus/sealed-2.toml"), 92);
}

/// Kept aside until the seventh to the twelfth set had been mended: 125 of 134 before and after; then its misses were read.
#[test]
fn what_was_kept_aside_last_is_read() {
    reads("kept aside last", include_str!("../../corpus/sealed-4.toml"), 98);
}

/// Written by people who did not know the grammar, and unread by whoever works on it: only the figures are told. 95 in 100
/// are aimed at: at the only time they were run, the sixth got 127 of 129, the eighth 220 of 231, the ninth 199 of 233, the tenth 208 of 262, the
/// eleventh 129 of 135, the twelfth 133 of 139 and the thirteenth 137 of 138.
#[test]
#[expect(clippy::print_stdout, reason = "the figure is what the test is for")]
fn what_is_kept_aside_is_read_no_worse_than_at_first() {
    for (name, corpus, at_least) in [
        ("third", include_str!("../../corpus/sealed-3.toml"), FIRST_LOOKS[0]),
        ("fifth", include_str!("../../corpus/sealed-5.toml"), FIRST_LOOKS[1]),
        ("sixth", include_str!("../../corpus/sealed-6.toml"), FIRST_LOOKS[2]),
        ("eighth", include_str!("../../corpus/sealed-8.toml"), FIRST_LOOKS[3]),
        ("ninth", include_str!("../../corpus/sealed-9.toml"), FIRST_LOOKS[4]),
        ("tenth", include_str!("../../corpus/sealed-10.toml"), FIRST_LOOKS[5]),
        ("eleventh", include_str!("../../corpus/sealed-11.toml"), FIRST_LOOKS[6]),
        ("twelfth", include_str!("../../corpus/sealed-12.toml"), FIRST_LOOKS[7]),
        ("thirteenth", include_str!("../../corpus/sealed-13.toml"), FIRST_LOOKS[8]),
    ] {
        let (right, all, _unread) = judge(corpus);
        println!("kept aside, {name}: {right} of {all} facts");
        assert!(right >= at_least, "{name}: {right} of {all} facts");
    }
}
