//! The lines of a story: what a text says of it, each with the words that say it.

use socrates_model::{Gesture, PlaceClass, Relation};

/// What a story states, by people's numbers from 0; whatever a text says of it has the words that say it.
#[derive(Debug, Clone, PartialEq)]
pub enum Line {
    /// Somebody is there.
    Person(usize),
    /// How somebody stands to the robot's way.
    Relation(usize, Relation),
    /// On which side.
    Side(usize),
    /// How fast somebody walks.
    Pace(usize),
    /// Somebody is in a group.
    Group(usize),
    /// Somebody meets the robot twice.
    Twice(usize),
    /// Somebody's step, by its number from 0.
    Step(usize, usize),
    /// Where it happens.
    Place(PlaceClass),
    /// Where the robot's way begins.
    RobotStart(PlaceClass),
    /// Where it ends.
    RobotGoal(PlaceClass),
    /// What it leads past.
    RobotVia(PlaceClass),
    /// The robot is there before somebody.
    RobotFirst(usize),
    /// The first comes before the second.
    Before(usize, usize),
    /// The robot makes a sign.
    RobotSays(Gesture),
}

impl Line {
    /// Of whom it tells.
    #[must_use]
    pub const fn person(&self) -> Option<usize> {
        match self {
            Self::Person(person)
            | Self::Relation(person, _)
            | Self::Side(person)
            | Self::Pace(person)
            | Self::Group(person)
            | Self::Twice(person)
            | Self::RobotFirst(person)
            | Self::Step(person, _) => Some(*person),
            Self::Before(..)
            | Self::Place(_)
            | Self::RobotStart(_)
            | Self::RobotGoal(_)
            | Self::RobotVia(_)
            | Self::RobotSays(_) => None,
        }
    }

    /// Whether it is about nobody who is taken out; it names the others by their new numbers.
    pub(crate) fn without(&mut self, out: &[usize]) -> bool {
        let anew = |person: usize| person - out.iter().filter(|gone| **gone < person).count();
        if let Self::Before(first, then) = self {
            let stays = !out.contains(first) && !out.contains(then);
            (*first, *then) = (anew(*first), anew(*then));
            return stays;
        }
        let (Self::Person(person)
        | Self::Relation(person, _)
        | Self::Side(person)
        | Self::Pace(person)
        | Self::Group(person)
        | Self::Twice(person)
        | Self::RobotFirst(person)
        | Self::Step(person, _)) = self
        else {
            return true;
        };
        let stays = !out.contains(person);
        *person = anew(*person);
        stays
    }
}
