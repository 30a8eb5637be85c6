//! Runs that lack the thing a clause tells of: the judge must not find that it holds.
//!
//! ```text
//! clause ─► row of the table ─┬─► exempt, with the reason
//!                             └─► edits ─► those that take the thing away here ─► recordings
//! ```
//!
//! The table ([`ROWS`]) has a row for every predicate and says for each [`Lack`] which edits take the thing away, or why none
//! can. Whether an edit takes it away in the run at hand is decided by the geometry of that run alone (`bites`): somebody who
//! starts at the place of the meeting is met there however long they stand.

mod bites;
mod edits;
mod robot;
mod table;

use socrates_model::{Clause, ClauseResult, Predicate, Recording};

pub use table::{ROWS, row};

use bites::bites;
use edits::edited;
use socrates_scoring::Evidence;
use socrates_scoring::fidelity::standing_of;

/// A way in which a thing does not happen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Lack {
    /// The agent stands, from the start or from when it should begin.
    Frozen,
    /// The agent is gone, or far away.
    Absent,
    /// Reflected, turned about, or walked backwards.
    Mirrored,
    /// So much later or sooner that it cannot be.
    Delayed,
    /// Somebody else does it.
    Exchanged,
    /// The log of the tree tells of the act, and the motion does not show it.
    WithoutEffect,
}

impl Lack {
    /// Every one, in the order of the rows.
    pub const ALL: [Self; 6] =
        [Self::Frozen, Self::Absent, Self::Mirrored, Self::Delayed, Self::Exchanged, Self::WithoutEffect];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Frozen => "frozen",
            Self::Absent => "absent",
            Self::Mirrored => "mirrored",
            Self::Delayed => "delayed",
            Self::Exchanged => "exchanged",
            Self::WithoutEffect => "without effect",
        }
    }
}

/// The agents that an edit changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Whose {
    /// The one whom the clause is about; the last human where it counts them.
    Person,
    /// Every human.
    Everybody,
    /// The members of the group.
    Members,
    /// One of them.
    LastMember,
    /// Those who come out of the room or car.
    Leavers,
    /// The robot.
    Robot,
}

/// A change of one agent's part of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Edit {
    /// Stands at the start of its way.
    StandsFromStart,
    /// Stands all the time where the evidence begins.
    StandsThere,
    /// Stands from when the evidence, or the act, begins.
    StandsFromEvidence,
    /// Is not in the recording.
    Gone,
    /// Is not there in the second half of the run.
    GoneHalfway,
    /// Does the same 60 m away.
    FarAway,
    /// Goes its way from the end to the start.
    Backwards,
    /// Faces the other way.
    TurnedAbout,
    /// Has its back to the robot.
    TurnedAway,
    /// Goes as far the opposite way from where the act begins.
    TowardsInstead,
    /// Goes ahead of the leader, and beside it.
    AheadInstead,
    /// See [`Edit::AheadInstead`].
    BesideInstead,
    /// Goes 2 m to the side of the robot's line.
    Aside,
    /// Everything so late that the run is over first.
    OutOfTime,
    /// Comes to the place once the robot has left it.
    AfterRobot,
    /// Later than was asked: past the limit, or after whom it should precede.
    Later,
    /// Sooner than was asked.
    Sooner,
    /// 0.03 s before whom it should precede.
    AtTheSameTime,
    /// Has done it when the run begins.
    AlreadyDone,
    /// Stands where the robot sees it from afar.
    SeenAhead,
    /// Another human has its track.
    Swapped,
    /// Both of a pair have each other's track.
    SwappedPair,
    /// Another human has its track from the middle of the run on.
    SwappedMidway,
    /// The log stays; the agent stands where the act should begin.
    LogStands,
    /// The log stays; the agent walks straight on where the act should begin.
    LogWalks,
    /// The log tells of a sign; no state shows it.
    LogAlone,
    /// The log stays; the agent walks out to the robot's way.
    WalksToRobot,
    /// The log stays; the members walk off before the robot comes.
    WalksOff,
    /// The door stays shut, opens at the start, or opens at the end of the run.
    DoorShut,
    /// See [`Edit::DoorShut`].
    DoorAtStart,
    /// See [`Edit::DoorShut`].
    DoorAtEnd,
    /// Stands where the robot drives.
    OnRobotsWay,
    /// Walks inside the robot.
    IntoRobot,
    /// Is 3 s farther on its way from one moment to the next.
    SkipsAhead,
    /// Goes its way at half the pace.
    HalfPace,
    /// Makes the sign long before its reason, or long after it.
    SignSooner,
    /// See [`Edit::SignSooner`].
    SignLater,
    /// Stands for as long where it starts, and drives on where it stood.
    StandsSooner,
    /// Drives on after a quarter of its stand.
    SetsOffSooner,
}

/// What a row says of a [`Lack`].
#[derive(Debug, Clone, Copy)]
pub(super) enum Entry {
    /// These edits take the thing away.
    Spoil(&'static [(Whose, Edit)]),
    /// The same as for the clause that comes first.
    AsFirst,
    /// It cannot, for this reason.
    Exempt(&'static str),
}

/// What takes the thing of a predicate away.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    /// Name of the predicate, as proposals have it.
    pub name: &'static str,
    entries: [Entry; 6],
}

impl Row {
    /// Why a lack has no meaning for the predicate; `None` where it has one.
    #[must_use]
    pub fn exemption(&self, lack: Lack) -> Option<&'static str> {
        match self.entry(lack) {
            Entry::Exempt(why) => Some(why),
            Entry::Spoil(_) | Entry::AsFirst => None,
        }
    }

    fn entry(&self, lack: Lack) -> Entry {
        let found = Lack::ALL.iter().zip(self.entries).find(|(other, _)| **other == lack);
        found.map_or(Entry::Spoil(&[]), |(_, entry)| entry)
    }
}

/// A run without the thing.
#[derive(Debug, Clone, PartialEq)]
pub struct Lacking {
    /// What it lacks.
    pub lack: Lack,
    /// The agent and the change, in words.
    pub about: String,
    /// The recording.
    pub recording: Recording,
}

/// Every run that lacks what a clause tells of and that `seen` found in the run at hand.
#[must_use]
pub fn lacking(evidence: &Evidence<'_>, clause: &Clause, seen: &ClauseResult) -> Vec<Lacking> {
    let row = row(&clause.predicate);
    let mut found = Vec::new();
    for lack in Lack::ALL {
        match row.entry(lack) {
            Entry::Exempt(_) => {}
            Entry::Spoil(edits) => of_edits(evidence, clause, seen, (lack, edits), &mut found),
            Entry::AsFirst => {
                let Some((first, seen)) = first_of(evidence, &clause.predicate) else { continue };
                if let Entry::Spoil(edits) = self::row(&first.predicate).entry(lack) {
                    of_edits(evidence, &first, &seen, (lack, edits), &mut found);
                }
            }
        }
    }
    found
}

/// The clause that an order puts first, as it was seen.
fn first_of(evidence: &Evidence<'_>, predicate: &Predicate) -> Option<(Clause, ClauseResult)> {
    let Predicate::Order { first, .. } = predicate else { return None };
    let clause = evidence.proposal?.expected_events.iter().find(|clause| clause.id == *first)?.clone();
    let seen = standing_of(evidence, &clause).ok()?;
    Some((clause, seen))
}

fn of_edits(
    evidence: &Evidence<'_>,
    clause: &Clause,
    seen: &ClauseResult,
    (lack, edits): (Lack, &[(Whose, Edit)]),
    found: &mut Vec<Lacking>,
) {
    let scene = edits::Scene::new(evidence, &clause.predicate, seen);
    for (whose, edit) in edits {
        let agents = scene.agents(*whose);
        if agents.is_empty() || !bites(&scene, *edit, &agents) {
            continue;
        }
        if let Some((who, recording)) = edited(&scene, *edit, &agents) {
            found.push(Lacking { lack, about: format!("{edit:?} of {who}"), recording });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_has_three_lacks_or_says_why_not() {
        for row in ROWS {
            let exempt: Vec<&str> = Lack::ALL.iter().filter_map(|lack| row.exemption(*lack)).collect();
            assert!(exempt.iter().all(|why| why.split(' ').count() > 3), "{}: {exempt:?}", row.name);
            let spoils = |entry: &Entry| matches!(entry, Entry::Spoil(edits) if !edits.is_empty());
            let entries = row.entries.iter();
            assert!(
                entries.filter(|entry| spoils(entry) || matches!(entry, Entry::AsFirst)).count() + exempt.len() == 6
            );
        }
    }
}
