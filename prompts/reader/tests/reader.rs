//! The reader as a whole: its rows by their examples, and what holds of every text.

#![cfg(test)]

use std::path::{Path, PathBuf};

use serde::Deserialize;
use socrates_model::PlaceClass;
use socrates_reader::{Act, Example, Fate, Files, Reader, SHIPPED, Toward, Verdict};

#[derive(Deserialize)]
struct Corpus {
    request: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    text: String,
}

/// Every text of the corpora.
fn texts() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../offline/corpus");
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
    paths.sort();
    let corpus = |path: &PathBuf| toml::from_str::<Corpus>(&std::fs::read_to_string(path).unwrap()).unwrap();
    let texts: Vec<String> = paths.iter().map(corpus).flat_map(|corpus| corpus.request).map(|case| case.text).collect();
    assert!(texts.len() > 3000, "{}", texts.len());
    texts
}

fn holds(reader: &Reader, example: &Example<'_>) -> bool {
    if example.file == "edits" {
        return reader.wishes(example.text).first().map(|wish| wish.edit.name()) == Some(example.gives);
    }
    let story = reader.read(example.text).story.to_string();
    if matches!(example.file, "rewrites" | "scopes") {
        return story == reader.read(example.gives).story.to_string();
    }
    story.lines().any(|line| line.starts_with(example.gives))
}

#[test]
fn every_row_reads_its_examples_and_no_other() {
    let reader = Reader::of(SHIPPED).unwrap();
    let examples = reader.examples();
    assert!(examples.len() > 150, "{}", examples.len());
    let wrong: Vec<_> = examples.iter().filter(|example| holds(&reader, example) != example.does).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn a_row_that_cannot_be_is_refused_with_its_file() {
    let bad = Files { signs: "[[row]]\nsays = \"HELLO\"", ..SHIPPED };
    assert_eq!(Reader::of(bad).unwrap_err().to_string(), "`signs.toml` cannot be read");
    let frames = "[[row]]\nid = \"odd\"\nphrases = [\"@ walks\"]\nreads = []\ngives = \"\"\nnot = []";
    let bad = Files { frames, ..SHIPPED };
    let fault = Reader::of(bad).unwrap_err();
    assert_eq!(fault.to_string(), "a pattern cannot be read");
}

#[test]
fn no_act_of_any_clause_vanishes() {
    let reader = Reader::shipped();
    let mut lost = Vec::new();
    for text in texts() {
        let passes = reader.passes(&text);
        lost.extend(passes.lost().into_iter().map(|word| format!("`{word}` of “{text}”")));
    }
    assert!(lost.is_empty(), "{} acts, among them {:#?}", lost.len(), lost.iter().take(5).collect::<Vec<_>>());
}

#[test]
fn every_word_lies_in_one_piece_and_pieces_stand_in_the_order_of_the_text() {
    let reader = Reader::shipped();
    for text in texts() {
        let read = reader.read(&text);
        assert!(
            read.pieces.iter().all(|piece| text.get(piece.at.clone()).is_some_and(|words| !words.is_empty())),
            "{text}"
        );
        let apart = read.pieces.windows(2).all(|two| two[0].at.end <= two[1].at.start);
        assert!(apart, "{text}: {:?}", read.pieces);
        // A word with its apostrophe may be two: `it's`.
        for (at, letter) in text.char_indices().filter(|(_, letter)| letter.is_alphanumeric()) {
            let behind = read.pieces.partition_point(|piece| piece.at.end <= at);
            let of = read.pieces.get(behind).is_some_and(|piece| piece.at.start <= at);
            assert!(of, "`{letter}` at {at} of “{text}”: {:?}", read.pieces);
        }
    }
}

/// The words of a text that are said to be not read.
fn not_read(text: &str) -> Vec<&str> {
    let read = socrates_reader::read(text);
    let lost = read.pieces.into_iter().filter(|piece| piece.fate == Fate::NotRead);
    lost.map(|piece| text.get(piece.at).unwrap()).collect()
}

#[test]
fn what_goes_into_no_statement_is_said_to_be_not_read() {
    for (text, lost) in [
        // How long somebody stands who does nothing else is in no form.
        ("A nurse stands in the corridor for 10 s.", vec!["10 s"]),
        // A reason for nothing that could be done at once.
        ("When the robot has yodeled, a nurse steps aside.", vec!["When the robot has yodeled"]),
        // Whoever is named, and of whom nothing is told.
        ("A nurse crosses the corridor with a juggler.", vec!["juggler"]),
        ("A nurse steps aside at 2 m.", vec![]),
        ("A nurse never blocks the robot.", vec![]),
    ] {
        assert_eq!(not_read(text), lost, "{text}");
    }
}

#[test]
fn words_that_describe_ask_for_nothing() {
    for (text, lost) in [
        // Where somebody stands, what the robot does beside its way, a heading, and beside whom somebody is.
        ("A porter waits near the aquarium.", vec![]),
        ("The robot hums along the corridor. A nurse stops.", vec![]),
        ("Politeness study: a nurse stops.", vec![]),
        ("A nurse stops. Her colleague stands behind her.", vec![]),
        // Somebody who was not made out, and what does not quite happen.
        ("A nurse stops near a juggler.", vec!["juggler"]),
        ("A nurse nearly stops.", vec!["nearly"]),
    ] {
        assert_eq!(not_read(text), lost, "{text}");
    }
}

#[test]
fn of_two_of_whom_she_and_he_are_guessed_the_second_is_doubted() {
    let text = "A nurse crosses the corridor, and a doctor comes towards the robot. She stops. He looks at it.";
    assert_eq!(not_read(text), ["He"]);
    assert_eq!(
        not_read("A woman crosses the corridor, and a man comes towards the robot. She stops. He looks at it."),
        [""; 0]
    );
}

#[test]
fn a_clause_may_be_read_in_part() {
    let text = "A nurse yodels in the corridor. She stops when she sees the robot. The weather yodels.";
    let verdicts: Vec<Verdict> =
        socrates_reader::read(text).verdicts().into_iter().map(|(_, verdict)| verdict).collect();
    assert!(
        matches!(&verdicts[0], Verdict::Partly(lost) if text.get(lost[0].clone()) == Some("yodels")),
        "{verdicts:?}"
    );
    assert_eq!(verdicts[1], Verdict::Read);
    assert_eq!(verdicts[2], Verdict::NotRead);
}

#[test]
fn people_are_counted() {
    for (text, people) in [
        ("Two nurses and a guest walk towards the robot.", 3),
        ("Three visitors stand in the corridor, no, two.", 2),
        ("There are four, sorry, five visitors in the corridor.", 5),
        ("Three people come out: a nurse and two guests.", 3),
        ("A couple, a woman and her husband, walk towards the robot.", 2),
        ("Maria, a young nurse, walks towards the robot and stops.", 1),
        ("Two porters stand there. The first stops, his colleague walks on.", 2),
        ("People block robots. A nurse crosses the corridor.", 1),
        ("Could I have a person? A nurse walks towards the robot.", 1),
        ("A mother and her son walk towards the robot. The boy stops.", 2),
        ("One visitor runs away. The other stops.", 2),
        ("At the junction an old man stops, a nurse a few steps behind him.", 2),
        ("Around a quarter to eight a nurse crosses the corridor.", 1),
        ("Half a dozen visitors stand there.", 6),
    ] {
        let story = socrates_reader::read(text).story;
        assert_eq!(story.people.len(), people, "{text}\n{story}");
    }
}

#[test]
fn of_several_those_act_who_are_meant() {
    for (text, who) in [
        ("Three visitors stand there. All but the last step aside.", vec![1, 2]),
        ("Three visitors stand there. All but one step aside.", vec![1, 2]),
        ("Three visitors stand there. The second steps aside.", vec![2]),
        (
            "Two visitors come. One crosses, the other walks ahead of the robot. The one who crosses steps aside.",
            vec![1],
        ),
        ("Two visitors come. The first stops at 3 m. None of them steps aside.", vec![]),
    ] {
        let story = socrates_reader::read(text).story;
        let steps_aside =
            |person: &socrates_reader::Person| person.steps.iter().any(|step| step.act.name() == "give_way");
        let found: Vec<usize> =
            story.people.iter().enumerate().filter(|(_, person)| steps_aside(person)).map(|(at, _)| at + 1).collect();
        assert_eq!(found, who, "{text}\n{story}");
    }
}

#[test]
fn what_no_row_knows_is_said_to_be_not_read() {
    let read = socrates_reader::read("A nurse yodels in the corridor and steps aside when she sees the robot.");
    let words: Vec<_> = read
        .pieces
        .iter()
        .filter(|piece| piece.fate == Fate::NotRead)
        .map(|piece| (piece.at.start, piece.at.end))
        .collect();
    assert_eq!(words, [(8, 14)]);
    assert_eq!(read.story.to_string(), "place: corridor\nhuman_1: nurse\nhuman_1: give_way when visible\n");
}

#[test]
fn odd_texts_are_read_as_nothing() {
    for text in [
        "",
        " ",
        "...",
        "?!",
        "\u{1f916}\u{1f916}",
        "1 2 3",
        "'s",
        "n't",
        "(((",
        "- - -",
        "the the the",
        "\"",
        "and and and",
    ] {
        let read = socrates_reader::read(text);
        assert!(read.story.people.len() <= 3, "{text}: {}", read.story);
    }
}

/// The passes of a sentence, as `--show` prints them; the file beside this one is what a reader of the crate looks at first.
#[test]
fn the_passes_print_themselves() {
    let text =
        "I want to see how it copes. The moment an elderly nurse sees the robot, she stops for 3 s and looks at it.";
    let shown = Reader::shipped().passes(text).to_string();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/passes.txt");
    if std::env::var_os("UPDATE_PASSES").is_some() {
        std::fs::write(&file, &shown).unwrap();
    }
    assert_eq!(shown, std::fs::read_to_string(file).unwrap(), "UPDATE_PASSES=1 writes it anew");
}

fn roles(all: &[&str]) -> Vec<String> {
    all.iter().map(|role| (*role).to_owned()).collect()
}

#[test]
fn an_edit_means_those_who_are_there_and_nobody_else() {
    let reader = Reader::shipped();
    let there = roles(&["nurse", "young woman", "visitor"]);
    for (text, people) in [
        ("remove the nurse", &[0][..]),
        ("the woman should be slower", &[1]),
        ("human_3 and the second one stop", &[2, 1]),
        ("swap them", &[0, 1, 2]),
        ("remove the astronaut", &[]),
        ("let the fourth one be faster", &[]),
        ("no gestures", &[]),
    ] {
        let whom = reader.whom(text, &there, &[]);
        assert_eq!((whom.people.as_slice(), whom.guess), (people, false), "{text}");
    }
    assert!(reader.whom("she stops", &there, &[]).guess, "nobody was spoken of");
    assert_eq!(reader.whom("she stops", &there, &[1]).people, [1]);
    assert!(reader.whom("the gentleman stops", &there, &[]).guess, "nobody is called so");
    assert!(reader.whom("make the robot's path longer", &there, &[]).robot);
}

#[test]
fn a_text_about_people_who_are_known_tells_of_them_and_of_those_who_join() {
    let read = Reader::shipped().read_of(
        "human_2 stops when the robot is within 2 m. A porter follows the robot. The nurse does not look at it.",
        &roles(&["nurse", "visitor"]),
        &[],
    );
    let people = &read.story.people;
    assert_eq!(people.iter().map(|person| person.role.as_str()).collect::<Vec<_>>(), ["nurse", "visitor", "porter"]);
    assert_eq!(people[1].steps[0].to_string(), "stand_still when near 2");
    assert_eq!(people[2].steps[0].act, Act::Follow);
    assert!(people[0].denied.contains(&Act::Look) && people[0].steps.is_empty(), "{people:#?}");
}

#[test]
fn a_task_names_the_places_of_the_way() {
    let text = "Bring mail from ward 2 to the exit via the corridor and do not enter the kitchen, then come back.";
    let errands = Reader::shipped().errands(text);
    let said = |at: &std::ops::Range<usize>| &text[at.clone()];
    let legs: Vec<_> =
        errands.iter().flat_map(|errand| &errand.legs).map(|leg| (leg.toward, said(&leg.name))).collect();
    assert_eq!(legs, [(Toward::From, "ward 2"), (Toward::To, "exit"), (Toward::Past, "corridor")]);
    let denied: Vec<_> =
        errands.iter().filter_map(|errand| errand.denied.as_ref()).map(|denied| said(&denied.at)).collect();
    assert_eq!(denied, ["do not enter the kitchen"]);
    assert_eq!(
        errands.iter().filter(|errand| errand.returns).map(|errand| said(&errand.at)).collect::<Vec<_>>(),
        ["come back"]
    );
}

#[test]
fn a_part_of_a_place_is_on_the_way_and_a_size_is_no_name() {
    let of = |text: &str| {
        let errands = Reader::shipped().errands(text);
        let legs: Vec<(Toward, String)> = errands
            .iter()
            .flat_map(|errand| &errand.legs)
            .map(|leg| (leg.toward, text[leg.name.clone()].to_owned()))
            .collect();
        let spots: Vec<(Toward, PlaceClass)> =
            errands.iter().flat_map(|errand| &errand.spots).map(|spot| (spot.toward, spot.class)).collect();
        (legs.into_iter().filter(|(_, name)| !matches!(name.as_str(), "end")).collect::<Vec<_>>(), spots)
    };
    let corridor = vec![(Toward::Past, PlaceClass::Corridor)];
    assert_eq!(of("Deliver a parcel to the other end of the corridor"), (vec![], corridor.clone()));
    assert_eq!(of("Fetch a label from the end of the passage"), (vec![], corridor));
    assert_eq!(of("Take documents to the small office"), (vec![], vec![]));
    assert_eq!(of("Go to the other ward").1, [(Toward::To, PlaceClass::Room)]);
    assert_eq!(of("Carry files to the doctor's office").0, [(Toward::To, "doctor's office".to_owned())]);
    assert_eq!(of("Carry files to the doctor").0, []);
}

#[test]
fn a_scene_says_who_is_there_and_how_fast_they_go() {
    for (text, role, pace_mps, said) in [
        ("A hospital floor with visitors in a hurry", Some("visitor"), Some(1.5), vec!["visitors", "hurry"]),
        ("An emergency", None, Some(1.5), vec!["emergency"]),
        ("A slow afternoon among nurses", Some("nurse"), Some(0.6), vec!["nurses", "slow"]),
        ("A warehouse in which people pick orders and robots carry them", None, None, vec![]),
    ] {
        let scene = Reader::shipped().scene(text);
        assert_eq!((scene.role.as_deref(), scene.pace_mps), (role, pace_mps), "{text}");
        assert_eq!(scene.used.iter().map(|at| &text[at.clone()]).collect::<Vec<_>>(), said, "{text}");
    }
}

#[test]
fn english_is_familiar_and_other_languages_are_not() {
    // Some texts of the corpora are in other languages.
    let strange = |text: &&String| {
        let familiar = Reader::shipped().familiar(text);
        familiar.known * 10 < familiar.words * 3
    };
    let texts = texts();
    let strangers: Vec<&String> = texts.iter().filter(strange).collect();
    assert!(strangers.len() * 200 < texts.len(), "{strangers:#?}");
    for text in ["Ein volles Lager mit vielen Leuten", "Une infirmière traverse le couloir devant le robot"] {
        let known = Reader::shipped().familiar(text);
        assert!(known.known * 10 < known.words * 4, "{known:?}: {text}");
    }
}
