//! Questionnaires as data: items, keys, points, where they come from; and the score of a scale.

use std::collections::{BTreeMap, BTreeSet};

use serde::Deserialize;

use crate::problem::{Problem, nearest};
use crate::rating::Rating;

/// Fewest items that make a scale; fewer are called single items, and no reliability is told of them.
pub const SCALE_ITEMS: usize = 3;

/// The questionnaires that are shipped: file name and text.
const SHIPPED: [(&str, &str); 7] = [
    ("godspeed.toml", include_str!("../instruments/godspeed.toml")),
    ("principles.toml", include_str!("../instruments/principles.toml")),
    ("psi.toml", include_str!("../instruments/psi.toml")),
    ("rosas.toml", include_str!("../instruments/rosas.toml")),
    ("rosas-sf.toml", include_str!("../instruments/rosas-sf.toml")),
    ("slider.toml", include_str!("../instruments/slider.toml")),
    ("vega2020.toml", include_str!("../instruments/vega2020.toml")),
];

/// A questionnaire.
#[derive(Debug, Clone, PartialEq)]
pub struct Instrument {
    /// Short name, by which studies ask for it.
    pub id: String,
    /// Title for people.
    pub title: String,
    /// Where its items come from.
    pub source: String,
    /// Terms of use, and what to know of it.
    pub notice: String,
    /// Whether a publication has examined what it measures.
    pub validated: bool,
    /// What stands before every item.
    pub stem: String,
    /// Lowest and highest answer, points.
    pub points: (f64, f64),
    /// Words of some answers, by their points.
    pub anchors: Vec<(f64, String)>,
    /// Its scales.
    pub scales: Vec<Scale>,
}

/// Items that are averaged.
#[derive(Debug, Clone, PartialEq)]
pub struct Scale {
    /// Name within the instrument.
    pub id: String,
    /// Its items.
    pub items: Vec<Item>,
}

/// One question.
#[derive(Debug, Clone, PartialEq)]
pub struct Item {
    /// Code, no two alike in a study: the scale's code and a number from 1.
    pub code: String,
    /// Its words.
    pub text: String,
    /// Whether agreement speaks against what the scale measures: scored `low + high − answer`.
    pub reversed: bool,
}

/// An instrument as a file or a study states it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Written {
    id: String,
    title: Option<String>,
    source: Option<String>,
    notice: Option<String>,
    #[serde(default)]
    validated: bool,
    #[serde(default)]
    stem: String,
    low: f64,
    high: f64,
    #[serde(default)]
    anchors: BTreeMap<String, String>,
    #[serde(default)]
    scale: Vec<WrittenScale>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenScale {
    code: String,
    id: Option<String>,
    #[serde(default)]
    items: Vec<WrittenItem>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
enum WrittenItem {
    Words(String),
    Keyed { text: String, reversed: bool },
}

impl Instrument {
    /// Checks what a file says.
    pub(crate) fn of(written: Written, file: &str) -> Result<Self, Problem> {
        let id = written.id.clone();
        let bad = |what: String, hint: &str| Problem::new(file, what, hint).column(&format!("instrument {id}"));
        if !(written.low.is_finite() && written.high.is_finite() && written.low < written.high) {
            let what = format!("`low` {} is not below `high` {}", written.low, written.high);
            return Err(bad(what, "a five-point instrument has `low = 1` and `high = 5`"));
        }
        let mut scales = Vec::new();
        for scale in written.scale {
            let code = &scale.code;
            if code.is_empty() || !code.chars().all(|c| c.is_ascii_alphanumeric()) {
                return Err(bad(format!("`code = \"{code}\"` of a scale"), "a code is letters and digits, such as RB"));
            }
            if scale.items.is_empty() {
                return Err(bad(
                    format!("the scale `{code}` has no items"),
                    "paste its items: `items = [\"…\", { text = \"…\", reversed = true }]`",
                ));
            }
            let mut items = Vec::new();
            for (place, item) in scale.items.into_iter().enumerate() {
                let (text, reversed) = match item {
                    WrittenItem::Words(text) => (text, false),
                    WrittenItem::Keyed { text, reversed } => (text, reversed),
                };
                if text.trim().is_empty() {
                    return Err(bad(
                        format!("item {} of the scale `{code}` has no words", place + 1),
                        "paste its text; an item without words cannot be asked",
                    ));
                }
                items.push(Item { code: format!("{code}{}", place + 1), text, reversed });
            }
            scales.push(Scale { id: scale.id.unwrap_or_else(|| code.clone()), items });
        }
        if scales.is_empty() {
            return Err(bad("it has no scale".to_owned(), "add `[[instrument.scale]]` with `code` and `items`"));
        }
        let mut anchors = Vec::new();
        for (points, words) in written.anchors {
            let at = points.parse::<f64>().ok().filter(|at| (written.low..=written.high).contains(at));
            let Some(at) = at else {
                return Err(bad(format!("the anchor `{points}` is no answer of it"), "anchors are keyed by points"));
            };
            anchors.push((at, words));
        }
        anchors.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(Self {
            title: written.title.unwrap_or_else(|| written.id.clone()),
            source: written.source.unwrap_or_else(|| "items of the study".to_owned()),
            notice: written.notice.unwrap_or_default(),
            id: written.id,
            validated: written.validated,
            stem: written.stem,
            points: (written.low, written.high),
            anchors,
            scales,
        })
    }

    /// An instrument from the text of its file.
    ///
    /// # Errors
    /// A text that is no instrument, a scale without items, an item without words.
    pub fn parse(text: &str, file: &str) -> Result<Self, Problem> {
        let written: Written = toml::from_str(text).map_err(|why| {
            Problem::new(file, why.message(), "the shipped instruments show the keys: `socrates study instruments`")
        })?;
        Self::of(written, file)
    }

    /// The shipped ones, by name.
    ///
    /// # Errors
    /// None with the shipped files; a test reads them all.
    pub fn shipped() -> Result<Vec<Self>, Problem> {
        SHIPPED.iter().map(|(file, text)| Self::parse(text, file)).collect()
    }

    /// A shipped one.
    ///
    /// # Errors
    /// There is none of this name.
    pub fn named(id: &str, file: &str) -> Result<Self, Problem> {
        let all = Self::shipped()?;
        let names: Vec<&str> = all.iter().map(|one| one.id.as_str()).collect();
        let near =
            nearest(id, names.iter().copied()).map_or_else(String::new, |near| format!("did you mean `{near}`? "));
        let hint =
            format!("{near}shipped are {}; others are pasted as `[[instrument]]` with their items", names.join(", "));
        let found = all.iter().find(|one| one.id == id).cloned();
        found.ok_or_else(|| {
            Problem::new(file, "no instrument of this name is shipped", hint).column("instruments").value(id)
        })
    }

    /// Whether these points are an answer: a whole step from `low` to `high`, any number on a slider of more than 20 points.
    #[must_use]
    pub fn takes(&self, points: f64) -> bool {
        let (low, high) = self.points;
        let step = points - low;
        (low..=high).contains(&points) && (high - low > 20.0 || (step - libm::round(step)).abs() < 1e-9)
    }

    /// The points of an answer in words, whatever their case.
    #[must_use]
    pub fn points_of(&self, words: &str) -> Option<f64> {
        let words = words.trim().to_lowercase();
        self.anchors.iter().find(|(_, anchor)| anchor.to_lowercase() == words).map(|(points, _)| *points)
    }

    /// A given answer in the direction of the scale: `low + high − answer` where the item is reversed.
    #[must_use]
    pub fn keyed(&self, item: &Item, rating: Rating) -> Option<f64> {
        let points = rating.points()?;
        Some(if item.reversed { self.points.0 + self.points.1 - points } else { points })
    }
}

impl Scale {
    /// Whether it is too short to be called a scale.
    #[must_use]
    pub const fn is_single(&self) -> bool {
        self.items.len() < SCALE_ITEMS
    }

    /// Mean of the answers in the direction of the scale; none where more than half of its items are missing.
    #[must_use]
    pub fn score(&self, of: &Instrument, answers: &BTreeMap<&str, Rating>) -> Option<f64> {
        let rating = |item: &Item| answers.get(item.code.as_str()).copied().unwrap_or_default();
        let given: Vec<f64> = self.items.iter().filter_map(|item| of.keyed(item, rating(item))).collect();
        if given.is_empty() || given.len() * 2 < self.items.len() {
            return None;
        }
        socrates_stats::mean(&given).ok()
    }
}

/// Refuses item codes that two instruments of a study share.
pub(crate) fn apart(instruments: &[Instrument], file: &str) -> Result<(), Problem> {
    let mut seen: BTreeSet<&str> = BTreeSet::new();
    for item in instruments.iter().flat_map(|one| &one.scales).flat_map(|scale| &scale.items) {
        if !seen.insert(&item.code) {
            let hint = "give each scale a `code` of its own, and name no instrument twice";
            return Err(Problem::new(file, "two items have this code", hint).column("instruments").value(&item.code));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_instruments_are_whole_and_their_codes_apart() {
        let all = Instrument::shipped().unwrap();
        apart(&all, "").unwrap();
        let items = |id: &str| -> Vec<usize> {
            all.iter().find(|one| one.id == id).unwrap().scales.iter().map(|scale| scale.items.len()).collect()
        };
        assert_eq!((items("rosas"), items("rosas-sf")), (vec![6, 6, 6], vec![2, 2, 2]));
        assert_eq!((items("godspeed"), items("vega2020")), (vec![5, 6, 5, 5], vec![9]));
        assert_eq!((items("principles"), items("psi"), items("slider")), (vec![10], vec![4, 4], vec![1]));
        let unvalidated: Vec<&str> = all.iter().filter(|one| !one.validated).map(|one| one.id.as_str()).collect();
        assert_eq!(unvalidated, ["principles", "slider", "vega2020"]);
        assert!(all.iter().all(|one| !one.source.is_empty() && !one.notice.is_empty()));
    }

    #[test]
    fn a_reversed_item_is_turned_round_and_a_missing_one_is_no_zero() {
        let own = "id = \"own\"\nlow = 1\nhigh = 5\n[[scale]]\ncode = \"X\"\nitems = [\"a\", \"b\", { text = \"c\", reversed = true }, \"d\"]\n";
        let own = Instrument::parse(own, "own.toml").unwrap();
        let scale = &own.scales[0];
        let score = |answers: &[(&'static str, f64)]| {
            let answers = answers.iter().map(|(code, points)| (*code, Rating::Given(*points))).collect();
            scale.score(&own, &answers)
        };
        assert_eq!(score(&[("X1", 4.0), ("X2", 4.0), ("X3", 2.0), ("X4", 4.0)]), Some(4.0));
        assert_eq!(score(&[("X1", 4.0), ("X3", 2.0)]), Some(4.0), "half of the items are enough");
        assert_eq!(score(&[("X1", 4.0)]), None, "a quarter of them is not, and the rest is no 0");
        assert_eq!(score(&[]), None);
    }

    #[test]
    fn what_is_no_answer_is_known() {
        let psi = Instrument::named("psi", "study.toml").unwrap();
        assert!(psi.takes(1.0) && psi.takes(5.0) && !psi.takes(0.0) && !psi.takes(6.0) && !psi.takes(2.5));
        assert!(Instrument::named("slider", "").unwrap().takes(33.3));
        assert_eq!(psi.points_of(" Somewhat Agree"), Some(4.0));
        let wrong = Instrument::named("rosa", "study.toml").unwrap_err();
        assert!(
            wrong.to_string().contains("`instruments` is `rosa`") && wrong.hint.contains("did you mean `rosas`"),
            "{wrong}"
        );
    }

    #[test]
    fn an_instrument_without_its_items_is_refused() {
        let refused = |scale: &str| {
            Instrument::parse(&format!("id = \"own\"\nlow = 1\nhigh = 5\n{scale}"), "own.toml").unwrap_err().to_string()
        };
        assert!(refused("").contains("no scale"));
        assert!(refused("[[scale]]\ncode = \"PB\"\nitems = []").contains("`PB` has no items"));
        assert!(refused("[[scale]]\ncode = \"PB\"\nitems = [\"a\", \" \"]").contains("item 2 of the scale `PB`"));
        assert!(refused("[[scale]]\ncode = \"P B\"\nitems = [\"a\"]").contains("P B"));
    }
}
