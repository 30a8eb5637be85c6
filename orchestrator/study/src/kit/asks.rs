//! What is asked about a film: questions as they stand on a page, whichever program shows it.

use serde_json::{Value, json};

use crate::design::Design;
use crate::instrument::{Instrument, Item};
use crate::problem::Problem;

/// Steps above which an instrument is a slider.
const SLIDER_STEPS: f64 = 20.0;
/// Points of which each has a word beside it, at most.
const WORDED: usize = 7;

/// The questions of one instrument.
#[derive(Debug, Clone, Copy)]
pub struct Block<'d> {
    /// The instrument.
    pub of: &'d Instrument,
}

impl<'d> Block<'d> {
    /// Its items, scale after scale.
    pub fn items(self) -> impl Iterator<Item = &'d Item> {
        self.of.scales.iter().flat_map(|scale| &scale.items)
    }

    /// Whether it is a slider.
    #[must_use]
    pub fn is_slider(self) -> bool {
        self.of.points.1 - self.of.points.0 > SLIDER_STEPS
    }

    /// Whether its items are pairs of words, one for either end: `dead / alive`.
    #[must_use]
    pub fn is_pairs(self) -> bool {
        self.items().all(|item| item.text.contains(" / "))
    }

    /// Its answers, the lowest first; none of a slider.
    #[must_use]
    pub fn points(self) -> Vec<f64> {
        let (low, high) = self.of.points;
        let mut found = Vec::new();
        let mut at = low;
        while !self.is_slider() && at <= high + 1e-9 {
            found.push(at);
            at += 1.0;
        }
        found
    }

    /// An answer in words, with its number where it has none.
    #[must_use]
    pub fn words(self, points: f64) -> String {
        let anchor = self.of.anchors.iter().find(|(at, _)| (at - points).abs() < 1e-9);
        anchor.filter(|_| !self.is_pairs()).map_or_else(|| points.to_string(), |(_, words)| words.clone())
    }

    /// Whether every answer has words that fit beside it.
    #[must_use]
    pub fn is_worded(self) -> bool {
        let points = self.points();
        !points.is_empty() && points.len() <= WORDED && self.of.anchors.len() == points.len() && !self.is_pairs()
    }
}

/// The questions of a study, instrument after instrument.
#[must_use]
pub fn blocks(design: &Design) -> Vec<Block<'_>> {
    design.instruments.iter().map(|of| Block { of }).collect()
}

/// An attention check: a line among the questions that says itself what to answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Check {
    /// Its name.
    pub name: String,
    /// Place of the film after which it is asked, from 1.
    pub position: usize,
    /// The instrument among whose questions it stands.
    pub instrument: String,
    /// It stands before the item of this number, from 0.
    pub before: usize,
    /// The right answer.
    pub points: f64,
    /// What is asked.
    pub text: String,
}

/// Where the declared checks stand, with what they say. They are spread over the films and stand in the middle of the questions.
///
/// # Errors
/// A check whose right answer is none of any instrument that has a choice.
pub fn checks(design: &Design, films: usize) -> Result<Vec<Check>, Problem> {
    let mut found = Vec::new();
    for (index, (name, right)) in design.checks.iter().enumerate() {
        let of = blocks(design).into_iter().find_map(|block| Some((block, answer(block, right)?)));
        let Some((block, points)) = of else {
            let hint = "a right answer is one of the points or words of an instrument that is no slider, such as 4";
            return Err(Problem::new("the study", "no instrument has this answer to an attention check", hint)
                .column(&format!("checks.{name}"))
                .value(right));
        };
        let words = block.words(points);
        found.push(Check {
            name: name.clone(),
            position: ((index + 1) * films).div_ceil(design.checks.len() + 1).clamp(1, films.max(1)),
            instrument: block.of.id.clone(),
            before: block.items().count().div_ceil(2),
            points,
            text: format!("To show that you read every line, please choose “{words}” in this one."),
        });
    }
    Ok(found)
}

/// An answer in points or words as points of a block.
#[must_use]
pub fn answer(block: Block<'_>, told: &str) -> Option<f64> {
    let points = told.trim().parse::<f64>().ok().or_else(|| block.of.points_of(told))?;
    (block.of.takes(points) && !block.is_slider()).then_some(points)
}

/// Whether an answer to a check, in points or words, is the right one.
#[must_use]
pub fn is_right(design: &Design, right: &str, told: &str) -> bool {
    let points = |text: &str| blocks(design).into_iter().find_map(|block| answer(block, text));
    let same = |right: f64, told: f64| (right - told).abs() < 1e-9;
    told.trim().eq_ignore_ascii_case(right.trim())
        || points(right).zip(points(told)).is_some_and(|(right, told)| same(right, told))
}

/// The questions as the script of a page takes them.
#[must_use]
pub fn told(design: &Design) -> Value {
    let block = |block: Block<'_>| {
        let items: Vec<Value> = block.items().map(|item| json!([item.code, item.text])).collect();
        let points: Vec<Value> = block.points().into_iter().map(|at| json!([at, block.words(at)])).collect();
        let anchors: Vec<Value> = block.of.anchors.iter().map(|(at, words)| json!([at, words])).collect();
        json!({ "id": block.of.id, "stem": block.of.stem, "items": items, "points": points, "anchors": anchors,
            "range": [block.of.points.0, block.of.points.1], "worded": block.is_worded(), "pairs": block.is_pairs() })
    };
    blocks(design).into_iter().map(block).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kit::tests::design;

    #[test]
    fn checks_are_spread_over_the_films_and_say_their_answer() {
        let design = design();
        let found = checks(&design, 3).unwrap();
        assert_eq!((found[0].position, found[1].position), (1, 2));
        assert_eq!((found[0].points, found[0].before), (4.0, 4));
        assert!(found[0].text.contains("“somewhat agree”"), "{}", found[0].text);
        assert!(
            is_right(&design, "4", "somewhat agree") && is_right(&design, "4", "4") && !is_right(&design, "4", "2")
        );
    }

    #[test]
    fn a_check_that_cannot_be_answered_is_refused() {
        let mut design = design();
        design.checks.insert("odd".to_owned(), "maybe".to_owned());
        let why = checks(&design, 3).unwrap_err().to_string();
        assert!(why.contains("`checks.odd` is `maybe`") && why.contains("hint"), "{why}");
    }

    #[test]
    fn kinds_of_questions_are_told_apart() {
        let of = |id: &str| Instrument::named(id, "").unwrap();
        let (pairs, slider, words, nine) = (of("godspeed"), of("slider"), of("psi"), of("rosas"));
        let block = |of| Block { of };
        assert!(block(&pairs).is_pairs() && !block(&pairs).is_worded() && block(&pairs).points().len() == 5);
        assert!(block(&slider).is_slider() && block(&slider).points().is_empty());
        assert!(block(&words).is_worded() && !block(&nine).is_worded());
        assert_eq!(
            (block(&nine).words(2.0), block(&nine).words(9.0)),
            ("2".to_owned(), "definitely associated".to_owned())
        );
    }
}
