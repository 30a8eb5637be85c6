//! Broken cores: that our checks catch an orchestrator which does what it must not.
//!
//! ```text
//! flaw ─► site (step, store, deaths) ◄─ life (random: workers, clients, clocks)
//!           ├─► the state's checker, after every event
//!           ├─► the store: what it refuses, and the audit of a file that it wrote
//!           ├─► the witness: what workers and clients were told
//!           └─► whether everything comes to an end
//! ```
//!
//! A check that passes a sound core proves little unless it fails a broken one. `docs/reliability.md` has the table.

mod flaw;
mod life;
mod site;
mod witness;

use std::collections::BTreeMap;

use self::flaw::Flaw;
use self::life::live;
use self::site::Check;

/// After how many lives and events each check noticed a flaw first, and what it said.
type Noticed = BTreeMap<Check, (u64, u64, String)>;

/// Lives of these seeds under a flaw, until every check has noticed it; the numbers of lives and events.
fn lives(flaw: Flaw, seeds: &[u64]) -> (Noticed, u64, u64) {
    // In memory where that can be: every audit is of a new file, and closing one waits for a disk.
    let folder = tempfile::tempdir_in("/dev/shm").or_else(|_none| tempfile::tempdir()).unwrap();
    let mut noticed = Noticed::new();
    let mut events = 0;
    for (seed, number) in seeds.iter().zip(1..) {
        let site = live(flaw, *seed, folder.path());
        for (check, (after, what)) in &site.noticed {
            noticed.entry(*check).or_insert_with(|| (number, events + after, what.clone()));
        }
        events += site.events;
        if noticed.len() == Check::ALL.len() {
            return (noticed, number, events);
        }
    }
    (noticed, seeds.len() as u64, events)
}

/// The check by which each flaw must be noticed; others may notice it too.
fn must_notice(flaw: Flaw) -> Option<Check> {
    match flaw {
        Flaw::None => None,
        Flaw::LostAttempt | Flaw::ReusedFences | Flaw::NoTimers => Some(Check::State),
        Flaw::SecondResult | Flaw::SplitStep | Flaw::LostEntry | Flaw::LostEnd => Some(Check::Store),
        Flaw::AnswersFirst
        | Flaw::NoFence
        | Flaw::NoRequestIds
        | Flaw::WallClock
        | Flaw::DoubleGrant
        | Flaw::LostReport => Some(Check::Told),
    }
}

#[test]
fn every_flaw_is_noticed_and_the_sound_core_is_not() {
    // The last flaw needs a rare life to show itself.
    flaws(&(0..15).chain(50..60).collect::<Vec<u64>>());
}

#[test]
#[ignore = "sweep: 60 lives a flaw, the table of docs/reliability.md"]
fn every_flaw_is_noticed_in_sixty_lives_and_the_sound_core_is_not() {
    flaws(&(0..60).collect::<Vec<u64>>());
}

/// Checks that every flaw is noticed in lives of these seeds and the sound core is not, and prints the table.
#[expect(clippy::print_stdout, reason = "the table of the document")]
fn flaws(seeds: &[u64]) {
    let (noticed, count, events) = lives(Flaw::None, seeds);
    assert!(noticed.is_empty(), "the sound core: {noticed:#?}");
    let mut table = vec![
        "| flaw | state | store | told | end |".to_owned(),
        "|---|---|---|---|---|".to_owned(),
        format!("| {} | – | – | – | – |", Flaw::None.words()),
    ];
    let mut missed = Vec::new();
    for flaw in Flaw::ALL {
        let (noticed, ..) = lives(flaw, seeds);
        let cell = |check: &Check| match noticed.get(check) {
            Some((lives, events, _)) => format!("{lives} ({events})"),
            None => "–".to_owned(),
        };
        let cells: Vec<String> = Check::ALL.iter().map(cell).collect();
        table.push(format!("| {} | {} |", flaw.words(), cells.join(" | ")));
        if must_notice(flaw).is_some_and(|check| !noticed.contains_key(&check)) {
            missed.push(format!("{flaw:?}: {noticed:#?}"));
        }
    }
    println!("{count} lives, {events} events of the sound core\n{}", table.join("\n"));
    assert!(missed.is_empty(), "not noticed:\n{}", missed.join("\n"));
}

#[test]
fn the_document_names_every_flaw() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/reliability.md");
    let text = std::fs::read_to_string(root).unwrap();
    for flaw in Flaw::ALL {
        assert!(text.contains(&format!("| {} |", flaw.words())), "docs/reliability.md lacks `{}`", flaw.words());
    }
}
