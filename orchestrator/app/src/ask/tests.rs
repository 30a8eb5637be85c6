//! Conversations, word for word, with the offline author and without a terminal.

use std::collections::VecDeque;
use std::path::Path;

use socrates_model::job::Stage;
use socrates_model::{AuthorSpec, Fault, FaultCode};
use socrates_offline::Offline;
use socrates_prompts::{Question, parse_behaviors, parse_paths, parse_proposal};

use super::conversation::{About, Decision, Look, Person, Tone, converse};
use super::log::{Log, Shelf};
use super::version::Version;
use crate::config::Config;
use crate::exit::Diagnostic;
use crate::prepare::prepare_text;
use crate::run_options::RunOptions;

const REQUEST: &str = r#"
location = "office"
task = "Bring a parcel from the lobby to the meeting room"
social_context = "A quiet afternoon"
rough_scenario = "A visitor comes towards the robot in the corridor. When the robot is within 2 m, she stops and looks at it."
"#;

/// What an editor does with a text.
type Editor = Box<dyn FnMut(&str) -> Result<String, String>>;

/// A person with a list of lines, and an editor that does what the test says.
#[derive(Default)]
struct Script {
    lines: VecDeque<String>,
    editor: Option<Editor>,
    heard: Vec<(Tone, String)>,
    pictures: usize,
    kept: usize,
    /// Letters in a line; none for a wide one.
    columns: Option<usize>,
}

impl Script {
    fn of(lines: &[&str]) -> Self {
        Self { lines: lines.iter().map(|line| (*line).to_owned()).collect(), ..Self::default() }
    }

    fn heard(&self, words: &str) -> bool {
        self.heard.iter().any(|(_, line)| line.contains(words))
    }

    fn text(&self) -> String {
        self.heard.iter().map(|(tone, line)| format!("{tone:?}: {line}\n")).collect()
    }
}

impl Person for Script {
    fn say(&mut self, tone: Tone, line: &str) {
        self.heard.push((tone, line.to_owned()));
    }
    fn columns(&self) -> usize {
        self.columns.unwrap_or(usize::MAX)
    }
    fn picture(&mut self, _: &Look, _: &Version) {
        self.pictures += 1;
    }
    fn ask(&mut self, _: &str) -> Option<String> {
        self.lines.pop_front()
    }
    fn edit(&mut self, _: &str, text: &str) -> Result<String, String> {
        self.editor.as_mut().map_or_else(|| Err("no editor".to_owned()), |edit| edit(text))
    }
    fn keep(&mut self, _: &Log) -> Result<(), Diagnostic> {
        self.kept += 1;
        Ok(())
    }
}

fn look(about: About) -> Look {
    let config = Config::load(None, std::iter::empty(), &[]).unwrap();
    let prepared = prepare_text("look", REQUEST, "look", Path::new("."), Some(&RunOptions::plain(1)), &config).unwrap();
    let question = Question::first(prepared.request.clone(), prepared.reading.clone(), prepared.location.clone(), 1);
    let proposal = parse_proposal(&Offline::answer(&question)).unwrap();
    let asked = Question { proposal: Some(proposal.clone()), ..question.clone() };
    let draft = about == About::Draft;
    let paths = Question { stage: Stage::Paths, ..asked.clone() };
    let behaviors = Question { stage: Stage::Behaviors, ..asked };
    Look {
        job: format!("look {about:?}"),
        about,
        came: Version {
            proposal,
            paths: draft.then(|| parse_paths(&Offline::answer(&paths), &paths).unwrap()),
            behaviors: draft.then(|| parse_behaviors(&Offline::answer(&behaviors), &behaviors).unwrap()),
            reading: prepared.reading,
        },
        others: Vec::new(),
        reasons: Vec::new(),
        question,
        author: AuthorSpec::Offline,
        pinned: Vec::new(),
    }
}

fn talk(look: &Look, person: &mut Script) -> (Option<Decision>, Log) {
    let mut log = Log::new();
    let decision = converse(look, &mut log, person).unwrap();
    (decision, log)
}

#[test]
fn what_is_accepted_is_what_came() {
    for about in [About::Proposal, About::Draft] {
        let look = look(about);
        let mut person = Script::of(&["accept"]);
        let (decision, _) = talk(&look, &mut person);
        let decision = decision.unwrap();
        assert_eq!(decision.left, look.came);
        assert!(decision.anew.is_empty());
        assert!(person.heard("nothing found against it"), "{}", person.text());
        assert_eq!(person.pictures, usize::from(about == About::Draft), "ways are drawn once there are some");
    }
}

#[test]
fn every_line_fits_a_terminal_of_forty_columns_and_nothing_is_lost() {
    let look = look(About::Draft);
    let lines = ["?", "make the robot's path longer", "the moon is green", "diff", "accept"];
    let (mut wide, mut narrow) = (Script::of(&lines), Script { columns: Some(40), ..Script::of(&lines) });
    talk(&look, &mut wide);
    talk(&look, &mut narrow);
    for (_, line) in &narrow.heard {
        let words = line.split_whitespace().count();
        assert!(line.chars().count() <= 40 || words == 1, "`{line}` is wider than 40 columns");
    }
    assert!(wide.heard.len() < narrow.heard.len() && wide.heard.iter().any(|(_, line)| line.chars().count() > 80));
    // Signs and names of the differences are written once more where a line is broken, hence the plain lines alone.
    let words = |script: &Script| -> Vec<String> {
        let plain = script.heard.iter().filter(|(tone, _)| matches!(tone, Tone::Plain | Tone::Quiet | Tone::Head));
        plain.flat_map(|(_, line)| line.split_whitespace()).map(str::to_owned).collect()
    };
    assert_eq!(words(&wide), words(&narrow));
}

#[test]
fn words_change_what_they_speak_of_and_undo_takes_it_back() {
    let look = look(About::Draft);
    let mut person = Script::of(&["make the robot's path longer", "accept"]);
    let (decision, log) = talk(&look, &mut person);
    let left = decision.unwrap().left;
    let length = |version: &Version| look.question.location.graph.length_m(&version.paths.as_ref().unwrap().robot);
    assert!(length(&left) > length(&look.came), "{}", person.text());
    assert_eq!(left.behaviors, look.came.behaviors, "of which nothing was said");
    assert!(left.paths.unwrap().author.has_person());
    assert!(person.heard.iter().any(|(tone, line)| *tone == Tone::Good && line.starts_with("+ robot")));
    assert_eq!(log.said, ["make the robot's path longer", "accept"]);

    let mut person = Script::of(&["make the robot's path longer", "undo", "undo", "accept"]);
    let (decision, _) = talk(&look, &mut person);
    assert_eq!(decision.unwrap().left, look.came);
    assert!(person.heard("undone: \"make the robot's path longer\"") && person.heard("nothing to undo"));
}

#[test]
fn an_edit_changes_what_the_result_is_held_against() {
    let look = look(About::Proposal);
    let mut person = Script::of(&["the visitor gives way when the robot is within 3 m", "accept"]);
    let (decision, _) = talk(&look, &mut person);
    let left = decision.unwrap_or_else(|| panic!("{}", person.text())).left;
    assert_ne!(left.reading, look.came.reading, "{}", person.text());
    assert!(left.proposal.humans[0].rules.iter().any(|rule| rule.act == socrates_model::Action::GiveWay));
}

#[test]
fn what_cannot_be_done_is_said_and_changes_nothing() {
    let look = look(About::Draft);
    let mut person = Script::of(&["paint the walls green", "take 3", "accept"]);
    let (decision, _) = talk(&look, &mut person);
    assert_eq!(decision.unwrap().left, look.came);
    assert!(person.heard("not done") && person.heard("what can be said"), "{}", person.text());
    assert!(person.heard("no proposal 3"));
}

#[test]
fn words_that_the_grammar_does_not_read_go_to_a_model() {
    let look = Look { author: "openai:m".parse().unwrap(), ..look(About::Proposal) };
    let mut person = Script::of(&["acept", "paint the walls green", "accept"]);
    let (decision, _) = talk(&look, &mut person);
    let decision = decision.unwrap();
    assert_eq!(decision.left, look.came);
    let wishes: Vec<String> =
        decision.anew.iter().flat_map(|repair| &repair.faults).map(|fault| fault.message.to_string()).collect();
    assert_eq!(wishes, ["paint the walls green"], "{}", person.text());
    assert!(person.heard("openai:m is asked: \"paint the walls green\""), "{}", person.text());
}

#[test]
fn one_stage_is_made_again_and_the_others_are_kept() {
    let look = look(About::Draft);
    let (decision, _) = talk(&look, &mut Script::of(&["again paths from the other side"]));
    let decision = decision.unwrap();
    assert_eq!(decision.anew.len(), 1);
    assert_eq!(decision.anew[0].stage, Stage::Paths);
    assert_eq!(decision.anew[0].faults, [Fault::new(FaultCode::PPerson, Stage::Paths, "from the other side")]);
    let (page, shown) = (FaultCode::PPerson.page(), decision.anew[0].faults[0].to_string());
    assert!(page.contains(&format!("```text\n{shown}\n```")), "its page does not show\n{shown}");
    let (decision, _) = talk(&look, &mut Script::of(&["again"]));
    let stages: Vec<Stage> = decision.unwrap().anew.iter().map(|wish| wish.stage).collect();
    assert_eq!(stages, [Stage::Paths, Stage::Behaviors], "what the look is about");
    let mut pinned = look.clone();
    pinned.pinned = vec![Stage::Paths];
    let mut person = Script::of(&["again paths", "quit"]);
    assert_eq!(talk(&pinned, &mut person).0, None);
    assert!(person.heard("pinned by the request"));
}

#[test]
fn who_leaves_comes_back_to_what_was_changed() {
    let look = look(About::Draft);
    let mut log = Log::new();
    let mut person = Script::of(&["make the robot's path longer", "quit"]);
    assert_eq!(converse(&look, &mut log, &mut person).unwrap(), None);
    let folder = tempfile::tempdir().unwrap();
    let shelf = Shelf::of(folder.path());
    shelf.keep(&log).unwrap();
    let mut log = shelf.load().unwrap();
    let mut person = Script::of(&["accept"]);
    let left = converse(&look, &mut log, &mut person).unwrap().unwrap().left;
    assert_ne!(left, look.came);
    assert!(!person.heard("- robot"), "nothing is a difference to what was left:\n{}", person.text());
    std::fs::write(folder.path().join("ask.json"), "{").unwrap();
    assert!(shelf.load().unwrap_err().to_string().contains("holds no looks"));
}

#[test]
fn what_is_made_again_is_compared_and_can_be_undone() {
    let first = look(About::Draft);
    let (_, mut log) = talk(&first, &mut Script::of(&["again paths"]));
    let mut second = first.clone();
    second.job = "another".to_owned();
    second.reasons = vec![Fault::new(FaultCode::PPerson, Stage::Paths, "longer")];
    second.came.paths.as_mut().unwrap().robot.reverse();
    let mut person = Script::of(&["undo", "accept"]);
    let left = converse(&second, &mut log, &mut person).unwrap().unwrap().left;
    assert!(person.heard("because    longer") && person.heard("- robot") && person.heard("+ robot"));
    assert_eq!(left.paths, first.came.paths);
}

#[test]
fn a_text_that_cannot_be_read_is_kept_for_the_next_try() {
    let look = look(About::Proposal);
    let mut person = Script::of(&["edit", "edit", "accept"]);
    let mut tries = 0;
    person.editor = Some(Box::new(move |text| {
        tries += 1;
        match tries {
            1 => Ok(text.replacen('{', "{{", 1)),
            _ => {
                assert!(text.starts_with("{{"), "as it was left");
                Ok(text.replacen("{{", "{", 1).replacen("\"title\": \"", "\"title\": \"Mine: ", 1))
            }
        }
    }));
    let (decision, _) = talk(&look, &mut person);
    let left = decision.expect("accepted").left;
    assert!(left.proposal.title.starts_with("Mine: "), "{}", person.text());
    assert!(person.heard("proposal.json cannot be read") && person.heard("line 1 column 2"));
}

#[test]
fn what_is_written_by_hand_wins_over_the_request() {
    let look = look(About::Proposal);
    let mut person = Script::of(&["edit proposal", "accept"]);
    person.editor = Some(Box::new(|text| {
        let mut proposal: serde_json::Value = serde_json::from_str(text).unwrap();
        proposal["humans"][0]["rules"] = serde_json::json!([]);
        let events = proposal["expected_events"].as_array_mut().unwrap();
        events.retain(|clause| clause["source"].as_str().unwrap_or_default().is_empty());
        Ok(proposal.to_string())
    }));
    let (decision, _) = talk(&look, &mut person);
    assert!(person.heard("is no longer asked for"), "{}", person.text());
    assert!(decision.unwrap_or_else(|| panic!("{}", person.text())).left.proposal.humans[0].rules.is_empty());
}

#[test]
fn what_is_wrong_is_not_accepted_and_what_no_longer_fits_is_made_again() {
    let look = look(About::Draft);
    let mut person = Script::of(&["edit human_1", "accept"]);
    person.editor = Some(Box::new(|_| Ok("<root>".to_owned())));
    let (decision, _) = talk(&look, &mut person);
    let decision = decision.unwrap();
    assert!(person.heard("behaviors no longer fit"), "{}", person.text());
    assert_eq!(decision.anew[0].stage, Stage::Behaviors);
    assert_eq!(decision.anew[0].faults[0].code, FaultCode::BXml);
    let mut pinned = look.clone();
    pinned.pinned = vec![Stage::Behaviors];
    let mut person = Script::of(&["edit human_1", "accept", "quit"]);
    person.editor = Some(Box::new(|_| Ok("<root>".to_owned())));
    assert_eq!(talk(&pinned, &mut person).0, None, "nobody is asked for what is pinned");
    assert!(person.heard("not accepted"), "{}", person.text());
}

#[test]
fn another_of_several_proposals_can_be_taken() {
    let mut look = look(About::Proposal);
    let mut other = look.came.proposal.clone();
    "Another".clone_into(&mut other.title);
    look.others = vec![look.came.proposal.clone(), other];
    let mut person = Script::of(&["take 2", "undo", "take 2", "accept"]);
    let (decision, _) = talk(&look, &mut person);
    assert_eq!(decision.unwrap().left.proposal.title, "Another");
    assert!(person.heard("(shown)") && person.heard("take 2     Another"), "{}", person.text());
}

#[test]
fn back_shows_the_proposal_and_accept_returns_to_the_draft() {
    let look = look(About::Draft);
    let mut person = Script::of(&["back", "accept", "accept"]);
    let (decision, _) = talk(&look, &mut person);
    assert_eq!(decision.unwrap().left, look.came);
    let title = format!("title      {}", look.came.proposal.title);
    assert!(person.heard(&title), "{}", person.text());
    assert_eq!(person.pictures, 2);
}

#[test]
fn what_was_changed_is_kept_when_the_proposal_is_made_again() {
    let first = look(About::Proposal);
    let lines = ["slow down the visitor", "the robot should say excuse me", "again somewhere livelier"];
    let (decision, mut log) = talk(&first, &mut Script::of(&lines));
    let mine = decision.unwrap().left;
    let slowed = mine.proposal.humans[0].speed_mps;
    assert!(slowed.is_some_and(|mps| mps < 1.2) && mine.proposal != first.came.proposal);
    // The author answers with what it had written first.
    let mut second = first.clone();
    second.job = "again".to_owned();
    second.reasons = vec![Fault::new(FaultCode::PPerson, Stage::Proposal, "somewhere livelier")];
    second.came.reading = mine.reading.clone();
    let mut person = Script::of(&["accept"]);
    let left = converse(&second, &mut log, &mut person).unwrap().unwrap().left;
    assert_eq!(left.proposal.humans[0].speed_mps, slowed, "{}", person.text());
    assert_eq!(left.proposal.robot.script, mine.proposal.robot.script, "{}", person.text());
    // It is a change as any other: it can be taken back.
    let (_, mut log) = talk(&first, &mut Script::of(&lines));
    let mut person = Script::of(&["undo", "accept"]);
    let left = converse(&second, &mut log, &mut person).unwrap().unwrap().left;
    assert!(person.heard("undone: what you had changed, kept"), "{}", person.text());
    assert_eq!(left.proposal, second.came.proposal);
}

#[test]
fn what_a_model_answers_to_what_was_changed_stands_and_what_it_dropped_is_put_back() {
    let first = Look { author: "openai:m".parse().unwrap(), ..look(About::Proposal) };
    let lines = ["slow down the visitor", "the robot should say excuse me", "again let her stand for longer"];
    let (decision, mut log) = talk(&first, &mut Script::of(&lines));
    let mine = decision.unwrap().left;
    let mut second = Look { job: "again".to_owned(), ..first.clone() };
    second.reasons = vec![Fault::new(FaultCode::PPerson, Stage::Proposal, "let her stand for longer")];
    second.came.reading = mine.reading.clone();
    // It says another pace than the person and dropped the robot's words.
    second.came.proposal.humans[0].speed_mps = Some(0.5);
    let mut person = Script::of(&["accept"]);
    let left = converse(&second, &mut log, &mut person).unwrap().unwrap().left;
    assert_eq!(left.proposal.humans[0].speed_mps, Some(0.5), "{}", person.text());
    assert_eq!(left.proposal.robot.script, mine.proposal.robot.script, "{}", person.text());
}

#[test]
fn no_words_are_both_done_and_not_done() {
    let look = look(About::Draft);
    for words in [
        "the visitor gives way when the robot is within 3 m and yodels",
        "slow down the visitor and paint her green",
        "add a nurse who walks towards the robot and juggles",
        "add a third person and remove the astronaut",
    ] {
        let mut person = Script::of(&[words, "quit"]);
        talk(&look, &mut person);
        let text = person.text();
        let quoted = |line: &str| line.split('`').nth(1).unwrap_or_default().to_owned();
        let refused: Vec<String> = person
            .heard
            .iter()
            .filter(|(_, line)| line.starts_with("not done"))
            .map(|(_, line)| quoted(line))
            .collect();
        assert!(!refused.contains(&words.to_owned()) || !person.heard("done       "), "{text}");
        assert!(!(person.heard("nothing was changed for it") && refused.is_empty()), "{text}");
    }
}

#[test]
fn after_undo_the_story_the_picture_and_the_text_by_hand_are_those_of_before() {
    let look = look(About::Draft);
    let mut person = Script::of(&["add a nurse who walks towards the robot", "show", "undo", "accept"]);
    let (decision, _) = talk(&look, &mut person);
    assert_eq!(decision.unwrap().left, look.came);
    // Drawn as it came, as it was changed, as it was shown, and as it is again.
    assert_eq!(person.pictures, 4, "{}", person.text());

    let mut person = Script::of(&["edit proposal", "slow down the visitor", "undo", "edit proposal", "accept"]);
    let mut tries = 0;
    person.editor = Some(Box::new(move |text| {
        tries += 1;
        assert!(text.starts_with("{\n"), "what was undone is not opened again: {text}");
        Ok(if tries == 1 { "{{".to_owned() } else { text.to_owned() })
    }));
    talk(&look, &mut person);
    assert!(person.heard("proposal.json cannot be read"), "{}", person.text());
}
