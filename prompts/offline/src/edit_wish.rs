//! The wishes of an edit in words, as the reader tells them apart, with their words.

use socrates_model::PlaceClass;
use socrates_reader::{Edit, Reader};

/// One wish of an edit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Wish {
    pub(crate) edit: Edit,
    /// Its words.
    pub(crate) quote: String,
    /// Where, if it says.
    pub(crate) place: Option<PlaceClass>,
    /// How many meters, if it says.
    pub(crate) meters: Option<f64>,
    /// Whether it speaks of another place of the same kind.
    pub(crate) other: bool,
    /// Whether it speaks of somebody or something more.
    pub(crate) adds: bool,
    /// Whether it means everybody.
    pub(crate) everybody: bool,
    /// Whether it speaks of a group.
    pub(crate) group: bool,
}

impl Wish {
    /// Words that may be node ids.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.quote.split(|c: char| !c.is_alphanumeric() && !matches!(c, '_' | '-')).filter(|word| !word.is_empty())
    }
}

/// Every wish of the words, in order.
pub(crate) fn wishes(text: &str) -> Vec<Wish> {
    let found = Reader::shipped().wishes(text).into_iter();
    found
        .map(|wish| Wish {
            quote: text.get(wish.at).unwrap_or_default().to_owned(),
            edit: wish.edit,
            place: wish.place,
            meters: wish.meters,
            other: wish.other,
            adds: wish.adds,
            everybody: wish.everybody,
            group: wish.group,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edits_are_told_apart() {
        for (text, edit) in [
            ("Make the robot's path longer", Edit::Longer),
            ("please shorten the way of the robot", Edit::Shorter),
            ("the second one should be slower", Edit::Slower),
            ("move it to the other corridor", Edit::Move),
            ("remove the group", Edit::Remove),
            ("no gestures", Edit::NoGestures),
            ("let her stop 3 m before the robot", Edit::Story),
            ("add a third person who waits at the door", Edit::Story),
            ("reverse the robot's path", Edit::Reverse),
            ("the robot should avoid the doorway", Edit::Avoid),
            ("start the nurse at the door", Edit::Start),
            ("the nurse should move aside", Edit::Story),
            ("swap the nurse and the visitor", Edit::Swap),
            ("make the nurse and the visitor a group", Edit::Group),
            ("break up the group", Edit::Ungroup),
            ("change the nurse's gesture to PROCEED", Edit::Gesture),
            ("the nurse gestures WAIT to the robot", Edit::Story),
        ] {
            let found = wishes(text);
            assert_eq!(found.iter().map(|wish| wish.edit).collect::<Vec<_>>(), [edit], "{text}");
            assert_eq!(found[0].quote, text);
        }
        assert_eq!(wishes("make the robot's path longer and remove the nurse").len(), 2);
        assert!(wishes("please, thanks").is_empty());
    }
}
