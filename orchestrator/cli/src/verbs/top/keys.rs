//! What keys do at the table of `top`: a cursor over batches and failures, a question before anything is given up, a page to read.

use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use socrates_app::top::{Deed, Sight};

/// What keys there are, in the line at the bottom.
pub(super) const HELP: &str = "↑ ↓ choose · e explain · p pause or resume a batch · c cancel · q quit";
/// The same while a page is read.
pub(super) const READING: &str = "↑ ↓ scroll · q back";

/// What stands on the terminal besides the tables.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) enum Mode {
    /// The tables alone.
    #[default]
    Looking,
    /// A question: whether this is really to be done.
    Asking(Deed),
    /// Lines to read, from this one on.
    Reading(Vec<String>, usize),
}

/// What a key asks for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Wish {
    /// Nothing, or only what the terminal shows.
    Nothing,
    /// An end.
    Leave,
    /// Something to be done by the orchestrator.
    Act(Deed),
    /// What was tried for a job.
    Explain(String),
}

/// Whether a key leaves what is shown.
const fn leaves(code: KeyCode) -> bool {
    matches!(code, KeyCode::Char('q') | KeyCode::Esc)
}

/// Where a key brings a place among so many.
fn moved(place: usize, code: KeyCode, count: usize) -> usize {
    let last = count.saturating_sub(1);
    let place = place.min(last);
    if code == KeyCode::Up {
        place.saturating_sub(1)
    } else if code == KeyCode::Down {
        (place + 1).min(last)
    } else {
        place
    }
}

/// What the cursor is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum On {
    /// A batch, by its row.
    Batch(usize),
    /// A failed attempt, by its row.
    Failure(usize),
}

/// A person at the table.
#[derive(Debug, Default)]
pub(super) struct Hand {
    /// Row of the cursor, over batches and then failures.
    pub(super) cursor: usize,
    pub(super) mode: Mode,
    /// What is said in the line below the head.
    pub(super) note: String,
}

impl Hand {
    /// What the cursor is on; none where there is neither batch nor failure.
    pub(super) fn on(&self, sight: &Sight) -> Option<On> {
        let (batches, failures) = (sight.batches.len(), sight.failures.len());
        let at = self.cursor.min((batches + failures).checked_sub(1)?);
        Some(if at < batches { On::Batch(at) } else { On::Failure(at - batches) })
    }

    /// What a key does.
    pub(super) fn press(&mut self, key: KeyEvent, sight: &Sight) -> Wish {
        if key.kind != KeyEventKind::Press {
            return Wish::Nothing;
        }
        if key.code == KeyCode::Char('c') && key.modifiers.contains(KeyModifiers::CONTROL) {
            return Wish::Leave;
        }
        match std::mem::take(&mut self.mode) {
            Mode::Looking => self.looking(key.code, sight),
            Mode::Asking(deed) if key.code == KeyCode::Char('y') => Wish::Act(deed),
            Mode::Asking(_) => {
                "nothing was canceled".clone_into(&mut self.note);
                Wish::Nothing
            }
            Mode::Reading(lines, from) => {
                if !leaves(key.code) {
                    let from = moved(from, key.code, lines.len());
                    self.mode = Mode::Reading(lines, from);
                }
                Wish::Nothing
            }
        }
    }

    fn looking(&mut self, code: KeyCode, sight: &Sight) -> Wish {
        self.note.clear();
        let rows = sight.batches.len() + sight.failures.len();
        self.cursor = moved(self.cursor, code, rows);
        if leaves(code) {
            Wish::Leave
        } else if let KeyCode::Char(key @ ('p' | 'c' | 'e')) = code {
            self.chosen(key, sight)
        } else {
            Wish::Nothing
        }
    }

    /// A key that means what the cursor is on.
    fn chosen(&mut self, key: char, sight: &Sight) -> Wish {
        let batch = |at: usize| sight.batches.get(at);
        let failure = |at: usize| sight.failures.get(at);
        let found = match (key, self.on(sight)) {
            ('p', Some(On::Batch(at))) => batch(at).map(|batch| {
                let name = batch.name.clone();
                Wish::Act(if batch.paused { Deed::Resume(name) } else { Deed::Pause(name) })
            }),
            ('e', Some(On::Failure(at))) => failure(at).map(|failure| Wish::Explain(failure.job.clone())),
            ('c', Some(on)) => {
                let deed = match on {
                    On::Batch(at) => batch(at).map(|batch| Deed::CancelBatch(batch.name.clone())),
                    On::Failure(at) => failure(at).map(|failure| Deed::CancelScenario(failure.scenario.clone())),
                };
                deed.map(|deed| {
                    self.mode = Mode::Asking(deed);
                    Wish::Nothing
                })
            }
            _ => None,
        };
        found.unwrap_or_else(|| {
            let words = match key {
                'p' => "p is for a batch: choose one with ↑",
                'e' => "e is for a failed attempt: choose one with ↓",
                _ => "there is nothing to cancel",
            };
            words.clone_into(&mut self.note);
            Wish::Nothing
        })
    }

    /// The line at the bottom: a question, or the keys that there are.
    pub(super) fn bottom(&self) -> String {
        match &self.mode {
            Mode::Looking => HELP.to_owned(),
            Mode::Reading(..) => READING.to_owned(),
            Mode::Asking(Deed::CancelBatch(name)) => {
                format!("Give up all of batch `{name}` that is not done? y gives it up, any other key does not")
            }
            Mode::Asking(Deed::CancelScenario(name)) => {
                format!("Give up scenario `{name}`? y gives it up, any other key does not")
            }
            Mode::Asking(Deed::Pause(name) | Deed::Resume(name)) => format!("Batch `{name}`? y does it"),
        }
    }
}

#[cfg(test)]
mod tests {
    use socrates_app::top::{BatchRow, FailureRow};

    use super::*;

    fn sight() -> Sight {
        let batch = |name: &str, paused: bool| BatchRow {
            name: name.to_owned(),
            paused,
            cells: std::array::from_fn(|_| String::new()),
        };
        let failure = FailureRow { job: "s-1/paths/r0".to_owned(), scenario: "s-1".to_owned(), line: String::new() };
        Sight {
            head: Vec::new(),
            stages: Vec::new(),
            workers: Vec::new(),
            batches: vec![batch("night", false), batch("day", true)],
            failures: vec![failure],
            object: serde_json::Value::Null,
        }
    }

    fn press(hand: &mut Hand, code: KeyCode) -> Wish {
        hand.press(KeyEvent::new(code, KeyModifiers::NONE), &sight())
    }

    #[test]
    fn the_cursor_goes_over_batches_and_failures_and_no_further() {
        let mut hand = Hand::default();
        assert_eq!(hand.on(&sight()), Some(On::Batch(0)));
        press(&mut hand, KeyCode::Up);
        assert_eq!(hand.on(&sight()), Some(On::Batch(0)));
        for _ in 0..5 {
            press(&mut hand, KeyCode::Down);
        }
        assert_eq!(hand.on(&sight()), Some(On::Failure(0)));
        let nothing = Sight { batches: Vec::new(), failures: Vec::new(), ..sight() };
        assert_eq!(hand.on(&nothing), None);
        assert_eq!(hand.press(KeyEvent::new(KeyCode::Char('c'), KeyModifiers::NONE), &nothing), Wish::Nothing);
        assert_eq!(hand.note, "there is nothing to cancel");
    }

    #[test]
    fn p_turns_a_batch_over_and_e_explains_a_failure() {
        let mut hand = Hand::default();
        assert_eq!(press(&mut hand, KeyCode::Char('p')), Wish::Act(Deed::Pause("night".to_owned())));
        assert_eq!(press(&mut hand, KeyCode::Char('e')), Wish::Nothing);
        assert!(hand.note.contains("failed attempt"), "{}", hand.note);
        press(&mut hand, KeyCode::Down);
        assert!(hand.note.is_empty());
        assert_eq!(press(&mut hand, KeyCode::Char('p')), Wish::Act(Deed::Resume("day".to_owned())));
        press(&mut hand, KeyCode::Down);
        assert_eq!(press(&mut hand, KeyCode::Char('e')), Wish::Explain("s-1/paths/r0".to_owned()));
    }

    #[test]
    fn nothing_is_given_up_without_a_yes() {
        let mut hand = Hand::default();
        assert_eq!(press(&mut hand, KeyCode::Char('c')), Wish::Nothing);
        assert!(hand.bottom().contains("`night`"), "{}", hand.bottom());
        // A key that means something elsewhere means no here.
        assert_eq!(press(&mut hand, KeyCode::Char('q')), Wish::Nothing);
        assert_eq!((&hand.mode, hand.note.as_str()), (&Mode::Looking, "nothing was canceled"));
        press(&mut hand, KeyCode::Char('c'));
        assert_eq!(press(&mut hand, KeyCode::Char('y')), Wish::Act(Deed::CancelBatch("night".to_owned())));
        for _ in 0..2 {
            press(&mut hand, KeyCode::Down);
        }
        press(&mut hand, KeyCode::Char('c'));
        assert_eq!(press(&mut hand, KeyCode::Char('y')), Wish::Act(Deed::CancelScenario("s-1".to_owned())));
    }

    #[test]
    fn a_page_is_scrolled_and_left_and_the_end_is_always_one_key_away() {
        let mut hand = Hand { mode: Mode::Reading(vec!["a".to_owned(), "b".to_owned()], 0), ..Hand::default() };
        for _ in 0..3 {
            press(&mut hand, KeyCode::Down);
        }
        assert!(matches!(hand.mode, Mode::Reading(_, 1)));
        assert_eq!(press(&mut hand, KeyCode::Char('q')), Wish::Nothing);
        assert_eq!(hand.mode, Mode::Looking);
        assert_eq!(press(&mut hand, KeyCode::Char('q')), Wish::Leave);
        let broken_off = KeyEvent::new(KeyCode::Char('c'), KeyModifiers::CONTROL);
        hand.mode = Mode::Asking(Deed::CancelBatch("night".to_owned()));
        assert_eq!(hand.press(broken_off, &sight()), Wish::Leave);
        let up = KeyEvent::new_with_kind(KeyCode::Char('q'), KeyModifiers::NONE, KeyEventKind::Release);
        assert_eq!(hand.press(up, &sight()), Wish::Nothing);
    }
}
