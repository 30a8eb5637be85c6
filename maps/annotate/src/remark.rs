//! What the annotation did not understand or wants to be told, with places.

use std::fmt;

use serde::Serialize;
use socrates_model::Point;

/// Kinds of remarks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum RemarkKind {
    /// Specks of a few cells on free floor.
    Dust,
    /// Things that stand alone, too small to part the floor.
    Things,
    /// Cells too coarse for doors.
    Coarse,
    /// Free floor that nothing leads to; it has no nodes.
    CutOff,
    /// Several floors of a building, or several buildings, in one picture; one of them is annotated.
    SeveralFloors,
    /// Free floor round the building; it has no nodes.
    Outside,
    /// A gap narrower than the robot.
    Gap,
    /// A small room with one door, which may be an elevator: a question.
    Elevator,
    /// An opening that is taken for a doorway with little confidence.
    Doubtful,
    /// The map is one floor without rooms, corridors and doors.
    OneFloor,
    /// A place that no edge reaches with the robot's radius.
    Unreached,
    /// All ways together are too short for any scenario.
    Small,
}

impl RemarkKind {
    /// Name as written in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Dust => "dust",
            Self::Things => "things",
            Self::Coarse => "coarse",
            Self::CutOff => "cut_off",
            Self::SeveralFloors => "several_floors",
            Self::Outside => "outside",
            Self::Gap => "gap",
            Self::Elevator => "elevator",
            Self::Doubtful => "doubtful",
            Self::OneFloor => "one_floor",
            Self::Unreached => "unreached",
            Self::Small => "small",
        }
    }
}

/// A remark: what, where, in words.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Remark {
    /// What it is about.
    pub kind: RemarkKind,
    /// Where, in the map frame, m; `None` where it is about the whole map.
    pub at: Option<Point>,
    /// A sentence for a person.
    pub text: String,
}

impl Remark {
    pub(crate) const fn new(kind: RemarkKind, at: Option<Point>, text: String) -> Self {
        Self { kind, at, text }
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.at {
            Some(at) => write!(f, "at ({:.1}, {:.1}) m: {}", at.x, at.y, self.text),
            None => f.write_str(&self.text),
        }
    }
}
