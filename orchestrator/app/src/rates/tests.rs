use super::*;

/// First seed of the random worlds that the tests play on; none was chosen for what it draws.
const WORLDS_FROM: u64 = 9001;

fn quiet(_: usize, _: usize, _: &str) {}

#[test]
fn every_scenario_of_the_catalog_happens_on_its_first_seed() {
    catalog(1, 100);
}

#[test]
#[ignore = "sweep: every card, 5 seeds each, at least 97 %"]
fn every_scenario_of_the_catalog_really_happens() {
    catalog(5, 97);
}

/// Plays every card with this number of seeds; one of five may fail, two of five are another scenario than the card says.
#[expect(clippy::print_stdout, reason = "figures are for readers of the tests")]
fn catalog(seeds: u64, least_percent: usize) {
    let wanted = usize::try_from(seeds).unwrap();
    let played = play(&cards(&[]).unwrap(), places(&[]).unwrap(), (seeds, false), &mut quiet).unwrap();
    let mut lines = Vec::new();
    for (number, card) in played.cards.iter().enumerate() {
        let tally = played.tally(number);
        if tally.realised < tally.played {
            let failures = played.failures(number);
            lines.push(format!("{}: {} of {} {failures:?}", card.id, tally.realised, tally.played));
        }
        assert!(tally.played == wanted && tally.realised + 1 >= tally.played, "{}", lines.join("\n"));
    }
    let pooled = played.pooled();
    println!("{} of {}, bound {least_percent} %\n{}", pooled.realised, pooled.played, lines.join("\n"));
    assert!(pooled.realised * 100 >= pooled.played * least_percent, "{}", lines.join("\n"));
}

#[test]
#[ignore = "sweep: every card on 15 random worlds, 3 seeds each, at least 90 %"]
#[expect(clippy::print_stdout, reason = "figures are for readers of the tests")]
fn most_scenarios_happen_on_random_worlds() {
    let seeds: Seeds = format!("{WORLDS_FROM}..{}", WORLDS_FROM + 2).parse().unwrap();
    let played = play(&cards(&[]).unwrap(), drawn(&seeds, &[]).unwrap(), (3, false), &mut quiet).unwrap();
    let pooled = played.pooled();
    let table = table::told(&played).join("\n");
    println!("{table}");
    assert!(pooled.played >= 40 * 3 && pooled.realised * 100 >= pooled.played * 90, "{table}");
}

#[test]
fn random_worlds_are_counted_by_kind_and_told_of_by_name() {
    let two = drawn(&"7..8".parse().unwrap(), &["office".to_owned(), "home".to_owned()]).unwrap();
    let told: Vec<(&str, &str)> = two.iter().map(|place| (place.column.as_str(), place.name.as_str())).collect();
    assert_eq!(told, [("office", "office-7"), ("home", "home-7"), ("office", "office-8"), ("home", "home-8")]);
    let castle = drawn(&Seeds::one(7), &["castle".to_owned()]).unwrap_err();
    assert!(castle.to_string().contains("castle"), "{castle}");
    let played = play(&cards(&["a".to_owned(), "o".to_owned()]).unwrap(), two, (2, false), &mut quiet).unwrap();
    let told = table::told(&played).join("\n");
    assert!(told.contains("office") && told.contains("needs an elevator, the map has none"), "{told}");
}

#[test]
fn what_does_not_fit_is_left_out_with_its_reason_and_the_rest_is_played() {
    let cards = cards(&["exiting_elevator".to_owned(), "frontal_approach".to_owned()]).unwrap();
    let places = places(&["office".to_owned(), "office".to_owned(), "hospital".to_owned()]).unwrap();
    let columns: Vec<&str> = places.iter().map(|place| place.column.as_str()).collect();
    assert_eq!(columns, ["office", "office-2", "hospital"]);
    let played = play(&cards, places, (1, true), &mut quiet).unwrap();
    assert_eq!(played.unfit.iter().map(|(card, place, _)| (*card, *place)).collect::<Vec<_>>(), [(0, 0), (0, 1)]);
    let runs: Vec<(usize, usize)> = played.runs.iter().map(|(item, _)| (item.card, item.place)).collect();
    assert_eq!(runs, [(0, 2), (1, 0), (1, 1), (1, 2)]);
    let told = table::told(&played).join("\n");
    assert!(told.contains("-[1]") && told.contains("[1] needs an elevator, the map has none"), "{told}");
    assert!(told.contains("fits       4 of 6 pairs"), "{told}");
    // The same map under two names: the same run.
    assert_eq!(played.runs.get(1).map(|(_, outcome)| outcome), played.runs.get(2).map(|(_, outcome)| outcome));
}

#[test]
fn cards_that_fit_no_map_are_refused_with_the_reason_and_the_maps_that_they_fit() {
    let played =
        nothing_fits(&cards(&["exiting_elevator".to_owned()]).unwrap(), &places(&["office".to_owned()]).unwrap());
    assert!(played.hint.contains("hospital"), "{played}");
    assert!(played.causes.iter().any(|why| why.contains("on office: needs an elevator, the map has none")), "{played}");
}

#[test]
fn a_second_call_says_the_same_whatever_thread_played_what() {
    let cards = cards(&["f".to_owned(), "k".to_owned()]).unwrap();
    let once = || {
        let played = play(&cards, places(&[]).unwrap(), (3, false), &mut quiet).unwrap();
        (table::told(&played), table::object(&played).to_string())
    };
    assert_eq!(once(), once());
}
